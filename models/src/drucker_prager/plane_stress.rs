//! Plane stress: the trial state for which the returned σ33 is 0. Its unknown is the trial mean
//! stress rather than ε33, whose rounding a bulk modulus at ν → ½ would magnify.

use super::Parameters;
use super::return_map::{Regime, Returned};
use crate::roots::bracketed_newton;
use crate::tensor::condense_plane_stress;
use umat_abi::law::Failure;

/// Doublings of the search for the other end of the bracket: 2²⁰⁰ times the first guess.
const DOUBLINGS: u32 = 200;

/// Largest σ33 that passes for 0, relative to the other stresses. It is of the order of rounding
/// (1e-14) for any parameters of a real material.
const RESIDUAL: f64 = 1e-8;

/// Below this times E the modulus 33 is taken as such: condensation would divide by rounding noise.
const LEAST_MODULUS: f64 = 1e-12;

/// The trial state with in-plane elastic strain `trial` and mean stress σ_m: ε33 follows.
fn at_mean_stress(parameters: &Parameters, trial: &[f64; 6], mean_stress: f64) -> Returned {
    let Parameters { elasticity, cone } = parameters;
    let mean_strain = mean_stress / (3.0 * elasticity.bulk_modulus);
    let (first, second) = (trial[0] - mean_strain, trial[1] - mean_strain);
    let deviator = [first, second, -first - second, trial[3], 0.0, 0.0];
    Returned::of_parts(elasticity, cone, deviator, mean_stress)
}

/// The return that ends at σ33 = 0, from the in-plane components of the elastic trial strain.
pub(super) fn plane_stress_return(parameters: &Parameters, trial: &[f64; 6]) -> Result<Returned, Failure> {
    let elasticity = &parameters.elasticity;
    let (bulk, mu) = (elasticity.bulk_modulus, elasticity.shear_modulus);
    // (σ11 + σ22)/3
    let elastic = elasticity.youngs_modulus / (3.0 * (1.0 - elasticity.poisson_ratio)) * (trial[0] + trial[1]);
    let at = |mean_stress: f64| at_mean_stress(parameters, trial, mean_stress);
    let start = at(elastic);
    if start.regime == Regime::Elastic {
        return Ok(start);
    }
    let residual = start.stress_33();
    // σ33 rises with σ_m,trial, at most as fast as in the elastic solid
    let mut step = -residual * bulk / (bulk + 4.0 / 3.0 * mu);
    let mut near = elastic;
    for _ in 0..DOUBLINGS {
        let far = near + step;
        let there = at(far).stress_33();
        if there == 0.0 {
            return Ok(at(far));
        }
        if (there > 0.0) != (residual > 0.0) {
            let bracket = if residual > 0.0 { [far, near] } else { [near, far] };
            let resolution = f64::EPSILON * parameters.cone.shear_strength;
            let root = bracketed_newton(bracket, far, resolution, |mean_stress| {
                let returned = at(mean_stress);
                (returned.stress_33(), returned.modulus_33() / bulk)
            });
            return checked(at(root));
        }
        near = far;
        step *= 2.0;
    }
    Err(Failure::CutBack { fraction: 0.25, reason: "no strain 33 makes stress 33 zero" })
}

/// Rejects a root so ill conditioned that σ33 is not 0: strains far beyond yielding, ν → ½ and a steep cone together.
fn checked(returned: Returned) -> Result<Returned, Failure> {
    if returned.stress_33().abs() <= RESIDUAL * (returned.root_j2 + returned.mean_stress.abs()) {
        Ok(returned)
    } else {
        Err(Failure::CutBack { fraction: 0.25, reason: "stress 33 cannot be made zero in double precision" })
    }
}

/// C_ab − C_a3 C_3b/C_33.
pub(super) fn condensed_tangent(returned: &Returned, youngs_modulus: f64) -> [[f64; 6]; 6] {
    let mut tangent = returned.tangent();
    let least = LEAST_MODULUS * youngs_modulus;
    if tangent[2][2].abs() < least {
        tangent[2][2] = least.copysign(tangent[2][2]);
    }
    condense_plane_stress(&tangent)
}
