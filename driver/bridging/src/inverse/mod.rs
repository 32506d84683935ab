//! The way back: from the beam test to σ(w), and from σ(w) to the bond.

mod beam;
mod bond;
mod constrained;
mod strengths;

pub use beam::{BridgingFit, MeasuredBeam, OPENINGS, fast_inverse, full_inverse};
pub use bond::{SoughtBond, bond_from_bridging, bond_from_strengths};
pub use strengths::Shape;

use levenberg_marquardt::{LeastSquaresProblem, LevenbergMarquardt, TerminationReason};
use nalgebra::storage::Owned;
use nalgebra::{DMatrix, DVector, Dyn, SymmetricEigen};

/// Half the distance of central differences, in parameters of size 1.
const STEP: f64 = 1e-5;
/// The search ends when the sum of squares, or the parameters, would change by less than this part.
const SMALLEST_GAIN: f64 = 1e-10;
/// Length of the first step, as a part of the parameters: far off, a model may be slow and give no information.
const FIRST_STEP: f64 = 1.0;
/// Directions whose information is below this part of the greatest cannot be determined.
const LEAST_INFORMATION: f64 = 1e-10;
/// A standard error above this part of the value: the data do not determine the quantity.
pub const IDENTIFIABLE: f64 = 0.25;

/// A least-squares problem. Rows after the data are penalties: they guide the search and carry no information.
struct LeastSquares<'f> {
    /// Residuals at parameters.
    residuals: &'f dyn Fn(&[f64]) -> Vec<f64>,
    /// The quantities that the parameters represent.
    quantities: &'f dyn Fn(&[f64]) -> Vec<f64>,
    /// Rows that are data, the first ones.
    data: usize,
    /// Evaluations per parameter.
    patience: usize,
}

/// A quantity with its uncertainty.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Estimate {
    /// Value.
    pub value: f64,
    /// Standard error; infinite if nothing is known, 0 if it was given and not sought.
    pub standard_error: f64,
}

impl Estimate {
    /// Returns whether it was given.
    pub fn is_given(&self) -> bool {
        self.standard_error == 0.0
    }

    /// Standard error over value.
    pub fn relative(&self) -> f64 {
        self.standard_error / self.value.abs()
    }

    /// Returns whether the data determine it.
    pub fn is_identifiable(&self) -> bool {
        self.standard_error <= IDENTIFIABLE * self.value.abs()
    }
}

/// Solution of an inverse problem.
#[derive(Clone, Debug, PartialEq)]
pub struct Fitted {
    /// Parameters.
    pub parameters: Vec<f64>,
    /// Quantities.
    pub estimates: Vec<Estimate>,
    /// Correlations of the quantities.
    pub correlation: DMatrix<f64>,
    /// √(Σr²/m) of the data.
    pub rms: f64,
    /// √(Σr²/m) of the penalties.
    pub penalty: f64,
    /// Whether the search came to its end.
    pub reached: bool,
}

/// Minimises by Levenberg and Marquardt's method (the crate `levenberg-marquardt`, after MINPACK) from `start`.
fn least_squares(problem: &LeastSquares<'_>, start: &[f64]) -> Fitted {
    let search = Search { problem, parameters: DVector::from_column_slice(start) };
    let method = LevenbergMarquardt::new().with_ftol(SMALLEST_GAIN).with_xtol(SMALLEST_GAIN);
    let method = method.with_stepbound(FIRST_STEP).with_patience(problem.patience);
    let (search, report) = method.minimize(search);
    let ended = report.termination;
    let reached = ended.was_successful() || matches!(ended, TerminationReason::NoImprovementPossible(_));
    Fitted { reached, ..assess(problem, search.parameters.as_slice().to_vec()) }
}

/// Returns what is known at parameters.
fn assess(problem: &LeastSquares<'_>, parameters: Vec<f64>) -> Fitted {
    let residuals = (problem.residuals)(&parameters);
    let (data, penalties) = residuals.split_at(problem.data.min(residuals.len()));
    let rms = |rows: &[f64]| (rows.iter().map(|row| row * row).sum::<f64>() / rows.len().max(1) as f64).sqrt();
    let jacobian = differences(&parameters, problem.residuals).rows(0, data.len()).into_owned();
    let values = (problem.quantities)(&parameters);
    let derivatives = differences(&parameters, problem.quantities);
    let (estimates, correlation) = estimates(&values, data, None, &jacobian, &[], &derivatives);
    Fitted { estimates, correlation, rms: rms(data), penalty: rms(penalties), parameters, reached: true }
}

