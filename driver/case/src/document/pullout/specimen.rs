//! Meshes: specimens by their parameters, or a file.

use super::super::{Positive, Whole};
use crate::validation::NAME_PATTERN;
use fe_core::element::ElementKind;
use schemars::JsonSchema;
use serde::Deserialize;

/// Source of the mesh.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(untagged)]
pub enum MeshSource {
    /// A specimen by its parameters.
    Specimen(Box<SpecimenSource>),
    /// A Gmsh file.
    File(FileSource),
}

/// A specimen by its parameters.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct SpecimenSource {
    /// Type and parameters; lengths in mm.
    pub specimen: Specimen,
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
pub type Elements = Whole<1, 100_000>;

/// A specimen.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(tag = "type", rename_all = "snake_case")]
pub enum Specimen {
    /// A fibre perpendicular to the face that it is pulled out of: parts fibre and matrix.
    PerpendicularFibre(PerpendicularFibre),
    /// A fibre at an angle to the normal of the face that it is pulled out of: parts fibre and matrix.
    InclinedFibre(InclinedFibre),
    /// Fibres of any shape: parts fibre.NAME (in parts also fibre for all of them) and matrix.
    Fibres(Fibres),
    /// A quarter of a plate with a hole: part plate; sets symmetry_x, symmetry_y, right, top, hole.
    PlateWithHole(PlateWithHole),
    /// A thick cylinder: part cylinder; sets inner, outer and bottom, top or symmetry_x, symmetry_y.
    ThickCylinder(ThickCylinder),
    /// Cook's membrane: part membrane; sets left, right, bottom, top.
    CookMembrane(CookMembrane),
    /// A rectangle about y = 0: part beam; sets left, right, bottom, top.
    Beam(Beam),
    /// Two rectangles upon each other, contact at y = 0: parts lower and upper.
    TwoBlocks(TwoBlocks),
    /// Half of a cylinder that is pressed onto a plane: parts cylinder and base.
    Hertz(Hertz),
    /// A strip that is pulled out from under a block: parts strip and block.
    DragOutStrip(DragOutStrip),
    /// A fibre that lies on a curved channel: parts fibre and channel.
    CurvedChannel(CurvedChannel),
}

/// A fibre perpendicular to the face that it is pulled out of. The defaults are the specimen of chapters 6 and 7.
#[derive(Clone, Copy, Debug, Default, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct PerpendicularFibre {
    /// A body of revolution about the fibre instead of a plane slice (default false).
    pub axisymmetric: Option<bool>,
    /// Outer radius (default √(width · matrix_thickness/π)).
    pub outer_radius: Option<Positive>,
    /// Width of the block (default 25.4).
    pub width: Option<Positive>,
    /// Depth of the block along the fibre (default 12.7).
    pub depth: Option<Positive>,
    /// Thickness of the block (default 3.26).
    pub matrix_thickness: Option<Positive>,
    /// Matrix concrete on both faces of the fibre, out of plane. It joins both halves of the block: part cover (default
    /// false; plane only).
    pub cover: Option<bool>,
    /// Make the block as thick as the fibre at the exit face, and thicker with the depth below it: min(t, φ + 2 slope ·
    /// depth), as a cone around the fibre would be (default: the same thickness everywhere; plane only).
    pub graded_thickness: Option<GradedThickness>,
    /// Diameter of the fibre (default 0.406).
    pub fibre_diameter: Option<Positive>,
    /// Embedded length (default 12.2).
    pub embedded_length: Option<Positive>,
    /// Length outside the block, up to the grip (default 3).
    pub free_length: Option<Positive>,
    /// Length by which the hole exceeds the fibre (default 0).
    #[schemars(range(min = 0.0))]
    pub tail_gap: Option<f64>,
    /// Elements of the fibre (default Q8).
    pub fibre_element: Option<ElementKind>,
    /// Elements of the matrix (default Q8).
    pub matrix_element: Option<ElementKind>,
    /// Elements of the fibre along its embedded length (default 40).
    pub embedded_elements: Option<Elements>,
    /// Size at the exit face (default 0.15).
    pub exit_size: Option<Positive>,
    /// Make all elements along the fibre equally long instead (default false).
    pub equal_sizes: Option<bool>,
    /// Elements across the fibre, or across its radius in axial symmetry (default 2).
    pub elements_across: Option<Elements>,
    /// Edges of the hole on each edge of the fibre (default 1).
    pub slave_edges_per_master: Option<Elements>,
    /// Size across the matrix at the hole (default 0.1).
    pub interface_size: Option<Positive>,
    /// Ratio of each size to the one before it, away from the hole (default 1.3).
    pub growth: Option<Positive>,
    /// Largest size (default 2).
    pub largest_size: Option<Positive>,
}

