//! A family of runs: a case that is varied, its results side by side, and what is claimed of them.
//!
//! A study file (`document`) is read and every run's case is checked (`read`) before anything runs. Each run is a process
//! of its own, so that a plugin meets the same program as in a single run; its results are an ordinary result directory
//! (`execution`). What is done already is not done again while neither the case, nor its files, nor the program changed
//! ([`CaseSource::key`]), and the user hears of each run that ends ([`StudyProgress`]). Then the runs are compared ([`results`]), the
//! claims are tested ([`claims`]), and pictures, tables and a report are made ([`pictures`], `table`, `report`).

pub mod claims;

mod demand;
mod execution;
mod fibres;
pub mod pictures;
mod progress;
mod read;
mod report;
pub mod results;
mod table;

pub use claims::{ClaimFinding, Verdict};
pub use demand::Demand;
pub use execution::{Execution, RunOutcome, execute};
pub use fibres::curves_of_fibres;
pub use progress::{StudyProgress, outcome};
pub use pullout_case::study::{Abscissa, Columns, NamedQuantity, QuantityOfFile as Quantity};
pub use read::{default_curve, read};
pub use report::write as write_report;
pub use results::{Results, RunResult};
pub use table::{FILE, write_csv, write_json};

use pullout_engine::CaseSource;
use std::cmp::Ordering;
use std::collections::BTreeSet;
use std::path::PathBuf;

/// A study that was read.
#[derive(Clone, Debug, Default)]
pub struct Study {
    /// The study file.
    pub file: PathBuf,
    /// Title of pictures and report.
    pub title: String,
    /// Text for the report.
    pub description: String,
    /// Quantity that is varied, if members have an x.
    pub x: Option<Abscissa>,
    /// The runs of each series.
    pub members: Vec<Member>,
    /// Lists of runs with the same members.
    pub series: Vec<RunSeries>,
    /// All runs, series by series.
    pub runs: Vec<StudyRun>,
    /// The curve whose peak and work count.
    pub curve: Columns,
    /// Units of the curve's columns.
    pub units: [String; 2],
    /// End of the integral for the work; `None`: what suits all runs that are done.
    pub work_to: Option<f64>,
    /// More pictures of all runs.
    pub overlays: Vec<Columns>,
    /// Claims that are tested.
    pub claims: Vec<Claim>,
    /// The history columns that the file names; those of cases that were not read are not checked yet.
    pub demands: Vec<Demand>,
}

impl Study {
    /// The history columns that it looks at.
    pub fn columns(&self) -> BTreeSet<&str> {
        let pairs = std::iter::once(&self.curve).chain(&self.overlays).flat_map(|pair| [&pair.x, &pair.y]);
        let of_claims = self.claims.iter().filter_map(|claim| match &claim.quantity {
            Quantity::Named(_) => None,
            Quantity::Column(value) => Some(std::iter::once(&value.column).chain(value.over())),
        });
        pairs.chain(of_claims.flatten()).map(String::as_str).collect()
    }

    /// The run of a member in a series.
    pub(crate) fn run_of(&self, series: usize, member: usize) -> usize {
        series * self.members.len() + member
    }

    /// "bent/45".
    pub fn name_of(&self, run: &StudyRun) -> String {
        format!("{}/{}", self.series[run.series].name, self.members[run.member].label)
    }

    /// The members by rising x; those without one stay as they are.
    fn members_by_x(&self) -> Vec<usize> {
        let x = |member: usize| self.members[member].x;
        let mut order: Vec<usize> = (0..self.members.len()).collect();
        order.sort_by(|&a, &b| x(a).partial_cmp(&x(b)).unwrap_or(Ordering::Equal));
        order
    }
}

/// One run of each series.
#[derive(Clone, Debug, PartialEq)]
pub struct Member {
    /// Short name, and name of the result directory.
    pub label: String,
    /// Title in legends and tables.
    pub title: String,
    /// Value of x.
    pub x: Option<f64>,
}

impl Member {
    /// Returns whether x is strictly between two values.
    fn is_between(&self, [lower, upper]: [f64; 2]) -> bool {
        self.x.is_some_and(|x| lower < x && x < upper)
    }
}

/// A list of runs.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct RunSeries {
    /// Short name, and name of the directory of its runs.
    pub name: String,
    /// Title in legends and tables.
    pub title: String,
}

/// A run of the study.
#[derive(Clone, Debug, Default)]
pub struct StudyRun {
    /// Index of its series.
    pub series: usize,
    /// Index of its member.
    pub member: usize,
    /// The case.
    pub case: CaseSource,
    /// Result directory below the study's.
    pub folder: PathBuf,
    /// Hash of everything that its rows depend on.
    pub fingerprint: String,
    /// Things the user should know of its case although nothing is wrong.
    pub warnings: Vec<String>,
}

/// A claim and its test.
#[derive(Clone, Debug, PartialEq)]
pub struct Claim {
    /// Text of the claim.
    pub claim: String,
    /// Indices of the series in each of which it must be found.
    pub series: Vec<usize>,
    /// Indices of the members that are looked at, in the order of their x.
    pub members: Vec<usize>,
    /// Quantity that a claim looks at.
    pub quantity: Quantity,
    /// The test.
    pub expectation: pullout_case::study::Expectation,
}
