//! A strip that is dragged out from under a block.

use super::{model, model_of, run_to_end};

/// Load with 200 equal increments, N.
const FINE_LOAD: f64 = 23.91026;

#[test]
fn the_drag_is_the_coefficient_of_friction_times_the_load() {
    let model = model("drag-out-strip", &[]);
    let mut drags = Vec::new();
    run_to_end(&model, |record, _| {
        if record.step == 2 && record.slip >= 0.5 {
            drags.push(record.load);
        }
    });
    println!("drag: {drags:.4?}");
    assert!(drags.len() > 10);
    for drag in drags {
        approx::assert_relative_eq!(drag, 15.0, max_relative = 5e-3);
    }
}

/// CalculiX takes 52 iterations for it, with looser tolerances.
#[test]
fn a_strip_that_slides_under_a_block_takes_few_iterations() {
    let model = model_of("benchmark", "drag-out-strip", &[]);
    let (mut iterations, mut cutbacks) = (0, 0);
    run_to_end(&model, |record, _| {
        iterations += record.iterations.len();
        cutbacks += record.cutbacks;
        if record.step == 2 {
            approx::assert_relative_eq!(record.load, 15.0, max_relative = 1e-3);
        }
    });
    assert_eq!(cutbacks, 0);
    assert!(iterations <= 60, "{iterations} iterations");
}

/// A strip between two curved blocks that press on it and rub. The facets of its sides pass those of the blocks; the load is
/// that of increments of a tenth.
#[test]
fn a_strip_slides_through_a_curved_channel() {
    let model = model("curved-strip", &[]);
    let (mut increments, mut cutbacks, mut load) = (0, 0, 0.0);
    run_to_end(&model, |record, _| {
        increments += 1;
        cutbacks += record.cutbacks;
        load = record.load;
    });
    println!("{increments} increments, {cutbacks} cut-backs, load {load:.5}");
    assert!(increments <= 100, "{increments} increments");
    assert!(cutbacks <= 20, "{cutbacks} cut-backs");
    approx::assert_relative_eq!(load, FINE_LOAD, max_relative = 1e-5);
}
