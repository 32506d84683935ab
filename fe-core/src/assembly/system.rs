//! The system of equations: element and contact stiffness between the rows that the solver sees.
//!
//! Rows are the equations, except for those in the interior of the condensed far field. Forces and displacements stay
//! with the freedoms; only corrections and residuals are by rows.

use super::far_field::FarField;
use super::{Equations, Solids};
use crate::mesh::Mesh;
use crate::model::Freedom;
use crate::solver::{
    Blocks, FactorisationReport, LinearSolver, Pattern, SolverError, SolverOptions, Symmetry, SystemMatrix,
};
use crate::threads::Threads;
use serde::{Deserialize, Serialize};
use std::ops::Range;
use std::sync::Arc;

#[cfg(test)]
mod test;

/// Places in the matrix of the entries of the stiffness of an element or of the far field.
#[derive(Clone, Debug)]
pub(super) struct Scatter {
    places: Places,
    /// From the first place to one past the last.
    span: Range<usize>,
}

#[derive(Clone, Debug)]
enum Places {
    /// Freedoms are equations or held: the place of each entry, or [`NOWHERE`].
    Direct(Vec<u32>),
    /// Couplings: (entry of the element, place, coefficient).
    Coupled(Vec<(u32, u32, f64)>),
}

/// The place of an entry whose row or column is held; the row of an equation that is condensed.
pub(super) const NOWHERE: u32 = u32::MAX;

/// Fewer values are assembled by one thread: it takes less than a millisecond, and waking another one a tenth.
const LEAST_SHARED: usize = 400_000;

/// A model's equations, their matrix and its solver.
pub struct System {
    equations: Equations,
    /// Row of each equation, or [`NOWHERE`].
    row_of_equation: Vec<u32>,
    /// Equation of each row.
    equation_of_row: Vec<usize>,
    matrix: SystemMatrix,
    /// Place of each row's diagonal entry.
    diagonal: Vec<usize>,
    solver: LinearSolver,
    /// One of each element; condensed ones have no places.
    scatter: Vec<Scatter>,
    threads: Threads,
    /// Elements with a freedom that a drive moves, with all their freedoms.
    driven_elements: Vec<(usize, Vec<usize>)>,
    /// Blocks of contact and loads, by freedoms.
    blocks: Blocks,
    far_field: Option<FarField>,
    far_scatter: Scatter,
}

/// A matrix with its factor, apart from the system.
pub(crate) struct Factor {
    matrix: SystemMatrix,
    blocks: Blocks,
    solver: LinearSolver,
}

/// State of a system that is stored: its matrix may be that of an earlier increment.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct SystemState {
    values: Vec<f64>,
    contact: Blocks,
    blocks: Blocks,
    solver: (Option<Symmetry>, Option<Pattern>),
}

/// Elements that a system condenses.
#[derive(Clone, Copy, Debug)]
pub struct Condensation<'a> {
    /// The solids, with the stiffness of the virgin state in elements to condense.
    pub elements: &'a Solids,
    /// False for elements to condense.
    pub active: &'a [bool],
    /// Freedoms that stay although only condensed elements have them.
    pub retained: &'a [usize],
}

impl System {
    /// Finds the pattern and condenses the far field.
    pub fn new(
        mesh: &Mesh,
        equations: Equations,
        condensation: Option<Condensation<'_>>,
        options: SolverOptions,
    ) -> Result<Self, SolverError> {
        let far_field = match &condensation {
            Some(condensation) => FarField::new(mesh, &equations, condensation)?,
            None => None,
        };
        let is_active = |element: usize| condensation.as_ref().is_none_or(|c| c.active[element]);
        let (row_of_equation, equation_of_row) = rows(&equations, far_field.as_ref());
        let element_freedoms: Vec<Vec<usize>> =
            mesh.elements().iter().map(|element| freedoms(element.nodes())).collect();
        let by_rows = |freedoms: &[usize]| rows_of(&equations, &row_of_equation, freedoms);
        let mut groups: Vec<Vec<usize>> = element_freedoms
            .iter()
            .enumerate()
            .filter(|(element, _)| is_active(*element))
            .map(|(_, freedoms)| by_rows(freedoms))
            .collect();
        groups.extend(far_field.iter().map(|far| by_rows(&far.border)));
        let pattern = Pattern::from_groups(equation_of_row.len(), groups.iter().map(Vec::as_slice));
        let scatter: Vec<Scatter> = element_freedoms
            .iter()
            .enumerate()
            .map(|(element, freedoms)| if is_active(element) { &freedoms[..] } else { &[] })
            .map(|freedoms| Scatter::new(&equations, &row_of_equation, &pattern, freedoms))
            .collect();
        let border = far_field.as_ref().map_or(&[][..], |far| &far.border);
        let far_scatter = Scatter::new(&equations, &row_of_equation, &pattern, border);
        let is_driven = |freedoms: &[usize]| freedoms.iter().any(|&freedom| !equations.drives_of(freedom).is_empty());
        let driven_elements =
            element_freedoms.into_iter().enumerate().filter(|(_, freedoms)| is_driven(freedoms)).collect();
        let nodes: Vec<usize> = equation_of_row.iter().map(|&equation| equations.freedoms()[equation] / 2).collect();
        let on_diagonal = |row| pattern.index(row, row).expect("the diagonal is always there");
        let diagonal = (0..pattern.size()).map(on_diagonal).collect();
        let pattern = Arc::new(pattern);
        let positions = nodes.iter().map(|&node| mesh.nodes()[node]).collect();
        let solver = LinearSolver::new(&pattern, &nodes, options).with_positions(positions);
        Ok(Self {
            matrix: SystemMatrix::new(pattern),
            equations,
            row_of_equation,
            equation_of_row,
            diagonal,
            solver,
            scatter,
            threads: Threads::default(),
            driven_elements,
            blocks: Blocks::default(),
            far_field,
            far_scatter,
        })
    }

