//! The whole system, solids and contact, in one sparse matrix, and its factorisations.

use super::analysis::Analysis;
use super::block_lu::BlockLu;
use super::general_lu::GeneralLu;
use super::ordering::elimination_order;
use super::parts::Parts;
use super::{Blocks, LARGEST_GROWTH, Method, Pattern, SolverError, SystemMatrix};
use crate::threads::Threads;

/// Largest number of a pattern's entries over those of the present matrix, before it is made anew.
const LARGEST_SUPERSET: f64 = 1.25;

/// One pattern that solids and contact fit, and its analyses.
pub(super) struct Whole {
    /// Remembers where contact was.
    pub(super) pattern: Pattern,
    /// Place of each value of the solids.
    solids: Vec<usize>,
    contact: Vec<Places>,
    /// Values of the matrix that was taken last.
    values: Vec<f64>,
    /// Present if it is large enough, once cuts were looked for.
    parts: Option<Parts>,
    is_cut: bool,
    block_lu: Option<BlockLu>,
    general_lu: Option<GeneralLu>,
}

/// Places of the entries of a contact block, row by row. Most points keep theirs from one matrix to the next.
#[derive(Default)]
struct Places {
    rows: Vec<usize>,
    places: Vec<usize>,
}

impl Places {
    /// Finds them; `false` if the pattern has no place for one.
    fn find(&mut self, rows: &[usize], pattern: &Pattern) -> bool {
        if self.rows == rows {
            return true;
        }
        self.rows.clear();
        self.places.clear();
        for &row in rows {
            self.places.extend(rows.iter().map_while(|&column| pattern.index(row, column)));
        }
        let is_complete = self.places.len() == rows.len() * rows.len();
        if is_complete {
            self.rows.extend_from_slice(rows);
        }
        is_complete
    }
}

impl Whole {
    /// A pattern for this matrix.
    pub(super) fn new(matrix: &SystemMatrix) -> Self {
        Self::over(matrix.pattern().with_blocks(&matrix.contact), matrix.pattern())
    }

    /// The system over a pattern that has all entries of the solids.
    pub(super) fn over(pattern: Pattern, solids: &Pattern) -> Self {
        let mut places = Vec::with_capacity(solids.entries());
        for column in 0..solids.size() {
            places.extend(solids.column(column).iter().filter_map(|&row| pattern.index(row, column)));
        }
        Self {
            solids: places,
            contact: Vec::new(),
            values: vec![0.0; pattern.entries()],
            parts: None,
            is_cut: false,
            block_lu: None,
            general_lu: None,
            pattern,
        }
    }

    /// Takes the values of a matrix; returns whether the pattern, and all that was analysed for it, could stay.
    pub(super) fn fill(&mut self, matrix: &SystemMatrix) -> bool {
        let reused = self.fits(&matrix.contact);
        if !reused {
            // Old entries are kept as long as they are few: points slide to and fro.
            let own = matrix.pattern().with_blocks(&matrix.contact);
            let superset = self.pattern.with_blocks(&matrix.contact);
            let accepted = superset.entries() as f64 <= LARGEST_SUPERSET * own.entries() as f64;
            *self = Self::over(if accepted { superset } else { own }, matrix.pattern());
            self.fits(&matrix.contact);
        }
        self.values.fill(0.0);
        self.solids.iter().zip(&matrix.values).for_each(|(&place, value)| self.values[place] = *value);
        for ((_, values), Places { places, .. }) in matrix.contact.iter().zip(&self.contact) {
            values.iter().zip(places).for_each(|(value, &place)| self.values[place] += value);
        }
        reused
    }

    /// Finds the places of contact's entries; `false` if the pattern has none for one.
    fn fits(&mut self, contact: &Blocks) -> bool {
        self.contact.resize_with(contact.len(), Places::default);
        contact.iter().zip(&mut self.contact).all(|((rows, _), places)| places.find(rows, &self.pattern))
    }

