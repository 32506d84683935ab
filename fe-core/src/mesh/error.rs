//! Faults of a mesh.

use crate::element::ElementKind;

/// The first fault of a mesh, in words. They count nodes, elements, parts and edges from 1.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[error("{0}")]
pub struct MeshError(pub(super) String);

impl MeshError {
    /// A fault of an element.
    pub(super) fn of_element(element: usize, kind: ElementKind, fault: &str) -> Self {
        Self(format!("element {} ({kind}): {fault}", element + 1))
    }
}
