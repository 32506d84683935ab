//! Three dimensions, plane strain, axisymmetry: the return is radial in deviatoric stress and
//! ends in closed form.

use super::{Parameters, Returned, YIELD_ROUNDING};
use crate::tensor::{add_dyad, deviator, strain_norm_squared};
use umat_abi::law::Request;

/// Returns the trial state with elastic strain `trial` (of the end strain and the old plastic strain).
///
/// `volumetric` is tr ε of the total strain: plastic flow keeps the volume, and the trace of the
/// stored plastic strain is only rounding, which a bulk modulus at ν → ½ would magnify.
#[inline]
pub(super) fn radial_return(
    parameters: &Parameters<'_>,
    trial: &[f64; 6],
    volumetric: f64,
    peeq: f64,
    request: Request,
) -> Returned {
    let Parameters { elasticity, hardening } = parameters;
    let mu = elasticity.shear_modulus;
    // s = 2μ e, q = √(3/2 s:s)
    let mean_stress = elasticity.bulk_modulus * volumetric;
    let trial_deviator = deviator(trial);
    let trial_stress = mu * (6.0 * strain_norm_squared(&trial_deviator)).sqrt();
    let complete = |s: &[f64; 6], factor: f64| {
        std::array::from_fn(|i| if i < 3 { mean_stress + 2.0 * factor * s[i] } else { factor * s[i] })
    };
    let mut returned = Returned {
        equivalent_stress: trial_stress,
        mean_stress,
        stress: complete(&trial_deviator, mu),
        tangent: [[0.0; 6]; 6],
        peeq_increment: 0.0,
        plastic_increment: [0.0; 6],
        strain_33: 0.0,
    };
    if trial_stress <= hardening.yield_stress(peeq) * (1.0 + YIELD_ROUNDING) {
        if request.wants_tangent() {
            returned.tangent = elasticity.stiffness();
        }
        return returned;
    }
    let (peeq_increment, slope) = hardening.radial_return(trial_stress, peeq, 3.0 * mu);
    let yield_stress = hardening.yield_stress(peeq + peeq_increment);
    let ratio = yield_stress / trial_stress;
    returned.equivalent_stress = yield_stress;
    returned.peeq_increment = peeq_increment;
    returned.stress = complete(&trial_deviator, ratio * mu);
    // Δεᵖ = Δp (3/2) s/q, as a strain
    returned.plastic_increment = trial_deviator.map(|e| 3.0 * mu * peeq_increment / trial_stress * e);
    if request.wants_tangent() {
        returned.tangent = elasticity.with_shear_modulus(ratio * mu).stiffness();
        // N = s/q
        let direction: [f64; 6] =
            std::array::from_fn(|i| trial_deviator[i] * mu / trial_stress * if i < 3 { 2.0 } else { 1.0 });
        let factor = 3.0 * mu * (slope / (3.0 * mu + slope) - ratio);
        add_dyad(&mut returned.tangent, factor, &direction, &direction);
    }
    returned
}
