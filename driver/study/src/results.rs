//! Results of the runs, and the numbers that are compared.
//!
//! # Equations
//!
//! Work along the path of the curve, with y linear between the lines of the history, to its end or to where x first passes
//! x_c:
//!
//! ```text
//! W = ∫ y dx, trapezoidal
//! ```
//!
//! The work of a crack, ∫σ dw, is that of its summary where this has it up to x_c: there rows are no limit.
//!
//! Work that is given back where x turns counts with its sign: W of a closed cycle is its dissipation.

use super::execution::{RunOutcome, is_refused};
use super::{Columns, Quantity, Study, StudyRun};
use pullout_case::study::{NamedPlace, NamedQuantity, Where};
use pullout_report::history::History;
use pullout_report::summary::{Status, Summary};
use std::path::Path;

/// A common end is reached within this part of it: the last increment of a step ends where rounding leaves it.
const END_TOLERANCE: f64 = 1e-9;

/// A path that turns back by no more than this part of its reach goes one way: a step that ends, a specimen that snaps back.
const LARGEST_RETURN: f64 = 0.05;

/// Results of all runs.
#[derive(Clone, Debug)]
pub struct Results {
    /// Results of the runs, in the study's order.
    pub runs: Vec<RunResult>,
    /// End of the integral for the work; `None`: the end of each run.
    pub work_to: Option<f64>,
}

/// Results of a run.
#[derive(Clone, Debug, Default)]
pub struct RunResult {
    /// `None`: it was not run.
    pub status: Option<Status>,
    /// Reason why it failed.
    pub message: Option<String>,
    /// Whether the results were there before.
    pub is_kept: bool,
    /// Columns of its history that the study looks at.
    pub history: History,
    /// Summary, if it came so far.
    pub summary: Option<Summary>,
    /// Greatest ordinate of the curve in magnitude, with its sign.
    pub peak: Option<f64>,
    /// The abscissa there.
    pub slip_at_peak: Option<f64>,
    /// The last ordinate.
    pub end: Option<f64>,
    /// The greatest abscissa in magnitude, with its sign.
    pub reach: Option<f64>,
    /// The integral along the curve up to the common end; `None` if the run does not reach it.
    pub work: Option<f64>,
}

impl Results {
    /// Reads the result directories below `out`.
    pub fn read(study: &Study, out: &Path, states: &[RunOutcome]) -> Self {
        let mut runs: Vec<RunResult> =
            study.runs.iter().zip(states).map(|(run, state)| RunResult::read(run, study, out, *state)).collect();
        let curves: Vec<_> = runs.iter().filter(|run| run.is_done()).map(|run| run.curve(&study.curve)).collect();
        let work_to = study.work_to.or_else(|| common_end(&curves));
        for run in &mut runs {
            run.find_work(&study.curve, work_to);
        }
        Self { runs, work_to }
    }
}

impl RunResult {
    /// Reads the results of a run from its directory below `out`.
    pub(super) fn read(run: &StudyRun, study: &Study, out: &Path, state: RunOutcome) -> Self {
        let folder = out.join(&run.folder);
        if state == RunOutcome::NotRun {
            return Self::default();
        }
        if let RunOutcome::Ran(code) = state
            && is_refused(code)
        {
            let message = Some("it was not run; output.txt has the reason".into());
            return Self { status: Some(Status::Failed), message, ..Self::default() };
        }
        let columns = Vec::from_iter(study.columns());
        let history = History::of_run(&folder, |table| table.read_columns(&columns)).unwrap_or_default();
        let summary = Summary::read(&folder.join("summary.json")).ok();
        let mut result = Self { is_kept: state == RunOutcome::Kept, ..Self::of(history, summary, &study.curve) };
        if result.summary.is_none() {
            result.message = Some("it ended without a summary; output.txt has what it printed".into());
        }
        result
    }