/// Returns numbers q with their standard errors, and their correlations, from the weighted least-squares estimate θ with
/// residuals r of the same variance σ² (r, J and weights W by rows; no weights: all 1), to first order:
///
/// ```text
/// cov θ = σ² (JᵀWJ)⁻¹ JᵀW²J (JᵀWJ)⁻¹,   σ² = rᵀr/(m − n),   cov q = D cov θ Dᵀ with D = ∂q/∂θ
/// ```
///
/// `scatter` is σ where it is known. Components along directions without information are unknown.
pub fn estimates(
    values: &[f64],
    residuals: &[f64],
    scatter: Option<f64>,
    jacobian: &DMatrix<f64>,
    weights: &[f64],
    derivatives: &DMatrix<f64>,
) -> (Vec<Estimate>, DMatrix<f64>) {
    let scaled = |power: i32| {
        let mut scaled = jacobian.clone();
        scaled.row_iter_mut().zip(weights).for_each(|(mut row, weight)| row *= weight.powi(power));
        jacobian.transpose() * scaled
    };
    let freedom = residuals.len().saturating_sub(jacobian.ncols()).max(1);
    let remaining = || residuals.iter().map(|row| row * row).sum::<f64>() / freedom as f64;
    let variance = scatter.map_or_else(remaining, |scatter| scatter * scatter);
    let information = SymmetricEigen::new(scaled(1));
    let greatest = information.eigenvalues.max();
    let is_determined = |eigenvalue: f64| eigenvalue > LEAST_INFORMATION * greatest;
    let inverse = information.eigenvalues.map(|value| if is_determined(value) { 1.0 / value } else { 0.0 });
    let inverse = &information.eigenvectors * DMatrix::from_diagonal(&inverse) * information.eigenvectors.transpose();
    let covariance = derivatives * &inverse * scaled(2) * &inverse * derivatives.transpose() * variance;
    let undetermined = information.eigenvalues.map(|value| f64::from(!is_determined(value)));
    let lost = derivatives * &information.eigenvectors * DMatrix::from_diagonal(&undetermined);
    let deviation = |k: usize| covariance[(k, k)].max(0.0).sqrt();
    let estimate = |(k, &value): (usize, &f64)| {
        let unknown = lost.row(k).norm() > LEAST_INFORMATION.sqrt() * derivatives.row(k).norm();
        Estimate { value, standard_error: if unknown { f64::INFINITY } else { deviation(k) } }
    };
    let correlation = DMatrix::from_fn(values.len(), values.len(), |i, j| {
        let product = deviation(i) * deviation(j);
        // a number that was given goes with no other
        if i == j {
            1.0
        } else if product > 0.0 {
            covariance[(i, j)] / product
        } else {
            0.0
        }
    });
    (values.iter().enumerate().map(estimate).collect(), correlation)
}

/// ∂f/∂θ by central differences.
pub fn differences(parameters: &[f64], f: &dyn Fn(&[f64]) -> Vec<f64>) -> DMatrix<f64> {
    let at = |k: usize, step: f64| {
        let mut moved = parameters.to_vec();
        moved[k] += step;
        DVector::from_vec(f(&moved))
    };
    let columns: Vec<DVector<f64>> =
        (0..parameters.len()).map(|k| (at(k, STEP) - at(k, -STEP)) / (2.0 * STEP)).collect();
    DMatrix::from_columns(&columns)
}

/// The problem as the method sees it.
struct Search<'p, 'f> {
    problem: &'p LeastSquares<'f>,
    parameters: DVector<f64>,
}

impl LeastSquaresProblem<f64, Dyn, Dyn> for Search<'_, '_> {
    type ResidualStorage = Owned<f64, Dyn>;
    type JacobianStorage = Owned<f64, Dyn, Dyn>;
    type ParameterStorage = Owned<f64, Dyn>;

    fn set_params(&mut self, parameters: &DVector<f64>) {
        self.parameters.copy_from(parameters);
    }

    fn params(&self) -> DVector<f64> {
        self.parameters.clone()
    }

    fn residuals(&self) -> Option<DVector<f64>> {
        let residuals = (self.problem.residuals)(self.parameters.as_slice());
        residuals.iter().all(|row| row.is_finite()).then(|| DVector::from_vec(residuals))
    }

    fn jacobian(&self) -> Option<DMatrix<f64>> {
        let jacobian = differences(self.parameters.as_slice(), self.problem.residuals);
        jacobian.iter().all(|entry| entry.is_finite()).then_some(jacobian)
    }
}
