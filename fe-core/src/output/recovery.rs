//! Recovery of nodal values from integration points.

use super::fields::{FieldsError, expect_length};
use crate::element::{ElementKind, IntegrationPoint};
use crate::mesh::Mesh;

/// The nodes of a mesh, once for each part that has them: where parts meet, fields have two values.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct PartNodes {
    nodes: Vec<usize>,
    parts: Vec<usize>,
    connectivity: Vec<usize>,
    starts: Vec<usize>,
}

impl PartNodes {
    /// Numbers them part by part, ascending by node. Nodes without an element have no place.
    pub fn new(mesh: &Mesh) -> Self {
        let mut nodes = Vec::new();
        let mut parts = Vec::new();
        let mut places = vec![Vec::new(); mesh.parts().len()];
        for part in 0..mesh.parts().len() {
            let mut used = vec![false; mesh.nodes().len()];
            for element in mesh.elements().iter().filter(|element| element.part() == part) {
                element.nodes().iter().for_each(|&node| used[node] = true);
            }
            let mut place_of = vec![usize::MAX; mesh.nodes().len()];
            for node in (0..used.len()).filter(|&node| used[node]) {
                place_of[node] = nodes.len();
                nodes.push(node);
                parts.push(part);
            }
            places[part] = place_of;
        }
        let mut starts = vec![0];
        let mut connectivity = Vec::new();
        for element in mesh.elements() {
            connectivity.extend(element.nodes().iter().map(|&node| places[element.part()][node]));
            starts.push(connectivity.len());
        }
        Self { nodes, parts, connectivity, starts }
    }

    /// The mesh's node at each place.
    pub fn nodes(&self) -> &[usize] {
        &self.nodes
    }

    /// The part at each place.
    pub fn parts(&self) -> &[usize] {
        &self.parts
    }

    /// The places of an element's nodes.
    pub fn of_element(&self, element: usize) -> &[usize] {
        &self.connectivity[self.starts[element]..self.starts[element + 1]]
    }
}

/// Extrapolation to nodes and averaging, for one mesh.
#[derive(Clone, Debug)]
pub struct Recovery {
    nodes: PartNodes,
    matrices: Vec<Extrapolation>,
    /// Index of each element's matrix.
    matrix_of: Vec<usize>,
    /// Number of elements at each place.
    counts: Vec<f64>,
    point_count: usize,
}

/// The matrix E of one kind of element with one rule, row by row: a row for each node, a column for each point.
#[derive(Clone, Debug)]
struct Extrapolation {
    kind: ElementKind,
    points: usize,
    rows: Vec<f64>,
}

impl Recovery {
    /// Prepares a mesh.
    pub fn new(mesh: &Mesh) -> Self {
        let nodes = PartNodes::new(mesh);
        let mut matrices: Vec<Extrapolation> = Vec::new();
        let mut matrix_of = Vec::with_capacity(mesh.elements().len());
        let mut counts = vec![0.0; nodes.nodes.len()];
        let mut point_count = 0;
        for (index, element) in mesh.elements().iter().enumerate() {
            let points = mesh.integration_points(index);
            let known = matrices.iter().position(|m| m.kind == element.kind() && m.points == points.len());
            matrix_of.push(known.unwrap_or_else(|| {
                matrices.push(Extrapolation::new(element.kind(), points));
                matrices.len() - 1
            }));
            nodes.of_element(index).iter().for_each(|&place| counts[place] += 1.0);
            point_count += points.len();
        }
        Self { nodes, matrices, matrix_of, counts, point_count }
    }

    /// The places that values are recovered at.
    pub fn nodes(&self) -> &PartNodes {
        &self.nodes
    }

