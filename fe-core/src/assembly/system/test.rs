//! Looks into the system, for the tests of whole runs.

use super::System;

impl System {
    /// Returns how many freedoms are condensed.
    pub(crate) fn condensed_count(&self) -> usize {
        self.far_field.as_ref().map_or(0, |far| far.interior.len())
    }

    /// K times unknowns by rows.
    pub(crate) fn multiply(&self, unknowns: &[f64]) -> Vec<f64> {
        let mut product = vec![0.0; unknowns.len()];
        self.matrix.multiply(unknowns, &mut product);
        product
    }
}
