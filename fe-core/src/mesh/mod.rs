//! A mesh: nodes, elements in parts, named sets of nodes and of element edges.
//!
//! A [`MeshDefinition`] is what somebody wrote; [`Mesh::new`] checks all of it and gives a [`Mesh`], on which nothing
//! can be out of range, inverted or wrongly connected. Checked are
//!
//! - positions: finite, and no node of an axisymmetric part left of the axis;
//! - elements: their number of nodes, nodes and part in range, no node twice, det J positive at the points of the
//!   part's rule and of the full rule, and large enough to trust ([`SMALLEST_RELATIVE_DETERMINANT`]), and not negative at
//!   the corners (quarter points around the tip of a crack make it 0 there);
//! - connections: an edge belongs to one element or to two that lie on either side of it and have the same middle node;
//! - parts: a name of their own, a positive thickness, an integration that their elements have;
//! - thicknesses of single elements: positive, of elements that exist;
//! - sets: not empty, in range, without repetition.
//!
//! Nodes that no element has are allowed (a grip can hang on one): [`Mesh::free_nodes`] lists them.
//!
//! Definitions come from [`gmsh`] files, from [`structured`] blocks and [`triangulation`]s or from the parameters of a [`specimen`];
//! [`preflight`] finds in a checked mesh what no single element shows, [`Mesh::overlap`] where deformed bodies lie in each other.
//!
//! # Example
//!
//! ```
//! use fe_core::element::ElementKind::T3;
//! use fe_core::kinematics::PlaneModel::PlaneStress;
//! use fe_core::mesh::{ElementDefinition, Mesh, MeshDefinition, Part};
//!
//! let clockwise = Mesh::new(MeshDefinition {
//!     nodes: vec![[0.0, 0.0], [1.0, 0.0], [0.0, 1.0]],
//!     parts: vec![Part::new("plate", PlaneStress, 1.0)],
//!     elements: vec![ElementDefinition { kind: T3, part: 0, nodes: vec![0, 2, 1] }],
//!     ..MeshDefinition::default()
//! });
//! assert!(clockwise.unwrap_err().to_string().starts_with("element 1 (T3): at integration point 1 the Jacobian"));
//! ```

mod error;
pub mod gmsh;
mod overlap;
pub mod preflight;
pub mod specimen;
pub mod structured;
mod topology;
pub mod triangulation;
mod validation;

pub use error::MeshError;
pub use overlap::Overlap;
pub use validation::SMALLEST_RELATIVE_DETERMINANT;

use std::collections::BTreeMap;

use crate::element::{EdgeKind, ElementKind, Integration, IntegrationPoint, MAX_NODES, characteristic_length};
use crate::kinematics::PlaneModel;
use topology::Neighbours;

#[cfg(test)]
mod test;

/// A body, or a piece of one, with assumptions of its own.
#[derive(Clone, Debug, PartialEq)]
pub struct Part {
    /// A name that no other part has.
    pub name: String,
    /// Assumption about the third direction.
    pub model: PlaneModel,
    /// Reference thickness of its elements without a thickness of their own, mm; unused in axial symmetry.
    pub thickness: f64,
    /// The integration of all its elements; `None`: each kind's default.
    pub integration: Option<Integration>,
}

impl Part {
    /// A part with the default integration of its elements.
    pub fn new(name: impl Into<String>, model: PlaneModel, thickness: f64) -> Self {
        Self { name: name.into(), model, thickness, integration: None }
    }
}

/// Unchecked element definition.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct ElementDefinition {
    /// Kind.
    pub kind: ElementKind,
    /// Index of its part.
    pub part: usize,
    /// Indices of its nodes, in the order of [`crate::element`].
    pub nodes: Vec<usize>,
}

impl ElementDefinition {
    /// The nodes of one of its edges: start, end and, on quadratic edges, the middle.
    pub(crate) fn edge_nodes(&self, edge: usize) -> Vec<usize> {
        let (local, count) = self.kind.edge_nodes(edge);
        local[..count].iter().map(|&node| self.nodes[node]).collect()
    }
}

/// One edge of one element.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord, serde::Serialize, serde::Deserialize)]
pub struct ElementEdge {
    /// Index of the element.
    pub element: usize,
    /// The edge's index in the element, in the order of [`crate::element`].
    pub edge: usize,
}

/// Unchecked mesh definition.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct MeshDefinition {
    /// Reference positions (x, y), mm.
    pub nodes: Vec<[f64; 2]>,
    /// Parts, to which elements refer.
    pub parts: Vec<Part>,
    /// Elements.
    pub elements: Vec<ElementDefinition>,
    /// Thicknesses of the elements that do not have their part's, mm.
    pub thicknesses: BTreeMap<usize, f64>,
    /// Named sets of nodes.
    pub node_sets: BTreeMap<String, Vec<usize>>,
    /// Named sets of element edges.
    pub edge_sets: BTreeMap<String, Vec<ElementEdge>>,
}

