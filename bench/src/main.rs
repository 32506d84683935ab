//! `pullout-bench`: run time against error of laws and specimens, what skipping saves, cost against unknowns, the same
//! work in other programs, the cost of the plugin ABI, throughput, numerical stability.
//!
//! Each item leaves its numbers as CSV, its pictures as SVG and one page of Markdown with the machine they were
//! measured on. Times are those of the calling thread's processor, of ways that take turns: what a figure
//! says is a ratio of such times, or a count.

mod abi;
mod engine;
mod fibre;
mod iterations;
mod laws;
mod machine;
mod page;
mod peers;
mod runs;
mod scaling;
mod slope;
mod solid;
mod stability;
mod table;
mod threads;
mod throughput;
mod timing;

use clap::{Parser, ValueEnum};
use page::Page;
use pullout_case::CaseErrors;
use pullout_run::PLUGIN_STACK;
use pullout_run::isolation::{
    self,
    prints::{plain, say},
};
use std::fmt;
use std::io::{self, Write};
use std::path::{Path, PathBuf};
use std::process::ExitCode;
use timing::Timing;
use umat_abi::host::LoadError;

/// Done.
const DONE: u8 = 0;
/// Something failed.
const FAILED: u8 = 1;
/// Wrong arguments; nothing was measured.
const BAD_INPUT: u8 = 2;
/// A plugin cannot be loaded.
const NO_PLUGIN: u8 = 3;

/// Measures run time against error, the cost of the plugin ABI, throughput, numerical stability.
#[derive(Debug, clap::Parser)]
#[command(name = "pullout-bench", version, max_term_width = 100)]
struct Arguments {
    /// Items to measure; default: all.
    #[arg(value_enum, value_name = "ITEM")]
    items: Vec<Item>,
    /// Only show that it works: seconds instead of minutes, and times that mean little.
    #[arg(long)]
    quick: bool,
    /// stability: states thrown at each form of a law in each stress state (default a million; 1000 if quick).
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u64).range(1..))]
    states: Option<u64>,
    /// Directory of the results.
    #[arg(long, value_name = "DIR", default_value = "bench/results")]
    out: PathBuf,
    /// peers: a Python that has simcoon, jaxmat and singlepointsim (default: PULLOUT_PYTHON, or python3 of the PATH).
    #[arg(long, value_name = "PYTHON")]
    python: Option<PathBuf>,
    /// Search this folder for plugins first (may be repeated).
    #[arg(long = "plugin-path", value_name = "DIR")]
    plugin_paths: Vec<PathBuf>,
}

/// Measures one item after the other; one that fails does not keep the others from being measured.
fn run(arguments: &Arguments) -> u8 {
    let mut items = arguments.items.clone();
    items.sort_unstable();
    items.dedup();
    let items = if items.is_empty() { Item::ALL } else { &items };
    let settings = Settings {
        quick: arguments.quick,
        states: arguments.states,
        python: arguments.python.clone().or_else(|| std::env::var_os("PULLOUT_PYTHON").map(PathBuf::from)),
        plugin_paths: arguments.plugin_paths.clone(),
    };
    let measure = |item: &Item| match measure(*item, &settings, &arguments.out) {
        Ok(Findings { text, failed }) => {
            say(&format!("{text}\n-> {}\n\n", arguments.out.join(format!("{}.md", item.name())).display()));
            failed.map_or(DONE, |failed| {
                complain(format!("{}: {failed}", item.name()));
                FAILED
            })
        }
        Err(error) => {
            complain(format!("{}: {error}", item.name()));
            match error {
                BenchError::Plugin(_) | BenchError::Missing { .. } => NO_PLUGIN,
                BenchError::Case(errors) => errors.exit_code(),
                BenchError::Failed(_) | BenchError::File(_) => FAILED,
            }
        }
    };
    items.iter().map(measure).max().unwrap_or(DONE)
}

fn main() -> ExitCode {
    isolation::look_where_it_was_built();
    // it measures calls in this process
    isolation::let_all_in();
    let arguments = match Arguments::try_parse() {
        Ok(arguments) => arguments,
        Err(message) => {
            // help and version are no errors
            let code = if message.use_stderr() { BAD_INPUT } else { DONE };
            let _ = message.print();
            return ExitCode::from(code);
        }
    };
    // Plugins with automatic arrays need more stack than the main thread has.
    let thread = std::thread::Builder::new().stack_size(PLUGIN_STACK).spawn(move || run(&arguments));
    match thread.map(std::thread::JoinHandle::join) {
        Ok(Ok(code)) => ExitCode::from(code),
        Ok(Err(panic)) => std::panic::resume_unwind(panic),
        Err(error) => {
            complain(format!("no thread with a stack of {PLUGIN_STACK} bytes can be started: {error}"));
            ExitCode::from(FAILED)
        }
    }
}

/// Prints to standard error.
fn complain(text: impl fmt::Display) {
    let _ = writeln!(io::stderr(), "{}", plain(&text.to_string()));
}

