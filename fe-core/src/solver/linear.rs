//! The solver: chooses a method, keeps its factors, checks its solutions.

use std::sync::Arc;

use super::method::Layout;
use super::whole::Whole;
use super::{
    ACCEPTED_RESIDUAL, Blocks, FactorisationReport, LARGEST_RESIDUAL, Method, Pattern, REFINED_RESIDUAL, ROUNDING,
    ROUNDING_MARGIN, SYMMETRIC_BLOCK, SolveReport, SolverError, SolverOptions, Symmetry, SystemMatrix,
};
use crate::threads::Threads;

/// Factorises and solves systems over one pattern; see the module's page for how.
pub struct LinearSolver {
    layout: Layout,
    options: SolverOptions,
    /// Present after the first factorisation.
    whole: Option<Whole>,
    /// The factor that solves, by its method, and the symmetry of its solids.
    factor: Option<(Method, Symmetry)>,
}

impl LinearSolver {
    /// A solver for matrices over `pattern`. `nodes` has the node of each equation, by any numbering (the graph of the
    /// nodes is ordered).
    pub fn new(pattern: &Arc<Pattern>, nodes: &[usize], options: SolverOptions) -> Self {
        Self { layout: Layout::new(pattern, nodes), options, whole: None, factor: None }
    }

    /// Makes another solver for the same pattern.
    pub(crate) fn anew(&self) -> Self {
        Self { layout: self.layout.clone(), options: self.options, whole: None, factor: None }
    }

    /// Sets the position of each equation's node, mm: a large definite matrix is then factorised in parts.
    pub fn with_positions(mut self, positions: Vec<[f64; 2]>) -> Self {
        self.layout.positions = positions;
        self
    }

    /// The threads that work on the parts. Their number changes no bit of a solution.
    pub fn set_threads(&mut self, threads: &Threads) {
        self.layout.threads = threads.clone();
    }

    /// Factorises a matrix, by the first method that can.
    ///
    /// # Errors
    ///
    /// If the matrix has a number that is not finite, or is singular. There is no factor then.
    pub fn factorise(&mut self, matrix: &SystemMatrix, symmetry: Symmetry) -> Result<FactorisationReport, SolverError> {
        self.factor = None;
        matrix.check_finite()?;
        let mut whole = self.whole.take().unwrap_or_else(|| Whole::new(matrix));
        if self.options.forgets {
            whole.forget_factors();
        }
        let pattern_reused = whole.fill(matrix);
        let (method, was_analysed) = self.factorise_filled(&mut whole, matrix, symmetry)?;
        let (flops, factor_entries) = whole.size_of(method).unzip();
        self.whole = Some(whole);
        self.factor = Some((method, symmetry));
        Ok(FactorisationReport { method, symbolic_reused: pattern_reused && was_analysed, flops, factor_entries })
    }

    /// The first method that can, and whether it had been analysed before.
    fn factorise_filled(
        &self,
        whole: &mut Whole,
        matrix: &SystemMatrix,
        symmetry: Symmetry,
    ) -> Result<(Method, bool), SolverError> {
        let is_symmetric = symmetry == Symmetry::Symmetric && is_symmetric(&matrix.contact);
        for method in Method::ALL {
            if self.options.first_method.is_some_and(|first| method < first) || !method.applies(is_symmetric) {
                continue;
            }
            let was_analysed = whole.is_analysed(method);
            if whole.factorise(method, &self.layout, matrix)? {
                return Ok((method, was_analysed));
            }
        }
        Err(SolverError::Singular { equation: None })
    }

    /// Returns what the next factorisation depends on in addition to its matrix: the symmetry of the solids if there is
    /// a factor, and the pattern of the whole if there is one.
    pub fn memory(&self) -> (Option<Symmetry>, Option<Pattern>) {
        (self.factor.map(|(_, symmetry)| symmetry), self.whole.as_ref().map(|whole| whole.pattern.clone()))
    }