    /// Makes results of rows and summary, with the numbers of a curve but the work.
    pub fn of(history: History, summary: Option<Summary>, columns: &Columns) -> Self {
        let mut result = Self {
            // without a summary it did not come to an end of its own
            status: Some(summary.as_ref().map_or(Status::Failed, |summary| summary.status)),
            message: summary.as_ref().and_then(|summary| summary.message.clone()),
            history,
            summary,
            ..Self::default()
        };
        let curve = result.curve(columns);
        let finite = || curve.iter().copied().filter(|(x, y)| x.is_finite() && y.is_finite());
        let greatest = finite().reduce(|best, point| if point.1.abs() > best.1.abs() { point } else { best });
        (result.slip_at_peak, result.peak) = greatest.unzip();
        // what output.every left out of the history counts as well
        let of_summary = result.summary.as_ref().and_then(|summary| summary.specimen.as_ref()?.peak_load);
        if let Some(peak) = of_summary.filter(|_| columns.y == "load") {
            result.peak = Some(peak.load);
            result.slip_at_peak = Some(peak.slip).filter(|_| columns.x == "slip").or(result.slip_at_peak);
        }
        // σ(w) is known between the rows of a crack as well
        let crack = result.summary.as_ref().and_then(|summary| summary.bridging.as_ref());
        let of_crack = crack.and_then(|crack| match columns.y.as_str() {
            "sigma" => Some((crack.w_peak, crack.sigma_peak)),
            "sigma_fibre" => Some((crack.w_fibre_peak, crack.sigma_fibre_peak)),
            _ => None,
        });
        if let Some((opening, peak)) = of_crack {
            result.peak = Some(peak);
            result.slip_at_peak = Some(opening).filter(|_| columns.x == "w").or(result.slip_at_peak);
        }
        result.end = finite().next_back().map(|(_, y)| y);
        result.reach = farthest(finite().map(|(x, _)| x));
        result
    }

    /// Finds the integral along the curve up to an end, or along all of it.
    pub fn find_work(&mut self, columns: &Columns, to: Option<f64>) {
        self.work = self.work_of_crack(columns, to).or_else(|| work(&self.curve(columns), to));
    }

    /// Returns the integral of σ(w), which rows do not limit, if the summary has it up to this end.
    fn work_of_crack(&self, columns: &Columns, to: Option<f64>) -> Option<f64> {
        let works =
            &self.summary.as_ref()?.bridging.as_ref().filter(|_| [&columns.x, &columns.y] == ["w", "sigma"])?.work;
        let known = match to {
            Some(end) => works.iter().find(|work| is_near(work.to, end, end)),
            None => works.last(),
        };
        known.map(|work| work.work)
    }

    /// Returns whether it came to its end.
    pub fn is_done(&self) -> bool {
        self.status == Some(Status::Done)
    }

