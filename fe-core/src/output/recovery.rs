//! Recovery of nodal values from integration points.

use super::fields::{FieldsError, expect_length};
use crate::element::{ElementKind, IntegrationPoint};
use crate::mesh::Mesh;

/// Extrapolation to nodes and averaging, for one mesh.
///
/// Values have a place at each node once for each part that has it: where parts meet, fields have two values. Places go part
/// by part, ascending by node; nodes without an element have none.
#[derive(Clone, Debug)]
pub struct Recovery {
    nodes: Vec<usize>,
    parts: Vec<usize>,
    /// The places of each element's nodes.
    places: Vec<Vec<usize>>,
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
        let mut keys: Vec<(usize, usize)> = Vec::new();
        for element in mesh.elements() {
            keys.extend(element.nodes().iter().map(|&node| (element.part(), node)));
        }
        keys.sort_unstable();
        keys.dedup();
        let mut matrices: Vec<Extrapolation> = Vec::new();
        let mut matrix_of = Vec::with_capacity(mesh.elements().len());
        let mut places = Vec::with_capacity(mesh.elements().len());
        let mut counts = vec![0.0; keys.len()];
        let mut point_count = 0;
        for (index, element) in mesh.elements().iter().enumerate() {
            let points = mesh.integration_points(index);
            let known = matrices.iter().position(|m| m.kind == element.kind() && m.points == points.len());
            matrix_of.push(known.unwrap_or_else(|| {
                matrices.push(Extrapolation::new(element.kind(), points));
                matrices.len() - 1
            }));
            let place = |&node: &usize| keys.partition_point(|key| *key < (element.part(), node));
            let own: Vec<usize> = element.nodes().iter().map(place).collect();
            own.iter().for_each(|&place| counts[place] += 1.0);
            places.push(own);
            point_count += points.len();
        }
        let (parts, nodes) = keys.into_iter().unzip();
        Self { nodes, parts, places, matrices, matrix_of, counts, point_count }
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
        &self.places[element]
    }

    /// Values at the places from values at all points, element by element.
    pub fn recover<const N: usize>(&self, values: &[[f64; N]]) -> Result<Vec<[f64; N]>, FieldsError> {
        expect_length("values at integration points", values.len(), self.point_count)?;
        let mut nodal = vec![[0.0; N]; self.counts.len()];
        let mut start = 0;
        for (element, &matrix) in self.matrix_of.iter().enumerate() {
            let Extrapolation { points, rows, .. } = &self.matrices[matrix];
            let own = &values[start..start + points];
            start += points;
            for (&place, row) in self.places[element].iter().zip(rows.chunks_exact(*points)) {
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
        Ok(nodal.iter().zip(&self.parts).map(limited).collect())
    }
}

impl Extrapolation {
    fn new(kind: ElementKind, points: &[IntegrationPoint]) -> Self {
        let row = |&node: &[f64; 2]| match (kind.corner_count(), points) {
            (3, [corner, along_xi, along_eta]) => {
                linear_weights([corner, along_xi, along_eta].map(|point| point.coordinates), node)
            }
            (3, _) => vec![1.0 / points.len() as f64; points.len()],
            _ => product_weights(points, node),
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
