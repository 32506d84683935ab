//! The number of threads changes no bit.

use super::skipping::plate;
use super::*;
use crate::threads::Threads;
use std::num::NonZeroUsize;
use umat_abi::law::Request;

/// Returns the results of a run with so many threads: loads, energies, displacements, and its cost.
fn outcome(model: &Model, threads: usize) -> (Vec<f64>, Vec<Energies>, Vec<f64>, AnalysisStatistics) {
    struct Keeper(Vec<f64>, Vec<Energies>);
    impl IncrementObserver for Keeper {
        fn increment(&mut self, record: &Record, _: &Snapshot<'_>) -> io::Result<Directive> {
            self.0.push(record.load);
            self.1.push(record.energies);
            Ok(Directive::GoOn)
        }
    }
    let mut keeper = Keeper(Vec::new(), Vec::new());
    let mut analysis = Analysis::new(model).unwrap();
    analysis.set_threads(Threads::new(NonZeroUsize::new(threads).unwrap()).unwrap());
    analysis.run(&mut keeper).unwrap();
    let displacements = analysis.snapshot().displacements().to_vec();
    (keeper.0, keeper.1, displacements, analysis.statistics())
}

#[test]
fn a_plate_in_plastic_flow_has_the_same_bits_with_any_number_of_threads() {
    for (cells, nlgeom) in [(2048, false), (512, true)] {
        let model = plate(cells, nlgeom);
        let one = outcome(&model, 1);
        for threads in [2, 3] {
            assert!(outcome(&model, threads) == one, "{threads} threads, {cells} cells, nlgeom {nlgeom}");
        }
    }
}

#[test]
fn the_first_failing_element_is_reported_by_any_number_of_threads() {
    let model = plate(512, true);
    let mut displacements = vec![0.0; 2 * model.mesh.nodes().len()];
    // turned inside out on both sides of a line, in many blocks
    for (node, [x, y]) in model.mesh.nodes().iter().enumerate() {
        displacements[2 * node] = if *y > 5.0 { -2.0 * x } else { 0.0 };
    }
    let context = IncrementContext { step: 1, increment: 1, iteration: 1, ..IncrementContext::default() };
    let trouble = |threads: usize| {
        let mut solids = Solids::new(&model).unwrap();
        solids.set_threads(&Threads::new(NonZeroUsize::new(threads).unwrap()).unwrap());
        let mut forces = vec![0.0; displacements.len()];
        let trouble = solids.evaluate(&displacements, &context, Request::Stress, &mut forces).unwrap_err();
        (format!("{:?}", trouble.place), solids.counters())
    };
    let one = trouble(1);
    for threads in [2, 3, 4] {
        assert_eq!(trouble(threads), one, "{threads} threads");
    }
}

/// Two parts would be two threads' work: their libraries may share what only one of them may touch.
#[test]
fn a_law_that_does_not_say_that_it_is_thread_safe_is_called_by_one_thread() {
    let mut model = plate(512, false);
    let threads = Threads::new(NonZeroUsize::new(3).unwrap()).unwrap();
    let count = |model: &Model| {
        let mut solids = Solids::new(model).unwrap();
        solids.set_threads(&threads);
        solids.thread_count()
    };
    assert_eq!(count(&model), 3);
    model.laws[0].plugin.law = None;
    assert_eq!(count(&model), 1);
}
