//! The plugin of a case: found, loaded, its law chosen, its parameters filled in and checked.

mod frame;

pub use frame::{begin_at, frame_from_json};

use crate::concrete;
use crate::document::{CalledAs, ConcreteStrength, EntryPoint, Material, Positive, PropValue, Props, Tangent};
use crate::host_normal;
use crate::problem::{Place, Problem, hint, nearest};
use crate::props;
use crate::reader::Reader;
use fe_core::model::NormalLaw;
use pullout_run::isolation::{is_shipped, worker};
use pullout_run::program::Mode;
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use umat_abi::host::{self, Found, LawDescription, Library, LoadError, Manner, Plugin, TangentSource, Validation};
use umat_abi::metadata::{kinds, stress_states};

/// Penalty of a hard normal law, MPa/mm, that this host fills in where the law leaves it to the host: about 100
/// times the elastic stiffness of a bond (chapter 8: 950 MPa/mm).
pub const NORMAL_PENALTY: f64 = 1e5;
/// Tangential penalty of laws that cannot derive their own, MPa/mm: about 10 times a bond's elastic stiffness.
pub const TANGENTIAL_PENALTY: f64 = 1e4;

/// Name of the library that contains all shipped laws; its folder is where they are looked for.
pub const ALL_LAWS: &str = "pullout_laws";

/// Use that the case makes of the plugin.
#[derive(Clone, Debug)]
pub struct Use {
    /// Level at which the plugin is called.
    pub level: Level,
    /// The entry point that is called.
    pub entry: EntryPoint,
    /// The mode of a material point, if it is known, and where the case says so.
    pub mode: Option<(Mode, Place)>,
    /// CELENT.
    pub length: Length,
    /// The host's normal law that goes with FRIC, if it is known, and its place in the case.
    pub normal: Option<(NormalLaw, Place)>,
}

/// Level at which a plugin is called: a point by itself, or a specimen.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Level {
    /// The point that the case is about.
    Point,
    /// A part of a specimen, or the contact between parts.
    Specimen,
}

/// The characteristic lengths that a law meets.
#[derive(Clone, Debug, PartialEq)]
pub enum Length {
    /// The value is invalid, which has already been reported, or no length is known here.
    Unknown,
    /// The case names none.
    NotGiven,
    /// As the case says, mm.
    Given(f64),
    /// Extremes of the elements of a part: index of the element, length in mm.
    OfElements(Vec<(usize, f64)>),
}

impl Length {
    /// Returns the length that the case of a point gives.
    pub fn of(given: Option<Positive>) -> Self {
        given.map_or(Self::NotGiven, |length| Self::Given(length.0))
    }

    /// The one length that is known, mm.
    pub fn given(&self) -> Option<f64> {
        if let Self::Given(length) = self { Some(*length) } else { None }
    }
}

/// Returns the entry point of a contact law that a material names, UINTER by default; `message`: UMAT is none.
pub fn contact_entry(reader: &mut Reader<'_>, given: Option<EntryPoint>, place: &Place, message: &str) -> EntryPoint {
    if given == Some(EntryPoint::Umat) {
        reader.problem(&place.key("entry"), message);
    }
    given.filter(|entry| *entry != EntryPoint::Umat).unwrap_or(EntryPoint::Uinter)
}

