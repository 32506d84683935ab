//! A scalar per node: the temperature of the laws.

use super::Scene;
use super::boundary::Drives;
use crate::document::PulloutCase;
use crate::document::pullout as document;
use crate::problem::{Place, hint};
use crate::reader::Reader;
use fe_core::model::{CrackSurface, FieldCoupling, FieldKind, FixedValue, Flux, PluginLaw, ScalarField};

/// The field of a case, without the cracks of the laws ([`with_cracks_of`]).
pub fn resolve(
    reader: &mut Reader<'_>,
    case: &PulloutCase,
    scene: Scene<'_>,
    drives: &mut Drives,
) -> Option<ScalarField> {
    let place = Place::root().key("field");
    let given = case.field.as_ref()?;
    let crack =
        given.crack.map(|crack| CrackSurface { fracture_energy: crack.fracture_energy.0, length: crack.length.0 });
    let kind = match given.kind {
        document::FieldKind::PhaseField => FieldKind::PhaseField(crack),
        document::FieldKind::Temperature => {
            if given.crack.is_some() {
                reader.problem(&place.key("crack"), "a temperature has no cracks: \"kind\": \"phase_field\" has");
            }
            FieldKind::Temperature
        }
    };
    let fixed = given.fixed.iter().flatten().enumerate().filter_map(|(index, entry)| {
        let place = place.key("fixed").index(index);
        let nodes = scene.node_set(reader, &entry.nodes, &place.key("nodes"));
        let drive = drive(drives, entry.drive.as_deref(), &place);
        Some(FixedValue { nodes: nodes?.to_vec(), value: entry.value, drive })
    });
    let fixed = fixed.collect();
    let fluxes = given.fluxes.iter().flatten().enumerate().filter_map(|(index, entry)| {
        let place = place.key("fluxes").index(index);
        let edges = scene.edge_set(reader, &entry.edges, &place.key("edges"));
        let drive = drive(drives, entry.drive.as_deref(), &place);
        Some(Flux { edges: edges?.to_vec(), flux: entry.flux, drive })
    });
    let fluxes = fluxes.collect();
    let mesh = scene.mesh?;
    let default = ScalarField::new(kind, mesh.parts().len());
    let conductivity = given.conductivity.map_or(default.conductivity, Into::into);
    let capacity = given.capacity.map_or(default.capacity, Into::into);
    let tolerance = given.tolerance.map_or(default.tolerance, Into::into);
    let parts = parts(reader, given, scene, &place).unwrap_or(default.parts);
    let coupling = match given.coupling {
        Some(document::FieldCoupling::OnePass) => FieldCoupling::OnePass,
        Some(document::FieldCoupling::Staggered) | None => FieldCoupling::Staggered,
    };
    let initial = given.initial.unwrap_or(default.initial);
    if case.course.temperature.is_some() {
        reader.warn_no_effect(&Place::root().key("temperature"), "parts of the field have its values");
    }
    Some(ScalarField { kind, parts, conductivity, capacity, initial, fixed, fluxes, coupling, tolerance })
}

fn drive(drives: &mut Drives, name: Option<&str>, place: &Place) -> Option<usize> {
    name.map(|name| drives.followed(name, &place.key("drive")))
}

/// Whether each part has the field; `None`: the case does not say.
fn parts(reader: &mut Reader<'_>, given: &document::ScalarField, scene: Scene<'_>, place: &Place) -> Option<Vec<bool>> {
    let place = place.key("parts");
    let names = given.parts.as_ref()?;
    let parts = scene.mesh?.parts();
    for (index, name) in names.iter().enumerate() {
        if !parts.iter().any(|part| part.name == *name) {
            let known: Vec<&str> = parts.iter().map(|part| part.name.as_str()).collect();
            let message = format!("the mesh has no part '{name}'{}", hint(name, &known));
            reader.problem(&place.index(index), message);
        }
    }
    if names.is_empty() {
        reader.problem(&place, "names no part: leave it out for all parts");
    }
    Some(parts.iter().map(|part| names.contains(&part.name)).collect())
}

/// Gives a phase field the cracks that its laws have, where the case does not say; a warning where the mesh is too coarse for them.
pub fn with_cracks_of(
    reader: &mut Reader<'_>,
    field: &mut ScalarField,
    laws: &[PluginLaw],
    lengths: impl Fn(usize) -> f64,
) {
    let FieldKind::PhaseField(crack) = &mut field.kind else { return };
    let surface = |law: &PluginLaw| {
        let parameter = |name: &str| {
            let place = law.law.as_ref()?.parameters.iter().position(|parameter| parameter.name == name)?;
            law.props.get(place).copied()
        };
        Some(CrackSurface { fracture_energy: parameter("G_f")?, length: parameter("l")? })
    };
    let with_field = laws.iter().enumerate().filter(|(part, _)| field.parts[*part]);
    for (part, law) in with_field {
        let Some(of_law) = surface(law) else { continue };
        let least = lengths(part);
        if least > of_law.length {
            reader.warn(format!(
                "$.field: the smallest element is {least:.3} mm, l = {} mm: cracks need elements of l/2 where they run, at most l",
                of_law.length
            ));
        }
        crack.get_or_insert(of_law);
    }
}