    /// The status as tables have it.
    pub(super) fn status_in_words(&self) -> &'static str {
        match self.status {
            Some(Status::Done) => "done",
            Some(Status::Failed) => "failed",
            Some(Status::Interrupted) => "interrupted",
            None => "not run",
        }
    }

    /// The greatest energy error of a specimen.
    pub(super) fn energy_error_max(&self) -> Option<f64> {
        self.summary.as_ref()?.specimen.as_ref()?.energy_error_max
    }

    /// Two columns of the history.
    pub fn curve(&self, columns: &Columns) -> Vec<(f64, f64)> {
        let column = |name: &str| self.history.column(name).unwrap_or_default();
        column(&columns.x).iter().copied().zip(column(&columns.y).iter().copied()).collect()
    }

    /// Returns a number of a finished run; `None` if the run is not finished or has no such number.
    pub fn value(&self, quantity: &Quantity, curve: &Columns) -> Option<f64> {
        if !self.is_done() {
            return None;
        }
        let summary = self.summary.as_ref();
        let number = match quantity {
            Quantity::Named(NamedQuantity::Peak) => self.peak?,
            Quantity::Named(NamedQuantity::SlipAtPeak) => self.slip_at_peak?,
            Quantity::Named(NamedQuantity::Work) => self.work?,
            Quantity::Named(NamedQuantity::End) => self.end?,
            Quantity::Named(NamedQuantity::Increments) => summary?.increments as f64,
            Quantity::Named(NamedQuantity::Iterations) => summary?.iterations as f64,
            Quantity::Named(NamedQuantity::Cutbacks) => summary?.cutbacks as f64,
            Quantity::Named(NamedQuantity::EnergyErrorMax) => self.energy_error_max()?,
            Quantity::Named(NamedQuantity::CpuTime) => summary?.cpu_time_s?,
            Quantity::Column(value) => {
                let line = self.line(&value.column, value.at(), curve)?;
                let of = |name: &str| self.history.column(name)?.get(line).copied();
                let whole: Option<f64> = value.over().iter().map(|name| of(name)).sum();
                of(&value.column)? / if value.over().is_empty() { 1.0 } else { whole? }
            }
        };
        number.is_finite().then_some(number)
    }

    /// Returns the index of a row of the history.
    fn line(&self, column: &str, at: Where, curve: &Columns) -> Option<usize> {
        let column_of = |name: &str| self.history.column(name);
        let extreme = |values: &[f64], sign: f64| {
            let finite = (0..values.len()).filter(|&k| values[k].is_finite());
            finite.reduce(|best, k| if sign * values[k] > sign * values[best] { k } else { best })
        };
        match at {
            Where::Named(NamedPlace::End) => column_of(column)?.len().checked_sub(1),
            Where::Named(NamedPlace::Greatest) => extreme(column_of(column)?, 1.0),
            Where::Named(NamedPlace::Least) => extreme(column_of(column)?, -1.0),
            Where::Named(NamedPlace::Peak) => {
                let magnitudes: Vec<f64> = column_of(&curve.y)?.iter().map(|y| y.abs()).collect();
                extreme(&magnitudes, 1.0)
            }
            Where::X(end) => {
                let along = column_of(&curve.x)?;
                let way = end - along.first()?;
                let short = END_TOLERANCE * end.abs();
                along.iter().position(|x| if way < 0.0 { *x <= end + short } else { *x >= end - short })
            }
        }
    }
}

/// The greatest number in magnitude, with its sign.
fn farthest(numbers: impl Iterator<Item = f64>) -> Option<f64> {
    numbers.reduce(|far, x| if x.abs() > far.abs() { x } else { far })
}

/// Returns the x up to which the work of several runs is compared: the end of the shortest run, if no run has a reversal and all go
/// in one direction. Otherwise, or if all end at the same x, `None`: the end of each run.
fn common_end(curves: &[Vec<(f64, f64)>]) -> Option<f64> {
    let mut ends = Vec::new();
    for curve in curves {
        let finite = || curve.iter().map(|(x, _)| *x).filter(|x| x.is_finite());
        let (Some(end), Some(far)) = (finite().next_back(), farthest(finite())) else { continue };
        let mut furthest = f64::NEG_INFINITY;
        for way in finite().map(|x| x * far.signum()) {
            furthest = way.max(furthest);
            if way < furthest - LARGEST_RETURN * far.abs() {
                return None;
            }
        }
        ends.push(end);
    }
    let shortest = ends.iter().copied().reduce(|short, end| if end.abs() < short.abs() { end } else { short })?;
    let is_apart = |end: &f64| !is_near(*end, shortest, shortest);
    (ends.iter().all(|end| end * shortest > 0.0) && ends.iter().any(is_apart)).then_some(shortest)
}

fn is_near(one: f64, other: f64, scale: f64) -> bool {
    (one - other).abs() <= END_TOLERANCE * scale.abs()
}

/// ∫ y dx along a curve, up to where x first passes `to`; `None` if it does not.
fn work(curve: &[(f64, f64)], to: Option<f64>) -> Option<f64> {
    let (first, _) = *curve.first()?;
    let mut sum = 0.0;
    for ends in curve.windows(2) {
        let [(a_x, a_y), (b_x, b_y)] = [ends[0], ends[1]];
        if let Some(end) = to.filter(|end| if *end < first { b_x <= *end } else { b_x >= *end }) {
            let share = if b_x == a_x { 1.0 } else { (end - a_x) / (b_x - a_x) };
            return Some(sum + 0.5 * (end - a_x) * (a_y + a_y + share * (b_y - a_y)));
        }
        sum += 0.5 * (b_x - a_x) * (a_y + b_y);
    }
    let (x, _) = *curve.last()?;
    to.is_none_or(|end| is_near(x, end, end)).then_some(sum)
}

#[cfg(test)]
mod test;
