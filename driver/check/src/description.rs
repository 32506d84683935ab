//! Describes plugins: the text that `pullout plugin info` prints.

use pullout_run::isolation::prints::Prints;
use pullout_run::isolation::{self, End, Need, Passage, Watch, Work};
use serde::{Deserialize, Serialize};
use serde_json::{Value, json};
use std::fmt::Write;
use std::path::{Path, PathBuf};
use umat_abi::host::{LawDescription, Library, LoadError, Parameter, Routine, StateDescription, binds_deeply};
use umat_abi::metadata::{flags, kinds, stress_states};

/// Returns what a library has, in lines: each law by its metadata, or the entry points of a library without; the routines
/// around them; where cases call it. `None`: it has neither metadata nor an entry point.
pub fn of_library(library: &Library) -> Option<String> {
    let path = library.path();
    let mut text: String = library.laws().iter().map(|law| of_law(law, path)).collect();
    if text.is_empty() {
        let entry_points = Some(library.entry_points()).filter(|names| !names.is_empty())?;
        let _ = writeln!(
            text,
            "{}: a library without metadata; entry points: {}; a case that uses it gives props, nstatv and, if needed, \
             symbol",
            path.display(),
            entry_points.join(", ")
        );
    }
    Some(text + &routines(library) + place_of(library) + memory())
}

/// Returns rows as lines, with left-aligned columns, two blanks apart.
pub fn table<const N: usize>(rows: &[[String; N]]) -> String {
    let width = |column: usize| rows.iter().map(|row| row[column].chars().count()).max().unwrap_or(0);
    let widths: [usize; N] = std::array::from_fn(width);
    let mut text = String::new();
    for row in rows {
        let line = row.iter().zip(widths).fold(String::new(), |line, (cell, width)| line + &format!("{cell:width$}  "));
        text.push_str(line.trim_end());
        text.push('\n');
    }
    text
}

/// Returns where cases call it.
fn place_of(library: &Library) -> &'static str {
    if isolation::is_shipped(library.path()) {
        "Process: pullout's own; the library was built with pullout\n"
    } else {
        "Process: a separate one, or with --in-process pullout's own\n"
    }
}

/// Says whose memory plugins take, where that changes how they are loaded; nothing otherwise.
fn memory() -> &'static str {
    if !cfg!(target_os = "linux") || binds_deeply() {
        ""
    } else {
        "Memory: not the C library's (LD_PRELOAD of another malloc): names that several libraries define are those of the \
         one that was loaded first\n"
    }
}

/// The routines around the laws, in a line; nothing if there are none.
fn routines(library: &Library) -> String {
    let name =
        |routine: &Routine| routine.name() + if routine.is_called { "" } else { " (not called by this program)" };
    let names: Vec<String> = library.routines().iter().map(name).collect();
    if names.is_empty() { String::new() } else { format!("Other routines: {}\n", names.join(", ")) }
}

/// Returns the parameters, states and claims of a law, followed by an empty line.
fn of_law(law: &LawDescription, path: &Path) -> String {
    let mut text = format!("{} {}: {}\n{}\n", law.name, law.version, law.description, path.display());
    let modes: Vec<_> = match law.kinds & kinds::UMAT {
        0 => vec!["a contact point (NDIR 2 or 3, NFDIR 1 or 2)".to_owned()],
        _ => modes(law).map(|(_, name, components)| format!("{name} ({components})")).collect(),
    };
    let _ = writeln!(text, "Entry points: {}", law.entry_points().join(", "));
    let _ = writeln!(text, "Modes: {}", modes.join(", "));
    let _ = writeln!(text, "Claims: {}", claims(law).collect::<Vec<_>>().join(", "));
    let _ = writeln!(text, "\nPROPS ({}):", law.parameters.len());
    let header = ["#", "name", "unit", "default", "bounds", "usual", "meaning"].map(String::from);
    let rows = law.parameters.iter().enumerate().map(|(k, p)| {
        let default = match p.choices.iter().find(|choice| choice.value == p.default_value) {
            Some(choice) => format!("{} ({})", p.default_value, choice.name),
            None => p.default_value.to_string(),
        };
        let usual = p.typical.map_or(String::new(), |[lower, upper]| format!("{lower} to {upper}"));
        [(k + 1).to_string(), p.name.clone(), p.unit.clone(), default, p.bounds(), usual, p.doc.clone()]
    });
    text.push_str(&table(&std::iter::once(header).chain(rows).collect::<Vec<_>>()));
    if let Some(group) = &law.group {
        let _ = writeln!(
            text,
            "The last {} may be repeated (at least {} times); in JSON \"{}\": [[...], ...]",
            group.size, group.minimum, group.name
        );
    }
    let _ = writeln!(text, "\nSTATEV ({}), all zero in the virgin state:", law.states.len());
    let header = ["#", "name", "unit", "meaning"].map(String::from);
    let rows = law
        .states
        .iter()
        .enumerate()
        .map(|(k, s)| [(k + 1).to_string(), s.name.clone(), s.unit.clone(), s.doc.clone()]);
    text.push_str(&table(&std::iter::once(header).chain(rows).collect::<Vec<_>>()));
    if !law.derived.is_empty() {
        let derived: Vec<_> =
            law.derived.iter().map(|d| format!("{} from {}", d.name, law.states[d.state].name)).collect();
        let _ = writeln!(text, "Derived: {}", derived.join(", "));
    }
    text.push('\n');
    text
}

