//! `pullout plugin list | info | check | build`.

mod build;
mod check;

use super::{DONE, Isolation, Refusal, complain, isolated, say};
use clap::Subcommand;
use pullout_case::CaseProblem;
use pullout_check::description;
use pullout_run::isolation::prints::Prints;
use pullout_run::isolation::{self, Need, Work};
use pullout_run::sources;
use serde::{Deserialize, Serialize};
use serde_json::{Value, json};
use std::fmt::Write;
use std::path::{Path, PathBuf};
use umat_abi::host::{Found, Library, library_path, names_a_file, search_paths};
use umat_abi::metadata::PLUGIN_SYMBOL;

pub(super) use check::{Checks, examine};

#[derive(Debug, Subcommand)]
pub(super) enum Action {
    /// List the plugins, their laws and versions, and the folders searched.
    List {
        /// Print as JSON.
        #[arg(long)]
        json: bool,
        /// Search this folder for plugins first (may be repeated).
        #[arg(long = "plugin-path", value_name = "DIR")]
        plugin_paths: Vec<PathBuf>,
    },
    /// Print the parameters (unit, default, bounds), state variables and modes of a plugin.
    Info {
        /// A law's name, or a shared library.
        #[arg(value_name = "NAME|FILE.so")]
        plugin: String,
        /// Print ABAQUS input: keywords, constants in order, state variables.
        #[arg(long)]
        abaqus: bool,
        /// Print JSON.
        #[arg(long, conflicts_with = "abaqus")]
        json: bool,
        /// Search this folder for plugins first (may be repeated).
        #[arg(long = "plugin-path", value_name = "DIR")]
        plugin_paths: Vec<PathBuf>,
        #[command(flatten)]
        isolation: Isolation,
    },
    /// Check a plugin's tangent, energies, memory and metadata, along the path of a case if you give one. Exit code 1:
    /// a check failed. Exit code 4: not tested, because the law has state variables but was linear wherever it was
    /// checked.
    Check(check::CheckArguments),
    /// Compile a UMAT in Fortran, C or C++ to a library, with the flags it needs.
    Build(build::BuildArguments),
}

/// Time limit of loading a library, or of one call, unless a case sets another, s. It is short, since the user waits.
const TIME_LIMIT: f64 = 5.0;

/// Executes the command.
pub(super) fn act(action: &Action) -> Result<u8, Refusal> {
    match action {
        Action::List { json, plugin_paths } => Ok(list(plugin_paths, *json)),
        Action::Info { plugin, abaqus, json, plugin_paths, .. } => {
            let form = match (abaqus, json) {
                (true, _) => Form::Abaqus,
                (_, true) => Form::Json,
                _ => Form::Text,
            };
            Description { library: file_of(plugin, plugin_paths)?, form }.print()
        }
        Action::Check(arguments) => check::run(arguments),
        Action::Build(arguments) => build::run(arguments),
    }
}

impl Action {
    /// Returns the process in which plugins are called.
    pub(super) fn isolation(&self) -> Isolation {
        match self {
            Self::Info { isolation, .. } => *isolation,
            Self::Check(arguments) => arguments.isolation,
            Self::List { .. } | Self::Build(_) => Isolation::default(),
        }
    }
}

/// Form in which a library is described.
#[derive(Clone, Copy, Debug, Serialize, Deserialize)]
enum Form {
    Text,
    Json,
    Abaqus,
}

/// What `plugin info` prints of a library.
#[derive(Debug, Serialize, Deserialize)]
pub(super) struct Description {
    #[serde(with = "isolation::path")]
    library: PathBuf,
    form: Form,
}

impl Work for Description {
    const NAME: &'static str = "info";
}

impl Description {
    /// Prints it, here or, if the library may not run here, in another process.
    pub(super) fn print(&self) -> Result<u8, Refusal> {
        if let Some(need) = Need::of_library(&self.library, TIME_LIMIT) {
            return Ok(isolated::carry_out(self, &need, &self.library, false));
        }
        // what it prints in thousands of calls is nobody's
        let _prints = Prints::discard();
        let library = isolation::load(&self.library).map_err(no_plugin)?;
        match self.form {
            Form::Text => info(&library),
            Form::Json => info_as_json(&library),
            Form::Abaqus => abaqus_input(&library),
        }
    }
}

