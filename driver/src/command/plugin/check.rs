//! `pullout plugin check`: in this process, or each group of checks in one of its own where the library may not run here.

use super::super::{DONE, FAILED, Isolation, NOT_TESTED, Refusal, option, say};
use super::{TIME_LIMIT, file_of, no_plugin};
use clap::ValueEnum;
use pullout_case::Case;
use pullout_check::conformance::{self, Event, Group, Options, Report};
use pullout_run::isolation::prints::Prints;
use pullout_run::isolation::{self, Need, worker};
use pullout_run::program::{Kind, Mode};
use serde_json::{Value, json};
use std::ffi::OsString;
use std::fs::File;
use std::io::Write;
use std::path::{Path, PathBuf};
use std::sync::{Arc, Mutex, OnceLock};
use umat_abi::host::{Library, Plugin, real_path};
use umat_abi::law::StressState;

mod children;

#[derive(Debug, Clone, clap::Args)]
pub(in crate::command) struct Arguments {
    /// A law's name, or a shared library.
    #[arg(value_name = "NAME|FILE.so")]
    plugin: String,
    /// Around the path of this case, with its parameters, mode, times, temperatures, initial state; a library without
    /// metadata cannot be judged without one.
    #[arg(long, value_name = "CASE.json")]
    case: Option<PathBuf>,
    /// Override an entry of the case, e.g. steps.0.increments=5.
    #[arg(long = "set", value_name = "a.b.c=VALUE")]
    overrides: Vec<String>,
    /// PROPS instead of the case's, or of the metadata's defaults.
    #[arg(long, value_name = "P1,P2,...", allow_hyphen_values = true, value_delimiter = ',')]
    props: Option<Vec<f64>>,
    /// NSTATV instead of the case's.
    #[arg(long, value_name = "N")]
    nstatv: Option<usize>,
    /// The mode instead of the case's; without a case, the only one that is checked.
    #[arg(long, value_name = "3d|plane_strain|axisymmetric|plane_stress")]
    mode: Option<String>,
    /// States in which the law is looked at, for each stress state.
    #[arg(long, default_value_t = Options::default().states)]
    states: usize,
    /// Rows and verdict as JSON.
    #[arg(long)]
    json: bool,
    /// Look here first (may be repeated).
    #[arg(long = "plugin-path", value_name = "DIR")]
    plugin_paths: Vec<PathBuf>,
    #[command(flatten)]
    pub(super) isolation: Isolation,
    /// The checks of one group, for the process that started this one.
    #[arg(long, hide = true, requires = "rows")]
    group: Option<Group>,
    /// File in which that process reads the events.
    #[arg(long, hide = true)]
    rows: Option<PathBuf>,
    /// States that are left out.
    #[arg(long, hide = true)]
    skip: Vec<usize>,
    /// Increments of the case at most.
    #[arg(long, hide = true)]
    longest_path: Option<u64>,
    /// Time for the group, s.
    #[arg(long, hide = true)]
    seconds: Option<f64>,
}

impl Arguments {
    /// The entries of the case that change.
    fn overrides(&self) -> Vec<String> {
        let entry = |key: &str, value: Option<String>| value.map(|value| format!("{key}={value}"));
        let changes = [
            entry("material.props", self.props.as_ref().map(|props| json!(props).to_string())),
            entry("material.nstatv", self.nstatv.map(|count| count.to_string())),
            entry("mode", self.mode.clone()),
        ];
        self.overrides.iter().cloned().chain(changes.into_iter().flatten()).collect()
    }

    /// The command line of a group of checks, without the program's name.
    fn command_line(
        &self,
        group: Group,
        rows: &Path,
        skip: &[usize],
        longest_path: Option<u64>,
        seconds: f64,
    ) -> Vec<OsString> {
        let group = group.to_possible_value().map(|value| value.get_name().to_owned()).unwrap_or_default();
        let mut line: Vec<OsString> = vec!["plugin".into(), "check".into(), format!("--group={group}").into()];
        line.extend(["--rows".into(), rows.into(), format!("--states={}", self.states).into()]);
        line.extend(skip.iter().map(|state| format!("--skip={state}").into()));
        line.extend(longest_path.map(|count| format!("--longest-path={count}").into()));
        line.push(format!("--seconds={seconds}").into());
        line.extend(self.case.iter().map(|case| option("--case", case)));
        if self.case.is_some() {
            line.extend(self.overrides().into_iter().map(|entry| format!("--set={entry}").into()));
        } else {
            let props = self.props.iter().map(|props| props.iter().map(f64::to_string).collect::<Vec<_>>().join(","));
            line.extend(props.map(|props| format!("--props={props}").into()));
            line.extend(self.mode.iter().map(|mode| format!("--mode={mode}").into()));
        }
        line.extend(self.plugin_paths.iter().map(|path| option("--plugin-path", path)));
        line.extend(["--".into(), OsString::from(&self.plugin)]);
        line
    }
}

/// Outcome of one law's check.
struct Judged {
    name: String,
    library: PathBuf,
    report: Report,
    /// Cases that repeat calls that did not come back.
    replays: Vec<Value>,
}

impl Judged {
    fn header(name: &str, library: &Path) -> String {
        format!("{name} ({})\n", library.display())
    }

    fn code(&self) -> u8 {
        if self.report.failures().next().is_some() {
            FAILED
        } else if self.report.is_vacuous() {
            NOT_TESTED
        } else {
            DONE
        }
    }

    fn verdict(code: u8) -> &'static str {
        match code {
            DONE => "pass",
            NOT_TESTED => "not tested",
            _ => "fail",
        }
    }
}

