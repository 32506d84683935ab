//! Sparse LU with partial pivoting: for what everything else refuses.

use faer::dyn_stack::{MemBuffer, MemStack};
use faer::sparse::linalg::lu::{LuRef, LuSymbolicParams, NumericLu, SymbolicLu, factorize_symbolic_lu};
use faer::sparse::linalg::{LuError, SupernodalThreshold};
use faer::sparse::{SparseColMatRef, SymbolicSparseColMat};
use faer::{Conj, Par, Spec};

use super::{Pattern, SolverError, column};

/// faer's LU of a pattern, with memory to compute and to use it.
pub(super) struct GeneralLu {
    pattern: SymbolicSparseColMat<usize>,
    symbolic: SymbolicLu<usize>,
    numeric: NumericLu<usize, f64>,
    memory: MemBuffer,
}

impl GeneralLu {
    /// Analyses a pattern.
    pub(super) fn new(pattern: &Pattern) -> Result<Self, SolverError> {
        let (size, starts, rows) = (pattern.size(), pattern.column_starts().to_vec(), pattern.rows().to_vec());
        let pattern = SymbolicSparseColMat::new_checked(size, size, starts, None, rows);
        let parameters = LuSymbolicParams {
            supernodal_flop_ratio_threshold: SupernodalThreshold::FORCE_SUPERNODAL,
            ..LuSymbolicParams::default()
        };
        let symbolic = factorize_symbolic_lu(pattern.as_ref(), parameters)?;
        let scratch = symbolic
            .factorize_numeric_lu_scratch::<f64>(Par::Seq, Spec::default())
            .or(symbolic.solve_in_place_scratch::<f64>(1, Par::Seq));
        Ok(Self { memory: MemBuffer::try_new(scratch)?, pattern, symbolic, numeric: NumericLu::new() })
    }

    /// Factorises finite values. A zero pivot is not noticed: the solution then is not finite, or of absurd size.
    pub(super) fn factorise(&mut self, values: &[f64]) -> Result<(), SolverError> {
        let matrix = SparseColMatRef::new(self.pattern.as_ref(), values);
        let stack = MemStack::new(&mut self.memory);
        match self.symbolic.factorize_numeric_lu(&mut self.numeric, matrix, Par::Seq, stack, Spec::default()) {
            Ok(_) => Ok(()),
            Err(LuError::SymbolicSingular { .. }) => Err(SolverError::Singular { equation: None }),
            Err(LuError::Generic(error)) => Err(error.into()),
        }
    }

    /// Solves in place.
    pub(super) fn solve(&mut self, x: &mut [f64]) {
        let factor = LuRef::new_unchecked(&self.symbolic, &self.numeric);
        factor.solve_in_place_with_conj(Conj::No, column(x), Par::Seq, MemStack::new(&mut self.memory));
    }
}
