//! The plugin of a case: found, loaded, its law chosen, its parameters filled in and checked.

use super::Reader;
use super::document::{Entry, Material, Props};
use super::problem::{Place, Problem, nearest};
use super::props;
use crate::path::program::{Mode, Plugin};
use std::path::PathBuf;
use umat_abi::host::{self, Found, Law, Library, LoadError, Validation};
use umat_abi::metadata::{kinds, stress_states};

/// Penalty of a hard normal law, MPa/mm, that this host fills in where the law leaves it to the host: about 100
/// times the elastic stiffness of a bond (chapter 8: 950 MPa/mm).
pub const NORMAL_PENALTY: f64 = 1e5;
/// Likewise tangential, for laws that cannot derive their own: about 10 times a bond's elastic stiffness.
pub const TANGENTIAL_PENALTY: f64 = 1e4;

/// What the case does with the plugin.
#[derive(Clone, Copy, Debug)]
pub struct Use {
    /// The entry point that is called.
    pub entry: Entry,
    /// The mode of a point case, if it is known.
    pub mode: Option<Mode>,
    /// CELENT, if it is given; `Err` if it is given wrongly.
    pub characteristic_length: Result<Option<f64>, ()>,
}

/// Loads and checks; `None` with problems if there is no plugin or its number of states is unknown.
pub fn resolve(reader: &mut Reader<'_>, material: &Material, place: &Place, purpose: Use) -> Option<Plugin> {
    if material.isolate == Some(true) {
        reader.warnings.push("material.isolate: plugins run in this process as yet; isolation is not available".into());
    }
    let place_of_plugin = place.key("plugin");
    let path = locate(reader, &material.plugin, &place_of_plugin)?;
    let library = match Library::open(&path) {
        Ok(library) => library,
        Err(error) => {
            reader.problems.push(Problem::plugin(place_of_plugin, error.to_string()));
            return None;
        }
    };
    if library.changes_floating_point() {
        reader.warnings.push(format!(
            "{}: loading it switched the processor's floating-point modes (flush to zero); they were restored",
            path.display()
        ));
    }
    let law = choose_law(reader, &library, material, place)?;
    let usable = match &law {
        Some(law) => check_kind(reader, law, &place_of_plugin, purpose),
        None => true,
    };
    if usable {
        check_symbol(reader, &library, material, place, purpose.entry);
    }
    let stem = path.file_stem().map_or_else(String::new, |stem| stem.to_string_lossy().into_owned());
    let name =
        law.as_ref().map_or_else(|| stem.strip_prefix("lib").unwrap_or(&stem).to_owned(), |law| law.name.clone());
    let nstatv = nstatv(reader, law.as_ref(), material, place)?;
    let props = properties(reader, law.as_ref(), material, place, purpose);
    Some(Plugin {
        cmname: material.cmname.clone().unwrap_or_else(|| name.to_uppercase()),
        library,
        law,
        name,
        symbol: material.symbol.clone(),
        props: props.unwrap_or_default(),
        nstatv,
    })
}

/// The library's file: a path relative to the case file, or a name on the search path.
fn locate(reader: &mut Reader<'_>, plugin: &str, place: &Place) -> Option<PathBuf> {
    if host::names_a_file(plugin) {
        let path = host::library_path(reader.folder, plugin);
        if path.is_file() {
            return Some(path);
        }
        let message = format!("there is no library file {} (a path is relative to the case file)", path.display());
        reader.problems.push(Problem::plugin(place.clone(), message));
        return None;
    }
    let folders = host::search_paths(reader.plugin_paths);
    if let Some(found) = Found::by_name(plugin, &folders) {
        return Some(found.path);
    }
    let names: Vec<String> = Found::all(&folders).into_iter().map(|found| found.name).collect();
    let near = nearest(plugin, &names).map_or_else(String::new, |name| format!("; nearest name there: '{name}'"));
    let folders: Vec<String> = folders.iter().map(|folder| folder.display().to_string()).collect();
    let message = format!("no plugin '{plugin}' was found; searched: {}{near}", folders.join(", "));
    reader.problems.push(Problem::plugin(place.clone(), message));
    None
}

