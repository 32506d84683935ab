//! `pullout plugin check`: checks in this process or, if the library may not run here, each group in its own process.

use super::super::{DONE, FAILED, Isolation, NOT_TESTED, Refusal, say};
use super::{TIME_LIMIT, file_of, no_plugin};
use pullout_case::Case;
use pullout_check::conformance::{self, CheckGroup, Event, Judged, Judgement, Options, Verdict};
use pullout_engine::CaseSource;
use pullout_lab::Examination;
use pullout_run::input::folder_of;
use pullout_run::isolation::prints::Prints;
use pullout_run::isolation::{self, Need, Work, worker};
use pullout_run::program::{Mode, PointKind};
use serde::{Deserialize, Serialize};
use serde_json::json;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use umat_abi::host::{Library, Plugin, library_path, names_a_file, real_path};
use umat_abi::law::StressState;

mod children;

#[derive(Debug, clap::Args)]
pub(in crate::command) struct CheckArguments {
    #[command(flatten)]
    of: Subject,
    /// Check along the path of this case, with its parameters, mode, times, temperatures and initial state. A library
    /// without metadata needs it. If you name a FILE, it replaces the library of the case.
    #[arg(long, value_name = "CASE.json")]
    case: Option<PathBuf>,
    /// Override an entry of the case, e.g. steps.0.increments=5 (VALUE is JSON, otherwise a string).
    #[arg(long = "set", value_name = "a.b.c=VALUE")]
    overrides: Vec<String>,
    /// NSTATV to use instead of the case's.
    #[arg(long, value_name = "N")]
    nstatv: Option<usize>,
    /// Print rows and verdict as JSON.
    #[arg(long)]
    json: bool,
    #[command(flatten)]
    pub(super) isolation: Isolation,
}

/// Library to check, and its inputs.
#[derive(Clone, Debug, Serialize, Deserialize, clap::Args)]
struct Subject {
    /// A law's name, or a shared library.
    #[arg(value_name = "NAME|FILE.so")]
    plugin: String,
    /// PROPS to use instead of those of the case, or of the defaults of the metadata.
    #[arg(long, value_name = "P1,P2,...", allow_hyphen_values = true, value_delimiter = ',')]
    props: Option<Vec<f64>>,
    /// PROPS of UMATHT, whose derivatives are then checked.
    #[arg(long, value_name = "P1,P2,...", allow_hyphen_values = true, value_delimiter = ',')]
    umatht_props: Option<Vec<f64>>,
    /// Mode to use instead of the case's. Without a case, only this mode is checked.
    #[arg(long, value_name = "3d|plane_strain|axisymmetric|plane_stress")]
    mode: Option<String>,
    /// Number of sampled states for each stress state.
    #[arg(long, default_value_t = Options::default().states)]
    states: usize,
    /// Search this folder for plugins first (may be repeated).
    #[arg(long = "plugin-path", value_name = "DIR")]
    #[serde(with = "isolation::paths")]
    plugin_paths: Vec<PathBuf>,
}

impl CheckArguments {
    /// The overridden entries of the case.
    fn overrides(&self) -> Vec<String> {
        let entry = |key: &str, value: Option<String>| value.map(|value| format!("{key}={value}"));
        let changes = [
            entry("material.props", self.of.props.as_ref().map(|props| json!(props).to_string())),
            entry("material.nstatv", self.nstatv.map(|count| count.to_string())),
            entry("mode", self.of.mode.clone()),
        ];
        self.overrides.iter().cloned().chain(changes.into_iter().flatten()).collect()
    }

    /// Returns the requested checks of a library.
    fn checks(&self, library: &Path) -> Checks {
        let (overrides, plugin_paths) = (self.overrides(), self.of.plugin_paths.clone());
        let mut case = self.case.as_ref().map(|case| CaseSource { overrides, plugin_paths, ..CaseSource::file(case) });
        let given = library_path(Path::new(""), &self.of.plugin);
        if let Some(source) =
            case.as_mut().filter(|source| names_a_file(&self.of.plugin) && !calls(source, &[library, &given]))
        {
            source.overrides.push(format!("material.plugin={}", json!(real_path(library))));
        }
        Checks::of(self.of.clone(), case)
    }
}

