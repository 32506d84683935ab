//! From energy release rate to damage, and what that damage dissipates in uniaxial stress.

use super::Branch;
use super::crack_band::{CrackBand, Stretch, Stretched};
use super::uniaxial::Uniaxial;
use crate::damage_law::integrity;

/// Relative growth of Y − Y₀ up to which the Hermite rule of sixth order is exact to rounding: its
/// error is of the order 7e-3 · growth⁶.
const SIXTH_ORDER_REACH: f64 = 0.01;
/// The same for the rule of fourth order, error about growth⁴/36.
const FOURTH_ORDER_REACH: f64 = 1e-3;

/// One branch's D(Y): D̂, stretched beyond the peak if there is a crack band.
#[derive(Clone, Copy, Debug)]
pub(super) struct Softening {
    /// The branch in uniaxial stress.
    pub curve: Uniaxial,
    /// The crack band, if any.
    pub band: Option<CrackBand>,
}

/// Damage at an energy release rate.
#[derive(Clone, Copy, Debug)]
pub(super) struct Damage {
    /// η.
    pub eta: f64,
    /// dD/dY.
    pub rate: f64,
    stretched: Option<(Stretch, Stretched)>,
}

impl Softening {
    /// η and dD/dY at an energy release rate above the threshold.
    #[inline]
    pub fn damage(&self, energy: f64) -> Damage {
        let eta = self.curve.law.eta(energy);
        let rate = self.curve.law.damage_rate(energy, eta);
        if let Some(band) = &self.band {
            // before the peak the curve itself holds, and its slope tells without knowing the peak
            if self.curve.slope(energy, eta, rate) < 0.0 {
                let stretch = band.stretch(&self.curve);
                if !band.allows(&self.curve, &stretch) {
                    // CELENT grew beyond the limit after the first call: the update reports it
                    return Damage { eta: f64::NAN, rate: f64::NAN, stretched: None };
                }
                if let Some(state) = stretch.at(&self.curve, energy, None) {
                    return Damage { eta: state.eta, rate: state.rate, stretched: Some((stretch, state)) };
                }
            }
        }
        Damage { eta, rate, stretched: None }
    }

    /// ∫ Y (−f') dD from a point of the curve to the end of an increment.
    pub fn dissipation(&self, start: &Branch, end: &Branch, reached: &Damage) -> f64 {
        let excess = start.maximum - self.curve.law.threshold;
        let growth = (end.maximum - start.maximum) / excess;
        let short = |reach: f64| start.eta > 0.0 && growth <= reach;
        let Some((stretch, last)) = &reached.stretched else {
            return if short(SIXTH_ORDER_REACH) {
                self.sixth_order(start, end)
            } else {
                self.curve.dissipation_between(start, end)
            };
        };
        let before = match stretch.at(&self.curve, start.maximum, Some(last)) {
            Some(first) if short(FOURTH_ORDER_REACH) => {
                return self.fourth_order(start, end, [first.rate, last.rate]);
            }
            Some(first) => stretch.dissipation(&self.curve, &first),
            None => self.curve.dissipation(start.eta),
        };
        (stretch.dissipation(&self.curve, last) - before).max(0.0)
    }

    /// −Δf between two points, without cancellation.
    #[inline]
    fn stiffness_drop(&self, start: &Branch, end: &Branch) -> f64 {
        let growth = (end.eta - start.eta) * integrity(end.eta) * integrity(start.eta);
        growth * self.curve.stiffness_loss(start.eta, end.eta)
    }

    /// −∫ Y df = −½ (Y_0 + Y_1) Δf + h²/10 ΔF' − h³/120 (F''_0 + F''_1) with F(Y) = 1 − f(D̂(Y)): integration
    /// by parts and the two-point Hermite rule for ∫ F dY; D'' = D' (B − 1 − 2BD)/(Y − Y₀).
    fn sixth_order(&self, start: &Branch, end: &Branch) -> f64 {
        let law = &self.curve.law;
        let step = end.maximum - start.maximum;
        // one division each for 1 − D, 1/(Y − Y₀) and 1/(1 − ρD): this runs in every growing update
        let slopes = |branch: &Branch| {
            let w = integrity(branch.eta);
            let d = branch.eta * w;
            let per_excess = 1.0 / (branch.maximum - law.threshold);
            let rate = law.b * d * w * per_excess;
            let second = rate * (law.b - 1.0 - 2.0 * law.b * d) * per_excess;
            let (loss, loss_rate) = self.curve.stiffness_losses(w);
            (loss * rate, loss_rate * rate * rate + loss * second)
        };
        let ((first_0, second_0), (first_1, second_1)) = (slopes(start), slopes(end));
        0.5 * (start.maximum + end.maximum) * self.stiffness_drop(start, end)
            + step * step * ((first_1 - first_0) / 10.0 - step * (second_0 + second_1) / 120.0)
    }

    /// −∫ Y df = −½ (Y_0 + Y_1) Δf + h²/12 ΔF', for the stretched curve, whose F'' is not at hand.
    fn fourth_order(&self, start: &Branch, end: &Branch, rates: [f64; 2]) -> f64 {
        let step = end.maximum - start.maximum;
        let slope = |branch: &Branch, rate: f64| rate * self.curve.stiffness_loss(branch.eta, branch.eta);
        let change = slope(end, rates[1]) - slope(start, rates[0]);
        0.5 * (start.maximum + end.maximum) * self.stiffness_drop(start, end) + step * step * change / 12.0
    }
}