/// `Some(None)`: a plain UMAT. Of several laws, CMNAME chooses.
fn choose_law(reader: &mut Reader<'_>, library: &Library, material: &Material, place: &Place) -> Option<Option<Law>> {
    let laws = library.laws();
    if let [] | [_] = laws {
        return Some(laws.first().cloned());
    }
    let names: Vec<&str> = laws.iter().map(|law| law.name.as_str()).collect();
    let Some(cmname) = &material.cmname else {
        let message = format!("is missing: the library has several laws; name one of {}", names.join(", "));
        reader.problem(&place.key("cmname"), message);
        return None;
    };
    let law = law_of_name(laws, cmname);
    if law.is_none() {
        let message =
            format!("'{cmname}' begins with the name of no law of the library{}", super::problem::hint(cmname, names));
        reader.problem(&place.key("cmname"), message);
        return None;
    }
    Some(law.cloned())
}

/// The law whose name CMNAME begins with, the longest of several; upper and lower case are alike.
pub fn law_of_name<'l>(laws: &'l [Law], cmname: &str) -> Option<&'l Law> {
    let wanted = cmname.trim().to_lowercase();
    laws.iter().filter(|law| wanted.starts_with(&law.name.to_lowercase())).max_by_key(|law| law.name.len())
}

/// Whether the law has the entry point and the mode.
fn check_kind(reader: &mut Reader<'_>, law: &Law, place: &Place, purpose: Use) -> bool {
    let (bit, what, advice) = match purpose.entry {
        Entry::Umat => (kinds::UMAT, "UMAT", "it is a law of a contact point; use kind \"interface\""),
        Entry::Uinter if law.kinds & kinds::FRIC != 0 => (kinds::UINTER, "UINTER", "set \"entry\": \"fric\""),
        Entry::Fric if law.kinds & kinds::UINTER != 0 => (kinds::FRIC, "FRIC", "set \"entry\": \"uinter\""),
        Entry::Uinter => (kinds::UINTER, "UINTER", "it is a law of a material point; use kind \"point\""),
        Entry::Fric => (kinds::FRIC, "FRIC", "it is a law of a material point; use kind \"point\""),
    };
    if law.kinds & bit == 0 {
        reader.problem(place, format!("{} has no {what}: {advice}", law.name));
        return false;
    }
    if let Some(mode) = purpose.mode
        && law.stress_states & state_bit(mode) == 0
    {
        let modes = [Mode::ThreeD, Mode::PlaneStrain, Mode::Axisymmetric, Mode::PlaneStress];
        let supported: Vec<&str> = modes
            .into_iter()
            .filter(|mode| law.stress_states & state_bit(*mode) != 0)
            .map(super::point::mode_name)
            .collect();
        let message = format!(
            "{} does not support mode {}; supported: {}",
            law.name,
            super::point::mode_name(mode),
            supported.join(", ")
        );
        reader.problem(&Place::root().key("mode"), message);
    }
    true
}

fn state_bit(mode: Mode) -> u32 {
    match mode {
        Mode::ThreeD => stress_states::THREE_D,
        Mode::PlaneStrain => stress_states::PLANE_STRAIN,
        Mode::Axisymmetric => stress_states::AXISYMMETRIC,
        Mode::PlaneStress => stress_states::PLANE_STRESS,
    }
}

fn check_symbol(reader: &mut Reader<'_>, library: &Library, material: &Material, place: &Place, entry: Entry) {
    let symbol = material.symbol.as_deref();
    let found: Result<(), LoadError> = match entry {
        Entry::Umat => library.umat(symbol).map(|_| ()),
        Entry::Uinter => library.uinter(symbol).map(|_| ()),
        Entry::Fric => library.fric(symbol).map(|_| ()),
    };
    if let Err(error) = found {
        let place = place.key(if symbol.is_some() { "symbol" } else { "plugin" });
        reader.problems.push(Problem::plugin(place, error.to_string()));
    }
}