/// Returns whether a case names one of these files, by its path or by the name of a law in it.
fn calls(source: &CaseSource, files: &[&Path]) -> bool {
    let text = source.text().unwrap_or_default();
    let named = text["material"]["plugin"].as_str().unwrap_or_default();
    let file = isolation::named_file(named, folder_of(&source.file), &source.plugin_paths);
    file.is_some_and(|file| files.iter().any(|known| real_path(&file) == real_path(known)))
}

/// Checks of a library: all, or those of one group.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub(in crate::command) struct Checks {
    of: Subject,
    /// The case along whose path the checks are made.
    case: Option<CaseSource>,
    /// The group that another process requests.
    group: Option<CheckGroup>,
    /// States that are left out.
    skip: Vec<usize>,
    /// Largest number of increments of the case.
    longest_path: Option<u64>,
    /// Time limit of the group, s.
    seconds: Option<f64>,
}

impl Work for Checks {
    const NAME: &'static str = "checks";
    const IS_HEARD_BY_STARTER: bool = true;
}

impl Checks {
    /// Returns all checks of a library.
    fn of(of: Subject, case: Option<CaseSource>) -> Self {
        Self { of, case, group: None, skip: Vec::new(), longest_path: None, seconds: None }
    }

    /// Makes the checks of a group for another process, which receives each event.
    pub(in crate::command) fn carry_out(&self) -> Result<u8, Refusal> {
        with_library(self, &file_of(&self.of.plugin, &self.of.plugin_paths)?, false).map(|_| DONE)
    }
}

/// Returns the header above the rows of a law.
fn header(name: &str, library: &Path) -> String {
    format!("{name} ({})\n", library.display())
}

/// Returns the exit code of a verdict.
fn code_of(judgement: &Judgement) -> u8 {
    match judgement.verdict {
        Verdict::Fail => FAILED,
        Verdict::NotTested => NOT_TESTED,
        _ => DONE,
    }
}

/// Checks a library, given by its law's name or by its path. Returns the exit code.
pub(super) fn run(arguments: &CheckArguments) -> Result<u8, Refusal> {
    let case = arguments.case.as_deref();
    if case.is_none() && (arguments.nstatv.is_some() || !arguments.overrides.is_empty()) {
        return Err(Refusal::input("--nstatv and --set change a case: give one by --case"));
    }
    if let Some(value) = arguments.of.props.iter().flatten().find(|value| !value.is_finite()) {
        return Err(Refusal::input(format!("--props: {value} is no finite number")));
    }
    let file = file_of(&arguments.of.plugin, &arguments.of.plugin_paths)?;
    let judged = judge(arguments.checks(&file), &file, !arguments.json)?;
    if let (Ok(judgement), true) = (&judged, arguments.json) {
        say(&format!("{:#}\n", json!(judgement)));
    }
    Ok(judged.map_or_else(|code| code, |judgement| code_of(&judgement)))
}

/// Makes checks for another process, which receives the judgement alone.
pub(in crate::command) fn examine(asked: Examination) -> Result<u8, Refusal> {
    let Examination { case, plugin, states } = asked;
    let plugin_paths = case.plugin_paths.clone();
    let of = Subject { plugin, props: None, umatht_props: None, mode: None, states, plugin_paths };
    let file = file_of(&of.plugin, &of.plugin_paths)?;
    let judged = judge(Checks::of(of, Some(case)), &file, false)?;
    if let Ok(judgement) = &judged {
        isolation::send(judgement);
    }
    Ok(judged.map_or_else(|code| code, |judgement| code_of(&judgement)))
}

/// Makes all checks. If nothing can be judged, the error has been printed and the exit code is returned. `prints_rows`: whether
/// rows are printed as they come.
fn judge(checks: Checks, file: &Path, prints_rows: bool) -> Result<Result<Judgement, u8>, Refusal> {
    let of_case = || checks.case.as_ref()?.need();
    if let Some(need) = of_case().or_else(|| Need::of_library(file, TIME_LIMIT)) {
        return children::run(checks, file, need, prints_rows);
    }
    Ok(Ok(Judgement::of(with_library(&checks, file, prints_rows)?)))
}

