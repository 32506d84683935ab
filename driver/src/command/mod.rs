//! The command line (docs/reference/command-line.md): what each command does, and the exit codes.

mod bench;
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

use clap::error::ErrorKind;
use clap::{Parser, Subcommand};
use pullout_case::{Case, CaseErrors};
use pullout_check::build;
use pullout_run::PLUGIN_STACK;
use pullout_run::isolation;
use pullout_run::isolation::prints::plain;
use pullout_run::isolation::prints::{Prints, say};
use pullout_run::signals;
use pullout_run::sources;
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
/// A check has seen nothing that could have shown an error.
const NOT_TESTED: u8 = 4;

/// What the program says when it is given nothing to do.
const FIRST_STEPS: &str = "\
pullout lab [my_umat.f]     change a law's parameters in the browser and see its curves
pullout new umat my_umat    files to begin with; also: point, law, bond, fibre, beam, study, sweep
pullout examples            the cases that came with pullout; pullout run CASE.json runs one
pullout help                all commands
";

/// Drives material and contact points through UMAT, UINTER and FRIC plugins.
#[derive(Debug, Parser)]
#[command(name = "pullout", version, max_term_width = 100)]
struct Arguments {
    #[command(subcommand)]
    command: Command,
}

#[derive(Debug, Subcommand)]
enum Command {
    /// Run cases; results go to out/<case>/ or --out.
    Run(run::Arguments),
    /// Write the files of a tutorial to begin with: a UMAT, a law, a fibre, a beam, a study, a sweep.
    New(new::Arguments),
    /// List the cases that came with pullout, with what each shows.
    Examples(examples::Arguments),
    /// Change a law's parameters and path in the browser, and see its curves and verdict as you type.
    Lab(lab::Arguments),
    /// Run families of cases on all processors, overlay them, and test what is claimed of them.
    Study(study::Arguments),
    /// Run a case thousands of times and keep numbers: planned once, worked off by any number of processes.
    Sweep {
        #[command(subcommand)]
        action: sweep::Action,
    },
    /// Validate cases and studies: all errors at once, with the JSON path of each.
    Check {
        /// Case and study files.
        #[arg(required = true, value_name = "CASE.json")]
        cases: Vec<PathBuf>,
        #[command(flatten)]
        reading: Reading,
        /// Say nothing but errors.
        #[arg(long)]
        quiet: bool,
        /// Say nothing but errors, and leave to the run what belongs to it.
        #[arg(long, hide = true)]
        before_run: bool,
        /// Write the columns of the rows, behind step and increment, into this file, as JSON.
        #[arg(long, hide = true, requires = "before_run")]
        columns: Option<PathBuf>,
    },
    /// List, describe or test plugins.
    Plugin {
        #[command(subcommand)]
        action: plugin::Action,
    },
    /// Print the JSON Schema of case and study files (draft 2020-12).
    Schema,
    /// Redraw the pictures of one or several runs, overlaid.
    Plot(plot::Arguments),
    /// A command line in a process of its own; started by the program itself.
    #[command(name = isolation::worker::COMMAND, hide = true)]
    Worker(isolation::Task),
    /// Write the manual pages and the shells' completions below a folder `share`; for the installer.
    #[command(hide = true)]
    Pages {
        /// The folder.
        #[arg(value_name = "SHARE")]
        share: PathBuf,
    },
    /// Turn a one-element ABAQUS job with a user material into a case of kind "point".
    Import(import::Arguments),
    /// Find a law's parameters from an experiment.
    ///
    /// `fit CASE` seeks numbers of any case by which a curve of its history is nearest to a measured one (Levenberg and
    /// Marquardt). Written to the result directory: fitted-case.json (runs with what was found), fitted-curve.csv, fit.json
    /// (values with standard errors and correlations), plots/, report.html.
    Fit(Box<fit::Fit>),
    /// Measure run time against error, the cost of the plugin ABI, throughput.
    Bench(bench::Arguments),
    /// Print calibrated parameters of a law.
    Props {
        #[command(subcommand)]
        law: props::CalibratedLaw,
    },
}

