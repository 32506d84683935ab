//! The return to the cone and its apex in three dimensions, in closed form, and its derivative.

use super::cone::Cone;
use crate::j2_plasticity::YIELD_ROUNDING;
use crate::tensor::{Elasticity, add_dyad, deviator, strain_norm_squared, trace};

/// Part of the yield surface to which a trial state returns.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Regime {
    Elastic,
    Cone,
    Apex,
}

/// The end of a return.
#[derive(Clone, Copy, Debug)]
pub(super) struct Returned {
    pub regime: Regime,
    /// σ_m.
    pub mean_stress: f64,
    /// √J₂.
    pub root_j2: f64,
    /// Δλ on the cone, else 0.
    pub multiplier: f64,
    /// N = s_trial/√J₂_trial in stress components; 0 if there is no deviator.
    direction: [f64; 6],
    /// √J₂_trial.
    trial_root_j2: f64,
    /// Elastic trial strain, its deviator kept.
    trial_deviator: [f64; 6],
    /// σ_m,trial.
    pub trial_mean_stress: f64,
    elasticity: Elasticity,
    cone: Cone,
}

/// √J₂ = μ √(2 e:e) of an elastic strain deviator.
#[inline]
fn root_j2(elasticity: &Elasticity, strain_deviator: &[f64; 6]) -> f64 {
    elasticity.shear_modulus * (2.0 * strain_norm_squared(strain_deviator)).sqrt()
}

/// (σ_m, √J₂) of an elastic strain.
#[inline]
pub(super) fn invariants(elasticity: &Elasticity, elastic_strain: &[f64; 6]) -> (f64, f64) {
    (elasticity.bulk_modulus * trace(elastic_strain), root_j2(elasticity, &deviator(elastic_strain)))
}

impl Returned {
    /// Returns the elastic trial strain.
    pub fn new(elasticity: &Elasticity, cone: &Cone, trial: &[f64; 6]) -> Self {
        Self::of_parts(elasticity, cone, deviator(trial), elasticity.bulk_modulus * trace(trial))
    }

    /// Returns the elastic trial strain with this deviator and this mean stress.
    pub fn of_parts(elasticity: &Elasticity, cone: &Cone, trial_deviator: [f64; 6], trial_mean_stress: f64) -> Self {
        let (mu, bulk) = (elasticity.shear_modulus, elasticity.bulk_modulus);
        let trial_root_j2 = root_j2(elasticity, &trial_deviator);
        let direction = if trial_root_j2 > 0.0 {
            std::array::from_fn(|i| trial_deviator[i] * mu / trial_root_j2 * if i < 3 { 2.0 } else { 1.0 })
        } else {
            [0.0; 6]
        };
        let mut returned = Self {
            regime: Regime::Elastic,
            mean_stress: trial_mean_stress,
            root_j2: trial_root_j2,
            multiplier: 0.0,
            direction,
            trial_root_j2,
            trial_deviator,
            trial_mean_stress,
            elasticity: *elasticity,
            cone: *cone,
        };
        let excess = cone.yield_function(trial_mean_stress, trial_root_j2);
        // the deviator is a difference of strains: its rounding grows with the volumetric strain, 2μ |tr ε| as a stress
        let volumetric_stress = 2.0 * mu / bulk * trial_mean_stress.abs();
        let terms =
            3.0 * cone.friction * trial_mean_stress.abs() + volumetric_stress + trial_root_j2 + cone.shear_strength;
        if excess > YIELD_ROUNDING * terms {
            let multiplier = excess / (mu + 9.0 * bulk * cone.friction * cone.dilation);
            let mean_stress = trial_mean_stress - 3.0 * bulk * cone.dilation * multiplier;
            // on the surface by construction
            let root_j2 = cone.shear_strength - 3.0 * cone.friction * mean_stress;
            if root_j2 > 0.0 && trial_root_j2 > 0.0 {
                returned = Self { regime: Regime::Cone, mean_stress, root_j2, multiplier, ..returned };
            } else {
                returned = Self { regime: Regime::Apex, mean_stress: cone.apex(), root_j2: 0.0, ..returned };
            }
        }
        returned
    }

