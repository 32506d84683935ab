//! Specimens by their parameters, and what each says where the case says nothing.

use super::boundary::BOTH;
use super::fibres;
use super::mesh::{DefaultPair, DefaultSupports, Defaults};
use crate::document::Positive;
use crate::document::pullout::{ElementName, Elements, Fibres, InclinedFibre, PerpendicularFibre, Thickness};
use fe_core::element::ElementKind;
use fe_core::kinematics::PlaneModel;
use fe_core::mesh::MeshDefinition;
use fe_core::mesh::specimen::{self, BodyChoice, CylinderSection, SpecimenError, SurfaceRole};
use fe_core::model::Width;
use schemars::JsonSchema;
use serde::Deserialize;

pub(super) const X: &[[f64; 2]] = &[[1.0, 0.0]];
const Y: &[[f64; 2]] = &[[0.0, 1.0]];

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

/// A mesh, and what the specimen says of it.
pub struct Generated {
    pub name: &'static str,
    pub definition: MeshDefinition,
    pub defaults: Defaults,
    /// Diameter of the round fibre, mm.
    pub diameter: Option<f64>,
    /// Notes on the model for the user.
    pub notes: Vec<String>,
    /// Names and values of what the case leaves to defaults.
    pub taken: Vec<String>,
}

/// Makes the mesh of a specimen. The thickness that the case gives the part `matrix` is that of a fibre's block; `slip`: how
/// far the grip goes, mm.
///
/// # Errors
/// Parameters that cannot be.
pub fn generate(given: &Specimen, matrix: Option<Thickness>, slip: f64) -> Result<Generated, SpecimenError> {
    match given {
        Specimen::PerpendicularFibre(given) => fibres::perpendicular_fibre(given, matrix),
        Specimen::InclinedFibre(given) => fibres::inclined_fibre(given, matrix, slip),
        Specimen::Fibres(given) => fibres::fibres(given, matrix, slip),
        Specimen::PlateWithHole(given) => specimen::plate_with_hole(&specimen::PlateWithHole {
            width: length(given.width, 10.0),
            height: length(given.height, 10.0),
            radius: length(given.radius, 1.0),
            cells: number(given.cells, 200),
            grading: length(given.grading, 10.0),
            body: body(given.element, ElementName::Q8),
        })
        .map(|definition| one_body("plate_with_hole", definition, &[("symmetry_x", X), ("symmetry_y", Y)])),
        Specimen::ThickCylinder(given) => thick_cylinder(given),
        Specimen::CookMembrane(given) => {
            specimen::cook_membrane(number(given.cells, 8), body(given.element, ElementName::Q8))
                .map(|definition| one_body("cook_membrane", definition, &[("left", BOTH)]))
        }
        Specimen::Beam(given) => {
            let cells = given.cells.map_or([20, 2], |cells| cells.map(|n| n.0 as usize));
            let (length, height) = (length(given.length, 10.0), length(given.height, 1.0));
            let body = body(given.element, ElementName::Q8);
            specimen::timoshenko_beam(&specimen::TimoshenkoBeam { length, height, cells, body })
                .map(|definition| one_body("beam", definition, &[("left", BOTH)]))
        }
        Specimen::TwoBlocks(given) => two_blocks(given),
        Specimen::Hertz(given) => hertz(given),
        Specimen::DragOutStrip(given) => drag_out_strip(given),
        Specimen::CurvedChannel(given) => curved_channel(given),
    }
}

fn thick_cylinder(given: &ThickCylinder) -> Result<Generated, SpecimenError> {
    let cells = number(given.other_cells, 10);
    let axisymmetric = given.axisymmetric.unwrap_or(false);
    let section = if axisymmetric {
        CylinderSection::Axisymmetric { height: length(given.height, 1.0), cells }
    } else {
        CylinderSection::Quarter { model: PlaneModel::PlaneStrain, thickness: 1.0, cells }
    };
    let definition = specimen::thick_cylinder(&specimen::ThickCylinder {
        inner_radius: length(given.inner_radius, 1.0),
        outer_radius: length(given.outer_radius, 2.0),
        radial_cells: number(given.radial_cells, 10),
        grading: length(given.grading, 2.0),
        section,
        kind: kind(given.element, ElementName::Q8),
    })?;
    let supports: &[(&'static str, &'static [[f64; 2]])] =
        if axisymmetric { &[("bottom", Y), ("top", Y)] } else { &[("symmetry_x", X), ("symmetry_y", Y)] };
    Ok(one_body("thick_cylinder", definition, supports))
}

fn two_blocks(given: &TwoBlocks) -> Result<Generated, SpecimenError> {
    let numbers =
        |given: Option<[Elements; 2]>, default: [usize; 2]| given.map_or(default, |n| n.map(|n| n.0 as usize));
    let definition = specimen::two_blocks(&specimen::TwoBlocks {
        width: length(given.width, 1.0),
        heights: given.heights.map_or([1.0; 2], |heights| heights.map(|height| height.0)),
        edges: numbers(given.edges, [4, 3]),
        rows: numbers(given.rows, [2, 2]),
        bodies: [body(given.element, ElementName::Q8); 2],
    })?;
    let supports = [("bottom", Y), ("lower_left", X), ("upper_left", X)];
    Ok(in_contact("two_blocks", definition, &supports, "lower_contact", "upper_contact", None))
}