/// A fibre at an angle to the normal of the face that it is pulled out of. The defaults are the specimen of chapter 7.
#[derive(Clone, Copy, Debug, Default, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct InclinedFibre {
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
    /// Width of the block (default 25.4).
    pub width: Option<Positive>,
    /// Depth of the block (default 12.7).
    pub depth: Option<Positive>,
    /// Thickness of the block (default 3.26).
    pub matrix_thickness: Option<Positive>,
    /// Matrix concrete on both faces of the fibre, out of plane. It joins both halves of the block: part cover (default
    /// true where the block is thicker than the fibre; false is the plane model of the thesis).
    pub cover: Option<bool>,
    /// Make the block as thick as the fibre at the exit face, and thicker with the depth below it: min(t, φ + 2 slope ·
    /// depth), as a cone around the fibre would be (default: the same thickness everywhere).
    pub graded_thickness: Option<GradedThickness>,
    /// Diameter of the fibre (default 0.406).
    pub fibre_diameter: Option<Positive>,
    /// Embedded length along the fibre (default 12.2).
    pub embedded_length: Option<Positive>,
    /// Radius of the hole's edges at the exit face (default a quarter of the diameter).
    pub exit_radius: Option<Positive>,
    /// Length over which fibre and matrix separate at the exit: mm, or "thesis" for φ (tan θ + 1/(2 tan θ)), 0 below 15°
    /// (6.27; default 0).
    pub separation_length: Option<SeparationLength>,
    /// Elements of the fibre (default Q8).
    pub fibre_element: Option<ElementKind>,
    /// Elements of the matrix, T6 or T3 (default T6).
    pub matrix_element: Option<ElementKind>,
    /// Factor on all sizes (default 1).
    pub mesh_size: Option<Positive>,
    /// Elements across the fibre (default 2).
    pub elements_across: Option<Elements>,
    /// Size along the fibre where it crosses the exit (default a quarter of the diameter).
    pub exit_size: Option<Positive>,
    /// Embedded length with elements of exit_size (default 5 diameters, or the length that the steps pull out if that
    /// is more).
    pub fine_length: Option<Positive>,
    /// Largest size along the fibre (default 0.5).
    pub largest_fibre_size: Option<Positive>,
    /// Growth of the elements' size per length (default 0.3).
    pub growth_rate: Option<Positive>,
    /// Largest size (default 2).
    pub largest_size: Option<Positive>,
}

/// Fibres in a block, pulled out of its upper face.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Fibres {
    /// The fibres, each with a name of its own.
    #[schemars(length(min = 1))]
    pub fibres: Vec<Fibre>,
    /// Pull all fibres together by the drive slip, or each by its own drive slip.NAME (default together). A step's slip
    /// applies to all fibres whose drives the step does not name.
    pub grips: Option<Grips>,
    /// Width of the block (default 25.4).
    pub width: Option<Positive>,
    /// Depth of the block (default 12.7).
    pub depth: Option<Positive>,
    /// Thickness of the block (default 3.26).
    pub matrix_thickness: Option<Positive>,
    /// Matrix concrete on both faces of the fibres, out of plane. It joins the pieces of the block: part cover (default
    /// true where the block is thicker than the fibres).
    pub cover: Option<bool>,
    /// Make the block as thick as the fibres at the exit face, and thicker with the depth below it: min(t, φ + 2 slope ·
    /// depth), as a cone around each fibre would be (default: the same thickness everywhere).
    pub graded_thickness: Option<GradedThickness>,
    /// Elements of the fibres (default Q8).
    pub fibre_element: Option<ElementKind>,
    /// Elements of the matrix, T6 or T3 (default T6).
    pub matrix_element: Option<ElementKind>,
    /// Factor on all sizes (default 1).
    pub mesh_size: Option<Positive>,
    /// Elements across each fibre (default 2).
    pub elements_across: Option<Elements>,
    /// Size along the fibres where they cross the exit (default a quarter of the diameter).
    pub exit_size: Option<Positive>,
    /// Largest size along the fibres (default 0.5).
    pub largest_fibre_size: Option<Positive>,
    /// Growth of the elements' size per length (default 0.3).
    pub growth_rate: Option<Positive>,
    /// Largest size (default 2).
    pub largest_size: Option<Positive>,
}

