//! Symmetric systems condensed onto a few equations: LLᵀ with these last.

use faer::linalg::matmul::triangular::{self, BlockStructure};
use faer::{Accum, Mat, Par};

use super::analysis::{Analysis, body_by_body};
use super::cholesky::{Cholesky, Refusal};
use super::graph::NONE;
use super::ordering::elimination_order;
use super::{Pattern, SolverError};

/// Shifts added to the diagonal of the zone, relative to it, so that A has an LLᵀ although a body may be held by contact
/// alone; a soft zone needs the second. They are subtracted again, which costs as many digits as they have more than A.
const SHIFTS: [f64; 2] = [1.0, 100.0];

/// A condensed onto the equations of a zone: with the zone last,
///
/// ```text
/// A + shift = L Lᵀ      S = A_ZZ − A_ZI A_II⁻¹ A_IZ = L_ZZ L_ZZᵀ − shift
/// ```
pub(super) struct SchurComplement {
    cholesky: Cholesky,
    /// The place in the zone of each equation of the system; `NONE` outside.
    pub(super) place_of: Vec<usize>,
    /// Indices in the pattern of the values of the zone's diagonal.
    diagonal: Vec<usize>,
    shift: Vec<f64>,
    /// L_ZZ.
    triangle: Mat<f64>,
    /// S in the order of the zone, both triangles.
    pub(super) schur: Mat<f64>,
}

impl SchurComplement {
    /// Analyses a pattern for the zone of these equations. `positions` of all equations: as for the order of elimination.
    pub(super) fn new(
        pattern: &Pattern,
        nodes: &[usize],
        positions: &[[f64; 2]],
        equations: &[usize],
    ) -> Result<Self, SolverError> {
        let zone = body_by_body(pattern, equations);
        let (order, _) = elimination_order(pattern, nodes, positions, &zone)?;
        let mut place_of = vec![NONE; pattern.size()];
        zone.iter().enumerate().for_each(|(place, &equation)| place_of[equation] = place);
        let count = zone.len();
        Ok(Self {
            cholesky: Cholesky::new(Analysis::new(pattern, order)?)?,
            place_of,
            diagonal: zone.iter().filter_map(|&equation| pattern.index(equation, equation)).collect(),
            shift: vec![0.0; count],
            triangle: Mat::zeros(count, count),
            schur: Mat::zeros(count, count),
        })
    }

    /// Returns how many equations the zone has.
    pub(super) fn len(&self) -> usize {
        self.shift.len()
    }

    /// Multiplications and additions of LLᵀ and of S.
    pub(super) fn flops(&self) -> f64 {
        self.cholesky.analysis.flops + dense_cholesky_flops(self.len())
    }

    /// Returns how many numbers the factor has.
    pub(super) fn entries(&self) -> usize {
        self.cholesky.factor.len()
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
        // x_Z ← L_ZZᵀ x_Z: back substitution then finds x_Z, and goes on to the others
        let first = x.len() - self.len();
        let zone = &mut x[first..];
        for column in 0..zone.len() {
            zone[column] = (column..zone.len()).map(|row| self.triangle[(row, column)] * zone[row]).sum();
        }
        self.cholesky.backward(x);
    }

    /// Takes the equations of the system into the order of elimination.
    pub(super) fn gather(&self, from: &[f64], to: &mut [f64]) {
        to.iter_mut().zip(&self.cholesky.analysis.order).for_each(|(to, &equation)| *to = from[equation]);
    }

    /// Scatters a vector of the zone back into one of the system.
    pub(super) fn scatter(&self, from: &[f64], to: &mut [f64]) {
        from.iter().zip(&self.cholesky.analysis.order).for_each(|(from, &equation)| to[equation] = *from);
    }
}

/// Multiplications and additions of a dense LLᵀ, or of a triangle times its transpose.
pub(super) fn dense_cholesky_flops(size: usize) -> f64 {
    (size as f64).powi(3) / 3.0
}
