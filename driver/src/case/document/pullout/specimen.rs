//! Meshes: specimens by their parameters, or a file.

use super::super::{Piece, Positive, Whole};
use schemars::JsonSchema;
use serde::Deserialize;

/// Where the mesh comes from.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(untagged)]
pub enum MeshSource {
    /// A specimen by its parameters.
    Specimen(SpecimenSource),
    /// A Gmsh file.
    File(FileSource),
}

/// A specimen by its parameters.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct SpecimenSource {
    /// Its type and parameters; lengths in mm.
    pub specimen: Piece<Specimen>,
}

/// A Gmsh file.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct FileSource {
    /// Gmsh file (.msh, format 4.1), relative to the case file: physical surfaces are parts, physical curves sets of
    /// nodes and edges, physical points sets of nodes.
    #[schemars(length(min = 1))]
    pub file: String,
}

/// Number of elements along something.
pub type Elements = Whole<1, 10_000>;

/// A specimen.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(tag = "type", rename_all = "snake_case")]
pub enum Specimen {
    /// A block: one part "block".
    Block(BlockSpecimen),
}

/// A rectangular block.
#[derive(Clone, Copy, Debug, Default, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct BlockSpecimen {
    /// Along x (default 1).
    pub width: Option<Positive>,
    /// Number of elements along x (default 1).
    pub elements_x: Option<Elements>,
}
