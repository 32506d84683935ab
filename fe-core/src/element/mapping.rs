//! The isoparametric map of an element from (ξ, η) to (x, y).

use super::{ElementKind, ShapeFunctions};

/// Reason why an element cannot be mapped.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
pub enum MappingError {
    /// Not one position per node.
    #[error("{kind} has {} nodes, but {found} positions were given", kind.node_count())]
    NodeCount {
        /// The kind of element.
        kind: ElementKind,
        /// Number of positions given.
        found: usize,
    },
    /// The element is inverted, collapsed, or not finite at this point.
    #[error("the Jacobian determinant is {determinant:.3e} where it must be positive")]
    Jacobian {
        /// det J.
        determinant: f64,
    },
}

/// One point of an element in space.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MappedPoint {
    /// (x, y).
    pub position: [f64; 2],
    /// J_jk = ∂x_j/∂ξ_k.
    pub jacobian: [[f64; 2]; 2],
    /// det J, positive.
    pub determinant: f64,
    /// Shape functions, with their derivatives by x and y.
    pub shape: ShapeFunctions,
}

impl MappedPoint {
    /// Maps the point (ξ, η) of an element whose nodes are at `nodes`.
    ///
    /// # Errors
    ///
    /// Not one position per node, or det J is not positive and finite.
    pub fn new(kind: ElementKind, nodes: &[[f64; 2]], reference: [f64; 2]) -> Result<Self, MappingError> {
        if nodes.len() != kind.node_count() {
            return Err(MappingError::NodeCount { kind, found: nodes.len() });
        }
        let mut shape = kind.shape_functions(reference);
        let (mut position, mut jacobian) = ([0.0; 2], [[0.0; 2]; 2]);
        for ((node, value), derivative) in nodes.iter().zip(shape.values()).zip(shape.derivatives()) {
            for j in 0..2 {
                position[j] += value * node[j];
                for k in 0..2 {
                    jacobian[j][k] += node[j] * derivative[k];
                }
            }
        }
        let determinant = jacobian[0][0] * jacobian[1][1] - jacobian[0][1] * jacobian[1][0];
        if !(determinant > 0.0 && determinant.is_finite()) {
            return Err(MappingError::Jacobian { determinant });
        }
        for derivative in &mut shape.derivatives[..nodes.len()] {
            let [by_xi, by_eta] = *derivative;
            *derivative = [
                (by_xi * jacobian[1][1] - by_eta * jacobian[1][0]) / determinant,
                (by_eta * jacobian[0][0] - by_xi * jacobian[0][1]) / determinant,
            ];
        }
        Ok(Self { position, jacobian, determinant, shape })
    }
}

/// The area of an element, exact for straight and curved edges.
///
/// # Errors
///
/// As [`MappedPoint::new`], at any point of the full rule.
pub fn area(kind: ElementKind, nodes: &[[f64; 2]]) -> Result<f64, MappingError> {
    kind.full_integration_points().iter().try_fold(0.0, |area, point| {
        Ok(area + point.weight * MappedPoint::new(kind, nodes, point.coordinates)?.determinant)
    })
}

/// Returns the length that a UMAT receives as `CELENT`, for an element of this area in the reference configuration. It
/// is the width of a crack band on aligned meshes: times the energy per volume that the law dissipates, it gives the
/// energy per crack area.
///
/// A straight band of quadrilaterals, or of pairs of linear triangles, is √A wide, where A is the area of the
/// quadrilateral. In a pair of quadratic triangles a crack opens 4 of the 6 integration points: the band is ⅔ as wide.
/// In quadratic quadrilaterals a crack opens both columns of points if symmetry demands it. Otherwise it opens one
/// column, and the band is half as wide as returned here (`bench/crack-band`).
pub fn characteristic_length(kind: ElementKind, reference_area: f64) -> f64 {
    kind.description().band * (kind.count_in_square() * reference_area).sqrt()
}
