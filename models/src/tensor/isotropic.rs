//! Isotropic linear relations in n normal directions (docs/theory/common.md): n = 3, or n = 2 in plane
//! stress, where the law of the plane is as simple as that of space once σ33 = 0 is built in.

use super::{deviator, trace};
use umat_abi::law::StressState;

/// ε split into the n-dimensional deviator e (with the shears) and the trace θ.
#[derive(Clone, Copy, Debug)]
pub struct IsotropicSplit {
    /// Number of normal directions, 2 or 3.
    directions: usize,
    /// e, engineering shear.
    pub deviator: [f64; 6],
    /// θ = Σ ε_ii over the n directions.
    pub trace: f64,
}

/// The number of normal directions in which a stress state drives a law.
#[inline(always)]
fn normal_directions(stress_state: StressState) -> usize {
    if stress_state == StressState::PlaneStress { 2 } else { 3 }
}

impl IsotropicSplit {
    /// Splits a strain; in plane stress ε33 is ignored.
    #[inline(always)]
    pub fn new(stress_state: StressState, strain: &[f64; 6]) -> Self {
        if normal_directions(stress_state) == 3 {
            return Self { directions: 3, deviator: deviator(strain), trace: trace(strain) };
        }
        let half_difference = 0.5 * (strain[0] - strain[1]);
        Self {
            directions: 2,
            deviator: [half_difference, -half_difference, 0.0, strain[3], strain[4], strain[5]],
            trace: strain[0] + strain[1],
        }
    }

    /// n.
    #[inline(always)]
    pub fn dimension(&self) -> f64 {
        self.directions as f64
    }

    /// e : e.
    #[inline(always)]
    pub(crate) fn deviator_norm_squared(&self) -> f64 {
        super::strain_norm_squared(&self.deviator)
    }

    /// 2μ e + s I_n with 2μ = `twice_shear_modulus` and s = `mean_stress`.
    #[inline(always)]
    pub fn stress(&self, twice_shear_modulus: f64, mean_stress: f64) -> [f64; 6] {
        let mut stress = self.deviator.map(|e| twice_shear_modulus * e);
        for normal in &mut stress[..self.directions] {
            *normal += mean_stress;
        }
        for shear in &mut stress[3..] {
            *shear *= 0.5;
        }
        stress
    }
}

/// 2μ I_dev + k_n I_n ⊗ I_n in components, `bulk_modulus` = k_n (so s = k_n θ).
#[inline(always)]
pub(crate) fn isotropic_stiffness(
    stress_state: StressState,
    twice_shear_modulus: f64,
    bulk_modulus: f64,
) -> [[f64; 6]; 6] {
    let directions = normal_directions(stress_state);
    let coupling = bulk_modulus - twice_shear_modulus / directions as f64;
    stiffness_of(directions, coupling + twice_shear_modulus, coupling, 0.5 * twice_shear_modulus)
}

/// Returns the stiffness of n normal directions: `direct` on their diagonal, `coupling` off it, and `shear`.
///
/// It is written entry by entry: values that stay in registers need not be read back from memory in pairs.
#[inline(always)]
pub(super) fn stiffness_of(directions: usize, direct: f64, coupling: f64, shear: f64) -> [[f64; 6]; 6] {
    let (d, c, s) = (direct, coupling, shear);
    if directions == 3 {
        [
            [d, c, c, 0.0, 0.0, 0.0],
            [c, d, c, 0.0, 0.0, 0.0],
            [c, c, d, 0.0, 0.0, 0.0],
            [0.0, 0.0, 0.0, s, 0.0, 0.0],
            [0.0, 0.0, 0.0, 0.0, s, 0.0],
            [0.0, 0.0, 0.0, 0.0, 0.0, s],
        ]
    } else {
        const NONE: [f64; 6] = [0.0; 6];
        [[d, c, 0.0, 0.0, 0.0, 0.0], [c, d, 0.0, 0.0, 0.0, 0.0], NONE, [0.0, 0.0, 0.0, s, 0.0, 0.0], NONE, NONE]
    }
}
