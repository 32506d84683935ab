//! Solid with cracks across three fixed axes (implex.md): ε⁻ = ε − ε⁺ minimises ½ (ε − ε⁺) : K : (ε − ε⁺) over the
//! openings and slips of the cracks.
//!
//! In the axes of the cracks, in components 11, 22, 33, 12, 13, 23, everything is piecewise linear. The open cracks,
//! and the pairs of cracks that slide freely, identify a piece.

use super::Parameters;
use super::criteria::times;
use crate::damage_law::{damage, integrity};
use crate::tensor::{Elasticity, Spectral, add_dyad, stress_norm_squared, trace, work};

/// The pairs of cracks, of shear components 12, 13, 23.
const PAIRS: [[usize; 2]; 3] = [[0, 1], [0, 2], [1, 2]];

/// The stress σ_C of a solid whose cracks are free.
#[derive(Clone, Copy, Debug)]
pub(super) struct FreeCracks {
    /// σ_C.
    pub stress: [f64; 6],
    /// N_i and 2 T_ij of the axes.
    directions: [[f64; 6]; 6],
    piece: Piece,
}

/// One linear piece, in the axes.
#[derive(Clone, Copy, Debug)]
struct Piece {
    stress: [f64; 6],
    stiffness: [[f64; 6]; 6],
    /// How far, as a strain, it is outside its own bounds.
    violation: f64,
}

impl Piece {
    /// Evaluates the piece whose cracks are `open`, and whose pairs slide freely or are stuck.
    fn new(elasticity: &Elasticity, friction: f64, strain: &[f64; 6], open: [bool; 3], is_free: [bool; 3]) -> Self {
        let (mu, slip) = (elasticity.shear_modulus, 1.0 / friction);
        let mut stiffness = elasticity.stiffness();
        // −∂²ψ/∂ε∂a_i and ∂²ψ/∂a_i∂a_k; a = 0 where a crack is closed
        let mut columns = [[0.0; 6]; 3];
        let mut curvature = [[0.0; 3]; 3];
        for i in 0..3 {
            curvature[i][i] = 1.0;
            if open[i] {
                columns[i][..3].copy_from_slice(&stiffness[i][..3]);
                for k in (0..3).filter(|&k| open[k]) {
                    curvature[i][k] = stiffness[i][k];
                }
            }
        }
        for (pair, cracks) in PAIRS.iter().enumerate() {
            if is_free[pair] {
                stiffness[3 + pair][3 + pair] = 0.0;
                continue;
            }
            for &i in cracks.iter().filter(|&&i| open[i]) {
                columns[i][3 + pair] = (slip * mu).copysign(strain[3 + pair]);
                for &k in cracks.iter().filter(|&&k| open[k]) {
                    curvature[i][k] += slip * slip * mu;
                }
            }
        }
        let compliance = inverse(&curvature);
        let opening = times(&compliance, &columns.map(|column| work(&column, strain)));
        for i in 0..6 {
            let row = times(&compliance, &[columns[0][i], columns[1][i], columns[2][i]]);
            for j in 0..6 {
                stiffness[i][j] -= row[0] * columns[0][j] + row[1] * columns[1][j] + row[2] * columns[2][j];
            }
        }
        let elastic = elasticity.stress(strain);
        let mut stress: [f64; 6] = std::array::from_fn(|k| {
            let relieved = (0..3).map(|i| columns[i][k] * opening[i]).sum::<f64>();
            if k >= 3 && is_free[k - 3] { 0.0 } else { elastic[k] - relieved }
        });
        let mut violation = 0.0_f64;
        // the least pressure of cracks that hold by friction
        let mut holding = [0.0; 3];
        for (pair, [i, k]) in PAIRS.into_iter().enumerate() {
            let excess = strain[3 + pair].abs() - slip * (opening[i] + opening[k]);
            violation = violation.max(if is_free[pair] { excess } else { -excess });
            holding[i] += slip * stress[3 + pair].abs();
            holding[k] += slip * stress[3 + pair].abs();
        }
        for i in 0..3 {
            violation = violation.max(if open[i] { -opening[i] } else { (stress[i] + holding[i]) / mu });
            if open[i] {
                // exact: the difference of two large stresses would leave a rounding error
                stress[i] = -holding[i];
            }
        }
        Self { stress, stiffness, violation }
    }
}

/// The inverse of a symmetric positive definite matrix.
#[inline]
fn inverse(m: &[[f64; 3]; 3]) -> [[f64; 3]; 3] {
    let minor = |i: usize, j: usize| {
        let [(a, b), (c, d)] = [i, j].map(|k| ((k + 1) % 3, (k + 2) % 3));
        m[a][c] * m[b][d] - m[a][d] * m[b][c]
    };
    let determinant = m[0][0] * minor(0, 0) + m[0][1] * minor(0, 1) + m[0][2] * minor(0, 2);
    std::array::from_fn(|i| std::array::from_fn(|j| minor(i, j) / determinant))
}

