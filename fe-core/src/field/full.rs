//! Displacements and field in one system of equations, of which each Newton iteration solves all:
//!
//! ```text
//! ⎡ K_uu    s K_uθ  ⎤ ⎡ δu   ⎤   ⎡ r   ⎤      K_uθ = ∂f_int/∂θ  by DDSDDT
//! ⎣ s K_θu  s² K_θθ ⎦ ⎣ δθ/s ⎦ = ⎣ s R ⎦      K_θu = −∂R/∂u     by DRPLDE
//! ```
//!
//! s makes the largest entries of both diagonals equal. The rows of the field come last.

use super::{Field, NONE};
use crate::assembly::{Solids, System};
use crate::mesh::Mesh;
use crate::model::{FieldCoupling, Flux};
use crate::solver::{LinearSolver, Pattern, SolverError, SolverOptions, Symmetry, SystemMatrix};
use std::sync::Arc;

/// The matrix of both, and its factor.
pub(super) struct FullSystem {
    matrix: SystemMatrix,
    solver: LinearSolver,
    /// Rows of displacements.
    rows: usize,
    /// Places of the values of the matrix of the displacements, and of that of the field.
    places: [Vec<usize>; 2],
    scale: f64,
}

impl FullSystem {
    fn new(field: &Field, system: &System, mesh: &Mesh) -> Self {
        let rows = system.row_count();
        let field_nodes = (0..mesh.nodes().len()).filter(|&node| field.equations[node] != NONE);
        let nodes: Vec<usize> = (0..rows).map(|row| system.node_of_row(row)).chain(field_nodes).collect();
        let mut has_field = vec![false; mesh.elements().len()];
        field.elements.iter().for_each(|element| has_field[element.element] = true);
        let groups: Vec<Vec<usize>> = mesh
            .elements()
            .iter()
            .zip(has_field)
            .map(|(element, has_field)| {
                let freedoms = element.nodes().iter().flat_map(|&node| [2 * node, 2 * node + 1]);
                let of_field = element.nodes().iter().map(|&node| field.equations[node]);
                let of_field =
                    of_field.filter(|&equation| has_field && equation != NONE).map(|equation| rows + equation);
                let mut all: Vec<usize> = freedoms
                    .flat_map(|freedom| system.rows_of_freedom(freedom).map(|(row, _)| row))
                    .chain(of_field)
                    .collect();
                all.sort_unstable();
                all.dedup();
                all
            })
            .collect();
        let pattern = Arc::new(Pattern::from_groups(nodes.len(), groups.iter().map(Vec::as_slice)));
        let places = [(system.matrix(), 0), (&field.matrix, rows)].map(|(matrix, first)| {
            let own = matrix.pattern();
            let columns = (0..own.size()).flat_map(|column| {
                let starts = own.column_starts();
                own.rows()[starts[column]..starts[column + 1]].iter().map(move |&row| (row, column))
            });
            let place =
                |(row, column)| pattern.index(first + row, first + column).expect("made from the same elements");
            columns.map(place).collect()
        });
        let positions = nodes.iter().map(|&node| mesh.nodes()[node]).collect();
        let solver = LinearSolver::new(&pattern, &nodes, SolverOptions::default()).with_positions(positions);
        Self { matrix: SystemMatrix::new(pattern), solver, rows, places, scale: 1.0 }
    }
}

impl Field {
    /// Returns whether the present attempt solves displacements and field together. Without time nothing flows, and the field stays.
    pub(crate) fn is_full(&self) -> bool {
        self.definition.coupling == FieldCoupling::Full && self.time > 0.0
    }

    /// Factorises the matrix of both at the present state, from that of the displacements as it is assembled.
    ///
    /// # Errors
    ///
    /// The equations have no solution.
    pub(crate) fn factorise_full(&mut self, system: &System, solids: &Solids, mesh: &Mesh) -> Result<(), SolverError> {
        let mut values = std::mem::take(&mut self.matrix.values);
        let mut residual = vec![0.0; self.equations.len()];
        self.add_elements(solids, &mut residual, Some((&mut values, &mut Symmetry::Unsymmetric)));
        self.matrix.values = values;
        let mut full = self.full.take().unwrap_or_else(|| Box::new(FullSystem::new(self, system, mesh)));
        let result = self.factorise_in(&mut full, system, solids);
        self.full = Some(full);
        result
    }

