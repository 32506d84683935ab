//! Specimens by their parameters, and what each says where the case says nothing.

use super::boundary::BOTH;
use super::fibres;
use super::mesh::{DefaultSupports, Held, MeshAndSets};
use crate::document::pullout::{CurvedChannel, DragOutStrip, Hertz, Specimen, ThickCylinder, Thickness, TwoBlocks};
use crate::reader::UsedDefaults;
use fe_core::element::ElementKind;
use fe_core::mesh::MeshDefinition;
use fe_core::mesh::specimen::{self, ContactSurfaces, CylinderSection, ParameterProblem, SpecimenError, SurfaceRole};

pub(super) const X: &[[f64; 2]] = &[[1.0, 0.0]];
const Y: &[[f64; 2]] = &[[0.0, 1.0]];

/// Makes the mesh of a specimen. The thickness that the case gives the part `matrix` is that of a fibre's block; `slip`: how
/// far the grip goes, mm; `taken`: notes what is left to defaults.
///
/// # Errors
/// Parameters that contradict each other or are out of range.
pub fn generate(
    given: &Specimen,
    matrix: Option<Thickness>,
    slip: f64,
    taken: &mut UsedDefaults,
) -> Result<MeshAndSets, SpecimenError> {
    match given {
        Specimen::PerpendicularFibre(given) => fibres::perpendicular_fibre(given, matrix, taken),
        Specimen::InclinedFibre(given) => fibres::inclined_fibre(given, matrix, slip, taken),
        Specimen::Fibres(given) => fibres::fibres(given, matrix, slip, taken),
        Specimen::PlateWithHole(given) => specimen::plate_with_hole(&specimen::PlateWithHole {
            width: taken.real("width", given.width, 10.0),
            height: taken.real("height", given.height, 10.0),
            radius: taken.real("radius", given.radius, 1.0),
            cells: taken.or("cells", given.cells, 200),
            grading: taken.real("grading", given.grading, 10.0),
            element: taken.or("element", given.element, ElementKind::Q8),
        })
        .map(|definition| one_body("plate_with_hole", definition, &[("symmetry_x", X), ("symmetry_y", Y)])),
        Specimen::ThickCylinder(given) => thick_cylinder(given, taken),
        Specimen::CookMembrane(given) => {
            let cells = taken.or("cells", given.cells, 8);
            specimen::cook_membrane(cells, taken.or("element", given.element, ElementKind::Q8))
                .map(|definition| one_body("cook_membrane", definition, &[("left", BOTH)]))
        }
        Specimen::Beam(given) => {
            let length = taken.real("length", given.length, 10.0);
            let height = taken.real("height", given.height, 1.0);
            let cells = taken.two("cells", given.cells, [20, 2]);
            let element = taken.or("element", given.element, ElementKind::Q8);
            specimen::timoshenko_beam(&specimen::TimoshenkoBeam { length, height, cells, element })
                .map(|definition| one_body("beam", definition, &[("left", BOTH)]))
        }
        Specimen::TwoBlocks(given) => two_blocks(given, taken),
        Specimen::Hertz(given) => hertz(given, taken),
        Specimen::DragOutStrip(given) => drag_out_strip(given, taken),
        Specimen::CurvedChannel(given) => curved_channel(given, taken),
    }
}

fn thick_cylinder(given: &ThickCylinder, taken: &mut UsedDefaults) -> Result<MeshAndSets, SpecimenError> {
    let axisymmetric = taken.or("axisymmetric", given.axisymmetric, false);
    let cells = taken.or("other_cells", given.other_cells, 10);
    without_effect(&[("height", given.height.is_some() && !axisymmetric, "a quarter of the cross-section")])?;
    let section = if axisymmetric {
        CylinderSection::Axisymmetric { height: taken.real("height", given.height, 1.0), cells }
    } else {
        CylinderSection::Quarter { cells }
    };
    let definition = specimen::thick_cylinder(&specimen::ThickCylinder {
        inner_radius: taken.real("inner_radius", given.inner_radius, 1.0),
        outer_radius: taken.real("outer_radius", given.outer_radius, 2.0),
        radial_cells: taken.or("radial_cells", given.radial_cells, 10),
        grading: taken.real("grading", given.grading, 2.0),
        section,
        element: taken.or("element", given.element, ElementKind::Q8),
    })?;
    let supports: &[Held] =
        if axisymmetric { &[("bottom", Y), ("top", Y)] } else { &[("symmetry_x", X), ("symmetry_y", Y)] };
    Ok(one_body("thick_cylinder", definition, supports))
}

