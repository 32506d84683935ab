//! Faults of a mesh. Messages count nodes, elements, parts and edges from 1.

use crate::element::{ElementKind, MappingError};

/// The first fault of a mesh. Indices in the fields count from 0, in the messages from 1.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[allow(missing_docs, reason = "the message of each variant says what its fields are")]
pub enum MeshError {
    /// Not a positive number, or of no element.
    #[error("element {}: its thickness is {thickness}, it must be positive, of one of the {count} elements", element + 1)]
    ElementThickness { element: usize, thickness: f64, count: usize },
    /// An edge that bulges across the axis.
    #[error("element {} ({kind}): integration point {} has the radius {radius}, not positive in the axisymmetric part '{part}'", element + 1, point + 1)]
    PointRadius { element: usize, kind: ElementKind, part: String, point: usize, radius: f64 },
    /// Inverted, or collapsed.
    #[error("element {} ({kind}): at integration point {} {source} (nodes go counter-clockwise; is it folded?)", element + 1, point + 1)]
    Jacobian { element: usize, kind: ElementKind, point: usize, source: MappingError },
    /// All but collapsed.
    #[error("element {} ({kind}): at integration point {} the Jacobian determinant is {determinant:.3e}, lost in rounding against its diagonal squared, {diagonal_squared:.3e}", element + 1, point + 1)]
    Sliver { element: usize, kind: ElementKind, point: usize, determinant: f64, diagonal_squared: f64 },
    /// Any other, in words.
    #[error("{0}")]
    Unsound(String),
}

impl MeshError {
    /// A fault of an element.
    pub(super) fn of_element(element: usize, kind: ElementKind, fault: &str) -> Self {
        Self::Unsound(format!("element {} ({kind}): {fault}", element + 1))
    }
}
