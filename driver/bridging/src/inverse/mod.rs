//! The way back: from the beam test to σ(w), and from σ(w) to the bond.

mod beam;
mod bond;

pub use beam::{BridgingFit, Measured, OPENINGS, fast_inverse, full_inverse};
pub use bond::bond_from_bridging;

use levenberg_marquardt::{LeastSquaresProblem, LevenbergMarquardt};
use nalgebra::storage::Owned;
use nalgebra::{DMatrix, DVector, Dyn, SymmetricEigen};

/// Half the distance of central differences, in parameters of size 1.
const STEP: f64 = 1e-5;
/// The search ends when the sum of squares, or the parameters, would change by less than this part.
const SMALLEST_GAIN: f64 = 1e-10;
/// Evaluations per parameter.
const PATIENCE: usize = 60;
/// Directions whose information is below this part of the greatest cannot be determined.
const LEAST_INFORMATION: f64 = 1e-10;
/// A standard error above this part of the value: the data do not tell the number.
const IDENTIFIABLE: f64 = 0.25;

/// A least-squares problem. Rows beyond the data are penalties: they guide the search and tell nothing.
pub struct LeastSquares<'f> {
    /// Residuals at parameters.
    pub residuals: &'f dyn Fn(&[f64]) -> Vec<f64>,
    /// The quantities that parameters stand for.
    pub quantities: &'f dyn Fn(&[f64]) -> Vec<f64>,
    /// Rows that are data, the first ones.
    pub data: usize,
}

/// A quantity with its uncertainty.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Estimate {
    /// Value.
    pub value: f64,
    /// Standard error; infinite if nothing is known.
    pub standard_error: f64,
}

impl Estimate {
    /// Returns whether the data tell it.
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
}

/// Levenberg and Marquardt's method (the crate `levenberg-marquardt`, after MINPACK) from `start`.
pub fn least_squares(problem: &LeastSquares<'_>, start: &[f64]) -> Fitted {
    let search = Search { problem, parameters: DVector::from_column_slice(start) };
    let method = LevenbergMarquardt::new().with_ftol(SMALLEST_GAIN).with_xtol(SMALLEST_GAIN).with_patience(PATIENCE);
    let (search, _) = method.minimize(search);
    assess(problem, search.parameters.as_slice().to_vec())
}

/// Returns what is known at parameters.
fn assess(problem: &LeastSquares<'_>, parameters: Vec<f64>) -> Fitted {
    let residuals = (problem.residuals)(&parameters);
    let (data, penalties) = residuals.split_at(problem.data.min(residuals.len()));
    let rms = |rows: &[f64]| (rows.iter().map(|row| row * row).sum::<f64>() / rows.len().max(1) as f64).sqrt();
    let jacobian = differences(&parameters, problem.residuals).rows(0, data.len()).into_owned();
    let freedom = data.len().saturating_sub(parameters.len()).max(1) as f64;
    let variance = data.iter().map(|row| row * row).sum::<f64>() / freedom;
    let (estimates, correlation) = uncertainty(&jacobian, variance, &parameters, problem.quantities);
    Fitted { estimates, correlation, rms: rms(data), penalty: rms(penalties), parameters }
}

/// cov q = D (JᵀJ)⁻¹ Dᵀ σ², D = ∂q/∂θ; what lies along directions without information is unknown.
fn uncertainty(
    jacobian: &DMatrix<f64>,
    variance: f64,
    parameters: &[f64],
    quantities: &dyn Fn(&[f64]) -> Vec<f64>,
) -> (Vec<Estimate>, DMatrix<f64>) {
    let information = SymmetricEigen::new(jacobian.transpose() * jacobian);
    let greatest = information.eigenvalues.max();
    let is_told = |value: f64| value > LEAST_INFORMATION * greatest;
    let inverse = information.eigenvalues.map(|value| if is_told(value) { 1.0 / value } else { 0.0 });
    let inverse = &information.eigenvectors * DMatrix::from_diagonal(&inverse) * information.eigenvectors.transpose();
    let derivatives = differences(parameters, quantities);
    let covariance = &derivatives * inverse * derivatives.transpose() * variance;
    let untold = information.eigenvalues.map(|value| f64::from(!is_told(value)));
    let lost = &derivatives * &information.eigenvectors * DMatrix::from_diagonal(&untold);
    let estimate = |(k, value): (usize, f64)| {
        let unknown = lost.row(k).norm() > LEAST_INFORMATION.sqrt() * derivatives.row(k).norm();
        let standard_error = if unknown { f64::INFINITY } else { covariance[(k, k)].max(0.0).sqrt() };
        Estimate { value, standard_error }
    };
    let estimates: Vec<Estimate> = quantities(parameters).into_iter().enumerate().map(estimate).collect();
    let correlation = DMatrix::from_fn(covariance.nrows(), covariance.ncols(), |i, j| {
        let product = (covariance[(i, i)] * covariance[(j, j)]).sqrt();
        if i == j {
            1.0
        } else if product > 0.0 {
            covariance[(i, j)] / product
        } else {
            0.0
        }
    });
    (estimates, correlation)
}

/// ∂f/∂θ by central differences.
fn differences(parameters: &[f64], f: &dyn Fn(&[f64]) -> Vec<f64>) -> DMatrix<f64> {
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
