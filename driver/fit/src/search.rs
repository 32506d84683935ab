//! Least squares over runs of a simulation by Levenberg and Marquardt's method (the crate `levenberg-marquardt`, after MINPACK).
//!
//! Derivatives are finite differences between the current run and runs with perturbed coordinates. If the current run recorded its
//! states or increments, the others follow them, so that automatic increments cause no jumps in the derivatives.

use levenberg_marquardt::{LeastSquaresProblem, LevenbergMarquardt, TerminationReason};
use nalgebra::storage::Owned;
use nalgebra::{DMatrix, DVector, Dyn};
use pullout_engine::{Along, CaseSource, INCREMENTS, Outcome, Settings};
use pullout_run::in_threads;
use serde_json::{Value, json};
use std::cell::Cell;
use std::sync::Arc;
use std::sync::atomic::AtomicBool;

/// Relative step of differences. Smaller steps drown in the tolerance of a specimen's equilibrium.
pub const STEP: f64 = 1e-6;
/// Difference in every row for coordinates that give no curve, as a fraction of the largest value. It is so large that the method
/// goes back and tries a shorter step. Along a direction that the curve does not determine, a step may have any length.
const NO_CURVE: f64 = 10.0;

/// The increments of one run, which other runs repeat.
#[derive(Clone)]
pub(crate) enum Increments {
    /// Increments of the run.
    Recorded(Value),
    /// The states of a specimen.
    Trail(Along),
}

/// Runs a case on the way of another run, if there is one; otherwise its own way is returned, if it came to its end. `stop` ends
/// the run.
///
/// # Errors
/// The case is wrong, or cannot be run.
pub fn outcome(
    mut source: CaseSource,
    on: Option<&Increments>,
    stop: &Arc<AtomicBool>,
) -> Result<(Outcome, Option<Increments>), String> {
    let along = match on {
        Some(Increments::Recorded(recorded)) => {
            source.overrides.push(format!("increments={}", json!({ "recorded": recorded })));
            None
        }
        Some(Increments::Trail(along)) => Some(along.clone()),
        None => None,
    };
    let prepared = source.read().map_err(|errors| {
        errors.problems.first().map_or_else(|| "the case is wrong".to_owned(), ToString::to_string)
    })?;
    let settings = Settings { records: on.is_none(), along, stop: stop.clone(), ..Settings::default() };
    let mut outcome = prepared.run(settings).map_err(|error| error.to_string())?;
    let trail = outcome.trail.take().map(|trail| Increments::Trail(trail.into()));
    let increments = trail.or_else(|| outcome.documents.remove(INCREMENTS).map(Increments::Recorded));
    Ok((outcome, increments))
}

/// Returns ∂rows/∂coordinates from runs in threads, each with one coordinate changed by its step.
///
/// # Errors
/// A run with a changed coordinate gives no rows.
pub fn derivatives(
    coordinates: &[f64],
    rows: &DVector<f64>,
    increments: Option<&Increments>,
    step: impl Fn(usize) -> f64,
    run: impl Fn(&[f64], Option<&Increments>) -> Result<DVector<f64>, String> + Sync,
) -> Result<DMatrix<f64>, String> {
    let count = coordinates.len();
    let (at_once, each) = match increments {
        Some(Increments::Trail(along)) => (
            count,
            Along::together(&along.trail, count).into_iter().map(|along| Some(Increments::Trail(along))).collect(),
        ),
        others => (std::thread::available_parallelism().map_or(1, usize::from), vec![others.cloned(); count]),
    };
    let run = &run;
    let mut columns = Vec::new();
    let mut perturbed = each.into_iter().enumerate().map(|(k, increments)| {
        let mut moved = coordinates.to_vec();
        moved[k] += step(k);
        (moved[k] - coordinates[k], moved, increments)
    });
    while columns.len() < count {
        let some = perturbed.by_ref().take(at_once).map(|(step, moved, increments)| {
            move || Ok::<_, String>((run(&moved, increments.as_ref())? - rows) / step)
        });
        columns.extend(in_threads(some).into_iter().map(|ended| {
            let ended = ended.map_err(|error| error.to_string())?;
            ended.unwrap_or_else(|_| Err("a run ended its thread".into()))
        }));
    }
    let columns: Result<Vec<DVector<f64>>, String> = columns.into_iter().collect();
    Ok(DMatrix::from_columns(&columns?))
}

/// A simulation whose coordinates are sought.
pub trait Simulation {
    /// Result of a run.
    type Run: Clone;

    /// Runs the simulation.
    ///
    /// # Errors
    /// Reason why there is no curve.
    fn run(&self, coordinates: &[f64]) -> Result<Self::Run, String>;

    /// Returns the differences whose squares shall be least, as parts of the greatest value.
    fn differences(&self, run: &Self::Run) -> DVector<f64>;

    /// Returns their derivatives by the coordinates.
    ///
    /// # Errors
    /// Reason why there are none.
    fn derivatives(&self, coordinates: &[f64], run: &Self::Run) -> Result<DMatrix<f64>, String>;

