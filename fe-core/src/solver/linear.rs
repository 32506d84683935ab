//! The solver: chooses a method, keeps its factors, checks its solutions.

use std::sync::Arc;

use super::analysis::cholesky_flops;
use super::ordering::elimination_order;
use super::pattern::check_length;
use super::whole::{Outcome, Whole};
use super::zone::{DenseLu, Zone};
use super::{
    ACCEPTED_RESIDUAL, Blocks, CONDENSATION_ADVANTAGE, FactorisationReport, LARGEST_RESIDUAL, Method, Pattern,
    REFINED_RESIDUAL, ROUNDING, ROUNDING_MARGIN, SYMMETRIC_BLOCK, SolveReport, SolverError, SolverOptions, Symmetry,
    SystemMatrix,
};
use crate::threads::Threads;

/// Factorises and solves systems over one pattern; see the module's page for how.
pub struct LinearSolver {
    pattern: Arc<Pattern>,
    nodes: Vec<usize>,
    /// Of each equation, if known.
    positions: Vec<[f64; 2]>,
    threads: Threads,
    is_contact: Vec<bool>,
    options: SolverOptions,
    /// Present if condensation is worth its while.
    zone: Option<(Zone, DenseLu)>,
    /// Present after the first factorisation of the whole.
    whole: Option<Whole>,
    /// The factor that solves, by its method.
    factor: Option<Method>,
    /// The symmetry of the solids at their last factorisation, and whether the zone has them.
    solids: Option<(Symmetry, bool)>,
    work: Work,
}

/// Vectors of the size of the system.
struct Work {
    solution: Vec<f64>,
    residual: Vec<f64>,
    ordered: Vec<f64>,
}

impl LinearSolver {
    /// A solver for matrices over `pattern`. `nodes` has the node of each equation, by any numbering (the graph of the
    /// nodes is ordered); `contact` lists the equations that contact blocks may touch, in any order.
    ///
    /// # Errors
    ///
    /// If a list does not fit the pattern, or memory does not suffice.
    pub fn new(
        pattern: &Arc<Pattern>,
        nodes: &[usize],
        contact: &[usize],
        options: SolverOptions,
    ) -> Result<Self, SolverError> {
        let size = pattern.size();
        check_length("list of nodes", size, nodes.len())?;
        let is_contact = marked(size, contact)?;
        let zone = worthwhile_zone(pattern, nodes, contact, options)?;
        let vector = || vec![0.0; size];
        Ok(Self {
            pattern: Arc::clone(pattern),
            nodes: nodes.to_vec(),
            positions: Vec::new(),
            threads: Threads::default(),
            is_contact,
            options,
            zone,
            whole: None,
            factor: None,
            solids: None,
            work: Work { solution: vector(), residual: vector(), ordered: vector() },
        })
    }

    /// Tells where the node of each equation is, mm: a large definite matrix is then factorised in parts.
    ///
    /// # Errors
    ///
    /// If there is not one position for each equation.
    pub fn with_positions(mut self, positions: Vec<[f64; 2]>) -> Result<Self, SolverError> {
        check_length("list of positions", self.pattern.size(), positions.len())?;
        self.positions = positions;
        Ok(self)
    }

    /// The threads that work on the parts. Their number changes no bit of a solution.
    pub fn set_threads(&mut self, threads: &Threads) {
        self.threads = threads.clone();
    }

    /// Factorises a matrix, by the first method that can.
    ///
    /// # Errors
    ///
    /// If the matrix does not fit the solver, has a number that is not finite, couples by contact what is no contact
    /// equation, or is singular. There is no factor then.
    pub fn factorise(&mut self, matrix: &SystemMatrix, symmetry: Symmetry) -> Result<FactorisationReport, SolverError> {
        (self.factor, self.solids) = (None, None);
        self.check(matrix)?;
        matrix.check_finite()?;
        self.solids = Some((symmetry, false));
        if symmetry == Symmetry::Symmetric
            && let Some(report) = self.condense(matrix)?
        {
            return Ok(report);
        }
        self.factorise_whole(matrix, symmetry)
    }

