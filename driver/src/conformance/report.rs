//! What was checked and what came out.

use std::fmt;

/// What a check found.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Verdict {
    /// As it should be.
    Pass,
    /// A claim of the metadata, or the contract itself, is broken.
    Fail,
    /// Suspicious, but nothing was promised.
    Warn,
    /// A figure to know.
    Info,
    /// Not applicable: not claimed.
    Skipped,
}

impl fmt::Display for Verdict {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.pad(match self {
            Self::Pass => "pass",
            Self::Fail => "FAIL",
            Self::Warn => "warn",
            Self::Info => "info",
            Self::Skipped => "-",
        })
    }
}

/// One check of one stress state.
#[derive(Clone, Debug)]
pub struct Row {
    /// What was checked.
    pub check: &'static str,
    /// Stress state or entry point; "-" for the metadata.
    pub stress_state: &'static str,
    /// What came out.
    pub verdict: Verdict,
    /// The number that decided.
    pub figure: String,
    /// Where, what was expected, what found.
    pub detail: String,
}

/// All rows.
#[derive(Clone, Debug, Default)]
pub struct Report {
    /// In the order of the checks.
    pub rows: Vec<Row>,
}

impl Report {
    /// True unless a row failed.
    pub fn passed(&self) -> bool {
        self.rows.iter().all(|row| row.verdict != Verdict::Fail)
    }

    /// The rows that failed.
    pub fn failures(&self) -> impl Iterator<Item = &Row> {
        self.rows.iter().filter(|row| row.verdict == Verdict::Fail)
    }
}

impl fmt::Display for Report {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let width = |text: fn(&Row) -> &str| self.rows.iter().map(|row| text(row).chars().count()).max().unwrap_or(0);
        let (check, state, figure) = (width(|r| r.check), width(|r| r.stress_state), width(|r| &r.figure));
        for row in &self.rows {
            let line = format!(
                "{:4}  {:check$}  {:state$}  {:figure$}  {}",
                row.verdict, row.check, row.stress_state, row.figure, row.detail
            );
            writeln!(f, "{}", line.trim_end())?;
        }
        let failures = self.failures().count();
        match failures {
            0 => writeln!(f, "{} checks, none failed", self.rows.len()),
            _ => writeln!(f, "{} checks, {failures} failed", self.rows.len()),
        }
    }
}

/// Adds the rows of one stress state.
pub(super) struct Ledger<'r> {
    report: &'r mut Report,
    stress_state: &'static str,
}

impl<'r> Ledger<'r> {
    pub(super) fn new(report: &'r mut Report, stress_state: &'static str) -> Self {
        Self { report, stress_state }
    }

    pub(super) fn add(
        &mut self,
        check: &'static str,
        verdict: Verdict,
        figure: impl Into<String>,
        detail: impl Into<String>,
    ) {
        let (figure, detail) = (figure.into(), detail.into());
        self.report.rows.push(Row { check, stress_state: self.stress_state, verdict, figure, detail });
    }

    pub(super) fn skip(&mut self, check: &'static str, reason: &str) {
        self.add(check, Verdict::Skipped, "", reason);
    }
}
