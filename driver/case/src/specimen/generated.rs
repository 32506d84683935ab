//! Specimens by their parameters, and what each says where the case says nothing.

use super::boundary::BOTH;
use super::fibres;
use super::mesh::{DefaultSupports, Held, MeshAndSets};
use crate::document::pullout::{Specimen, Thickness};
use crate::reader::UsedDefaults;
use fe_core::mesh::MeshDefinition;
use fe_core::mesh::specimen::{self, ContactSurfaces, ParameterProblem, SpecimenError, SurfaceRole};

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
        Specimen::PlateWithHole(given) => {
            given.note(taken, &[]);
            let supports = [("symmetry_x", X), ("symmetry_y", Y)];
            Ok(one_body("plate_with_hole", specimen::plate_with_hole(given)?, &supports))
        }
        Specimen::ThickCylinder(given) => {
            let is_quarter = !given.axisymmetric;
            without_effect(&[("height", given.has("height") && is_quarter, "a quarter of the cross-section")])?;
            given.note(taken, if is_quarter { &["height"] } else { &[] });
            let supports = match is_quarter {
                true => [("symmetry_x", X), ("symmetry_y", Y)],
                false => [("bottom", Y), ("top", Y)],
            };
            Ok(one_body("thick_cylinder", specimen::thick_cylinder(given)?, &supports))
        }
        Specimen::CookMembrane(given) => {
            given.note(taken, &[]);
            Ok(one_body("cook_membrane", specimen::cook_membrane(given)?, &[("left", BOTH)]))
        }
        Specimen::Beam(given) => {
            given.note(taken, &[]);
            Ok(one_body("beam", specimen::beam(given)?, &[("left", BOTH)]))
        }
        Specimen::TwoBlocks(given) => {
            given.note(taken, &[]);
            let supports = [("bottom", Y), ("lower_left", X), ("upper_left", X)];
            let bodies = one_body("two_blocks", specimen::two_blocks(given)?, &supports);
            Ok(in_contact(bodies, ["lower_contact", "upper_contact"], None))
        }
        Specimen::Hertz(given) => {
            given.note(taken, &[]);
            let bodies = one_body("hertz", specimen::hertz(given)?, &[("bottom", Y), ("symmetry", X)]);
            Ok(in_contact(bodies, ["base_contact", "cylinder_contact"], None))
        }
        Specimen::DragOutStrip(given) => {
            given.note(taken, &[]);
            let supports = [("symmetry", Y), ("block_left", X)];
            let bodies = one_body("drag_out_strip", specimen::drag_out_strip(given)?, &supports);
            Ok(in_contact(bodies, ["block_contact", "strip_contact"], Some(("sliding_end", [1.0, 0.0]))))
        }
        Specimen::CurvedChannel(given) => {
            given.note(taken, &[]);
            let bodies = one_body("curved_channel", specimen::curved_channel(given)?, &[("channel", BOTH)]);
            Ok(in_contact(bodies, ["channel_contact", "fibre_contact"], Some(("grip", [0.0, -1.0]))))
        }
    }
}

fn one_body(name: &str, definition: MeshDefinition, supports: &[Held]) -> MeshAndSets {
    let supports = vec![DefaultSupports { name: "standard", supports: supports.to_vec() }];
    let specimen = specimen::Specimen { definition, ..Default::default() };
    MeshAndSets { words: format!("specimen {name}"), specimen, supports, ..MeshAndSets::default() }
}

/// Bodies with the surfaces, slave and master, on which they touch.
fn in_contact(
    mut ground: MeshAndSets,
    [slave, master]: [&str; 2],
    grip: Option<(&'static str, [f64; 2])>,
) -> MeshAndSets {
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