    /// Factorises a matrix whose solids have the values of the last [`Self::factorise`], which the caller vouches for:
    /// only contact has changed. Condensed, this is one dense LU of the contact equations; otherwise all is redone.
    ///
    /// # Errors
    ///
    /// As [`Self::factorise`], and if there was none.
    pub fn factorise_contact(&mut self, matrix: &SystemMatrix) -> Result<FactorisationReport, SolverError> {
        match self.solids {
            None => Err(SolverError::NotFactorised),
            Some((symmetry, false)) => self.factorise(matrix, symmetry),
            Some((_, true)) => {
                self.factor = None;
                self.check(matrix)?;
                matrix.check_finite_contact()?;
                self.factorise_dense(&matrix.contact, true)
            }
        }
    }

    /// What the next factorisation depends on beside its matrix: the symmetry of the solids if there is a factor, and the
    /// pattern of the whole if there is one.
    pub fn memory(&self) -> (Option<Symmetry>, Option<Pattern>) {
        let symmetry = self.factor.and(self.solids).map(|(symmetry, _)| symmetry);
        (symmetry, self.whole.as_ref().map(|whole| whole.pattern().clone()))
    }

    /// Takes over the memory of another solver of the same pattern, and makes its factor of its matrix.
    ///
    /// # Errors
    ///
    /// Those of [`Self::factorise`], and a pattern of another system.
    pub fn take_memory(
        &mut self,
        (symmetry, pattern): &(Option<Symmetry>, Option<Pattern>),
        matrix: &SystemMatrix,
    ) -> Result<(), SolverError> {
        if let Some(pattern) = pattern {
            if !pattern.is_superset_of(&self.pattern) {
                return Err(SolverError::Pattern);
            }
            self.whole = Some(Whole::over(pattern.clone(), &self.pattern));
        }
        symmetry.map_or(Ok(()), |symmetry| self.factorise(matrix, symmetry).map(|_| ()))
    }

    /// Solves K x = `right_side` in place with the last factor, which must be that of `matrix`.
    ///
    /// # Errors
    ///
    /// Without a factor, for a right side that does not fit or is not finite, and if what the solution leaves of the
    /// right side stays above [`ACCEPTED_RESIDUAL`]. The right side is as it was then.
    pub fn solve(&mut self, matrix: &SystemMatrix, right_side: &mut [f64]) -> Result<SolveReport, SolverError> {
        let method = self.factor.ok_or(SolverError::NotFactorised)?;
        check_length("right side", self.pattern.size(), right_side.len())?;
        self.check(matrix)?;
        if let Some(equation) = right_side.iter().position(|value| !value.is_finite()) {
            return Err(SolverError::RightSide { equation });
        }
        let scale = greatest(right_side);
        if scale == 0.0 {
            return Ok(SolveReport { relative_residual: 0.0, refined: false });
        }
        let mut solution = std::mem::take(&mut self.work.solution);
        solution.copy_from_slice(right_side);
        self.apply(method, &mut solution);
        let result = self.refine(method, matrix, right_side, &mut solution, scale);
        if result.is_ok() {
            right_side.copy_from_slice(&solution);
        }
        self.work.solution = solution;
        result
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
        let mut residual = std::mem::take(&mut self.work.residual);
        let mut left = set_residual(matrix, right_side, solution, &mut residual)? / scale;
        let (mut refined, mut tolerance) = (false, ACCEPTED_RESIDUAL);
        if left.is_nan() || left > REFINED_RESIDUAL {
            let rounding = ROUNDING * matrix.norm() * greatest(solution) / scale;
            refined = left.is_nan() || left > rounding;
            if refined {
                self.apply(method, &mut residual);
                solution.iter_mut().zip(&residual).for_each(|(x, correction)| *x += correction);
                left = set_residual(matrix, right_side, solution, &mut residual)? / scale;
            }
            tolerance = tolerance.max((ROUNDING_MARGIN * rounding).min(LARGEST_RESIDUAL));
        }
        self.work.residual = residual;
        if left <= tolerance {
            Ok(SolveReport { relative_residual: left, refined })
        } else {
            Err(SolverError::Residual { residual: left, tolerance })
        }
    }

