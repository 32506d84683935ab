//! Cases of kind "pullout", run in this process.

use super::BenchError;
use super::timing::thread_time;
use pullout_case::Case;
use pullout_run::columns::place_in_specimen;
use pullout_run::path::{self, Statistics, Stop};
use pullout_run::pullout::checkpoint::Checkpoints;
use pullout_run::pullout::{self, Findings, PulloutProgram, SpecimenSettings};
use std::path::{Path, PathBuf};
use std::time::Duration;

/// Outcome of a case that was not refused.
pub(super) struct Ran {
    /// Time of the processors on this process, s, from the model to the end.
    pub seconds: f64,
    /// Freedoms of its mesh.
    pub freedoms: usize,
    /// Rows before the end.
    pub rows: usize,
    /// The last row: slip, mm; load, N; work, N·mm.
    pub end: [f64; 3],
    pub findings: Findings,
    pub statistics: Statistics,
    /// Reason why it stopped early.
    pub stopped: Option<String>,
    /// Stopped because it was over its limit.
    pub over_limit: bool,
}

/// Limits beyond which a run is given up.
#[derive(Clone, Copy, Debug)]
pub(super) struct Limit {
    /// Most increments.
    pub increments: usize,
    /// Most time of the processor.
    pub processor: Duration,
}

impl Limit {
    /// None.
    pub const NONE: Self = Self { increments: usize::MAX, processor: Duration::MAX };
}

/// Keeps the last row, and ends the run at its limit.
struct Keeper {
    rows: usize,
    last: Vec<f64>,
    start: Duration,
    limit: Limit,
    over_limit: bool,
}

impl path::Observer for Keeper {
    fn row(&mut self, row: path::Row<'_>) -> std::io::Result<()> {
        self.rows += 1;
        self.last.clear();
        self.last.extend_from_slice(row.values);
        let spent = thread_time() - self.start;
        // the first row is the state before the first increment
        let increments = self.rows - 1;
        self.over_limit = increments > self.limit.increments || spent > self.limit.processor;
        if self.over_limit {
            let seconds = spent.as_secs();
            let message = format!("over the limit after {increments} increments and {seconds} s of the processor");
            return Err(std::io::Error::other(message));
        }
        Ok(())
    }

    fn increment_done(&mut self, _row: path::Row<'_>, _so_far: Statistics) {}
}

impl Keeper {
    fn last(&self, column: &str) -> f64 {
        place_in_specimen(column).and_then(|place| self.last.get(place)).copied().unwrap_or(f64::NAN)
    }
}

/// Runs a case with overrides (texts of `--set`) on this thread, whose stack must do for plugins.
///
/// # Errors
/// The case is refused.
pub(super) fn run(file: &Path, overrides: &[String], plugins: &[PathBuf], folder: &Path) -> Result<Ran, BenchError> {
    run_within(Limit::NONE, file, overrides, plugins, folder)
}

/// Runs a case as [`run`] does, up to a limit.
///
/// # Errors
/// As [`run`].
pub(super) fn run_within(
    limit: Limit,
    file: &Path,
    overrides: &[String],
    plugins: &[PathBuf],
    folder: &Path,
) -> Result<Ran, BenchError> {
    let program = read(file, overrides, plugins)?;
    Ok(run_program(&program, limit, folder))
}

/// Reads a case with overrides, and meshes it.
///
/// # Errors
/// The case is refused.
pub(super) fn read(file: &Path, overrides: &[String], plugins: &[PathBuf]) -> Result<Box<PulloutProgram>, BenchError> {
    match pullout_case::read(file, overrides, plugins)? {
        Case::Pullout(program) => Ok(program),
        _ => Err(BenchError::Failed(format!("{}: not a specimen", file.display()))),
    }
}

/// Runs what was read, on this thread, whose stack must do for plugins.
pub(super) fn run_program(program: &PulloutProgram, limit: Limit, folder: &Path) -> Ran {
    let start = thread_time();
    let mut keeper = Keeper { rows: 0, last: Vec::new(), start, limit, over_limit: false };
    let outcome = pullout::run(program, &SpecimenSettings::new(program, folder, &Checkpoints::default()), &mut keeper);
    Ran {
        seconds: (thread_time() - start).as_secs_f64(),
        freedoms: 2 * program.model.mesh.nodes().len(),
        rows: keeper.rows,
        end: ["slip", "load", "external_work"].map(|column| keeper.last(column)),
        findings: outcome.findings,
        statistics: outcome.statistics,
        stopped: outcome.result.err().map(|stop| match stop {
            Stop::Failed(failure) => failure.message,
            Stop::Write(error) => error.to_string(),
        }),
        over_limit: keeper.over_limit,
    }
}