/// Library that another process is asked to describe.
#[derive(Debug, Serialize, Deserialize)]
pub struct Subject {
    #[serde(with = "isolation::path")]
    library: PathBuf,
}

impl Work for Subject {
    const NAME: &'static str = "describe";
    const IS_HEARD_BY_STARTER: bool = true;
}

impl Subject {
    /// Sends [`as_json`] to the process that asked.
    ///
    /// # Errors
    /// The library cannot be loaded.
    pub fn send(&self) -> Result<(), LoadError> {
        isolation::send(&loaded(&self.library)?);
        Ok(())
    }
}

/// Describes the library of a file as JSON ([`as_json`]), in a process of its own if it may not run here; null: it could not be
/// loaded there, which was said. `time_limit`: of loading it, s.
///
/// # Errors
/// The library cannot be loaded, or ends the process.
pub fn of_file(library: &Path, time_limit: f64) -> Result<Value, String> {
    let Some(need) = Need::of_library(library, time_limit) else {
        return loaded(library).map_err(|error| error.to_string());
    };
    let in_words = |error: std::io::Error| format!("{}: cannot be looked at: {error}", library.display());
    let mut passage = Passage::new(&Subject { library: library.to_owned() }).map_err(in_words)?;
    match isolation::supervise(&mut passage, &Watch::default(), &need).map_err(in_words)? {
        End::Done(_) => Ok(passage.heard().pop().unwrap_or_default()),
        End::Failed(failure) => Err(failure.report.message),
    }
}

fn loaded(library: &Path) -> Result<Value, LoadError> {
    let _prints = Prints::discard();
    Ok(as_json(&isolation::load(library)?))
}

/// Returns what [`of_library`] says, as JSON: `laws` with their parameters and states, `entry_points`, `routines`.
pub fn as_json(library: &Library) -> Value {
    let routine = |routine: &Routine| json!({ "name": routine.name(), "is_called": routine.is_called });
    json!({
        "library": library.path(),
        "is_shipped": isolation::is_shipped(library.path()),
        "entry_points": library.entry_points(),
        "laws": library.laws().iter().map(law_as_json).collect::<Vec<_>>(),
        "routines": library.routines().iter().map(routine).collect::<Vec<_>>(),
    })
}

fn law_as_json(law: &LawDescription) -> Value {
    let parameter = |p: &Parameter| {
        let choices: Vec<_> = p.choices.iter().map(|c| json!({ "value": c.value, "name": c.name })).collect();
        // what is not bounded is null
        json!({
            "name": p.name, "unit": p.unit, "doc": p.doc, "default": p.default_value, "lower": p.lower, "upper": p.upper,
            "usual": p.typical, "choices": choices,
        })
    };
    let state = |s: &StateDescription| json!({ "name": s.name, "unit": s.unit, "doc": s.doc });
    json!({
        "name": law.name,
        "version": law.version,
        "description": law.description,
        "entry_points": law.entry_points(),
        "modes": modes(law).map(|(_, name, _)| name).collect::<Vec<_>>(),
        "claims": claims(law).collect::<Vec<_>>(),
        "parameters": law.parameters.iter().map(parameter).collect::<Vec<_>>(),
        "group": law.group.as_ref().map(|group| json!({ "name": group.name, "size": group.size, "minimum": group.minimum })),
        "states": law.states.iter().map(state).collect::<Vec<_>>(),
    })
}

/// The modes of a law: flag, name in a case, components.
fn modes(law: &LawDescription) -> impl Iterator<Item = (u32, &'static str, &'static str)> + '_ {
    let all = [
        (stress_states::THREE_D, "3d", "NTENS 6"),
        (stress_states::PLANE_STRAIN, "plane_strain", "NTENS 4"),
        (stress_states::AXISYMMETRIC, "axisymmetric", "NTENS 4"),
        (stress_states::PLANE_STRESS, "plane_stress", "NTENS 3"),
    ];
    all.into_iter().filter(|(bit, ..)| law.kinds & kinds::UMAT != 0 && law.stress_states & bit != 0)
}

/// What a law claims of itself.
fn claims(law: &LawDescription) -> impl Iterator<Item = &'static str> + '_ {
    let all = [
        (flags::SYMMETRIC_TANGENT, "symmetric tangent"),
        (flags::THREAD_SAFE, "thread-safe"),
        (flags::USES_CELENT, "uses CELENT"),
        (flags::FINITE_STRAIN, "finite strain"),
        (flags::STRESS_ONLY, "stress-only calls"),
        (flags::PATH_EXACT, "exact for any increment on proportional paths"),
        (flags::ISOTROPIC, "isotropic"),
    ];
    all.into_iter().filter(|(flag, _)| law.has(*flag)).map(|(_, name)| name)
}