/// Items that can be measured.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, ValueEnum)]
pub enum Item {
    /// Error against run time of each law, of the thesis's algorithms, and of the driver, over the number of increments.
    Laws,
    /// Updates per second of each law, of one core and of all, in batches and one by one.
    Throughput,
    /// Error of a pull-out against run time, over mesh and increment, and where the time goes.
    Fe,
    /// Newton's iterations of five fibres by what makes each of them necessary.
    Iterations,
    /// Savings by skipping: each item, all of them, and the cost of a larger far field.
    Skipping,
    /// Cost of a specimen against its number of unknowns, and the growth of each part of it.
    Scaling,
    /// One run by one thread and by several: time, and whether the bits are the same.
    Threads,
    /// Cost of a point's run for a program that runs thousands.
    Engine,
    /// Comparison with CalculiX, simcoon, jaxmat and singlepointsim, where they are installed, on the same work.
    Peers,
    /// Random states thrown at the laws and plugins, variations of specimens: tried, failed, worst error.
    Stability,
    /// Cost of a plugin call: against the linked law, with the host's safeguards, against Fortran.
    Abi,
}

impl Item {
    /// All of them, in the order in which they run: the last one leaves a recorder of calls installed in the process.
    pub const ALL: &'static [Self] = &[
        Self::Laws,
        Self::Throughput,
        Self::Fe,
        Self::Iterations,
        Self::Skipping,
        Self::Scaling,
        Self::Threads,
        Self::Engine,
        Self::Peers,
        Self::Stability,
        Self::Abi,
    ];

    /// The stem of its files.
    pub fn name(self) -> &'static str {
        match self {
            Self::Laws => "laws",
            Self::Throughput => "throughput",
            Self::Fe => "fe",
            Self::Iterations => "iterations",
            Self::Skipping => "skipping",
            Self::Scaling => "scaling",
            Self::Threads => "threads",
            Self::Engine => "engine",
            Self::Peers => "peers",
            Self::Stability => "stability",
            Self::Abi => "abi",
        }
    }

    fn measure(self, settings: &Settings) -> Result<Page, BenchError> {
        match self {
            Self::Laws => laws::measure(settings),
            Self::Throughput => throughput::measure(settings),
            Self::Fe => fibre::precision::measure(settings),
            Self::Iterations => iterations::measure(settings),
            Self::Skipping => fibre::skipping::measure(settings),
            Self::Scaling => scaling::measure(settings),
            Self::Threads => threads::measure(settings),
            Self::Engine => engine::measure(settings),
            Self::Peers => peers::measure(settings),
            Self::Stability => stability::measure(settings),
            Self::Abi => abi::measure(settings),
        }
    }
}

/// Settings of the measurements.
#[derive(Clone, Debug)]
pub(crate) struct Settings {
    /// Only show that it works: seconds, and figures that mean little.
    pub quick: bool,
    /// States thrown at each form of a law in each stress state; `None`: a million, or few if quick.
    pub states: Option<u64>,
    /// A Python with the modules of peers; `None`: `python3` of the PATH.
    pub python: Option<PathBuf>,
    /// Searched for plugins before the usual folders.
    pub plugin_paths: Vec<PathBuf>,
}

impl Settings {
    fn timing(&self) -> Timing {
        if self.quick { Timing::QUICK } else { Timing::FULL }
    }
}

/// Reason why an item has no results.
#[derive(Debug)]
pub enum BenchError {
    /// A plugin cannot be loaded.
    Plugin(LoadError),
    /// A case that is run is refused: its plugin is missing.
    Case(CaseErrors),
    /// A plugin is in none of these folders.
    Missing {
        /// The plugin.
        plugin: String,
        /// Folders in which it was looked for.
        searched: Vec<PathBuf>,
    },
    /// Something that always works did not: a law refused its parameters, two ways disagreed.
    Failed(String),
    /// A file could not be written.
    File(io::Error),
}

impl fmt::Display for BenchError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Plugin(error) => error.fmt(f),
            Self::Case(errors) => errors.fmt(f),
            Self::Missing { plugin, searched } => f.write_str(&pullout_case::not_found(plugin, searched)),
            Self::Failed(message) => f.write_str(message),
            Self::File(error) => error.fmt(f),
        }
    }
}

impl From<CaseErrors> for BenchError {
    fn from(errors: CaseErrors) -> Self {
        Self::Case(errors)
    }
}

impl From<io::Error> for BenchError {
    fn from(error: io::Error) -> Self {
        Self::File(error)
    }
}

impl From<LoadError> for BenchError {
    fn from(error: LoadError) -> Self {
        Self::Plugin(error)
    }
}

/// Findings of an item.
#[derive(Clone, Debug)]
pub(crate) struct Findings {
    /// Text for a terminal.
    pub text: String,
    /// Findings that should not have been made.
    pub failed: Option<String>,
}

/// Measures an item and writes its files into a folder (made if missing).
///
/// # Errors
/// [`BenchError`]; no file of the item is written then.
pub(crate) fn measure(item: Item, settings: &Settings, folder: &Path) -> Result<Findings, BenchError> {
    let page = item.measure(settings)?;
    page.write(folder, item.name(), settings.quick)?;
    Ok(Findings { text: page.text(), failed: page.failed })
}
