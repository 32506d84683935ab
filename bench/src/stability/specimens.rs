//! Variations of small specimens, run as cases are.

use super::Row;
use super::progress::Progress;
use super::variations::{Base, bases};
use crate::BenchError;
use crate::runs::{self, Limit};
use crate::table::Table;
use pullout_run::in_threads;
use pullout_run::number::significant;
use pullout_run::path::Statistics;
use std::path::{Path, PathBuf};
use std::sync::Mutex;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::time::Duration;

const PART: &str = "specimen";

/// Largest imbalance of the energies, relative as in the history (docs/reference/columns.md).
const ENERGY_ERROR: f64 = 1e-3;

/// Limits beyond which a variation is given up: three times the increments of the finest, and some minutes.
pub(super) const LIMIT: Limit = Limit { increments: 30_000, processor: Duration::from_secs(300) };

/// A variation and its outcome.
pub(super) struct Run {
    base: &'static str,
    family: &'static str,
    label: String,
    /// Reason why it may fail.
    known_limit: Option<&'static str>,
    end: End,
}

enum End {
    Reached { energy_error: f64, statistics: Statistics },
    Refused(String),
    Stopped { message: String, energy_error: f64, rows: usize },
    OverLimit { message: String, energy_error: f64 },
}

struct Job {
    base: usize,
    family: &'static str,
    label: String,
    known_limit: Option<&'static str>,
    overrides: Vec<String>,
}

/// Runs every `stride`-th variation, on all processors. `progress`: of so many runs.
pub(super) fn measure(
    stride: usize,
    limit: Limit,
    plugin_paths: &[PathBuf],
    progress: impl FnOnce(u64) -> Progress,
) -> Result<Vec<Run>, BenchError> {
    let bases = bases();
    let folder = tempfile::tempdir()?;
    for (k, base) in bases.iter().enumerate() {
        std::fs::write(case_file(folder.path(), k), base.case)?;
    }
    let jobs: Vec<Job> = jobs(&bases).into_iter().step_by(stride).collect();
    let progress = progress(jobs.len() as u64);
    let (next, done) = (AtomicUsize::new(0), Mutex::new(Vec::new()));
    let work = || {
        loop {
            let k = next.fetch_add(1, Ordering::Relaxed);
            let Some(job) = jobs.get(k) else { break };
            let (file, out) = (case_file(folder.path(), job.base), folder.path().join(k.to_string()));
            let end = run(limit, &file, job, &out, plugin_paths);
            let &Job { base, family, ref label, known_limit, .. } = job;
            let run = Run { base: bases[base].name, family, label: label.clone(), known_limit, end };
            progress.advance(1, &format!("{}, {family} {label}", run.base));
            done.lock().unwrap_or_else(std::sync::PoisonError::into_inner).push((k, run));
        }
    };
    let threads = std::thread::available_parallelism().map_or(1, std::num::NonZero::get);
    for ended in in_threads((0..threads).map(|_| work)) {
        ended?.map_err(|_| BenchError::Failed("a specimen's run panicked".into()))?;
    }
    let mut ended = done.into_inner().unwrap_or_else(std::sync::PoisonError::into_inner);
    ended.sort_unstable_by_key(|(k, _)| *k);
    Ok(ended.into_iter().map(|(_, run)| run).collect())
}

fn case_file(folder: &Path, base: usize) -> PathBuf {
    folder.join(format!("base-{base}.json"))
}

fn jobs(bases: &[Base]) -> Vec<Job> {
    let mut jobs = Vec::new();
    for (k, base) in bases.iter().enumerate() {
        for family in &base.families {
            for variation in &family.variations {
                let overrides = base.set.iter().map(|&set| set.to_owned()).chain(variation.set.clone()).collect();
                let (label, known_limit) = (variation.label.clone(), variation.known_limit);
                jobs.push(Job { base: k, family: family.name, label, known_limit, overrides });
            }
        }
    }
    jobs
}

fn run(limit: Limit, file: &Path, job: &Job, folder: &Path, plugin_paths: &[PathBuf]) -> End {
    let ran = match runs::run_within(limit, file, &job.overrides, plugin_paths, folder) {
        Ok(ran) => ran,
        Err(BenchError::Case(errors)) => {
            return End::Refused(errors.problems.iter().map(ToString::to_string).collect::<Vec<_>>().join("; "));
        }
        Err(error) => return End::Refused(error.to_string()),
    };
    let energy_error = ran.findings.energy_error_max.unwrap_or(f64::NAN);
    match ran.stopped {
        None => End::Reached { energy_error, statistics: ran.statistics },
        Some(message) if ran.over_limit => End::OverLimit { message, energy_error },
        Some(message) => End::Stopped { message, energy_error, rows: ran.rows },
    }
}

