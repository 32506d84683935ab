//! Law A: the thesis's bond with consistent, pinched unloading (doc.md), a plasticity whose
//! admissible tractions are a disc of residual friction, stretched towards the side of first debonding.

use super::State;
use super::envelope::Envelope;
use super::friction::{ROUNDING, return_to_disc};
use super::tangential::{
    BondFraction, Contribution, Matrix, Slip, Vector, difference, dot, norm, outer, product, scaled, scaled_identity,
    sum,
};
use std::f64::consts::PI;

/// Parameters of law A.
#[derive(Clone, Copy, Debug)]
pub(super) struct LawA<'p> {
    pub envelope: Envelope<'p>,
    /// k_u, MPa/mm.
    pub unloading_stiffness: f64,
}

/// The state of the bond at one largest slip κ.
struct AtLargestSlip {
    largest_slip: f64,
    /// τ(κ) and τ'(κ).
    strength: f64,
    strength_slope: f64,
    /// k_u(κ) and its derivative.
    stiffness: f64,
    stiffness_slope: f64,
    /// T = min(τ_res, τ(κ)) and its derivative.
    friction: f64,
    friction_slope: f64,
}

/// A traction with its derivatives.
struct Pulled {
    traction: Vector,
    by_slip: Matrix,
    by_fraction: Vector,
    /// k_u(κ) at the end.
    stiffness: f64,
    /// Whether the bond slid: the plastic slip follows.
    slides: bool,
}

/// The state `side` of a unit vector: ±1 for ±e₁, and ±(1 + θ/π) with the angle θ ∈ [−π/2, π/2] to the
/// ±e₁ axis in general; never 0, which means "no debonding yet".
fn side_of(direction: Vector) -> f64 {
    let sign = if direction[0] < 0.0 { -1.0 } else { 1.0 };
    sign * (1.0 + direction[1].atan2(direction[0].abs()) / PI)
}

/// The unit vector of a `side`.
fn direction_of(side: f64) -> Vector {
    let (sine, cosine) = ((side.abs() - 1.0) * PI).sin_cos();
    [cosine * side.signum(), sine]
}

