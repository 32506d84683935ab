//! The least squares of `pullout fit`, over functions of Python.

use crate::errors::wrong;
use nalgebra::{DMatrix, DVector};
use numpy::{PyReadonlyArray1, PyReadonlyArray2};
use pullout_fit::{BestFit, Range, Simulation, least_squares as searched};
use pyo3::prelude::*;
use std::cell::RefCell;

/// Numbers with their standard errors, correlations by rows, half the sum of squares, the bounds that numbers lie on, and why the numbers
/// are not the best.
type Fitted = (Vec<f64>, Vec<f64>, Vec<Vec<f64>>, f64, Vec<Option<f64>>, Option<String>);

/// Functions of Python whose squares shall be least. NaN says that there is no curve; an exception ends all searches.
struct Functions<'py> {
    residuals: Bound<'py, PyAny>,
    derivatives: Bound<'py, PyAny>,
    /// The greatest value of the data in standard deviations.
    scale: f64,
    raised: RefCell<Option<PyErr>>,
}

impl<'py> Functions<'py> {
    /// Calls a function, unless one has raised.
    fn call<R: for<'a> FromPyObject<'a, 'py>>(
        &self,
        function: &Bound<'py, PyAny>,
        values: &[f64],
    ) -> Result<R, String> {
        let ended = || "a function has raised".to_owned();
        if self.raised.borrow().is_some() {
            return Err(ended());
        }
        let found = function.call1((values.to_vec(),)).and_then(|found| found.extract().map_err(Into::into));
        found.map_err(|error| {
            *self.raised.borrow_mut() = Some(error);
            ended()
        })
    }
}

impl Simulation for Functions<'_> {
    type Run = DVector<f64>;

    fn run(&self, values: &[f64]) -> Result<DVector<f64>, String> {
        let found: PyReadonlyArray1<'_, f64> = self.call(&self.residuals, values)?;
        let found = DVector::from_iterator(found.as_array().len(), found.as_array().iter().map(|row| row / self.scale));
        if found.iter().all(|row| row.is_finite()) { Ok(found) } else { Err("there is no curve".into()) }
    }

    fn differences(&self, run: &DVector<f64>) -> DVector<f64> {
        run.clone()
    }

    fn derivatives(&self, values: &[f64], _: &DVector<f64>) -> Result<DMatrix<f64>, String> {
        let found: PyReadonlyArray2<'_, f64> = self.call(&self.derivatives, values)?;
        let found = found.as_array();
        let found = DMatrix::from_fn(found.nrows(), found.ncols(), |i, j| found[[i, j]] / self.scale);
        let message = "a run for the derivatives gives no curve";
        if found.iter().all(|entry| entry.is_finite()) { Ok(found) } else { Err(message.into()) }
    }

    fn rms(&self, run: &DVector<f64>) -> f64 {
        run.norm() / (run.len() as f64).sqrt()
    }
}

/// Fits numbers within bounds by the search of `pullout fit`, from `start` and other places.
///
/// `ranges`: lower and upper bound, and whether the logarithm is sought. `limits`: most places, and most runs. `scale`: the greatest value
/// of the data in standard deviations. `is_known`: whether the standard deviations are those of the data.
#[pyfunction]
pub fn least_squares<'py>(
    residuals: Bound<'py, PyAny>,
    derivatives: Bound<'py, PyAny>,
    ranges: Vec<(f64, f64, bool)>,
    start: Vec<f64>,
    limits: [usize; 2],
    scale: f64,
    is_known: bool,
) -> PyResult<Fitted> {
    let functions = Functions { residuals, derivatives, scale, raised: RefCell::default() };
    let range = |(low, high, is_logarithmic)| Range { bounds: [low, high], is_logarithmic };
    let ranges: Vec<Range> = ranges.into_iter().map(range).collect();
    let scatter = is_known.then_some(1.0 / scale);
    let found = searched(&functions, &ranges, &start, limits, scatter, &|_, _| {});
    if let Some(error) = functions.raised.take() {
        return Err(error);
    }
    let BestFit { run, estimates, correlation, trouble, .. } = found.map_err(|message| wrong("x0", message))?;
    let bounds = std::iter::zip(&ranges, &estimates).map(|(range, estimate)| range.bound(estimate.value)).collect();
    let (values, errors) = estimates.iter().map(|estimate| (estimate.value, estimate.standard_error)).unzip();
    let rows = correlation.row_iter().map(|row| row.iter().copied().collect()).collect();
    Ok((values, errors, rows, 0.5 * (run * scale).norm_squared(), bounds, trouble))
}
