//! The command line (docs/reference/command-line.md): what each command does, and the exit codes.

mod animate;
mod bench;
mod browser;
pub mod examples;
mod fit;
mod import;
mod isolated;
mod lab;
mod new;
mod pages;
mod plot;
mod plugin;
mod props;
mod run;
mod study;
mod sweep;
mod watch;

use clap::error::ErrorKind;
use clap::{Parser, Subcommand};
use pullout_case::{Case, CaseErrors, CaseProblem};
use pullout_check::{build, description};
use pullout_engine::{CaseSource, Inspection, Job, Message};
use pullout_lab::Examination;
use pullout_run::PLUGIN_STACK;
use pullout_run::input::{self, Input};
use pullout_run::isolation::prints::plain;
use pullout_run::isolation::prints::{Prints, say};
use pullout_run::isolation::{self, Work};
use pullout_run::signals;
use pullout_run::sources;
use pullout_sweep::Batch;
use serde::de::DeserializeOwned;
use serde_json::{Map, Value, json};
use std::ffi::OsString;
use std::io;
use std::num::NonZeroUsize;
use std::path::{Path, PathBuf};

/// Done.
const DONE: u8 = 0;
/// The run failed; partial results are kept.
const FAILED: u8 = 1;
/// Bad input; nothing was run.
const BAD_INPUT: u8 = 2;
/// A plugin cannot be loaded.
const NO_PLUGIN: u8 = 3;
/// Nothing was tested that could have shown an error.
const NOT_TESTED: u8 = 4;

/// Text that is printed if no command is given.
const FIRST_STEPS: &str = "\
pullout lab [my_umat.f]     change a law's parameters in the browser and see its curves
pullout new umat my_umat    files to begin with; also: point, law, bond, fibre, hooked-fibre, beam, study, sweep
pullout examples            the cases that came with pullout; pullout run CASE.json runs one
pullout help                all commands
";

/// Drives material and contact points through UMAT, UINTER and FRIC plugins.
#[derive(Debug, Parser)]
#[command(name = "pullout", version, max_term_width = 100)]
struct CommandLine {
    #[command(subcommand)]
    command: Command,
}

#[derive(Debug, Subcommand)]
enum Command {
    /// Run cases; results go to out/<case>/ or --out.
    Run(run::RunArguments),
    /// Write starter files: a UMAT, a law, a fibre, a beam, a study or a sweep.
    New(new::NewArguments),
    /// List the cases installed with pullout and what each one shows.
    Examples(examples::ExamplesArguments),
    /// Change a law's parameters and path in the browser, and see its curves and verdict as you type.
    Lab(lab::Arguments),
    /// Run families of cases on all processors, overlay their curves, and test claims about them.
    Study(study::StudyArguments),
    /// Run a case with thousands of parameter sets, in any number of processes, and keep the numbers.
    Sweep {
        #[command(subcommand)]
        action: sweep::Action,
    },
    /// Validate cases and studies, and report all errors at once, each with its JSON path.
    Check {
        /// Case and study files.
        #[arg(required = true, value_name = "CASE.json")]
        cases: Vec<PathBuf>,
        #[command(flatten)]
        reading: Reading,
        /// Print only errors.
        #[arg(long)]
        quiet: bool,
    },
    /// List, describe, check or build plugins.
    Plugin {
        #[command(subcommand)]
        action: plugin::Action,
    },
    /// Print the JSON Schema of case and study files (draft 2020-12).
    Schema,
    /// Redraw the pictures of a run, or overlay several runs.
    Plot(plot::PlotArguments),
    /// Make a looping GIF of a specimen's run: the deformed mesh next to the curve.
    Animate(animate::AnimateArguments),
    /// Execute work for the pullout process that started this one.
    #[command(name = isolation::worker::COMMAND, hide = true)]
    Worker(isolation::Task),
    /// Write manual pages and shell completions into a folder `share`; for the installer.
    #[command(hide = true)]
    Pages {
        /// The folder.
        #[arg(value_name = "SHARE")]
        share: PathBuf,
    },
    /// Turn a one-element ABAQUS job with a user material into a case of kind "point".
    Import(import::ImportArguments),
    /// Find a law's parameters from an experiment.
    ///
    /// `fit CASE` adjusts parameters of any case until a history curve matches a measured one (Levenberg–Marquardt). It
    /// writes to the result directory: fitted-case.json (the case with the fitted values), fitted-curve.csv, fit.json
    /// (values with standard errors and correlations), plots/ and report.html.
    Fit(Box<fit::Fit>),
    /// Measure run time against error, the cost of a plugin call, and throughput.
    Bench(bench::BenchArguments),
    /// Print calibrated parameters of a law.
    Props {
        #[command(subcommand)]
        law: props::CalibratedLaw,
    },
}

