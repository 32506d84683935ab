//! Runs that repeat the increments of others.

use super::{Keeper, snap_back};
use crate::kinematics::PlaneModel;
use crate::mesh::{ElementDefinition, Mesh, MeshDefinition};
use crate::model::{Model, PluginLaw, StepControl};
use crate::stepping::{
    Along, Analysis, AnalysisStatistics, AttemptVerdict, LeadingQuantity, Record, Recorded, RunError, Trail, Tried,
};
use std::sync::Arc;

fn recorded(records: &[Record]) -> Recorded {
    let mut recorded = Recorded::default();
    for record in records.iter().filter(|record| record.step > 0) {
        recorded.push(record.step, record.tried.clone());
    }
    assert_eq!(recorded.mistake(), None);
    recorded
}

fn repeat(model: &Model, recorded: &Recorded) -> Result<Vec<Record>, RunError> {
    let mut analysis = Analysis::new(model).unwrap();
    analysis.repeat(recorded.clone());
    let mut keeper = Keeper::default();
    analysis.run(&mut keeper).map(|()| keeper.0)
}

/// An element that fails snaps back, and dissipation leads; refused attempts and all.
#[test]
fn a_repeated_run_has_the_same_bits_through_a_snap_back() {
    let model = snap_back::bar();
    let (base, _) = super::run(&model);
    let recorded = recorded(&base);
    let all = || recorded.steps.iter().flatten().flatten();
    assert!(all().any(|tried| matches!(tried.to, LeadingQuantity::Dissipation(_))));
    assert!(all().any(|tried| tried.verdict == AttemptVerdict::Refused));
    let again = repeat(&model, &recorded).unwrap();
    assert_eq!(format!("{again:?}"), format!("{base:?}"));
}

#[test]
fn an_increment_that_does_not_converge_is_not_replaced_by_others() {
    let model = snap_back::bar();
    let (base, _) = super::run(&model);
    let mut recorded = recorded(&base);
    // from the elastic branch to the end at once
    let last = recorded.steps[0].len() - 1;
    recorded.steps[0].drain(1..last);
    let jump =
        Tried { to: LeadingQuantity::Dissipation(1e3), time: 0.1, verdict: AttemptVerdict::Stands, imbalanced: None };
    recorded.steps[0][1] = vec![jump];
    let message = repeat(&model, &recorded).unwrap_err().to_string();
    assert!(message.contains("increment 2") && message.contains("repeated as it is"), "{message}");
}

/// Returns the rows of a run with its states.
fn with_trail(model: &Model) -> (Vec<Record>, Arc<Trail>) {
    let mut analysis = Analysis::new(model).unwrap();
    analysis.keep_trail();
    let mut keeper = Keeper::default();
    analysis.run(&mut keeper).unwrap();
    (keeper.0, Arc::new(analysis.take_trail().unwrap()))
}

/// Returns the loads of a run parallel to another one, and its iterations.
fn parallel(model: &Model, trail: &Arc<Trail>) -> (Vec<f64>, u64) {
    let (loads, statistics) = go(model, &Arc::clone(trail).into());
    (loads, statistics.iterations)
}

fn go(model: &Model, along: &Along) -> (Vec<f64>, AnalysisStatistics) {
    let (records, statistics) = follow(model, along);
    (records.iter().map(|record| record.load).collect(), statistics)
}

fn follow(model: &Model, along: &Along) -> (Vec<Record>, AnalysisStatistics) {
    let mut analysis = Analysis::new(model).unwrap();
    analysis.follow(along);
    let mut keeper = Keeper::default();
    analysis.run(&mut keeper).unwrap();
    (keeper.0, analysis.statistics())
}

/// The load of an element that fails through a snap-back, by its strength: differences of runs along the states of the first,
/// against those of runs that repeat its increments with smaller tolerances.
#[test]
fn derivatives_along_a_trail_are_those_between_exact_equilibria() {
    let model = snap_back::bar();
    let (base, trail) = with_trail(&model);
    assert_eq!(trail.recorded.steps[0].len(), base.len() - 1);
    assert!(trail.recorded.steps[0].iter().all(|attempts| attempts.len() == 1), "what was refused is left out");
    let loads: Vec<f64> = base.iter().map(|record| record.load).collect();
    let (same, iterations) = parallel(&model, &trail);
    assert!(iterations < 5, "{iterations}: sums of displacements are rounded, else nothing is to be corrected");
    for (same, load) in same.iter().zip(&loads) {
        approx::assert_relative_eq!(same, load, max_relative = 1e-12);
    }
    let scaled = |factor: f64| snap_back::bar_of(factor * snap_back::THRESHOLD);
    let step = 1e-6;
    let slopes = |loads: &dyn Fn(f64) -> Vec<f64>| -> Vec<f64> {
        let both = loads(1.0 + step).into_iter().zip(loads(1.0 - step));
        both.map(|(more, less)| (more - less) / (2.0 * step)).collect()
    };
    let along = slopes(&|factor| {
        let (loads, iterations) = parallel(&scaled(factor), &trail);
        assert!(iterations < base.len() as u64, "{iterations} iterations in {} increments", base.len() - 1);
        loads
    });
    let between = slopes(&|factor| {
        let mut model = scaled(factor);
        model.controls.force_tolerance = 1e-11;
        model.controls.displacement_tolerance = 1e-11;
        repeat(&model, &trail.recorded).unwrap().iter().map(|record| record.load).collect()
    });
    let greatest = between.iter().fold(0.0_f64, |greatest, slope| greatest.max(slope.abs()));
    for (along, between) in along.iter().zip(&between) {
        approx::assert_abs_diff_eq!(along, between, epsilon = 1e-4 * greatest);
    }
}

