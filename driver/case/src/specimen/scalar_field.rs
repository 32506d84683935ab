//! A scalar per node: the temperature of the laws.

use super::KnownMesh;
use super::boundary::Drives;
use super::mesh::{MATRIX, called};
use crate::document::PulloutCase;
use crate::document::pullout as document;
use crate::document::pullout::{HeatRoutine, MeshSource};
use crate::plugin;
use crate::problem::{Place, hint};
use crate::reader::Reader;
use fe_core::model::{
    CrackSurface, FieldCoupling, FieldKind, Fields, FixedValue, Flux, HeatTransfer, PluginLaw, ScalarField,
};
use pullout_run::isolation::is_shipped;
use umat_abi::host::{Library, Plugin};

/// The field of a case, without the cracks of the laws ([`with_cracks_of`]).
pub fn resolve(
    reader: &mut Reader<'_>,
    case: &PulloutCase,
    scene: KnownMesh<'_>,
    has_field: Option<Vec<bool>>,
    drives: &mut Drives,
) -> Option<ScalarField> {
    let place = Place::root().key("field");
    let given = case.field.as_ref()?;
    let kind = match given.kind {
        document::FieldKind::PhaseField => FieldKind::PhaseField(given.crack),
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
    let parts = has_field.unwrap_or(default.parts);
    let initial = given.initial.unwrap_or(default.initial);
    let coupling = given.coupling.unwrap_or_default();
    if coupling == FieldCoupling::Full && matches!(kind, FieldKind::PhaseField(_)) {
        reader.warn(format!(
            "{}: a phase field in full coupling may stay on a state without a crack that is no longer stable, above the strength: compare the peak with that of \"staggered\"",
            place.key("coupling")
        ));
    }
    let umatht = given.umatht.clone().unwrap_or_default();
    let transfer = HeatTransfer {
        props: umatht.props.unwrap_or_default(),
        density: umatht.density.map_or(0.0, |density| density.0),
    };
    Some(ScalarField {
        kind,
        parts,
        conductivity,
        capacity,
        initial,
        has_generation: default.has_generation,
        transfer: Some(transfer),
        fixed,
        fluxes,
        coupling,
        tolerance,
    })
}

/// Returns a parameter of a law that its library names.
fn parameter(law: &PluginLaw, name: &str) -> Option<f64> {
    let place = law.law.as_ref()?.parameters.iter().position(|parameter| parameter.name == name)?;
    law.props.get(place).copied()
}

/// The cracks of a law with a phase field.
fn surface(law: &PluginLaw) -> Option<CrackSurface> {
    Some(CrackSurface { fracture_energy: parameter(law, "G_f")?, length: parameter(law, "l")? })
}

/// Returns whether a law may return RPL: shipped laws do not, except those with a phase field.
pub fn may_have_source(law: &PluginLaw) -> bool {
    !is_shipped(law.library.path()) || surface(law).is_some()
}

/// Decides which routines of heat are called: those that the case names, or those that the libraries of the parts have.
pub fn with_routines(reader: &mut Reader<'_>, case: &PulloutCase, field: &mut ScalarField, laws: &[PluginLaw]) {
    let root = Place::root().key("field");
    let place = root.key("routines");
    let Some(given) = &case.field else { return };
    let libraries = || laws.iter().zip(&field.parts).filter(|(_, has_field)| **has_field).map(|(law, _)| &law.library);
    let in_library =
        |library: &Library, routine: HeatRoutine| library.routines().iter().any(|one| one.symbol == symbol(routine));
    let named: Option<Vec<HeatRoutine>> = given.routines.as_ref().map(|named| {
        let there = named.iter().enumerate().filter(|&(index, &routine)| {
            let is_there = libraries().any(|library| in_library(library, routine));
            if !is_there {
                let name = symbol(routine).to_uppercase();
                reader.problem(&place.index(index), format!("no library of its parts has {name}"));
            }
            is_there
        });
        there.map(|(_, &routine)| routine).collect()
    });
    let is_called = |routine: HeatRoutine| {
        let has = libraries().any(|library| in_library(library, routine));
        named.as_ref().map_or(has, |named| named.contains(&routine))
    };
    let [has_generation, has_transfer] = [HeatRoutine::Hetval, HeatRoutine::Umatht].map(is_called);
    let has_both = |library: &&Library| {
        [HeatRoutine::Hetval, HeatRoutine::Umatht].into_iter().all(|routine| in_library(library, routine))
    };
    if has_generation
        && has_transfer
        && let Some(library) = libraries().find(has_both)
    {
        let library = library.path().display();
        let message = format!("name one: {library} has HETVAL and UMATHT, which exclude each other, as in ABAQUS");
        reader.problem(&place, message);
    }
    if !has_transfer {
        if given.umatht.is_some() {
            reader.warn_no_effect(&root.key("umatht"), "no UMATHT is called");
        }
        field.transfer = None;
    } else if libraries().all(|library| in_library(library, HeatRoutine::Umatht)) {
        for (key, is_given) in [("conductivity", given.conductivity.is_some()), ("capacity", given.capacity.is_some())]
        {
            if is_given {
                let advice = "UMATHT determines what flows and what is stored; \"umatht\" has its props and density";
                reader.warn_no_effect(&root.key(key), advice);
            }
        }
    }
    field.has_generation = has_generation;
}

/// The plain symbol of a routine, as [`umat_abi::host::Routine`] has it.
fn symbol(routine: HeatRoutine) -> &'static str {
    match routine {
        HeatRoutine::Hetval => "hetval",
        HeatRoutine::Umatht => "umatht",
    }
}