impl Run {
    fn energy_error(&self) -> Option<f64> {
        match self.end {
            End::Reached { energy_error, .. }
            | End::Stopped { energy_error, .. }
            | End::OverLimit { energy_error, .. } => Some(energy_error),
            End::Refused(_) => None,
        }
    }

    fn is_refused(&self) -> bool {
        matches!(self.end, End::Refused(_))
    }

    fn is_stopped(&self) -> bool {
        matches!(self.end, End::Stopped { .. })
    }

    /// Refused, stopped, or out of balance.
    fn is_broken(&self) -> bool {
        self.is_refused()
            || self.is_stopped()
            || self.energy_error().is_some_and(|error| error > ENERGY_ERROR || error.is_nan())
    }

    /// Broken without a known reason.
    fn failed(&self) -> bool {
        self.is_broken() && self.known_limit.is_none()
    }

    /// Broken for a known reason.
    fn is_at_known_limit(&self) -> bool {
        self.is_broken() && self.known_limit.is_some()
    }

    fn is_over_limit(&self) -> bool {
        matches!(self.end, End::OverLimit { .. })
    }

    fn note(&self) -> String {
        let reason = self
            .known_limit
            .filter(|_| self.is_broken() || self.is_over_limit())
            .map_or_else(String::new, |why| format!(". Known limit: {why}"));
        self.ending() + &reason
    }

    fn ending(&self) -> String {
        match &self.end {
            End::Reached { statistics, energy_error } => format!(
                "{} increments, {} iterations, {} cut-backs, energy error {}",
                statistics.increments,
                statistics.iterations,
                statistics.cutbacks,
                significant(*energy_error, 2)
            ),
            End::Refused(message) => format!("refused: {message}"),
            End::Stopped { message, rows, .. } => format!("stopped after {rows} rows: {message}"),
            End::OverLimit { message, .. } => message.clone(),
        }
    }
}

/// One line for each variation.
pub(super) fn rows(runs: &[Run]) -> Vec<Row> {
    let row = |run: &Run| Row {
        part: PART,
        subject: run.base.into(),
        situation: run.family.into(),
        case: run.label.clone(),
        tried: 1,
        excluded: u64::from(!run.failed() && (run.is_over_limit() || run.is_at_known_limit())),
        failed: u64::from(run.failed()),
        worst: run.energy_error().map(|error| error / ENERGY_ERROR),
        note: run.note(),
    };
    runs.iter().map(row).collect()
}

/// Returns the runs that the table does not count as failed though they did not end well: a sentence each.
pub(super) fn exceptions(runs: &[Run]) -> Vec<String> {
    let excepted = runs.iter().filter(|run| run.is_at_known_limit() || run.is_over_limit());
    excepted.map(|run| format!("{}, {} {}: {}.", run.base, run.family, run.label, run.note())).collect()
}

/// One line for each thing that is varied.
pub(super) fn summary(runs: &[Run]) -> Table {
    let mut table = Table::new([
        "specimen",
        "varied",
        "from",
        "to",
        "variations",
        "reached",
        "refused",
        "stopped",
        "out of balance",
        "over the limit",
        "known limit",
        "worst energy error",
    ]);
    for family in runs.chunk_by(|a, b| (a.base, a.family) == (b.base, b.family)) {
        let count = |is: fn(&Run) -> bool| family.iter().filter(|run| is(run)).count();
        let worst = family.iter().filter_map(Run::energy_error).reduce(f64::max);
        let unbalanced = |run: &Run| run.failed() && !run.is_stopped() && !run.is_refused();
        table.push([
            family[0].base.into(),
            family[0].family.into(),
            family[0].label.as_str().into(),
            family[family.len() - 1].label.as_str().into(),
            family.len().into(),
            count(|run| matches!(run.end, End::Reached { .. })).into(),
            count(Run::is_refused).into(),
            count(|run| run.is_stopped() && run.failed()).into(),
            count(unbalanced).into(),
            count(Run::is_over_limit).into(),
            count(Run::is_at_known_limit).into(),
            worst.into(),
        ]);
    }
    table
}
