//! IV-HP: inelastic strain (doc.md). While a criterion grows, the fraction b of the growth of its part of the strain
//! becomes permanent: cracks do not close fully, and compaction does not recover.

use super::Parameters;
use super::criteria::{Criteria, times};
use super::evolution::History;
use super::split::Split;
use super::stress_and_tangent::degraded_elasticity;
use crate::tensor::Elasticity;

impl Parameters {
    /// IV-HP rather than IV-H.
    #[inline(always)]
    pub(super) fn has_inelastic_strain(&self) -> bool {
        self.b_t != 0.0 || self.b_c != 0.0
    }
}

/// Inelastic strain of one increment, in the principal axes of the trial strain ε_tr = ε − ε_p,n.
#[derive(Clone, Copy, Debug)]
pub(super) struct Flow {
    strain: [f64; 3],
    criteria: Criteria,
    elasticity: Elasticity,
    split: Split,
    shrink_t: f64,
    shrink_c: f64,
    /// The Y_t and Y_c from which flow begins.
    pub thresholds: [f64; 2],
    /// c_t t⁺, the inelastic strain of this increment that cracks leave.
    pub tension: [f64; 3],
    /// c_c t⁻: the inelastic strain that crushing causes in this increment.
    pub compression: [f64; 3],
    /// ε_e = ε_tr − c_t t⁺ − c_c t⁻.
    pub elastic_strain: [f64; 3],
}

/// s = √(Y_threshold/Y) where Y exceeds what was reached before, else 1.
#[inline]
fn shrink(energy: f64, threshold: f64) -> f64 {
    if energy > threshold { (threshold / energy).sqrt() } else { 1.0 }
}

impl Flow {
    /// The flow at a trial strain; `None` if nothing grows or the law has no inelastic strain.
    #[inline]
    pub fn new(parameters: &Parameters, history: &History, strain: &[f64; 3]) -> Option<Self> {
        if !parameters.has_inelastic_strain() {
            return None;
        }
        let criteria = Criteria::new(parameters, strain);
        let thresholds = [
            parameters.tension.threshold.max(history.tension.maximum),
            parameters.compression.threshold.max(history.compression.maximum),
        ];
        let shrink_t = shrink(criteria.tension, thresholds[0]);
        let shrink_c = shrink(criteria.compression, thresholds[1]);
        if shrink_t == 1.0 && shrink_c == 1.0 {
            return None;
        }
        let elasticity = degraded_elasticity(parameters, history.compression.eta);
        let split = Split::new(&elasticity, strain);
        let (c_t, c_c) = (parameters.b_t * (1.0 - shrink_t), parameters.b_c * (1.0 - shrink_c));
        let tension: [f64; 3] = std::array::from_fn(|i| c_t * (strain[i] - split.minus[i]));
        let compression = split.minus.map(|e| c_c * e);
        Some(Self {
            strain: *strain,
            criteria,
            elasticity,
            split,
            shrink_t,
            shrink_c,
            thresholds,
            tension,
            compression,
            elastic_strain: std::array::from_fn(|i| strain[i] - tension[i] - compression[i]),
        })
    }

    /// ∂ε_e/∂ε = 1 − c_t P⁺ − c_c P⁻ − t⁺ ⊗ ∂c_t − t⁻ ⊗ ∂c_c with P⁻ = K_c⁻¹ C_NT, P⁺ = 1 − P⁻ and
    /// ∂c_x = (b_x/2)(s_x/Y_x) ∂Y_x, as the principal matrix and the three shear factors.
    pub fn gradient(&self, parameters: &Parameters) -> ([[f64; 3]; 3], [f64; 3]) {
        let c_t = parameters.b_t * (1.0 - self.shrink_t);
        let c_c = parameters.b_c * (1.0 - self.shrink_c);
        let projection = self.minus_gradient();
        let two_mu = 2.0 * self.elasticity.shear_modulus;
        let shear = self.split.shear_stiffness(&self.elasticity, &self.strain).map(|d| d / two_mu);
        let slope = |b: f64, s: f64, energy: f64| if s < 1.0 { 0.5 * b * s / energy } else { 0.0 };
        let slope_t = slope(parameters.b_t, self.shrink_t, self.criteria.tension);
        let slope_c = slope(parameters.b_c, self.shrink_c, self.criteria.compression);
        let tension = self.criteria.tension_gradient(parameters).map(|y| slope_t * y);
        let compression = self.criteria.compression_gradient(parameters).map(|y| slope_c * y);
        let gradient = std::array::from_fn(|i| {
            std::array::from_fn(|j| {
                let identity = f64::from(u8::from(i == j));
                let minus = projection[i][j];
                identity
                    - c_t * (identity - minus)
                    - c_c * minus
                    - (self.strain[i] - self.split.minus[i]) * tension[j]
                    - self.split.minus[i] * compression[j]
            })
        });
        (gradient, shear.map(|minus| 1.0 - c_t * (1.0 - minus) - c_c * minus))
    }

    /// P⁻ = ∂t⁻/∂ε = K_c⁻¹ H in principal axes.
    fn minus_gradient(&self) -> [[f64; 3]; 3] {
        let (e, nu) = (self.elasticity.youngs_modulus, self.elasticity.poisson_ratio);
        let mut compliance = [[-nu / e; 3]; 3];
        for i in 0..3 {
            compliance[i][i] = 1.0 / e;
        }
        let stiffness = self.split.stiffness(&self.elasticity);
        // both are symmetric: row i of the product is stiffness · (row i of the compliance)
        compliance.map(|row| times(&stiffness, &row))
    }
}
