//! Principal values and directions of a symmetric 3×3 tensor, and isotropic tensor functions of it.

/// ε = Σ e_i n_i ⊗ n_i with e_1 ≥ e_2 ≥ e_3.
///
/// Cyclic Jacobi rotations: backward stable, exact for diagonal input, one rotation in plane problems, and insensitive
/// to repeated values. Any orthonormal basis of an eigenspace will do, because isotropic functions and their
/// derivatives do not depend on the choice.
#[derive(Clone, Copy, Debug)]
pub struct Spectral {
    /// Principal values, descending.
    pub values: [f64; 3],
    /// `directions[i]` is the unit vector of `values[i]`.
    pub directions: [[f64; 3]; 3],
}

/// Off-diagonal terms below this fraction of the largest entry are zero to working precision.
const NEGLIGIBLE: f64 = 1e-18;
/// Quadratic convergence needs 3–5 sweeps; the bound only keeps the loop finite.
const MAX_SWEEPS: usize = 12;

impl Spectral {
    /// Decomposes a strain (engineering shear).
    #[inline]
    pub fn of_strain(strain: &[f64; 6]) -> Self {
        let [a, b, c, d, e, f] = *strain;
        Self::of_matrix([[a, 0.5 * d, 0.5 * e], [0.5 * d, b, 0.5 * f], [0.5 * e, 0.5 * f, c]])
    }

    /// Decomposes a stress (tensor components).
    #[inline]
    pub fn of_stress(stress: &[f64; 6]) -> Self {
        let [a, b, c, d, e, f] = *stress;
        Self::of_matrix([[a, d, e], [d, b, f], [e, f, c]])
    }

    #[inline]
    fn of_matrix(mut m: [[f64; 3]; 3]) -> Self {
        let mut directions = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
        if m[0][2] == 0.0 && m[1][2] == 0.0 {
            // direction 3 is principal: one rotation at most, which leaves exact zeros
            rotate::<0, 1>(&mut m, &mut directions, 0.0);
        } else {
            let negligible = NEGLIGIBLE * m.iter().flatten().fold(0.0_f64, |scale, entry| scale.max(entry.abs()));
            for _ in 0..MAX_SWEEPS {
                let first = rotate::<0, 1>(&mut m, &mut directions, negligible);
                let second = rotate::<0, 2>(&mut m, &mut directions, negligible);
                let third = rotate::<1, 2>(&mut m, &mut directions, negligible);
                if !(first || second || third) {
                    break;
                }
            }
        }
        let mut this = Self { values: [m[0][0], m[1][1], m[2][2]], directions };
        for (i, j) in [(0, 1), (1, 2), (0, 1)] {
            if this.values[i] < this.values[j] {
                this.values.swap(i, j);
                this.directions.swap(i, j);
            }
        }
        this
    }

    /// The coordinate axis of each principal direction if all are coordinate axes.
    #[inline]
    fn coordinate_axes(&self) -> Option<[usize; 3]> {
        let axis = |i: usize| (0..3).find(|&k| self.directions[i][k].abs() == 1.0);
        let (first, second) = (axis(0)?, axis(1)?);
        (first != second).then_some([first, second, 3 - first - second])
    }

    /// N_i = n_i ⊗ n_i in tensor components (no factor on the shears): σ = Σ s_i N_i, and
    /// ∂e_i/∂ε = N_i with engineering shear.
    #[inline]
    pub(crate) fn projector(&self, i: usize) -> [f64; 6] {
        let [x, y, z] = self.directions[i];
        [x * x, y * y, z * z, x * y, x * z, y * z]
    }

    /// T_ij = (n_i ⊗ n_j + n_j ⊗ n_i)/2 in tensor components.
    #[inline]
    pub(crate) fn shear_projector(&self, i: usize, j: usize) -> [f64; 6] {
        let (a, b) = (self.directions[i], self.directions[j]);
        [
            a[0] * b[0],
            a[1] * b[1],
            a[2] * b[2],
            0.5 * (a[0] * b[1] + a[1] * b[0]),
            0.5 * (a[0] * b[2] + a[2] * b[0]),
            0.5 * (a[1] * b[2] + a[2] * b[1]),
        ]
    }

    /// Σ s_i N_i: the stress with these principal values in these directions.
    #[inline]
    pub fn stress(&self, principal: &[f64; 3]) -> [f64; 6] {
        let mut stress = [0.0; 6];
        for i in 0..3 {
            let projector = self.projector(i);
            for k in 0..6 {
                stress[k] += principal[i] * projector[k];
            }
        }
        stress
    }