    /// x ← K⁻¹ x by the factor, unchecked.
    fn apply(&mut self, method: Method, x: &mut [f64]) {
        match (method, &mut self.zone, &mut self.whole) {
            (Method::Condensed, Some((zone, dense)), _) => {
                let ordered = &mut self.work.ordered;
                zone.gather(x, ordered);
                zone.forward(ordered);
                dense.solve(&mut ordered[x.len() - zone.len()..]);
                zone.backward(ordered);
                zone.scatter(ordered, x);
            }
            (_, _, Some(whole)) => whole.solve(method, x, &self.threads),
            _ => {}
        }
    }

    /// Condenses the solids and factorises what remains; `None` if there is no zone, or the solids refuse.
    fn condense(&mut self, matrix: &SystemMatrix) -> Result<Option<FactorisationReport>, SolverError> {
        let Some((zone, _)) = &mut self.zone else { return Ok(None) };
        if zone.condense(&matrix.values).is_err() {
            return Ok(None);
        }
        self.solids = Some((Symmetry::Symmetric, true));
        self.factorise_dense(&matrix.contact, false).map(Some)
    }

    fn factorise_dense(&mut self, contact: &Blocks, solids_reused: bool) -> Result<FactorisationReport, SolverError> {
        let Some((zone, dense)) = &mut self.zone else { return Err(SolverError::NotFactorised) };
        let first = self.pattern.size() - zone.len();
        let positive = dense
            .factorise(zone, contact)
            .map_err(|place| SolverError::Singular { equation: Some(zone.equation(first + place)) })?;
        self.factor = Some(Method::Condensed);
        let solids_flops = if solids_reused { 0.0 } else { zone.flops() };
        Ok(FactorisationReport {
            method: Method::Condensed,
            symbolic_reused: true,
            solids_reused,
            dense_equations: zone.len(),
            flops: Some(solids_flops + dense_flops(zone.len())),
            factor_entries: Some(zone.entries() + zone.len() * zone.len()),
            determinant_positive: Some(positive),
        })
    }

    fn factorise_whole(
        &mut self,
        matrix: &SystemMatrix,
        symmetry: Symmetry,
    ) -> Result<FactorisationReport, SolverError> {
        let mut whole = self.whole.take().unwrap_or_else(|| Whole::new(matrix));
        if self.options.forgets {
            whole.forget_factors();
        }
        let pattern_reused = whole.fill(matrix);
        let first = self.options.first_method.unwrap_or(Method::Condensed);
        let is_symmetric = symmetry == Symmetry::Symmetric && is_symmetric(&matrix.contact);
        let mut done = None;
        for method in [Method::Cholesky, Method::BlockLu, Method::GeneralLu] {
            if method < first || method == Method::Cholesky && !is_symmetric {
                continue;
            }
            let symbolic_reused = pattern_reused && whole.is_analysed(method);
            let outcome = match method {
                Method::Condensed | Method::Cholesky => {
                    whole.factorise_cholesky(matrix, &self.nodes, &self.positions, &self.threads)
                }
                Method::BlockLu => whole.factorise_block_lu(matrix, &self.nodes, &self.positions),
                Method::GeneralLu => whole.factorise_general_lu(matrix),
            };
            match outcome {
                Ok(Outcome::Refused) => {}
                Ok(Outcome::Done(positive)) => done = Some(Ok((method, symbolic_reused, positive))),
                Err(error) => done = Some(Err(error)),
            }
            if done.is_some() {
                break;
            }
        }
        let (method, symbolic_reused, determinant_positive) =
            done.unwrap_or(Err(SolverError::Singular { equation: None }))?;
        let (flops, factor_entries) = whole.size_of(method);
        self.whole = Some(whole);
        self.factor = Some(method);
        Ok(FactorisationReport {
            method,
            symbolic_reused,
            solids_reused: false,
            dense_equations: 0,
            flops,
            factor_entries,
            determinant_positive,
        })
    }

