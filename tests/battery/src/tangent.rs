//! Tangents of random states against differences.

use super::differences::{directional_error, near_kink};
use super::{Point, Random, STRESS_STATES, Sample};
use umat_abi::law::{Law, StressState};

/// Returns the largest error of the columns of the tangent against differences.
pub fn tangent_error<L: Law>(point: &Point<'_, L>, strain: &[f64; 6]) -> f64 {
    let unit = |j: usize| std::array::from_fn(|i| if i == j { 1.0 } else { 0.0 });
    let columns: [[f64; 6]; 6] = std::array::from_fn(|k| unit(*point.stress_state.components().get(k).unwrap_or(&0)));
    directional_error(point, strain, &columns[..point.stress_state.components().len()])
}

/// Result of comparing the tangents of random states with differences.
#[derive(Clone, Copy, Debug, Default)]
pub struct TangentSummary {
    pub tried: usize,
    /// Number of those at kinks: the tangent itself jumps within the reach of the differences.
    pub excluded: usize,
    /// Greatest error of the others.
    pub worst: f64,
}

/// States of each stress state whose tangent is compared: the acceptance asks for 10 000.
const TANGENT_STATES: usize = 10_000;

/// Compares the tangents of 10 000 random states of each stress state, spread over the samples, with differences; prints a row each.
pub fn check_tangents<L: Law>(label: &str, samples: &[Sample<'_>]) {
    for stress_state in STRESS_STATES {
        let mut sum = TangentSummary::default();
        for sample in samples {
            let one = check_tangent::<L>(sample, stress_state, TANGENT_STATES.div_ceil(samples.len()));
            sum.tried += one.tried;
            sum.excluded += one.excluded;
            sum.worst = sum.worst.max(one.worst);
        }
        let name = format!("{} {label}", L::INFO.name.to_string_lossy());
        println!(
            "tangent | {name:<38} | {:<25} | {:>6} states | {:>3} at kinks | worst {:.1e}",
            format!("{stress_state:?}"),
            sum.tried,
            sum.excluded,
            sum.worst
        );
    }
}

/// Random two-leg histories. Fails if a smooth state's tangent disagrees with differences, or if more than 5 % are
/// excluded.
pub fn check_tangent<L: Law>(sample: &Sample<'_>, stress_state: StressState, count: usize) -> TangentSummary {
    let mut random = Random::new(0x5EED);
    let mut summary = TangentSummary { tried: count, ..TangentSummary::default() };
    for number in 0..count {
        let mut point = sample.point::<L>(stress_state);
        let first = sample.strain(&mut random, stress_state);
        if random.unit() < 0.7 {
            point.advance(&first);
        }
        let strain = sample.strain(&mut random, stress_state);
        let error = tangent_error(&point, &strain);
        if error <= 1e-6 {
            summary.worst = summary.worst.max(error);
        } else if near_kink(&point, &strain, error) {
            summary.excluded += 1;
        } else {
            panic!(
                "{}: state {number}: tangent error {error:e} at {strain:?} from {:?}",
                L::INFO.name.to_string_lossy(),
                point.state
            );
        }
    }
    assert!(summary.excluded * 20 <= count, "{} of {count} states excluded as kinks", summary.excluded);
    summary
}
