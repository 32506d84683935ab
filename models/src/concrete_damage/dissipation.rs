//! Energy dissipated in one increment: by damage and by inelastic strain (doc.md).

use super::crack_band::{Damage, Softening};
use super::criteria::Criteria;
use super::evolution::{Branch, History};
use super::stress_and_tangent::{Degraded, Point};
use super::{Parameters, State};
use crate::damage_law::integrity;
use crate::tensor::{Spectral, work};
use umat_abi::law::Increment;

impl Point {
    /// The dissipation of an increment that ends here, whose state before is given.
    ///
    /// Damage: ½ (R_n + R_{n+1}) ∫ Y (−f') dD for each branch, R = F/(Y (−f')), F = −∂Ψ/∂D the true force and
    /// f the uniaxial stiffness ratio. R stays the same in uniaxial stress (and, for cracking, on any
    /// proportional strain path without crushing), where this is exact for any increment; it is of second
    /// order otherwise, and never negative.
    /// Inelastic strain: ½ (σ* + σ_{n+1}) : Δε_p, σ* being σ_n carried along its ray to the threshold.
    #[inline]
    pub fn dissipation(
        &self,
        parameters: &Parameters,
        softening: &[Softening; 2],
        start: &History,
        increment: &Increment,
        state: &State,
        stress: &[f64; 6],
    ) -> f64 {
        let end = &self.evolution;
        if end.growth.iter().all(Option::is_none) && end.flow.is_none() {
            return 0.0;
        }
        let mut strain: [f64; 6] = std::array::from_fn(|i| increment.strain[i] - increment.strain_increment[i]);
        if self.normal.is_some() {
            strain[2] = state.strain_33;
        }
        let strain = Spectral::of_strain(&state.trial_strain(&strain)).values;
        let criteria = Criteria::new(parameters, &strain);
        let mut dissipation = 0.0;
        if end.growth[0].is_some() || end.growth[1].is_some() {
            let solid = Degraded::new(parameters, start.tension.eta, start.compression.eta, &strain);
            if let Some(damage) = &end.growth[0] {
                let (old, new) = (&start.tension, &end.history.tension);
                let ratio = end.solid.tensile_force() / new.maximum;
                let first = ratio_or(solid.tensile_force(), criteria.tension, ratio);
                dissipation += 0.5 * (first + ratio) * softening[0].dissipation(old, new, damage);
            }
            if let Some(damage) = &end.growth[1] {
                let (old, new) = (&start.compression, &end.history.compression);
                let loss = |eta: f64| softening[1].curve.stiffness_loss(eta, eta);
                let ratio = end.solid.compressive_force(parameters) / (new.maximum * loss(new.eta));
                let first = ratio_or(solid.compressive_force(parameters), criteria.compression * loss(old.eta), ratio);
                dissipation += 0.5 * (first + ratio) * softening[1].dissipation(old, new, damage);
            }
        }
        if let Some(flow) = &end.flow {
            let parts = [
                (flow.tension, flow.thresholds[0], criteria.tension),
                (flow.compression, flow.thresholds[1], criteria.compression),
            ];
            for (principal, threshold, energy) in parts {
                let inelastic = self.axes.strain(&principal);
                let last = work(stress, &inelastic);
                let carried = || (threshold / energy).sqrt() * work(&increment.stress, &inelastic);
                let first = if energy > 0.0 { carried() } else { last };
                dissipation += 0.5 * (first.max(0.0) + last.max(0.0));
            }
        }
        dissipation
    }
}

/// The start's ratio, or the end's where the start has no direction.
fn ratio_or(force: f64, energy: f64, otherwise: f64) -> f64 {
    let ratio = force / energy;
    if energy > 0.0 && ratio.is_finite() { ratio } else { otherwise }
}

/// Relative growth of Y − Y₀ up to which the Hermite rule of sixth order is exact to rounding: its
/// error is of the order 7e-3 · growth⁶.
const SIXTH_ORDER_REACH: f64 = 0.01;
/// Relative growth of Y − Y₀ up to which the rule of fourth order is exact to rounding: its error is about growth⁴/36.
const FOURTH_ORDER_REACH: f64 = 1e-3;

impl Softening {
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