impl FreeCracks {
    /// Finds the piece that a strain lies in, with the friction 1/α of closed cracks: the first within its bounds, or, by rounding, the one that is least outside.
    #[inline]
    pub fn new(elasticity: &Elasticity, friction: f64, axes: &Spectral, strain: &[f64; 6]) -> Self {
        let twice = |projector: [f64; 6]| projector.map(|x| 2.0 * x);
        let shear = PAIRS.map(|[i, j]| twice(axes.shear_projector(i, j)));
        let directions = [axes.projector(0), axes.projector(1), axes.projector(2), shear[0], shear[1], shear[2]];
        let strain = directions.map(|direction| work(&direction, strain));
        let mut piece = Piece::new(elasticity, friction, &strain, [false; 3], [false; 3]);
        let bits = |number: usize| std::array::from_fn(|k| number >> k & 1 == 1);
        for number in 8..64 {
            if piece.violation <= 0.0 {
                break;
            }
            let (open, is_free): ([bool; 3], [bool; 3]) = (bits(number / 8), bits(number % 8));
            // nothing slides freely where both are closed
            if PAIRS.iter().zip(is_free).all(|([i, k], is_free)| !is_free || open[*i] || open[*k]) {
                let other = Piece::new(elasticity, friction, &strain, open, is_free);
                if other.violation < piece.violation {
                    piece = other;
                }
            }
        }
        let stress = std::array::from_fn(|k| (0..6).map(|i| piece.stress[i] * directions[i][k]).sum());
        Self { stress, directions, piece }
    }

    /// ∂σ_C/∂ε.
    #[inline]
    pub fn stiffness(&self) -> [[f64; 6]; 6] {
        let mut tangent = [[0.0; 6]; 6];
        for (row, first) in self.piece.stiffness.iter().zip(&self.directions) {
            for (factor, second) in row.iter().zip(&self.directions) {
                if *factor != 0.0 {
                    add_dyad(&mut tangent, *factor, first, second);
                }
            }
        }
        // symmetric up to rounding
        std::array::from_fn(|i| std::array::from_fn(|j| 0.5 * (tangent[i][j] + tangent[j][i])))
    }

    /// μ e⁻ : e⁻ + ½ βk (θ⁻)², from σ_C of the virgin stiffness.
    #[inline]
    pub fn degradable_energy(&self, parameters: &Parameters) -> f64 {
        let Elasticity { shear_modulus, bulk_modulus, .. } = parameters.elasticity;
        let mean = trace(&self.stress) / 3.0;
        let [a, b, c, d, e, f] = self.stress;
        stress_norm_squared(&[a - mean, b - mean, c - mean, d, e, f]) / (4.0 * shear_modulus)
            + 0.5 * parameters.beta * mean * mean / bulk_modulus
    }
}

/// The cracked, softened solid at one strain and fixed damage.
#[derive(Clone, Copy, Debug)]
pub(super) struct FixedCracks {
    eta_t: f64,
    elasticity: Elasticity,
    strain: [f64; 6],
    free: FreeCracks,
    /// σ = (1 − D_t) K_c : ε + D_t σ_C.
    pub stress: [f64; 6],
}

impl FixedCracks {
    /// Degrades the stiffness K_c.
    #[inline]
    pub fn new(elasticity: &Elasticity, friction: f64, eta_t: f64, axes: &Spectral, strain: &[f64; 6]) -> Self {
        let free = FreeCracks::new(elasticity, friction, axes, strain);
        let (full, w, d) = (elasticity.stress(strain), integrity(eta_t), damage(eta_t));
        let stress = std::array::from_fn(|i| w * full[i] + d * free.stress[i]);
        Self { eta_t, elasticity: *elasticity, strain: *strain, free, stress }
    }

    /// Ψ = ½ σ : ε (Ψ is homogeneous of degree 2 in ε).
    #[inline]
    pub fn energy(&self) -> f64 {
        0.5 * work(&self.stress, &self.strain)
    }

    /// ∂σ/∂ε.
    #[inline]
    pub fn stiffness(&self) -> [[f64; 6]; 6] {
        let (w, d) = (integrity(self.eta_t), damage(self.eta_t));
        let (full, free) = (self.elasticity.stiffness(), self.free.stiffness());
        std::array::from_fn(|i| std::array::from_fn(|j| w * full[i][j] + d * free[i][j]))
    }
}