    /// σ.
    pub fn stress(&self) -> [f64; 6] {
        std::array::from_fn(|i| self.root_j2 * self.direction[i] + if i < 3 { self.mean_stress } else { 0.0 })
    }

    /// Component 33 of the elastic trial strain.
    pub fn trial_strain_33(&self) -> f64 {
        self.trial_deviator[2] + self.trial_mean_stress / (3.0 * self.elasticity.bulk_modulus)
    }

    /// Δεᵖ, engineering shear.
    pub fn plastic_increment(&self) -> [f64; 6] {
        match self.regime {
            Regime::Elastic => [0.0; 6],
            Regime::Cone => std::array::from_fn(|i| {
                let flow = if i < 3 { 0.5 * self.direction[i] + self.cone.dilation } else { self.direction[i] };
                self.multiplier * flow
            }),
            Regime::Apex => {
                let volumetric = (self.trial_mean_stress - self.mean_stress) / (3.0 * self.elasticity.bulk_modulus);
                std::array::from_fn(|i| self.trial_deviator[i] + if i < 3 { volumetric } else { 0.0 })
            }
        }
    }

    /// J₂/(2μ) + σ_m²/(2k₀).
    pub fn stored_energy(&self) -> f64 {
        self.root_j2.powi(2) / (2.0 * self.elasticity.shear_modulus)
            + self.mean_stress.powi(2) / (2.0 * self.elasticity.bulk_modulus)
    }

    /// μ + 9 k₀ α ᾱ.
    pub fn consistency_modulus(&self) -> f64 {
        self.elasticity.shear_modulus + 9.0 * self.elasticity.bulk_modulus * self.cone.friction * self.cone.dilation
    }

    /// H of eq. 5.26 for the slope α or ᾱ.
    fn gradient_image(&self, slope: f64) -> [f64; 6] {
        let volumetric = 3.0 * self.elasticity.bulk_modulus * slope;
        std::array::from_fn(|i| {
            self.elasticity.shear_modulus * self.direction[i] + if i < 3 { volumetric } else { 0.0 }
        })
    }

    /// ∂σ/∂ε.
    pub fn tangent(&self) -> [[f64; 6]; 6] {
        match self.regime {
            Regime::Elastic => self.elasticity.stiffness(),
            Regime::Apex => [[0.0; 6]; 6],
            Regime::Cone => {
                let mu = self.elasticity.shear_modulus;
                let ratio = self.root_j2 / self.trial_root_j2;
                let mut tangent = self.elasticity.with_shear_modulus(ratio * mu).stiffness();
                add_dyad(&mut tangent, mu * (1.0 - ratio), &self.direction, &self.direction);
                let flow = self.gradient_image(self.cone.dilation);
                let normal = self.gradient_image(self.cone.friction);
                add_dyad(&mut tangent, -1.0 / self.consistency_modulus(), &flow, &normal);
                tangent
            }
        }
    }

    /// σ33 alone.
    pub fn stress_33(&self) -> f64 {
        self.root_j2 * self.direction[2] + self.mean_stress
    }

    /// Entry 33, 33 of [`Self::tangent`].
    pub fn modulus_33(&self) -> f64 {
        let Elasticity { shear_modulus: mu, bulk_modulus: bulk, .. } = self.elasticity;
        match self.regime {
            Regime::Elastic => bulk + 4.0 / 3.0 * mu,
            Regime::Apex => 0.0,
            Regime::Cone => {
                let ratio = self.root_j2 / self.trial_root_j2;
                let shear = mu * self.direction[2];
                let flow = shear + 3.0 * bulk * self.cone.dilation;
                let normal = shear + 3.0 * bulk * self.cone.friction;
                bulk + 4.0 / 3.0 * mu * ratio + shear * (1.0 - ratio) * self.direction[2]
                    - flow * normal / self.consistency_modulus()
            }
        }
    }
}
