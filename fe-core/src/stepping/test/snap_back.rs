//! A bar whose last quarter softens so fast that the rest, unloading, must turn back: the equilibrium path is
//!
//! ```text
//! u = ε L_s + σ L_e/E_e      σ = E ε/(1 + η)      η = [A (E ε²/2 − Y_0)]^B        (model I, ν = 0)
//! ```

use super::patch::Looking;
use super::pull_out::{bond_with, fibre};
use super::*;
use crate::mesh::specimen::Configuration;
use crate::model::{FieldValues, Fields as ModelFields};
use umat_abi::host::UmatInputs;

/// The softening quarter.
pub(super) const MODULUS: f64 = 31800.0;
const SCALE: f64 = 5000.0;
const EXPONENT: f64 = 1.3;
pub(super) const THRESHOLD: f64 = 2e-4;
/// The rest: soft, so that it stores much.
const REST: f64 = 5000.0;
/// Section, mm².
pub(super) const AREA: f64 = 0.5;
/// Length of the rest and of the softening quarter, mm.
pub(super) const LENGTHS: [f64; 2] = [3.0, 1.0];
/// Pulled so far, mm.
const END: f64 = 0.003;

pub(super) fn bar() -> Model {
    bar_of(THRESHOLD)
}

/// As [`bar`], with another damage threshold of the softening quarter, MPa.
pub(super) fn bar_of(threshold: f64) -> Model {
    let rest = PluginLaw::shipped("linear_elastic", &[("E", REST), ("nu", 0.0)]);
    let properties = [("E", MODULUS), ("nu", 0.0), ("A", SCALE), ("B", EXPONENT), ("Y_0", threshold)];
    let softening = PluginLaw::shipped("pure_damage", &properties);
    let control = StepControl::Automatic { initial: 0.02, maximum: 0.05, minimum: 1e-8 };
    chain(vec![rest, softening], PlaneModel::PlaneStress, END, control)
}

/// σ of the softening quarter.
pub(super) fn stress(strain: f64) -> f64 {
    let excess = (0.5 * MODULUS * strain * strain - THRESHOLD).max(0.0);
    MODULUS * strain / (1.0 + (SCALE * excess).powf(EXPONENT))
}

#[test]
fn dissipation_leads_through_a_snap_back_without_contact() {
    let (records, _) = run(&bar());
    let mut turned_back: f64 = 0.0;
    for pair in records.windows(2) {
        let (before, record) = (&pair[0], &pair[1]);
        let strain = (record.slip - record.load / AREA * LENGTHS[0] / REST) / LENGTHS[1];
        approx::assert_relative_eq!(record.load / AREA, stress(strain), max_relative = 1e-5);
        assert!(record.energies.damage >= before.energies.damage);
        assert!(record.energy_error.abs() < 1e-3, "{}: {:e}", record.increment, record.energy_error);
        let damaged = if record.energies.damage > 0.0 { AREA * LENGTHS[1] } else { 0.0 };
        approx::assert_relative_eq!(record.damaged_volume, damaged, max_relative = 1e-12);
        turned_back = turned_back.max(before.slip - record.slip);
    }
    assert!(turned_back > 0.0, "the drive had to turn back");
    let greatest = records.iter().map(|record| record.load).fold(0.0, f64::max);
    let peak = (1..4000).map(|k| AREA * stress(1e-7 * f64::from(k))).fold(0.0, f64::max);
    approx::assert_relative_eq!(greatest, peak, max_relative = 5e-3);
    assert_eq!(records.last().unwrap().slip, END);
}

/// Work that the drives take back from a damaged bar that unloads was stored.
#[test]
fn elastic_unloading_is_distinguished_from_loading() {
    let mut model = bar();
    let reached = 2.3e-3;
    model.steps[0].targets = vec![Some(reached)];
    let mut analysis = Analysis::new(&model).unwrap();
    analysis.run(&mut Keeper::default()).unwrap();
    assert!(analysis.present.energies.damage > 0.0);
    let context = IncrementContext { step: 1, increment: 2, iteration: 1, ..IncrementContext::default() };
    for (drive, unloads) in [(0.9 * reached, true), (1.01 * reached, false)] {
        let converged = analysis.attempt(&IncrementGoal::Drives(vec![drive]), context).unwrap();
        assert_eq!(analysis.findings(&converged).gives_back, unloads, "{drive}");
        analysis.equilibrium.restore();
    }
}

