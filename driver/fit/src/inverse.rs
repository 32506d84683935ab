//! Inverse finite elements: the law whose computed curve is nearest to the measured one, by Levenberg and Marquardt's
//! method (the crate `levenberg-marquardt`, after MINPACK).

use super::curve::LoadSlipCurve;
use super::law::BondLaw;
use super::simulation::{SimulatedCurve, Simulator};
use levenberg_marquardt::{LeastSquaresProblem, LevenbergMarquardt, TerminationReason};
use nalgebra::storage::Owned;
use nalgebra::{DMatrix, DVector, Dyn};
use std::cell::Cell;

/// Differences of curves are taken over this distance in each coordinate, most of which are logarithms: curves are
/// smooth to about 1e-4 of the peak.
const STEP: f64 = 0.02;
/// The search ends when the sum of squares would fall by less than this part,
const SMALLEST_GAIN: f64 = 1e-4;
/// or the coordinates would move by less than this part.
const SMALLEST_MOVE: f64 = 1e-4;
/// The first step is at most this part of the coordinates: the regressions are near.
const FIRST_STEP: f64 = 1.0;

/// The difference, as a part of the peak, of every row of a law that gives no curve: so far off that the method turns
/// back and takes a shorter step. Along what a curve does not tell, a step may be of any length.
pub(super) const NO_CURVE: f64 = 10.0;

/// Weighting of the curve's rows.
#[derive(Clone, Copy, Debug, PartialEq, Eq, clap::ValueEnum)]
pub enum Weights {
    /// Rising and softening branch count the same, however many rows each has.
    Balanced,
    /// Every row counts the same.
    Equal,
}

impl Weights {
    /// Returns the weight of each row; their mean is 1.
    pub fn of(self, curve: &LoadSlipCurve) -> Vec<f64> {
        let peak = curve.peak().slip;
        let rises = |slip: f64| slip <= peak;
        let count = curve.slips.len() as f64;
        let rising = curve.slips.iter().filter(|&&slip| rises(slip)).count() as f64;
        let weight = |&slip: &f64| match self {
            Self::Equal => 1.0,
            Self::Balanced => 0.5 * count / if rises(slip) { rising } else { count - rising },
        };
        curve.slips.iter().map(weight).collect()
    }
}

/// The curve that a law is fitted to.
#[derive(Clone, Debug)]
pub struct Target<'c> {
    /// The curve.
    pub curve: &'c LoadSlipCurve,
    /// Weight of each row.
    pub weights: Vec<f64>,
}

impl Target<'_> {
    /// Computed less measured loads, as parts of the measured peak.
    pub fn differences(&self, computed: &SimulatedCurve) -> DVector<f64> {
        let peak = self.curve.peak().load;
        let rows = self.curve.slips.iter().zip(&self.curve.loads);
        let differences = rows.map(|(&slip, load)| (computed.load_at(slip) - load) / peak);
        DVector::from_iterator(self.curve.slips.len(), differences)
    }

    fn weighted(&self, mut differences: DVector<f64>) -> DVector<f64> {
        differences.iter_mut().zip(&self.weights).for_each(|(difference, weight)| *difference *= weight.sqrt());
        differences
    }
}

/// Result of the search.
#[derive(Clone, Debug)]
pub struct Found {
    /// The law.
    pub law: BondLaw,
    /// Curve.
    pub curve: SimulatedCurve,
    /// Derivatives of [`Target::differences`] by the law's coordinates; `None` if there were no runs left for it.
    pub jacobian: Option<DMatrix<f64>>,
    /// The RMS difference of the law that the search began from, as a part of the peak.
    pub start_rms: f64,
    /// Runs that were made.
    pub runs: usize,
    /// Reason why the search ended where it should not have.
    pub trouble: Option<String>,
}

/// Searches from a law, with at most so many runs. `progress` is told the runs so far and the RMS difference, as a part
/// of the peak, of each law that is tried.
///
/// # Errors
/// The first run gives no curve.
pub fn search(
    simulator: &Simulator,
    target: &Target<'_>,
    start: &BondLaw,
    max_runs: usize,
    progress: &dyn Fn(usize, f64),
) -> Result<Found, String> {
    let coordinates = DVector::from_vec(start.coordinates());
    let dimensions = coordinates.len();
    // central differences at the end
    let reserve = 2 * dimensions;
    let mut problem = Problem {
        simulator,
        target,
        form: start,
        runs: Cell::new(0),
        max_runs: max_runs.saturating_sub(reserve),
        coordinates,
        present: None,
        best: None,
        progress,
    };
    problem.evaluate();
    let Some(first) = &problem.best else {
        return Err("the law of the regression gives no curve".into());
    };
    let start_rms = root_mean_square(&target.differences(&first.curve));
    if let Some(failure) = first.curve.failure.as_ref().filter(|_| first.curve.slips.len() < 2) {
        return Err(format!("the simulation fails at once: {failure}"));
    }
    let method = LevenbergMarquardt::new()
        .with_ftol(SMALLEST_GAIN)
        .with_xtol(SMALLEST_MOVE)
        .with_stepbound(FIRST_STEP)
        .with_patience(max_runs);
    let (problem, report) = method.minimize(problem);
    let trouble = match report.termination {
        reason if reason.was_successful() => None,
        // differences of curves are no finer
        TerminationReason::NoImprovementPossible(_) => None,
        TerminationReason::User(_) if problem.is_used_up() => {
            Some(format!("the search was not at its end after the {max_runs} runs of --max-runs"))
        }
        TerminationReason::User(_) => Some("a law next to the best one gives no curve".into()),
        other => Some(format!("the search ended with {other:?}")),
    };
    let runs = problem.runs.get();
    let Some(best) = problem.best else { return Err("no law gives a curve".into()) };
    let jacobian = if runs + reserve <= max_runs { jacobian(simulator, target, &best) } else { None };
    let runs = runs + if jacobian.is_some() { reserve } else { 0 };
    Ok(Found { law: best.law, curve: best.curve, jacobian, start_rms, runs, trouble })
}

