//! Shape functions of the triangles, in the area coordinates (1 − ξ − η, ξ, η).

use super::integration::{CENTROID, TRIANGLE_3};
use super::{EdgeKind, ElementDescription, ShapeFunctions};

pub(super) const T3: ElementDescription = ElementDescription {
    coordinates: COORDINATES.first_chunk::<3>().expect("corners"),
    corner_count: 3,
    edge_kind: EdgeKind::Linear,
    shape_functions: linear,
    full: &CENTROID,
    reduced: None,
    band: 1.0,
    gmsh: 2,
    vtk: 5,
};

pub(super) const T6: ElementDescription = ElementDescription {
    coordinates: &COORDINATES,
    edge_kind: EdgeKind::Quadratic,
    shape_functions: quadratic,
    full: &TRIANGLE_3,
    band: 2.0 / 3.0,
    gmsh: 9,
    vtk: 22,
    ..T3
};

/// Corners, then the middles of the edges.
const COORDINATES: [[f64; 2]; 6] = [[0.0, 0.0], [1.0, 0.0], [0.0, 1.0], [0.5, 0.0], [0.5, 0.5], [0.0, 0.5]];

/// Derivatives of the three area coordinates by ξ and η.
const AREA_COORDINATE_DERIVATIVES: [[f64; 2]; 3] = [[-1.0, -1.0], [1.0, 0.0], [0.0, 1.0]];

/// T3: the area coordinates themselves.
fn linear([xi, eta]: [f64; 2]) -> ShapeFunctions {
    let mut shape = ShapeFunctions::zero(3);
    shape.values[..3].copy_from_slice(&[1.0 - xi - eta, xi, eta]);
    shape.derivatives[..3].copy_from_slice(&AREA_COORDINATE_DERIVATIVES);
    shape
}

/// T6: Lᵢ (2Lᵢ − 1) at the corners, 4 Lᵢ Lⱼ at the middle of edge ij.
fn quadratic([xi, eta]: [f64; 2]) -> ShapeFunctions {
    let area_coordinates = [1.0 - xi - eta, xi, eta];
    let mut shape = ShapeFunctions::zero(6);
    for start in 0..3 {
        let end = (start + 1) % 3;
        let middle = 3 + start;
        let (l_start, l_end) = (area_coordinates[start], area_coordinates[end]);
        shape.values[start] = l_start * (2.0 * l_start - 1.0);
        shape.values[middle] = 4.0 * l_start * l_end;
        for k in 0..2 {
            let (d_start, d_end) = (AREA_COORDINATE_DERIVATIVES[start][k], AREA_COORDINATE_DERIVATIVES[end][k]);
            shape.derivatives[start][k] = (4.0 * l_start - 1.0) * d_start;
            shape.derivatives[middle][k] = 4.0 * (d_start * l_end + l_start * d_end);
        }
    }
    shape
}
