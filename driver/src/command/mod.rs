//! The command line (cli-and-cases.md): what each command does, and the exit codes.

mod bench;
mod fit;
mod import;
mod isolated;
mod plot;
mod plugin;
mod props;
mod run;
mod study;

use crate::PLUGIN_STACK;
use crate::case::{self, Case, CaseErrors};
use crate::isolation;
use crate::isolation::prints::{Prints, say};
use crate::output::directory::Kind;
use crate::output::plain;
use crate::signals;
use clap::{Parser, Subcommand};
use std::ffi::OsString;
use std::num::NonZeroUsize;
use std::path::{Path, PathBuf};
use std::process::ExitCode;

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
    Run {
        /// Case files.
        #[arg(required = true, value_name = "CASE.json")]
        cases: Vec<PathBuf>,
        #[command(flatten)]
        results: run::Results,
        #[command(flatten)]
        reading: Reading,
        #[command(flatten)]
        interruption: run::Interruption,
        /// Threads that share the work of a case of kind "pullout"; default: the number of processors. The results have
        /// the same bits with any number.
        #[arg(long, value_name = "N")]
        threads: Option<NonZeroUsize>,
        /// Say nothing but errors.
        #[arg(long)]
        quiet: bool,
        /// Show what the plugins print (Fortran's units 6 and 7, printf), which is kept in umat.log and umat.msg of the
        /// result directory.
        #[arg(long)]
        echo: bool,
        /// End with this process; a study says so to its runs.
        #[arg(long, hide = true)]
        parent: Option<u32>,
    },
    /// Run families of cases on all processors, overlay them, and test what is claimed of them.
    Study(study::Arguments),
    /// Validate cases and studies: all errors at once, with the JSON path of each.
    Check {
        /// Case and study files.
        #[arg(required = true, value_name = "CASE.json")]
        cases: Vec<PathBuf>,
        #[command(flatten)]
        reading: Reading,
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
    /// One case in a process of its own; started by the program itself.
    #[command(name = isolation::worker::COMMAND, hide = true)]
    Worker {
        #[command(flatten)]
        task: isolation::Task,
        #[command(flatten)]
        reading: Reading,
    },
    /// Turn a one-element ABAQUS job with a user material into a case of kind "point".
    Import(import::Arguments),
    /// Find a law's parameters from an experiment.
    Fit {
        #[command(subcommand)]
        law: fit::Law,
    },
    /// Measure run time against error, the cost of the plugin ABI, throughput.
    Bench(bench::Arguments),
    /// Print calibrated parameters of a law.
    Props {
        #[command(subcommand)]
        law: props::Law,
    },
}

/// How case files are read.
#[derive(Debug, clap::Args)]
struct Reading {
    /// Override an entry, e.g. steps.0.increments=5 (VALUE is JSON, else a string; applies to all cases).
    #[arg(long = "set", value_name = "a.b.c=VALUE")]
    overrides: Vec<String>,
    /// Look for plugins here first (may be repeated).
    #[arg(long = "plugin-path", value_name = "DIR")]
    plugin_paths: Vec<PathBuf>,
}

impl Reading {
    /// Reads a case. What its plugins print meanwhile belongs to no run.
    fn case(&self, file: &Path) -> Result<Case, CaseErrors> {
        let _prints = Prints::discard();
        case::read(file, &self.overrides, &self.plugin_paths)
    }

    /// Why and how a case runs in a process of its own, if it does.
    fn need(&self, file: &Path) -> Option<isolation::Need> {
        isolation::need(file, &self.overrides, &self.plugin_paths)
    }
}

/// How many threads can run at the same time.
fn processors() -> NonZeroUsize {
    std::thread::available_parallelism().unwrap_or(NonZeroUsize::MIN)
}

/// Runs the program with these arguments; the result is its exit code.
pub fn main(arguments: impl IntoIterator<Item = OsString>) -> ExitCode {
    let arguments = match Arguments::try_parse_from(arguments) {
        Ok(arguments) => arguments,
        Err(message) => {
            // help and version are no errors
            let code = if message.use_stderr() { BAD_INPUT } else { DONE };
            let _ = message.print();
            return ExitCode::from(code);
        }
    };
    // Plugins with automatic arrays need more stack than the main thread has.
    let act = move || act(arguments.command);
    let thread = std::thread::Builder::new().name("pullout".into()).stack_size(PLUGIN_STACK).spawn(act);
    match thread.map(std::thread::JoinHandle::join) {
        Ok(Ok(code)) => ExitCode::from(code),
        Ok(Err(panic)) => std::panic::resume_unwind(panic),
        Err(error) => {
            complain(format!("no thread with a stack of {PLUGIN_STACK} bytes can be started: {error}"));
            ExitCode::from(FAILED)
        }
    }
}

/// Does what a command line without the program's name says; the result is the exit code.
fn act_on(arguments: &[OsString]) -> u8 {
    match Arguments::try_parse_from(std::iter::once(&OsString::from("pullout")).chain(arguments)) {
        Ok(arguments) => act(arguments.command),
        Err(message) => {
            complain(message);
            BAD_INPUT
        }
    }
}

/// Does what a command says; the result is the exit code.
fn act(command: Command) -> u8 {
    // a study and a supervisor end at a second signal, and what they started with them
    let listening = match &command {
        Command::Run { parent, .. } => signals::listen(parent.is_none()),
        Command::Worker { .. } => signals::listen(false),
        Command::Study(_) => signals::listen(true),
        _ => signals::write_beyond_limits_fails(),
    };
    if let Err(error) = listening {
        complain(format!("signals cannot be listened to: {error}"));
    }
    match command {
        Command::Run { cases, results, reading, interruption, threads, quiet, echo, parent } => {
            if let Some(parent) = parent {
                // where it cannot be asked for, a run outlives its study
                let _ = isolation::die_with(parent);
            }
            let threads = threads.unwrap_or_else(processors);
            // a study's run has what the study adds to its results
            let kind = if parent.is_some() { Kind::Member } else { Kind::Run };
            run::run(&cases, &results, kind, &reading, &interruption, threads, run::Telling { quiet, echo })
        }
        Command::Study(arguments) => study::run_all(&arguments),
        Command::Check { cases, reading } => run::check(&cases, &reading),
        Command::Plugin { action } => plugin::act(&action),
        Command::Schema => schema(),
        Command::Plot(arguments) => plot::plot(&arguments),
        Command::Import(arguments) => import::run(&arguments),
        Command::Fit { law } => fit::act(&law),
        Command::Bench(arguments) => bench::run(&arguments),
        Command::Props { law } => props::print(&law),
        Command::Worker { task, reading } => isolated::work(&task, &reading),
    }
}

fn schema() -> u8 {
    say(&format!("{:#}\n", crate::case::schema()));
    DONE
}

/// Prints to standard error.
fn complain(text: impl std::fmt::Display) {
    use std::io::Write;
    let _ = writeln!(std::io::stderr(), "{}", plain(&text.to_string()));
}

/// Prints a case's problems and returns their exit code.
fn refuse(errors: &CaseErrors) -> u8 {
    complain(errors);
    errors.exit_code()
}
