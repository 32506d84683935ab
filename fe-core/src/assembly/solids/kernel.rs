//! The loops over an element's nodes, compiled for each number of nodes N.
//!
//! Everything works with gradients by reference coordinates, of which a displacement u_i of node i gives
//! H = Σ u_i ⊗ ∂N_i/∂X and, about an axis, H₃₃ = Σ u_i1 N_i/R:
//!
//! ```text
//! f_i = ∫ P · ∂N_i/∂X dV        K_ij = ∫ ∂N_i/∂X · ∂P/∂F · ∂N_j/∂X dV
//! ```
//!
//! with P and ∂P/∂F of [`crate::kinematics::finite`], or σ and C where strains are small. One pair of kernels handles
//! both; node blocks of 2 × 2 keep the inner loops in registers.

use crate::kinematics::finite::{GRADIENT_COMPONENTS, Gradient, NominalTangent};

/// Two numbers per node.
pub(super) type Nodal<const N: usize> = [[f64; 2]; N];

/// The shape functions of a point: ∂N_i/∂X and, about an axis, N_i/R.
pub(super) struct PointShape<'a, const N: usize> {
    pub(super) gradients: &'a Nodal<N>,
    pub(super) hoop: Option<[f64; N]>,
}

impl<const N: usize> PointShape<'_, N> {
    /// H.
    #[inline]
    pub(super) fn gradient(&self, displacements: &Nodal<N>) -> Gradient {
        let mut h = [0.0; GRADIENT_COMPONENTS];
        for ([u, v], [x, y]) in displacements.iter().zip(self.gradients) {
            h[0] += u * x;
            h[1] += u * y;
            h[2] += v * x;
            h[3] += v * y;
        }
        if let Some(hoop) = &self.hoop {
            h[4] = displacements.iter().zip(hoop).map(|([u, _], value)| u * value).sum();
        }
        h
    }

    /// Adds the conjugate of H: the nodal values of what multiplies each component.
    #[inline]
    pub(super) fn add_conjugate(&self, conjugate: &Gradient, factor: f64, nodal: &mut Nodal<N>) {
        let [p11, p12, p21, p22, p33] = conjugate.map(|component| component * factor);
        for ([f, g], [x, y]) in nodal.iter_mut().zip(self.gradients) {
            *f += p11 * x + p12 * y;
            *g += p21 * x + p22 * y;
        }
        if let Some(hoop) = &self.hoop {
            for ([f, _], value) in nodal.iter_mut().zip(hoop) {
                *f += p33 * value;
            }
        }
    }

    /// Adds ∂N/∂X · tangent · ∂N/∂X · volume. `UPPER`: node blocks on and above the diagonal only, for a symmetric
    /// tangent; [`mirror`] makes the rest.
    #[inline]
    pub(super) fn add_stiffness<const UPPER: bool>(
        &self,
        tangent: &NominalTangent,
        volume: f64,
        stiffness: &mut [Nodal<N>],
    ) {
        let tangent = tangent.map(|row| row.map(|entry| entry * volume));
        match &self.hoop {
            None => {
                let rates = [0, 1, 2, 3].map(|k| self.rates(&tangent[k]));
                add_plane::<N, UPPER>(self.gradients, &rates, stiffness);
            }
            Some(hoop) => {
                let rates = tangent.map(|row| {
                    let mut rates = self.rates(&row);
                    for (rate, value) in rates.iter_mut().zip(hoop) {
                        rate[0] += row[4] * value;
                    }
                    rates
                });
                let [plane @ .., around] = &rates;
                add_plane::<N, UPPER>(self.gradients, plane, stiffness);
                // by index, LLVM 22 (rustc 1.95) vectorises the upper half of eight nodes wrongly at opt-level 3
                for (i, (factor, row)) in hoop.iter().zip(stiffness.iter_mut().step_by(2)).enumerate() {
                    for (target, rate) in row.iter_mut().zip(around).skip(if UPPER { i } else { 0 }) {
                        target[0] += factor * rate[0];
                        target[1] += factor * rate[1];
                    }
                }
            }
        }
    }

    /// ∂P_k by each freedom, without the hoop's share.
    #[inline(always)]
    fn rates(&self, [a11, a12, a21, a22, _]: &[f64; GRADIENT_COMPONENTS]) -> Nodal<N> {
        self.gradients.map(|[x, y]| [a11 * x + a12 * y, a21 * x + a22 * y])
    }
}

#[inline(always)]
fn add_plane<const N: usize, const UPPER: bool>(
    gradients: &Nodal<N>,
    rates: &[Nodal<N>; 4],
    stiffness: &mut [Nodal<N>],
) {
    for (i, ([x, y], rows)) in gradients.iter().zip(stiffness.as_chunks_mut::<2>().0).enumerate() {
        let [first, second] = rows;
        for j in if UPPER { i } else { 0 }..N {
            for c in 0..2 {
                first[j][c] += x * rates[0][j][c] + y * rates[1][j][c];
                second[j][c] += x * rates[2][j][c] + y * rates[3][j][c];
            }
        }
    }
}

/// Adds column ⊗ row.
pub(super) fn add_product<const N: usize>(column: &Nodal<N>, row: &Nodal<N>, stiffness: &mut [Nodal<N>]) {
    for (factor, target) in column.as_flattened().iter().zip(stiffness) {
        for (target, value) in target.as_flattened_mut().iter_mut().zip(row.as_flattened()) {
            *target += factor * value;
        }
    }
}

/// Copies what is above the diagonal below it.
pub(super) fn mirror<const N: usize>(stiffness: &mut [Nodal<N>]) {
    for row in 0..2 * N {
        for column in 0..row {
            stiffness[row][column / 2][column % 2] = stiffness[column][row / 2][row % 2];
        }
    }
}