/// Settings for reading case files.
#[derive(Clone, Debug, clap::Args)]
struct Reading {
    /// Override an entry of every case, e.g. steps.0.increments=5 (VALUE is JSON, otherwise a string).
    #[arg(long = "set", value_name = "a.b.c=VALUE")]
    overrides: Vec<String>,
    /// Search this folder for plugins first (may be repeated).
    #[arg(long = "plugin-path", value_name = "DIR")]
    plugin_paths: Vec<PathBuf>,
    /// Treat case files as untrusted: use only plugins of the search path, refuse "symbol", and read no file outside the
    /// folder of the case.
    #[arg(long, conflicts_with = "in_process")]
    untrusted: bool,
    #[command(flatten)]
    isolation: Isolation,
}

/// Process for libraries that were not built with pullout.
#[derive(Clone, Copy, Debug, Default, clap::Args)]
struct Isolation {
    /// Call all plugins in this process, except in cases with "isolate": true. A plugin that stops or crashes then ends
    /// pullout.
    #[arg(long)]
    in_process: bool,
}

impl Reading {
    /// Returns a case file with these settings.
    fn source(&self, file: &Path) -> CaseSource {
        CaseSource {
            overrides: self.overrides.clone(),
            plugin_paths: self.plugin_paths.clone(),
            is_untrusted: self.untrusted,
            ..CaseSource::file(file)
        }
    }
}

/// Reads a case. Output of its plugins meanwhile is discarded: it belongs to no run.
fn read(source: &CaseSource) -> Result<Case, CaseErrors> {
    let _prints = Prints::discard();
    source.case()
}

impl Command {
    /// Returns whether its cases are untrusted.
    fn is_untrusted(&self) -> bool {
        match self {
            Self::Run(arguments) => arguments.reading.untrusted,
            Self::Study(arguments) => arguments.reading.untrusted,
            Self::Check { reading, .. } => reading.untrusted,
            _ => false,
        }
    }

    /// Returns the process in which it calls plugins.
    fn isolation(&self) -> Isolation {
        match self {
            Self::Run(arguments) => arguments.reading.isolation,
            Self::Study(arguments) => arguments.reading.isolation,
            Self::Check { reading, .. } => reading.isolation,
            Self::Plugin { action } => action.isolation(),
            Self::Fit(fit) => fit.isolation(),
            // it measures calls in this process
            Self::Bench(_) => Isolation { in_process: true },
            Self::New(_)
            | Self::Examples(_)
            | Self::Lab(_)
            | Self::Sweep { .. }
            | Self::Schema
            | Self::Animate(_)
            | Self::Plot(_)
            | Self::Worker(_)
            | Self::Pages { .. }
            | Self::Import(_)
            | Self::Props { .. } => Isolation::default(),
        }
    }
}

/// Returns how many threads can run at the same time.
fn processors() -> NonZeroUsize {
    std::thread::available_parallelism().unwrap_or(NonZeroUsize::MIN)
}