    pub(crate) fn threads(&self) -> &Threads {
        &self.threads
    }

    /// The threads that assemble, factorise and solve.
    pub fn set_threads(&mut self, threads: &Threads) {
        self.threads = threads.clone();
        self.solver.set_threads(threads);
    }

    /// The equations.
    pub fn equations(&self) -> &Equations {
        &self.equations
    }

    /// Returns how many rows the solver sees.
    pub(crate) fn row_count(&self) -> usize {
        self.equation_of_row.len()
    }

    /// The matrix, without what is condensed of it.
    pub(crate) fn matrix(&self) -> &SystemMatrix {
        &self.matrix
    }

    /// The rows of a freedom with their coefficients, where nothing is condensed.
    pub(crate) fn rows_of_freedom(&self, freedom: usize) -> impl Iterator<Item = (usize, f64)> + '_ {
        let terms = self.equations.equations_of(freedom).iter();
        terms.map(|&(equation, coefficient)| (self.row_of_equation[equation] as usize, coefficient))
    }

    /// The node of a row.
    pub(crate) fn node_of_row(&self, row: usize) -> usize {
        self.equations.freedoms()[self.equation_of_row[row]] / 2
    }

    /// Adds all elements into the matrix. Each thread has its own range of the values, and every value the same sum.
    pub(crate) fn assemble_elements(&mut self, elements: &Solids) {
        let values = &mut self.matrix.values;
        let count = if values.len() < LEAST_SHARED { 1 } else { self.threads.count() };
        let length = values.len().div_ceil(count).max(1);
        let mut ranges: Vec<(usize, &mut [f64])> =
            values.chunks_mut(length).enumerate().map(|(number, range)| (number * length, range)).collect();
        let (scatter, far) = (&self.scatter, self.far_field.as_ref());
        let add = |(first, values): &mut (usize, &mut [f64])| {
            values.fill(0.0);
            for (element, scatter) in scatter.iter().enumerate() {
                scatter.add(elements.stiffness(element), *first, values);
            }
            if let Some(far) = far {
                self.far_scatter.add(far.stiffness(), *first, values);
            }
        };
        match ranges.as_mut_slice() {
            [whole] => add(whole),
            ranges => self.threads.for_each(ranges, add),
        }
    }

    /// The largest stiffness of a freedom against itself, N/mm.
    pub(crate) fn largest_diagonal(&self) -> f64 {
        let elements = self.diagonal.iter().map(|&place| self.matrix.values[place].abs()).fold(0.0, f64::max);
        let of_block = |(rows, values): (&[usize], &[f64])| {
            values.iter().step_by(rows.len() + 1).fold(0.0, |largest: f64, value| largest.max(value.abs()))
        };
        elements + self.matrix.contact.iter().map(of_block).fold(0.0, f64::max)
    }

    /// Takes over the blocks of contact and of loads that follow the body, by freedoms.
    pub(crate) fn set_blocks(&mut self, blocks: &Blocks) {
        self.blocks.clone_from(blocks);
        self.matrix.contact.clear();
        for (freedoms, values) in blocks.iter() {
            let (equations, values) = reduced_block(&self.equations, freedoms, values);
            let rows: Vec<usize> = equations.into_iter().map(|e| self.row_of_equation[e] as usize).collect();
            self.matrix.contact.push(&rows, &values);
        }
    }

    /// Factorises the matrix.
    pub fn factorise(&mut self, symmetry: Symmetry) -> Result<FactorisationReport, SolverError> {
        self.solver.factorise(&self.matrix, symmetry)
    }

    /// Makes a matrix of the present pattern without a factor.
    pub(crate) fn new_factor(&self) -> Factor {
        let matrix = SystemMatrix::new(Arc::clone(self.matrix.pattern()));
        Factor { matrix, blocks: Blocks::default(), solver: self.solver.anew() }
    }

    /// Returns whether a factor is of the same equations.
    pub(crate) fn fits(&self, factor: &Factor) -> bool {
        factor.matrix.pattern() == self.matrix.pattern()
    }

    /// Exchanges matrix and factor with those of another system.
    pub(crate) fn exchange(&mut self, other: &mut Factor) {
        std::mem::swap(&mut self.matrix, &mut other.matrix);
        std::mem::swap(&mut self.blocks, &mut other.blocks);
        std::mem::swap(&mut self.solver, &mut other.solver);
    }

    /// The matrix and what its factor depends on, as they are kept between runs.
    pub fn state(&self) -> SystemState {
        let SystemMatrix { values, contact, .. } = &self.matrix;
        SystemState {
            values: values.clone(),
            contact: contact.clone(),
            blocks: self.blocks.clone(),
            solver: self.solver.memory(),
        }
    }

    /// Takes over a matrix and makes its factor.
    pub(crate) fn set_state(&mut self, state: &SystemState) -> Result<(), SolverError> {
        let SystemState { values, contact, blocks, solver } = state;
        self.matrix.values.clone_from(values);
        self.matrix.contact.clone_from(contact);
        self.blocks.clone_from(blocks);
        self.solver.take_memory(solver, &self.matrix)
    }

    /// Solves in place with the last factor.
    pub fn solve(&mut self, right_side: &mut [f64]) -> Result<(), SolverError> {
        self.solver.solve(&self.matrix, right_side).map(|_| ())
    }

    /// Tᵀ f by rows.
    pub fn reduce(&self, forces: &[f64]) -> Vec<f64> {
        let all = self.equations.reduce(forces);
        self.equation_of_row.iter().map(|&equation| all[equation]).collect()
    }

    /// T q + S a from unknowns by rows; the interior of the far field stays 0.
    pub fn displacements(&self, unknowns: &[f64], drives: &[f64]) -> Vec<f64> {
        let mut all = vec![0.0; self.equations.count()];
        self.equation_of_row.iter().zip(unknowns).for_each(|(&equation, value)| all[equation] = *value);
        let mut displacements = vec![0.0; self.equations.freedom_count()];
        self.equations.add_displacements(&all, drives, &mut displacements);
        displacements
    }

    /// Tᵀ K S a by rows: the forces when the drives move by `drives` and the unknowns stay.
    pub(crate) fn drive_stiffness(&self, elements: &Solids, drives: &[f64]) -> Vec<f64> {
        let displacements = self.displacements(&vec![0.0; self.row_count()], drives);
        let mut forces = vec![0.0; displacements.len()];
        for (element, freedoms) in &self.driven_elements {
            add_product(freedoms, elements.stiffness(*element), &displacements, 1.0, &mut forces);
        }
        for (freedoms, values) in self.blocks.iter() {
            add_product(freedoms, values, &displacements, 1.0, &mut forces);
        }
        self.reduce(&forces)
    }

    /// Adds the forces of the far field on its border (`sign` 1), or takes them away (−1).
    pub(crate) fn add_far_forces(&self, displacements: &[f64], sign: f64, forces: &mut [f64]) {
        if let Some(far) = &self.far_field {
            add_product(&far.border, far.stiffness(), displacements, sign, forces);
        }
    }

    /// Sets the displacements in the far field from those at its border.
    pub fn expand(&mut self, displacements: &mut [f64]) {
        self.far_field.iter_mut().for_each(|far| far.expand(displacements));
    }
}

