//! Errors of stresses, and how fast they fall.

use super::path::Components;
use crate::slope::exponent;

/// Rounding error that is accepted for an exact result, relative to the largest stress of a path: a good implementation in
/// double precision is this close to a result with 40 digits.
pub const ROUND_OFF: f64 = 1e-13;

/// The largest entry.
pub fn largest(stresses: &[Components]) -> f64 {
    stresses.iter().flatten().fold(0.0, |largest: f64, stress| largest.max(stress.abs()))
}

/// max |σ − σ_ref|/`scale` over a path; the reference has a multiple of its increments. NaN counts as infinite.
pub fn error(stresses: &[Components], reference: &[Components], scale: f64) -> f64 {
    let stride = reference.len() / stresses.len();
    let mut worst = 0.0_f64;
    for (i, stress) in stresses.iter().enumerate() {
        let exact = &reference[(i + 1) * stride - 1];
        for k in 0..6 {
            let difference = (stress[k] - exact[k]).abs();
            worst = if difference.is_nan() { f64::INFINITY } else { worst.max(difference) };
        }
    }
    worst / scale
}

/// The power of 1/N with which errors fall: the slope of a straight line through them, both logarithmic. `None` if fewer
/// than three of them are above rounding and small enough to be errors of the method.
pub fn order(errors: &[(usize, f64)]) -> Option<f64> {
    let counts = errors.iter().filter(|(_, error)| (100.0 * ROUND_OFF..0.1).contains(error));
    let points: Vec<(f64, f64)> = counts.map(|&(n, error)| (n as f64, error)).collect();
    if points.len() < 3 { None } else { exponent(&points).map(|power| -power) }
}