/// Runs the program with these arguments; the result is its exit code.
pub fn main(arguments: impl IntoIterator<Item = OsString>) -> u8 {
    isolation::this_is_the_program();
    isolation::look_where_it_was_built();
    let line: Vec<OsString> = arguments.into_iter().collect();
    if line.len() <= 1 {
        say(FIRST_STEPS);
        return DONE;
    }
    let arguments = match CommandLine::try_parse_from(&line) {
        Ok(arguments) => arguments,
        Err(message) => {
            // help and version are no errors
            let code = if message.use_stderr() { BAD_INPUT } else { DONE };
            let _ = message.print();
            if message.kind() == ErrorKind::InvalidSubcommand {
                line.get(1).and_then(|word| command_for(Path::new(word))).iter().for_each(complain);
            }
            return code;
        }
    };
    // Plugins with automatic arrays need more stack than the main thread has.
    let act = move || act(arguments.command);
    let thread = std::thread::Builder::new().name("pullout".into()).stack_size(PLUGIN_STACK).spawn(act);
    match thread.map(std::thread::JoinHandle::join) {
        Ok(Ok(code)) => code,
        Ok(Err(panic)) => std::panic::resume_unwind(panic),
        Err(error) => {
            complain(format!("no thread with a stack of {PLUGIN_STACK} bytes can be started: {error}"));
            FAILED
        }
    }
}

/// Returns the command for a file without a command.
fn command_for(file: &Path) -> Option<String> {
    let command = match file.extension()?.to_str()? {
        "json" if pullout_case::is_study(file) => "study",
        "json" => "run",
        _ if umat_abi::host::names_a_file(&file.to_string_lossy()) => "lab",
        _ => return None,
    };
    file.is_file().then(|| format!("to use this file: pullout {command} {}", file.display()))
}

/// Executes a command. Returns the exit code.
fn act(command: Command) -> u8 {
    if command.isolation().in_process {
        isolation::let_all_in();
    }
    // what another process asks for says itself whom it trusts
    if !matches!(command, Command::Worker(_)) {
        compile_sources(command.is_untrusted());
    }
    // a study and a supervisor end at a second signal, and what they started with them
    let listening = match &command {
        // it listens already
        _ if isolation::worker::is_this_process() => Ok(()),
        Command::Worker(_) => signals::listen(false),
        Command::Run(_) | Command::Lab(_) | Command::Study(_) | Command::Sweep { .. } => signals::listen(true),
        _ => signals::write_beyond_limits_fails(),
    };
    if let Err(error) = listening {
        complain(format!("signals cannot be handled: {error}"));
    }
    let done = match command {
        Command::Run(arguments) => Ok(run::run(&arguments)),
        Command::New(arguments) => new::write(&arguments),
        Command::Examples(arguments) => examples::list(&arguments),
        Command::Lab(arguments) => lab::run(arguments),
        Command::Study(arguments) => Ok(study::run_all(&arguments)),
        Command::Sweep { action } => sweep::act(&action),
        Command::Check { cases, reading, quiet } => Ok(run::check(&cases, &reading, quiet)),
        Command::Plugin { action } => plugin::act(&action),
        Command::Schema => {
            say(&format!("{:#}\n", pullout_case::schema()));
            Ok(DONE)
        }
        Command::Plot(arguments) => plot::plot(&arguments),
        Command::Animate(arguments) => animate::animate(&arguments),
        Command::Import(arguments) => import::run(&arguments),
        Command::Fit(fit) => fit::act(&fit),
        Command::Bench(arguments) => Err(bench::run(&arguments)),
        Command::Props { law } => props::print(&law),
        Command::Worker(task) => isolation::worker::work(&task, work).map_err(Refusal::failed),
        Command::Pages { share } => pages::write(&share),
    };
    done.unwrap_or_else(Refusal::report)
}

/// Allows cases to name plugin sources, which are then compiled, unless the cases are untrusted.
pub fn compile_sources(is_untrusted: bool) {
    if !is_untrusted {
        sources::build_by(|source| {
            build::kept(source, &|words| complain(words)).map_err(|refusal| refusal.to_string())
        });
    }
}