/// Row of each equation and equation of each row.
fn rows(equations: &Equations, far_field: Option<&FarField>) -> (Vec<u32>, Vec<usize>) {
    let mut row_of_equation = vec![0; equations.count()];
    for &freedom in far_field.map_or(&[][..], |far| &far.interior) {
        for &(equation, _) in equations.equations_of(freedom) {
            row_of_equation[equation] = NOWHERE;
        }
    }
    let kept: Vec<usize> = (0..equations.count()).filter(|&equation| row_of_equation[equation] != NOWHERE).collect();
    for (row, &equation) in kept.iter().enumerate() {
        row_of_equation[equation] = row as u32;
    }
    (row_of_equation, kept)
}

/// The freedoms of some nodes, two each.
pub(super) fn freedoms(nodes: &[usize]) -> Vec<usize> {
    nodes.iter().flat_map(|&node| [0, 1].map(|component| Freedom { node, component }.index())).collect()
}

/// f += `sign` k u over some freedoms.
fn add_product(freedoms: &[usize], stiffness: &[f64], displacements: &[f64], sign: f64, forces: &mut [f64]) {
    for (row, &freedom) in stiffness.chunks_exact(freedoms.len()).zip(freedoms) {
        let force: f64 = row.iter().zip(freedoms).map(|(k, &other)| k * displacements[other]).sum();
        forces[freedom] += sign * force;
    }
}