impl LawA<'_> {
    fn at(&self, largest_slip: f64) -> AtLargestSlip {
        let strength = self.envelope.strength(largest_slip);
        let (stiffness, stiffness_slope) = self.envelope.unloading_stiffness(largest_slip, self.unloading_stiffness);
        let residual = self.envelope.residual;
        let (friction, friction_slope) =
            if residual <= strength.traction { (residual, 0.0) } else { (strength.traction, strength.slope) };
        AtLargestSlip {
            largest_slip,
            strength: strength.traction,
            strength_slope: strength.slope,
            stiffness,
            stiffness_slope,
            friction,
            friction_slope,
        }
    }

    /// Advances the bond, without the friction spring parallel to it.
    #[inline]
    pub fn advance(&self, slip: &Slip, fraction: BondFraction, state: &mut State) -> Contribution {
        let stiffness_before = self.envelope.unloading_stiffness(state.largest_slip, self.unloading_stiffness).0;
        let elastic_before = difference(slip.start, state.plastic_slip);
        let pulled = if state.side == 0.0 {
            self.first_debonding(slip.end, fraction.end, state)
        } else {
            self.after_debonding(slip.end, fraction.end, state)
        };
        if pulled.slides {
            state.plastic_slip = difference(slip.end, scaled(pulled.traction, 1.0 / pulled.stiffness));
        }
        let traction_before = scaled(elastic_before, stiffness_before);
        let stored_before = 0.5 * stiffness_before * dot(elastic_before, elastic_before);
        let stored_energy = 0.5 * dot(pulled.traction, pulled.traction) / pulled.stiffness;
        Contribution {
            traction: pulled.traction,
            slip_tangent: pulled.by_slip,
            bond_fraction_tangent: pulled.by_fraction,
            stored_energy,
            dissipation: slip.dissipation([traction_before, pulled.traction], [stored_before, stored_energy]),
            ..Contribution::default()
        }
    }

    /// Advances a bond without debonding so far: the traction has the direction of the slip and depends on its size r alone.
    fn first_debonding(&self, slip: Vector, fraction: f64, state: &mut State) -> Pulled {
        let r = norm(slip);
        let now = self.at(state.largest_slip.max(r));
        state.largest_slip = now.largest_slip;
        let direction = if r > 0.0 { scaled(slip, 1.0 / r) } else { [1.0, 0.0] };
        let loading = r >= now.largest_slip * (1.0 - ROUNDING);
        let bonded = fraction == 1.0 && now.largest_slip <= self.envelope.critical_slip;
        // on the envelope, or below it on the elastic line
        let (bond, bond_slope) =
            if loading { (now.strength, now.strength_slope) } else { (now.stiffness * r, now.stiffness) };
        let capped = fraction * bond > now.friction;
        let (cap, cap_slope, cap_by_fraction) = if capped {
            (fraction * bond, fraction * bond_slope, bond)
        } else {
            (now.friction, if loading { now.friction_slope } else { 0.0 }, 0.0)
        };
        let trial = now.stiffness * r;
        if bonded || r == 0.0 || trial < cap * (1.0 - ROUNDING) {
            // at r = 0 the fade acts from the first slip on, unless residual friction holds
            let fades_at_once = r == 0.0 && now.friction == 0.0 && self.envelope.residual == 0.0;
            let by_slip = scaled_identity(if fades_at_once { fraction * now.stiffness } else { now.stiffness });
            let traction = scaled(slip, now.stiffness);
            return Pulled { traction, by_slip, by_fraction: [0.0; 2], stiffness: now.stiffness, slides: false };
        }
        // an elastic line that is not yet faded (fraction 1 up to g_crit) leaves the side open
        let slides = trial > cap || now.largest_slip > self.envelope.critical_slip;
        if slides {
            state.side = side_of(direction);
        }
        let radial = outer(direction, direction);
        let secant = if r > 0.0 { cap / r } else { now.stiffness };
        let across = sum(scaled_identity(secant), radial.map(|row| scaled(row, -secant)));
        Pulled {
            traction: scaled(direction, cap),
            by_slip: sum(radial.map(|row| scaled(row, cap_slope)), across),
            by_fraction: scaled(direction, cap_by_fraction),
            stiffness: now.stiffness,
            slides,
        }
    }

    /// After first debonding towards n: t is k_u(κ)(g − g_pl), brought back to the tractions
    /// {a n + f, 0 ≤ a ≤ ⟨w U(x) − T⟩, |f| ≤ T}, with U(x) = τ(κ) − k_u(κ − x), x = n·g.
    fn after_debonding(&self, slip: Vector, fraction: f64, state: &mut State) -> Pulled {
        let n = direction_of(state.side);
        let x = dot(n, slip);
        let loading = x >= state.largest_slip * (1.0 - ROUNDING);
        let now = self.at(state.largest_slip.max(x));
        state.largest_slip = now.largest_slip;
        let k = now.stiffness;
        let towards_n = |factor: f64| if loading { scaled(n, factor) } else { [0.0; 2] };

        let reload = now.strength - k * (now.largest_slip - x);
        let reload_slope = if loading { now.strength_slope } else { k };
        let stretch = fraction * reload - now.friction;
        let friction_by_slip = towards_n(now.friction_slope);
        let (stretch, stretch_by_slip, stretch_by_fraction) = if stretch > 0.0 {
            (stretch, difference(scaled(n, fraction * reload_slope), friction_by_slip), reload)
        } else {
            (0.0, [0.0; 2], 0.0)
        };

        let elastic = difference(slip, state.plastic_slip);
        let trial = scaled(elastic, k);
        let trial_by_slip = sum(scaled_identity(k), outer(elastic, towards_n(now.stiffness_slope)));
        let along = dot(n, trial);
        let tolerance = ROUNDING * k * (norm(slip) + norm(state.plastic_slip));
        let (centre, centre_by_slip, centre_by_fraction) = if along <= 0.0 {
            (0.0, [0.0; 2], 0.0)
        } else if along < stretch - tolerance {
            (along, [0, 1].map(|j| n[0] * trial_by_slip[0][j] + n[1] * trial_by_slip[1][j]), 0.0)
        } else {
            (stretch, stretch_by_slip, stretch_by_fraction)
        };
        let returned = return_to_disc(difference(trial, scaled(n, centre)), now.friction, tolerance);
        let centre_tangent = outer(n, centre_by_slip);
        let from_centre = sum(trial_by_slip, centre_tangent.map(|row| scaled(row, -1.0)));
        let moved = sum(product(returned.by_trial, from_centre), outer(returned.by_radius, friction_by_slip));
        // by the fraction: the centre moves, the distance from it moves back
        let shift = scaled(n, centre_by_fraction);
        let shift_back = super::tangential::image(returned.by_trial, shift);
        Pulled {
            traction: [0, 1].map(|i| n[i] * centre + returned.vector[i]),
            by_slip: sum(centre_tangent, moved),
            by_fraction: difference(shift, shift_back),
            stiffness: k,
            slides: returned.slides,
        }
    }
}