fn hertz(given: &Hertz) -> Result<Generated, SpecimenError> {
    let definition = specimen::cylinder_on_plane(&specimen::CylinderOnPlane {
        radius: length(given.radius, 10.0),
        half_width: length(given.half_width, 5.0),
        height: length(given.height, 5.0),
        depth: length(given.depth, 5.0),
        contact_zone: length(given.contact_zone, 0.5),
        contact_edges: number(given.contact_edges, 20),
        growth: length(given.growth, 1.3),
        bodies: [body(given.element, ElementName::Q8); 2],
    })?;
    let supports = [("bottom", Y), ("symmetry", X)];
    Ok(in_contact("hertz", definition, &supports, "base_contact", "cylinder_contact", None))
}

fn drag_out_strip(given: &DragOutStrip) -> Result<Generated, SpecimenError> {
    let default = specimen::DragOutStrip::new([body(given.element, ElementName::Q4); 2]);
    let definition = specimen::drag_out_strip(&specimen::DragOutStrip {
        strip_length: length(given.strip_length, default.strip_length),
        strip_height: length(given.strip_height, default.strip_height),
        block_start: length(given.block_start, default.block_start),
        block_length: length(given.block_length, default.block_length),
        block_height: length(given.block_height, default.block_height),
        strip_edges: number(given.strip_edges, default.strip_edges),
        strip_rows: number(given.strip_rows, default.strip_rows),
        block_edges: number(given.block_edges, default.block_edges),
        block_size: length(given.block_size, default.block_size),
        growth: length(given.growth, default.growth),
        bodies: default.bodies,
    })?;
    let supports = [("symmetry", Y), ("block_left", X)];
    let grip = Some(("sliding_end", [1.0, 0.0]));
    Ok(in_contact("drag_out_strip", definition, &supports, "block_contact", "strip_contact", grip))
}

fn curved_channel(given: &CurvedChannel) -> Result<Generated, SpecimenError> {
    let definition = specimen::curved_channel(&specimen::CurvedChannel {
        radius: length(given.radius, 10.0),
        angle: length(given.angle_deg, 90.0).to_radians(),
        fibre_height: length(given.fibre_height, 0.2),
        free_length: length(given.free_length, 1.0),
        depth: length(given.depth, 0.5),
        edges: number(given.edges, 40),
        free_edges: number(given.free_edges, 3),
        rows: number(given.rows, 1),
        bodies: [body(given.element, ElementName::Q8); 2],
    })?;
    let grip = Some(("grip", [0.0, -1.0]));
    Ok(in_contact("curved_channel", definition, &[("channel", BOTH)], "channel_contact", "fibre_contact", grip))
}

fn one_body(
    name: &'static str,
    definition: MeshDefinition,
    supports: &[(&'static str, &'static [[f64; 2]])],
) -> Generated {
    let supports = vec![DefaultSupports { name: "standard", supports: supports.to_vec() }];
    let defaults = Defaults { supports, ..Defaults::default() };
    Generated { name, definition, defaults, diameter: None, notes: Vec::new(), taken: Vec::new() }
}

fn in_contact(
    name: &'static str,
    definition: MeshDefinition,
    supports: &[(&'static str, &'static [[f64; 2]])],
    slave: &str,
    master: &str,
    grip: Option<(&'static str, [f64; 2])>,
) -> Generated {
    let mut made = one_body(name, definition, supports);
    let (slave, master) = (slave.to_owned(), master.to_owned());
    made.defaults.pairs = vec![DefaultPair {
        name: "contact".to_owned(),
        slave,
        master,
        width: Width::OfPart,
        role: SurfaceRole::Bonded,
    }];
    made.defaults.grip = grip;
    made
}

pub(super) fn length(given: Option<Positive>, default: f64) -> f64 {
    given.map_or(default, |length| length.0)
}

pub(super) fn number(given: Option<Elements>, default: usize) -> usize {
    given.map_or(default, |n| n.0 as usize)
}

pub(super) fn kind(given: Option<ElementName>, default: ElementName) -> ElementKind {
    match given.unwrap_or(default) {
        ElementName::T3 => ElementKind::T3,
        ElementName::T6 => ElementKind::T6,
        ElementName::Q4 => ElementKind::Q4,
        ElementName::Q8 => ElementKind::Q8,
    }
}

/// Plane strain of thickness 1; the case's parts say otherwise.
fn body(given: Option<ElementName>, default: ElementName) -> BodyChoice {
    BodyChoice::new(kind(given, default), PlaneModel::PlaneStrain, 1.0)
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
    pub element: Option<ElementName>,
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
    pub element: Option<ElementName>,
}

/// Cook's membrane.
#[derive(Clone, Copy, Debug, Default, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct CookMembrane {
    /// Elements along each side (default 8).
    pub cells: Option<Elements>,
    /// Kind of elements (default Q8).
    pub element: Option<ElementName>,
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
    pub element: Option<ElementName>,
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
    pub element: Option<ElementName>,
}

/// Half of a cylinder that is pressed onto a plane.
#[derive(Clone, Copy, Debug, Default, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Hertz {
    /// Radius of the cylinder (default 10).
    pub radius: Option<Positive>,
    /// How far both bodies reach beside the symmetry line (default 5).
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
    pub element: Option<ElementName>,
}

/// A strip that is pulled out from under a block.
#[derive(Clone, Copy, Debug, Default, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct DragOutStrip {
    /// Length of the strip (default 12).
    pub strip_length: Option<Positive>,
    /// Half of its thickness (default 0.25).
    pub strip_height: Option<Positive>,
    /// Where the block starts on the strip (default 2).
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
    pub element: Option<ElementName>,
}

/// A fibre that lies on a curved channel, straight before and after it: a capstan.
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
    pub element: Option<ElementName>,
}