/// Settings for reading case files.
#[derive(Clone, Debug, clap::Args)]
struct Reading {
    /// Override an entry, e.g. steps.0.increments=5 (VALUE is JSON, else a string; applies to all cases).
    #[arg(long = "set", value_name = "a.b.c=VALUE")]
    overrides: Vec<String>,
    /// Look for plugins here first (may be repeated).
    #[arg(long = "plugin-path", value_name = "DIR")]
    plugin_paths: Vec<PathBuf>,
    /// Trust no file: plugins of the search path only, no symbol in them, and no reading outside
    /// file's folder.
    #[arg(long, conflicts_with = "in_process")]
    untrusted: bool,
    /// Write what is wrong with the case into this file, as JSON.
    #[arg(long, hide = true)]
    problems: Option<PathBuf>,
    #[command(flatten)]
    isolation: Isolation,
}

/// Process in which libraries run that were not built with this program.
#[derive(Clone, Copy, Debug, Default, clap::Args)]
struct Isolation {
    /// Call all plugins in this process, except where a case says "isolate": true. What ends them ends the program.
    #[arg(long)]
    in_process: bool,
}

impl Reading {
    /// Returns these arguments as a worker takes them.
    fn command_line(&self) -> Vec<OsString> {
        let overrides = self.overrides.iter().map(|entry| format!("--set={entry}").into());
        let folders = self.plugin_paths.iter().map(|folder| option("--plugin-path", folder));
        let problems = self.problems.iter().map(|file| option("--problems", file));
        overrides.chain(folders).chain(problems).chain(self.untrusted.then(|| "--untrusted".into())).collect()
    }

    /// Reads a case. What its plugins print meanwhile belongs to no run.
    fn case(&self, file: &Path) -> Result<Case, CaseErrors> {
        let _prints = Prints::discard();
        let read = if self.untrusted { pullout_case::read_untrusted } else { pullout_case::read };
        let read = read(file, &self.overrides, &self.plugin_paths);
        if let (Err(errors), Some(to)) = (&read, &self.problems) {
            // who cannot read them has the words
            let _ = serde_json::to_string(&errors.problems).map(|text| std::fs::write(to, text));
        }
        read
    }

    /// Returns what a case needs a process of its own for, if it does.
    fn need(&self, file: &Path) -> Option<isolation::Need> {
        pullout_case::need(file, &self.overrides, &self.plugin_paths)
    }
}

impl Command {
    /// Returns whether nobody vouches for its cases.
    fn is_untrusted(&self) -> bool {
        match self {
            Self::Run(arguments) => arguments.reading.untrusted,
            Self::Study(arguments) => arguments.reading.untrusted,
            Self::Check { reading, .. } => reading.untrusted,
            _ => false,
        }
    }

