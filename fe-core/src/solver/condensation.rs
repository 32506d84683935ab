//! A linear elastic far field, condensed onto its border once and for all.

use super::cholesky::Refusal;
use super::zone::SchurComplement;
use super::{Pattern, SolverError};

/// A body that stays linear, seen from its border: with border B and interior I,
///
/// ```text
/// S = A_BB − A_BI A_II⁻¹ A_IB      forces on the border are S u_B
/// u_I = −A_II⁻¹ A_IB u_B           as long as no force acts inside
/// ```
///
/// One factor L Lᵀ with the border last gives both ([`crate::solver`], Condensation).
pub struct Superelement {
    zone: SchurComplement,
    border: Vec<usize>,
    /// The place in the zone of each border equation.
    places: Vec<usize>,
    stiffness: Vec<f64>,
}

impl Superelement {
    /// Condenses a symmetric stiffness, N/mm, given by `values` over `pattern`, onto the equations in `border`, in
    /// their order. `nodes` has the node of each equation, by any numbering.
    ///
    /// # Errors
    ///
    /// If a value is not finite, or the body is not stable with its border held: A_II is not positive definite. Also if S has
    /// an eigenvalue far below zero, which no elastic body has.
    pub fn new(pattern: &Pattern, values: &[f64], nodes: &[usize], border: &[usize]) -> Result<Self, SolverError> {
        pattern.check_finite(values)?;
        let mut zone = SchurComplement::new(pattern, nodes, &[], border)?;
        zone.condense(values).map_err(|refusal| match refusal {
            Refusal::NotDefinite { place } => SolverError::NotDefinite { equation: zone.equation(place) },
            Refusal::Singular { place } => SolverError::Singular { equation: Some(zone.equation(place)) },
        })?;
        let places: Vec<usize> = border.iter().map(|&equation| zone.place_of[equation]).collect();
        let rows = places.iter().flat_map(|&row| places.iter().map(move |&column| (row, column)));
        let stiffness = rows.map(|entry| zone.schur[entry]).collect();
        Ok(Self { zone, border: border.to_vec(), places, stiffness })
    }

    /// S, N/mm, row by row: a block for [`crate::solver::Blocks`], symmetric to the last bit.
    pub fn stiffness(&self) -> &[f64] {
        &self.stiffness
    }

    /// Displacements of all equations of the body, mm, from those of its border; the latter are copied.
    pub fn expand(&mut self, border: &[f64], displacements: &mut [f64]) {
        let size = self.zone.place_of.len();
        let mut ordered = vec![0.0; size];
        let first = size - border.len();
        self.places.iter().zip(border).for_each(|(&place, value)| ordered[first + place] = *value);
        self.zone.backward(&mut ordered);
        self.zone.scatter(&ordered, displacements);
        self.border.iter().zip(border).for_each(|(&equation, value)| displacements[equation] = *value);
    }
}
