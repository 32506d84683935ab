//! Proportional paths: the stress at their end.

use super::{Sample, worst};
use umat_abi::law::{Law, StressState};

/// The stress at the end of a proportional path that stops at these fractions of the strain.
pub fn stress_after<L: Law>(
    sample: &Sample<'_>,
    stress_state: StressState,
    strain: &[f64; 6],
    fractions: impl Iterator<Item = f64>,
) -> [f64; 6] {
    let mut point = sample.point::<L>(stress_state);
    for fraction in fractions {
        point.advance(&strain.map(|x| fraction * x));
    }
    point.stress
}

/// The fractions of equal increments.
pub fn equal(count: u32) -> impl Iterator<Item = f64> {
    (1..=count).map(move |step| f64::from(step) / f64::from(count))
}

/// Returns the deviation of a stress from the expected one, relative to the largest component.
pub fn deviation(stress: &[f64; 6], expected: &[f64; 6]) -> f64 {
    let largest = expected.iter().fold(0.0_f64, |m, x| m.max(x.abs()));
    let error = |i: usize| if stress[i] == expected[i] { 0.0 } else { (stress[i] - expected[i]).abs() / largest };
    worst((0..6).map(error))
}
