//! Elastic bodies of Q8 elements in rows and columns. Shared by the tests and the benchmark, which import what it uses.

use super::{
    Arc, ElementKind, Integration, MAX_FREEDOMS, MappedPoint, Pattern, PlaneModel, StrainDisplacement, SystemMatrix,
};

/// Rectangles of unit squares in plane strain, with equations for all freedoms but those of held nodes.
#[derive(Default)]
pub struct Bodies {
    /// The node of each equation.
    pub nodes: Vec<usize>,
    /// Position of that node, from the lower left corner of its body.
    pub positions: Vec<[f64; 2]>,
    /// The lower and the upper surface of each body, equations from left to right.
    pub surfaces: Vec<[Vec<usize>; 2]>,
    node_count: usize,
    elements: Vec<(Vec<usize>, Vec<f64>)>,
}

impl Bodies {
    /// Adds a body; `held`: its left side is fixed.
    pub fn add(&mut self, columns: usize, rows: usize, modulus: f64, held: bool) {
        let (width, height) = (2 * columns + 1, 2 * rows + 1);
        let mut equations = vec![[None; 2]; width * height];
        for (place, pair) in equations.iter_mut().enumerate() {
            let (i, j) = (place % width, place / width);
            if i % 2 == 1 && j % 2 == 1 || held && i == 0 {
                continue;
            }
            *pair = [Some(self.nodes.len()), Some(self.nodes.len() + 1)];
            self.nodes.extend([self.node_count; 2]);
            self.positions.extend([[0.5 * i as f64, 0.5 * j as f64]; 2]);
            self.node_count += 1;
        }
        let surface = |j: usize| equations[j * width..(j + 1) * width].iter().flatten().flatten().copied().collect();
        self.surfaces.push([surface(0), surface(height - 1)]);
        let stiffness = element_stiffness(modulus);
        for (row, column) in (0..rows).flat_map(|row| (0..columns).map(move |column| (row, column))) {
            let corner = |i: usize, j: usize| equations[(2 * row + j) * width + 2 * column + i];
            let freedoms: Vec<Option<usize>> = LATTICE.iter().flat_map(|&[i, j]| corner(i, j)).collect();
            let free: Vec<usize> = (0..freedoms.len()).filter(|&freedom| freedoms[freedom].is_some()).collect();
            let values = free.iter().flat_map(|&row| free.iter().map(move |&column| (row, column)));
            let values = values.map(|(row, column)| stiffness[row][column]).collect();
            self.elements.push((freedoms.into_iter().flatten().collect(), values));
        }
    }

    /// The stiffness of all bodies.
    pub fn matrix(&self) -> SystemMatrix {
        let groups = self.elements.iter().map(|(equations, _)| equations.as_slice());
        let mut matrix = SystemMatrix::new(Arc::new(Pattern::from_groups(self.nodes.len(), groups)));
        for (equations, values) in &self.elements {
            for (&row, line) in equations.iter().zip(values.chunks_exact(equations.len())) {
                for (&column, value) in equations.iter().zip(line) {
                    let place = matrix.pattern().index(row, column).expect("elements made the pattern");
                    matrix.values[place] += value;
                }
            }
        }
        matrix
    }
}

/// Nodes of a Q8 on a lattice of half its side.
const LATTICE: [[usize; 2]; 8] = [[0, 0], [2, 0], [2, 2], [0, 2], [1, 0], [2, 1], [1, 2], [0, 1]];

/// Stiffness of a unit square, Poisson's ratio 0.2.
fn element_stiffness(modulus: f64) -> [[f64; MAX_FREEDOMS]; MAX_FREEDOMS] {
    let poisson = 0.2;
    let shear = modulus / (2.0 * (1.0 + poisson));
    let lame = 2.0 * shear * poisson / (1.0 - 2.0 * poisson);
    let nodes = LATTICE.map(|[i, j]| [0.5 * i as f64, 0.5 * j as f64]);
    let mut stiffness = [[0.0; MAX_FREEDOMS]; MAX_FREEDOMS];
    for point in ElementKind::Q8.integration_points(Integration::Reduced).expect("Q8 has it") {
        let mapped = MappedPoint::new(ElementKind::Q8, &nodes, point.coordinates).expect("a square");
        let b = StrainDisplacement::new(PlaneModel::PlaneStrain, &mapped).expect("plane strain");
        for (column, strain) in b.columns().iter().enumerate() {
            let dilatation: f64 = strain[..3].iter().sum();
            let mut stress = strain.map(|component| 2.0 * shear * component);
            stress[3] = shear * strain[3];
            stress[..3].iter_mut().for_each(|direct| *direct += lame * dilatation);
            for (row, virtual_strain) in b.columns().iter().enumerate() {
                let power: f64 = virtual_strain.iter().zip(&stress).map(|(strain, stress)| strain * stress).sum();
                stiffness[row][column] += power * mapped.determinant * point.weight;
            }
        }
    }
    stiffness
}