    /// Returns whether nothing about this method's pattern needs to be found out again.
    pub(super) fn is_analysed(&self, method: Method) -> bool {
        match method {
            Method::GeneralLu => self.general_lu.is_some(),
            Method::Parts => self.parts.is_some(),
            Method::BlockLu => self.block_lu.is_some(),
        }
    }

    /// LLᵀ in parts of the matrix that was taken last; `false` if it is small, or not definite.
    pub(super) fn factorise_parts(
        &mut self,
        nodes: &[usize],
        positions: &[[f64; 2]],
        threads: &Threads,
    ) -> Result<bool, SolverError> {
        if !std::mem::replace(&mut self.is_cut, true) {
            self.parts = Parts::new(&self.pattern, nodes, positions, threads)?;
        }
        Ok(self.parts.as_mut().is_some_and(|parts| parts.factorise(&self.values, threads)))
    }

    /// LU with pivoting inside supernodes; `false` if that is not enough.
    pub(super) fn factorise_block_lu(&mut self, nodes: &[usize], positions: &[[f64; 2]]) -> Result<bool, SolverError> {
        let block_lu = get_or_try_insert(&mut self.block_lu, || {
            let (order, _) = elimination_order(&self.pattern, nodes, positions, &[])?;
            BlockLu::new(Analysis::new(&self.pattern, order)?)
        })?;
        Ok(block_lu.factorise(&self.values))
    }

    /// LU with full partial pivoting. Singular if a right side of ones with changing signs is answered by a vector
    /// that is greater than a regular matrix of this `norm` could make it.
    pub(super) fn factorise_general_lu(&mut self, norm: f64) -> Result<bool, SolverError> {
        let general_lu = get_or_try_insert(&mut self.general_lu, || GeneralLu::new(&self.pattern))?;
        general_lu.factorise(&self.values)?;
        // The signs follow the bits of the golden ratio's multiples: no smooth mode is orthogonal to them.
        let signs = (1..=self.pattern.size() as u64).map(|i| (i.wrapping_mul(0x9E37_79B9_7F4A_7C15) >> 63) as f64);
        let mut answer: Vec<f64> = signs.map(|sign| 1.0 - 2.0 * sign).collect();
        general_lu.solve(&mut answer);
        let greatest = answer.iter().map(|x| if x.is_nan() { f64::INFINITY } else { x.abs() });
        if greatest.fold(0.0, f64::max) * norm > LARGEST_GROWTH {
            return Err(SolverError::Singular { equation: None });
        }
        Ok(true)
    }

    /// Solves in place with the last factor of this method.
    pub(super) fn solve(&mut self, method: Method, x: &mut [f64], threads: &Threads) {
        match method {
            Method::Parts => self.parts.iter_mut().for_each(|parts| parts.solve(x, threads)),
            Method::BlockLu => self.block_lu.iter_mut().for_each(|factor| factor.solve(x)),
            Method::GeneralLu => self.general_lu.iter_mut().for_each(|factor| factor.solve(x)),
        }
    }

    /// Discards the factor: nothing of it is kept at the next factorisation.
    pub(super) fn forget_factors(&mut self) {
        self.block_lu.iter_mut().for_each(BlockLu::forget);
        self.parts.iter_mut().for_each(Parts::forget);
    }

    /// Flops of the last factorisation by this method, as far as known before, and the numbers in its factor.
    pub(super) fn size_of(&self, method: Method) -> (Option<f64>, Option<usize>) {
        match method {
            Method::Parts => self.parts.as_ref().map(|parts| (parts.flops, parts.entries())).unzip(),
            Method::BlockLu => self.block_lu.as_ref().map(|factor| (factor.flops, factor.entries())).unzip(),
            Method::GeneralLu => (None, None),
        }
    }
}

/// Returns what is in the slot, or what `make` makes for it.
pub(super) fn get_or_try_insert<T>(
    slot: &mut Option<T>,
    make: impl FnOnce() -> Result<T, SolverError>,
) -> Result<&mut T, SolverError> {
    let value = match slot.take() {
        Some(value) => value,
        None => make()?,
    };
    Ok(slot.insert(value))
}
