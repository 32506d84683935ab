//! Uncertainty of each number of the law as the curve determines it.

use super::law::BondSlipLaw;
use nalgebra::{DMatrix, DVector};
use pullout_bridging::{Estimate, differences, estimates};

/// The numbers of a law, and their correlation matrix.
#[derive(Clone, Debug, PartialEq)]
pub struct Uncertainty {
    /// Estimates in the order of [`BondSlipLaw::quantities`]; the last slip of a piecewise law is given by the curve.
    pub estimates: Vec<Estimate>,
    /// Between them.
    pub correlation: DMatrix<f64>,
}

/// Returns the uncertainty of a fitted law.
pub fn uncertainty(
    law: &BondSlipLaw,
    residuals: &DVector<f64>,
    jacobian: &DMatrix<f64>,
    weights: &[f64],
) -> Uncertainty {
    let values = |law: &BondSlipLaw| -> Vec<f64> { law.quantities().iter().map(|quantity| quantity.value).collect() };
    let derivatives = differences(&law.coordinates(), &|coordinates: &[f64]| values(&law.at(coordinates)));
    let (estimates, correlation) = estimates(&values(law), residuals.as_slice(), None, jacobian, weights, &derivatives);
    Uncertainty { estimates, correlation }
}
