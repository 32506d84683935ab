//! `pullout plugin list | info | check | build`.

mod build;
mod check;

use super::{DONE, Isolation, Refusal, complain, isolated, say};
use clap::Subcommand;
use pullout_case::CaseProblem;
use pullout_check::description;
use pullout_run::isolation::prints::Prints;
use pullout_run::isolation::{self, Need};
use pullout_run::sources;
use serde_json::Value;
use std::ffi::OsString;
use std::fmt::Write;
use std::path::{Path, PathBuf};
use umat_abi::host::{Found, Library, library_path, names_a_file, search_paths};
use umat_abi::metadata::PLUGIN_SYMBOL;

pub(super) use check::{Checks, examine};

#[derive(Debug, Subcommand)]
pub(super) enum Action {
    /// Plugins found, their laws and versions, and the folders searched.
    List {
        /// Look here first (may be repeated).
        #[arg(long = "plugin-path", value_name = "DIR")]
        plugin_paths: Vec<PathBuf>,
    },
    /// Parameters (unit, default, bounds), state variables, modes of a plugin.
    Info {
        /// A law's name, or a shared library.
        #[arg(value_name = "NAME|FILE.so")]
        plugin: String,
        /// Print as ABAQUS input: keywords, constants in order, state variables.
        #[arg(long)]
        abaqus: bool,
        /// Print as JSON.
        #[arg(long, conflicts_with = "abaqus")]
        json: bool,
        /// Look here first (may be repeated).
        #[arg(long = "plugin-path", value_name = "DIR")]
        plugin_paths: Vec<PathBuf>,
        #[command(flatten)]
        isolation: Isolation,
    },
    /// Test a plugin against what its metadata claims, around the path of a case; exit code 1 if it fails, 4 if it was
    /// nowhere seen to be nonlinear although it has states that matter.
    Check(check::Arguments),
    /// Compile a UMAT in Fortran, C or C++ to a library, with the flags that it needs.
    Build(build::Arguments),
}

/// Longest time that loading a library, or one call of it, may take unless a case says otherwise, s: who looks at a
/// plugin waits for it.
const TIME_LIMIT: f64 = 5.0;

/// Does what the command line says, whose words are `line`.
pub(super) fn act(action: &Action, line: &[OsString]) -> Result<u8, Refusal> {
    match action {
        Action::List { plugin_paths } => Ok(list(plugin_paths)),
        Action::Info { plugin, abaqus, json, plugin_paths, .. } => {
            let work = match (abaqus, json) {
                (true, _) => abaqus_input,
                (_, true) => info_as_json,
                _ => info,
            };
            with_library(plugin, plugin_paths, line, work)
        }
        Action::Check(arguments) => check::run(arguments),
        Action::Build(arguments) => build::run(arguments),
    }
}

impl Action {
    /// Returns where plugins are called.
    pub(super) fn isolation(&self) -> Isolation {
        match self {
            Self::Info { isolation, .. } => *isolation,
            Self::Check(arguments) => arguments.isolation,
            Self::List { .. } | Self::Build(_) => Isolation::default(),
        }
    }
}

/// Loads a library, by its law's name or by its path, and does something with it; in a process of its own, which carries
/// out the same command line, if it may not run here.
fn with_library(
    name: &str,
    plugin_paths: &[PathBuf],
    line: &[OsString],
    work: fn(&Library) -> Result<u8, Refusal>,
) -> Result<u8, Refusal> {
    let file = file_of(name, plugin_paths)?;
    if let Some(need) = Need::of_library(&file, TIME_LIMIT) {
        return Ok(isolated::carry_out(&line.to_vec(), &need, &file, false));
    }
    // what it prints in thousands of calls is nobody's
    let _prints = Prints::discard();
    work(&isolation::load(&file).map_err(no_plugin)?)
}

/// A library that cannot be loaded, or is none.
fn no_plugin(message: impl std::fmt::Display) -> Refusal {
    CaseProblem::library(message.to_string()).into()
}

/// The file of a library, by its law's name or by its path.
fn file_of(name: &str, plugin_paths: &[PathBuf]) -> Result<PathBuf, Refusal> {
    if names_a_file(name) {
        let file = library_path(Path::new(""), name);
        return if file.is_file() { sources::library_of(file).map_err(no_plugin) } else { Ok(file) };
    }
    let paths = search_paths(plugin_paths);
    let not_found = || pullout_case::not_found(name, &paths) + "; `pullout plugin list` tells what there is";
    Found::by_name(name, &paths).map(|found| found.path).ok_or_else(|| no_plugin(not_found()))
}

fn list(plugin_paths: &[PathBuf]) -> u8 {
    let paths = search_paths(plugin_paths);
    let mut rows = vec![["LAW", "VERSION", "ENTRY POINTS", "LIBRARY"].map(String::from)];
    for Found { path, .. } in Found::all(&paths) {
        let told = match pullout_check::build::defines(&path, PLUGIN_SYMBOL) {
            Ok(true) => rows_of(&path),
            // other libraries (compiler plugins beside the executable) are not even loaded
            Ok(false) => Ok(Vec::new()),
            Err(error) => Err(format!("{}: cannot be read as a library: {error}", path.display())),
        };
        match told {
            Ok(told) => rows.extend(
                told.into_iter()
                    .map(|[law, version, entry_points]| [law, version, entry_points, path.display().to_string()]),
            ),
            Err(message) => complain(message),
        }
    }
    let mut text = description::table(&rows);
    text.push_str("\nSearched:\n");
    for path in &paths {
        let _ = writeln!(text, "  {}{}", path.display(), if path.is_dir() { "" } else { " (does not exist)" });
    }
    if rows.len() == 1 {
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

/// Name, version and entry points of the laws of a library, which is loaded into this process only if it may be.
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
