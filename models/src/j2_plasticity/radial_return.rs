//! Three dimensions, plane strain, axisymmetry: the return is radial in deviatoric stress and
//! ends in closed form.

use super::{Parameters, Returned};
use crate::tensor::{Elasticity, add_dyad, deviator, strain_norm_squared, trace};
use umat_abi::law::{Request, Response};

/// The stress without flow: s = 2μ e, mean stress k tr ε.
pub(super) struct TrialState {
    deviator: [f64; 6],
    /// e : e.
    norm_squared: f64,
    mean_stress: f64,
    volumetric: f64,
}

impl TrialState {
    /// The volumetric strain is that of the total strain: plastic flow keeps the volume, and the trace of the
    /// stored plastic strain is only rounding, which a bulk modulus at ν → ½ would magnify.
    #[inline(always)]
    pub fn new(elasticity: &Elasticity, elastic_strain: &[f64; 6], strain: &[f64; 6]) -> Self {
        let deviator = deviator(elastic_strain);
        let norm_squared = strain_norm_squared(&deviator);
        let volumetric = trace(strain);
        Self { deviator, norm_squared, volumetric, mean_stress: elasticity.bulk_modulus * volumetric }
    }

    /// q² = 3/2 s:s, MPa².
    #[inline(always)]
    pub fn equivalent_stress_squared(&self, elasticity: &Elasticity) -> f64 {
        6.0 * (elasticity.shear_modulus * elasticity.shear_modulus) * self.norm_squared
    }

    /// 2μ |tr ε|, MPa.
    #[inline(always)]
    pub fn volumetric_stress(&self, elasticity: &Elasticity) -> f64 {
        2.0 * elasticity.shear_modulus * self.volumetric.abs()
    }

    /// The stress with the deviator's share of another shear modulus.
    #[inline(always)]
    fn stress(&self, shear_modulus: f64) -> [f64; 6] {
        let (mean, normal, shear) = (self.mean_stress, 2.0 * shear_modulus, shear_modulus);
        let means = [mean, mean, mean, 0.0, 0.0, 0.0];
        let moduli = [normal, normal, normal, shear, shear, shear];
        let mut stress = [0.0; 6];
        for i in 0..6 {
            stress[i] = means[i] + moduli[i] * self.deviator[i];
        }
        stress
    }

    /// An elastic trial state.
    #[inline(always)]
    pub fn elastic_response(&self, elasticity: &Elasticity, dissipated_energy: f64, request: Request) -> Response {
        let Elasticity { shear_modulus, .. } = *elasticity;
        Response {
            stress: self.stress(shear_modulus),
            tangent: if request.wants_tangent() { elasticity.stiffness() } else { [[0.0; 6]; 6] },
            stored_energy: shear_modulus * self.norm_squared + 0.5 * self.mean_stress * self.volumetric,
            dissipated_energy,
        }
    }
}

/// Returns the trial state to the yield surface.
#[inline(always)]
pub(super) fn radial_return(
    Parameters { elasticity, hardening }: &Parameters<'_>,
    elastic_strain: &[f64; 6],
    strain: &[f64; 6],
    peeq: f64,
    request: Request,
) -> Returned {
    let trial = TrialState::new(elasticity, elastic_strain, strain);
    let mu = elasticity.shear_modulus;
    let trial_stress = mu * (6.0 * trial.norm_squared).sqrt();
    let (peeq_increment, slope) = hardening.radial_return(trial_stress, peeq, 3.0 * mu);
    let yield_stress = hardening.yield_stress(peeq + peeq_increment);
    let ratio = yield_stress / trial_stress;
    let mut tangent = [[0.0; 6]; 6];
    if request.wants_tangent() {
        tangent = elasticity.with_shear_modulus(ratio * mu).stiffness();
        // N = s/q
        let direction: [f64; 6] =
            std::array::from_fn(|i| trial.deviator[i] * mu / trial_stress * if i < 3 { 2.0 } else { 1.0 });
        let factor = 3.0 * mu * (slope / (3.0 * mu + slope) - ratio);
        add_dyad(&mut tangent, factor, &direction, &direction);
    }
    Returned {
        equivalent_stress: yield_stress,
        mean_stress: trial.mean_stress,
        stress: trial.stress(ratio * mu),
        tangent,
        peeq_increment,
        // Δεᵖ = Δp (3/2) s/q, as a strain
        plastic_increment: trial.deviator.map(|e| 3.0 * mu * peeq_increment / trial_stress * e),
        strain_33: strain[2],
    }
}
