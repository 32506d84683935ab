//! Checks and their outcomes.

use pullout_run::isolation::worker;
use serde::{Deserialize, Serialize};
use serde_json::Value;
use std::borrow::Cow;
use std::fmt;
use std::path::PathBuf;

/// Outcome of a check.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
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
    #[default]
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
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct CheckRow {
    /// Name of the check.
    pub check: Cow<'static, str>,
    /// Stress state or entry point; "-" for the metadata.
    pub stress_state: Cow<'static, str>,
    /// Outcome.
    pub verdict: Verdict,
    /// The number that decided.
    pub figure: String,
    /// Place, expected value and value found.
    pub detail: String,
}

impl fmt::Display for CheckRow {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { check, stress_state, verdict, figure, detail } = self;
        // as wide as the longest names
        let line = format!("{verdict:4}  {check:19}  {stress_state:21}  {figure:16}  {detail}");
        f.write_str(line.trim_end())
    }
}

/// Event of a check, reported as it happens: from process to process as a line of JSON.
#[derive(Clone, Debug, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Event {
    /// The checks of a law of a library begin.
    Law(String, PathBuf),
    /// A check of an entry point begins.
    Begins(Cow<'static, str>, Cow<'static, str>),
    /// A state of the sample is drawn; whether it is a long step away from the case's path.
    Draws(usize, bool),
    /// A check has ended.
    Row(CheckRow),
}

/// All rows.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
pub struct Report {
    /// Rows in the order of the checks.
    pub rows: Vec<CheckRow>,
    /// Receives each event as it occurs, since a plugin may end the process.
    #[serde(skip)]
    pub(super) listener: Option<fn(Event)>,
}

impl Report {
    /// True unless a row failed, or the law was never seen beyond its elastic range.
    pub fn passed(&self) -> bool {
        self.verdict() == Verdict::Pass
    }

    /// Returns whether what was looked at says nothing of the law.
    pub fn is_vacuous(&self) -> bool {
        self.rows.iter().any(|row| row.verdict == Verdict::NotTested)
    }

    /// The rows that failed.
    pub fn failures(&self) -> impl Iterator<Item = &CheckRow> {
        self.rows.iter().filter(|row| row.verdict == Verdict::Fail)
    }

    /// Returns what all rows together say of the law.
    pub fn verdict(&self) -> Verdict {
        if self.failures().next().is_some() {
            Verdict::Fail
        } else if self.is_vacuous() {
            Verdict::NotTested
        } else {
            Verdict::Pass
        }
    }

    /// Returns a sentence with the number of failed checks and of warnings, and their names.
    pub fn conclusion(&self) -> String {
        let count = match self.rows.len() {
            1 => "1 check".to_owned(),
            many => format!("{many} checks"),
        };
        let outcome = match self.failures().count() {
            0 if self.is_vacuous() => {
                let void = self.rows.iter().filter(|row| row.verdict == Verdict::NotTested).count();
                format!("not tested: {count}, {void} of which say nothing about the law")
            }
            0 => format!("{count}: none failed"),
            failures => format!("{count}: {failures} failed"),
        };
        let warnings: Vec<&str> =
            self.rows.iter().filter(|row| row.verdict == Verdict::Warn).map(|row| &*row.check).collect();
        match warnings.len() {
            0 => outcome,
            1 => format!("{outcome}, 1 warning: {}", warnings[0]),
            number => format!("{outcome}, {number} warnings: {}", warnings.join(", ")),
        }
    }
}

impl fmt::Display for Report {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.rows.iter().try_for_each(|row| writeln!(f, "{row}"))?;
        writeln!(f, "{}", self.conclusion())
    }
}

/// Checks of a law, and what they came to.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
pub struct Judged {
    /// Name of the law.
    pub name: String,
    /// File of its library.
    pub library: String,
    /// Verdict of the report.
    pub verdict: Verdict,
    /// Conclusion of the report.
    pub conclusion: String,
    /// Rows.
    #[serde(flatten)]
    pub report: Report,
    /// Cases that repeat calls that did not come back.
    pub replays: Vec<Value>,
}

/// Checks of the laws of a library, as `pullout plugin check --json` prints them and as one process sends them to another.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct Judgement {
    /// Verdict of a law that failed; otherwise of one that was not tested; otherwise passed.
    pub verdict: Verdict,
    /// Laws.
    pub laws: Vec<Judged>,
}

impl Judgement {
    /// Concludes the checks of all laws; without a law they failed.
    pub fn of(mut laws: Vec<Judged>) -> Self {
        for law in &mut laws {
            (law.verdict, law.conclusion) = (law.report.verdict(), law.report.conclusion());
        }
        let is_of = |verdict: &Verdict| laws.iter().any(|law| law.verdict == *verdict);
        let first = [Verdict::Fail, Verdict::NotTested, Verdict::Pass].into_iter().find(is_of);
        Self { verdict: first.unwrap_or(Verdict::Fail), laws }
    }
}

/// Adds the rows of one stress state.
pub(super) struct Ledger<'r> {
    report: &'r mut Report,
    stress_state: &'static str,
    /// The check that was begun last.
    check: &'static str,
    /// Rows that another process reports are not wanted.
    pub(super) is_muted: bool,
}

impl<'r> Ledger<'r> {
    pub(super) fn new(report: &'r mut Report, stress_state: &'static str) -> Self {
        Self { report, stress_state, check: "", is_muted: false }
    }

    /// Says which check the calls from now on belong to.
    pub(super) fn begin(&mut self, check: &'static str) {
        self.check = check;
        worker::begin_calls();
        if let Some(listener) = self.report.listener {
            listener(Event::Begins(check.into(), self.stress_state.into()));
        }
    }

    /// Says which state of the sample the calls from now on draw.
    pub(super) fn draw(&mut self, number: usize, is_far: bool) {
        if let Some(listener) = self.report.listener {
            listener(Event::Draws(number, is_far));
        }
    }

    /// Adds a row of the check that was begun last.
    pub(super) fn add(&mut self, verdict: Verdict, figure: impl Into<String>, detail: impl Into<String>) {
        self.row(self.check, verdict, figure, detail);
    }

    /// Adds a row of another check.
    pub(super) fn row(
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
        let row = CheckRow { check: check.into(), stress_state: self.stress_state.into(), verdict, figure, detail };
        if let Some(listener) = self.report.listener {
            listener(Event::Row(row.clone()));
        }
        self.report.rows.push(row);
    }

    /// Says why the check that was begun last does not apply.
    pub(super) fn skip(&mut self, reason: &str) {
        self.add(Verdict::Skipped, "", reason);
    }
}
