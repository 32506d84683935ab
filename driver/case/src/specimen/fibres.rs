//! Specimens with fibres, and what each says where the case says nothing.

use super::boundary::BOTH;
use super::generated::{X, without_effect};
use super::mesh::{DefaultSupports, Held, MeshAndSets, thickness};
use crate::document::Positive;
use crate::document::pullout::{self as document, FibreShape, SeparationLength, SeparationRule, Thickness};
use crate::reader::UsedDefaults;
use fe_core::element::ElementKind;
use fe_core::mesh::specimen::{
    self, Configuration, FINE_DIAMETERS, Fibre, FibreMesh, Fibres, FibresMesh, GradedThickness, ParameterProblem,
    PerpendicularFibre, Segment, SpecimenError,
};
use pullout_bridging::Hook;

/// Default slope of a graded thickness: the stiffness of the fibre in its block is within 14 % of that in space at 0 and 45°, along and across
/// it, in blocks of 3 and 13 mm (`tests/reference/inclined_fibre`).
const SLOPE: f64 = 1.0;

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
    let axisymmetric = taken.or("axisymmetric", given.axisymmetric, false);
    let has_radius = given.outer_radius.is_some();
    without_effect(&[
        ("outer_radius", has_radius && !axisymmetric, "a plane slice"),
        ("width", given.width.is_some() && has_radius && axisymmetric, "a body of revolution with an outer_radius"),
        (
            "matrix_thickness",
            given.matrix_thickness.is_some() && has_radius && axisymmetric,
            "a body of revolution with an outer_radius",
        ),
        matrix_thickness_twice(matrix.filter(|_| !axisymmetric), given.matrix_thickness),
        (
            "equal_sizes",
            given.equal_sizes == Some(true) && given.exit_size.is_some(),
            "a specimen with an exit_size, from which the sizes grow",
        ),
    ])?;
    let default = PerpendicularFibre::default();
    let fibre_diameter = taken.real("fibre_diameter", given.fibre_diameter, default.fibre_diameter);
    let sizes = FibreMesh::default();
    let exit_size = sizes.exit_size.filter(|_| given.equal_sizes != Some(true));
    let exit_size = exit_size.map(|size| taken.real("exit_size", given.exit_size, size));
    let parameters = PerpendicularFibre {
        configuration: if axisymmetric {
            Configuration::Axisymmetric { outer_radius: given.outer_radius.map(|radius| radius.0) }
        } else {
            Configuration::Plane
        },
        // an outer radius that is not given follows from width and thickness
        width: if has_radius { default.width } else { taken.real("width", given.width, default.width) },
        depth: taken.real("depth", given.depth, default.depth),
        matrix_thickness: if has_radius {
            default.matrix_thickness
        } else {
            let of_part = matrix.filter(|_| !axisymmetric);
            matrix_thickness(of_part, given.matrix_thickness, fibre_diameter, default.matrix_thickness, taken)
        },
        cover: taken.or("cover", given.cover, default.cover),
        graded_thickness: given.graded_thickness.map(graded),
        fibre_diameter,
        embedded_length: taken.real("embedded_length", given.embedded_length, default.embedded_length),
        free_length: taken.real("free_length", given.free_length, default.free_length),
        tail_gap: taken.real("tail_gap", given.tail_gap, default.tail_gap),
        fibre_element: taken.or("fibre_element", given.fibre_element, ElementKind::Q8),
        matrix_element: taken.or("matrix_element", given.matrix_element, ElementKind::Q8),
        mesh: FibreMesh {
            embedded_elements: taken.or("embedded_elements", given.embedded_elements, sizes.embedded_elements),
            exit_size,
            elements_across: taken.or("elements_across", given.elements_across, sizes.elements_across),
            slave_edges_per_master: taken.or(
                "slave_edges_per_master",
                given.slave_edges_per_master,
                sizes.slave_edges_per_master,
            ),
            interface_size: taken.real("interface_size", given.interface_size, sizes.interface_size),
            growth: taken.real("growth", given.growth, sizes.growth),
            largest_size: taken.real("largest_size", given.largest_size, sizes.largest_size),
        },
    };
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
        matrix_thickness_twice(matrix, given.matrix_thickness),
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
    let block = document::Fibres {
        fibres: Vec::new(),
        grips: None,
        width: given.width,
        depth: given.depth,
        matrix_thickness: given.matrix_thickness,
        cover: given.cover,
        graded_thickness: given.graded_thickness,
        fibre_element: given.fibre_element,
        matrix_element: given.matrix_element,
        mesh_size: given.mesh_size,
        elements_across: given.elements_across,
        exit_size: given.exit_size,
        largest_fibre_size: given.largest_fibre_size,
        growth_rate: given.growth_rate,
        largest_size: given.largest_size,
    };
    around("inclined_fibre", vec![fibre], &block, matrix, taken)
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
    let mut ground = around("fibres", made, given, matrix, taken)?;
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

