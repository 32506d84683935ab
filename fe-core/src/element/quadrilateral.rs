//! Shape functions of the quadrilaterals.

use super::integration::{GAUSS_2X2, GAUSS_3X3};
use super::{EdgeKind, ElementDescription, ShapeFunctions};

pub(super) const Q4: ElementDescription = ElementDescription {
    coordinates: COORDINATES.first_chunk::<4>().expect("corners"),
    corner_count: 4,
    edge_kind: EdgeKind::Linear,
    shape_functions: bilinear,
    full: &GAUSS_2X2,
    reduced: None,
    band: 1.0,
    gmsh: 3,
    vtk: 9,
};

pub(super) const Q8: ElementDescription = ElementDescription {
    coordinates: &COORDINATES,
    edge_kind: EdgeKind::Quadratic,
    shape_functions: serendipity,
    full: &GAUSS_3X3,
    reduced: Some(&GAUSS_2X2),
    gmsh: 16,
    vtk: 23,
    ..Q4
};

/// Corners, then the middles of the edges.
const COORDINATES: [[f64; 2]; 8] =
    [[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0], [0.0, -1.0], [1.0, 0.0], [0.0, 1.0], [-1.0, 0.0]];

/// Q4: products of linear functions.
fn bilinear([xi, eta]: [f64; 2]) -> ShapeFunctions {
    let mut shape = ShapeFunctions::zero(4);
    for node in 0..4 {
        let [a, b] = COORDINATES[node];
        let (along_xi, along_eta) = (1.0 + a * xi, 1.0 + b * eta);
        shape.values[node] = 0.25 * along_xi * along_eta;
        shape.derivatives[node] = [0.25 * a * along_eta, 0.25 * along_xi * b];
    }
    shape
}

/// Q8: the serendipity functions.
fn serendipity([xi, eta]: [f64; 2]) -> ShapeFunctions {
    let mut shape = ShapeFunctions::zero(8);
    for node in 0..4 {
        let [a, b] = COORDINATES[node];
        let (along_xi, along_eta) = (1.0 + a * xi, 1.0 + b * eta);
        shape.values[node] = 0.25 * along_xi * along_eta * (a * xi + b * eta - 1.0);
        // With aa = bb = 1 the product rule collapses to these.
        shape.derivatives[node] =
            [0.25 * a * along_eta * (2.0 * a * xi + b * eta), 0.25 * b * along_xi * (2.0 * b * eta + a * xi)];
    }
    for node in [4, 6] {
        let b = COORDINATES[node][1];
        let (bubble, along_eta) = ((1.0 - xi) * (1.0 + xi), 1.0 + b * eta);
        shape.values[node] = 0.5 * bubble * along_eta;
        shape.derivatives[node] = [-xi * along_eta, 0.5 * bubble * b];
    }
    for node in [5, 7] {
        let a = COORDINATES[node][0];
        let (along_xi, bubble) = (1.0 + a * xi, (1.0 - eta) * (1.0 + eta));
        shape.values[node] = 0.5 * along_xi * bubble;
        shape.derivatives[node] = [0.5 * a * bubble, -eta * along_xi];
    }
    shape
}
