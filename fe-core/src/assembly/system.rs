//! The system of equations: element and contact stiffness between the rows that the solver sees.

use super::{Blocks, Equations};
use crate::mesh::Mesh;
use crate::model::Freedom;
use crate::solver::{FactorisationReport, LinearSolver, Pattern, SolverError, SolverOptions, Symmetry, SystemMatrix};

/// The stiffness of an element: row-major over its freedoms.
pub trait ElementStiffness {
    /// ∂force/∂displacement of element `element`.
    fn stiffness(&self, element: usize) -> &[f64];
}

/// Where the entries of an element's stiffness go: K_rc += coefficient · k_entry at a place of the pattern.
#[derive(Clone, Debug)]
enum Scatter {
    /// Freedoms are equations or held: (entry of the element, place) pairs with coefficient 1.
    Direct(Vec<(u32, u32)>),
    /// Couplings: with coefficients.
    Coupled(Vec<(u32, u32, f64)>),
}

/// A model's equations, their matrix and its solver.
#[derive(Debug)]
pub struct System {
    equations: Equations,
    matrix: SystemMatrix,
    solver: LinearSolver,
    scatter: Vec<Scatter>,
    element_freedoms: Vec<Vec<usize>>,
    /// Elements with a freedom that a drive moves.
    driven_elements: Vec<usize>,
    contact: Blocks,
}

impl System {
    /// Finds the pattern. `contact`: the freedoms that contact may couple; `follower`: groups of freedoms that loads may
    /// couple beside the elements'.
    ///
    /// # Errors
    ///
    /// Those of the symbolic analysis.
    pub fn new(
        mesh: &Mesh,
        equations: Equations,
        contact: &[usize],
        options: SolverOptions,
    ) -> Result<Self, SolverError> {
        let element_freedoms: Vec<Vec<usize>> = mesh.elements().iter().map(|element| freedoms(element.nodes())).collect();
        let groups: Vec<Vec<usize>> =
            element_freedoms.iter().map(|freedoms| equations_of_all(&equations, freedoms)).collect();
        let pattern = Pattern::from_groups(equations.count(), groups.iter().map(Vec::as_slice));
        let scatter = element_freedoms.iter().map(|freedoms| Scatter::new(&equations, &pattern, freedoms)).collect();
        let driven = |freedoms: &Vec<usize>| freedoms.iter().any(|&freedom| !equations.drives_of(freedom).is_empty());
        let driven_elements = (0..element_freedoms.len()).filter(|&e| driven(&element_freedoms[e])).collect();
        let solver = LinearSolver::new(&pattern, equations.nodes(), &equations_of_all(&equations, contact), options)?;
        let matrix = SystemMatrix::new(pattern);
        Ok(Self { equations, matrix, solver, scatter, element_freedoms, driven_elements, contact: Blocks::default() })
    }

    /// The equations.
    pub fn equations(&self) -> &Equations {
        &self.equations
    }

    /// The matrix of the last assembly.
    pub fn matrix(&self) -> &SystemMatrix {
        &self.matrix
    }

    /// Adds all elements into the matrix.
    pub fn assemble_elements(&mut self, elements: &impl ElementStiffness) {
        let values = &mut self.matrix.values;
        values.fill(0.0);
        for (element, scatter) in self.scatter.iter().enumerate() {
            let stiffness = elements.stiffness(element);
            match scatter {
                Scatter::Direct(entries) => {
                    for &(entry, place) in entries {
                        values[place as usize] += stiffness[entry as usize];
                    }
                }
                Scatter::Coupled(entries) => {
                    for &(entry, place, coefficient) in entries {
                        values[place as usize] += coefficient * stiffness[entry as usize];
                    }
                }
            }
        }
    }

    /// Takes over the blocks of contact and of loads that follow the body, by freedoms.
    pub fn set_blocks(&mut self, blocks: &Blocks) {
        self.contact.clone_from(blocks);
        self.matrix.contact.clear();
        for (freedoms, values) in blocks.iter() {
            let (rows, values) = reduced_block(&self.equations, freedoms, values);
            self.matrix.contact.push(&rows, &values);
        }
    }