/// A specimen of fibres in the block that a case describes; its own list of fibres is not looked at.
fn around(
    name: &str,
    fibres: Vec<Fibre>,
    block: &document::Fibres,
    matrix: Option<Thickness>,
    taken: &mut UsedDefaults,
) -> Result<MeshAndSets, SpecimenError> {
    let (default, sizes) = (Fibres::default(), FibresMesh::default());
    let thickest = fibres.iter().map(|fibre| fibre.diameter).fold(0.0, f64::max);
    let matrix_thickness = matrix_thickness(matrix, block.matrix_thickness, thickest, default.matrix_thickness, taken);
    let parameters = Fibres {
        width: taken.real("width", block.width, default.width),
        depth: taken.real("depth", block.depth, default.depth),
        matrix_thickness,
        cover: taken.or("cover", block.cover, matrix_thickness > thickest),
        graded_thickness: block.graded_thickness.map(graded),
        fibres,
        fibre_element: taken.or("fibre_element", block.fibre_element, ElementKind::Q8),
        matrix_element: taken.or("matrix_element", block.matrix_element, default.matrix_element),
        mesh: FibresMesh {
            size: taken.real("mesh_size", block.mesh_size, sizes.size),
            elements_across: taken.or("elements_across", block.elements_across, sizes.elements_across),
            exit_size: block.exit_size.map(|size| size.0),
            largest_fibre_size: taken.real("largest_fibre_size", block.largest_fibre_size, sizes.largest_fibre_size),
            growth_rate: taken.real("growth_rate", block.growth_rate, sizes.growth_rate),
            largest_size: taken.real("largest_size", block.largest_size, sizes.largest_size),
        },
    };
    let made = specimen::fibres(&parameters)?;
    let ways = ["sides", "face_near", "face_away", "bottom"];
    Ok(pulled_fibre(name, made, &ways, &[]))
}

/// l = φ (tan θ + 1/(2 tan θ)), 0 below 15° (6.27), mm; θ in rad.
fn thesis_separation_length(diameter: f64, angle: f64) -> f64 {
    let tangent = angle.tan();
    if angle.to_degrees() < 15.0 { 0.0 } else { diameter * (tangent + 0.5 / tangent) }
}

/// The thickness of a block around a fibre, mm: what the case says of the part, or else of the specimen.
fn matrix_thickness(
    of_part: Option<Thickness>,
    given: Option<Positive>,
    diameter: f64,
    default: f64,
    taken: &mut UsedDefaults,
) -> f64 {
    let of_part = of_part.and_then(|of_part| thickness(of_part, Some(diameter)).ok());
    of_part.unwrap_or_else(|| taken.real("matrix_thickness", given, default))
}

/// Returns what is wrong if the block's thickness is given in addition to that of its part, which counts.
fn matrix_thickness_twice(of_part: Option<Thickness>, given: Option<Positive>) -> (&'static str, bool, &'static str) {
    let is_twice = of_part.is_some() && given.is_some();
    ("matrix_thickness", is_twice, "a specimen whose parts.matrix has a thickness")
}

fn graded(given: document::GradedThickness) -> GradedThickness {
    GradedThickness { slope: given.slope.unwrap_or(SLOPE), extent: given.extent.map(|extent| extent.0) }
}

/// A specimen that is held by one of some node sets, and by what holds it in any case.
fn pulled_fibre(name: &str, mut specimen: specimen::Specimen, ways: &[&'static str], also: &[Held]) -> MeshAndSets {
    specimen.contact_pairs.extend(specimen.fibres.iter().map(|fibre| fibre.end.clone()));
    let exists = |set: &&&str| specimen.definition.node_sets.contains_key(**set);
    let held = |set: &'static str| [&[(set, BOTH)], also].concat();
    let supports = ways.iter().filter(exists).map(|&set| DefaultSupports { name: set, supports: held(set) }).collect();
    MeshAndSets { words: format!("specimen {name}"), specimen, supports, grip: Some("grip"), grips_each: false }
}
