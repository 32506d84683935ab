//! Coulomb friction of a point as a spring with a slider: traction k_f (g − g_s), at most μ⟨p − p_ref⟩
//! (doc.md "snubbing", law 2), and the return to a disc that all tangential laws share.

use super::tangential::{Contribution, Matrix, Slip, Vector, difference, dot, norm, scaled, scaled_identity};

/// Rounding of a slip, and of an elastic traction k |g|: within it of the limit counts as sliding, and of κ as loading,
/// so that a converged sliding point keeps its sliding tangent when it is evaluated again.
pub(super) const ROUNDING: f64 = 4.0 * f64::EPSILON;

/// A vector brought back to a disc about the origin.
#[derive(Clone, Copy, Debug)]
pub(super) struct Returned {
    /// The nearest vector of the disc.
    pub vector: Vector,
    /// Derivative by the trial vector.
    pub by_trial: Matrix,
    /// Derivative by the radius.
    pub by_radius: Vector,
    /// Whether the disc's edge is reached.
    pub slides: bool,
}

/// The nearest vector of the disc of this radius; `tolerance`: rounding of the trial vector.
#[inline]
pub(super) fn return_to_disc(trial: Vector, radius: f64, tolerance: f64) -> Returned {
    let length = norm(trial);
    if length < radius - tolerance || (length == 0.0 && radius > 0.0) {
        return Returned { vector: trial, by_trial: scaled_identity(1.0), by_radius: [0.0; 2], slides: false };
    }
    let direction = if length > 0.0 { scaled(trial, 1.0 / length) } else { [0.0; 2] };
    let [x, y] = direction;
    let turn = if length > 0.0 { radius / length } else { 0.0 };
    Returned {
        vector: scaled(direction, radius),
        by_trial: [[turn * y * y, -turn * x * y], [-turn * x * y, turn * x * x]],
        by_radius: direction,
        slides: true,
    }
}

/// Friction spring and slider.
#[derive(Clone, Copy, Debug)]
pub struct Friction {
    /// k_f, MPa/mm.
    pub stiffness: f64,
    /// μ.
    pub coefficient: f64,
    /// p_ref, MPa: the pressure that rubs nothing (that of the soft normal law at zero gap).
    pub reference_pressure: f64,
}

impl Friction {
    /// μ⟨p − p_ref⟩ and its derivative by p.
    #[inline]
    pub fn limit(&self, pressure: f64) -> (f64, f64) {
        let effective = pressure - self.reference_pressure;
        if effective > 0.0 { (self.coefficient * effective, self.coefficient) } else { (0.0, 0.0) }
    }

    /// Advances the slider.
    #[inline]
    pub(super) fn advance(&self, slip: &Slip, pressure: f64, slider: &mut Vector) -> Contribution {
        let k = self.stiffness;
        let (limit, limit_slope) = self.limit(pressure);
        let trial = scaled(difference(slip.end, *slider), k);
        let tolerance = ROUNDING * k * (norm(slip.end) + norm(*slider));
        let returned = return_to_disc(trial, limit, tolerance);
        let traction_before = scaled(difference(slip.start, *slider), k);
        let before = *slider;
        if returned.slides {
            *slider = difference(slip.end, scaled(returned.vector, 1.0 / k));
        }
        // trapezoid of the friction's power; never negative by more than a coarse reversal's error
        let mean = [0, 1].map(|i| 0.5 * (traction_before[i] + returned.vector[i]));
        Contribution {
            traction: returned.vector,
            slip_tangent: returned.by_trial.map(|row| scaled(row, k)),
            pressure_tangent: scaled(returned.by_radius, limit_slope),
            stored_energy: 0.5 * dot(returned.vector, returned.vector) / k,
            dissipation: dot(mean, difference(*slider, before)).max(0.0),
            ..Contribution::default()
        }
    }
}
