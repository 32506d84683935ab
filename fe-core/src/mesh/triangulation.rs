//! Triangles that fill an outline.
//!
//! The outline's points are given, and with them the sizes of the triangles: the constrained Delaunay triangulation is
//! refined (Ruppert) until no angle is below [`LEAST_ANGLE`], with triangles that grow from the small edges of the outline
//! towards its long ones. The outline's edges stay as they are, so that a contact surface keeps its nodes.

use super::MeshError;
use spade::{
    AngleLimit, ConstrainedDelaunayTriangulation, InsertionError, Point2, RefinementParameters, Triangulation as _,
};

#[cfg(test)]
mod test;

/// Angles that refinement tries to reach everywhere, degrees.
pub const LEAST_ANGLE: f64 = 27.0;
/// Points that refinement may add, for each point of the outline.
const ADDED_POINTS: usize = 1000;
/// Points that it may add in all: beyond what can be solved.
const MOST_ADDED_POINTS: usize = 1_000_000;

/// Triangles that fill an outline.
#[derive(Clone, Debug, PartialEq)]
pub struct Triangulation {
    /// Corners (x, y): first those of the outline, in its order.
    pub points: Vec<[f64; 2]>,
    /// Corners of each triangle, counter-clockwise.
    pub triangles: Vec<[usize; 3]>,
}

/// Fills a closed outline, the body on its left, with triangles of at most an area.
///
/// # Errors
///
/// An outline that meets itself, points that are not finite, or sizes too different for the angles.
pub(crate) fn triangulate(outline: &[[f64; 2]], largest_area: f64) -> Result<Triangulation, MeshError> {
    let meets_itself = |[x, y]: [f64; 2]| MeshError(format!("the outline meets itself near ({x}, {y})"));
    let mut mesh = ConstrainedDelaunayTriangulation::<Point2<f64>>::new();
    let mut handles = Vec::with_capacity(outline.len());
    for (&[x, y], number) in outline.iter().zip(1..) {
        let refused = |_: InsertionError| MeshError(format!("point {number} of the outline is ({x}, {y})"));
        handles.push(mesh.insert(Point2::new(x, y)).map_err(refused)?);
        if mesh.num_vertices() != handles.len() {
            return Err(meets_itself([x, y]));
        }
    }
    for (index, &start) in handles.iter().enumerate() {
        let end = handles[(index + 1) % handles.len()];
        if !mesh.can_add_constraint(start, end) || !mesh.add_constraint(start, end) {
            return Err(meets_itself(outline[index]));
        }
    }
    let refined = mesh.refine(
        RefinementParameters::new()
            .exclude_outer_faces(true)
            .keep_constraint_edges()
            .with_max_allowed_area(largest_area)
            .with_angle_limit(AngleLimit::from_deg(LEAST_ANGLE))
            .with_max_additional_vertices((ADDED_POINTS * outline.len()).min(MOST_ADDED_POINTS)),
    );
    if !refined.refinement_complete {
        return Err(MeshError(format!(
            "sizes along the outline are too different: no triangulation with angles of {LEAST_ANGLE}° was found"
        )));
    }
    let outer = std::collections::HashSet::<_>::from_iter(refined.excluded_faces);
    let points = mesh.vertices().map(|vertex| vertex.position()).map(|point| [point.x, point.y]).collect();
    let triangles = mesh.inner_faces().filter(|face| !outer.contains(&face.fix()));
    let triangles = triangles.map(|face| face.vertices().map(|vertex| vertex.index())).collect();
    Ok(Triangulation { points, triangles })
}
