//! Principal values and directions of a symmetric 3×3 tensor, and isotropic tensor functions of it.

/// ε = Σ e_i n_i ⊗ n_i with e_1 ≥ e_2 ≥ e_3.
///
/// Cyclic Jacobi rotations: backward stable, exact for diagonal input, one rotation in plane
/// problems, and indifferent to repeated values (any orthonormal basis of an eigenspace serves,
/// because isotropic functions and their derivatives do not depend on the choice).
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
    fn of_matrix(m: [[f64; 3]; 3]) -> Self {
        let mut m = m.map(|row| row.map(|entry| [entry]));
        let mut directions = identity();
        if m[0][2] == [0.0] && m[1][2] == [0.0] {
            // direction 3 is principal: one rotation at most, which leaves exact zeros
            rotate::<1, 0, 1>(&mut m, &mut directions, &[0.0]);
        } else {
            let negligible = [NEGLIGIBLE * largest(&m, 0)];
            sweep(&mut m, &mut directions, &negligible);
        }
        Self::of_lane(&m, &directions, 0)
    }

    /// Decomposes W strains at once, component by component: to the same bits as [`Self::of_strain`], one by one.
    #[inline(always)]
    pub fn of_strains<const W: usize>(strains: &[[f64; W]; 6]) -> [Self; W] {
        let [a, b, c, d, e, f] = strains;
        let [d, e, f] = [d, e, f].map(|shear| shear.map(|gamma| 0.5 * gamma));
        let mut m = [[*a, d, e], [d, *b, f], [e, f, *c]];
        let mut directions = identity();
        let negligible = std::array::from_fn(|lane| {
            let is_planar = m[0][2][lane] == 0.0 && m[1][2][lane] == 0.0;
            if is_planar { 0.0 } else { NEGLIGIBLE * largest(&m, lane) }
        });
        sweep(&mut m, &mut directions, &negligible);
        std::array::from_fn(|lane| Self::of_lane(&m, &directions, lane))
    }

    #[inline(always)]
    fn of_lane<const W: usize>(m: &Lanes<W>, directions: &Lanes<W>, lane: usize) -> Self {
        let values = [m[0][0][lane], m[1][1][lane], m[2][2][lane]];
        Self { values, directions: directions.map(|row| row.map(|entry| entry[lane])) }.sorted()
    }

    /// The same with e_1 ≥ e_2 ≥ e_3.
    #[inline]
    fn sorted(mut self) -> Self {
        for (i, j) in [(0, 1), (1, 2), (0, 1)] {
            if self.values[i] < self.values[j] {
                self.values.swap(i, j);
                self.directions.swap(i, j);
            }
        }
        self
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
    pub fn projector(&self, i: usize) -> [f64; 6] {
        let [x, y, z] = self.directions[i];
        [x * x, y * y, z * z, x * y, x * z, y * z]
    }

    /// T_ij = (n_i ⊗ n_j + n_j ⊗ n_i)/2 in tensor components.
    #[inline]
    pub fn shear_projector(&self, i: usize, j: usize) -> [f64; 6] {
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

/// W matrices at once, entry by entry.
type Lanes<const W: usize> = [[[f64; W]; 3]; 3];

#[inline(always)]
fn identity<const W: usize>() -> Lanes<W> {
    std::array::from_fn(|i| std::array::from_fn(|j| [if i == j { 1.0 } else { 0.0 }; W]))
}

/// The largest entry of a matrix in magnitude.
#[inline(always)]
fn largest<const W: usize>(m: &Lanes<W>, lane: usize) -> f64 {
    m.iter().flatten().fold(0.0_f64, |scale, entry| scale.max(entry[lane].abs()))
}

/// Jacobi rotations until nothing is left off the diagonals.
#[inline(always)]
fn sweep<const W: usize>(m: &mut Lanes<W>, directions: &mut Lanes<W>, negligible: &[f64; W]) {
    for _ in 0..MAX_SWEEPS {
        let first = rotate::<W, 0, 1>(m, directions, negligible);
        let second = rotate::<W, 0, 2>(m, directions, negligible);
        let third = rotate::<W, 1, 2>(m, directions, negligible);
        if !(first || second || third) {
            break;
        }
    }
}

/// One Jacobi rotation that annihilates entry P, Q of each matrix where it is not negligible (Rutishauser's stable form);
/// false: nowhere. The other matrices stay as they are. Short loops over the lanes: those become vector instructions.
#[inline(always)]
fn rotate<const W: usize, const P: usize, const Q: usize>(
    m: &mut Lanes<W>,
    directions: &mut Lanes<W>,
    negligible: &[f64; W],
) -> bool {
    let off_diagonal = m[P][Q];
    let mut any = false;
    for lane in 0..W {
        any |= off_diagonal[lane].abs() > negligible[lane];
    }
    if !any {
        return false;
    }
    let r = 3 - P - Q;
    let (pp, qq) = (m[P][P], m[Q][Q]);
    let (mut t, mut c, mut s) = ([0.0; W], [0.0; W], [0.0; W]);
    for lane in 0..W {
        let theta = 0.5 * (qq[lane] - pp[lane]) / off_diagonal[lane];
        let magnitude = 1.0 / (theta.abs() + (theta * theta + 1.0).sqrt());
        let signed = if theta < 0.0 { -magnitude } else { magnitude };
        // an infinite θ is no rotation
        t[lane] = if theta.abs() < f64::INFINITY { signed } else { 0.0 };
        c[lane] = 1.0 / (t[lane] * t[lane] + 1.0).sqrt();
        s[lane] = t[lane] * c[lane];
    }
    let choose = |new: [f64; W], old: [f64; W]| {
        let mut chosen = [0.0; W];
        for lane in 0..W {
            let wanted = off_diagonal[lane].abs() > negligible[lane];
            chosen[lane] = if wanted { new[lane] } else { old[lane] };
        }
        chosen
    };
    let turn = |a: [f64; W], b: [f64; W]| {
        let (mut first, mut second) = ([0.0; W], [0.0; W]);
        for lane in 0..W {
            first[lane] = c[lane] * a[lane] - s[lane] * b[lane];
            second[lane] = s[lane] * a[lane] + c[lane] * b[lane];
        }
        (choose(first, a), choose(second, b))
    };
    let (mut less, mut more) = ([0.0; W], [0.0; W]);
    for lane in 0..W {
        less[lane] = pp[lane] - t[lane] * off_diagonal[lane];
        more[lane] = qq[lane] + t[lane] * off_diagonal[lane];
    }
    m[P][P] = choose(less, pp);
    m[Q][Q] = choose(more, qq);
    m[P][Q] = choose([0.0; W], off_diagonal);
    m[Q][P] = m[P][Q];
    (m[r][P], m[r][Q]) = turn(m[r][P], m[r][Q]);
    m[P][r] = m[r][P];
    m[Q][r] = m[r][Q];
    for k in 0..3 {
        (directions[P][k], directions[Q][k]) = turn(directions[P][k], directions[Q][k]);
    }
    true
}
