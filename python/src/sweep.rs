//! The table of a sweep.

use crate::errors::{Exception, without_panic};
use numpy::IntoPyArray;
use pullout_sweep::table::Column;
use pullout_sweep::{Store, collect as collected};
use pyo3::prelude::*;
use pyo3::types::PyList;
use std::path::PathBuf;

/// The columns of a sweep, a row a run: arrays of whole numbers, of numbers with NaN where there is none; lists of texts; lists of arrays.
#[pyfunction]
pub fn collect(py: Python<'_>, folder: PathBuf) -> PyResult<Vec<(String, Py<PyAny>)>> {
    without_panic(|| {
        let table = py.detach(|| collected(&Store::new(&folder)));
        let table = table.map_err(|error| Exception::Pullout.with(error.to_string()))?;
        table.columns.into_iter().map(|(name, column)| Ok((name, array(py, column)?))).collect()
    })
}

fn array(py: Python<'_>, column: Column) -> PyResult<Py<PyAny>> {
    let numbers =
        |values: Vec<Option<f64>>| -> Vec<f64> { values.into_iter().map(|value| value.unwrap_or(f64::NAN)).collect() };
    Ok(match column {
        Column::Number(values) => numbers(values).into_pyarray(py).into_any().unbind(),
        Column::Count(values) => match values.iter().copied().collect::<Option<Vec<i64>>>() {
            Some(counts) => counts.into_pyarray(py).into_any().unbind(),
            None => {
                let values = values.into_iter().map(|value| value.map(|count| count as f64)).collect();
                numbers(values).into_pyarray(py).into_any().unbind()
            }
        },
        Column::Text(texts) => PyList::new(py, texts.into_iter().map(Option::unwrap_or_default))?.into_any().unbind(),
        Column::List(lists) => {
            let arrays = lists.into_iter().map(|list| list.into_pyarray(py));
            PyList::new(py, arrays)?.into_any().unbind()
        }
    })
}