/// If something other than the drives leads, nobody knows beforehand how far an increment goes. Yet the laws receive
/// the temperature of its time, and step by step all of its change.
#[test]
fn time_and_temperature_go_on_through_a_snap_back_and_end_with_the_step() {
    let mut model = bar();
    model.skipping = Skipping::NONE;
    let at = |temperature: f64| FieldValues { temperature, variables: Vec::new() };
    model.fields = ModelFields { initial: at(10.0), ends: vec![at(30.0)] };
    let (mut turned_back, mut slip, mut received) = (false, 0.0, [10.0; 2]);
    let look = |record: &Record, snapshot: &Snapshot<'_>| {
        turned_back |= record.slip < slip;
        slip = record.slip;
        if record.increment == 0 {
            return;
        }
        let solids = snapshot.solids();
        let calls = (0..model.mesh.elements().len()).flat_map(|element| (0..4).map(move |point| (element, point)));
        for call in calls.filter_map(|(element, point)| solids.last_call(element, point)) {
            let UmatInputs { time, dtime, temp, dtemp, .. } = *call.arguments;
            approx::assert_relative_eq!(time[1], record.time - dtime, epsilon = 1e-14);
            approx::assert_relative_eq!(temp, received[1], epsilon = 1e-12);
            approx::assert_relative_eq!(temp + dtemp, 10.0 + 20.0 * record.time, epsilon = 1e-12);
        }
        received = [received[1], 10.0 + 20.0 * record.time];
        // what temperature does to the material is no work of the drives
        assert!(record.energy_error.is_nan());
    };
    Analysis::new(&model).unwrap().run(&mut Looking(look)).unwrap();
    assert!(turned_back && slip == END, "{turned_back} {slip}");
    approx::assert_relative_eq!(received[1], 30.0, epsilon = 1e-12);
}

#[test]
fn stabilisation_passes_a_snap_back_without_turning_and_books_what_it_takes() {
    let mut model = bar();
    model.controls.relaxation_time = 1e-4;
    let (records, _) = run(&model);
    assert!(records.windows(2).all(|pair| pair[1].slip > pair[0].slip));
    let last = records.last().unwrap();
    assert!(last.energies.stabilisation > 0.0);
    assert!(records.iter().all(|record| record.energy_error.abs() < 1e-2));
    let share = last.energies.stabilisation / last.energies.external_work;
    for (limit, passes) in [(1.01 * share, true), (0.99 * share, false)] {
        model.controls.max_stabilisation_share = Some(limit);
        let mut keeper = Keeper::default();
        let ended = Analysis::new(&model).unwrap().run(&mut keeper);
        assert_eq!(keeper.0.last().unwrap().energies, last.energies, "all increments are kept");
        match ended {
            Ok(()) => assert!(passes, "{share} of {limit}"),
            Err(error) => assert!(!passes && error.to_string().contains("% of the work"), "{error}"),
        }
    }
    // Where nothing moves fast any more, nothing is left of it.
    let strain = (last.slip - last.load / AREA * LENGTHS[0] / REST) / LENGTHS[1];
    approx::assert_abs_diff_eq!(last.load / AREA, stress(strain), epsilon = 0.02);
}

/// A bar whose damage lags by one increment carries more than its strength; the smaller the increments, the smaller the
/// excess.
#[test]
fn extrapolated_damage_passes_a_snap_back_without_turning_and_books_what_it_takes() {
    let properties = [("E", MODULUS), ("nu", 0.0), ("A_t", SCALE), ("B_t", EXPONENT), ("Y_t0", THRESHOLD)];
    let peak = (1..4000).map(|k| AREA * stress(1e-7 * f64::from(k))).fold(0.0, f64::max);
    let overshoots = [1.0, 0.25, 0.0625].map(|fraction| {
        let mut model = bar();
        model.laws[1] = PluginLaw::shipped("concrete_damage_implex", &properties);
        let (initial, maximum) = (0.02 * fraction, 0.05 * fraction);
        model.steps[0].control = StepControl::Automatic { initial, maximum, minimum: 1e-8 };
        let (records, statistics) = run(&model);
        assert!(records.windows(2).all(|pair| pair[1].slip > pair[0].slip));
        assert!(records.iter().all(|record| record.energy_error.abs() < 1e-3));
        assert!(statistics.iterations <= 3 * statistics.increments, "{statistics:?}: increments are nearly linear");
        let last = records.last().unwrap();
        assert_eq!(last.slip, END);
        let strain = (last.slip - last.load / AREA * LENGTHS[0] / REST) / LENGTHS[1];
        approx::assert_abs_diff_eq!(last.load / AREA, stress(strain), epsilon = 0.02);
        let Energies { external_work, elastic, damage, stabilisation, .. } = last.energies;
        assert!(stabilisation > 0.0 && damage > 0.0);
        approx::assert_relative_eq!(damage + stabilisation + elastic, external_work, max_relative = 1e-3);
        records.iter().map(|record| record.load).fold(0.0, f64::max) / peak - 1.0
    });
    assert!(overshoots.windows(2).all(|pair| pair[1] < 0.6 * pair[0]) && overshoots[2] < 0.02, "{overshoots:?}");
}