fn nstatv(reader: &mut Reader<'_>, law: Option<&Law>, material: &Material, place: &Place) -> Option<usize> {
    let given = material.nstatv.map(|n| usize::try_from(n.0).unwrap_or(usize::MAX));
    match (law.map(|law| (law.states.len(), &law.name)), given) {
        (None, None) => {
            let message = "is missing: the library describes no law (it has no metadata), so the number of its state \
                           variables must be given";
            reader.problem(&place.key("nstatv"), message);
            None
        }
        (Some((needed, name)), Some(given)) if given < needed => {
            reader.problem(&place.key("nstatv"), format!("{name} needs {needed} state variables, {given} given"));
            Some(needed)
        }
        (Some((needed, _)), given) => Some(given.unwrap_or(needed)),
        (None, given) => given,
    }
}

fn properties(
    reader: &mut Reader<'_>,
    law: Option<&Law>,
    material: &Material,
    place: &Place,
    purpose: Use,
) -> Option<Vec<f64>> {
    let place = place.key("props");
    let Some(law) = law else {
        return match &material.props {
            None => Some(Vec::new()),
            Some(Props::List(values)) => Some(values.clone()),
            Some(Props::Named(_)) => {
                let message = "the library describes no parameters (it has no metadata): give an array in PROPS order";
                reader.problem(&place, message);
                None
            }
        };
    };
    match props::resolve(law, material.props.as_ref(), &place) {
        Ok(mut values) => {
            if let Entry::Uinter | Entry::Fric = purpose.entry {
                fill_penalties(reader, law, &mut values, purpose.entry);
            }
            validate(reader, law, &values, &place, purpose);
            Some(values)
        }
        Err(problems) => {
            reader.problems.extend(problems);
            None
        }
    }
}

/// Parameters with a penalty role whose value is 0 are the host's to fill. A tangential one only where the law
/// refuses its 0: others derive it from their own stiffness. FRIC has no normal law.
fn fill_penalties(reader: &mut Reader<'_>, law: &Law, values: &mut [f64], entry: Entry) {
    let zero = |values: &[f64], role: &str| {
        let mut roles = law.parameters.iter().zip(values).map(|(p, value)| p.role == role && *value == 0.0);
        roles.position(|unfilled| unfilled)
    };
    if let (Some(k), Entry::Uinter) = (zero(values, "normal_penalty"), entry) {
        values[k] = NORMAL_PENALTY;
        note_filling(reader, law, k, NORMAL_PENALTY);
    }
    if let Some(k) = zero(values, "tangential_penalty")
        && let Validation::Invalid(_) = law.validate(values, None)
    {
        values[k] = TANGENTIAL_PENALTY;
        if let Validation::Invalid(_) = law.validate(values, None) {
            values[k] = 0.0;
        } else {
            note_filling(reader, law, k, TANGENTIAL_PENALTY);
        }
    }
}

fn note_filling(reader: &mut Reader<'_>, law: &Law, k: usize, value: f64) {
    let name = &law.parameters[k].name;
    reader.warnings.push(format!(
        "material.props.{name} is 0, which leaves it to the host: {value} MPa/mm is used (where the law has a use for it)"
    ));
}

/// The law's own opinion.
fn validate(reader: &mut Reader<'_>, law: &Law, values: &[f64], place: &Place, purpose: Use) {
    match (law.validate(values, purpose.characteristic_length.unwrap_or(None)), purpose.characteristic_length) {
        (Validation::Valid, _) | (Validation::NeedsCharacteristicLength(_), Err(())) => {}
        (Validation::Invalid(message), _) => reader.problem(place, format!("{}: {message}", law.name)),
        (Validation::NeedsCharacteristicLength(message), Ok(_)) => {
            let place = Place::root().key("characteristic_length");
            reader.problem(&place, format!("is missing: {}: {message}", law.name));
        }
    }
}
