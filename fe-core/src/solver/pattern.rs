//! Pattern of the entries of a system matrix, and the matrix.

use std::sync::Arc;

use super::{Blocks, SolverError};

/// Symmetric pattern of a square matrix, compressed by columns: both triangles, rows ascending, diagonal always there.
#[derive(Clone, Debug, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
pub struct Pattern {
    starts: Vec<usize>,
    rows: Vec<usize>,
}

impl Pattern {
    /// Makes a pattern from groups of equations that are coupled with each other, such as those of an element.
    ///
    /// # Panics
    ///
    /// If a group names an equation that is not below `size`.
    pub fn from_groups<'g>(size: usize, groups: impl Iterator<Item = &'g [usize]> + Clone) -> Self {
        let mut ends = vec![0; size + 1];
        for &equation in groups.clone().flatten() {
            ends[equation + 1] += 1;
        }
        accumulate(&mut ends);
        let mut members = vec![&[][..]; ends[size]];
        let mut next = ends.clone();
        for group in groups {
            for &equation in group {
                members[next[equation]] = group;
                next[equation] += 1;
            }
        }
        Self::from_columns(size, |column, rows| {
            rows.push(column);
            members[ends[column]..ends[column + 1]].iter().for_each(|group| rows.extend_from_slice(group));
        })
    }

    /// Returns this pattern with the entries of `blocks`.
    pub(super) fn with_blocks(&self, blocks: &Blocks) -> Self {
        let mut groups = vec![Vec::new(); self.size()];
        for (block, _) in blocks.iter() {
            block.iter().for_each(|&equation| groups[equation].push(block));
        }
        Self::from_columns(self.size(), |column, rows| {
            rows.extend_from_slice(self.column(column));
            groups[column].iter().for_each(|group| rows.extend_from_slice(group));
        })
    }

    /// The pattern between some equations, ascending, in their numbering, and where its values are among those of the whole.
    pub(super) fn restricted_to(&self, equations: &[usize]) -> (Self, Vec<usize>) {
        let mut places = vec![None; self.size()];
        equations.iter().enumerate().for_each(|(place, &equation)| places[equation] = Some(place));
        let (mut starts, mut rows, mut from) = (vec![0], Vec::new(), Vec::new());
        for &equation in equations {
            for (offset, &row) in self.column(equation).iter().enumerate() {
                if let Some(place) = places[row] {
                    rows.push(place);
                    from.push(self.starts[equation] + offset);
                }
            }
            starts.push(rows.len());
        }
        (Self { starts, rows }, from)
    }

    /// Makes a pattern from the rows of each column, which `write` gives in any order and as often as it likes.
    fn from_columns(size: usize, mut write: impl FnMut(usize, &mut Vec<usize>)) -> Self {
        let mut starts = Vec::with_capacity(size + 1);
        let (mut rows, mut column_rows) = (Vec::new(), Vec::new());
        starts.push(0);
        for column in 0..size {
            column_rows.clear();
            write(column, &mut column_rows);
            column_rows.sort_unstable();
            column_rows.dedup();
            rows.extend_from_slice(&column_rows);
            starts.push(rows.len());
        }
        Self { starts, rows }
    }

    /// Returns how many equations.
    pub fn size(&self) -> usize {
        self.starts.len() - 1
    }

    /// Returns how many entries, both triangles.
    pub fn entries(&self) -> usize {
        self.rows.len()
    }

    /// The place of an entry among the values; `None` where the pattern has none.
    pub fn index(&self, row: usize, column: usize) -> Option<usize> {
        if column >= self.size() {
            return None;
        }
        self.column(column).binary_search(&row).ok().map(|place| self.starts[column] + place)
    }

    /// Returns where the entries of each column start among the values, followed by the number of values.
    pub(crate) fn column_starts(&self) -> &[usize] {
        &self.starts
    }

    /// The row of each value.
    pub fn rows(&self) -> &[usize] {
        &self.rows
    }

    /// The rows of a column.
    pub(super) fn column(&self, column: usize) -> &[usize] {
        &self.rows[self.starts[column]..self.starts[column + 1]]
    }

    /// All values are numbers.
    pub(super) fn check_finite(&self, values: &[f64]) -> Result<(), SolverError> {
        match values.iter().position(|value| !value.is_finite()) {
            None => Ok(()),
            Some(place) => {
                let column = self.starts.partition_point(|&start| start <= place) - 1;
                Err(SolverError::NotFinite { row: self.rows[place], column })
            }
        }
    }

    /// Place of the entry (column, row) for each entry (row, column).
    pub(super) fn transposed_places(&self) -> Vec<usize> {
        let mut next = self.starts.clone();
        let mut places = vec![0; self.entries()];
        for column in 0..self.size() {
            for place in self.starts[column]..self.starts[column + 1] {
                let row = self.rows[place];
                places[place] = next[row];
                next[row] += 1;
            }
        }
        places
    }
}

/// Turns counts after a leading 0 into starts.
pub(super) fn accumulate(counts: &mut [usize]) {
    for i in 1..counts.len() {
        counts[i] += counts[i - 1];
    }
}

/// The matrix of a system, N/mm: values of the solids over a pattern, and what contact adds.
///
/// K = A + Σ contact blocks.
#[derive(Clone, Debug)]
pub struct SystemMatrix {
    pattern: Arc<Pattern>,
    /// A, one for each entry of the pattern.
    pub values: Vec<f64>,
    /// Blocks between equations that the solver knows as contact equations.
    pub contact: Blocks,
}

impl SystemMatrix {
    /// All zero, no contact.
    pub fn new(pattern: Arc<Pattern>) -> Self {
        Self { values: vec![0.0; pattern.entries()], pattern, contact: Blocks::default() }
    }

    /// Returns where A has entries.
    pub fn pattern(&self) -> &Arc<Pattern> {
        &self.pattern
    }

    /// y = K x.
    pub(crate) fn multiply(&self, x: &[f64], y: &mut [f64]) {
        y.fill(0.0);
        for (column, &factor) in x.iter().enumerate() {
            let range = self.pattern.starts[column]..self.pattern.starts[column + 1];
            for (row, value) in self.pattern.rows[range.clone()].iter().zip(&self.values[range]) {
                y[*row] += value * factor;
            }
        }
        for (rows, values) in self.contact.iter() {
            for (row, line) in rows.iter().zip(values.chunks_exact(rows.len().max(1))) {
                y[*row] += line.iter().zip(rows).map(|(value, column)| value * x[*column]).sum::<f64>();
            }
        }
    }

    /// All entries are numbers.
    pub(super) fn check_finite(&self) -> Result<(), SolverError> {
        self.pattern.check_finite(&self.values)?;
        for (rows, values) in self.contact.iter() {
            if let Some(place) = values.iter().position(|value| !value.is_finite()) {
                return Err(SolverError::NotFinite { row: rows[place / rows.len()], column: rows[place % rows.len()] });
            }
        }
        Ok(())
    }

    /// ‖K‖∞ or more: the greatest sum of magnitudes in a row, those of A and of the blocks added.
    pub(super) fn norm(&self) -> f64 {
        let mut sums = vec![0.0; self.pattern.size()];
        self.pattern.rows.iter().zip(&self.values).for_each(|(row, value)| sums[*row] += value.abs());
        for (rows, values) in self.contact.iter() {
            for (row, line) in rows.iter().zip(values.chunks_exact(rows.len().max(1))) {
                sums[*row] += line.iter().map(|value| value.abs()).sum::<f64>();
            }
        }
        sums.into_iter().fold(0.0, f64::max)
    }
}
