//! Runs and checks that one process asks of another, and the messages it gets back.

use super::CaseSource;
use pullout_case::CaseProblem;
use pullout_run::isolation::{self, Aftermath, Work};
use serde::{Deserialize, Serialize};
use std::num::NonZeroUsize;
use std::path::PathBuf;

/// Options of a run, which are the same in this process and in another one.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize, clap::Args)]
pub struct RunOptions {
    /// Also replace files in the result directory that pullout did not write or that were changed since, and list them.
    #[arg(long)]
    pub overwrite: bool,
    /// Save the state to checkpoint.bin in the result directory every N increments (kind "pullout").
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u64).range(1..))]
    pub checkpoint_every: Option<u64>,
    /// Number of threads for a case of kind "pullout" [default: the number of processors]. Results are bit for bit the
    /// same with any number.
    #[arg(long, value_name = "N", value_parser = at_least_one, allow_negative_numbers = true)]
    pub threads: Option<NonZeroUsize>,
    /// Write increments.json. Another case can repeat these increments with "increments": {"recorded": FILE}.
    #[arg(long)]
    pub record_increments: bool,
    /// Print only errors.
    #[arg(long)]
    pub quiet: bool,
    /// Also print what the plugins print (Fortran's units 6 and 7, printf). The result directory always has it in
    /// umat.log and umat.msg.
    #[arg(long)]
    pub echo: bool,
}

/// Parses a number of threads.
fn at_least_one(text: &str) -> Result<NonZeroUsize, String> {
    text.parse().map_err(|_| "a number from 1 on is needed".into())
}

/// Results that are wanted of a run.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub enum Keep {
    /// All that the case asks for.
    #[default]
    All,
    /// The same, as a part of a study, which has something to add.
    Member,
    /// What another process reads at once: no pictures and no report; the folder goes, so that nothing names it.
    Passing,
}

/// A run of a case into a folder.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct Job {
    /// The case.
    pub case: CaseSource,
    /// The result directory.
    #[serde(with = "isolation::path")]
    pub folder: PathBuf,
    /// Results to write.
    pub keep: Keep,
    /// Options.
    pub options: RunOptions,
    /// Whether the interrupted run in the folder is continued.
    pub goes_on: bool,
    /// Whether the columns, and from time to time the current row, are sent ([`Message`]).
    pub sends_rows: bool,
    /// What is known of a run that was ended from outside. If it is given, nothing is run: results are made from its rows.
    pub aftermath: Option<Aftermath>,
}

impl Job {
    /// A run with all results.
    pub fn new(case: CaseSource, folder: PathBuf, options: RunOptions) -> Self {
        Self { case, folder, keep: Keep::All, options, goes_on: false, sends_rows: false, aftermath: None }
    }
}

impl Work for Job {
    const NAME: &'static str = "run";
}

/// A check of a case.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Inspection {
    /// The case.
    pub case: CaseSource,
    /// Whether only errors are printed.
    pub quiet: bool,
    /// Whether the case will be run next. If so, what concerns the run is left to it, and the columns are sent ([`Message`]).
    pub before_run: bool,
}

impl Work for Inspection {
    const NAME: &'static str = "check";
}

/// Message of a process that runs or checks a case.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Message {
    /// Columns of the rows; for a check, those after step and increment.
    Columns(Vec<String>),
    /// The fraction done, and the current row: step, increment, values, iterations. `None`: NaN or infinite.
    Row(Vec<Option<f64>>),
    /// Reasons why nothing is run.
    Refused(Vec<CaseProblem>),
}
