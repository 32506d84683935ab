//! Checks and their outcomes.

use pullout_run::isolation::worker;
use serde::{Deserialize, Serialize};
use std::fmt;

/// Outcome of a check.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Verdict {
    /// Passed.
    Pass,
    /// A claim of the metadata, or the contract itself, is broken.
    Fail,
    /// Suspicious, but nothing was promised.
    Warn,
    /// A figure to know.
    Info,
    /// Not applicable: the law does not claim it.
    Skipped,
    /// Undecided: nothing that was looked at could have shown an error, or nothing was looked at.
    #[serde(rename = "not tested")]
    NotTested,
}

impl fmt::Display for Verdict {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.pad(match self {
            Self::Pass => "pass",
            Self::Fail => "FAIL",
            Self::Warn => "warn",
            Self::Info => "info",
            Self::Skipped => "-",
            Self::NotTested => "void",
        })
    }
}

/// One check of one stress state.
#[derive(Clone, Debug, Serialize)]
pub struct Row {
    /// Name of the check.
    pub check: &'static str,
    /// Stress state or entry point; "-" for the metadata.
    pub stress_state: &'static str,
    /// Outcome.
    pub verdict: Verdict,
    /// The number that decided.
    pub figure: String,
    /// Place, expected value and value found.
    pub detail: String,
}

impl fmt::Display for Row {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { check, stress_state, verdict, figure, detail } = self;
        // as wide as the longest names
        let line = format!("{verdict:4}  {check:19}  {stress_state:21}  {figure:16}  {detail}");
        f.write_str(line.trim_end())
    }
}

/// Event of a check, reported as it happens.
#[derive(Clone, Copy, Debug)]
pub enum Event<'a> {
    /// A check of an entry point begins.
    Begins(&'static str, &'static str),
    /// A state of the sample is drawn; whether it is a long step away from the case's path.
    Draws(usize, bool),
    /// A check has ended.
    Ends(&'a Row),
}

/// All rows.
#[derive(Clone, Debug, Default)]
pub struct Report {
    /// Rows in the order of the checks.
    pub rows: Vec<Row>,
    /// Told of what happens.
    pub(super) listener: Option<fn(Event<'_>)>,
}

impl Report {
    /// True unless a row failed, or the law was never seen beyond its elastic range.
    pub fn passed(&self) -> bool {
        self.failures().next().is_none() && !self.is_vacuous()
    }

    /// Returns whether what was looked at says nothing of the law.
    pub fn is_vacuous(&self) -> bool {
        self.rows.iter().any(|row| row.verdict == Verdict::NotTested)
    }

    /// The rows that failed.
    pub fn failures(&self) -> impl Iterator<Item = &Row> {
        self.rows.iter().filter(|row| row.verdict == Verdict::Fail)
    }

    /// Returns how many checks failed, in words.
    pub fn conclusion(&self) -> String {
        match self.failures().count() {
            0 if self.is_vacuous() => {
                let void = self.rows.iter().filter(|row| row.verdict == Verdict::NotTested).count();
                format!("not tested: {} checks, {void} of which tell nothing of the law", self.rows.len())
            }
            0 => format!("{} checks, none failed", self.rows.len()),
            failures => format!("{} checks, {failures} failed", self.rows.len()),
        }
    }
}

impl fmt::Display for Report {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.rows.iter().try_for_each(|row| writeln!(f, "{row}"))?;
        writeln!(f, "{}", self.conclusion())
    }
}

/// Adds the rows of one stress state.
pub(super) struct Ledger<'r> {
    report: &'r mut Report,
    stress_state: &'static str,
    /// Rows that another process reports are not wanted.
    pub(super) is_muted: bool,
}

impl<'r> Ledger<'r> {
    pub(super) fn new(report: &'r mut Report, stress_state: &'static str) -> Self {
        Self { report, stress_state, is_muted: false }
    }

    /// Says which check the calls from now on belong to.
    pub(super) fn begin(&mut self, check: &'static str) {
        worker::begin_calls();
        if let Some(listener) = self.report.listener {
            listener(Event::Begins(check, self.stress_state));
        }
    }

    /// Says which state of the sample the calls from now on draw.
    pub(super) fn draw(&mut self, number: usize, is_far: bool) {
        if let Some(listener) = self.report.listener {
            listener(Event::Draws(number, is_far));
        }
    }

    pub(super) fn add(
        &mut self,
        check: &'static str,
        verdict: Verdict,
        figure: impl Into<String>,
        detail: impl Into<String>,
    ) {
        if self.is_muted {
            return;
        }
        let (figure, detail) = (figure.into(), detail.into());
        let row = Row { check, stress_state: self.stress_state, verdict, figure, detail };
        if let Some(listener) = self.report.listener {
            listener(Event::Ends(&row));
        }
        self.report.rows.push(row);
    }

    pub(super) fn skip(&mut self, check: &'static str, reason: &str) {
        self.add(check, Verdict::Skipped, "", reason);
    }
}