    /// Returns where it calls plugins.
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
    let arguments = match Arguments::try_parse_from(&line) {
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
    let act = move || act(arguments.command, line.get(1..).unwrap_or_default());
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

/// The command that a file alone asks for.
fn command_for(file: &Path) -> Option<String> {
    let command = match file.extension()?.to_str()? {
        "json" if pullout_case::is_study(file) => "study",
        "json" => "run",
        _ if umat_abi::host::names_a_file(&file.to_string_lossy()) => "lab",
        _ => return None,
    };
    file.is_file().then(|| format!("for a file: pullout {command} {}", file.display()))
}

/// Does what a command line without the program's name says; the result is the exit code.
fn act_on(arguments: &[OsString]) -> u8 {
    match Arguments::try_parse_from(std::iter::once(&OsString::from("pullout")).chain(arguments)) {
        Ok(parsed) => act(parsed.command, arguments),
        Err(message) => {
            complain(message);
            BAD_INPUT
        }
    }
}

/// Does what a command says, which `line` is without the program's name; the result is the exit code.
fn act(command: Command, line: &[OsString]) -> u8 {
    if command.isolation().in_process {
        isolation::let_all_in();
    }
    // a case that nobody vouches for has nothing compiled, and what a worker is there for is another command line
    if !command.is_untrusted() && !matches!(command, Command::Worker(_)) {
        sources::build_by(|source| {
            build::kept(source, &|words| complain(words)).map_err(|refusal| refusal.to_string())
        });
    }
    // a study and a supervisor end at a second signal, and what they started with them
    let listening = match &command {
        // it listens already
        _ if isolation::worker::is_this_process() => Ok(()),
        Command::Run(arguments) => signals::listen(arguments.parent.is_none()),
        Command::Worker(_) => signals::listen(false),
        Command::Lab(_) => signals::listen(true),
        Command::Study(_) | Command::Sweep { .. } => signals::listen(true),
        _ => signals::write_beyond_limits_fails(),
    };
    if let Err(error) = listening {
        complain(format!("signals cannot be listened to: {error}"));
    }
    let done = match command {
        Command::Run(arguments) => {
            if let Some(parent) = arguments.parent {
                // where it cannot be asked for, a run outlives its study
                let _ = isolation::die_with(parent);
            }
            Ok(run::run(&arguments))
        }
        Command::New(arguments) => new::write(&arguments),
        Command::Examples(arguments) => examples::list(&arguments),
        Command::Lab(arguments) => lab::run(arguments),
        Command::Study(arguments) => Ok(study::run_all(&arguments)),
        Command::Sweep { action } => sweep::act(&action),
        Command::Check { cases, reading, quiet, before_run, columns } => {
            Ok(run::check(&cases, &reading, quiet || before_run, before_run, columns.as_deref()))
        }
        Command::Plugin { action } => plugin::act(&action, line),
        Command::Schema => {
            say(&format!("{:#}\n", pullout_case::schema()));
            Ok(DONE)
        }
        Command::Plot(arguments) => plot::plot(&arguments),
        Command::Import(arguments) => import::run(&arguments),
        Command::Fit(fit) => fit::act(&fit, line),
        Command::Bench(arguments) => Err(bench::run(&arguments)),
        Command::Props { law } => props::print(&law),
        Command::Worker(task) => Err(isolated::work(&task)),
        Command::Pages { share } => pages::write(&share),
    };
    done.unwrap_or_else(Refusal::told)
}

/// An option with its value, which may begin with a hyphen.
fn option(name: &str, value: &Path) -> OsString {
    let mut option = OsString::from(name);
    option.push("=");
    option.push(value);
    option
}

/// The result directory of a file: the one that was asked for, of several files their parent; else one below `out`.
fn folder_of(file: &Path, asked_for: Option<&Path>, is_alone: bool) -> PathBuf {
    let stem = file.file_stem().unwrap_or_default();
    match asked_for {
        Some(folder) if is_alone => folder.to_owned(),
        parent => parent.unwrap_or(Path::new("out")).join(stem),
    }
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
}

impl Refusal {
    /// Bad input.
    fn input(message: impl std::fmt::Display) -> Self {
        Self { message: message.to_string(), code: BAD_INPUT }
    }

    /// A failure of the system, or of a run.
    fn failed(message: impl std::fmt::Display) -> Self {
        Self { message: message.to_string(), code: FAILED }
    }

    /// Prints the message and returns the exit code.
    fn told(self) -> u8 {
        complain(self.message);
        self.code
    }
}

impl From<io::Error> for Refusal {
    fn from(error: io::Error) -> Self {
        Self::failed(error)
    }
}

impl From<CaseErrors> for Refusal {
    fn from(errors: CaseErrors) -> Self {
        Self { message: errors.to_string(), code: errors.exit_code() }
    }
}
