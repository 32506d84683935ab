//! The no-tension split in principal strains (doc.md).
//!
//! ε⁻ = ε − ε⁺ minimises ½ (ε − ε⁺) : K : (ε − ε⁺) over ε⁺ ≥ 0: what remains when cracks open freely. There are four
//! regions, by the number of open principal directions; the stress K : ε⁻ ≤ 0 does no work on ε⁺.

use crate::tensor::Elasticity;

/// Region of strain space by the number of open principal directions.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Region {
    /// R1: none; the full elastic stress is compressive.
    Closed,
    /// R2: direction 1; 2 and 3 carry a plane state of compression.
    OneOpen,
    /// R3: directions 1 and 2; 3 carries uniaxial compression.
    TwoOpen,
    /// R4: all.
    AllOpen,
}

/// The split of one strain e_1 ≥ e_2 ≥ e_3.
#[derive(Clone, Copy, Debug)]
pub(super) struct Split {
    pub region: Region,
    /// ε⁻.
    pub minus: [f64; 3],
    /// σ_NT = K : ε⁻.
    pub stress: [f64; 3],
}

impl Split {
    /// Splits principal strains in descending order.
    #[inline]
    pub fn new(elasticity: &Elasticity, strain: &[f64; 3]) -> Self {
        let [e1, e2, e3] = *strain;
        let (nu, two_mu) = (elasticity.poisson_ratio, 2.0 * elasticity.shear_modulus);
        let volumetric = elasticity.lambda * (e1 + e2 + e3);
        if volumetric + two_mu * e1 <= 0.0 {
            let stress = strain.map(|e| volumetric + two_mu * e);
            Self { region: Region::Closed, minus: *strain, stress }
        } else if e2 + nu * e3 <= 0.0 {
            let plane = elasticity.youngs_modulus / (1.0 - nu * nu);
            Self {
                region: Region::OneOpen,
                minus: [-nu / (1.0 - nu) * (e2 + e3), e2, e3],
                stress: [0.0, plane * (e2 + nu * e3), plane * (e3 + nu * e2)],
            }
        } else if e3 < 0.0 {
            Self {
                region: Region::TwoOpen,
                minus: [-nu * e3, -nu * e3, e3],
                stress: [0.0, 0.0, elasticity.youngs_modulus * e3],
            }
        } else {
            Self { region: Region::AllOpen, minus: [0.0; 3], stress: [0.0; 3] }
        }
    }

    /// H_ij = ∂s_i/∂e_j.
    #[inline]
    pub fn stiffness(&self, elasticity: &Elasticity) -> [[f64; 3]; 3] {
        let (e, nu) = (elasticity.youngs_modulus, elasticity.poisson_ratio);
        match self.region {
            Region::Closed => principal_stiffness(elasticity),
            Region::OneOpen => {
                let plane = e / (1.0 - nu * nu);
                [[0.0; 3], [0.0, plane, nu * plane], [0.0, nu * plane, plane]]
            }
            Region::TwoOpen => [[0.0; 3], [0.0; 3], [0.0, 0.0, e]],
            Region::AllOpen => [[0.0; 3]; 3],
        }
    }

    /// Returns d_12, d_13, d_23 with d_ij = (s_i − s_j)/(e_i − e_j), in closed form at repeated strains.
    ///
    /// If only one of the two carries stress, the quotient is s_j/(e_j − e_i); convexity bounds it
    /// by 2μ, which is also its limit when the two strains meet (and `min` takes 2μ against 0/0).
    #[inline]
    pub fn shear_stiffness(&self, elasticity: &Elasticity, strain: &[f64; 3]) -> [f64; 3] {
        let two_mu = 2.0 * elasticity.shear_modulus;
        let open_against = |i: usize, j: usize| (-self.stress[j] / (strain[i] - strain[j])).min(two_mu);
        match self.region {
            Region::Closed => [two_mu; 3],
            Region::OneOpen => [open_against(0, 1), open_against(0, 2), two_mu],
            Region::TwoOpen => [0.0, open_against(0, 2), open_against(1, 2)],
            Region::AllOpen => [0.0; 3],
        }
    }
}

/// K_ij = λ + 2μ δ_ij.
#[inline]
pub(super) fn principal_stiffness(elasticity: &Elasticity) -> [[f64; 3]; 3] {
    let mut stiffness = [[elasticity.lambda; 3]; 3];
    for i in 0..3 {
        stiffness[i][i] += 2.0 * elasticity.shear_modulus;
    }
    stiffness
}

/// K : ε in principal components.
#[inline]
pub(super) fn principal_stress(elasticity: &Elasticity, strain: &[f64; 3]) -> [f64; 3] {
    let volumetric = elasticity.lambda * (strain[0] + strain[1] + strain[2]);
    strain.map(|e| volumetric + 2.0 * elasticity.shear_modulus * e)
}