    /// Factorises the matrix.
    ///
    /// # Errors
    ///
    /// It is singular or not finite.
    pub fn factorise(&mut self, symmetry: Symmetry) -> Result<FactorisationReport, SolverError> {
        self.solver.factorise(&self.matrix, symmetry)
    }

    /// Factorises again after the blocks alone have changed.
    ///
    /// # Errors
    ///
    /// It is singular or not finite.
    pub fn factorise_blocks(&mut self) -> Result<FactorisationReport, SolverError> {
        self.solver.factorise_contact(&self.matrix)
    }

    /// Solves in place with the last factor.
    ///
    /// # Errors
    ///
    /// The residual stays too large.
    pub fn solve(&mut self, right_side: &mut [f64]) -> Result<(), SolverError> {
        self.solver.solve(&self.matrix, right_side).map(|_| ())
    }

    /// Tᵀ K S a: the forces at the equations when the drives move by `drives` and the unknowns stay.
    pub fn drive_stiffness(&self, elements: &impl ElementStiffness, drives: &[f64]) -> Vec<f64> {
        let mut displacements = vec![0.0; self.equations.freedom_count()];
        self.equations.add_displacements(&vec![0.0; self.equations.count()], drives, &mut displacements);
        let mut forces = vec![0.0; displacements.len()];
        for &element in &self.driven_elements {
            add_product(&self.element_freedoms[element], elements.stiffness(element), &displacements, &mut forces);
        }
        for (freedoms, values) in self.contact.iter() {
            add_product(freedoms, values, &displacements, &mut forces);
        }
        let mut reduced = vec![0.0; self.equations.count()];
        self.equations.reduce(&forces, &mut reduced);
        reduced
    }
}

/// The freedoms of some nodes, two each.
pub(crate) fn freedoms(nodes: &[usize]) -> Vec<usize> {
    nodes.iter().flat_map(|&node| [0, 1].map(|component| Freedom { node, component }.index())).collect()
}

/// f += k u over some freedoms.
fn add_product(freedoms: &[usize], stiffness: &[f64], displacements: &[f64], forces: &mut [f64]) {
    for (row, &freedom) in stiffness.chunks_exact(freedoms.len()).zip(freedoms) {
        forces[freedom] += row.iter().zip(freedoms).map(|(k, &other)| k * displacements[other]).sum::<f64>();
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

/// Tᵀ k T of a block: its equations and values.
fn reduced_block(equations: &Equations, freedoms: &[usize], values: &[f64]) -> (Vec<usize>, Vec<f64>) {
    let rows = equations_of_all(equations, freedoms);
    let place = |equation: usize| rows.binary_search(&equation).expect("rows are the equations of these freedoms");
    let mut reduced = vec![0.0; rows.len() * rows.len()];
    for (line, &row_freedom) in values.chunks_exact(freedoms.len()).zip(freedoms) {
        for &(row, row_coefficient) in equations.equations_of(row_freedom) {
            for (value, &column_freedom) in line.iter().zip(freedoms) {
                for &(column, column_coefficient) in equations.equations_of(column_freedom) {
                    reduced[place(row) * rows.len() + place(column)] += row_coefficient * value * column_coefficient;
                }
            }
        }
    }
    (rows, reduced)
}

impl Scatter {
    fn new(equations: &Equations, pattern: &Pattern, freedoms: &[usize]) -> Self {
        let mut entries = Vec::with_capacity(freedoms.len() * freedoms.len());
        for (i, &row_freedom) in freedoms.iter().enumerate() {
            for (j, &column_freedom) in freedoms.iter().enumerate() {
                for &(row, a) in equations.equations_of(row_freedom) {
                    for &(column, b) in equations.equations_of(column_freedom) {
                        let place = pattern.index(row, column).expect("the pattern was made from these freedoms");
                        entries.push(((i * freedoms.len() + j) as u32, place as u32, a * b));
                    }
                }
            }
        }
        if entries.iter().all(|(_, _, coefficient)| *coefficient == 1.0) {
            Self::Direct(entries.into_iter().map(|(entry, place, _)| (entry, place)).collect())
        } else {
            Self::Coupled(entries)
        }
    }
}