/// Drives by which several fibres are pulled.
#[derive(Clone, Copy, Debug, Deserialize, JsonSchema, PartialEq, Eq)]
#[serde(rename_all = "lowercase")]
pub enum Grips {
    /// All by the same displacement.
    Together,
    /// Each by a drive of its own.
    Each,
}

/// A fibre by the line of its axis, from its embedded end to the grip.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Fibre {
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
pub enum FibrePath {
    /// Pieces.
    Pieces(#[schemars(length(min = 1))] Vec<PathPiece>),
    /// A hooked end.
    Hooked(HookedPath),
}

/// The word "hooked".
#[derive(Clone, Copy, Debug, Deserialize, JsonSchema)]
#[serde(rename_all = "lowercase")]
pub enum HookedWord {
    /// A hooked end.
    Hooked,
}

/// A straight shaft with a hooked end. From shaft to tip, the axis bends by the angle, back, by the angle to the other
/// side, and back, one bend per piece. The length of the shaft follows from `embedded`, the length of the axis in the
/// block.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct HookedPath {
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
pub struct PathPiece {
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
pub struct ArcPiece {
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
pub struct WavePiece {
    /// Half of the height from trough to crest; negative: to the right.
    pub amplitude: f64,
    /// Length of a wave along the axis' direction.
    pub length: Positive,
    /// Number of waves: 0.5, 1, 1.5, ….
    pub n: Positive,
}

/// A thickness that grows with the depth below the exit face.
#[derive(Clone, Copy, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct GradedThickness {
    /// Spread of the cone to each side divided by its depth (default 1, which makes the fibre about as stiff in its
    /// block as in a 3-D one).
    #[schemars(range(min = 0.1))]
    pub slope: Option<f64>,
    /// Width of the graded zone on each side of the fibre's axis, along the face (default 2 φ + (t − φ)/2 · (1 + tan
    /// θ/slope)).
    pub extent: Option<Positive>,
}

/// Shape of an inclined fibre outside the block.
#[derive(Clone, Copy, Debug, Deserialize, JsonSchema, PartialEq, Eq)]
#[serde(rename_all = "lowercase")]
pub enum FibreShape {
    /// The fibre curves at the exit face to the face's normal (initially bent).
    Bent,
    /// The fibre goes on along its axis (initially straight).
    Straight,
}

/// Length of separation at the exit.
#[derive(Clone, Copy, Debug, Deserialize, JsonSchema)]
#[serde(untagged)]
pub enum SeparationLength {
    /// mm.
    Given(f64),
    /// A length that follows from the inclination.
    Rule(SeparationRule),
}

/// The word "thesis".
#[derive(Clone, Copy, Debug, Deserialize, JsonSchema)]
#[serde(rename_all = "lowercase")]
pub enum SeparationRule {
    /// φ (tan θ + 1/(2 tan θ)), 0 below 15° (6.27).
    Thesis,
}

/// A quarter of a plate with a hole.
#[derive(Clone, Copy, Debug, Default, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct PlateWithHole {
    /// Half of the width (default 10).
    pub width: Option<Positive>,
    /// Half of the height (default 10).
    pub height: Option<Positive>,
    /// Radius of the hole (default 1).
    pub radius: Option<Positive>,
    /// About how many elements (default 200).
    pub cells: Option<Elements>,
    /// Size at the outside over size at the hole (default 10).
    pub grading: Option<Positive>,
    /// Kind of elements (default Q8).
    pub element: Option<ElementKind>,
}

/// A thick cylinder.
#[derive(Clone, Copy, Debug, Default, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct ThickCylinder {
    /// A body of revolution instead of a quarter of the cross-section (default false).
    pub axisymmetric: Option<bool>,
    /// Inner radius (default 1).
    pub inner_radius: Option<Positive>,
    /// Outer radius (default 2).
    pub outer_radius: Option<Positive>,
    /// Elements from the inner to the outer radius (default 10).
    pub radial_cells: Option<Elements>,
    /// Elements around, or along the height (default 10).
    pub other_cells: Option<Elements>,
    /// Height of the body of revolution (default 1).
    pub height: Option<Positive>,
    /// Size at the outer radius over size at the inner one (default 2).
    pub grading: Option<Positive>,
    /// Kind of elements (default Q8).
    pub element: Option<ElementKind>,
}