/// √(Σ x²/n).
pub fn root_mean_square(values: &DVector<f64>) -> f64 {
    (values.norm_squared() / values.len() as f64).sqrt()
}

/// A law that was tried.
#[derive(Clone, Debug)]
struct Tried {
    law: BondLaw,
    coordinates: Vec<f64>,
    curve: SimulatedCurve,
    /// Weighted.
    differences: DVector<f64>,
}

/// Central differences at a law.
fn jacobian(simulator: &Simulator, target: &Target<'_>, at: &Tried) -> Option<DMatrix<f64>> {
    let steps = (0..at.coordinates.len()).flat_map(|k| [(k, STEP), (k, -STEP)]);
    let laws: Vec<BondLaw> = steps.map(|(k, step)| moved(&at.law, &at.coordinates, k, step)).collect();
    let curves = simulator.curves(&laws);
    let column = |pair: &[Option<SimulatedCurve>]| match pair {
        [Some(up), Some(down)] => Some((target.differences(up) - target.differences(down)) / (2.0 * STEP)),
        _ => None,
    };
    let columns: Option<Vec<DVector<f64>>> = curves.chunks_exact(2).map(column).collect();
    columns.map(|columns| DMatrix::from_columns(&columns))
}

fn moved(form: &BondLaw, coordinates: &[f64], k: usize, step: f64) -> BondLaw {
    let mut coordinates = coordinates.to_vec();
    coordinates[k] += step;
    form.at(&coordinates)
}

/// The least-squares problem as the method sees it.
struct Problem<'a> {
    simulator: &'a Simulator,
    target: &'a Target<'a>,
    form: &'a BondLaw,
    runs: Cell<usize>,
    max_runs: usize,
    coordinates: DVector<f64>,
    present: Option<DVector<f64>>,
    best: Option<Tried>,
    progress: &'a dyn Fn(usize, f64),
}

impl Problem<'_> {
    fn is_used_up(&self) -> bool {
        self.runs.get() + self.coordinates.len() >= self.max_runs
    }

    fn evaluate(&mut self) {
        self.present = None;
        if self.runs.get() >= self.max_runs.max(1) {
            return;
        }
        self.runs.set(self.runs.get() + 1);
        let law = self.form.at(self.coordinates.as_slice());
        let Some(curve) = self.simulator.curve(&law) else {
            self.present = self.best.as_ref().map(|best| best.differences.map(|_| NO_CURVE));
            return;
        };
        let plain = self.target.differences(&curve);
        (self.progress)(self.runs.get(), root_mean_square(&plain));
        let differences = self.target.weighted(plain);
        if self.best.as_ref().is_none_or(|best| differences.norm_squared() < best.differences.norm_squared()) {
            let coordinates = self.coordinates.as_slice().to_vec();
            self.best = Some(Tried { law, coordinates, curve, differences: differences.clone() });
        }
        self.present = Some(differences);
    }
}

impl LeastSquaresProblem<f64, Dyn, Dyn> for Problem<'_> {
    type ResidualStorage = Owned<f64, Dyn>;
    type JacobianStorage = Owned<f64, Dyn, Dyn>;
    type ParameterStorage = Owned<f64, Dyn>;

    fn set_params(&mut self, coordinates: &DVector<f64>) {
        if *coordinates != self.coordinates || self.present.is_none() {
            self.coordinates.copy_from(coordinates);
            self.evaluate();
        }
    }

    fn params(&self) -> DVector<f64> {
        self.coordinates.clone()
    }

    fn residuals(&self) -> Option<DVector<f64>> {
        self.present.clone()
    }

    fn jacobian(&self) -> Option<DMatrix<f64>> {
        let here = self.present.as_ref()?;
        let dimensions = self.coordinates.len();
        if self.runs.get() + dimensions > self.max_runs {
            return None;
        }
        self.runs.set(self.runs.get() + dimensions);
        let laws: Vec<BondLaw> =
            (0..dimensions).map(|k| moved(self.form, self.coordinates.as_slice(), k, STEP)).collect();
        let curves = self.simulator.curves(&laws);
        let column = |curve: Option<SimulatedCurve>| {
            curve.map(|curve| (self.target.weighted(self.target.differences(&curve)) - here) / STEP)
        };
        let columns: Option<Vec<DVector<f64>>> = curves.into_iter().map(column).collect();
        columns.map(|columns| DMatrix::from_columns(&columns))
    }
}
