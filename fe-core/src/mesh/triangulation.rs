//! Triangles that fill an outline.
//!
//! The outline's points are given, and with them the sizes of the triangles: the constrained Delaunay triangulation is
//! refined (Ruppert) until no angle is below [`LEAST_ANGLE`], with triangles that grow from the small edges of the outline
//! towards its long ones. The outline's edges stay as they are, so that a contact surface keeps its nodes.

use spade::{
    AngleLimit, ConstrainedDelaunayTriangulation, InsertionError, Point2, RefinementParameters, Triangulation as _,
};

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

/// Reason why an outline cannot be filled.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum TriangulationError {
    /// A point that is no point of the plane.
    #[error("point {} of the outline is ({}, {})", index + 1, position[0], position[1])]
    Point {
        /// Index.
        index: usize,
        /// Its position.
        position: [f64; 2],
    },
    /// An outline that touches or crosses itself.
    #[error("the outline meets itself near ({}, {})", position[0], position[1])]
    Crossing {
        /// One of its points there.
        position: [f64; 2],
    },
    /// Sizes too different for the angles.
    #[error("sizes along the outline are too different: no triangulation with angles of {LEAST_ANGLE}° was found")]
    Unfinished,
}

/// Fills a closed outline, the body on its left, with triangles of at most an area.
///
/// # Errors
///
/// An outline that meets itself, or points that are not finite.
pub(crate) fn triangulate(outline: &[[f64; 2]], largest_area: f64) -> Result<Triangulation, TriangulationError> {
    let mut mesh = ConstrainedDelaunayTriangulation::<Point2<f64>>::new();
    let mut handles = Vec::with_capacity(outline.len());
    for (index, &[x, y]) in outline.iter().enumerate() {
        let refused = |_: InsertionError| TriangulationError::Point { index, position: [x, y] };
        handles.push(mesh.insert(Point2::new(x, y)).map_err(refused)?);
        if mesh.num_vertices() != handles.len() {
            return Err(TriangulationError::Crossing { position: [x, y] });
        }
    }
    for (index, &start) in handles.iter().enumerate() {
        let end = handles[(index + 1) % handles.len()];
        if !mesh.can_add_constraint(start, end) || !mesh.add_constraint(start, end) {
            return Err(TriangulationError::Crossing { position: outline[index] });
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
        return Err(TriangulationError::Unfinished);
    }
    let outer = std::collections::HashSet::<_>::from_iter(refined.excluded_faces);
    let points = mesh.vertices().map(|vertex| vertex.position()).map(|point| [point.x, point.y]).collect();
    let triangles = mesh.inner_faces().filter(|face| !outer.contains(&face.fix()));
    let triangles = triangles.map(|face| face.vertices().map(|vertex| vertex.index())).collect();
    Ok(Triangulation { points, triangles })
}

#[cfg(test)]
mod test {
    use super::*;

    fn area(points: &[[f64; 2]], corners: &[usize]) -> f64 {
        let twice = (0..corners.len()).map(|k| {
            let ([a_x, a_y], [b_x, b_y]) = (points[corners[k]], points[corners[(k + 1) % corners.len()]]);
            a_x * b_y - b_x * a_y
        });
        0.5 * twice.sum::<f64>()
    }

    fn least_angle(points: &[[f64; 2]], corners: [usize; 3]) -> f64 {
        let angle = |k: usize| {
            let [a, b, c] = [0, 1, 2].map(|step| points[corners[(k + step) % 3]]);
            let ([p_x, p_y], [q_x, q_y]) = ([b[0] - a[0], b[1] - a[1]], [c[0] - a[0], c[1] - a[1]]);
            (p_x * q_y - p_y * q_x).atan2(p_x * q_x + p_y * q_y).to_degrees()
        };
        (0..3).map(angle).fold(f64::INFINITY, f64::min)
    }

    #[test]
    fn a_graded_outline_is_filled_with_good_triangles_and_keeps_its_points() {
        // an L, its inner corner finely divided
        let corners: [[f64; 2]; 6] = [[0.0, 0.0], [10.0, 0.0], [10.0, 4.0], [4.0, 4.0], [4.0, 9.0], [0.0, 9.0]];
        let mut outline = Vec::new();
        for k in 0..6 {
            let (a, b) = (corners[k], corners[(k + 1) % 6]);
            let n = if k == 2 || k == 3 { 12 } else { 8 };
            outline.extend((0..n).map(|i| {
                let t = f64::from(i) / f64::from(n);
                [a[0] + t * (b[0] - a[0]), a[1] + t * (b[1] - a[1])]
            }));
        }
        let made = triangulate(&outline, 2.0).unwrap();
        assert_eq!(made.points[..outline.len()], outline[..]);
        let whole: f64 = made.triangles.iter().map(|corners| area(&made.points, corners)).sum();
        assert!((whole - 60.0).abs() < 1e-12, "{whole}");
        for &triangle in &made.triangles {
            assert!(area(&made.points, &triangle) > 0.0 && area(&made.points, &triangle) <= 2.0);
            assert!(least_angle(&made.points, triangle) > 20.0, "{triangle:?}");
        }
        // every edge of the outline is an edge of one triangle
        for k in 0..outline.len() {
            let next = (k + 1) % outline.len();
            let has = |t: &&[usize; 3]| (0..3).any(|i| t[i] == k && t[(i + 1) % 3] == next);
            assert_eq!(made.triangles.iter().filter(has).count(), 1, "{k}");
        }
        assert_eq!(made, triangulate(&outline, 2.0).unwrap(), "the same every time");
    }

    #[test]
    fn outlines_that_meet_themselves_are_told() {
        let crossing = [[0.0, 0.0], [1.0, 1.0], [1.0, 0.0], [0.0, 1.0]];
        assert!(matches!(triangulate(&crossing, 1.0), Err(TriangulationError::Crossing { .. })));
        let touching = [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 0.0], [-1.0, 1.0]];
        assert!(matches!(triangulate(&touching, 1.0), Err(TriangulationError::Crossing { .. })));
        let lost = [[0.0, 0.0], [f64::NAN, 0.0], [1.0, 1.0]];
        assert!(matches!(triangulate(&lost, 1.0), Err(TriangulationError::Point { index: 1, .. })));
    }
}