/// Cook's membrane.
#[derive(Clone, Copy, Debug, Default, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct CookMembrane {
    /// Elements along each side (default 8).
    pub cells: Option<Elements>,
    /// Kind of elements (default Q8).
    pub element: Option<ElementKind>,
}

/// A rectangle about y = 0.
#[derive(Clone, Copy, Debug, Default, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Beam {
    /// Along x (default 10).
    pub length: Option<Positive>,
    /// Along y (default 1).
    pub height: Option<Positive>,
    /// Elements along x and y (default 20 and 2).
    pub cells: Option<[Elements; 2]>,
    /// Kind of elements (default Q8).
    pub element: Option<ElementKind>,
}

/// Two rectangles upon each other; values are of the lower and the upper one.
#[derive(Clone, Copy, Debug, Default, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct TwoBlocks {
    /// Width of both (default 1).
    pub width: Option<Positive>,
    /// Heights (default 1 and 1).
    pub heights: Option<[Positive; 2]>,
    /// Edges on the contact (default 4 and 3).
    pub edges: Option<[Elements; 2]>,
    /// Rows of elements (default 2 and 2).
    pub rows: Option<[Elements; 2]>,
    /// Kind of elements (default Q8).
    pub element: Option<ElementKind>,
}

/// Half of a cylinder that is pressed onto a plane.
#[derive(Clone, Copy, Debug, Default, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Hertz {
    /// Radius of the cylinder (default 10).
    pub radius: Option<Positive>,
    /// Extent of both bodies from the symmetry line (default 5).
    pub half_width: Option<Positive>,
    /// Height of the cylinder's flat top above the contact (default 5).
    pub height: Option<Positive>,
    /// Depth of the base (default 5).
    pub depth: Option<Positive>,
    /// Half width of the zone of small edges (default 0.5).
    pub contact_zone: Option<Positive>,
    /// Edges in this zone (default 20).
    pub contact_edges: Option<Elements>,
    /// Each size over the one before it (default 1.3).
    pub growth: Option<Positive>,
    /// Kind of elements (default Q8).
    pub element: Option<ElementKind>,
}

/// A strip that is pulled out from under a block.
#[derive(Clone, Copy, Debug, Default, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct DragOutStrip {
    /// Length of the strip (default 12).
    pub strip_length: Option<Positive>,
    /// Half of its thickness (default 0.25).
    pub strip_height: Option<Positive>,
    /// Position on the strip at which the block starts (default 2).
    pub block_start: Option<Positive>,
    /// Length of the block (default 10).
    pub block_length: Option<Positive>,
    /// Height of the block (default 5).
    pub block_height: Option<Positive>,
    /// Edges of the strip (default 96).
    pub strip_edges: Option<Elements>,
    /// Elements across the strip (default 2).
    pub strip_rows: Option<Elements>,
    /// Edges of the block on the strip (default 80).
    pub block_edges: Option<Elements>,
    /// Size of the block's elements at the strip (default 0.125).
    pub block_size: Option<Positive>,
    /// Each size over the one before it (default 1.2).
    pub growth: Option<Positive>,
    /// Kind of elements (default Q4).
    pub element: Option<ElementKind>,
}

/// A fibre on a curved channel, straight before and after it: a capstan.
#[derive(Clone, Copy, Debug, Default, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct CurvedChannel {
    /// Radius of the channel (default 10).
    pub radius: Option<Positive>,
    /// Angle of the arc, degrees (default 90).
    pub angle_deg: Option<Positive>,
    /// Height of the fibre (default 0.2).
    pub fibre_height: Option<Positive>,
    /// Length of the fibre before and after the arc (default 1).
    pub free_length: Option<Positive>,
    /// Depth of the channel's body (default 0.5).
    pub depth: Option<Positive>,
    /// Edges around the arc (default 40).
    pub edges: Option<Elements>,
    /// Edges along each free length (default 3).
    pub free_edges: Option<Elements>,
    /// Elements across the fibre (default 1).
    pub rows: Option<Elements>,
    /// Kind of elements (default Q8).
    pub element: Option<ElementKind>,
}
