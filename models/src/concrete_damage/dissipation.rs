//! What one increment dissipates: damage and inelastic strain (doc.md).

use super::criteria::Criteria;
use super::degraded::Degraded;
use super::evolution::Evolution;
use super::softening::Softening;
use super::{History, Parameters};
use crate::tensor::{Spectral, work};

/// The committed state that an increment starts from.
pub(super) struct Start {
    /// ε_n − ε_p,n.
    pub elastic_strain: [f64; 6],
    /// σ_n.
    pub stress: [f64; 6],
    /// Damage at n.
    pub history: History,
}

/// The dissipation of an increment.
///
/// Damage: ½ (R_n + R_{n+1}) ∫ Y (−f') dD for each branch, R = F/(Y (−f')), F = −∂Ψ/∂D the true force and
/// f the uniaxial stiffness ratio. R stays the same in uniaxial stress (and, for cracking, on any
/// proportional strain path without crushing), where this is exact for any increment; it is of second
/// order otherwise, and never negative.
/// `strain` holds the principal values of the start's elastic strain.
/// Inelastic strain: ½ (σ* + σ_{n+1}) : Δε_p, σ* being σ_n carried along its ray to the threshold.
pub(super) fn increment(
    parameters: &Parameters,
    softening: &[Softening; 2],
    start: &Start,
    strain: &[f64; 3],
    end: &Evolution,
    axes: &Spectral,
    stress: &[f64; 6],
) -> f64 {
    let criteria = Criteria::new(parameters, strain);
    let mut dissipation = 0.0;
    if end.growth[0].is_some() || end.growth[1].is_some() {
        let solid = Degraded::new(parameters, start.history.tension.eta, start.history.compression.eta, strain);
        if let Some(damage) = &end.growth[0] {
            let (old, new) = (&start.history.tension, &end.history.tension);
            let ratio = end.solid.tensile_force() / new.maximum;
            let first = ratio_or(solid.tensile_force(), criteria.tension, ratio);
            dissipation += 0.5 * (first + ratio) * softening[0].dissipation(old, new, damage);
        }
        if let Some(damage) = &end.growth[1] {
            let (old, new) = (&start.history.compression, &end.history.compression);
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
            let inelastic = axes.strain(&principal);
            let last = work(stress, &inelastic);
            let first = if energy > 0.0 { (threshold / energy).sqrt() * work(&start.stress, &inelastic) } else { last };
            dissipation += 0.5 * (first.max(0.0) + last.max(0.0));
        }
    }
    dissipation
}

/// The start's ratio, or the end's where the start has no direction.
fn ratio_or(force: f64, energy: f64, otherwise: f64) -> f64 {
    let ratio = force / energy;
    if energy > 0.0 && ratio.is_finite() { ratio } else { otherwise }
}