/// Loads and checks; `None` with problems if there is no plugin or its number of states is unknown.
pub fn resolve(reader: &mut Reader<'_>, material: &Material, place: &Place, purpose: Use) -> Option<Plugin> {
    let place_of_plugin = place.key("plugin");
    if reader.is_untrusted && material.symbol.is_some() {
        reader.problem(&place.key("symbol"), "chooses what is called in a library, which --untrusted does not allow");
        return None;
    }
    let path = locate(reader, &material.plugin, &place_of_plugin)?;
    let mut library = open(reader, &path, place_of_plugin.clone())?;
    if material.thread_safe.is_some() && library.is_thread_safe() {
        reader.warn_no_effect(&place.key("thread_safe"), "the library says itself that several threads may call it");
    } else if material.thread_safe == Some(true) {
        // SAFETY: the case vouches for it.
        library = unsafe { library.thread_safe() };
    }
    if material.call_time_limit_s.is_some() && material.isolate != Some(true) && !worker::is_this_process() {
        let reason = "the plugin runs in the program's own process; \"isolate\": true gives it one of its own";
        reader.warn_no_effect(&place.key("call_time_limit_s"), reason);
    }
    let law = choose_law(reader, &library, material, place)?;
    let manner = manner(reader, material, place, &purpose);
    let frame = frame::of(reader, material, place, &purpose);
    let usable = match &law {
        Some(law) => check_kind(reader, law, &place_of_plugin, &purpose, manner),
        None => true,
    };
    if usable {
        check_symbol(reader, &library, material, place, purpose.entry);
    }
    let name = law.as_ref().map_or_else(|| host::library_name(&path), |law| law.name.clone());
    let nstatv = nstatv(reader, law.as_ref(), material, place)?;
    let props = properties(reader, law.as_ref(), material, place, &purpose);
    Some(Plugin {
        cmname: material.cmname.clone().unwrap_or_else(|| name.to_uppercase()),
        library,
        law,
        name,
        symbol: material.symbol.clone(),
        props: props.unwrap_or_default(),
        nstatv,
        manner,
        frame,
    })
}

/// Returns why a change of temperature changes nothing, where that is known: these laws are the program's own, which do not read it,
/// and none of their materials expands.
pub fn without_expansion<'p>(plugins: impl Iterator<Item = &'p Plugin> + Clone) -> Option<String> {
    let is_known = |plugin: &Plugin| {
        let expands = plugin.frame.as_ref().is_some_and(|frame| frame.expansion.is_some());
        !expands && is_shipped(plugin.library.path())
    };
    let mut names: Vec<&str> = plugins.clone().map(|plugin| plugin.name.as_str()).collect();
    names.dedup();
    (!names.is_empty() && plugins.clone().all(is_known)).then(|| {
        format!(
            "{} does not depend on the temperature; \"expansion\" of the material gives it thermal strain",
            names.join(", ")
        )
    })
}

/// Warns of what the routines around a law do that is not obvious: whether SDVINI and SIGINI are called where the case gives
/// states and stress, and which are not called at all.
pub fn report_initial_values(reader: &mut Reader<'_>, library: &Library, given: [bool; 2]) {
    let [states_given, stress_given] = given;
    for routine in library.routines() {
        let what = match routine.symbol {
            _ if !routine.is_called => "is not called by pullout: anything that the law expects from it is missing",
            "sdvini" if states_given => "is not called: the case gives the initial states",
            "sigini" if stress_given => "is not called: the case gives the initial stress",
            "sigini" => "sets the initial stress",
            _ => continue,
        };
        let warning = format!("{}: its {} {what}", library.path().display(), routine.name());
        reader.warn(warning);
    }
}

/// Warns of routines of heat in a library that are not called where the case is as it is: HETVAL, UMATHT; `reasons`: why not.
pub fn report_heat_routines(reader: &mut Reader<'_>, library: &Library, reasons: [(&str, Option<&str>); 2]) {
    for (symbol, reason) in reasons {
        let routine = library.routines().iter().find(|routine| routine.symbol == symbol);
        if let (Some(routine), Some(reason)) = (routine, reason) {
            let warning = format!("{}: its {} is not called: {reason}", library.path().display(), routine.name());
            reader.warn(warning);
        }
    }
}

/// Loads a library, each file once in a case.
fn open(reader: &mut Reader<'_>, path: &Path, place: Place) -> Option<Library> {
    let file = host::real_path(path);
    if let Some(library) = reader.libraries.get(&file) {
        return Some(library.clone());
    }
    let library = pullout_run::isolation::load(path)
        .map_err(|error| reader.problems.push(Problem::plugin(place, error.to_string())))
        .ok()?;
    if library.changes_floating_point() {
        reader.warn(format!(
            "{}: loading it switched the processor's floating-point modes (flush to zero); they were restored",
            path.display()
        ));
    }
    reader.libraries.insert(file, library.clone());
    Some(library)
}

