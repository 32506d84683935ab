//! Sparse LLᵀ of a symmetric, positive definite matrix.

use faer::dyn_stack::{MemBuffer, MemStack};
use faer::linalg::cholesky::llt::factor::{LltError, LltRegularization};
use faer::sparse::SparseColMatRef;
use faer::sparse::linalg::cholesky::supernodal::{
    SupernodalLltRef, factorize_supernodal_numeric_llt, factorize_supernodal_numeric_llt_scratch,
};
use faer::{Conj, Mat, Par, Spec};

use super::analysis::Analysis;
use super::{SINGULAR_PIVOT, SolverError, column};

/// A matrix that has no LLᵀ.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Refusal {
    /// A pivot is not positive; its place in the order of elimination.
    NotDefinite { place: usize },
    /// A pivot is lost in rounding.
    Singular { place: usize },
}

/// The factor L of P A Pᵀ = L Lᵀ, with memory to compute and to use it.
pub(super) struct Cholesky {
    pub analysis: Analysis,
    lower: Vec<f64>,
    pub factor: Vec<f64>,
    memory: MemBuffer,
}

impl Cholesky {
    /// Memory for a factor.
    pub(super) fn new(analysis: Analysis) -> Result<Self, SolverError> {
        let supernodes = &analysis.supernodes;
        let scratch = factorize_supernodal_numeric_llt_scratch::<usize, f64>(supernodes, Par::Seq, Spec::default())
            .or(supernodes.solve_in_place_scratch::<f64>(1, Par::Seq));
        Ok(Self {
            memory: MemBuffer::try_new(scratch)?,
            lower: vec![0.0; analysis.from.len()],
            factor: vec![0.0; supernodes.len_val()],
            analysis,
        })
    }

    /// Factorises A + diag(`shift`); `shift` belongs to the last equations, in their order of elimination.
    pub(super) fn factorise(&mut self, values: &[f64], shift: &[f64]) -> Result<(), Refusal> {
        let analysis = &self.analysis;
        self.lower.iter_mut().zip(&analysis.from).for_each(|(entry, &from)| *entry = values[from]);
        let first = analysis.order.len() - shift.len();
        for (&diagonal, shift) in analysis.diagonal[first..].iter().zip(shift) {
            self.lower[diagonal] += shift;
        }
        factorize_supernodal_numeric_llt(
            &mut self.factor,
            SparseColMatRef::new(analysis.lower.as_ref(), &self.lower),
            LltRegularization::default(),
            &analysis.supernodes,
            Par::Seq,
            MemStack::new(&mut self.memory),
            Spec::default(),
        )
        .map_err(|LltError::NonPositivePivot { index }| Refusal::NotDefinite { place: index })?;
        self.check_pivots()
    }

    /// Checks that no pivot is lost in the rounding of the diagonal entry from which it was left over.
    fn check_pivots(&self) -> Result<(), Refusal> {
        let factor = self.view();
        for index in 0..self.analysis.supernodes.n_supernodes() {
            let supernode = factor.supernode(index);
            for column in 0..supernode.val().ncols() {
                let place = supernode.start() + column;
                let pivot = supernode.val()[(column, column)].powi(2);
                let lost = SINGULAR_PIVOT * self.lower[self.analysis.diagonal[place]];
                if pivot.is_nan() || pivot <= lost {
                    return Err(Refusal::Singular { place });
                }
            }
        }
        Ok(())
    }

    fn view(&self) -> SupernodalLltRef<'_, usize, f64> {
        SupernodalLltRef::new(&self.analysis.supernodes, &self.factor)
    }

    /// x ← L⁻¹ x, x in the order of elimination.
    pub(super) fn forward(&mut self, x: &mut [f64]) {
        let factor = SupernodalLltRef::new(&self.analysis.supernodes, &self.factor);
        factor.l_solve_with_conj(Conj::No, column(x), Par::Seq, MemStack::new(&mut self.memory));
    }

    /// x ← L⁻ᵀ x, x in the order of elimination.
    pub(super) fn backward(&mut self, x: &mut [f64]) {
        let factor = SupernodalLltRef::new(&self.analysis.supernodes, &self.factor);
        factor.l_transpose_solve_with_conj(Conj::No, column(x), Par::Seq, MemStack::new(&mut self.memory));
    }

    /// Copies as many of the last rows and columns of L as `triangle` has; zero above the diagonal.
    pub(super) fn copy_trailing(&self, triangle: &mut Mat<f64>) {
        let first = self.analysis.order.len() - triangle.nrows();
        triangle.fill(0.0);
        let factor = self.view();
        for index in (0..self.analysis.supernodes.n_supernodes()).rev() {
            let supernode = factor.supernode(index);
            let (start, values) = (supernode.start(), supernode.val());
            let columns = values.ncols();
            if start + columns <= first {
                break;
            }
            for column in first.saturating_sub(start)..columns {
                let target = start + column - first;
                for row in column..columns {
                    triangle[(start + row - first, target)] = values[(row, column)];
                }
                for (row, &place) in supernode.pattern().iter().enumerate() {
                    triangle[(place - first, target)] = values[(columns + row, column)];
                }
            }
        }
    }
}