/// Loads a library and checks it.
fn with_library(checks: &Checks, file: &Path, prints_rows: bool) -> Result<Vec<Judged>, Refusal> {
    worker::let_calls_come_back();
    // what it prints in thousands of calls is nobody's
    let _prints = Prints::discard();
    here(checks, &isolation::load(file).map_err(no_plugin)?, prints_rows)
}

/// Checks a library in this process. `prints_rows`: whether rows are printed as they come.
fn here(checks: &Checks, library: &Library, prints_rows: bool) -> Result<Vec<Judged>, Refusal> {
    let mut options = Options {
        umatht_props: checks.of.umatht_props.clone(),
        states: checks.of.states,
        group: checks.group,
        skipped: checks.skip.clone(),
        longest_path: checks.longest_path,
        seconds: checks.seconds,
        ..Options::default()
    };
    let plugins = plugins(checks, library, &mut options)?;
    options.listener = match prints_rows {
        false => Some(|event| isolation::send(&event)),
        true => Some(|event| {
            if let Event::Row(row) = event {
                say(&format!("{row}\n"));
            }
        }),
    };
    let mut judged = Vec::new();
    for plugin in plugins {
        let path = plugin.library.path();
        isolation::send(&Event::Law(plugin.name.clone(), path.to_owned()));
        if prints_rows {
            say(&header(&plugin.name, path));
        }
        let report = conformance::check(&plugin, &options);
        if prints_rows {
            say(&format!("{}\n\n", report.conclusion()));
        }
        let library = path.display().to_string();
        judged.push(Judged { name: plugin.name.clone(), library, report, ..Judged::default() });
    }
    Ok(judged)
}

/// Returns the laws to check: the case's, or all of the library.
fn plugins(checks: &Checks, library: &Library, options: &mut Options) -> Result<Vec<Plugin>, Refusal> {
    let wrong = |message: String| Err(Refusal::input(message));
    let path = library.path();
    let Some(source) = &checks.case else {
        if library.laws().is_empty() {
            return wrong(format!(
                "{}: has no metadata: it cannot be checked without a --case that has its props and nstatv, and a path that makes the law nonlinear",
                path.display()
            ));
        }
        options.stress_state = match checks.of.mode.as_deref() {
            None => None,
            Some("3d") => Some(StressState::ThreeD),
            Some("plane_strain" | "axisymmetric") => Some(StressState::PlaneStrainOrAxisymmetric),
            Some("plane_stress") => Some(StressState::PlaneStress),
            Some(other) => {
                return wrong(format!("--mode {other}: there are 3d, plane_strain, axisymmetric, plane_stress"));
            }
        };
        for law in library.laws() {
            let (given, wanted) =
                (checks.of.props.as_ref().map_or(law.parameters.len(), Vec::len), law.parameters.len());
            if law.group.is_none() && given != wanted {
                return wrong(format!("--props: {given} values; {} has {wanted}", law.name));
            }
        }
        options.props.clone_from(&checks.of.props);
        options.is_axisymmetric = checks.of.mode.as_deref() == Some(Mode::Axisymmetric.name());
        return Ok(library.laws().iter().map(|law| Plugin::with_defaults(library, law)).collect());
    };
    let (case, file) = (source.case()?, &source.file);
    let Case::Path(program) = case else {
        return wrong(format!("{}: give a case of kind point or interface: it has one plugin", file.display()));
    };
    let plugin = program.plugin.clone();
    if real_path(plugin.library.path()) != real_path(path) {
        let other = plugin.library.path().display();
        return wrong(format!("{}: uses the plugin {other}, not {}", file.display(), path.display()));
    }
    options.is_axisymmetric = matches!(&program.kind, PointKind::Point(point) if point.mode == Mode::Axisymmetric);
    options.characteristic_length = program.characteristic_length;
    options.program = Some(Arc::new(*program));
    Ok(vec![plugin])
}