/// The library's file: a path relative to the case file, or a name on the search path.
fn locate(reader: &mut Reader<'_>, plugin: &str, place: &Place) -> Option<PathBuf> {
    if host::names_a_file(plugin) {
        if reader.is_untrusted {
            reader.problem(place, "is a file: --untrusted allows plugins of the search path, by their names");
            return None;
        }
        let path = host::library_path(reader.folder, plugin);
        if path.is_file() {
            let library = pullout_run::sources::library_of(path);
            return library.map_err(|words| reader.problems.push(Problem::plugin(place.clone(), words))).ok();
        }
        let message = format!("there is no library file {} (a path is relative to the case file)", path.display());
        reader.problems.push(Problem::plugin(place.clone(), message));
        return None;
    }
    let folders = host::search_paths(reader.plugin_paths);
    if let Some(found) = Found::by_name(plugin, &folders) {
        return Some(found.path);
    }
    reader.problems.push(Problem::plugin(place.clone(), not_found(plugin, &folders)));
    None
}

/// Says that no folder has a plugin of this name, and what to do.
pub fn not_found(plugin: &str, folders: &[PathBuf]) -> String {
    let names: Vec<String> = Found::all(folders).into_iter().map(|found| found.name).collect();
    let near = nearest(plugin, &names).map_or_else(String::new, |name| format!("; nearest name there: '{name}'"));
    let searched: Vec<String> = folders.iter().map(|folder| folder.display().to_string()).collect();
    format!("no plugin '{plugin}' was found; searched: {}{near}; {}", searched.join(", "), where_to_look(folders))
}

/// Returns how to name folders of plugins, and how to get the program's own laws if they are in none of these folders.
pub fn where_to_look(folders: &[PathBuf]) -> String {
    let other = "--plugin-path DIR or the environment variable PULLOUT_PLUGIN_PATH names other folders";
    match Found::by_name(ALL_LAWS, folders) {
        Some(_) => other.to_owned(),
        None => format!(
            "{other}; none of these folders has pullout's own laws: `cargo xtask install --prefix DIR`, run in the source folder, installs pullout and its laws together"
        ),
    }
}

/// Chooses the law that CMNAME names; `Some(None)` for a UMAT without metadata.
fn choose_law(
    reader: &mut Reader<'_>,
    library: &Library,
    material: &Material,
    place: &Place,
) -> Option<Option<LawDescription>> {
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
    let law = LawDescription::named(laws, cmname);
    if law.is_none() {
        let message = format!("'{cmname}' begins with the name of no law of the library{}", hint(cmname, names));
        reader.problem(&place.key("cmname"), message);
        return None;
    }
    Some(law.cloned())
}

/// Returns how the UMAT is called, as the case says.
fn manner(reader: &mut Reader<'_>, material: &Material, place: &Place, purpose: &Use) -> Manner {
    let keys = [("as", material.components.is_some()), ("tangent", material.tangent.is_some())];
    if purpose.entry != EntryPoint::Umat {
        for (key, _) in keys.iter().filter(|(_, given)| *given) {
            reader.problem(&place.key(key), "is for the entry point umat alone");
        }
    }
    match (&purpose.mode, material.components) {
        (Some((Mode::ThreeD, _)), Some(CalledAs::Plane)) => {
            reader.problem(&place.key("as"), "mode 3d has all six components: leave it out");
        }
        (Some((mode, _)), Some(_)) if mode.is_of_line() => {
            let message = format!(
                "mode {} is not a plane mode: leave this entry out, or use mode 3d for a law with six components",
                mode.name()
            );
            reader.problem(&place.key("as"), message);
        }
        _ => {}
    }
    Manner {
        as_three_d: material.components.map(|components| components == CalledAs::ThreeD),
        tangent: material.tangent.map(|tangent| match tangent {
            Tangent::Reported => TangentSource::Reported,
            Tangent::Numerical => TangentSource::Numerical,
            Tangent::Compare => TangentSource::Compared,
        }),
    }
}

