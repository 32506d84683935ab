//! Faults of a mesh. Messages count nodes, elements, parts and edges from 1.

use crate::element::{ElementKind, Integration, MappingError};

/// Kind of set that a message is about.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SetKind {
    /// Nodes.
    Node,
    /// Edges of elements.
    Edge,
}

impl std::fmt::Display for SetKind {
    fn fmt(&self, formatter: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        formatter.write_str(match self {
            Self::Node => "node set",
            Self::Edge => "edge set",
        })
    }
}

/// The first fault of a mesh. Indices in the fields count from 0, in the messages from 1.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[allow(missing_docs, reason = "the message of each variant says what its fields are")]
pub enum MeshError {
    /// Nothing to compute.
    #[error("the mesh has no elements")]
    NoElements,
    /// NaN or infinite.
    #[error("node {}: its position ({}, {}) is not finite", node + 1, position[0], position[1])]
    Position { node: usize, position: [f64; 2] },
    /// Two parts of one name.
    #[error("parts {} and {} are both called '{name}'", first + 1, second + 1)]
    PartName { name: String, first: usize, second: usize },
    /// Not a positive number.
    #[error("part '{part}': its thickness is {thickness}, it must be positive")]
    Thickness { part: String, thickness: f64 },
    /// Not a positive number, or of no element.
    #[error("element {}: its thickness is {thickness}, it must be positive, of one of the {count} elements", element + 1)]
    ElementThickness { element: usize, thickness: f64, count: usize },
    /// Not as many nodes as the kind has.
    #[error("element {} ({kind}): it has {found} nodes, {kind} needs {}", element + 1, kind.node_count())]
    NodeCount { element: usize, kind: ElementKind, found: usize },
    /// A node that does not exist.
    #[error("element {} ({kind}): its node {} does not exist, the mesh has {count}", element + 1, node + 1)]
    NodeIndex { element: usize, kind: ElementKind, node: usize, count: usize },
    /// A node twice in one element.
    #[error("element {} ({kind}): it has node {} twice", element + 1, node + 1)]
    RepeatedNode { element: usize, kind: ElementKind, node: usize },
    /// A part that does not exist.
    #[error("element {} ({kind}): its part {} does not exist, the mesh has {count}", element + 1, part + 1)]
    PartIndex { element: usize, kind: ElementKind, part: usize, count: usize },
    /// An integration that the kind does not have.
    #[error("element {} ({kind}): part '{part}' asks for {integration} integration, which {kind} does not have", element + 1)]
    Integration { element: usize, kind: ElementKind, part: String, integration: Integration },
    /// Left of the axis.
    #[error("element {} ({kind}): node {} has the radius {radius}, negative in the axisymmetric part '{part}'", element + 1, node + 1)]
    Radius { element: usize, kind: ElementKind, part: String, node: usize, radius: f64 },
    /// An edge that bulges across the axis.
    #[error("element {} ({kind}): integration point {} has the radius {radius}, not positive in the axisymmetric part '{part}'", element + 1, point + 1)]
    PointRadius { element: usize, kind: ElementKind, part: String, point: usize, radius: f64 },
    /// Inverted, or collapsed.
    #[error("element {} ({kind}): at integration point {} {source} (nodes go counter-clockwise; is it folded?)", element + 1, point + 1)]
    Jacobian { element: usize, kind: ElementKind, point: usize, source: MappingError },
    /// All but collapsed.
    #[error("element {} ({kind}): at integration point {} the Jacobian determinant is {determinant:.3e}, lost in rounding against its diagonal squared, {diagonal_squared:.3e}", element + 1, point + 1)]
    Sliver { element: usize, kind: ElementKind, point: usize, determinant: f64, diagonal_squared: f64 },
    /// Three elements on one edge.
    #[error("elements {}, {} and {} share the edge of nodes {}–{}; an edge has two sides", elements[0] + 1, elements[1] + 1, elements[2] + 1, nodes[0] + 1, nodes[1] + 1)]
    CrowdedEdge { elements: [usize; 3], nodes: [usize; 2] },
    /// Two elements on the same side of an edge.
    #[error("elements {} and {} lie on the same side of their edge of nodes {}–{}: they overlap", elements[0] + 1, elements[1] + 1, nodes[0] + 1, nodes[1] + 1)]
    Overlap { elements: [usize; 2], nodes: [usize; 2] },
    /// A linear edge against a quadratic one, or two middle nodes.
    #[error("elements {} and {} share the edge of nodes {}–{} but not its middle node ({} against {})", elements[0] + 1, elements[1] + 1, nodes[0] + 1, nodes[1] + 1, middle_name(middles[0]), middle_name(middles[1]))]
    MiddleNode { elements: [usize; 2], nodes: [usize; 2], middles: [Option<usize>; 2] },
    /// A set of nothing.
    #[error("{kind} '{name}' is empty")]
    EmptySet { kind: SetKind, name: String },
    /// A node that does not exist.
    #[error("node set '{name}': node {} does not exist, the mesh has {count}", node + 1)]
    SetNode { name: String, node: usize, count: usize },
    /// An edge that does not exist.
    #[error("edge set '{name}': edge {} of element {} does not exist", edge + 1, element + 1)]
    SetEdge { name: String, element: usize, edge: usize },
    /// A node twice in a set.
    #[error("node set '{name}' has node {} twice", node + 1)]
    SetNodeRepeated { name: String, node: usize },
    /// An edge twice in a set.
    #[error("edge set '{name}' has edge {} of element {} twice", edge + 1, element + 1)]
    SetEdgeRepeated { name: String, element: usize, edge: usize },
}

/// A middle node in a message.
fn middle_name(middle: Option<usize>) -> String {
    middle.map_or("none".to_owned(), |node| format!("node {}", node + 1))
}
