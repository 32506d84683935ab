//! Meshes: specimens by their parameters, or a file.

use super::super::{Positive, WithDefaults};
use crate::validation::NAME_PATTERN;
use fe_core::mesh::specimen::{
    self, Beam, CookMembrane, CurvedChannel, DragOutStrip, Hertz, PlateWithHole, ThickCylinder, TwoBlocks,
};
use schemars::JsonSchema;
use serde::Deserialize;

/// Source of the mesh.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(untagged)]
pub(crate) enum MeshSource {
    /// A specimen by its parameters.
    Specimen(Box<SpecimenSource>),
    /// A Gmsh file.
    File(FileSource),
}

/// A specimen by its parameters.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(crate) struct SpecimenSource {
    /// Type and parameters; lengths in mm.
    pub specimen: Specimen,
}

/// A Gmsh file.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(crate) struct FileSource {
    /// Gmsh file (.msh, format 4.1), relative to the case file: physical surfaces are parts, physical curves sets of
    /// nodes and edges, physical points sets of nodes.
    #[schemars(length(min = 1))]
    pub file: String,
}

/// A specimen.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(tag = "type", rename_all = "snake_case")]
pub(crate) enum Specimen {
    /// A fibre perpendicular to the face that it is pulled out of: parts fibre and matrix.
    PerpendicularFibre(PerpendicularFibre),
    /// A fibre at an angle to the normal of the face that it is pulled out of: parts fibre and matrix.
    InclinedFibre(InclinedFibre),
    /// Fibres of any shape: parts fibre.NAME (in parts also fibre for all of them) and matrix.
    Fibres(Fibres),
    /// A quarter of a plate with a hole: part plate; sets symmetry_x, symmetry_y, right, top, hole.
    PlateWithHole(WithDefaults<PlateWithHole>),
    /// A thick cylinder: part cylinder; sets inner, outer and bottom, top or symmetry_x, symmetry_y.
    ThickCylinder(WithDefaults<ThickCylinder>),
    /// Cook's membrane: part membrane; sets left, right, bottom, top.
    CookMembrane(WithDefaults<CookMembrane>),
    /// A rectangle about y = 0: part beam; sets left, right, bottom, top.
    Beam(WithDefaults<Beam>),
    /// Two rectangles upon each other, contact at y = 0: parts lower and upper.
    TwoBlocks(WithDefaults<TwoBlocks>),
    /// Half of a cylinder that is pressed onto a plane: parts cylinder and base.
    Hertz(WithDefaults<Hertz>),
    /// A strip that is pulled out from under a block: parts strip and block.
    DragOutStrip(WithDefaults<DragOutStrip>),
    /// A fibre that lies on a curved channel: parts fibre and channel.
    CurvedChannel(WithDefaults<CurvedChannel>),
}

/// A fibre perpendicular to the face that it is pulled out of. The defaults are the specimen of chapters 6 and 7.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[schemars(deny_unknown_fields)]
pub(crate) struct PerpendicularFibre {
    /// A body of revolution about the fibre instead of a plane slice (default false).
    pub axisymmetric: Option<bool>,
    /// Outer radius (default √(width · matrix_thickness/π)).
    pub outer_radius: Option<Positive>,
    /// Make all elements along the fibre equally long instead (default false).
    pub equal_sizes: Option<bool>,
    /// Block, fibre and sizes.
    #[serde(flatten)]
    pub fibre: WithDefaults<specimen::PerpendicularFibre>,
}

