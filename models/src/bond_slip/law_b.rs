//! Law B: interfacial damage with friction on the damaged part, Alfano–Sacco type (doc.md).

use super::State;
use super::envelope::Envelope;
use super::friction::{Friction, ROUNDING, return_to_disc};
use super::tangential::{
    BondFraction, Contribution, Integrity, Slip, Vector, difference, dot, norm, outer, product, scaled,
    scaled_identity, sum,
};

/// Parameters of law B.
#[derive(Clone, Copy, Debug)]
pub(super) struct LawB<'p> {
    pub envelope: Envelope<'p>,
    /// c_N: weight of the gap relative to the slip; 0: only slip causes damage.
    pub gap_weight: f64,
}

impl LawB<'_> {
    /// Advances damage and friction: t = (1 − d) k g + d k (g − g_s); `gap`: ⟨gap⟩ ≥ 0.
    #[inline]
    pub fn advance(
        &self,
        friction: &Friction,
        slip: &Slip,
        gap: f64,
        pressure: f64,
        fraction: BondFraction,
        state: &mut State,
    ) -> Contribution {
        let k = self.envelope.elastic_stiffness;
        let (stored_before, traction_before) = self.energy_and_traction(slip.start, fraction.start, state);
        let start = fraction.start * self.envelope.integrity(state.largest_slip).0;
        let g = slip.end;
        let weighted_gap = self.gap_weight * gap;
        let r = norm([norm(g), weighted_gap]);
        let loading = r >= state.largest_slip * (1.0 - ROUNDING);
        state.largest_slip = state.largest_slip.max(r);
        let (unopened, unopened_slope) = self.envelope.integrity(state.largest_slip);
        let integrity = fraction.end * unopened;
        let damage = state.damage.max(1.0 - integrity);
        let integrity_by_square = if loading && r > 0.0 { fraction.end * unopened_slope / r } else { 0.0 };
        let integrity_by_slip = scaled(g, integrity_by_square);
        let integrity_by_gap = integrity_by_square * self.gap_weight * weighted_gap;

        // newly damaged area has not slid yet: it dilutes the friction slip, so that damage never stores energy
        let share = if damage > 0.0 { state.damage / damage } else { 0.0 };
        let trial = [0, 1].map(|i| k * (g[i] - share * state.friction_slip[i]));
        // ∂trial/∂(1 − d)
        let trial_by_integrity =
            if damage > state.damage { scaled(state.friction_slip, -k * share / damage) } else { [0.0; 2] };
        let (rubbing, rubbing_slope) = friction.limit(pressure);
        let tolerance = ROUNDING * k * (r + norm(state.friction_slip));
        let returned = return_to_disc(trial, self.envelope.residual + rubbing, tolerance);

        let old_share = scaled(state.friction_slip, share);
        state.friction_slip = match (damage > 0.0, returned.slides) {
            (false, _) => [0.0; 2],
            (true, false) => old_share,
            (true, true) => difference(g, scaled(returned.vector, 1.0 / k)),
        };
        state.damage = damage;

        let elastic = scaled(g, k);
        let traction = [0, 1].map(|i| integrity * elastic[i] + damage * returned.vector[i]);
        // ∂t/∂(1 − d) at fixed slip, also through the diluted friction slip
        let drop = difference(elastic, returned.vector);
        let diluted = super::tangential::image(returned.by_trial, trial_by_integrity);
        let by_integrity = [0, 1].map(|i| drop[i] + damage * diluted[i]);
        let friction_tangent = product(returned.by_trial, scaled_identity(k * damage));
        let stored_energy = self.stored_energy(integrity, elastic, damage, returned.vector);
        Contribution {
            traction,
            slip_tangent: sum(
                sum(scaled_identity(integrity * k), friction_tangent),
                outer(by_integrity, integrity_by_slip),
            ),
            pressure_tangent: scaled(returned.by_radius, damage * rubbing_slope),
            bond_fraction_tangent: scaled(by_integrity, unopened),
            gap_tangent: scaled(by_integrity, integrity_by_gap),
            integrity: Integrity { start, end: integrity, by_slip: integrity_by_slip, by_gap: integrity_by_gap },
            stored_energy,
            dissipation: slip.dissipation([traction_before, traction], [stored_before, stored_energy]),
        }
    }

    /// ψ = (1 − d) k g²/2 + d k (g − g_s)²/2 from the tractions of the two parts.
    fn stored_energy(&self, integrity: f64, elastic: Vector, damage: f64, friction: Vector) -> f64 {
        let k = self.envelope.elastic_stiffness;
        0.5 * (integrity * dot(elastic, elastic) + damage * dot(friction, friction)) / k
    }

    /// Stored energy and traction of the committed state.
    fn energy_and_traction(&self, slip: Vector, fraction: f64, state: &State) -> (f64, Vector) {
        let k = self.envelope.elastic_stiffness;
        let integrity = fraction * self.envelope.integrity(state.largest_slip).0;
        let elastic = scaled(slip, k);
        let friction = scaled(difference(slip, state.friction_slip), k);
        let traction = [0, 1].map(|i| integrity * elastic[i] + state.damage * friction[i]);
        (self.stored_energy(integrity, elastic, state.damage, friction), traction)
    }
}
