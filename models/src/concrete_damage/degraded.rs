//! Stress, energy and forces at given damage (doc.md): the hyperelastic part.

use super::Parameters;
use super::criteria::{degradable_energy, times};
use super::no_tension::{Split, principal_stiffness, principal_stress};
use crate::damage_law::{damage, integrity};
use crate::tensor::Elasticity;

/// K_c(D_c) = (1 − D_c) 2μ I_dev + (1 − β D_c) k I ⊗ I.
#[inline]
pub(super) fn degraded_elasticity(parameters: &Parameters, eta_c: f64) -> Elasticity {
    let virgin = &parameters.elasticity;
    if eta_c == 0.0 {
        return *virgin;
    }
    let mu = integrity(eta_c) * virgin.shear_modulus;
    let k = hydrostatic_integrity(parameters, eta_c) * virgin.bulk_modulus;
    Elasticity::from_bulk_and_shear(k, mu)
}

/// 1 − β D_c without cancellation: (1 − β) + β (1 − D_c).
#[inline]
fn hydrostatic_integrity(parameters: &Parameters, eta_c: f64) -> f64 {
    (1.0 - parameters.beta) + parameters.beta * integrity(eta_c)
}

/// The response of the cracked, softened solid to one principal strain at fixed damage.
#[derive(Clone, Copy, Debug)]
pub(super) struct Degraded {
    eta_t: f64,
    eta_c: f64,
    elasticity: Elasticity,
    strain: [f64; 3],
    split: Split,
    /// K_c : ε.
    full: [f64; 3],
    /// σ = (1 − D_t) K_c : ε + D_t σ_NT.
    pub stress: [f64; 3],
}

impl Degraded {
    /// At principal strains in descending order.
    #[inline]
    pub fn new(parameters: &Parameters, eta_t: f64, eta_c: f64, strain: &[f64; 3]) -> Self {
        let elasticity = degraded_elasticity(parameters, eta_c);
        let full = principal_stress(&elasticity, strain);
        let split = Split::new(&elasticity, strain);
        let (w, d) = (integrity(eta_t), damage(eta_t));
        let stress = std::array::from_fn(|i| w * full[i] + d * split.stress[i]);
        Self { eta_t, eta_c, elasticity, strain: *strain, split, full, stress }
    }

    /// Ψ = ½ σ : ε (Ψ is homogeneous of degree 2 in ε).
    #[inline]
    pub fn energy(&self) -> f64 {
        0.5 * dot(&self.stress, &self.strain)
    }

    /// The rounding error to expect in a principal stress, MPa: one unit in the last place of the terms
    /// it is the sum of.
    #[inline]
    pub fn rounding(&self) -> f64 {
        let modulus = self.elasticity.lambda.abs() + 2.0 * self.elasticity.shear_modulus;
        let size = |e: &[f64; 3]| e[0].abs() + e[1].abs() + e[2].abs();
        let (w, d) = (integrity(self.eta_t), damage(self.eta_t));
        f64::EPSILON * modulus * (w * size(&self.strain) + d * size(&self.split.minus))
    }

    /// −∂Ψ/∂D_t = ½ ε : K_c : ε − ψ_NT ≥ 0.
    #[inline]
    pub fn tensile_force(&self) -> f64 {
        (0.5 * (dot(&self.full, &self.strain) - dot(&self.split.stress, &self.strain))).max(0.0)
    }

    /// −∂Ψ/∂D_c = (1 − D_t)(a + β b) + D_t (a⁻ + β b⁻) ≥ 0.
    #[inline]
    pub fn compressive_force(&self, parameters: &Parameters) -> f64 {
        integrity(self.eta_t) * degradable_energy(parameters, &self.strain)
            + damage(self.eta_t) * degradable_energy(parameters, &self.split.minus)
    }

    /// ∂σ/∂ε at fixed damage: (1 − D_t) K_c + D_t C_NT, as (H, d).
    #[inline]
    pub fn stiffness(&self) -> ([[f64; 3]; 3], [f64; 3]) {
        let (w, d) = (integrity(self.eta_t), damage(self.eta_t));
        let full = principal_stiffness(&self.elasticity);
        let open = self.split.stiffness(&self.elasticity);
        let shear = self.split.shear_stiffness(&self.elasticity, &self.strain);
        let two_mu = 2.0 * self.elasticity.shear_modulus;
        (
            std::array::from_fn(|i| std::array::from_fn(|j| w * full[i][j] + d * open[i][j])),
            shear.map(|s| w * two_mu + d * s),
        )
    }

    /// ∂σ/∂D_t = −(K_c : ε − σ_NT).
    #[inline]
    pub fn tensile_softening(&self) -> [f64; 3] {
        std::array::from_fn(|i| self.split.stress[i] - self.full[i])
    }

    /// ∂σ/∂D_c = (1 − D_t) K_c' : ε + D_t s', with K_c' : ε = −(2μ e + β k θ I) and
    /// s' = −C_NT(K_c) : [e⁻/(1 − D_c) + (β/(1 − β D_c)) (θ⁻/3) I].
    #[inline]
    pub fn compressive_softening(&self, parameters: &Parameters) -> [f64; 3] {
        let (w, d) = (integrity(self.eta_t), damage(self.eta_t));
        let virgin = &parameters.elasticity;
        let volume: f64 = self.strain.iter().sum();
        let minus = &self.split.minus;
        let mean_minus = (minus[0] + minus[1] + minus[2]) / 3.0;
        let hydrostatic = parameters.beta / hydrostatic_integrity(parameters, self.eta_c);
        let dual = minus.map(|e| (e - mean_minus) * (1.0 + self.eta_c) + hydrostatic * mean_minus);
        let open = times(&self.split.stiffness(&self.elasticity), &dual);
        let volumetric = parameters.beta * virgin.bulk_modulus * volume;
        std::array::from_fn(|i| {
            let full = 2.0 * virgin.shear_modulus * (self.strain[i] - volume / 3.0) + volumetric;
            -(w * full + d * open[i])
        })
    }
}

/// Σ a_i b_i.
#[inline]
pub(super) fn dot(a: &[f64; 3], b: &[f64; 3]) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}