/// A fibre at an angle to the normal of the face that it is pulled out of. The defaults are the specimen of chapter 7.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[schemars(deny_unknown_fields)]
pub(crate) struct InclinedFibre {
    /// Inclination: the embedded fibre's angle from the outward normal of the exit face, degrees (default 45).
    #[schemars(range(min = 0.0, max = 80.0))]
    pub angle_deg: Option<f64>,
    /// Shape of the fibre outside the block (default bent).
    pub shape: Option<FibreShape>,
    /// Length outside the block, up to the grip (default 3 after the bend; 0 if straight: loading at the exit).
    #[schemars(range(min = 0.0))]
    pub free_length: Option<f64>,
    /// Radius of the bend of the fibre's axis (default 1.5 diameters).
    pub bend_radius: Option<Positive>,
    /// Matrix concrete on both faces of the fibre, out of plane. It joins both halves of the block: part cover (default
    /// true where the block is thicker than the fibre; false is the plane model of the thesis).
    pub cover: Option<bool>,
    /// Diameter of the fibre (default 0.406).
    pub fibre_diameter: Option<Positive>,
    /// Embedded length along the fibre (default 12.2).
    pub embedded_length: Option<Positive>,
    /// Radius of the hole's edges at the exit face (default a quarter of the diameter).
    pub exit_radius: Option<Positive>,
    /// Length over which fibre and matrix separate at the exit: mm, or "thesis" for φ (tan θ + 1/(2 tan θ)), 0 below 15°
    /// (6.27; default 0).
    pub separation_length: Option<SeparationLength>,
    /// Embedded length with elements of exit_size (default 5 diameters, or the length that the steps pull out if that
    /// is more).
    pub fine_length: Option<Positive>,
    /// The block, and the sizes of the mesh.
    #[serde(flatten)]
    pub block: WithDefaults<specimen::Fibres>,
}

/// Fibres in a block, pulled out of its upper face.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[schemars(deny_unknown_fields)]
pub(crate) struct Fibres {
    /// The fibres, each with a name of its own.
    #[schemars(length(min = 1))]
    pub fibres: Vec<Fibre>,
    /// Pull all fibres together by the drive slip, or each by its own drive slip.NAME (default together). A step's slip
    /// applies to all fibres whose drives the step does not name.
    pub grips: Option<Grips>,
    /// Matrix concrete on both faces of the fibres, out of plane. It joins the pieces of the block: part cover (default
    /// true where the block is thicker than the fibres).
    pub cover: Option<bool>,
    /// The block, and the sizes of the mesh.
    #[serde(flatten)]
    pub block: WithDefaults<specimen::Fibres>,
}

/// Drives by which several fibres are pulled.
#[derive(Clone, Copy, Debug, Deserialize, JsonSchema, PartialEq, Eq)]
#[serde(rename_all = "lowercase")]
pub(crate) enum Grips {
    /// All by the same displacement.
    Together,
    /// Each by a drive of its own.
    Each,
}

/// A fibre by the line of its axis, from its embedded end to the grip.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(crate) struct Fibre {
    /// Unique name: letters, digits, - and _.
    #[schemars(regex(pattern = NAME_PATTERN))]
    pub name: String,
    /// Diameter (default 0.406).
    pub diameter: Option<Positive>,
    /// Position on the exit face at which the fibre's axis crosses it, from the middle of the block (default 0).
    pub exit: Option<f64>,
    /// Axis from the embedded end to the grip: pieces, each continuing in the direction in which the one before it
    /// ends; or a hooked end with the dimensions of a data sheet.
    pub path: FibrePath,
    /// Rotation of the axis inside the block to the right, degrees (default 0). It is added to the tilt of the first
    /// piece and to all to_deg there. The axis outside the block does not rotate: a hooked fibre follows the normal of
    /// the face there.
    pub rotate_deg: Option<f64>,
    /// Length of the axis from the embedded end to the exit face (default 12.2).
    pub embedded: Option<Positive>,
    /// Variable diameter, for example of an enlarged end: straight lines through points [distance from the embedded
    /// end, diameter] (default none).
    pub width_profile: Option<Vec<[f64; 2]>>,
    /// Length by which the hole exceeds the fibre (default 0).
    #[schemars(range(min = 0.0))]
    pub tail_gap: Option<f64>,
    /// Radius of the hole's edges at the exit face (default a quarter of the diameter).
    pub exit_radius: Option<Positive>,
    /// Length over which fibre and matrix separate at the exit (default 0).
    #[schemars(range(min = 0.0))]
    pub separation_length: Option<f64>,
    /// Embedded length with elements of exit_size (default 5 diameters, or the length that the steps pull out if that
    /// is more; by default the hook of a hooked path is not refined, however far it is pulled).
    pub fine_length: Option<Positive>,
}

