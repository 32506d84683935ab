//! Sparse LU with partial pivoting: for what everything else refuses.

use faer::dyn_stack::{MemBuffer, MemStack};
use faer::sparse::linalg::lu::{LuRef, LuSymbolicParams, NumericLu, SymbolicLu, factorize_symbolic_lu};
use faer::sparse::linalg::{LuError, SupernodalThreshold};
use faer::sparse::{SparseColMatRef, SymbolicSparseColMat};
use faer::{Conj, Par, Spec};

use super::method::{Factorisation, Layout};
use super::{LARGEST_GROWTH, Pattern, SolverError, SystemMatrix, column};
use crate::threads::Threads;

/// faer's LU of a pattern, with memory to compute and to use it.
pub(super) struct GeneralLu {
    pattern: SymbolicSparseColMat<usize>,
    symbolic: SymbolicLu<usize>,
    numeric: NumericLu<usize, f64>,
    memory: MemBuffer,
}

impl Factorisation for GeneralLu {
    fn analyse(pattern: &Pattern, _: &Layout) -> Result<Option<Self>, SolverError> {
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
        Ok(Some(Self { memory: MemBuffer::try_new(scratch)?, pattern, symbolic, numeric: NumericLu::new() }))
    }

    /// Factorises finite values. faer does not notice a zero pivot: the matrix is singular if a right side of ones with changing
    /// signs is answered by a vector that is greater than a regular matrix of this norm could make it.
    fn factorise(&mut self, values: &[f64], matrix: &SystemMatrix, threads: &Threads) -> Result<bool, SolverError> {
        let size = self.pattern.ncols() as u64;
        let taken = SparseColMatRef::new(self.pattern.as_ref(), values);
        let stack = MemStack::new(&mut self.memory);
        match self.symbolic.factorize_numeric_lu(&mut self.numeric, taken, Par::Seq, stack, Spec::default()) {
            Ok(_) => {}
            Err(LuError::SymbolicSingular { .. }) => return Err(SolverError::Singular { equation: None }),
            Err(LuError::Generic(error)) => return Err(error.into()),
        }
        // The signs follow the bits of the golden ratio's multiples: no smooth mode is orthogonal to them.
        let signs = (1..=size).map(|i| (i.wrapping_mul(0x9E37_79B9_7F4A_7C15) >> 63) as f64);
        let mut answer: Vec<f64> = signs.map(|sign| 1.0 - 2.0 * sign).collect();
        self.solve(&mut answer, threads);
        let greatest = answer.iter().map(|x| if x.is_nan() { f64::INFINITY } else { x.abs() });
        if greatest.fold(0.0, f64::max) * matrix.norm() > LARGEST_GROWTH {
            return Err(SolverError::Singular { equation: None });
        }
        Ok(true)
    }

    fn solve(&mut self, x: &mut [f64], _: &Threads) {
        let factor = LuRef::new_unchecked(&self.symbolic, &self.numeric);
        factor.solve_in_place_with_conj(Conj::No, column(x), Par::Seq, MemStack::new(&mut self.memory));
    }
}
