//! One run: its numbers and curves.

use crate::store::{Keep, Store, Sweep};
use pullout_engine::{CaseSource, Outcome, REPLAY, Settings};
use pullout_report::compare::Branch;
use pullout_report::summary::Status;
use pullout_run::path::{FailedAt, FailureKind};
use pullout_study::RunResult;
use serde::{Deserialize, Serialize};
use std::sync::Arc;
use std::sync::atomic::AtomicBool;
use std::time::Instant;

/// Record of a run that is over.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
pub(crate) struct Measured {
    /// Kind and place of the failure; `None`: it is done, or lost.
    pub failed_at: Option<FailedAt>,
    /// Whether its worker has ended.
    pub is_lost: bool,
    /// Reason.
    pub message: Option<String>,
    /// Quantities in the order of the names.
    pub quantities: Vec<Option<f64>>,
    /// Curves in the order of [`Keep::curves`].
    pub curves: Vec<Vec<f64>>,
    /// Increments, iterations, cutbacks.
    pub counts: [u64; 3],
    /// Times of the clock and of the processors, s.
    pub times: [f64; 2],
    /// The case that repeats a failure.
    pub replay: Option<String>,
}

/// Runs a case, which may be from an unknown source. `None`: the run was asked to end.
pub fn measure(
    store: &Store,
    sweep: &Sweep,
    run: usize,
    is_untrusted: bool,
    stop: &Arc<AtomicBool>,
) -> Option<Measured> {
    let start = Instant::now();
    let settings = Settings { stop: Arc::clone(stop), ..Settings::default() };
    let source = CaseSource { is_untrusted, ..CaseSource::document(sweep.document(run), &store.bundle(sweep, run)) };
    let outcome = source.read().map_err(pullout_engine::Error::from).and_then(|prepared| prepared.run(settings));
    let wall = start.elapsed().as_secs_f64();
    match outcome {
        Ok(outcome) if outcome.summary.status == Status::Interrupted => None,
        Ok(outcome) => Some(of(outcome, &sweep.keep, wall)),
        Err(pullout_engine::Error::Stopped) => None,
        Err(error) => Some(Measured {
            failed_at: Some(FailedAt { kind: FailureKind::Failed, step: 0, increment: 0 }),
            message: Some(match error {
                // nobody knows the document by the name of its file
                pullout_engine::Error::Case(errors) => errors.lines().join("\n"),
                error => error.to_string(),
            }),
            times: [wall, 0.0],
            ..Measured::without_numbers(&sweep.keep)
        }),
    }
}

impl Measured {
    /// Returns the result of a run that has no numbers.
    pub fn without_numbers(keep: &Keep) -> Self {
        Self {
            quantities: vec![None; keep.quantities.len()],
            curves: vec![Vec::new(); keep.curves.len()],
            ..Self::default()
        }
    }
}

fn of(outcome: Outcome, keep: &Keep, wall: f64) -> Measured {
    let Outcome { history, summary, documents, .. } = outcome;
    let failed_at = summary.failed_at.or_else(|| {
        let is_failed = summary.status == Status::Failed;
        is_failed.then_some(FailedAt { kind: FailureKind::Failed, step: 0, increment: 0 })
    });
    let message = summary.message.clone();
    let counts = [summary.increments, summary.iterations, summary.cutbacks];
    let times = [wall, summary.cpu_time_s.unwrap_or_default()];
    let mut result = RunResult::of(history, Some(summary), &keep.curve);
    result.find_work(&keep.curve, keep.work_to);
    let value = |quantity| result.value(quantity, &keep.curve);
    Measured {
        failed_at,
        message,
        quantities: keep.quantities.values().map(value).collect(),
        curves: keep.curves.iter().map(|name| curve(&result, keep, name)).collect(),
        counts,
        times,
        is_lost: false,
        replay: documents.get(REPLAY).map(|case| format!("{case:#}\n")),
    }
}

/// A column as it is, or on the grid.
fn curve(result: &RunResult, keep: &Keep, name: &str) -> Vec<f64> {
    let column = |name: &str| result.history.column(name).unwrap_or_default();
    let Some(grid) = &keep.grid else { return column(name).to_vec() };
    let branch = Branch::first(column(&keep.curve.x), column(name));
    grid.iter().map(|&x| branch.at(x).unwrap_or(f64::NAN)).collect()
}
