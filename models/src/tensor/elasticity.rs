//! Isotropic linear elasticity (docs/theory/common.md).

use super::isotropic::stiffness_of;
use super::{strain_norm_squared, trace};
use umat_abi::law::{ConfigurationError, Increment, Request, StressState};
use umat_abi::table::Field;

/// Lamé's constants and relatives of an isotropic solid, MPa.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Elasticity {
    /// Young's modulus E.
    pub youngs_modulus: f64,
    /// Poisson's ratio ν.
    pub poisson_ratio: f64,
    /// λ = Eν/((1+ν)(1−2ν)).
    pub lambda: f64,
    /// μ = E/(2(1+ν)).
    pub shear_modulus: f64,
    /// k = E/(3(1−2ν)).
    pub bulk_modulus: f64,
}

impl Field<2> for Elasticity {
    #[inline(always)]
    fn read([youngs_modulus, poisson_ratio]: [f64; 2]) -> Result<Self, ConfigurationError> {
        Ok(Self::new(youngs_modulus, poisson_ratio))
    }
}

impl Elasticity {
    /// Makes isotropic elasticity from E and ν.
    #[inline(always)]
    pub fn new(youngs_modulus: f64, poisson_ratio: f64) -> Self {
        let (e, nu) = (youngs_modulus, poisson_ratio);
        Self {
            youngs_modulus,
            poisson_ratio,
            lambda: e * nu / ((1.0 + nu) * (1.0 - 2.0 * nu)),
            shear_modulus: e / (2.0 * (1.0 + nu)),
            bulk_modulus: e / (3.0 * (1.0 - 2.0 * nu)),
        }
    }

    /// The solid with the same bulk modulus and another shear modulus.
    #[inline(always)]
    pub(crate) fn with_shear_modulus(&self, shear_modulus: f64) -> Self {
        Self::from_bulk_and_shear(self.bulk_modulus, shear_modulus)
    }

    /// Makes isotropic elasticity from k and μ: E = 9kμ/(3k + μ), ν = (3k − 2μ)/(2(3k + μ)).
    #[inline(always)]
    pub(crate) fn from_bulk_and_shear(bulk_modulus: f64, shear_modulus: f64) -> Self {
        let (k, mu) = (bulk_modulus, shear_modulus);
        Self {
            youngs_modulus: 9.0 * k * mu / (3.0 * k + mu),
            poisson_ratio: (3.0 * k - 2.0 * mu) / (2.0 * (3.0 * k + mu)),
            lambda: k - 2.0 * mu / 3.0,
            shear_modulus: mu,
            bulk_modulus: k,
        }
    }

    /// k_n of n = 2 (plane stress) or 3 normal directions: n k_n = E/(1 − (n−1)ν) (docs/theory/common.md).
    #[inline(always)]
    pub(crate) fn bulk_modulus_in(&self, dimension: f64) -> f64 {
        self.youngs_modulus / (dimension * (1.0 - (dimension - 1.0) * self.poisson_ratio))
    }

    /// σ = K₀ : ε = λ tr(ε) I + 2μ ε.
    #[inline(always)]
    pub fn stress(&self, strain: &[f64; 6]) -> [f64; 6] {
        let volumetric = self.lambda * trace(strain);
        let mu = self.shear_modulus;
        [
            volumetric + 2.0 * mu * strain[0],
            volumetric + 2.0 * mu * strain[1],
            volumetric + 2.0 * mu * strain[2],
            mu * strain[3],
            mu * strain[4],
            mu * strain[5],
        ]
    }

    /// Returns ½ ε : K₀ : ε = ½ (λ tr²(ε) + 2μ ε : ε), computed from the strains alone.
    #[inline(always)]
    pub fn stored_energy(&self, strain: &[f64; 6]) -> f64 {
        let trace = trace(strain);
        0.5 * self.lambda * (trace * trace) + self.shear_modulus * strain_norm_squared(strain)
    }

    /// K₀ in components: ∂σ_i/∂ε_j with engineering shear.
    #[inline(always)]
    pub fn stiffness(&self) -> [[f64; 6]; 6] {
        let (l, mu) = (self.lambda, self.shear_modulus);
        stiffness_of(3, l + 2.0 * mu, l, mu)
    }

    /// The ε33 for which σ33 = 0: −ν/(1−ν)(ε11 + ε22).
    #[inline(always)]
    pub fn plane_stress_strain_33(&self, strain: &[f64; 6]) -> f64 {
        let nu = self.poisson_ratio;
        -nu / (1.0 - nu) * (strain[0] + strain[1])
    }

    /// Returns the total strain 33 at the end of an increment of a solid that is elastic or isotropically damaged.
    #[inline(always)]
    pub fn strain_33(&self, increment: &Increment) -> f64 {
        match increment.stress_state {
            StressState::PlaneStress => self.plane_stress_strain_33(&increment.strain),
            _ => increment.strain[2],
        }
    }

    /// Returns the stiffness between the plane-stress components 11, 22, 12 (rows and columns 0, 1, 3).
    #[inline(always)]
    pub fn plane_stress_stiffness(&self) -> [[f64; 6]; 6] {
        let nu = self.poisson_ratio;
        let d = self.youngs_modulus / (1.0 - nu * nu);
        stiffness_of(2, d, nu * d, self.shear_modulus)
    }

    /// The stiffness of the stress state, 0 if no tangent is wanted.
    #[inline(always)]
    pub fn tangent(&self, plane_stress: bool, request: Request) -> [[f64; 6]; 6] {
        match (request.wants_tangent(), plane_stress) {
            (false, _) => [[0.0; 6]; 6],
            (true, false) => self.stiffness(),
            (true, true) => self.plane_stress_stiffness(),
        }
    }
}