/// The equations that some freedoms are made of, ascending, each once.
fn equations_of_all(equations: &Equations, freedoms: &[usize]) -> Vec<usize> {
    let of_one = |&freedom: &usize| equations.equations_of(freedom).iter().map(|(equation, _)| *equation);
    let mut all: Vec<usize> = freedoms.iter().flat_map(of_one).collect();
    all.sort_unstable();
    all.dedup();
    all
}

/// The rows of the equations that some freedoms are made of, ascending, each once.
pub(super) fn rows_of(equations: &Equations, row_of_equation: &[u32], freedoms: &[usize]) -> Vec<usize> {
    equations_of_all(equations, freedoms).into_iter().map(|equation| row_of_equation[equation] as usize).collect()
}

/// Tᵀ k T of a block: its equations and values.
fn reduced_block(equations: &Equations, freedoms: &[usize], values: &[f64]) -> (Vec<usize>, Vec<f64>) {
    let rows = equations_of_all(equations, freedoms);
    let place = |equation: usize| rows.binary_search(&equation).expect("rows are the equations of these freedoms");
    // the equations of each freedom one after the other: freedom, place of the equation in the block, coefficient
    let terms: Vec<(usize, usize, f64)> = (0..freedoms.len())
        .flat_map(|k| equations.equations_of(freedoms[k]).iter().map(move |&(equation, factor)| (k, equation, factor)))
        .map(|(k, equation, factor)| (k, place(equation), factor))
        .collect();
    let mut reduced = vec![0.0; rows.len() * rows.len()];
    for &(row_freedom, row, row_coefficient) in &terms {
        let line = &values[row_freedom * freedoms.len()..][..freedoms.len()];
        let target = &mut reduced[row * rows.len()..][..rows.len()];
        for &(column_freedom, column, column_coefficient) in &terms {
            target[column] += row_coefficient * line[column_freedom] * column_coefficient;
        }
    }
    (rows, reduced)
}

impl Scatter {
    /// Adds an element's stiffness to the values from `first` on.
    pub(super) fn add(&self, stiffness: &[f64], first: usize, values: &mut [f64]) {
        if self.span.start >= first + values.len() || self.span.end <= first {
            return;
        }
        match &self.places {
            Places::Direct(places) => {
                for (&place, entry) in places.iter().zip(stiffness) {
                    if place != NOWHERE
                        && let Some(value) = values.get_mut((place as usize).wrapping_sub(first))
                    {
                        *value += entry;
                    }
                }
            }
            Places::Coupled(entries) => {
                for &(entry, place, coefficient) in entries {
                    if let Some(value) = values.get_mut((place as usize).wrapping_sub(first)) {
                        *value += coefficient * stiffness[entry as usize];
                    }
                }
            }
        }
    }

    /// Finds the places of an element's entries in a pattern over the rows that its equations have.
    pub(super) fn new(equations: &Equations, row_of_equation: &[u32], pattern: &Pattern, freedoms: &[usize]) -> Self {
        let mut entries = Vec::with_capacity(freedoms.len() * freedoms.len());
        for (i, &row_freedom) in freedoms.iter().enumerate() {
            for (j, &column_freedom) in freedoms.iter().enumerate() {
                for &(row, a) in equations.equations_of(row_freedom) {
                    for &(column, b) in equations.equations_of(column_freedom) {
                        let (row, column) = (row_of_equation[row] as usize, row_of_equation[column] as usize);
                        let place = pattern.index(row, column).expect("the pattern was made from these freedoms");
                        entries.push(((i * freedoms.len() + j) as u32, place as u32, a * b));
                    }
                }
            }
        }
        let present = || entries.iter().map(|&(_, place, _)| place as usize);
        let span = present().min().unwrap_or(0)..present().max().map_or(0, |last| last + 1);
        let places = if entries.iter().all(|(_, _, coefficient)| *coefficient == 1.0) {
            let mut places = vec![NOWHERE; freedoms.len() * freedoms.len()];
            for (entry, place, _) in entries {
                places[entry as usize] = place;
            }
            Places::Direct(places)
        } else {
            Places::Coupled(entries)
        };
        Self { places, span }
    }
}