    /// Σ e_i N_i as a strain (engineering shear).
    #[inline]
    pub fn strain(&self, principal: &[f64; 3]) -> [f64; 6] {
        let mut strain = self.stress(principal);
        for shear in &mut strain[3..] {
            *shear *= 2.0;
        }
        strain
    }

    /// The tangent of an isotropic function with principal values s_i(e_1, e_2, e_3) (docs/theory/common.md):
    ///
    /// C = Σ_ij H_ij N_i ⊗ N_j + Σ_{i<j} 2 d_ij T_ij ⊗ T_ij,
    ///
    /// `principal[i][j]` = H_ij = ∂s_i/∂e_j, `shear` = d_12, d_13, d_23 with
    /// d_ij = (s_i − s_j)/(e_i − e_j), which the caller evaluates in closed form for repeated values.
    #[inline]
    pub fn tangent(&self, principal: &[[f64; 3]; 3], shear: &[f64; 3]) -> [[f64; 6]; 6] {
        if let Some(axes) = self.coordinate_axes() {
            return along_axes(axes, principal, shear);
        }
        let n = [self.projector(0), self.projector(1), self.projector(2)];
        let t = [self.shear_projector(0, 1), self.shear_projector(0, 2), self.shear_projector(1, 2)];
        let mut tangent = [[0.0; 6]; 6];
        for i in 0..3 {
            let mut row = [0.0; 6];
            let mut scaled = [0.0; 6];
            for k in 0..6 {
                row[k] = principal[i][0] * n[0][k] + principal[i][1] * n[1][k] + principal[i][2] * n[2][k];
                scaled[k] = 2.0 * shear[i] * t[i][k];
            }
            for a in 0..6 {
                for b in 0..6 {
                    tangent[a][b] += n[i][a] * row[b] + t[i][a] * scaled[b];
                }
            }
        }
        tangent
    }
}

/// [`Spectral::tangent`] where the principal directions are the coordinate axes: the entries themselves.
#[inline]
fn along_axes(axes: [usize; 3], principal: &[[f64; 3]; 3], shear: &[f64; 3]) -> [[f64; 6]; 6] {
    let mut tangent = [[0.0; 6]; 6];
    for i in 0..3 {
        for j in 0..3 {
            tangent[axes[i]][axes[j]] = principal[i][j];
        }
    }
    for (pair, (i, j)) in [(0, 1), (0, 2), (1, 2)].into_iter().enumerate() {
        // shear components 12, 13, 23 are numbers 3, 4, 5; T_ij has ½ there twice
        let component = axes[i] + axes[j] + 2;
        tangent[component][component] = 0.5 * shear[pair];
    }
    tangent
}

/// One Jacobi rotation that annihilates entry P, Q if it is not negligible (Rutishauser's stable form); false: none.
#[inline(always)]
fn rotate<const P: usize, const Q: usize>(
    m: &mut [[f64; 3]; 3],
    directions: &mut [[f64; 3]; 3],
    negligible: f64,
) -> bool {
    let off_diagonal = m[P][Q];
    // NaN is no reason either
    let is_wanted = off_diagonal.abs() > negligible;
    if !is_wanted {
        return false;
    }
    let r = 3 - P - Q;
    let theta = 0.5 * (m[Q][Q] - m[P][P]) / off_diagonal;
    let magnitude = 1.0 / (theta.abs() + (theta * theta + 1.0).sqrt());
    let signed = if theta < 0.0 { -magnitude } else { magnitude };
    // an infinite θ is no rotation
    let t = if theta.abs() < f64::INFINITY { signed } else { 0.0 };
    let c = 1.0 / (t * t + 1.0).sqrt();
    let s = t * c;
    let turn = |a: f64, b: f64| (c * a - s * b, s * a + c * b);
    m[P][P] -= t * off_diagonal;
    m[Q][Q] += t * off_diagonal;
    (m[P][Q], m[Q][P]) = (0.0, 0.0);
    (m[r][P], m[r][Q]) = turn(m[r][P], m[r][Q]);
    (m[P][r], m[Q][r]) = (m[r][P], m[r][Q]);
    for k in 0..3 {
        (directions[P][k], directions[Q][k]) = turn(directions[P][k], directions[Q][k]);
    }
    true
}