/// Executes work for another process, given by its name and as JSON. Returns the exit code.
fn work(name: &str, work: &str) -> u8 {
    /// Reads work and executes it.
    fn done<W: Work + DeserializeOwned>(work: &str, act: impl FnOnce(W) -> Result<u8, Refusal>) -> Result<u8, Refusal> {
        serde_json::from_str(work).map_err(Refusal::failed).and_then(act)
    }
    let done = match name {
        fit::Bond::NAME => done(work, |bond: fit::Bond| {
            compile_sources(false);
            bond.act()
        }),
        plugin::Description::NAME => done(work, |asked: plugin::Description| {
            compile_sources(false);
            asked.print()
        }),
        Job::NAME => done(work, |job: Job| {
            compile_sources(job.case.is_untrusted);
            Ok(run::carry_out(&job))
        }),
        Inspection::NAME => done(work, |inspection: Inspection| {
            compile_sources(inspection.case.is_untrusted);
            Ok(run::inspect(&inspection))
        }),
        description::Subject::NAME => done(work, |subject: description::Subject| {
            compile_sources(false);
            subject.send().map(|()| DONE).map_err(Refusal::failed)
        }),
        Examination::NAME => done(work, |asked: Examination| {
            compile_sources(asked.case.is_untrusted);
            plugin::examine(asked)
        }),
        plugin::Checks::NAME => done(work, |checks: plugin::Checks| {
            compile_sources(false);
            checks.carry_out()
        }),
        Batch::NAME => done(work, |batch: Batch| {
            compile_sources(batch.is_untrusted);
            Ok(batch.carry_out().map(|()| DONE)?)
        }),
        _ => Err(Refusal::failed(format!("{name}: unknown work"))),
    };
    done.unwrap_or_else(Refusal::report)
}

/// Returns the result directory of a file: the requested one (for several files, below it), otherwise one below `out`.
fn folder_of(file: &Path, asked_for: Option<&Path>, is_alone: bool) -> PathBuf {
    let stem = file.file_stem().unwrap_or_default();
    match asked_for {
        Some(folder) if is_alone => folder.to_owned(),
        parent => parent.unwrap_or(Path::new("out")).join(stem),
    }
}

/// Prints a JSON file of a result directory as one line, after its input and the directory.
fn say_json(input: (&str, &Path), folder: &Path, file: &str) -> io::Result<()> {
    let text = input::text(&folder.join(file), Input::Result)?;
    let results: Map<String, Value> = serde_json::from_str(&text)?;
    let mut line = json!({ input.0: input.1, "folder": folder });
    line.as_object_mut().into_iter().for_each(|line| line.extend(results.clone()));
    say(&format!("{line}\n"));
    Ok(())
}

/// Prints to standard error.
fn complain(text: impl std::fmt::Display) {
    use std::io::Write;
    let _ = writeln!(std::io::stderr(), "{}", plain(&text.to_string()));
}

/// Early end of a command: message and exit code.
struct Refusal {
    message: String,
    code: u8,
    /// An error in the input.
    problems: Vec<CaseProblem>,
}

impl Refusal {
    /// Bad input.
    fn input(message: impl std::fmt::Display) -> Self {
        CaseProblem::unreadable(message.to_string()).into()
    }

    /// An error in a file.
    fn of(file: &Path, problem: CaseProblem) -> Self {
        Self { message: format!("{}: {problem}", file.display()), ..problem.into() }
    }

    /// A failure of the system, or of a run.
    fn failed(message: impl std::fmt::Display) -> Self {
        Self { message: message.to_string(), code: FAILED, problems: Vec::new() }
    }

    /// Prints the message, and passes errors in the input on. Returns the exit code.
    fn report(self) -> u8 {
        if !self.problems.is_empty() {
            isolation::send(&Message::Refused(self.problems));
        }
        complain(self.message);
        self.code
    }
}

impl From<io::Error> for Refusal {
    fn from(error: io::Error) -> Self {
        Self::failed(error)
    }
}

impl From<CaseProblem> for Refusal {
    fn from(problem: CaseProblem) -> Self {
        let message = problem.to_string();
        Self { message, ..CaseErrors { file: PathBuf::new(), problems: vec![problem] }.into() }
    }
}

impl From<CaseErrors> for Refusal {
    fn from(errors: CaseErrors) -> Self {
        Self { message: errors.to_string(), code: errors.exit_code(), problems: errors.problems }
    }
}