/// Makes the refusal of a library that cannot be loaded, or is none.
fn no_plugin(message: impl std::fmt::Display) -> Refusal {
    CaseProblem::library(message.to_string()).into()
}

/// Returns the file of a library, given by its law's name or by its path.
fn file_of(name: &str, plugin_paths: &[PathBuf]) -> Result<PathBuf, Refusal> {
    if names_a_file(name) {
        let file = library_path(Path::new(""), name);
        return if file.is_file() { sources::library_of(file).map_err(no_plugin) } else { Ok(file) };
    }
    let paths = search_paths(plugin_paths);
    let not_found = || pullout_case::not_found(name, &paths) + "; `pullout plugin list` lists all laws";
    Found::by_name(name, &paths).map(|found| found.path).ok_or_else(|| no_plugin(not_found()))
}

fn list(plugin_paths: &[PathBuf], json: bool) -> u8 {
    let paths = search_paths(plugin_paths);
    let mut rows = Vec::new();
    for Found { path, .. } in Found::all(&paths) {
        let rows_or_error = match pullout_check::build::defines(&path, PLUGIN_SYMBOL) {
            Ok(true) => rows_of(&path),
            // other libraries (compiler plugins next to the executable) are not even loaded
            Ok(false) => Ok(Vec::new()),
            Err(error) => Err(format!("{}: cannot be read as a library: {error}", path.display())),
        };
        match rows_or_error {
            Ok(found) => rows.extend(
                found
                    .into_iter()
                    .map(|[law, version, entry_points]| [law, version, entry_points, path.display().to_string()]),
            ),
            Err(message) => complain(message),
        }
    }
    if json {
        let law = |[name, version, entry_points, library]: &[String; 4]| {
            let entry_points: Vec<&str> = entry_points.split(' ').collect();
            json!({ "name": name, "version": version, "entry_points": entry_points, "library": library })
        };
        let folder = |path: &PathBuf| json!({ "folder": path, "exists": path.is_dir() });
        let laws: Vec<Value> = rows.iter().map(law).collect();
        let searched: Vec<Value> = paths.iter().map(folder).collect();
        say(&format!("{:#}\n", json!({ "laws": laws, "searched": searched })));
        return DONE;
    }
    let is_empty = rows.is_empty();
    rows.insert(0, ["LAW", "VERSION", "ENTRY POINTS", "LIBRARY"].map(String::from));
    let mut text = description::table(&rows);
    text.push_str("\nSearched:\n");
    for path in &paths {
        let _ = writeln!(text, "  {}{}", path.display(), if path.is_dir() { "" } else { " (does not exist)" });
    }
    if is_empty {
        let _ = writeln!(text, "No law was found; {}", pullout_case::where_to_look(&paths));
    }
    say(&text);
    DONE
}

fn info(library: &Library) -> Result<u8, Refusal> {
    let nothing = || no_plugin(format!("{}: has neither metadata nor an entry point", library.path().display()));
    say(&description::of_library(library).ok_or_else(nothing)?);
    Ok(DONE)
}

fn info_as_json(library: &Library) -> Result<u8, Refusal> {
    say(&format!("{:#}\n", description::as_json(library)));
    Ok(DONE)
}

/// Returns name, version and entry points of the laws of a library, which is loaded into this process only if it may run here.
fn rows_of(library: &Path) -> Result<Vec<[String; 3]>, String> {
    let described = description::of_file(library, TIME_LIMIT)?;
    let text = |value: &Value| value.as_str().unwrap_or_default().to_owned();
    let row = |law: &Value| {
        let entry_points: Vec<String> = law["entry_points"].as_array().into_iter().flatten().map(text).collect();
        [text(&law["name"]), text(&law["version"]), entry_points.join(" ")]
    };
    Ok(described["laws"].as_array().into_iter().flatten().map(row).collect())
}

fn abaqus_input(library: &Library) -> Result<u8, Refusal> {
    if library.laws().is_empty() {
        let message = "has no metadata: the order of its constants is not known";
        return Err(Refusal::input(format!("{}: {message}", library.path().display())));
    }
    let laws: Result<Vec<_>, _> = library.laws().iter().map(pullout_case::abaqus::input).collect();
    say(&laws.map_err(Refusal::input)?.join("**\n"));
    Ok(DONE)
}