/// Returns whether the law has the entry point and the mode.
fn check_kind(reader: &mut Reader<'_>, law: &LawDescription, place: &Place, purpose: &Use, manner: Manner) -> bool {
    let of_specimen = purpose.level == Level::Specimen;
    let solid =
        if of_specimen { "it is a law of a part" } else { "it is a law of a material point; use kind \"point\"" };
    let contact =
        if of_specimen { "it is a law of contact" } else { "it is a law of a contact point; use kind \"interface\"" };
    let (bit, what, advice) = match purpose.entry {
        EntryPoint::Umat => (kinds::UMAT, "UMAT", contact),
        EntryPoint::Uinter if law.kinds & kinds::FRIC != 0 => (kinds::UINTER, "UINTER", "set \"entry\": \"fric\""),
        EntryPoint::Fric if law.kinds & kinds::UINTER != 0 => (kinds::FRIC, "FRIC", "set \"entry\": \"uinter\""),
        EntryPoint::Uinter => (kinds::UINTER, "UINTER", solid),
        EntryPoint::Fric => (kinds::FRIC, "FRIC", solid),
    };
    if law.kinds & bit == 0 {
        reader.problem(place, format!("{} has no {what}: {advice}", law.name));
        return false;
    }
    if let Some((mode, place_of_mode)) = &purpose.mode
        && law.stress_states & state_bit(*mode) == 0
        && !manner.has_six(law, mode.stress_state())
    {
        let modes = [Mode::ThreeD, Mode::PlaneStrain, Mode::Axisymmetric, Mode::PlaneStress];
        let supported: Vec<&str> =
            modes.into_iter().filter(|mode| law.stress_states & state_bit(*mode) != 0).map(Mode::name).collect();
        let message =
            format!("{} does not support mode {}; supported: {}", law.name, mode.name(), supported.join(", "));
        reader.problem(place_of_mode, message);
    }
    true
}

fn state_bit(mode: Mode) -> u32 {
    match mode {
        Mode::ThreeD => stress_states::THREE_D,
        Mode::PlaneStrain => stress_states::PLANE_STRAIN,
        Mode::Axisymmetric => stress_states::AXISYMMETRIC,
        Mode::PlaneStress => stress_states::PLANE_STRESS,
        Mode::OneD | Mode::Beam => 0,
    }
}

fn check_symbol(reader: &mut Reader<'_>, library: &Library, material: &Material, place: &Place, entry: EntryPoint) {
    let symbol = material.symbol.as_deref();
    let found: Result<(), LoadError> = match entry {
        EntryPoint::Umat => library.umat(symbol).map(|_| ()),
        EntryPoint::Uinter => library.uinter(symbol).map(|_| ()),
        EntryPoint::Fric => library.fric(symbol).map(|_| ()),
    };
    if let Err(error) = found {
        let place = place.key(if symbol.is_some() { "symbol" } else { "plugin" });
        reader.problems.push(Problem::plugin(place, error.to_string()));
    }
}

fn nstatv(reader: &mut Reader<'_>, law: Option<&LawDescription>, material: &Material, place: &Place) -> Option<usize> {
    let given = material.nstatv.map(|n| n.0);
    let place = place.key("nstatv");
    let Some(LawDescription { name, states, .. }) = law else {
        if given.is_none() {
            let message = "is missing: the library describes no law (it has no metadata), so the number of its state \
                           variables must be given";
            reader.problem(&place, message);
        }
        return given;
    };
    let needed = states.len();
    match given {
        Some(given) if given < needed => {
            reader.problem(&place, format!("{name} needs {needed} state variables, {given} given"));
        }
        Some(given) if given > needed => {
            let reason = format!("{name} has {needed} state variables; the others stay as they are");
            reader.warn_no_effect(&place, reason);
        }
        _ => {}
    }
    Some(given.unwrap_or(needed).max(needed))
}