/// An element of a checked mesh.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Element {
    kind: ElementKind,
    part: usize,
    nodes: [usize; MAX_NODES],
    area: f64,
    thickness: f64,
}

impl Element {
    /// Returns the kind.
    pub fn kind(&self) -> ElementKind {
        self.kind
    }

    /// Index of its part.
    pub fn part(&self) -> usize {
        self.part
    }

    /// Indices of its nodes, in the order of [`crate::element`].
    pub fn nodes(&self) -> &[usize] {
        &self.nodes[..self.kind.node_count()]
    }

    /// Returns the reference thickness, mm: its own or its part's; unused in axial symmetry.
    pub fn thickness(&self) -> f64 {
        self.thickness
    }
}

/// The nodes of an element's edge, in its direction: the body lies on the left.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct EdgeNodes {
    kind: EdgeKind,
    nodes: [usize; 3],
}

impl EdgeNodes {
    /// Linear or quadratic.
    pub fn kind(&self) -> EdgeKind {
        self.kind
    }

    /// Indices: start, end and, on quadratic edges, the middle.
    pub fn nodes(&self) -> &[usize] {
        &self.nodes[..self.kind.node_count()]
    }
}

/// A checked mesh.
#[derive(Clone, Debug)]
pub struct Mesh {
    nodes: Vec<[f64; 2]>,
    parts: Vec<Part>,
    elements: Vec<Element>,
    node_sets: BTreeMap<String, Vec<usize>>,
    edge_sets: BTreeMap<String, Vec<ElementEdge>>,
    neighbours: Vec<Neighbours>,
}

/// Indices of elements, parts and nodes that a mesh did not give itself panic like those of a slice.
impl Mesh {
    /// Checks a definition.
    ///
    /// # Errors
    ///
    /// The first fault found, in the order of the list at the top of this page.
    pub fn new(definition: MeshDefinition) -> Result<Self, MeshError> {
        validation::check_nodes(&definition)?;
        validation::check_parts(&definition)?;
        let elements = validation::checked_elements(&definition)?;
        let neighbours = topology::neighbours(&elements)?;
        validation::check_sets(&definition)?;
        let MeshDefinition { nodes, parts, node_sets, edge_sets, .. } = definition;
        Ok(Self { nodes, parts, elements, node_sets, edge_sets, neighbours })
    }

    /// Reference positions (x, y), mm.
    pub fn nodes(&self) -> &[[f64; 2]] {
        &self.nodes
    }

    /// The parts.
    pub fn parts(&self) -> &[Part] {
        &self.parts
    }

    /// The elements.
    pub fn elements(&self) -> &[Element] {
        &self.elements
    }

    /// A named set of nodes.
    pub fn node_set(&self, name: &str) -> Option<&[usize]> {
        self.node_sets.get(name).map(Vec::as_slice)
    }

    /// A named set of element edges.
    pub fn edge_set(&self, name: &str) -> Option<&[ElementEdge]> {
        self.edge_sets.get(name).map(Vec::as_slice)
    }

    /// Names of the sets of nodes, sorted.
    pub fn node_set_names(&self) -> impl Iterator<Item = &str> {
        self.node_sets.keys().map(String::as_str)
    }

    /// Names of the sets of element edges, sorted.
    pub fn edge_set_names(&self) -> impl Iterator<Item = &str> {
        self.edge_sets.keys().map(String::as_str)
    }

    /// Reference positions of an element's nodes: the first `node_count` of the array.
    pub fn element_positions(&self, element: usize) -> ([[f64; 2]; MAX_NODES], usize) {
        let nodes = self.elements[element].nodes();
        let mut positions = [[0.0; 2]; MAX_NODES];
        for (position, &node) in positions.iter_mut().zip(nodes) {
            *position = self.nodes[node];
        }
        (positions, nodes.len())
    }

    /// The integration points of an element.
    pub fn integration_points(&self, element: usize) -> &'static [IntegrationPoint] {
        let Element { kind, part, .. } = self.elements[element];
        let integration = self.parts[part].integration.unwrap_or(kind.default_integration());
        kind.integration_points(integration).expect("checked: the part's integration is one of the element's")
    }

    /// The reference area of an element, mm².
    pub fn element_area(&self, element: usize) -> f64 {
        self.elements[element].area
    }

    /// The length that an element's UMAT receives as `CELENT`, mm: constant in time.
    pub fn characteristic_length(&self, element: usize) -> f64 {
        characteristic_length(self.elements[element].kind, self.elements[element].area)
    }

    /// Nodes that no element has, ascending.
    pub fn free_nodes(&self) -> Vec<usize> {
        let mut used = vec![false; self.nodes.len()];
        for &node in self.elements.iter().flat_map(Element::nodes) {
            used[node] = true;
        }
        (0..used.len()).filter(|&node| !used[node]).collect()
    }
}
