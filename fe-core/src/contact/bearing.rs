//! Crushing of the slave's surface under a pressure above its strength.

use super::history::PointState;
use super::law::{PointLaw, Situation, Tangent};
use crate::assembly::{Setback, USUAL_FRACTION};
use crate::model::Bearing;

/// First crushing as a part of p_b: where plastic flow begins in front of a cylinder in Drucker–Prager concrete
/// (`tests/reference/bearing`).
const FIRST_CRUSHING: f64 = 0.4;
/// Accepted excess of the pressure over the capacity of the surface, as a part of it.
const TOLERANCE: f64 = 1e-11;
/// Iterations for the depth: Newton's method on a convex function.
const ITERATIONS: usize = 30;

impl Bearing {
    /// Returns the pressure that a surface crushed by u_b carries, p_b √(a² + (1 − a²) min(u_b/δ_b, 1)), and its
    /// derivative.
    fn capacity(&self, crushed: f64) -> [f64; 2] {
        if crushed >= self.depth {
            return [self.strength, 0.0];
        }
        let first = FIRST_CRUSHING * FIRST_CRUSHING;
        let root = (first + (1.0 - first) * crushed / self.depth).sqrt();
        [self.strength * root, 0.5 * self.strength * (1.0 - first) / (self.depth * root)]
    }
}

/// Asks the law of a point, and sets its trial state and tangent. The surface is crushed where the law's pressure
/// exceeds its capacity.
///
/// # Errors
/// The law returns an error, or no depth is found.
pub(super) fn advance(
    law: &mut PointLaw,
    bearing: Option<&Bearing>,
    situation: &Situation<'_>,
    end: &mut PointState,
    statev: &mut [f64],
) -> Result<Tangent, Setback> {
    end.crushing = 0.0;
    let mut tangent = law.advance(situation, end, statev)?;
    let Some(bearing) = bearing else { return Ok(tangent) };
    for _ in 0..ITERATIONS {
        let [capacity, slope] = bearing.capacity(situation.start.crushed + end.crushing);
        let excess = end.pressure - capacity;
        if end.crushing == 0.0 && excess <= 0.0 {
            return Ok(tangent);
        }
        let [[by_gap, by_slip], [shear_by_gap, shear_by_slip]] = tangent;
        let stiffness = by_gap + slope;
        if excess.abs() <= TOLERANCE * capacity {
            // p = p(u − u_b, s) stays at the capacity: du_b = (∂p/∂u du + ∂p/∂s ds)/(∂p/∂u + slope)
            let [yields, yields_by_slip] = [by_gap, by_slip].map(|entry| entry / stiffness);
            return Ok([
                [slope * yields, slope * yields_by_slip],
                [shear_by_gap * (1.0 - yields), shear_by_slip - shear_by_gap * yields_by_slip],
            ]);
        }
        if stiffness <= 0.0 {
            break;
        }
        end.crushing += excess / stiffness;
        let moved = Situation { gap: situation.gap + end.crushing, ..*situation };
        tangent = law.advance(&moved, end, statev)?;
    }
    Err(Setback { reason: "no crushed depth carries the pressure".to_owned(), fraction: Some(USUAL_FRACTION) })
}
