//! Systems condensed onto a few equations: LLᵀ of the solids with these last, and a dense unsymmetric matrix on them.

use std::sync::Arc;

use faer::dyn_stack::{MemBuffer, MemStack};
use faer::linalg::lu::partial_pivoting::factor::{PartialPivLuParams, lu_in_place, lu_in_place_scratch};
use faer::linalg::lu::partial_pivoting::solve::{solve_in_place, solve_in_place_scratch};
use faer::linalg::matmul::triangular::{self, BlockStructure};
use faer::perm::PermRef;
use faer::{Accum, Mat, MatMut, Par, Spec};

use super::analysis::{Analysis, body_by_body};
use super::cholesky::{Cholesky, Refusal};
use super::graph::NONE;
use super::ordering::elimination_order;
use super::{Blocks, Pattern, SINGULAR_PIVOT, SolverError};

/// What is added to the diagonal of the zone, relative to it, so that A has an LLᵀ although a body may hang on contact
/// alone; a soft zone needs the second. It is taken off again, which costs as many digits as it has more than A.
const SHIFTS: [f64; 2] = [1.0, 100.0];

/// A condensed onto the equations of a zone: with the zone last,
///
/// ```text
/// A + shift = L Lᵀ      S = A_ZZ − A_ZI A_II⁻¹ A_IZ = L_ZZ L_ZZᵀ − shift
/// ```
pub(super) struct Zone {
    cholesky: Cholesky,
    /// The place in the zone of each equation of the system.
    place_of: Vec<usize>,
    /// Where the values of the zone's diagonal are in the pattern.
    diagonal: Vec<usize>,
    shift: Vec<f64>,
    /// L_ZZ.
    triangle: Mat<f64>,
    /// S, both triangles.
    schur: Mat<f64>,
}

impl Zone {
    /// Analyses a pattern for the zone of these equations. `positions` of all equations: as for the order of elimination.
    pub(super) fn new(
        pattern: &Pattern,
        nodes: &[usize],
        positions: &[[f64; 2]],
        equations: &[usize],
    ) -> Result<Self, SolverError> {
        let zone = body_by_body(pattern, equations);
        let order = elimination_order(pattern, nodes, positions, &zone)?;
        let mut place_of = vec![NONE; pattern.size()];
        zone.iter().enumerate().for_each(|(place, &equation)| place_of[equation] = place);
        let count = zone.len();
        Ok(Self {
            cholesky: Cholesky::new(Arc::new(Analysis::new(pattern, order)?))?,
            place_of,
            diagonal: zone.iter().filter_map(|&equation| pattern.index(equation, equation)).collect(),
            shift: vec![0.0; count],
            triangle: Mat::zeros(count, count),
            schur: Mat::zeros(count, count),
        })
    }

    /// How many equations the zone has.
    pub(super) fn len(&self) -> usize {
        self.shift.len()
    }

    /// The place of an equation in the zone; `NONE` outside.
    pub(super) fn place_of(&self, equation: usize) -> usize {
        self.place_of[equation]
    }

    /// Multiplications and additions of LLᵀ and of S.
    pub(super) fn flops(&self) -> f64 {
        self.cholesky.analysis.flops + dense_cholesky_flops(self.len())
    }

    /// How many numbers the factor has.
    pub(super) fn entries(&self) -> usize {
        self.cholesky.entries()
    }

    /// The equation that is eliminated at a place.
    pub(super) fn equation(&self, place: usize) -> usize {
        self.cholesky.analysis.order[place]
    }

    /// Factorises A and computes S.
    pub(super) fn condense(&mut self, values: &[f64]) -> Result<(), Refusal> {
        let first = self.place_of.len() - self.len();
        let mut result = Ok(());
        for factor in SHIFTS {
            self.set_shift(values, factor);
            result = self.cholesky.factorise(values, &self.shift);
            match result {
                Err(Refusal::NotDefinite { place }) if place >= first => {}
                _ => break,
            }
        }
        result?;
        self.cholesky.copy_trailing(&mut self.triangle);
        triangular::matmul(
            &mut self.schur,
            BlockStructure::TriangularLower,
            Accum::Replace,
            &self.triangle,
            BlockStructure::TriangularLower,
            self.triangle.transpose(),
            BlockStructure::TriangularUpper,
            1.0,
            Par::Seq,
        );
        for column in 0..self.len() {
            self.schur[(column, column)] -= self.shift[column];
            (0..column).for_each(|row| self.schur[(row, column)] = self.schur[(column, row)]);
        }
        Ok(())
    }

    /// The shift follows the stiffness of each equation; those without any take the greatest.
    fn set_shift(&mut self, values: &[f64], factor: f64) {
        let magnitudes = self.diagonal.iter().map(|&place| values[place].abs());
        let greatest = magnitudes.clone().fold(0.0, f64::max);
        let least = if greatest > 0.0 { greatest * f64::EPSILON } else { 1.0 };
        let fallback = if greatest > 0.0 { greatest } else { 1.0 };
        for (shift, magnitude) in self.shift.iter_mut().zip(magnitudes) {
            *shift = factor * if magnitude >= least { magnitude } else { fallback };
        }
    }