    fn factorise_in(&self, full: &mut FullSystem, system: &System, solids: &Solids) -> Result<(), SolverError> {
        let own = self.matrix.pattern();
        let on_diagonal = |equation| own.index(equation, equation).map_or(0.0, |place| self.matrix.values[place].abs());
        let largest = (0..own.size()).map(on_diagonal).fold(0.0, f64::max);
        let ratio = (system.largest_diagonal() / largest).sqrt();
        full.scale = if ratio.is_finite() && ratio > 0.0 { ratio } else { 1.0 };
        let FullSystem { matrix, solver, rows, places: [of_displacements, of_field], scale } = full;
        let (values, scale) = (&mut matrix.values, *scale);
        values.fill(0.0);
        of_displacements.iter().zip(&system.matrix().values).for_each(|(&place, value)| values[place] = *value);
        of_field.iter().zip(&self.matrix.values).for_each(|(&place, value)| values[place] = scale * scale * value);
        matrix.contact.clone_from(&system.matrix().contact);
        let pattern = matrix.pattern().clone();
        for element in &self.elements {
            let coupling = solids.coupling(element.element);
            let count = element.nodes.len();
            for (k, &node) in element.nodes.iter().enumerate() {
                let equation = self.equations[node];
                if equation == NONE {
                    continue;
                }
                let span = 2 * count * k..2 * count * (k + 1);
                let forces = coupling.force_by_field[span.clone()].iter();
                let entries = forces.zip(&coupling.source_by_displacement[span]).enumerate();
                for (freedom, (force, source)) in entries {
                    for (row, coefficient) in system.rows_of_freedom(2 * element.nodes[freedom / 2] + freedom % 2) {
                        let field_row = *rows + equation;
                        for (place, value) in [((row, field_row), *force), ((field_row, row), -source)] {
                            let place = pattern.index(place.0, place.1).expect("made from the same elements");
                            matrix.values[place] += scale * coefficient * value;
                        }
                    }
                }
            }
        }
        solver.factorise(matrix, Symmetry::Unsymmetric).map(drop)
    }

    /// Solves in place for the corrections of displacements, by rows, and of the field, from their residuals, with the last factor.
    ///
    /// # Errors
    ///
    /// There is no factor, or it does not solve.
    pub(crate) fn solve_full(&mut self, right_side: &mut [f64]) -> Result<(), SolverError> {
        let full = self.full.as_mut().ok_or(SolverError::NotFactorised)?;
        let scale = |values: &mut [f64]| values[full.rows..].iter_mut().for_each(|value| *value *= full.scale);
        scale(right_side);
        full.solver.solve(&full.matrix, right_side)?;
        scale(right_side);
        Ok(())
    }

    /// R under these drives at the last evaluation.
    pub(crate) fn residual(&self, drives: &[f64], solids: &Solids) -> Vec<f64> {
        self.equations_at(drives, solids, None)
    }

    /// ∂R/∂a · d of drives that move so, and with them held displacements, the others at rest.
    pub(crate) fn drive_residual(&self, drives: &[f64], displacements: &[f64], solids: &Solids) -> Vec<f64> {
        let mut change = vec![0.0; self.matrix.pattern().size()];
        let of_drives = |flux: &Flux| flux.drive.map_or(0.0, |drive| drives[drive]);
        self.add_fluxes(of_drives, &mut change);
        for element in &self.elements {
            let moved: Vec<f64> =
                element.nodes.iter().flat_map(|&node| [displacements[2 * node], displacements[2 * node + 1]]).collect();
            if moved.iter().all(|u| *u == 0.0) {
                continue;
            }
            let coupling = solids.coupling(element.element);
            for (row, &node) in coupling.source_by_displacement.chunks_exact(moved.len()).zip(&element.nodes) {
                if self.equations[node] != NONE {
                    change[self.equations[node]] += row.iter().zip(&moved).map(|(by, u)| by * u).sum::<f64>();
                }
            }
        }
        change
    }

    /// Adds a correction to the field under these drives, and gives it to the laws.
    pub(crate) fn advance_full(&mut self, correction: &[f64], drives: &[f64], solids: &mut Solids) {
        self.definition.fixed.iter().for_each(|fixed| fixed.set(drives, &mut self.next));
        self.apply(correction, 1.0);
        self.trial.clone_from(&self.next);
        self.give(&self.trial, solids);
    }

    /// Returns whether a correction is small enough to be left out at the end of an increment.
    pub(crate) fn tolerates(&self, correction: &[f64]) -> bool {
        let limit = self.definition.tolerance * self.scale();
        correction.iter().all(|value| value.abs() <= limit)
    }
}
