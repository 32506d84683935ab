//! Dense blocks of stiffness between a few rows each.

/// Blocks of an unsymmetric stiffness: block k couples rows and columns `rows(k)`. One arena, refilled at every
/// evaluation without allocating.
#[derive(Clone, Debug, Default, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct Blocks {
    rows: Vec<usize>,
    values: Vec<f64>,
    /// End of each block's rows and values.
    ends: Vec<(usize, usize)>,
}

impl Blocks {
    /// Removes all blocks, and keeps the memory.
    pub fn clear(&mut self) {
        self.rows.clear();
        self.values.clear();
        self.ends.clear();
    }

    /// Adds a block; `values` row by row, ∂force_row/∂displacement_column.
    ///
    /// # Panics
    ///
    /// If `values` is not square over `rows`.
    pub fn push(&mut self, rows: &[usize], values: &[f64]) {
        assert_eq!(values.len(), rows.len() * rows.len(), "a block is square");
        self.rows.extend_from_slice(rows);
        self.values.extend_from_slice(values);
        self.ends.push((self.rows.len(), self.values.len()));
    }

    /// Returns how many there are.
    pub fn len(&self) -> usize {
        self.ends.len()
    }

    /// Returns whether there is none.
    pub fn is_empty(&self) -> bool {
        self.ends.is_empty()
    }

    /// The blocks in order: rows, and values row by row.
    pub fn iter(&self) -> impl Iterator<Item = (&[usize], &[f64])> {
        let starts = std::iter::once((0, 0)).chain(self.ends.iter().copied());
        starts.zip(&self.ends).map(|(start, end)| (&self.rows[start.0..end.0], &self.values[start.1..end.1]))
    }
}
