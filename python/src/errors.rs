//! Errors as the package's own exceptions, which are written in Python (`pullout_fe.errors`).

use pullout_case::CaseProblem;
use pyo3::exceptions::PyRuntimeError;
use pyo3::prelude::*;
use std::any::Any;
use std::panic::{AssertUnwindSafe, catch_unwind};

/// An exception of the package.
#[derive(Clone, Copy, Debug)]
pub enum Exception {
    /// Wrong input.
    Case,
    /// A library that cannot be used.
    Plugin,
    /// A run that was asked to end, and has no results.
    Stopped,
    /// Anything else that the engine cannot go on with.
    Pullout,
}

impl Exception {
    const fn name(self) -> &'static str {
        match self {
            Self::Case => "CaseError",
            Self::Plugin => "PluginError",
            Self::Stopped => "Stopped",
            Self::Pullout => "PulloutError",
        }
    }

    /// Creates the exception with a message.
    pub fn with(self, message: impl Into<String>) -> PyErr {
        self.of((message.into(),))
    }

    /// Creates the exception with its arguments.
    fn of<A>(self, arguments: A) -> PyErr
    where
        A: for<'py> pyo3::call::PyCallArgs<'py> + Send + Sync + 'static,
    {
        Python::attach(|py| {
            let made = py
                .import("pullout_fe.errors")
                .and_then(|module| module.getattr(self.name()))
                .and_then(|class| class.call1(arguments));
            made.map_or_else(|error| error, PyErr::from_value)
        })
    }
}

/// Everything that is wrong with a case.
pub fn case_error(problems: &[CaseProblem]) -> PyErr {
    let place = |problem: &CaseProblem| problem.place.as_ref().map_or("$", |place| place.as_str()).to_owned();
    let pairs: Vec<_> = problems.iter().map(|problem| (place(problem), problem.message.clone())).collect();
    let kind = |problem: &CaseProblem| serde_json::to_value(problem.kind).ok()?.as_str().map(str::to_owned);
    let kinds: Vec<_> = problems.iter().map(|problem| kind(problem).unwrap_or_default()).collect();
    Exception::Case.of((pairs, kinds))
}

/// An argument of a call that is wrong.
pub fn wrong(place: impl Into<String>, message: impl Into<String>) -> PyErr {
    Exception::Case.of((vec![(place.into(), message.into())],))
}

/// Runs the body of a function that Python calls. A panic, which is a bug of pullout, becomes an exception.
pub fn without_panic<R>(body: impl FnOnce() -> PyResult<R>) -> PyResult<R> {
    catch_unwind(AssertUnwindSafe(body)).unwrap_or_else(|panic| Err(of_panic(&*panic)))
}

/// The exception that a panic becomes.
pub fn of_panic(panic: &(dyn Any + Send)) -> PyErr {
    let words = panic.downcast_ref::<String>().map(String::as_str).or_else(|| panic.downcast_ref::<&str>().copied());
    let message = format!("an internal error of the engine: {}", words.unwrap_or("a panic"));
    if std::thread::panicking() { PyRuntimeError::new_err(message) } else { Exception::Pullout.with(message) }
}
