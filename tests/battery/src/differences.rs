//! Tangents against differences of the stress.

use super::Point;
use umat_abi::law::{Law, Response};

/// Relative errors below this are those of the differences, not of the tangent: no other step is tried.
const GOOD_DIFFERENCE: f64 = 1e-8;

/// Returns the distance of C·d from central differences of the stress along each of the directions d: the best of
/// several steps, relative to the largest tangent entry. Away from kinks this is rounding plus truncation.
pub fn directional_error<L: Law>(point: &Point<'_, L>, strain: &[f64; 6], directions: &[[f64; 6]]) -> f64 {
    let components = point.stress_state.components();
    let tangent = point.trial(strain).0.tangent;
    let scale = tangent.iter().flatten().fold(0.0_f64, |m, x| m.max(x.abs()));
    let size = strain.iter().fold(1e-30_f64, |m, x| m.max(x.abs()));
    let mut best = f64::INFINITY;
    for relative_step in [1e-5, 1e-4, 1e-6, 1e-7] {
        let h = relative_step * size;
        let mut worst = 0.0_f64;
        for direction in directions {
            let stress_at =
                |factor: f64| point.trial(&std::array::from_fn(|i| strain[i] + factor * h * direction[i])).0.stress;
            let (far_plus, plus, minus, far_minus) = (stress_at(2.0), stress_at(1.0), stress_at(-1.0), stress_at(-2.0));
            for &i in components {
                // fourth-order central difference
                let slope = (8.0 * (plus[i] - minus[i]) - (far_plus[i] - far_minus[i])) / (12.0 * h);
                let expected: f64 = components.iter().map(|&j| tangent[i][j] * direction[j]).sum();
                worst = worst.max((slope - expected).abs());
            }
        }
        // a stress that is exactly constant (the apex of a cone) has nothing to scale by
        best = best.min(if worst == 0.0 { 0.0 } else { worst / scale });
        if best <= GOOD_DIFFERENCE {
            break;
        }
    }
    best
}

/// Returns the distance of C·d from the one-sided differences along d: the better side and the best of several steps.
/// At a kink the tangent must be that of one side.
pub fn one_sided_error<L: Law>(point: &Point<'_, L>, strain: &[f64; 6], direction: &[f64; 6]) -> f64 {
    let components = point.stress_state.components();
    let (response, _) = point.trial(strain);
    let scale = response.tangent.iter().flatten().fold(0.0_f64, |m, x| m.max(x.abs()));
    let size = strain.iter().fold(1e-30_f64, |m, x| m.max(x.abs()));
    let mut best = f64::INFINITY;
    for h in [1e-5, 1e-4, 1e-6, -1e-5, -1e-4, -1e-6].map(|step| step * size) {
        let stress_at =
            |factor: f64| point.trial(&std::array::from_fn(|i| strain[i] + factor * h * direction[i])).0.stress;
        let (one, two, three) = (stress_at(1.0), stress_at(2.0), stress_at(3.0));
        let worst = components.iter().fold(0.0_f64, |worst, &i| {
            // third-order forward difference
            let slope = (-11.0 * response.stress[i] + 18.0 * one[i] - 9.0 * two[i] + 2.0 * three[i]) / (6.0 * h);
            let expected: f64 = components.iter().map(|&j| response.tangent[i][j] * direction[j]).sum();
            worst.max((slope - expected).abs())
        });
        best = best.min(if worst == 0.0 { 0.0 } else { worst / scale });
    }
    best
}

/// Returns whether the tangent itself jumps within the reach of the differences around this strain, so that no
/// difference quotient can be compared with it: by 2 % within that of the longest, or within that of the shorter ones
/// by a quarter of the error of the best of them. (Smooth tangents vary there by some 1e-5, and their differences are
/// right to 1e-6.)
pub fn near_kink<L: Law>(point: &Point<'_, L>, strain: &[f64; 6], error: f64) -> bool {
    let size = strain.iter().fold(0.0_f64, |m, x| m.max(x.abs()));
    let Response { tangent: here, stress, .. } = point.trial(strain).0;
    let scale = here.iter().flatten().fold(0.0_f64, |m, x| m.max(x.abs()));
    let largest_stress = stress.iter().fold(0.0_f64, |m, x| m.max(x.abs()));
    let close = (0.25 * error).min(2e-2);
    point.stress_state.components().iter().any(|&j| {
        [(-2e-4, 2e-2), (-2e-6, close), (2e-6, close), (2e-4, 2e-2)].into_iter().any(|(step, jump)| {
            let mut shifted = *strain;
            shifted[j] += step * size;
            let Response { tangent: there, stress: far, .. } = point.trial(&shifted).0;
            // where the stress itself jumps (model III of the thesis) the tangent has no scale: right there, or
            // within the step by more than the tangents at its ends allow
            let mut neighbour = *strain;
            neighbour[j] += 1e-12 * step.signum() * size;
            let beyond = point.trial(&neighbour).0.stress;
            let largest_there = there.iter().flatten().fold(scale, |m, x| m.max(x.abs()));
            let allowed = 4.0 * largest_there * (step * size).abs();
            stress.iter().zip(&far).any(|(a, b)| (a - b).abs() > allowed)
                || stress.iter().zip(&beyond).any(|(a, b)| (a - b).abs() > 1e-10 * largest_stress)
                || here.iter().flatten().zip(there.iter().flatten()).any(|(a, b)| (a - b).abs() > jump * scale)
        })
    })
}