    /// Takes over the memory of another solver of the same pattern, and makes its factor of its matrix.
    ///
    /// # Errors
    ///
    /// There is no factor.
    pub(crate) fn take_memory(
        &mut self,
        (symmetry, pattern): &(Option<Symmetry>, Option<Pattern>),
        matrix: &SystemMatrix,
    ) -> Result<(), SolverError> {
        self.whole = pattern.as_ref().map(|pattern| Whole::over(pattern.clone(), &self.layout.solids));
        symmetry.map_or(Ok(()), |symmetry| self.factorise(matrix, symmetry).map(drop))
    }

    /// Solves K x = `right_side` in place with the last factor, which must be that of `matrix`.
    ///
    /// # Errors
    ///
    /// Without a factor, for a right side that is not finite, and if what the solution leaves of the right side stays above
    /// [`ACCEPTED_RESIDUAL`]. The right side is as it was then.
    pub fn solve(&mut self, matrix: &SystemMatrix, right_side: &mut [f64]) -> Result<SolveReport, SolverError> {
        let (method, _) = self.factor.ok_or(SolverError::NotFactorised)?;
        if let Some(equation) = right_side.iter().position(|value| !value.is_finite()) {
            return Err(SolverError::RightSide { equation });
        }
        let scale = greatest(right_side);
        if scale == 0.0 {
            return Ok(SolveReport { relative_residual: 0.0, refined: false });
        }
        let mut solution = right_side.to_vec();
        self.apply(method, &mut solution);
        let report = self.refine(method, matrix, right_side, &mut solution, scale)?;
        right_side.copy_from_slice(&solution);
        Ok(report)
    }

    /// Corrects a solution once if it needs it.
    fn refine(
        &mut self,
        method: Method,
        matrix: &SystemMatrix,
        right_side: &[f64],
        solution: &mut [f64],
        scale: f64,
    ) -> Result<SolveReport, SolverError> {
        let mut residual = vec![0.0; right_side.len()];
        let mut left = set_residual(matrix, right_side, solution, &mut residual) / scale;
        let (mut refined, mut tolerance) = (false, ACCEPTED_RESIDUAL);
        if left.is_nan() || left > REFINED_RESIDUAL {
            let rounding = ROUNDING * matrix.norm() * greatest(solution) / scale;
            refined = left.is_nan() || left > rounding;
            if refined {
                self.apply(method, &mut residual);
                solution.iter_mut().zip(&residual).for_each(|(x, correction)| *x += correction);
                left = set_residual(matrix, right_side, solution, &mut residual) / scale;
            }
            tolerance = tolerance.max((ROUNDING_MARGIN * rounding).min(LARGEST_RESIDUAL));
        }
        if left <= tolerance {
            Ok(SolveReport { relative_residual: left, refined })
        } else {
            Err(SolverError::Residual { residual: left, tolerance })
        }
    }

    /// x ← K⁻¹ x by the factor, unchecked.
    fn apply(&mut self, method: Method, x: &mut [f64]) {
        if let Some(whole) = &mut self.whole {
            whole.solve(method, x, &self.layout.threads);
        }
    }
}

/// Returns whether each block is symmetric up to rounding.
fn is_symmetric(contact: &Blocks) -> bool {
    contact.iter().all(|(rows, values)| {
        let accepted = SYMMETRIC_BLOCK * greatest(values);
        let count = rows.len();
        (0..count).all(|i| (0..i).all(|j| (values[i * count + j] - values[j * count + i]).abs() <= accepted))
    })
}

/// residual = right side − K x; returns its greatest magnitude, NaN if there is one.
fn set_residual(matrix: &SystemMatrix, right_side: &[f64], x: &[f64], residual: &mut [f64]) -> f64 {
    matrix.multiply(x, residual);
    residual.iter_mut().zip(right_side).for_each(|(residual, right)| *residual = right - *residual);
    greatest(residual)
}

/// The greatest magnitude; NaN if there is one.
fn greatest(values: &[f64]) -> f64 {
    values
        .iter()
        .map(|value| value.abs())
        .fold(0.0, |greatest, value| if value <= greatest || greatest.is_nan() { greatest } else { value })
}