#[test]
fn runs_that_share_factors_come_to_the_derivatives_of_each_alone() {
    let (base, trail) = with_trail(&snap_back::bar());
    let steps = [1e-6, -1e-6, 2e-6];
    let slopes = |loads: &[f64], step: f64| -> Vec<f64> {
        loads.iter().zip(&base).map(|(load, record)| (load - record.load) / step).collect()
    };
    let scaled = |step: f64| snap_back::bar_of((1.0 + step) * snap_back::THRESHOLD);
    let alone = steps.map(|step| slopes(&parallel(&scaled(step), &trail).0, step));
    let greatest = alone[0].iter().fold(0.0_f64, |greatest, slope| greatest.max(slope.abs()));
    // none, or one of them is given up before it begins
    for without in [None, Some(1)] {
        let members = Along::together(&trail, steps.len());
        std::thread::scope(|scope| {
            let begin = |(number, along): (usize, Along)| {
                let begun = without != Some(number);
                begun.then(|| (number, scope.spawn(move || go(&scaled(steps[number]), &along))))
            };
            let runs: Vec<_> = members.into_iter().enumerate().filter_map(begin).collect();
            for (number, run) in runs {
                let (loads, statistics) = run.join().unwrap();
                for (shared, alone) in slopes(&loads, steps[number]).iter().zip(&alone[number]) {
                    approx::assert_abs_diff_eq!(shared, alone, epsilon = 1e-4 * greatest);
                }
                let factors = statistics.factorisations + statistics.block_factorisations;
                let makes_factors = number == 0 || without.is_some();
                let many = factors > base.len() as u64 / 2;
                assert_eq!(many, makes_factors, "run {number} without {without:?}: {factors} in {}", base.len() - 1);
            }
        });
    }
}

#[test]
fn a_run_on_another_mesh_repeats_the_increments() {
    let law = PluginLaw::shipped("linear_elastic", &[("E", 1000.0), ("nu", 0.0)]);
    let model = super::strip(law, PlaneModel::PlaneStress, 0.04, StepControl::Fixed { increments: 2 });
    let (base, trail) = with_trail(&model);
    // its lower row of elements, whose nodes come first
    let mut half = model.clone();
    let elements = model.mesh.elements()[..4].iter();
    let elements = elements.map(|element| ElementDefinition {
        kind: element.kind(),
        part: element.part(),
        nodes: element.nodes().to_vec(),
    });
    half.mesh = Mesh::new(MeshDefinition {
        nodes: model.mesh.nodes()[..23].to_vec(),
        parts: model.mesh.parts().to_vec(),
        elements: elements.collect(),
        ..MeshDefinition::default()
    })
    .unwrap();
    half.supports.iter_mut().for_each(|support| support.nodes.retain(|node| *node < 23));
    let (loads, _) = parallel(&half, &trail);
    approx::assert_relative_eq!(loads[2], 0.5 * base[2].load, max_relative = 1e-9);
}

/// Derivatives by where a step leads and by how long it takes, through a snap-back: along a trail, and between runs on the same increments
/// with smaller tolerances.
#[test]
fn runs_along_a_trail_go_where_their_own_steps_lead() {
    let model = snap_back::bar();
    let (base, trail) = with_trail(&model);
    let step = 1e-6;
    let changed = |factor: f64, time: f64| {
        let mut model = model.clone();
        model.steps.iter_mut().for_each(|step| step.time *= time);
        model.steps.iter_mut().flat_map(|step| &mut step.targets).flatten().for_each(|target| *target *= factor);
        model
    };
    let longer = changed(1.0, 1.5);
    let end = |records: &[Record]| records.last().unwrap().time;
    let repeated = repeat(&longer, &trail.recorded).unwrap();
    for records in [repeated, follow(&longer, &Arc::clone(&trail).into()).0] {
        approx::assert_relative_eq!(end(&records), 1.5 * end(&base), max_relative = 1e-12);
    }
    let farther = changed(1.0 + step, 1.0);
    let (loads, _) = parallel(&farther, &trail);
    let tight = |mut model: Model| {
        model.controls.force_tolerance = 1e-11;
        model.controls.displacement_tolerance = 1e-11;
        repeat(&model, &trail.recorded).unwrap()
    };
    let (more, less) = (tight(farther), tight(model.clone()));
    let between: Vec<f64> = more.iter().zip(&less).map(|(more, less)| (more.load - less.load) / step).collect();
    let greatest = between.iter().fold(0.0_f64, |greatest, slope| greatest.max(slope.abs()));
    assert!(greatest > 0.1 * base.iter().fold(0.0, |greatest: f64, record| greatest.max(record.load)));
    for ((load, record), between) in loads.iter().zip(&base).zip(&between) {
        approx::assert_abs_diff_eq!((load - record.load) / step, between, epsilon = 1e-4 * greatest);
    }
}

#[test]
fn a_run_with_other_increments_goes_its_own_way() {
    let law = PluginLaw::shipped("linear_elastic", &[("E", 1000.0), ("nu", 0.0)]);
    let strip =
        |increments| super::strip(law.clone(), PlaneModel::PlaneStress, 0.04, StepControl::Fixed { increments });
    let (_, trail) = with_trail(&strip(2));
    assert_eq!(parallel(&strip(4), &trail).0.len(), 5);
    let mut longer = strip(2);
    longer.steps.push(longer.steps[0].clone());
    assert_eq!(parallel(&longer, &trail).0.len(), 5);
}
