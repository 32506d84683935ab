//! Which increments may stand.

use super::judgement::repeat;
use super::*;
use crate::model::{PluginLaw, StepControl};
use crate::stepping::constants::STABILISATION_BUDGET;
use crate::stepping::newton::Iteration;
use crate::stepping::test::strip;

impl StepRun {
    /// Returns the step, led by drag in its first half.
    pub(in crate::stepping) fn through_drag(mut self, stiffness: f64) -> Self {
        (self.usual_progress, self.usual_stiffness) = (0.5 / THROUGH_DRAG, stiffness);
        self.lead = self.drag().expect("there is contact");
        self
    }
}

/// An increment that the drives lead may unload: a step may ask for it. Under another lead it would run the step backwards.
#[test]
fn a_lead_that_unloads_elastically_is_refused_until_the_run_fails() {
    let law = PluginLaw::shipped("linear_elastic", &[("E", 1000.0), ("nu", 0.3)]);
    let control = StepControl::Automatic { initial: 0.1, maximum: 0.1, minimum: 1e-6 };
    let model = strip(law, crate::kinematics::PlaneModel::PlaneStress, 0.04, control);
    let mut run = StepRun::new(&model.steps[0], &[0.0], &model);
    let end = Committed { drives: vec![0.01], ..Committed::default() };
    let converged = Converged { end, ..Converged::default() };
    let load = LoadHistory { greatest: 10.0, last: 10.0, ..LoadHistory::default() };
    let unloads = Findings { load: 10.0, gives_back: true, ..Findings::default() };
    let fails = Findings { gives_back: false, ..unloads };
    assert!(run.judge(&converged, load, unloads).is_ok());
    for by in [Leader::PointSlip, Leader::Dissipation] {
        run.lead = Lead::Other(Led::new(by, 0.1));
        run.progress = 0.25;
        assert!(run.judge(&converged, load, fails).is_ok());
        let judgement = run.judge(&converged, load, unloads).expect_err("elastic");
        assert!(judgement.has_failed && judgement.trouble.reason.contains("unloads elastically"));
        // however small
        let attempts = (0..1000).find(|_| run.reject(&judgement.trouble, true) == Advance::Failed);
        assert!(attempts.is_some());
        assert!(run.judge(&converged, load, unloads).is_err());
    }
}

/// Viscosity takes the snap-back of solids, but contact has none: a fibre that leaves its hole snaps.
#[test]
fn with_stabilisation_slip_leads_where_the_drives_fail_again_and_again() {
    let law = PluginLaw::shipped("linear_elastic", &[("E", 1000.0), ("nu", 0.3)]);
    let control = StepControl::Automatic { initial: 0.1, maximum: 0.1, minimum: 1e-9 };
    let mut model = strip(law, crate::kinematics::PlaneModel::PlaneStress, 0.04, control);
    model.controls.relaxation_time = 1e-6;
    let mut run = StepRun::new(&model.steps[0], &[0.0], &model);
    (run.follows_slip, run.usual_slip, run.usual_dissipation) = (true, 0.01, 1.0);
    let trouble = repeat("no equilibrium", 0.25).trouble;
    for _ in 1..PATIENCE {
        assert_eq!(run.reject(&trouble, true), Advance::Repeated);
        assert_eq!(run.lead, Lead::Drives);
    }
    assert_eq!(run.reject(&trouble, true), Advance::Repeated);
    assert!(matches!(run.lead, Lead::Other(Led { by: Leader::PointSlip, .. })));
}

