//! Specimens with fibres, and what each says where the case says nothing.

use super::boundary::BOTH;
use super::generated::{X, without_effect};
use super::mesh::{DefaultSupports, Held, MeshAndSets, thickness};
use crate::document::pullout::{self as document, FibreShape, SeparationLength, SeparationRule, Thickness};
use crate::document::{Positive, WithDefaults};
use crate::reader::UsedDefaults;
use fe_core::mesh::specimen::{
    self, Configuration, FINE_DIAMETERS, Fibre, Fibres, ParameterProblem, PerpendicularFibre, Segment, SpecimenError,
};
use pullout_bridging::Hook;

/// Inclination of a fibre, degrees.
const ANGLE: f64 = 45.0;

/// The least diameter of a fibre, mm: carbon has 0.007.
const THINNEST: f64 = 0.002;
/// The greatest embedded length, in diameters.
const MOST_DIAMETERS: f64 = 5000.0;
/// Angle of the bends of a hook, degrees, and the radius of its axis, in diameters.
const HOOK_ANGLE: f64 = 45.0;
const HOOK_RADIUS: f64 = 2.0;

/// Length of a bent fibre between its bend and the grip, mm.
const FREE_LENGTH_AFTER_BEND: f64 = 3.0;

pub(super) fn perpendicular_fibre(
    given: &document::PerpendicularFibre,
    matrix: Option<Thickness>,
    taken: &mut UsedDefaults,
) -> Result<MeshAndSets, SpecimenError> {
    let fibre = &given.fibre;
    let axisymmetric = taken.or("axisymmetric", given.axisymmetric, false);
    let matrix = matrix.filter(|_| !axisymmetric);
    let has_radius = given.outer_radius.is_some();
    let has_equal_sizes = given.equal_sizes == Some(true);
    const WITH_RADIUS: &str = "a body of revolution with an outer_radius";
    without_effect(&[
        ("outer_radius", has_radius && !axisymmetric, "a plane slice"),
        ("width", fibre.has("width") && has_radius && axisymmetric, WITH_RADIUS),
        ("matrix_thickness", fibre.has("matrix_thickness") && has_radius && axisymmetric, WITH_RADIUS),
        matrix_thickness_twice(matrix, fibre.has("matrix_thickness")),
        (
            "equal_sizes",
            has_equal_sizes && fibre.has("exit_size"),
            "a specimen with an exit_size, from which the sizes grow",
        ),
    ])?;
    let decided =
        [("width", has_radius), ("matrix_thickness", has_radius || matrix.is_some()), ("exit_size", has_equal_sizes)];
    let decided: Vec<&str> = decided.into_iter().filter(|(_, is)| *is).map(|(name, _)| name).collect();
    fibre.note(taken, &decided);
    let mut parameters = PerpendicularFibre::clone(fibre);
    if axisymmetric {
        // one that is not given follows from width and thickness
        let outer_radius = given.outer_radius.map(|radius| radius.0);
        parameters.configuration = Configuration::Axisymmetric { outer_radius };
    }
    if has_equal_sizes {
        parameters.mesh.exit_size = None;
    }
    let fibre_diameter = fibre.fibre_diameter;
    parameters.matrix_thickness = matrix_thickness(matrix, fibre_diameter).unwrap_or(parameters.matrix_thickness);
    let lengths = [("fibre_diameter", fibre_diameter), ("embedded_length", parameters.embedded_length)];
    check_unit(None, lengths)?;
    let made = specimen::perpendicular_fibre(&parameters)?;
    let ways: &[&'static str] =
        if axisymmetric { &["outer", "bottom"] } else { &["sides", "face_near", "face_away", "bottom"] };
    let also: &[Held] = if axisymmetric { &[("axis", X)] } else { &[] };
    Ok(pulled_fibre("perpendicular_fibre", made, ways, also))
}

pub(super) fn inclined_fibre(
    given: &document::InclinedFibre,
    matrix: Option<Thickness>,
    slip: f64,
    taken: &mut UsedDefaults,
) -> Result<MeshAndSets, SpecimenError> {
    let angle = taken.real("angle_deg", given.angle_deg, ANGLE).to_radians();
    let is_straight = given.shape == Some(FibreShape::Straight);
    without_effect(&[
        ("bend_radius", is_straight && given.bend_radius.is_some(), "a straight fibre"),
        matrix_thickness_twice(matrix, given.block.has("matrix_thickness")),
    ])?;
    let default = Fibre::new(angle, Vec::new());
    let diameter = taken.real("fibre_diameter", given.fibre_diameter, default.diameter);
    let embedded_length = taken.real("embedded_length", given.embedded_length, default.embedded_length);
    check_unit(None, [("fibre_diameter", diameter), ("embedded_length", embedded_length)])?;
    let mut path = vec![Segment::Straight { length: embedded_length }];
    if given.shape.is_none() {
        taken.note("shape", "bent");
    }
    let free_length = match given.shape.unwrap_or(FibreShape::Bent) {
        FibreShape::Bent => {
            path.push(Segment::Arc { radius: taken.real("bend_radius", given.bend_radius, 1.5 * diameter), to: 0.0 });
            taken.real("free_length", given.free_length, FREE_LENGTH_AFTER_BEND)
        }
        FibreShape::Straight => taken.real("free_length", given.free_length, 0.0),
    };
    path.push(Segment::Straight { length: free_length });
    let separation_length = match given.separation_length {
        None => taken.real("separation_length", None::<f64>, 0.0),
        Some(SeparationLength::Given(length)) => length,
        Some(SeparationLength::Rule(SeparationRule::Thesis)) => thesis_separation_length(diameter, angle),
    };
    let fibre = Fibre {
        diameter,
        path,
        embedded_length,
        exit_radius: given.exit_radius.map(|radius| radius.0),
        separation_length,
        fine_length: fine_length(given.fine_length, slip, diameter, embedded_length),
        ..default
    };
    around("inclined_fibre", vec![fibre], (&given.block, given.cover), matrix, taken)
}

pub(super) fn fibres(
    given: &document::Fibres,
    matrix: Option<Thickness>,
    slip: f64,
    taken: &mut UsedDefaults,
) -> Result<MeshAndSets, SpecimenError> {
    let mut made = Vec::new();
    for given in &given.fibres {
        let of = |key: &str| format!("{}.{key}", given.name);
        let default = Fibre::new(0.0, Vec::new());
        let diameter = taken.real(&of("diameter"), given.diameter, default.diameter);
        let embedded_length = taken.real(&of("embedded"), given.embedded, default.embedded_length);
        check_unit(Some(made.len()), [("diameter", diameter), ("embedded", embedded_length)])?;
        let rotation = given.rotate_deg.unwrap_or(0.0).to_radians();
        let (lean, path, hook_length) = match &given.path {
            document::FibrePath::Pieces(pieces) => {
                pieces_of_path(pieces, rotation, embedded_length).map(|(lean, path)| (lean, path, 0.0))
            }
            document::FibrePath::Hooked(hooked) => {
                hooked_path(hooked, rotation, [diameter, embedded_length], &of, taken)
            }
        }
        .map_err(|(value, requirement)| wrong(Some(made.len()), "path", value, requirement))?;
        let default = Fibre { lean, path, ..default };
        made.push(Fibre {
            name: Some(given.name.clone()),
            diameter,
            exit: taken.real(&of("exit"), given.exit, default.exit),
            embedded_length,
            profile: given.width_profile.clone().unwrap_or_default(),
            tail_gap: taken.real(&of("tail_gap"), given.tail_gap, default.tail_gap),
            exit_radius: given.exit_radius.map(|radius| radius.0),
            separation_length: taken.real(&of("separation_length"), given.separation_length, default.separation_length),
            fine_length: fine_length(given.fine_length, slip, diameter, embedded_length),
            hook_length: if given.fine_length.is_none() { hook_length } else { 0.0 },
            ..default
        });
    }
    let mut ground = around("fibres", made, (&given.block, given.cover), matrix, taken)?;
    ground.grips_each = given.grips == Some(document::Grips::Each);
    Ok(ground)
}

fn wrong(fibre: Option<usize>, name: &'static str, value: String, requirement: String) -> SpecimenError {
    SpecimenError::Parameters { problems: vec![ParameterProblem { fibre, name, value, requirement }] }
}

/// Refuses a diameter in metres, and an embedded length in micrometres, before they are meshed.
fn check_unit(
    fibre: Option<usize>,
    [(diameter_key, diameter), (length_key, length)]: [(&'static str, f64); 2],
) -> Result<(), SpecimenError> {
    if diameter < THINNEST {
        let requirement = format!("at least {THINNEST}: lengths are in mm, and no fibre is thinner");
        return Err(wrong(fibre, diameter_key, diameter.to_string(), requirement));
    }
    if length > MOST_DIAMETERS * diameter {
        let requirement = format!("at most {MOST_DIAMETERS} diameters: are all lengths in mm?");
        return Err(wrong(fibre, length_key, length.to_string(), requirement));
    }
    Ok(())
}

/// What is wrong with a path: a value, and what it must be.
type PathProblem = (String, String);

/// The lean of a path where it begins, rad, and its segments; those inside the block are turned by `rotation`.
fn pieces_of_path(
    pieces: &[document::PathPiece],
    rotation: f64,
    embedded_length: f64,
) -> Result<(f64, Vec<Segment>), PathProblem> {
    let wrong = |index: usize, value: &str, requirement: &str| {
        Err((format!("{value} in piece {}", index + 1), requirement.to_owned()))
    };
    let lean = pieces.first().and_then(|piece| piece.tilt_deg).unwrap_or(0.0).to_radians() + rotation;
    let (mut direction, mut length) = (lean, 0.0);
    let mut path = Vec::new();
    for (index, piece) in pieces.iter().enumerate() {
        if index > 0 && piece.tilt_deg.is_some() {
            let requirement = "in the first piece only: each goes on where the one before it ends, and an arc turns it";
            return wrong(index, "given tilt_deg", requirement);
        }
        let segment = match (piece.straight, piece.arc, piece.wave) {
            (Some(length), None, None) => Segment::Straight { length: length.0 },
            (None, Some(arc), None) => {
                let to = match (arc.to_deg.map(f64::to_radians), arc.by_deg.map(f64::to_radians)) {
                    (Some(to), None) => {
                        // by its middle: embedded lengths are rounded
                        let is_inside = length + 0.5 * arc.radius.0 * (to - direction).abs() < embedded_length;
                        if is_inside { to + rotation } else { to }
                    }
                    (None, Some(by)) => direction + by,
                    _ => return wrong(index, "unclear", "given as one of \"to_deg\" and \"by_deg\" in each arc"),
                };
                Segment::Arc { radius: arc.radius.0, to }
            }
            (None, None, Some(wave)) => {
                Segment::Wave { amplitude: wave.amplitude, length: wave.length.0, count: wave.n.0 }
            }
            _ => {
                let requirement = "given as one of \"straight\", \"arc\" and \"wave\" in each piece";
                return wrong(index, "unclear", requirement);
            }
        };
        length += segment.length(direction);
        if let Segment::Arc { to, .. } = segment {
            direction = to;
        }
        path.push(segment);
    }
    Ok((lean, path))
}

/// The lean and the segments of a shaft with a hooked end, and the length of the hook.
fn hooked_path(
    given: &document::HookedPath,
    rotation: f64,
    [diameter, embedded_length]: [f64; 2],
    of: &dyn Fn(&str) -> String,
    taken: &mut UsedDefaults,
) -> Result<(f64, Vec<Segment>, f64), PathProblem> {
    let count = given.hook.len();
    if let Some(bends) = given.bends.filter(|bends| *bends != count) {
        return Err((
            format!("a hook of {count} pieces with {bends} bends"),
            "one with as many bends as pieces".to_owned(),
        ));
    }
    let angle = taken.real(&of("path.angle_deg"), given.angle_deg, HOOK_ANGLE).to_radians();
    let radius = taken.real(&of("path.radius"), given.radius, HOOK_RADIUS * diameter);
    let free_length = taken.real(&of("path.free_length"), given.free_length, FREE_LENGTH_AFTER_BEND);
    // from the shaft: oblique, along it, oblique to the other side, along it
    let lean = |from_shaft: usize| rotation + [0.0, angle, 0.0, -angle][from_shaft % 4];
    let mut path = Vec::new();
    let mut hook_length = 0.0;
    for (index, piece) in given.hook.iter().enumerate() {
        let taken_by_bends = Hook::taken_by_bends(index, angle, radius);
        let straight = piece.0 - taken_by_bends;
        if straight <= 0.0 {
            return Err((
                format!("a hook whose piece {} is {} mm long", index + 1, piece.0),
                format!(
                    "one whose bends have room: more than {taken_by_bends:.4} mm there, or a smaller radius or angle"
                ),
            ));
        }
        path.push(Segment::Straight { length: straight });
        path.push(Segment::Arc { radius, to: lean(count - 1 - index) });
        hook_length += straight + radius * angle;
    }
    let shaft = embedded_length - hook_length;
    if shaft <= 0.0 {
        return Err((
            format!("a hook of {hook_length:.4} mm in an embedded length of {embedded_length} mm"),
            "one that lies in the block with a piece of its shaft".to_owned(),
        ));
    }
    if rotation == 0.0 {
        path.push(Segment::Straight { length: shaft + free_length });
    } else {
        let bend_radius = taken.real(&of("path.bend_radius"), given.bend_radius, 1.5 * diameter);
        path.push(Segment::Straight { length: shaft });
        path.push(Segment::Arc { radius: bend_radius, to: 0.0 });
        path.push(Segment::Straight { length: free_length });
    }
    Ok((lean(count), path, hook_length))
}

/// Returns the length that is meshed finely. What slides out is: coarse elements that bend over the exit's edge make the load a saw. A hook is
/// not: its mesh decides the curve, which would depend on how far the fibre is pulled.
fn fine_length(given: Option<Positive>, slip: f64, diameter: f64, embedded_length: f64) -> Option<f64> {
    let slides_out = (slip > FINE_DIAMETERS * diameter).then(|| slip.min(embedded_length));
    given.map(|length| length.0).or(slides_out)
}

/// A specimen of fibres in the block that a case describes, with a cover if it says so.
fn around(
    name: &str,
    fibres: Vec<Fibre>,
    (block, cover): (&WithDefaults<Fibres>, Option<bool>),
    matrix: Option<Thickness>,
    taken: &mut UsedDefaults,
) -> Result<MeshAndSets, SpecimenError> {
    let thickest = fibres.iter().map(|fibre| fibre.diameter).fold(0.0, f64::max);
    let of_part = matrix_thickness(matrix, thickest);
    block.note(taken, if of_part.is_some() { &["matrix_thickness"] } else { &[] });
    let matrix_thickness = of_part.unwrap_or(block.matrix_thickness);
    let cover = taken.or("cover", cover, matrix_thickness > thickest);
    let parameters = Fibres { matrix_thickness, cover, fibres, ..Fibres::clone(block) };
    let made = specimen::fibres(&parameters)?;
    let ways = ["sides", "face_near", "face_away", "bottom"];
    Ok(pulled_fibre(name, made, &ways, &[]))
}

/// l = φ (tan θ + 1/(2 tan θ)), 0 below 15° (6.27), mm; θ in rad.
fn thesis_separation_length(diameter: f64, angle: f64) -> f64 {
    let tangent = angle.tan();
    if angle.to_degrees() < 15.0 { 0.0 } else { diameter * (tangent + 0.5 / tangent) }
}

/// The thickness that the case gives the part around a fibre, mm.
fn matrix_thickness(of_part: Option<Thickness>, diameter: f64) -> Option<f64> {
    of_part.and_then(|of_part| thickness(of_part, Some(diameter)).ok())
}

/// Returns what is wrong if the block's thickness is given in addition to that of its part, which counts.
fn matrix_thickness_twice(of_part: Option<Thickness>, is_given: bool) -> (&'static str, bool, &'static str) {
    ("matrix_thickness", of_part.is_some() && is_given, "a specimen whose parts.matrix has a thickness")
}

/// A specimen that is held by one of some node sets, and by what holds it in any case.
fn pulled_fibre(name: &str, mut specimen: specimen::Specimen, ways: &[&'static str], also: &[Held]) -> MeshAndSets {
    specimen.contact_pairs.extend(specimen.fibres.iter().map(|fibre| fibre.end.clone()));
    let exists = |set: &&&str| specimen.definition.node_sets.contains_key(**set);
    let held = |set: &'static str| [&[(set, BOTH)], also].concat();
    let supports = ways.iter().filter(exists).map(|&set| DefaultSupports { name: set, supports: held(set) }).collect();
    MeshAndSets { words: format!("specimen {name}"), specimen, supports, grip: Some("grip"), grips_each: false }
}
