//! `pullout bench`: run time against error of laws and specimens, what skipping saves, cost against unknowns, the same
//! work in other programs, the cost of the plugin ABI, throughput, numerical stability.
//!
//! Each item leaves its numbers as CSV, its pictures as SVG and one page of Markdown with the machine they were
//! measured on. Times are those of the calling thread's processor, of ways that take turns: what a figure
//! says is a ratio of such times, or a count.

mod abi;
mod fibre;
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

use crate::case::CaseErrors;
use clap::ValueEnum;
use page::Page;
use std::fmt;
use std::io;
use std::path::{Path, PathBuf};
use timing::Timing;
use umat_abi::host::LoadError;

/// What can be measured.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, ValueEnum)]
pub enum Item {
    /// Error against run time of each law, of the thesis's algorithms, and of the driver, over the number of increments.
    Laws,
    /// Updates per second of each law, of one core and of all, in batches and one by one.
    Throughput,
    /// Error of a pull-out against run time, over mesh and increment, and where the time goes.
    Fe,
    /// What skipping saves: each item, all of them, and what a larger far field costs.
    Skipping,
    /// What a specimen costs against its number of unknowns, and which part of it grows how.
    Scaling,
    /// One run by one thread and by several: time, and whether the bits are the same.
    Threads,
    /// The same work in CalculiX and simcoon, where they are installed.
    Peers,
    /// Random states thrown at the laws and plugins, variations of specimens: tried, failed, worst error.
    Stability,
    /// What a call of a plugin costs: against the linked law, with the host's safeguards, against Fortran.
    Abi,
}

impl Item {
    /// All of them, in the order in which they run: the last one leaves a recorder of calls installed in the process.
    pub const ALL: &'static [Self] = &[
        Self::Laws,
        Self::Throughput,
        Self::Fe,
        Self::Skipping,
        Self::Scaling,
        Self::Threads,
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
            Self::Skipping => "skipping",
            Self::Scaling => "scaling",
            Self::Threads => "threads",
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
            Self::Skipping => fibre::skipping::measure(settings),
            Self::Scaling => scaling::measure(settings),
            Self::Threads => threads::measure(settings),
            Self::Peers => peers::measure(settings),
            Self::Stability => stability::measure(settings),
            Self::Abi => abi::measure(settings),
        }
    }
}

/// How it is measured.
#[derive(Clone, Debug)]
pub struct Settings {
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

/// Why an item has no results.
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
        /// Where it was looked for.
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
            Self::Missing { plugin, searched } => f.write_str(&crate::case::not_found(plugin, searched)),
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

/// What an item found.
#[derive(Clone, Debug)]
pub struct Findings {
    /// For a terminal.
    pub text: String,
    /// What should not have been found.
    pub failed: Option<String>,
}

/// Measures an item and writes its files into a folder (made if missing).
///
/// # Errors
/// [`BenchError`]; no file of the item is written then.
pub fn measure(item: Item, settings: &Settings, folder: &Path) -> Result<Findings, BenchError> {
    let page = item.measure(settings)?;
    page.write(folder, item.name(), settings.quick)?;
    Ok(Findings { text: page.text(), failed: page.failed })
}
