//! From energy release rate to damage, and what that damage dissipates when Y is its force.

use super::Branch;
use crate::damage_law::{DamageLaw, damage, integrity};

/// Relative growth of Y − Y₀ up to which the Hermite rule of [`Softening::dissipation`] is exact to
/// rounding: its error is of the order 7e-3 · growth⁶.
const HERMITE_REACH: f64 = 0.01;

/// One branch's D(Y).
#[derive(Clone, Copy, Debug)]
pub(super) struct Softening {
    /// D̂(Y).
    pub law: DamageLaw,
}

impl Softening {
    /// η and dD/dY at an energy release rate.
    #[inline]
    pub fn damage(&self, energy: f64) -> (f64, f64) {
        let eta = self.law.eta(energy);
        (eta, self.law.damage_rate(energy, eta))
    }

    /// ∫ Y dD between two points of the curve (thesis eq. 4.14 with Y as the force).
    #[inline]
    pub fn dissipation(&self, start: &Branch, end: &Branch) -> f64 {
        let excess = start.maximum - self.law.threshold;
        if start.eta > 0.0 && end.maximum - start.maximum <= HERMITE_REACH * excess {
            return self.short_dissipation(start, end);
        }
        self.law.dissipation(end.eta) - self.law.dissipation(start.eta)
    }

    /// ∫ Y dD = ½ (Y_0 + Y_1) ΔD + h²/10 (D'_1 − D'_0) − h³/120 (D''_0 + D''_1): integration by parts and
    /// the two-point Hermite rule for ∫ D dY, with D'' = D' (B − 1 − 2 B D)/(Y − Y₀).
    fn short_dissipation(&self, start: &Branch, end: &Branch) -> f64 {
        let step = end.maximum - start.maximum;
        let growth = (end.eta - start.eta) * integrity(end.eta) * integrity(start.eta);
        let slopes = |branch: &Branch| {
            let first = self.law.damage_rate(branch.maximum, branch.eta);
            let excess = branch.maximum - self.law.threshold;
            (first, first * (self.law.b - 1.0 - 2.0 * self.law.b * damage(branch.eta)) / excess)
        };
        let ((first_0, second_0), (first_1, second_1)) = (slopes(start), slopes(end));
        0.5 * (start.maximum + end.maximum) * growth
            + step * step * ((first_1 - first_0) / 10.0 - step * (second_0 + second_1) / 120.0)
    }
}
