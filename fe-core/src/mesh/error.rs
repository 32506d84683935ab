//! Faults of meshes, of their files and of what they are made from.

use crate::element::ElementKind;

/// Message about the first fault of a mesh, of its file, or of what it is made from. Nodes, elements, parts and edges
/// are counted from 1; in a Gmsh file nodes and elements have the tags of the file.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[error("{0}")]
pub struct MeshError(pub(super) String);

impl MeshError {
    /// A fault of an element.
    pub(super) fn of_element(element: usize, kind: ElementKind, fault: &str) -> Self {
        Self(format!("element {} ({kind}): {fault}", element + 1))
    }
}
