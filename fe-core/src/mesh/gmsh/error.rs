//! Faults of a Gmsh file, their places, and remedies.

use std::path::PathBuf;

use crate::element::MappingError;

/// A fault of a Gmsh file. Tags of nodes and elements in the message are those of Gmsh.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[error("{}{place}: {fault}", path.display())]
pub struct GmshError {
    /// The file.
    pub path: PathBuf,
    /// The place in the file.
    pub place: Place,
    /// The fault.
    pub fault: GmshFault,
}

/// A place in a file.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Place {
    /// The file as a whole.
    File,
    /// A line of a text file, from 1.
    Line(usize),
    /// A byte of a binary file, from 0.
    Byte(usize),
}

impl std::fmt::Display for Place {
    fn fmt(&self, formatter: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::File => Ok(()),
            Self::Line(line) => write!(formatter, ":{line}"),
            Self::Byte(byte) => write!(formatter, ", byte {byte}"),
        }
    }
}

/// Kinds of faults of a Gmsh file.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[allow(missing_docs, reason = "the message of each variant says what its fields are")]
pub enum GmshFault {
    /// A file that is not a mesh file.
    #[error("this is no Gmsh mesh: it must start with $MeshFormat, found '{found}'")]
    NotGmsh { found: String },
    /// Another version.
    #[error("format version {version} is not read; save with Mesh.MshFileVersion = 4.1 (or 2.2)")]
    Version { version: String },
    /// Binary in a form that this reader does not have.
    #[error("binary data with {what} is not read; save as text with Mesh.Binary = 0")]
    Binary { what: String },
    /// Other text than the format requires here.
    #[error("expected {expected}, found '{found}'; is a count of this section wrong, or the file edited?")]
    Expected { expected: String, found: String },
    /// Too early an end.
    #[error("the file ends where {expected} should be; it is truncated, save it again")]
    Truncated { expected: String },
    /// Nodes or Elements are not there.
    #[error("there is no section ${section}; mesh the model (Mesh > 2D) before saving it")]
    MissingSection { section: &'static str },
    /// A section twice.
    #[error("section ${section} comes a second time; a file holds one mesh")]
    RepeatedSection { section: String },
    /// Partitioned for another solver.
    #[error("the mesh is partitioned; save it with Mesh.PartitionSplitMeshFiles = 0 and without partitions")]
    Partitioned,
    /// Node tag used before.
    #[error("node {node} is defined twice")]
    RepeatedNode { node: u64 },
    /// NaN or infinite.
    #[error("node {node}: its position is not finite")]
    Position { node: u64 },
    /// Out of the plane.
    #[error("node {node} lies at z = {z}, others at {other}; a plane mesh has one z")]
    OutOfPlane { node: u64, z: f64, other: f64 },
    /// A node that was not defined.
    #[error("element {element} has node {node}, which is not in $Nodes")]
    UnknownNode { element: u64, node: u64 },
    /// An entity that was not defined (4.1).
    #[error(
        "elements of the entity of dimension {dimension} and tag {tag}, which is not in $Entities; save the mesh from Gmsh again"
    )]
    UnknownEntity { dimension: usize, tag: i64 },
    /// A type of element that is not computed.
    #[error("element type {number} ({name}) is not computed; {remedy}")]
    ElementType { number: i64, name: &'static str, remedy: &'static str },
    /// Nothing to compute.
    #[error(
        "there are no triangles or quadrilaterals; mesh the surfaces (Mesh > 2D) and put them into physical groups"
    )]
    NoSurface,
    /// Surface elements outside all groups.
    #[error(
        "element {element}{} is in no physical surface; add Physical Surface(\"name\") = {{...}} over all surfaces",
        one_of(*count)
    )]
    NoGroup { element: u64, count: usize },
    /// A surface in two groups.
    #[error(
        "element {element} is in the physical surfaces '{first}' and '{second}'; every surface belongs to one part"
    )]
    TwoGroups { element: u64, first: String, second: String },
    /// The same nodes in two elements.
    #[error(
        "elements {first} (physical surface '{first_group}') and {second} ('{second_group}') have the same nodes; every surface belongs to one part, once"
    )]
    SameNodes { first: u64, second: u64, first_group: String, second_group: String },
    /// Parts here and parts there.
    #[error("{}", part_names(without_properties, without_elements, available))]
    PartNames {
        /// Physical surfaces to which the caller gave no properties.
        without_properties: Vec<String>,
        /// Names of the caller that are no physical surface.
        without_elements: Vec<String>,
        /// All physical surfaces with elements.
        available: Vec<String>,
    },
    /// One name, two sets.
    #[error("'{name}' names a physical point and a physical curve; both would become the node set of this name")]
    SetName { name: String },
    /// A curve apart from the surfaces.
    #[error(
        "line element {element} of the physical curve '{group}' is no edge of a surface element of its order; the curve must bound a meshed surface"
    )]
    NoEdge { element: u64, group: String },
    /// Inverted or collapsed.
    #[error("element {element}: {source}; it is folded or collapsed, repair the mesh (Mesh > Inspect shows it)")]
    Shape { element: u64, source: MappingError },
}

/// Returns how many there are, if more than one.
fn one_of(count: usize) -> String {
    if count > 1 { format!(" (the first of {count})") } else { String::new() }
}

/// Both kinds of mismatch, and what there is.
fn part_names(without_properties: &[String], without_elements: &[String], available: &[String]) -> String {
    let quoted = |names: &[String]| names.iter().map(|name| format!("'{name}'")).collect::<Vec<_>>().join(", ");
    let mut message = String::new();
    if !without_elements.is_empty() {
        message += &format!("no physical surface with elements is called {}; ", quoted(without_elements));
    }
    if !without_properties.is_empty() {
        message += &format!("no properties are given for the physical surface {}; ", quoted(without_properties));
    }
    message + "the file's physical surfaces are " + &quoted(available)
}