    /// S in the order of the zone.
    pub(super) fn schur(&self) -> &Mat<f64> {
        &self.schur
    }

    /// x ← L⁻¹ x, then its zone part the right side that is left for S.
    pub(super) fn forward(&mut self, x: &mut [f64]) {
        self.cholesky.forward(x);
        let first = x.len() - self.len();
        let zone = &mut x[first..];
        for column in (0..zone.len()).rev() {
            let factor = std::mem::take(&mut zone[column]);
            (column..zone.len()).for_each(|row| zone[row] += self.triangle[(row, column)] * factor);
        }
    }

    /// The displacements of all equations from those of the zone and what [`Self::forward`] left of the others.
    pub(super) fn backward(&mut self, x: &mut [f64]) {
        self.multiply_by_transposed_triangle(x);
        self.cholesky.backward(x);
    }

    /// The same with memory of its own.
    pub(super) fn backward_apart(&self, x: &mut [f64]) -> Result<(), SolverError> {
        self.multiply_by_transposed_triangle(x);
        self.cholesky.backward_apart(x)
    }

    /// x_Z ← L_ZZᵀ x_Z: back substitution then finds x_Z, and goes on to the others.
    fn multiply_by_transposed_triangle(&self, x: &mut [f64]) {
        let first = x.len() - self.len();
        let zone = &mut x[first..];
        for column in 0..zone.len() {
            zone[column] = (column..zone.len()).map(|row| self.triangle[(row, column)] * zone[row]).sum();
        }
    }

    /// Takes the equations of the system into the order of elimination.
    pub(super) fn gather(&self, from: &[f64], to: &mut [f64]) {
        to.iter_mut().zip(&self.cholesky.analysis.order).for_each(|(to, &equation)| *to = from[equation]);
    }

    /// And back.
    pub(super) fn scatter(&self, from: &[f64], to: &mut [f64]) {
        from.iter().zip(&self.cholesky.analysis.order).for_each(|(from, &equation)| to[equation] = *from);
    }
}

/// Multiplications and additions of a dense LLᵀ, or of a triangle times its transpose.
pub(super) fn dense_cholesky_flops(size: usize) -> f64 {
    (size as f64).powi(3) / 3.0
}

/// Dense LU of S + contact.
pub(super) struct DenseLu {
    matrix: Mat<f64>,
    permutation: Vec<usize>,
    inverse: Vec<usize>,
    memory: MemBuffer,
}

impl DenseLu {
    /// Memory for `size` equations.
    pub(super) fn new(size: usize) -> Result<Self, SolverError> {
        let scratch = lu_in_place_scratch::<usize, f64>(size, size, Par::Seq, parameters())
            .or(solve_in_place_scratch::<usize, f64>(size, 1, Par::Seq));
        Ok(Self {
            matrix: Mat::zeros(size, size),
            permutation: vec![0; size],
            inverse: vec![0; size],
            memory: MemBuffer::try_new(scratch)?,
        })
    }

    /// Factorises S + Σ blocks; returns whether the determinant is positive, or the place of a pivot that is lost in
    /// the rounding of its column.
    pub(super) fn factorise(&mut self, zone: &Zone, contact: &Blocks) -> Result<bool, usize> {
        let size = zone.len();
        self.matrix.copy_from(zone.schur());
        for (rows, values) in contact.iter() {
            for (row, line) in rows.iter().zip(values.chunks_exact(rows.len().max(1))) {
                for (column, value) in rows.iter().zip(line) {
                    self.matrix[(zone.place_of(*row), zone.place_of(*column))] += value;
                }
            }
        }
        // Before elimination, S itself is left over from A: its rounding is that of the shifted diagonal.
        let scales: Vec<f64> = (0..size)
            .map(|column| (0..size).map(|row| self.matrix[(row, column)].abs()).fold(zone.shift[column], f64::max))
            .collect();
        let (info, _) = lu_in_place(
            self.matrix.as_mut(),
            &mut self.permutation,
            &mut self.inverse,
            Par::Seq,
            MemStack::new(&mut self.memory),
            parameters(),
        );
        let mut positive = info.transposition_count.is_multiple_of(2);
        for (place, scale) in scales.iter().enumerate() {
            let pivot = self.matrix[(place, place)];
            if pivot.is_nan() || pivot.abs() <= SINGULAR_PIVOT * scale {
                return Err(place);
            }
            positive ^= pivot < 0.0;
        }
        Ok(positive)
    }

    /// Solves in place.
    pub(super) fn solve(&mut self, x: &mut [f64]) {
        let size = x.len();
        solve_in_place(
            self.matrix.as_ref(),
            self.matrix.as_ref(),
            PermRef::new_checked(&self.permutation, &self.inverse, size),
            MatMut::from_column_major_slice_mut(x, size, 1),
            Par::Seq,
            MemStack::new(&mut self.memory),
        );
    }
}

fn parameters() -> Spec<PartialPivLuParams, f64> {
    Spec::default()
}