fn two_blocks(given: &TwoBlocks, taken: &mut UsedDefaults) -> Result<MeshAndSets, SpecimenError> {
    let definition = specimen::two_blocks(&specimen::TwoBlocks {
        width: taken.real("width", given.width, 1.0),
        heights: taken.two("heights", given.heights, [1.0; 2]),
        edges: taken.two("edges", given.edges, [4, 3]),
        rows: taken.two("rows", given.rows, [2, 2]),
        elements: [taken.or("element", given.element, ElementKind::Q8); 2],
    })?;
    let supports = [("bottom", Y), ("lower_left", X), ("upper_left", X)];
    Ok(in_contact("two_blocks", definition, &supports, "lower_contact", "upper_contact", None))
}

fn hertz(given: &Hertz, taken: &mut UsedDefaults) -> Result<MeshAndSets, SpecimenError> {
    let definition = specimen::cylinder_on_plane(&specimen::CylinderOnPlane {
        radius: taken.real("radius", given.radius, 10.0),
        half_width: taken.real("half_width", given.half_width, 5.0),
        height: taken.real("height", given.height, 5.0),
        depth: taken.real("depth", given.depth, 5.0),
        contact_zone: taken.real("contact_zone", given.contact_zone, 0.5),
        contact_edges: taken.or("contact_edges", given.contact_edges, 20),
        growth: taken.real("growth", given.growth, 1.3),
        element: taken.or("element", given.element, ElementKind::Q8),
    })?;
    let supports = [("bottom", Y), ("symmetry", X)];
    Ok(in_contact("hertz", definition, &supports, "base_contact", "cylinder_contact", None))
}

fn drag_out_strip(given: &DragOutStrip, taken: &mut UsedDefaults) -> Result<MeshAndSets, SpecimenError> {
    let default = specimen::DragOutStrip::default();
    let definition = specimen::drag_out_strip(&specimen::DragOutStrip {
        strip_length: taken.real("strip_length", given.strip_length, default.strip_length),
        strip_height: taken.real("strip_height", given.strip_height, default.strip_height),
        block_start: taken.real("block_start", given.block_start, default.block_start),
        block_length: taken.real("block_length", given.block_length, default.block_length),
        block_height: taken.real("block_height", given.block_height, default.block_height),
        strip_edges: taken.or("strip_edges", given.strip_edges, default.strip_edges),
        strip_rows: taken.or("strip_rows", given.strip_rows, default.strip_rows),
        block_edges: taken.or("block_edges", given.block_edges, default.block_edges),
        block_size: taken.real("block_size", given.block_size, default.block_size),
        growth: taken.real("growth", given.growth, default.growth),
        element: taken.or("element", given.element, default.element),
    })?;
    let supports = [("symmetry", Y), ("block_left", X)];
    let grip = Some(("sliding_end", [1.0, 0.0]));
    Ok(in_contact("drag_out_strip", definition, &supports, "block_contact", "strip_contact", grip))
}

fn curved_channel(given: &CurvedChannel, taken: &mut UsedDefaults) -> Result<MeshAndSets, SpecimenError> {
    let definition = specimen::curved_channel(&specimen::CurvedChannel {
        radius: taken.real("radius", given.radius, 10.0),
        angle: taken.real("angle_deg", given.angle_deg, 90.0).to_radians(),
        fibre_height: taken.real("fibre_height", given.fibre_height, 0.2),
        free_length: taken.real("free_length", given.free_length, 1.0),
        depth: taken.real("depth", given.depth, 0.5),
        edges: taken.or("edges", given.edges, 40),
        free_edges: taken.or("free_edges", given.free_edges, 3),
        rows: taken.or("rows", given.rows, 1),
        element: taken.or("element", given.element, ElementKind::Q8),
    })?;
    let grip = Some(("grip", [0.0, -1.0]));
    Ok(in_contact("curved_channel", definition, &[("channel", BOTH)], "channel_contact", "fibre_contact", grip))
}

fn one_body(name: &str, definition: MeshDefinition, supports: &[Held]) -> MeshAndSets {
    let supports = vec![DefaultSupports { name: "standard", supports: supports.to_vec() }];
    let specimen = specimen::Specimen { definition, ..Default::default() };
    MeshAndSets { words: format!("specimen {name}"), specimen, supports, ..MeshAndSets::default() }
}

fn in_contact(
    name: &str,
    definition: MeshDefinition,
    supports: &[Held],
    slave: &str,
    master: &str,
    grip: Option<(&'static str, [f64; 2])>,
) -> MeshAndSets {
    let mut ground = one_body(name, definition, supports);
    ground.specimen.contact_pairs = vec![ContactSurfaces {
        name: "contact".into(),
        slave: slave.into(),
        master: master.into(),
        role: SurfaceRole::Bonded,
        width: None,
    }];
    if let Some((nodes, direction)) = grip {
        ground.grip = Some(nodes);
        ground.specimen.pull_direction = direction;
    }
    ground
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