    /// Returns the root mean square of the differences in the unit that is reported to the user.
    fn rms(&self, run: &Self::Run) -> f64;
}

/// A run and its place.
#[derive(Clone)]
pub struct Best<R> {
    pub coordinates: Vec<f64>,
    pub run: R,
    sum: f64,
}

/// A search for the coordinates of a simulation, as the method sees it.
pub struct Search<'a, S: Simulation> {
    simulation: &'a S,
    /// Most runs, and how many of them are left for what follows.
    budget: [usize; 2],
    runs: Cell<usize>,
    coordinates: DVector<f64>,
    /// Differences at the coordinates.
    present: Option<DVector<f64>>,
    /// The run there, if it gave a curve.
    here: Option<S::Run>,
    /// The best run since the search began.
    pub best: Option<Best<S::Run>>,
    trouble: Cell<Option<String>>,
    progress: &'a dyn Fn(usize, f64),
}

impl<'a, S: Simulation> Search<'a, S> {
    /// Prepares searches with at most `max_runs` runs, `reserve` of which are kept for later. For each place that gives a curve,
    /// `progress` receives the number of runs so far and the root mean square of the differences.
    pub fn new(simulation: &'a S, max_runs: usize, reserve: usize, progress: &'a dyn Fn(usize, f64)) -> Self {
        Self {
            simulation,
            budget: [max_runs, reserve],
            runs: Cell::new(0),
            coordinates: DVector::zeros(0),
            present: None,
            here: None,
            best: None,
            trouble: Cell::new(None),
            progress,
        }
    }

    /// Returns whether so many runs are left.
    pub fn may_run(&self, count: usize) -> bool {
        let [most, reserve] = self.budget;
        self.runs.get() + count + reserve <= most
    }

    /// Returns how many runs were made.
    pub fn runs(&self) -> usize {
        self.runs.get()
    }

    /// Takes a place to search from.
    ///
    /// # Errors
    /// Reason why it has no curve.
    pub fn begin(&mut self, coordinates: &[f64]) -> Result<(), String> {
        self.coordinates = DVector::from_column_slice(coordinates);
        self.best = None;
        self.evaluate()
    }

    /// Searches from the present place; the text is why it did not come to its end.
    pub fn search(self, method: LevenbergMarquardt<f64>) -> (Self, Option<String>) {
        let [most, _] = self.budget;
        let (problem, report) = method.with_patience(most).minimize(self);
        let trouble = match report.termination {
            reason if reason.was_successful() => None,
            // increments that runs choose are no finer
            TerminationReason::NoImprovementPossible(_) => None,
            TerminationReason::User(_) => problem
                .trouble
                .take()
                .or_else(|| Some(format!("the search did not finish within the {most} runs that it may make"))),
            other => Some(format!("the search ended with {other:?}")),
        };
        (problem, trouble)
    }

    /// Counts the runs that the derivatives at one place take.
    pub fn count_derivative_runs(&self) {
        self.runs.set(self.runs.get() + self.coordinates.len());
    }

    fn evaluate(&mut self) -> Result<(), String> {
        (self.present, self.here) = (None, None);
        self.runs.set(self.runs.get() + 1);
        let run = self.simulation.run(self.coordinates.as_slice())?;
        (self.progress)(self.runs.get(), self.simulation.rms(&run));
        let differences = self.simulation.differences(&run);
        let sum = differences.norm_squared();
        if self.best.as_ref().is_none_or(|best| sum < best.sum) {
            self.best = Some(Best { coordinates: self.coordinates.as_slice().to_vec(), run: run.clone(), sum });
        }
        (self.present, self.here) = (Some(differences), Some(run));
        Ok(())
    }
}

impl<S: Simulation> LeastSquaresProblem<f64, Dyn, Dyn> for Search<'_, S> {
    type ResidualStorage = Owned<f64, Dyn>;
    type JacobianStorage = Owned<f64, Dyn, Dyn>;
    type ParameterStorage = Owned<f64, Dyn>;

    fn set_params(&mut self, coordinates: &DVector<f64>) {
        if *coordinates == self.coordinates && self.present.is_some() {
            return;
        }
        self.coordinates.copy_from(coordinates);
        if !self.may_run(1) {
            (self.present, self.here) = (None, None);
        } else if self.evaluate().is_err() {
            self.present = self.best.as_ref().map(|best| self.simulation.differences(&best.run).map(|_| NO_CURVE));
        }
    }

    fn params(&self) -> DVector<f64> {
        self.coordinates.clone()
    }

    fn residuals(&self) -> Option<DVector<f64>> {
        self.present.clone()
    }

    fn jacobian(&self) -> Option<DMatrix<f64>> {
        let run = self.here.as_ref()?;
        if !self.may_run(self.coordinates.len()) {
            return None;
        }
        self.count_derivative_runs();
        let derivatives = self.simulation.derivatives(self.coordinates.as_slice(), run);
        derivatives.map_err(|message| self.trouble.set(Some(message))).ok()
    }
}

/// √(Σ x²/n).
pub fn root_mean_square(values: &DVector<f64>) -> f64 {
    (values.norm_squared() / values.len() as f64).sqrt()
}