/// Where no lead is left a specimen with contact goes through drag: the drives go a little on and stand, until it is in balance.
/// Drag thickens where attempts fail, and not without end. Without contact the run ends.
#[test]
fn drag_leads_where_nothing_else_does() {
    let law = PluginLaw::shipped("linear_elastic", &[("E", 1000.0), ("nu", 0.3)]);
    let control = StepControl::Automatic { initial: 0.1, maximum: 0.1, minimum: 1e-3 };
    let model = strip(law, crate::kinematics::PlaneModel::PlaneStress, 0.04, control);
    let trouble = repeat("no equilibrium", 0.25).trouble;
    let load = LoadHistory { greatest: 10.0, last: 10.0, ..LoadHistory::default() };
    let falls = Findings { load: 9.5, pulls_on: true, ..Findings::default() };
    let end = || Committed { drives: vec![0.01], ..Committed::default() };
    let converged = |drag| Converged { end: end(), drag, ..Converged::default() };
    for has_contact in [true, false] {
        let mut run = StepRun::new(&model.steps[0], &[0.0], &model);
        (run.follows_slip, run.extrapolates, run.stabilised) = (has_contact, true, true);
        (run.usual_progress, run.usual_stiffness, run.progress) = (0.1, 1e3, 0.2);
        let ends = (0..100).find(|_| {
            run.target();
            run.reject(&trouble, true) == Advance::Failed || matches!(run.lead, Lead::Drag(_))
        });
        assert!(ends.is_some());
        assert_eq!(matches!(run.lead, Lead::Drag(_)), has_contact);
        if !has_contact {
            continue;
        }
        let IncrementGoal::Through { goal, resistance } = run.target() else { panic!("no drag") };
        assert!(goal[0] > run.drives_at(0.2)[0] && resistance > 0.0);
        assert!(run.judge(&converged(5.0), load, falls).is_ok(), "the load may fall");
        let imbalanced = Findings { energy_error: 0.5, ..falls };
        assert!(run.judge(&converged(5.0), load, imbalanced).is_err(), "it missed energy");
        let judgement = run.judge(&converged(5.0), load, Findings { load: 5.0, ..falls }).expect_err("a jump");
        let mut shorter = run.clone();
        let rises =
            shorter.judge(&converged(5.0), load, Findings { load: 20.0, ..falls }).expect_err("drag carries it");
        assert_eq!(shorter.reject(&rises.trouble, rises.has_failed), Advance::Repeated);
        let IncrementGoal::Through { goal: nearer, resistance: same } = shorter.target() else { panic!("no drag") };
        assert!(nearer[0] < goal[0] && same == resistance);
        let mut failing = run.clone();
        assert_eq!(failing.reject(&judgement.trouble, false), Advance::Repeated);
        let IncrementGoal::Through { resistance: thicker, .. } = failing.target() else { panic!("no drag") };
        assert!(thicker > 2.0 * resistance);
        assert!((0..100).any(|_| failing.reject(&trouble, true) == Advance::Failed), "drag thickens for ever");

        run.accept(&Committed::default(), &converged(5.0), falls, load);
        let stood = run.progress;
        let IncrementGoal::Through { goal: stands, resistance: thinner } = run.target() else {
            panic!("it is out of balance")
        };
        assert!(stands == goal && thinner < resistance && stood > 0.2);
        let mut turning = run.clone();
        let back = Converged { turns: true, ..converged(5.0) };
        turning.accept(&Committed::default(), &back, falls, load);
        assert!(matches!(turning.target(), IncrementGoal::Through { resistance, .. } if resistance > thinner));
        // neither state balances: the drives go on, and further before drag leads again
        let accepted = (2..100).find(|_| {
            turning.target();
            turning.accept(&Committed::default(), &back, falls, load);
            turning.lead == Lead::Drives
        });
        assert_eq!((accepted, turning.progress, turning.nudges), (Some(MOST_TURNS), stood, 1));
        run.accept(&Committed::default(), &converged(0.5), falls, load);
        assert!(run.lead == Lead::Drives && run.progress == stood);
    }
}

/// Drag takes nothing from runs that it cannot lead: a first increment is cut to the least that a step allows, and without contact
/// the leads change as often as they did.
#[test]
fn where_drag_cannot_lead_runs_go_on_as_far_as_without_it() {
    let law = PluginLaw::shipped("linear_elastic", &[("E", 1000.0), ("nu", 0.3)]);
    let control = StepControl::Automatic { initial: 0.1, maximum: 0.1, minimum: 1e-9 };
    let model = strip(law, crate::kinematics::PlaneModel::PlaneStress, 0.04, control);
    let trouble = repeat("no equilibrium", 0.25).trouble;
    let mut first = StepRun::new(&model.steps[0], &[0.0], &model);
    first.follows_slip = true;
    while first.attempted * 0.25 >= 1e-9 {
        assert_eq!(first.reject(&trouble, true), Advance::Repeated, "{:e}", first.attempted);
        first.target();
    }
    assert_eq!(first.reject(&trouble, true), Advance::Failed);
    let mut without = StepRun::new(&model.steps[0], &[0.0], &model);
    (without.usual_progress, without.last_progress, without.usual_dissipation) = (0.1, 0.1, 1.0);
    let mut leads = Vec::new();
    for _ in 0..1000 {
        without.target();
        assert_eq!(without.reject(&trouble, true), Advance::Repeated);
        if leads.last() != Some(&std::mem::discriminant(&without.lead)) {
            leads.push(std::mem::discriminant(&without.lead));
        }
    }
    assert!(leads.len() > 2 * LEADS as usize, "{}", leads.len());
}

/// The part of its work that a first increment misses where contact opens is the same, however small it is.
#[test]
fn energies_that_a_smaller_increment_does_not_mend_refuse_none() {
    let law = PluginLaw::shipped("linear_elastic", &[("E", 1000.0), ("nu", 0.3)]);
    let control = StepControl::Automatic { initial: 0.1, maximum: 0.1, minimum: 1e-9 };
    let model = strip(law, crate::kinematics::PlaneModel::PlaneStress, 0.04, control);
    let begun = StepRun::new(&model.steps[0], &[0.0], &model);
    let load = LoadHistory { greatest: 10.0, last: 10.0, ..LoadHistory::default() };
    let converged = Converged { end: Committed { drives: vec![0.01], ..Committed::default() }, ..Converged::default() };
    // of the error's order: how many attempts are refused before one stands, and how large it is
    let refusals = |order: f64| {
        let mut run = begun.clone();
        for count in 0..20 {
            run.target();
            let energy_error = 0.1 * (run.attempted / 0.1).powf(order);
            let findings = Findings { load: 10.0, energy_error, ..Findings::default() };
            match run.judge(&converged, load, findings) {
                Ok(()) => return (count, run.attempted),
                Err(judgement) => assert_eq!(run.reject(&judgement.trouble, judgement.has_failed), Advance::Repeated),
            }
        }
        panic!("none stands");
    };
    let (count, size) = refusals(0.0);
    assert!(count == 1 && size < 0.1, "{count} at {size}");
    for order in [1.0, 2.0, 3.0] {
        let (count, size) = refusals(order);
        assert!(count >= 1 && 0.1 * (size / 0.1).powf(order) < 3e-4, "{order}: {count} at {size}");
    }
}

