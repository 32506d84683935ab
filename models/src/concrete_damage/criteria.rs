//! The two damage energy release rates, explicit in strain (doc.md), and their gradients.

use super::Parameters;
use super::split::{Split, principal_stress};

/// M v of a 3×3 matrix.
#[inline]
pub(super) fn times(matrix: &[[f64; 3]; 3], vector: &[f64; 3]) -> [f64; 3] {
    matrix.map(|row| row[0] * vector[0] + row[1] * vector[1] + row[2] * vector[2])
}

/// μ e:e + β k θ²/2: what compressive damage can release of a strain.
#[inline]
pub(super) fn degradable_energy(parameters: &Parameters, strain: &[f64; 3]) -> f64 {
    let volume = strain[0] + strain[1] + strain[2];
    let deviator = strain.map(|e| e - volume / 3.0);
    let square: f64 = deviator.iter().map(|e| e * e).sum();
    parameters.elasticity.shear_modulus * square
        + 0.5 * parameters.beta * parameters.elasticity.bulk_modulus * volume * volume
}

/// Y_t, Y_c of one strain, and what their gradients need.
#[derive(Clone, Copy, Debug)]
pub(super) struct Criteria {
    /// Y_t = ⟨s̄_1⟩²/(2E), s̄ = K₀ : ε.
    pub tension: f64,
    /// Y_c = [μ e⁻:e⁻ + β k θ⁻²/2]/(1 + ζ_c w_c)² of the K₀ split.
    pub compression: f64,
    strain: [f64; 3],
    elastic_stress: [f64; 3],
    split: Split,
}

impl Criteria {
    /// Evaluates the criteria at principal strains in descending order.
    #[inline]
    pub fn new(parameters: &Parameters, strain: &[f64; 3]) -> Self {
        let elastic_stress = principal_stress(&parameters.elasticity, strain);
        let split = Split::new(&parameters.elasticity, strain);
        let opening = elastic_stress[0].max(0.0);
        let compression = degradable_energy(parameters, &split.minus);
        let mut criteria = Self {
            tension: opening * opening / (2.0 * parameters.elasticity.youngs_modulus),
            compression,
            strain: *strain,
            elastic_stress,
            split,
        };
        criteria.compression = criteria.confined(parameters, compression);
        criteria
    }

    /// Returns an energy that compression releases over (1 + ζ_c w_c)².
    #[inline]
    pub fn confined(&self, parameters: &Parameters, energy: f64) -> f64 {
        if parameters.zeta_c == 0.0 {
            return energy;
        }
        let divisor = 1.0 + parameters.zeta_c * self.confinement();
        energy / (divisor * divisor)
    }

    /// Returns the effect of rounding of the strain on Y_t and Y_c: δY = √(2 Y/E) δs, where δs is a few units in the
    /// last place of the terms of s.
    #[inline]
    pub fn rounding(&self, parameters: &Parameters) -> [f64; 2] {
        let elasticity = &parameters.elasticity;
        let modulus = elasticity.lambda.abs() + 2.0 * elasticity.shear_modulus;
        let size: f64 = self.strain.iter().map(|e| e.abs()).sum();
        let stress = 8.0 * f64::EPSILON * modulus * size;
        [self.tension, self.compression].map(|y| (2.0 * y / elasticity.youngs_modulus).sqrt() * stress)
    }

    /// w_c = s̄_1/s̄_3 where all elastic principal stresses are compressive, else 0: 0 in uniaxial and
    /// plane compression, 1 in hydrostatic compression.
    #[inline]
    fn confinement(&self) -> f64 {
        if self.elastic_stress[0] < 0.0 { self.elastic_stress[0] / self.elastic_stress[2] } else { 0.0 }
    }

    /// ∂Y_t/∂e_j = (s̄_1/E)(λ + 2μ δ_1j).
    #[inline]
    pub fn tension_gradient(&self, parameters: &Parameters) -> [f64; 3] {
        let elasticity = &parameters.elasticity;
        let factor = self.elastic_stress[0].max(0.0) / elasticity.youngs_modulus;
        let lateral = factor * elasticity.lambda;
        [lateral + factor * 2.0 * elasticity.shear_modulus, lateral, lateral]
    }

    /// ∂Y_c/∂e_j = H(K₀) [e⁻ + β (θ⁻/3) 1]/(1 + ζ_c w_c)² − 2 ζ_c Y_c/(1 + ζ_c w_c) ∂w_c/∂e_j.
    #[inline]
    pub fn compression_gradient(&self, parameters: &Parameters) -> [f64; 3] {
        let elasticity = &parameters.elasticity;
        let minus = &self.split.minus;
        let mean = (minus[0] + minus[1] + minus[2]) / 3.0;
        let dual = minus.map(|e| e - mean + parameters.beta * mean);
        let mut gradient = times(&self.split.stiffness(elasticity), &dual);
        if parameters.zeta_c == 0.0 || self.elastic_stress[0] >= 0.0 {
            return gradient;
        }
        // ∂w_c/∂e_j = (∂s̄_1/∂e_j − w_c ∂s̄_3/∂e_j)/s̄_3
        let confinement = self.confinement();
        let divisor = 1.0 + parameters.zeta_c * confinement;
        let slope = -2.0 * parameters.zeta_c * self.compression / (divisor * self.elastic_stress[2]);
        let (lambda, two_mu) = (elasticity.lambda, 2.0 * elasticity.shear_modulus);
        let common = lambda * (1.0 - confinement);
        let confinement_slope = [common + two_mu, common, common - confinement * two_mu];
        for j in 0..3 {
            gradient[j] = gradient[j] / (divisor * divisor) + slope * confinement_slope[j];
        }
        gradient
    }
}