    /// Values at the places of [`Self::nodes`] from values at all points, element by element.
    pub fn recover<const N: usize>(&self, values: &[[f64; N]]) -> Result<Vec<[f64; N]>, FieldsError> {
        expect_length("values at integration points", values.len(), self.point_count)?;
        let mut nodal = vec![[0.0; N]; self.counts.len()];
        let mut start = 0;
        for (element, &matrix) in self.matrix_of.iter().enumerate() {
            let Extrapolation { points, rows, .. } = &self.matrices[matrix];
            let own = &values[start..start + points];
            start += points;
            for (&place, row) in self.nodes.of_element(element).iter().zip(rows.chunks_exact(*points)) {
                for (factor, value) in row.iter().zip(own) {
                    for k in 0..N {
                        nodal[place][k] += factor * value[k] / self.counts[place];
                    }
                }
            }
        }
        Ok(nodal)
    }

    /// Recovers as [`Self::recover`] does, limited in each part to the range of that part's points (see the module's page).
    pub fn recover_limited(&self, mesh: &Mesh, values: &[f64]) -> Result<Vec<f64>, FieldsError> {
        let columns: Vec<[f64; 1]> = values.iter().map(|&value| [value]).collect();
        let nodal = self.recover(&columns)?;
        let mut ranges = vec![(f64::INFINITY, f64::NEG_INFINITY); mesh.parts().len()];
        let mut start = 0;
        for (element, &matrix) in mesh.elements().iter().zip(&self.matrix_of) {
            let end = start + self.matrices[matrix].points;
            let range = &mut ranges[element.part()];
            *range = values[start..end].iter().fold(*range, |(least, most), &v| (least.min(v), most.max(v)));
            start = end;
        }
        // f64::min and max drop a NaN, which must stay one
        let limited = |(value, part): (&[f64; 1], &usize)| {
            let (least, most) = ranges[*part];
            if value[0].is_nan() { f64::NAN } else { value[0].max(least).min(most) }
        };
        Ok(nodal.iter().zip(&self.nodes.parts).map(limited).collect())
    }
}

impl Extrapolation {
    fn new(kind: ElementKind, points: &[IntegrationPoint]) -> Self {
        let row = |&node: &[f64; 2]| match (kind, points) {
            (ElementKind::T3 | ElementKind::T6, [corner, along_xi, along_eta]) => {
                linear_weights([corner, along_xi, along_eta].map(|point| point.coordinates), node)
            }
            (ElementKind::T3 | ElementKind::T6, _) => vec![1.0 / points.len() as f64; points.len()],
            (ElementKind::Q4 | ElementKind::Q8, _) => product_weights(points, node),
        };
        Self { kind, points: points.len(), rows: kind.reference_coordinates().iter().flat_map(row).collect() }
    }
}

/// Area coordinates of a place in the triangle of three points.
fn linear_weights([p, q, r]: [[f64; 2]; 3], [xi, eta]: [f64; 2]) -> Vec<f64> {
    let (a, b, c) = ([q[0] - p[0], q[1] - p[1]], [r[0] - p[0], r[1] - p[1]], [xi - p[0], eta - p[1]]);
    let cross = |u: [f64; 2], v: [f64; 2]| u[0] * v[1] - u[1] * v[0];
    let (second, third) = (cross(c, b) / cross(a, b), cross(a, c) / cross(a, b));
    vec![1.0 - second - third, second, third]
}

/// Products of the Lagrange polynomials through the points of a product rule, ξ running fastest.
fn product_weights(points: &[IntegrationPoint], [xi, eta]: [f64; 2]) -> Vec<f64> {
    let line: Vec<f64> = points.iter().take(points.len().isqrt()).map(|point| point.coordinates[0]).collect();
    let lagrange = |index: usize, at: f64| -> f64 {
        let others = line.iter().enumerate().filter(|&(other, _)| other != index);
        others.map(|(_, abscissa)| (at - abscissa) / (line[index] - abscissa)).product()
    };
    let count = line.len();
    (0..count * count).map(|index| lagrange(index % count, xi) * lagrange(index / count, eta)).collect()
}