/// An increment that converged is no reason to fail: a judgement cuts no increment below the least.
#[test]
fn a_judgement_leaves_the_least_increment() {
    let law = PluginLaw::shipped("linear_elastic", &[("E", 1000.0), ("nu", 0.3)]);
    let control = StepControl::Automatic { initial: 0.1, maximum: 0.1, minimum: 0.04 };
    let model = strip(law, crate::kinematics::PlaneModel::PlaneStress, 0.04, control);
    let mut run = StepRun::new(&model.steps[0], &[0.0], &model);
    let load = LoadHistory { greatest: 10.0, last: 10.0, ..LoadHistory::default() };
    let converged = Converged { end: Committed { drives: vec![0.01], ..Committed::default() }, ..Converged::default() };
    let findings = Findings { load: 10.0, energy_error: 1.0, ..Findings::default() };
    let judgement = run.judge(&converged, load, findings).expect_err("the energies miss the work");
    assert_eq!(run.reject(&judgement.trouble, judgement.has_failed), Advance::Repeated);
    run.target();
    assert_eq!(run.attempted, 0.04);
    assert!(run.judge(&converged, load, findings).is_ok());
}

/// A law that extrapolates spends on overstress with the square of the increment. Were every increment allowed the same, this step would
/// spend 2 % of its work; repeating increments for it would cost as much as they do.
#[test]
fn overstress_leaves_increments_less_the_more_is_spent() {
    let law = PluginLaw::shipped("linear_elastic", &[("E", 1000.0), ("nu", 0.3)]);
    let control = StepControl::Automatic { initial: 1e-3, maximum: 0.1, minimum: 1e-9 };
    let model = strip(law, crate::kinematics::PlaneModel::PlaneStress, 0.04, control);
    let mut run = StepRun::new(&model.steps[0], &[0.0], &model);
    let load = LoadHistory { greatest: 10.0, last: 10.0, ..LoadHistory::default() };
    let start = Committed { drives: vec![0.0], ..Committed::default() };
    let converged = Converged { end: Committed { drives: vec![0.01], ..Committed::default() }, ..Converged::default() };
    let (mut spent, mut refused, mut accepted) = (0.0, 0, 0);
    while !run.is_done() {
        run.target();
        let work = run.progress + run.attempted;
        let overstress = 4.0 * run.attempted.powi(2);
        let findings = Findings {
            load: 10.0,
            overstress: overstress / work,
            stabilisation_before: spent / work,
            ..Findings::default()
        };
        match run.judge(&converged, load, findings) {
            Ok(()) => {
                spent += overstress;
                accepted += 1;
                run.accept(&start, &converged, findings, load);
            }
            Err(judgement) => {
                refused += 1;
                assert_eq!(run.reject(&judgement.trouble, judgement.has_failed), Advance::Repeated);
            }
        }
    }
    assert!((0.005..STABILISATION_BUDGET).contains(&spent), "{spent}");
    assert!(refused * 10 < accepted, "{refused} of {accepted}");
}

/// Contact that settles needs the same few iterations after each update of its multipliers, however small the increment is: increments
/// that were judged by the sum of them shrank to the least that a step allows.
#[test]
fn rounds_of_contact_do_not_shrink_an_increment() {
    let law = PluginLaw::shipped("linear_elastic", &[("E", 1000.0), ("nu", 0.3)]);
    let control = StepControl::Automatic { initial: 0.01, maximum: 0.1, minimum: 1e-9 };
    let model = strip(law, crate::kinematics::PlaneModel::PlaneStress, 0.04, control);
    let load = LoadHistory { greatest: 10.0, last: 10.0, ..LoadHistory::default() };
    let findings = Findings { load: 10.0, ..Findings::default() };
    let after = |rounds: usize, each: usize| {
        let begins = |k: usize| Iteration { begins_round: k.is_multiple_of(each), ..Iteration::default() };
        let iterations: Vec<Iteration> = (0..rounds * each).map(begins).collect();
        let mut run = StepRun::new(&model.steps[0], &[0.0], &model);
        for _ in 0..2 {
            run.target();
            let converged = Converged { iterations: iterations.clone(), ..Converged::default() };
            run.accept(&Committed::default(), &converged, findings, load);
        }
        run.size.next(1.0)
    };
    assert_eq!(after(5, 4), 0.01);
    assert!(after(1, 4) > 0.01 && after(1, 20) < 0.01);
}