/// The props of a law, completed by what follows from the class of a concrete.
fn with_concrete(
    reader: &mut Reader<'_>,
    law: Option<&LawDescription>,
    props: Option<&Props>,
    given: &ConcreteStrength,
    place: &Place,
) -> Option<Props> {
    let concrete = concrete::resolve(reader, given, &place.key("concrete"))?;
    let mut named = match props {
        None => BTreeMap::new(),
        Some(Props::Named(named)) => named.clone(),
        Some(Props::List(_)) => {
            reader.problem(
                &place.key("props"),
                "is a list, which \"concrete\" cannot complete: give the parameters by name",
            );
            return None;
        }
    };
    let own = law.map(|law| props::split(law).0).unwrap_or_default();
    let has = |name: &str| own.iter().any(|parameter| parameter.name == name);
    let own_value = |name: &str| match named.get(name) {
        Some(PropValue::Number(value)) => Some(*value),
        _ => None,
    };
    let values = concrete::parameters(&concrete, ["E", "nu"].map(own_value));
    let values = reader.without_problem(values, &place.key("props"))?;
    // E and ν alone are no concrete
    if !["f_t", "A_t"].into_iter().any(has) {
        let name = law.map_or("the library", |law| &law.name);
        let message = format!("{name} has no strength that follows from a class: give its parameters in \"props\"");
        reader.problem(&place.key("concrete"), message);
        return None;
    }
    for (name, value) in values.into_iter().filter(|(name, _)| has(name)) {
        named.entry(name).or_insert(PropValue::Number(value));
    }
    Some(Props::Named(named))
}

fn properties(
    reader: &mut Reader<'_>,
    law: Option<&LawDescription>,
    material: &Material,
    place: &Place,
    purpose: &Use,
) -> Option<Vec<f64>> {
    let of_concrete = match &material.concrete {
        Some(given) => Some(with_concrete(reader, law, material.props.as_ref(), given, place)?),
        None => None,
    };
    let given = of_concrete.as_ref().or(material.props.as_ref());
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
    let beside = purpose.normal.as_ref().and_then(|(normal, place_of_normal)| {
        host_normal::beside(reader, law, given, *normal, [&place, place_of_normal])
    });
    let given = beside.as_ref().or(given);
    match props::resolve(law, given, &place) {
        Ok(values) => {
            let filled = match purpose.entry {
                EntryPoint::Umat => values.clone(),
                // FRIC has no normal law
                entry @ (EntryPoint::Uinter | EntryPoint::Fric) => law.with_penalties(
                    &values,
                    (entry == EntryPoint::Uinter).then_some(NORMAL_PENALTY),
                    TANGENTIAL_PENALTY,
                ),
            };
            validate(reader, law, &filled, &place, &purpose.length);
            for (parameter, value) in props::in_order(law).zip(&values) {
                if let Some(range) = parameter.missed_range(*value) {
                    reader.warn_unusual(place.key(&parameter.name).in_words(), *value, &parameter.unit, range);
                }
            }
            reader.note_defaults(&place, &props::defaults(law, given));
            if purpose.level == Level::Specimen {
                // the contact pair fills them in from the bodies' stiffness
                return Some(values);
            }
            for (k, (value, _)) in filled.iter().zip(&values).enumerate().filter(|(_, (new, old))| new != old) {
                let name = &law.parameters[k].name;
                reader.warn(format!(
                    "material.props.{name} = 0 leaves the value to the host: {value} MPa/mm is used (if the law needs it)"
                ));
            }
            Some(filled)
        }
        Err(problems) => {
            reader.problems.extend(problems);
            None
        }
    }
}

/// The law's own opinion of its parameters, and of them at each characteristic length.
fn validate(reader: &mut Reader<'_>, law: &LawDescription, values: &[f64], place: &Place, length: &Length) {
    let given = if let Length::Given(length) = length { Some(*length) } else { None };
    match law.validate(values, given) {
        Validation::Valid => {}
        Validation::Invalid(message) => return reader.problem(place, format!("{}: {message}", law.name)),
        Validation::NeedsCharacteristicLength(message) if matches!(length, Length::NotGiven) => {
            let place = Place::root().key("characteristic_length");
            return reader.problem(&place, format!("is missing: {}: {message}", law.name));
        }
        Validation::NeedsCharacteristicLength(_) => {}
    }
    let Length::OfElements(elements) = length else { return };
    for &(element, length) in elements {
        if let Validation::Invalid(message) = law.validate(values, Some(length)) {
            let message = format!("{}: in element {}, of length {length:.4} mm: {message}", law.name, element + 1);
            return reader.problem(place, message);
        }
    }
}