/// Far from all thresholds. What never loses its stability gets no dashpot.
#[test]
fn stabilisation_adds_the_stress_of_a_dashpot_to_an_elastic_strip_that_may_lose_its_stability() {
    let (modulus, relaxation_time, end) = (1000.0, 0.25, 0.004);
    let elastic = [("E", modulus), ("nu", 0.0)];
    let with = |plugin: &str, more: &[(&str, f64)]| PluginLaw::shipped(plugin, &[&elastic, more].concat());
    let softening = with("pure_damage", &[("A", SCALE), ("B", EXPONENT), ("Y_0", 1e3)]);
    let frictional = [("cohesion", 1e3), ("friction_angle_deg", 30.0), ("dilation_angle_deg", 10.0)];
    let unassociated = with("drucker_prager", &frictional);
    let cases = [
        (softening.clone(), false, 1.0),
        (softening, true, 1.0),
        (unassociated, false, 1.0),
        (with("linear_elastic", &[]), false, 0.0),
    ];
    for (law, nlgeom, viscous) in cases {
        let name = format!("{}, nlgeom {nlgeom}", law.law.as_ref().map_or("", |law| &law.name));
        let mut model = strip(law, PlaneModel::PlaneStrain, end, StepControl::Fixed { increments: 5 });
        model.controls.relaxation_time = relaxation_time;
        model.nlgeom.fill(nlgeom);
        let (records, _) = run(&model);
        let rate = end / 4.0;
        let tolerance = if nlgeom { 5e-3 } else { 1e-9 };
        for record in &records[1..] {
            let expected = AREA * modulus * (record.slip / 4.0 + viscous * relaxation_time * rate);
            assert!((record.load - expected).abs() <= tolerance * expected, "{name}: {} for {expected}", record.load);
            // The stress appears within the first increment: half of it on the mean.
            let spent = viscous * relaxation_time * modulus * rate * rate * (record.time - 0.1) * AREA * 4.0;
            assert!(record.energy_error.abs() < 1e-3, "{name}: {:e}", record.energy_error);
            approx::assert_relative_eq!(record.energies.stabilisation, spent, max_relative = tolerance);
        }
    }
}

/// Where the drives cannot go on, a fibre whose brittle bond fails at once goes through drag to the equilibrium that indirect control
/// comes to beyond the turn. What it sets free is the work of the drag; what is dissipated is the same on both ways.
#[test]
fn drag_leads_to_the_equilibrium_beyond_the_turn() {
    let elastic = |modulus, poisson| PluginLaw::shipped("linear_elastic", &[("E", modulus), ("nu", poisson)]);
    // a soft fibre stores much; beyond 0.02 mm its bond falls with the square of the slip
    let bond = bond_with(&[("a_2", 8e-4), ("b_2", -2.0)]);
    let control = StepControl::Automatic { initial: 1e-3, maximum: 0.05, minimum: 1e-9 };
    let mut model = fibre(Configuration::Plane, [elastic(500.0, 0.3), elastic(23.7e3, 0.15)], &bond, 0.6, control);
    let (path, _) = run(&model);
    let turn = path.windows(2).find(|pair| pair[1].slip < pair[0].slip).expect("a turn")[0].slip;
    let after = path.windows(2).rposition(|pair| pair[1].slip < pair[0].slip).expect("a turn");
    let goal = 1.06 * turn;
    let beyond = path[after..].windows(2).find(|pair| pair[0].slip <= goal && goal < pair[1].slip).expect("beyond");
    let share = (goal - beyond[0].slip) / (beyond[1].slip - beyond[0].slip);
    let there = |of: fn(&Record) -> f64| of(&beyond[0]) + share * (of(&beyond[1]) - of(&beyond[0]));
    let expected = there(|record| record.load);
    let peak = path.iter().map(|record| record.load).fold(0.0, f64::max);
    assert!(expected < 0.5 * peak, "{expected} N after {peak} N");

    model.steps[0].targets = vec![Some(0.98 * turn)];
    let mut analysis = Analysis::new(&model).unwrap();
    let mut keeper = Keeper::default();
    analysis.run(&mut keeper).unwrap();
    let onward = Step { targets: vec![Some(goal)], ..model.steps[0].clone() };
    let run = StepRun::new(&onward, &analysis.present.committed.drives, &model).through_drag(peak / (0.1 * turn));
    analysis.step(Position { step: 2, run, increment: 0, step_time: 0.0 }, &mut keeper).unwrap();
    assert!(analysis.statistics().dragged > 0);
    let load = keeper.0.last().expect("increments").load;
    assert!((load - expected).abs() < 1e-3 * peak, "{load} N instead of {expected} N");
    let energies = analysis.present.energies;
    let work = there(|record| record.energies.external_work);
    assert!(energies.imbalance().abs() < 2e-3 * work, "{energies:?}");
    let dissipated = there(|record| record.energies.interface_dissipation());
    let error = energies.interface_dissipation() / dissipated - 1.0;
    assert!(error.abs() < 0.02, "{error:e}: {energies:?}");
    // both ways end in the same state: what this one took more work for was set free
    let free = energies.external_work - work;
    assert!(free > 0.05 * work && (energies.stabilisation / free - 1.0).abs() < 0.05, "{free} N·mm, {energies:?}");
}