/// Warns of a temperature of the case that no law is given, or that changes nothing.
pub fn report_temperature(
    reader: &mut Reader<'_>,
    case: &PulloutCase,
    fields: &Fields,
    field: Option<&ScalarField>,
    [laws, of_contact]: [&[&Plugin]; 2],
) {
    let changes = fields.ends.iter().any(|end| end.temperature != fields.initial.temperature);
    let of_parts = laws.iter().enumerate().filter(|(part, _)| field.is_none_or(|field| !field.parts[*part]));
    let without_field: Vec<&Plugin> = of_parts.map(|(_, law)| *law).chain(of_contact.iter().copied()).collect();
    let reason = match (field, plugin::without_expansion(without_field.iter().copied())) {
        // contact is given the temperature of the case, but the shipped laws of it do not read it
        (Some(field), None) if without_field.is_empty() => Some(reason_of_field(field)),
        (Some(field), Some(_)) if without_field.len() == of_contact.len() => Some(reason_of_field(field)),
        (_, reason) => reason.filter(|_| changes),
    };
    if let Some(reason) = reason.filter(|_| changes || case.course.temperature.is_some()) {
        reader.warn_no_effect(&Place::root().key("temperature"), reason);
    }
}

/// Why the temperature of a case has no effect on parts with a field.
fn reason_of_field(field: &ScalarField) -> String {
    let reason = if field.is_phase_field() {
        "all parts have the phase field in place of a temperature"
    } else {
        "all parts have the temperature of \"field\", which starts at its \"initial\"; \"initial_temperature\" of an \
         \"expansion\" is the temperature without thermal strain, if that is another one"
    };
    reason.to_owned()
}

fn drive(drives: &mut Drives, name: Option<&str>, place: &Place) -> Option<usize> {
    name.map(|name| drives.followed(name, &place.key("drive")))
}

/// Whether each part has the field; `None`: there is no field, or the mesh is not known. In a specimen the cover has it as the matrix, whose law is its own, and
/// a phase field is that of the matrix: nothing would hold it in the fibres.
pub fn parts(reader: &mut Reader<'_>, case: &PulloutCase, scene: KnownMesh<'_>) -> Option<Vec<bool>> {
    let given = case.field.as_ref()?;
    let is_specimen = matches!(case.mesh, MeshSource::Specimen(_));
    let place = Place::root().key("field").key("parts");
    let parts = scene.mesh?.parts();
    let has_matrix = is_specimen && parts.iter().any(|part| part.name == MATRIX);
    let is_of_matrix = has_matrix && matches!(given.kind, document::FieldKind::PhaseField);
    let Some(names) = given.parts.clone().or_else(|| is_of_matrix.then(|| vec![MATRIX.to_owned()])) else {
        return Some(vec![true; parts.len()]);
    };
    let name_of = |part: &'_ str| -> String {
        if is_specimen { called(part, |name| names.iter().any(|one| one == name)).to_owned() } else { part.to_owned() }
    };
    for (index, name) in names.iter().enumerate() {
        if !parts.iter().any(|part| name_of(&part.name) == *name) {
            let known: Vec<&str> = parts.iter().map(|part| part.name.as_str()).collect();
            let message = format!("the mesh has no part '{name}'{}", hint(name, &known));
            reader.problem(&place.index(index), message);
        }
    }
    if names.is_empty() {
        reader.problem(&place, "names no part: leave it out for all parts");
    }
    Some(parts.iter().map(|part| names.contains(&name_of(&part.name))).collect())
}

/// Gives a phase field the cracks that its laws have, where the case does not say; a warning where the mesh is too coarse for them.
pub fn with_cracks_of(
    reader: &mut Reader<'_>,
    field: &mut ScalarField,
    laws: &[PluginLaw],
    lengths: impl Fn(usize) -> f64,
) {
    let FieldKind::PhaseField(crack) = &mut field.kind else { return };
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
