//! The whole system, solids and contact, in one sparse matrix, and its factorisations.

use super::method::{Analysed, Layout};
use super::{Blocks, Method, Pattern, SolverError, SystemMatrix};
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
    /// The methods that were tried, in their order.
    methods: [Option<Analysed>; Method::ALL.len()],
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
            methods: Default::default(),
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
        matches!(self.methods[method as usize], Some(Some(_)))
    }

    /// Factorises the matrix that was taken last; `false` if the method cannot.
    pub(super) fn factorise(
        &mut self,
        method: Method,
        layout: &Layout,
        matrix: &SystemMatrix,
    ) -> Result<bool, SolverError> {
        let slot = &mut self.methods[method as usize];
        let analysed = match slot.take() {
            Some(analysed) => analysed,
            None => method.analyse(&self.pattern, layout)?,
        };
        match slot.insert(analysed) {
            Some(analysed) => analysed.factorise(&self.values, matrix, &layout.threads),
            None => Ok(false),
        }
    }

    /// Solves in place with the last factor of this method.
    pub(super) fn solve(&mut self, method: Method, x: &mut [f64], threads: &Threads) {
        self.methods[method as usize].iter_mut().flatten().for_each(|analysed| analysed.solve(x, threads));
    }

    /// Discards the factors: nothing of them is kept at the next factorisation.
    pub(super) fn forget_factors(&mut self) {
        self.methods.iter_mut().flatten().flatten().for_each(|analysed| analysed.forget());
    }

    /// Flops of the last factorisation by this method and the numbers in its factor, if the method knows.
    pub(super) fn size_of(&self, method: Method) -> Option<(f64, usize)> {
        self.methods[method as usize].iter().flatten().find_map(|analysed| analysed.size())
    }
}
