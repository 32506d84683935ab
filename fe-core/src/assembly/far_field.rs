//! The elastic far field, condensed onto the zone that is not elastic.
//!
//! ```text
//! K_II u_I + K_IB u_B = 0        f_B = (K_BB − K_BI K_II⁻¹ K_IB) u_B
//! ```
//!
//! Far elements are computed with the tangent of their virgin state and no law is called for them while an increment
//! iterates. Before it is accepted their displacements are expanded, their laws called, and the equilibrium of every
//! equation checked with the laws: an element that is no longer elastic is noticed exactly, leaves the far field,
//! and the increment goes on.

use super::system::{NOWHERE, Scatter, freedoms, rows_of};
use super::{Condensation, Equations};
use crate::mesh::Mesh;
use crate::solver::{Pattern, SolverError, Superelement};

/// Condensed elements.
pub(super) struct FarField {
    superelement: Superelement,
    /// Freedoms of border and interior, ascending: the superelement's equations.
    own: Vec<usize>,
    /// Freedoms that it shares with the zone, and those that it has for itself, ascending.
    pub(super) border: Vec<usize>,
    pub(super) interior: Vec<usize>,
}

impl FarField {
    /// Condenses the elements that are not active; freedoms that the others share stay. `None` if there are none.
    pub(super) fn new(
        mesh: &Mesh,
        equations: &Equations,
        &Condensation { elements, active, retained }: &Condensation<'_>,
    ) -> Result<Option<Self>, SolverError> {
        let mut kept = vec![false; equations.freedom_count()];
        retained.iter().for_each(|&freedom| kept[freedom] = true);
        let mut far = vec![false; equations.freedom_count()];
        for (element, &is_active) in mesh.elements().iter().zip(active) {
            let mask = if is_active { &mut kept } else { &mut far };
            freedoms(element.nodes()).into_iter().for_each(|freedom| mask[freedom] = true);
        }
        // Held freedoms have no equation; the others are their own (`may_be_condensed`).
        let own: Vec<usize> =
            (0..far.len()).filter(|&freedom| far[freedom] && !equations.equations_of(freedom).is_empty()).collect();
        if own.is_empty() {
            return Ok(None);
        }
        let mut row_of_equation = vec![NOWHERE; equations.count()];
        for (row, &freedom) in (0..).zip(&own) {
            equations.equations_of(freedom).iter().for_each(|&(equation, _)| row_of_equation[equation] = row);
        }
        let far_elements: Vec<(usize, Vec<usize>)> = (0..active.len())
            .filter(|&element| !active[element])
            .map(|element| (element, freedoms(mesh.elements()[element].nodes())))
            .collect();
        let groups: Vec<Vec<usize>> =
            far_elements.iter().map(|(_, freedoms)| rows_of(equations, &row_of_equation, freedoms)).collect();
        let pattern = Pattern::from_groups(own.len(), groups.iter().map(Vec::as_slice));
        let mut values = vec![0.0; pattern.entries()];
        for (element, freedoms) in &far_elements {
            let scatter = Scatter::new(equations, &row_of_equation, &pattern, freedoms);
            scatter.add(elements.stiffness(*element), 0, &mut values);
        }
        let nodes: Vec<usize> = own.iter().map(|freedom| freedom / 2).collect();
        let (border, interior): (Vec<usize>, Vec<usize>) = (0..own.len()).partition(|&index| kept[own[index]]);
        let superelement = Superelement::new(&pattern, &values, &nodes, &border)?;
        let to_freedoms = |indices: Vec<usize>| indices.into_iter().map(|index| own[index]).collect();
        let (border, interior) = (to_freedoms(border), to_freedoms(interior));
        Ok(Some(Self { superelement, own, border, interior }))
    }

    /// The condensed stiffness, row by row over the border.
    pub(super) fn stiffness(&self) -> &[f64] {
        self.superelement.stiffness()
    }

    /// Sets the displacements of its interior from those of its border.
    pub(super) fn expand(&mut self, displacements: &mut [f64]) {
        let border: Vec<f64> = self.border.iter().map(|&freedom| displacements[freedom]).collect();
        let mut expanded = vec![0.0; self.own.len()];
        self.superelement.expand(&border, &mut expanded);
        self.own.iter().zip(&expanded).for_each(|(&freedom, value)| displacements[freedom] = *value);
    }
}

/// Returns which elements may be condensed: each of their freedoms is its own equation or held still, and carries no
/// load.
pub(crate) fn may_be_condensed(mesh: &Mesh, equations: &Equations, loaded: &[usize]) -> Vec<bool> {
    let mut has_load = vec![false; equations.freedom_count()];
    loaded.iter().for_each(|&freedom| has_load[freedom] = true);
    let may_be = |freedom: usize| !has_load[freedom] && equations.is_plain(freedom);
    mesh.elements().iter().map(|element| freedoms(element.nodes()).into_iter().all(may_be)).collect()
}

/// Returns which elements have one of these freedoms.
pub fn touching(mesh: &Mesh, of: &[usize]) -> Vec<bool> {
    let mut marked = vec![false; 2 * mesh.nodes().len()];
    of.iter().for_each(|&freedom| marked[freedom] = true);
    mesh.elements().iter().map(|element| freedoms(element.nodes()).into_iter().any(|f| marked[f])).collect()
}
