//! Specimens by their parameters, and what each says where the case says nothing.

use super::boundary::BOTH;
use super::fibres;
use super::mesh::{DefaultPair, DefaultSupports, Defaults};
use crate::document::Positive;
use crate::document::pullout::{
    CurvedChannel, DragOutStrip, Elements, Hertz, Specimen, ThickCylinder, Thickness, TwoBlocks,
};
use fe_core::element::ElementKind;
use fe_core::mesh::MeshDefinition;
use fe_core::mesh::specimen::{self, CylinderSection, ParameterProblem, PulledFibre, SpecimenError, SurfaceRole};
use fe_core::model::Width;

pub(super) const X: &[[f64; 2]] = &[[1.0, 0.0]];
const Y: &[[f64; 2]] = &[[0.0, 1.0]];

/// Generated mesh with its default supports, pairs and notes.
pub struct Generated {
    pub name: &'static str,
    pub definition: MeshDefinition,
    pub defaults: Defaults,
    /// Fibres of the specimen.
    pub fibres: Vec<PulledFibre>,
    /// Notes on the model for the user.
    pub notes: Vec<String>,
    /// Names and values of what the case leaves to defaults.
    pub taken: Vec<String>,
}

/// Makes the mesh of a specimen. The thickness that the case gives the part `matrix` is that of a fibre's block; `slip`: how
/// far the grip goes, mm.
///
/// # Errors
/// Parameters that contradict each other or are out of range.
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
            element: kind(given.element),
        })
        .map(|definition| one_body("plate_with_hole", definition, &[("symmetry_x", X), ("symmetry_y", Y)])),
        Specimen::ThickCylinder(given) => thick_cylinder(given),
        Specimen::CookMembrane(given) => specimen::cook_membrane(number(given.cells, 8), kind(given.element))
            .map(|definition| one_body("cook_membrane", definition, &[("left", BOTH)])),
        Specimen::Beam(given) => {
            let cells = given.cells.map_or([20, 2], |cells| cells.map(|n| n.0 as usize));
            let (length, height) = (length(given.length, 10.0), length(given.height, 1.0));
            let element = kind(given.element);
            specimen::timoshenko_beam(&specimen::TimoshenkoBeam { length, height, cells, element })
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
    without_effect(&[("height", given.height.is_some() && !axisymmetric, "a quarter of the cross-section")])?;
    let section = if axisymmetric {
        CylinderSection::Axisymmetric { height: length(given.height, 1.0), cells }
    } else {
        CylinderSection::Quarter { cells }
    };
    let definition = specimen::thick_cylinder(&specimen::ThickCylinder {
        inner_radius: length(given.inner_radius, 1.0),
        outer_radius: length(given.outer_radius, 2.0),
        radial_cells: number(given.radial_cells, 10),
        grading: length(given.grading, 2.0),
        section,
        element: kind(given.element),
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
        elements: [kind(given.element); 2],
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
        element: kind(given.element),
    })?;
    let supports = [("bottom", Y), ("symmetry", X)];
    Ok(in_contact("hertz", definition, &supports, "base_contact", "cylinder_contact", None))
}

fn drag_out_strip(given: &DragOutStrip) -> Result<Generated, SpecimenError> {
    let default = specimen::DragOutStrip::default();
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
        element: given.element.unwrap_or(default.element),
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
        element: kind(given.element),
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
    Generated { name, definition, defaults, fibres: Vec::new(), notes: Vec::new(), taken: Vec::new() }
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

/// Refuses parameters without effect: of each the name, whether it is one, and what it must be left out of.
pub(super) fn without_effect(parameters: &[(&'static str, bool, &str)]) -> Result<(), SpecimenError> {
    let problem = |(name, _, of): &(&'static str, bool, &str)| {
        let requirement = format!("left out of {of}");
        ParameterProblem { fibre: None, name, value: "given".into(), requirement }
    };
    let problems: Vec<ParameterProblem> = parameters.iter().filter(|(_, is, _)| *is).map(problem).collect();
    if problems.is_empty() { Ok(()) } else { Err(SpecimenError::Parameters { problems }) }
}

pub(super) fn length(given: Option<Positive>, default: f64) -> f64 {
    given.map_or(default, |length| length.0)
}

pub(super) fn number(given: Option<Elements>, default: usize) -> usize {
    given.map_or(default, |n| n.0 as usize)
}

pub(super) fn kind(given: Option<ElementKind>) -> ElementKind {
    given.unwrap_or(ElementKind::Q8)
}
