//! Symmetric second-order tensors as six components 11, 22, 33, 12, 13, 23.
//!
//! **Strains carry engineering shear, stresses carry no factor.** With that, stress · strain is the
//! plain scalar product and ∂σ/∂ε needs no factors either.

mod elasticity;
mod isotropic;
mod spectral;

pub use elasticity::Elasticity;
pub use isotropic::IsotropicSplit;
pub(crate) use isotropic::isotropic_stiffness;
pub use spectral::Spectral;

#[cfg(test)]
mod test;

/// tr ε (or tr σ).
#[inline(always)]
pub fn trace(tensor: &[f64; 6]) -> f64 {
    tensor[0] + tensor[1] + tensor[2]
}

/// Deviator of a strain; the engineering shears stay as they are. From differences of the normal strains, which equal ones
/// leave without a trace of rounding.
#[inline(always)]
pub fn deviator(strain: &[f64; 6]) -> [f64; 6] {
    const THIRD: f64 = 1.0 / 3.0;
    let [a, b, c, ..] = *strain;
    let (ab, bc, ca) = (a - b, b - c, c - a);
    [THIRD * (ab - ca), THIRD * (bc - ab), THIRD * (ca - bc), strain[3], strain[4], strain[5]]
}

/// ε : ε of a strain with engineering shear, Σ ε_ii² + ½ Σ γ_ij².
#[inline(always)]
pub fn strain_norm_squared(strain: &[f64; 6]) -> f64 {
    let [a, b, c, d, e, f] = *strain;
    a * a + b * b + c * c + 0.5 * (d * d + e * e + f * f)
}

/// σ : σ of a stress, Σ σ_ii² + 2 Σ σ_ij².
#[inline]
pub fn stress_norm_squared(stress: &[f64; 6]) -> f64 {
    let [a, b, c, d, e, f] = *stress;
    a * a + b * b + c * c + 2.0 * (d * d + e * e + f * f)
}

/// σ : ε.
#[inline]
pub fn work(stress: &[f64; 6], strain: &[f64; 6]) -> f64 {
    stress.iter().zip(strain).map(|(s, e)| s * e).sum()
}

/// `tangent += factor · a ⊗ b`.
#[inline]
pub fn add_dyad(tangent: &mut [[f64; 6]; 6], factor: f64, a: &[f64; 6], b: &[f64; 6]) {
    for i in 0..6 {
        let scaled = factor * a[i];
        for j in 0..6 {
            tangent[i][j] += scaled * b[j];
        }
    }
}

/// Condenses a tangent onto the plane-stress components: C_ab − C_a3 C_3b / C_33 in rows and columns
/// 0, 1, 3 (components 11, 22, 12), everything else 0.
pub(crate) fn condense_plane_stress(tangent: &[[f64; 6]; 6]) -> [[f64; 6]; 6] {
    let mut condensed = [[0.0; 6]; 6];
    for i in [0, 1, 3] {
        for j in [0, 1, 3] {
            condensed[i][j] = tangent[i][j] - tangent[i][2] * tangent[2][j] / tangent[2][2];
        }
    }
    condensed
}