    fn check(&self, matrix: &SystemMatrix) -> Result<(), SolverError> {
        self.check_pattern(matrix)?;
        matrix.check_lengths()?;
        match matrix.contact.iter().flat_map(|(rows, _)| rows).find(|&&equation| !self.is_contact[equation]) {
            Some(&equation) => Err(SolverError::OutsideContact { equation }),
            None => Ok(()),
        }
    }

    fn check_pattern(&self, matrix: &SystemMatrix) -> Result<(), SolverError> {
        let same = Arc::ptr_eq(&self.pattern, matrix.pattern()) || self.pattern == *matrix.pattern();
        if same { Ok(()) } else { Err(SolverError::Pattern) }
    }
}

/// Which equations are in a list that has each once.
pub(super) fn marked(size: usize, equations: &[usize]) -> Result<Vec<bool>, SolverError> {
    let mut marks = vec![false; size];
    for &equation in equations {
        match marks.get_mut(equation) {
            None => return Err(SolverError::Equation { equation, size }),
            Some(true) => return Err(SolverError::Repeated { equation }),
            Some(mark) => *mark = true,
        }
    }
    Ok(marks)
}

/// A zone, if there is contact and condensing onto it is asked for, or pays.
fn worthwhile_zone(
    pattern: &Pattern,
    nodes: &[usize],
    contact: &[usize],
    options: SolverOptions,
) -> Result<Option<(Zone, DenseLu)>, SolverError> {
    if contact.is_empty() {
        return Ok(None);
    }
    let affordable = match options.first_method {
        Some(Method::Condensed) => f64::INFINITY,
        Some(_) => return Ok(None),
        None => CONDENSATION_ADVANTAGE * cholesky_flops(pattern, &elimination_order(pattern, nodes, &[], &[])?)?,
    };
    if dense_flops(contact.len()) > affordable {
        return Ok(None);
    }
    let zone = Zone::new(pattern, nodes, &[], contact)?;
    if zone.flops() + dense_flops(zone.len()) > affordable {
        return Ok(None);
    }
    let dense = DenseLu::new(zone.len())?;
    Ok(Some((zone, dense)))
}

/// Multiplications and additions of a dense LU.
fn dense_flops(size: usize) -> f64 {
    2.0 / 3.0 * (size as f64).powi(3)
}

/// Whether each block is symmetric but for rounding.
fn is_symmetric(contact: &Blocks) -> bool {
    contact.iter().all(|(rows, values)| {
        let accepted = SYMMETRIC_BLOCK * greatest(values);
        let count = rows.len();
        (0..count).all(|i| (0..i).all(|j| (values[i * count + j] - values[j * count + i]).abs() <= accepted))
    })
}

/// residual = right side − K x; returns its greatest magnitude, NaN if there is one.
fn set_residual(
    matrix: &SystemMatrix,
    right_side: &[f64],
    x: &[f64],
    residual: &mut [f64],
) -> Result<f64, SolverError> {
    matrix.multiply(x, residual)?;
    residual.iter_mut().zip(right_side).for_each(|(residual, right)| *residual = right - *residual);
    Ok(greatest(residual))
}

/// The greatest magnitude; NaN if there is one.
fn greatest(values: &[f64]) -> f64 {
    values
        .iter()
        .map(|value| value.abs())
        .fold(0.0, |greatest, value| if value <= greatest || greatest.is_nan() { greatest } else { value })
}