/// The exit code of several: a failure, before what was not tested.
fn code_of(judged: &[Judged]) -> u8 {
    let codes = || judged.iter().map(Judged::code);
    codes().find(|code| *code == FAILED).or(codes().max()).unwrap_or(FAILED)
}

/// Prints everything as JSON, if that is wanted; the exit code.
fn conclude(arguments: &Arguments, judged: &[Judged]) -> u8 {
    let code = code_of(judged);
    if arguments.json {
        let laws: Vec<Value> = judged
            .iter()
            .map(|law| {
                json!({
                    "name": law.name,
                    "library": law.library.display().to_string(),
                    "verdict": Judged::verdict(law.code()),
                    "conclusion": law.report.conclusion(),
                    "rows": law.report.rows,
                    "replays": law.replays,
                })
            })
            .collect();
        say(&format!("{:#}\n", json!({ "verdict": Judged::verdict(code), "laws": laws })));
    }
    code
}

/// Checks a library, by its law's name or by its path; the exit code.
pub(super) fn run(arguments: &Arguments) -> Result<u8, Refusal> {
    let file = file_of(&arguments.plugin, &arguments.plugin_paths)?;
    let case = arguments.case.as_deref();
    if case.is_none() && (arguments.nstatv.is_some() || !arguments.overrides.is_empty()) {
        return Err(Refusal::input("--nstatv and --set change a case: give one by --case"));
    }
    let of_case = || pullout_case::need(case?, &arguments.overrides(), &arguments.plugin_paths);
    if let Some(need) = of_case().or_else(|| Need::of_library(&file, TIME_LIMIT)) {
        return Ok(children::run(arguments, &file, need));
    }
    worker::let_calls_come_back();
    // what it prints in thousands of calls is nobody's
    let _prints = Prints::discard();
    here(arguments, &isolation::load(&file).map_err(no_plugin)?)
}

/// File in which the process that started this one reads the events.
static ROWS: OnceLock<Mutex<File>> = OnceLock::new();

/// Hands an event on.
fn hand_on(event: &Event) {
    if let Some(mut file) = ROWS.get().and_then(|file| file.lock().ok())
        && file.write_all(format!("{}\n", json!(event)).as_bytes()).is_err()
    {
        worker::end_for_closed_output();
    }
}

/// Checks a library in this process.
fn here(arguments: &Arguments, library: &Library) -> Result<u8, Refusal> {
    let mut options = Options {
        states: arguments.states,
        group: arguments.group,
        skipped: arguments.skip.clone(),
        longest_path: arguments.longest_path,
        seconds: arguments.seconds,
        ..Options::default()
    };
    let plugins = plugins(arguments, library, &mut options)?;
    options.listener = match &arguments.rows {
        Some(rows) => {
            let file = File::options().append(true).open(rows)?;
            let _ = ROWS.set(Mutex::new(isolation::out_of_reach(file)));
            Some(|event| hand_on(&event))
        }
        None if arguments.json => None,
        None => Some(|event| {
            if let Event::Row(row) = event {
                say(&format!("{row}\n"));
            }
        }),
    };
    let mut judged = Vec::new();
    for plugin in plugins {
        let path = plugin.library.path();
        hand_on(&Event::Law(plugin.name.clone(), path.to_owned()));
        let is_told = arguments.rows.is_none() && !arguments.json;
        if is_told {
            say(&Judged::header(&plugin.name, path));
        }
        let report = conformance::check(&plugin, &options);
        if is_told {
            say(&format!("{}\n\n", report.conclusion()));
        }
        judged.push(Judged { name: plugin.name.clone(), library: path.to_owned(), report, replays: Vec::new() });
    }
    Ok(if arguments.rows.is_some() { DONE } else { conclude(arguments, &judged) })
}

/// The laws to be checked: the case's, or all of the library.
fn plugins(arguments: &Arguments, library: &Library, options: &mut Options) -> Result<Vec<Plugin>, Refusal> {
    let wrong = |message: String| Err(Refusal::input(message));
    let path = library.path();
    let Some(file) = &arguments.case else {
        if library.laws().is_empty() {
            return wrong(format!(
                "{}: has no metadata; give its props and nstatv by --case, a case along whose path the law shows what it \
                 does: without one it cannot be judged",
                path.display()
            ));
        }
        options.stress_state = match arguments.mode.as_deref() {
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
                (arguments.props.as_ref().map_or(law.parameters.len(), Vec::len), law.parameters.len());
            if law.group.is_none() && given != wanted {
                return wrong(format!("--props: {given} values; {} has {wanted}", law.name));
            }
        }
        options.props.clone_from(&arguments.props);
        options.is_axisymmetric = arguments.mode.as_deref() == Some(Mode::Axisymmetric.name());
        return Ok(library.laws().iter().map(|law| Plugin::with_defaults(library, law)).collect());
    };
    let case = pullout_case::read(file, &arguments.overrides(), &arguments.plugin_paths)?;
    let Case::Path(program) = case else {
        return wrong(format!("{}: give a case of kind point or interface: it has one plugin", file.display()));
    };
    let plugin = program.plugin.clone();
    if real_path(plugin.library.path()) != real_path(path) {
        let other = plugin.library.path().display();
        return wrong(format!("{}: uses the plugin {other}, not {}", file.display(), path.display()));
    }
    options.is_axisymmetric = matches!(&program.kind, Kind::Point(point) if point.mode == Mode::Axisymmetric);
    options.characteristic_length = program.characteristic_length;
    options.program = Some(Arc::new(*program));
    Ok(vec![plugin])
}
