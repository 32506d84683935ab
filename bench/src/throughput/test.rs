//! Throughputs are numbers, and those of the same thing.

use super::super::Settings;
use super::super::solid::{Situation, solids};
use super::{batch, cores};
use umat_abi::law::Request;

#[test]
fn batches_of_all_laws_are_those_of_single_calls() {
    let settings = Settings { quick: true, states: None, python: None, plugin_paths: Vec::new() };
    for solid in solids() {
        let library = solid.library(&settings).expect("a plugin that Cargo built");
        for situation in Situation::ALL {
            // it compares every bit before it measures
            let batch = batch::measure(&solid, &library, situation, &settings).expect("the same bits");
            assert!(batch.gain > 0.0 && batch.per_second.is_finite(), "{} {batch:?}", solid.law);
        }
    }
}

#[test]
fn all_cores_make_no_more_than_their_number_allows() {
    let settings = Settings { quick: true, states: None, python: None, plugin_paths: Vec::new() };
    let solid = &solids()[0];
    let library = solid.library(&settings).expect("a plugin that Cargo built");
    let cores = cores::measure(solid, &library, Situation::Elastic, Request::Stress, &settings).expect("a throughput");
    assert!(cores.per_second > 1e4 && cores.all_over_one > 0.0, "{cores:?}");
}
