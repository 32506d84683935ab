//! Plane stress: the ε33 that makes σ33 = 0 (doc.md).
//!
//! Direction 3 is principal and stays so, hence the search needs one in-plane decomposition only.

use super::Parameters;
use super::evolution::{Evolution, History};
use crate::tensor::Spectral;

/// Newton takes 3–8 steps, bisection at most about 60 to exhaust the digits.
const MAX_ITERATIONS: usize = 120;
/// Number of steps from which on every second one halves the bracket, and the search for one takes its full reach.
const SLOW: usize = 12;
/// σ33 within so many roundings of its own terms counts as 0. The test is on σ33, not on the step, so
/// that a solution passes again from the committed state, when damage and the slope no longer grow.
const ROUNDINGS: f64 = 4.0;
/// Factor by which the largest step grows while no bracket is known.
const EXPANSION: f64 = 1.3;

/// A point with σ33 = 0.
pub(super) struct Solution {
    /// ε33 − ε_p33.
    pub strain_33: f64,
    /// The axes of the trial strain with that ε33.
    pub axes: Spectral,
    /// Position of direction 3 among the axes.
    pub normal: usize,
    /// The response there.
    pub evolution: Evolution,
}

/// The in-plane axes, into which any ε33 can be sorted.
struct Plane {
    values: [f64; 2],
    directions: [[f64; 3]; 2],
}

impl Plane {
    fn new(strain: &[f64; 6]) -> Self {
        let [e11, e22, _, e12, _, _] = *strain;
        // a value between the others or not: direction 3 is the one whose third component is ±1
        let axes = Spectral::of_strain(&[e11, e22, 0.0, e12, 0.0, 0.0]);
        let normal = (0..3).find(|&i| axes.directions[i][2] != 0.0).unwrap_or(2);
        let [i, j] = [[1, 2], [0, 2], [0, 1]][normal];
        Self { values: [axes.values[i], axes.values[j]], directions: [axes.directions[i], axes.directions[j]] }
    }

    fn axes(&self, strain_33: f64) -> (Spectral, usize) {
        let [p, q] = self.values;
        let [a, b] = self.directions;
        let normal = [0.0, 0.0, 1.0];
        if strain_33 > p {
            (Spectral { values: [strain_33, p, q], directions: [normal, a, b] }, 0)
        } else if strain_33 > q {
            (Spectral { values: [p, strain_33, q], directions: [a, normal, b] }, 1)
        } else {
            (Spectral { values: [p, q, strain_33], directions: [a, b, normal] }, 2)
        }
    }
}

/// A point of the bracket when Newton's step leaves it. The sides of a cracked solid open at ε33 = 0 and
/// the root of a fully cracked one may be 1e-100 away from there, so 0 and its neighbourhood come first.
fn inside(below: f64, above: f64) -> f64 {
    if below < 0.0 && above > 0.0 {
        0.0
    } else if below == 0.0 || above == 0.0 {
        f64::EPSILON * (below + above)
    } else if below / above > 4.0 || above / below > 4.0 {
        // of one sign: halves the decades between them
        below.signum() * (below.abs().sqrt() * above.abs().sqrt())
    } else {
        0.5 * (below + above)
    }
}

/// Finds ε33 by Newton's method inside a shrinking bracket, from `guess`; `None` if σ33 has no zero
/// within reach.
///
/// σ33 does not decrease with ε33 at fixed damage; growth of damage can only bend it. Until both signs
/// have been seen the steps may grow by [`EXPANSION`] at most, so that the root nearest the guess is
/// taken.
pub(super) fn solve(
    parameters: &Parameters,
    evolve: impl Fn(&[f64; 3]) -> Evolution,
    history: &History,
    strain: &[f64; 6],
    elastic: f64,
    guess: f64,
) -> Option<Solution> {
    let plane = Plane::new(strain);
    let at = |strain_33: f64| {
        let (axes, normal) = plane.axes(strain_33);
        let evolution = evolve(&axes.values);
        Solution { strain_33, axes, normal, evolution }
    };
    let undamaged = history.is_undamaged();
    let size = plane.values[0].abs().max(plane.values[1].abs());
    // |ε33| ≤ 2 max|ε| at frozen damage, whatever ν. A guess from a much larger strain is farther away than
    // halving can come back from.
    let guess = guess.max(-2.0 * size).min(2.0 * size);
    let mut point = at(if undamaged { elastic } else { guess });
    if undamaged && point.evolution.history.is_undamaged() {
        return Some(point);
    }
    let (mut below, mut above) = (f64::NEG_INFINITY, f64::INFINITY);
    let mut reach = 0.1 * size.max(point.strain_33.abs());
    for iteration in 0..MAX_ITERATIONS {
        let residual = point.evolution.solid.stress[point.normal];
        if residual.abs() <= ROUNDINGS * point.evolution.solid.rounding() {
            return Some(point);
        }
        let z = point.strain_33;
        if residual < 0.0 {
            below = z
        } else {
            above = z
        }
        let slope = point.evolution.tangent(parameters).0[point.normal][point.normal];
        let newton = z - residual / slope;
        let bracketed = below.is_finite() && above.is_finite();
        let next = if bracketed {
            let slow = iteration > SLOW && iteration % 2 == 0;
            if newton > below && newton < above && !slow { newton } else { inside(below, above) }
        } else {
            let step = if slope > 0.0 && iteration <= SLOW { (residual / slope).abs().min(reach) } else { reach };
            reach *= EXPANSION;
            if residual < 0.0 { z + step } else { z - step }
        };
        if next == z || next == below || next == above {
            // the bracket has no number between its ends: as good as the digits allow
            return Some(point);
        }
        if !next.is_finite() {
            return None;
        }
        point = at(next);
    }
    None
}

/// Least |C_33| relative to the largest |C_3j|: smaller ones are replaced by it, since growth of damage makes C_33 pass 0.
const LEAST_PIVOT: f64 = 1e-12;

/// Returns C_33 of its row, or the least that replaces it.
pub(super) fn pivot(row: &[f64; 3], normal: usize) -> f64 {
    let least = LEAST_PIVOT * row.iter().fold(0.0_f64, |largest, c| largest.max(c.abs()));
    // a row of zeros: σ33 is 0 whatever ε33
    row[normal].abs().max(least).max(f64::MIN_POSITIVE).copysign(row[normal])
}

/// Returns C_ab − C_a3 C_3b/C_33 in principal axes; the shears out of the plane vanish.
///
/// The row of an open direction is small as a whole, of the order (1 − D_t) E: C_3b/C_33 = −∂ε33/∂ε_b is right however
/// small C_33 is, and C_a3, which the growth of damage fills, need not be small.
pub(super) fn condense((tangent, shear): ([[f64; 3]; 3], [f64; 3]), normal: usize) -> ([[f64; 3]; 3], [f64; 3]) {
    let row = &tangent[normal];
    let pivot = pivot(row, normal);
    let condensed = std::array::from_fn(|i| {
        std::array::from_fn(|j| {
            if i == normal || j == normal { 0.0 } else { tangent[i][j] - tangent[i][normal] * row[j] / pivot }
        })
    });
    // d_12, d_13, d_23: only the pair without the normal remains
    let kept = [2, 1, 0][normal];
    (condensed, std::array::from_fn(|pair| if pair == kept { shear[pair] } else { 0.0 }))
}
