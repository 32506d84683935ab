//! Which increments may stand.

use super::judgement::repeat;
use super::*;
use crate::model::{PluginLaw, StepControl};
use crate::stepping::test::strip;

/// An increment that the drives lead may unload: a step may ask for it. Under another lead it would run the step backwards.
#[test]
fn a_lead_that_unloads_elastically_is_refused_until_the_run_fails() {
    let law = PluginLaw::shipped("linear_elastic", &[("E", 1000.0), ("nu", 0.3)]);
    let control = StepControl::Automatic { initial: 0.1, maximum: 0.1, minimum: 1e-6 };
    let model = strip(law, crate::kinematics::PlaneModel::PlaneStress, 0.04, control);
    let mut run = StepRun::new(&model.steps[0], &[0.0], &model);
    let end = Committed { drives: vec![0.01], ..Committed::default() };
    let converged = Converged { end, iterations: Vec::new(), snapped: false };
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
    for _ in 1..FAILURES_BEFORE_CHANGE {
        assert_eq!(run.reject(&trouble, true), Advance::Repeated);
        assert_eq!(run.lead, Lead::Drives);
    }
    assert_eq!(run.reject(&trouble, true), Advance::Repeated);
    assert!(matches!(run.lead, Lead::Other(Led { by: Leader::PointSlip, .. })));
}

/// Where no lead is left a specimen with contact snaps, once; the drives lead on from there. Without contact the run ends.
#[test]
fn a_specimen_with_contact_snaps_where_nothing_leads_on() {
    let law = PluginLaw::shipped("linear_elastic", &[("E", 1000.0), ("nu", 0.3)]);
    let control = StepControl::Automatic { initial: 0.1, maximum: 0.1, minimum: 1e-3 };
    let model = strip(law, crate::kinematics::PlaneModel::PlaneStress, 0.04, control);
    let trouble = repeat("no equilibrium", 0.25).trouble;
    let converged = Converged {
        end: Committed { drives: vec![0.01], ..Committed::default() },
        iterations: Vec::new(),
        snapped: true,
    };
    let load = LoadHistory { greatest: 10.0, last: 10.0, ..LoadHistory::default() };
    let jumps = Findings { load: 1.0, pulls_on: true, energy_error: 0.5, ..Findings::default() };
    for has_contact in [true, false] {
        let mut run = StepRun::new(&model.steps[0], &[0.0], &model);
        (run.follows_slip, run.extrapolates, run.stabilised) = (has_contact, true, true);
        (run.usual_progress, run.progress) = (0.1, 0.2);
        run.target();
        let snaps = (0..100).find(|_| {
            run.target();
            run.reject(&trouble, true) == Advance::Failed || run.lead == Lead::Snap
        });
        assert!(snaps.is_some());
        assert_eq!(run.lead == Lead::Snap, has_contact);
        if !has_contact {
            continue;
        }
        assert!(matches!(run.target(), Target::Drives { snaps: true, .. }));
        assert!(run.judge(&converged, load, jumps).is_ok(), "a snap may jump");
        let mut failing = run.clone();
        assert!(
            (0..100).any(|_| {
                failing.target();
                failing.reject(&trouble, true) == Advance::Failed
            }),
            "nor does a snap go on for ever"
        );
        run.accept(&Committed::default(), &converged, jumps, load);
        assert!(run.lead == Lead::Drives && run.progress > 0.0);
    }
}

/// What a first increment misses where contact opens is the same part of its work, however small it is.
#[test]
fn energies_that_a_smaller_increment_does_not_mend_refuse_none() {
    let law = PluginLaw::shipped("linear_elastic", &[("E", 1000.0), ("nu", 0.3)]);
    let control = StepControl::Automatic { initial: 0.1, maximum: 0.1, minimum: 1e-9 };
    let model = strip(law, crate::kinematics::PlaneModel::PlaneStress, 0.04, control);
    let begun = StepRun::new(&model.steps[0], &[0.0], &model);
    let load = LoadHistory { greatest: 10.0, last: 10.0, ..LoadHistory::default() };
    let converged = Converged {
        end: Committed { drives: vec![0.01], ..Committed::default() },
        iterations: Vec::new(),
        snapped: false,
    };
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

/// What converged is no reason to fail: a judgement cuts no increment below the least.
#[test]
fn a_judgement_leaves_the_least_increment() {
    let law = PluginLaw::shipped("linear_elastic", &[("E", 1000.0), ("nu", 0.3)]);
    let control = StepControl::Automatic { initial: 0.1, maximum: 0.1, minimum: 0.04 };
    let model = strip(law, crate::kinematics::PlaneModel::PlaneStress, 0.04, control);
    let mut run = StepRun::new(&model.steps[0], &[0.0], &model);
    let load = LoadHistory { greatest: 10.0, last: 10.0, ..LoadHistory::default() };
    let converged = Converged {
        end: Committed { drives: vec![0.01], ..Committed::default() },
        iterations: Vec::new(),
        snapped: false,
    };
    let findings = Findings { load: 10.0, energy_error: 1.0, ..Findings::default() };
    let judgement = run.judge(&converged, load, findings).expect_err("the energies miss the work");
    assert_eq!(run.reject(&judgement.trouble, judgement.has_failed), Advance::Repeated);
    run.target();
    assert_eq!(run.attempted, 0.04);
    assert!(run.judge(&converged, load, findings).is_ok());
}
