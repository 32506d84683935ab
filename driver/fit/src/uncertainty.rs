//! Uncertainty of each number of the law as the curve determines it: standard errors and correlations, to first order.

use super::law::{BondLaw, Quantity};
use nalgebra::{DMatrix, DVector, SymmetricEigen};

/// Directions of the coordinates whose information is below this part of the greatest cannot be determined.
const LEAST_INFORMATION: f64 = 1e-10;
/// A standard error above this part of the value: the curve does not tell the number.
pub const IDENTIFIABLE: f64 = 0.25;
/// Derivatives of the numbers by the coordinates are taken over this distance.
const STEP: f64 = 1e-5;

/// A number of the law with its uncertainty.
#[derive(Clone, Debug, PartialEq)]
pub struct Estimate {
    /// The number.
    pub quantity: Quantity,
    /// Standard error in its unit; infinite if nothing is known, 0 if it was given and not sought.
    pub standard_error: f64,
}

impl Estimate {
    /// Returns whether it was given: the last slip of a piecewise law is the curve's.
    pub fn is_given(&self) -> bool {
        self.standard_error == 0.0
    }

    /// Standard error over value.
    pub fn relative(&self) -> f64 {
        self.standard_error / self.quantity.value.abs()
    }

    /// Returns whether the curve tells the number.
    pub fn is_identifiable(&self) -> bool {
        self.relative() <= IDENTIFIABLE
    }
}

/// The numbers of a law, and their correlation matrix.
#[derive(Clone, Debug, PartialEq)]
pub struct Uncertainty {
    /// Estimates in the order of [`BondLaw::quantities`].
    pub estimates: Vec<Estimate>,
    /// Between them.
    pub correlation: DMatrix<f64>,
}

/// Returns the uncertainty of a fitted law.
pub fn uncertainty(law: &BondLaw, residuals: &DVector<f64>, jacobian: &DMatrix<f64>, weights: &[f64]) -> Uncertainty {
    let (errors, correlation) = spread(residuals, jacobian, weights, &derivatives(law));
    let quantities = law.quantities().into_iter().zip(errors);
    let estimates = quantities.map(|(quantity, standard_error)| Estimate { quantity, standard_error }).collect();
    Uncertainty { estimates, correlation }
}

/// Standard errors and correlations of numbers q of the weighted least-squares estimate θ with residuals r of the same
/// variance σ² (r, J and weights W by rows):
///
/// ```text
/// cov θ = σ² (JᵀWJ)⁻¹ JᵀW²J (JᵀWJ)⁻¹,   σ² = rᵀr/(m − n),   cov q = D cov θ Dᵀ with D = ∂q/∂θ
/// ```
pub fn spread(
    residuals: &DVector<f64>,
    jacobian: &DMatrix<f64>,
    weights: &[f64],
    derivatives: &DMatrix<f64>,
) -> (Vec<f64>, DMatrix<f64>) {
    let weights = DVector::from_column_slice(weights);
    let scaled = |power: i32| {
        let mut scaled = jacobian.clone();
        scaled.row_iter_mut().zip(&weights).for_each(|(mut row, weight)| row *= weight.powi(power));
        jacobian.transpose() * scaled
    };
    let freedom = residuals.len().saturating_sub(jacobian.ncols()).max(1);
    let variance = residuals.norm_squared() / freedom as f64;
    let information = SymmetricEigen::new(scaled(1));
    let greatest = information.eigenvalues.max();
    let is_told = |eigenvalue: f64| eigenvalue > LEAST_INFORMATION * greatest;
    let inverse = information.eigenvalues.map(|value| if is_told(value) { 1.0 / value } else { 0.0 });
    let inverse = &information.eigenvectors * DMatrix::from_diagonal(&inverse) * information.eigenvectors.transpose();
    let covariance = derivatives * &inverse * scaled(2) * &inverse * derivatives.transpose() * variance;
    let untold = information.eigenvalues.map(|value| f64::from(!is_told(value)));
    let lost = derivatives * &information.eigenvectors * DMatrix::from_diagonal(&untold);
    let deviation = |k: usize| covariance[(k, k)].max(0.0).sqrt();
    let error = |k: usize| {
        let unknown = lost.row(k).norm() > LEAST_INFORMATION.sqrt() * derivatives.row(k).norm();
        if unknown { f64::INFINITY } else { deviation(k) }
    };
    let count = derivatives.nrows();
    let correlation = DMatrix::from_fn(count, count, |i, j| {
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
    ((0..count).map(error).collect(), correlation)
}

/// ∂q/∂θ by central differences.
fn derivatives(law: &BondLaw) -> DMatrix<f64> {
    let coordinates = law.coordinates();
    let at = |k: usize, step: f64| {
        let mut moved = coordinates.clone();
        moved[k] += step;
        DVector::from_iterator(
            law.quantities().len(),
            law.at(&moved).quantities().iter().map(|quantity| quantity.value),
        )
    };
    let column = |k: usize| (at(k, STEP) - at(k, -STEP)) / (2.0 * STEP);
    let columns: Vec<DVector<f64>> = (0..coordinates.len()).map(column).collect();
    DMatrix::from_columns(&columns)
}