/// The axis of a fibre.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(untagged)]
pub(crate) enum FibrePath {
    /// Pieces.
    Pieces(#[schemars(length(min = 1))] Vec<PathPiece>),
    /// A hooked end.
    Hooked(HookedPath),
}

/// The word "hooked".
#[derive(Clone, Copy, Debug, Deserialize, JsonSchema)]
#[serde(rename_all = "lowercase")]
pub(crate) enum HookedWord {
    /// A hooked end.
    Hooked,
}

/// A straight shaft with a hooked end. From shaft to tip, the axis bends by the angle, back, by the angle to the other
/// side, and back, one bend per piece. The length of the shaft follows from `embedded`, the length of the axis in the
/// block.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(crate) struct HookedPath {
    /// The word "hooked".
    #[serde(rename = "type")]
    #[expect(dead_code, reason = "it distinguishes this path from pieces")]
    pub kind: HookedWord,
    /// Lengths of the hook's pieces from the tip to the shaft, mm, measured between the corners where their lines meet:
    /// two for a 3D end, three for 4D, four for 5D.
    #[schemars(length(min = 1))]
    pub hook: Vec<Positive>,
    /// Angle of each bend, degrees (default 45).
    #[schemars(range(min = 5.0, max = 90.0))]
    pub angle_deg: Option<f64>,
    /// Number of bends. If it is given, it must equal the number of pieces.
    pub bends: Option<usize>,
    /// Radius of the axis in the bends (default 2 diameters; data sheets do not give it).
    pub radius: Option<Positive>,
    /// Length outside the block, up to the grip (default 3, after the bend of an inclined fibre).
    pub free_length: Option<Positive>,
    /// Radius of the bend of an inclined fibre outside the block (default 1.5 diameters).
    pub bend_radius: Option<Positive>,
}

/// A piece of the axis of a fibre: one of straight, arc and wave.
#[derive(Clone, Copy, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(crate) struct PathPiece {
    /// A line of this length.
    pub straight: Option<Positive>,
    /// An arc.
    pub arc: Option<ArcPiece>,
    /// Waves.
    pub wave: Option<WavePiece>,
    /// Direction in which the piece begins, as an angle from the outward normal of the exit face, degrees, positive to
    /// the right. First piece only (default 0).
    pub tilt_deg: Option<f64>,
}

/// An arc that turns the axis.
#[derive(Clone, Copy, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(crate) struct ArcPiece {
    /// Radius of the axis.
    pub radius: Positive,
    /// Direction in which the arc ends, as an angle from the outward normal of the exit face, degrees.
    pub to_deg: Option<f64>,
    /// Change of direction, degrees, positive to the right; an alternative to to_deg.
    pub by_deg: Option<f64>,
}

/// Waves amplitude · (1 − cos(2π u/length)) to the left of the axis' direction.
#[derive(Clone, Copy, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(crate) struct WavePiece {
    /// Half of the height from trough to crest; negative: to the right.
    pub amplitude: f64,
    /// Length of a wave along the axis' direction.
    pub length: Positive,
    /// Number of waves: 0.5, 1, 1.5, ….
    pub n: Positive,
}

/// Shape of an inclined fibre outside the block.
#[derive(Clone, Copy, Debug, Deserialize, JsonSchema, PartialEq, Eq)]
#[serde(rename_all = "lowercase")]
pub(crate) enum FibreShape {
    /// The fibre curves at the exit face to the face's normal (initially bent).
    Bent,
    /// The fibre goes on along its axis (initially straight).
    Straight,
}

/// Length of separation at the exit.
#[derive(Clone, Copy, Debug, Deserialize, JsonSchema)]
#[serde(untagged)]
pub(crate) enum SeparationLength {
    /// mm.
    Given(f64),
    /// A length that follows from the inclination.
    Rule(SeparationRule),
}

/// The word "thesis".
#[derive(Clone, Copy, Debug, Deserialize, JsonSchema)]
#[serde(rename_all = "lowercase")]
pub(crate) enum SeparationRule {
    /// φ (tan θ + 1/(2 tan θ)), 0 below 15° (6.27).
    Thesis,
}
