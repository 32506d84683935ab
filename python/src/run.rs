//! Runs of cases.

use crate::errors::{Exception, case_error, of_panic, without_panic};
use driver::command::examples::{Example, find as find_examples};
use numpy::{IntoPyArray, PyArray1, PyReadonlyArray1};
use pullout_case::CaseErrors;
use pullout_engine::{Along, CaseSource, Error, Outcome, Settings};
use pullout_report::compare::OnGrid;
use pullout_run::isolation;
use pullout_run::{PLUGIN_STACK, in_threads};
use pyo3::prelude::*;
use pyo3::types::PyDict;
use serde_json::Value;
use std::collections::BTreeMap;
use std::ffi::OsString;
use std::num::NonZeroUsize;
use std::path::PathBuf;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{self, RecvTimeoutError};
use std::sync::{Arc, Mutex, PoisonError};
use std::time::{Duration, Instant};

/// Time between two looks at signals and progress.
const LOOK: Duration = Duration::from_millis(50);
/// Time that a run has after it was asked to end, before it is left to end on its own.
const PATIENCE: Duration = Duration::from_millis(300);
/// Time after which a run that another thread asked to end is abandoned: a call of a library in this process may never return.
const LONGEST: Duration = Duration::from_secs(10);

/// A case as Python has it: a file or a document or both, then what the file had; the folder, changes, folders of plugins.
pub(crate) type Parts = (Option<PathBuf>, Option<String>, PathBuf, Vec<String>, Vec<PathBuf>);

/// A column with its unit.
type Column<'py> = (String, &'static str, Bound<'py, PyArray1<f64>>);

/// Columns; texts: `summary.json` and the documents of the run by their names, the page of the viewer, what plugins printed in a child;
/// whether the run came to its end; the states of a specimen.
type Results<'py> = (Vec<Column<'py>>, BTreeMap<String, String>, bool, Option<Trail>);

/// The states of a specimen, along which a run with nearly the same parameters goes.
#[pyclass(frozen, module = "pullout_fe._core")]
pub(crate) struct Trail(Along);

#[pymethods]
impl Trail {
    /// Returns the trail once for each of `count` runs that are under way at once, and share factors.
    fn together(&self, count: usize) -> Vec<Self> {
        Along::together(&self.0.trail, count).into_iter().map(Self).collect()
    }

    /// Lets the others go on without a run that may not have begun.
    fn leave(&self) {
        self.0.leave();
    }
}

/// Flag by which another thread ends runs, whose own threads receive no signals.
#[pyclass(frozen, module = "pullout_fe._core")]
#[derive(Default)]
pub(crate) struct Stop(Arc<AtomicBool>);

#[pymethods]
impl Stop {
    #[new]
    fn new() -> Self {
        Self::default()
    }

    /// Ends the runs that have it, and those that will.
    fn set(&self) {
        self.0.store(true, Ordering::Relaxed);
    }

    /// Returns whether it was set.
    fn is_set(&self) -> bool {
        self.0.load(Ordering::Relaxed)
    }
}

/// Progress of a run: the part that is done, and the present row.
type State = Option<(f64, Vec<f64>)>;

/// Returns a case, which may name sources of plugins: these are compiled.
fn source((file, document, folder, overrides, plugin_paths): Parts) -> PyResult<CaseSource> {
    driver::command::compile_sources(false);
    let mut source = match (file, document) {
        (Some(file), None) => CaseSource::file(&file),
        (file, document) => {
            let text = document.unwrap_or_default();
            let document: Value = serde_json::from_str(&text).map_err(|e| Exception::Case.with(e.to_string()))?;
            let source = CaseSource::document(document, &folder);
            CaseSource { file: file.unwrap_or_else(|| source.file.clone()), ..source }
        }
    };
    (source.overrides, source.plugin_paths) = (overrides, plugin_paths);
    Ok(source)
}

/// Returns the exception for the errors of a case, or of its plugins alone.
fn refusal(errors: &CaseErrors) -> PyErr {
    let is_plugin = |problem: &pullout_case::CaseProblem| problem.kind == pullout_case::ProblemKind::PluginNotLoadable;
    match errors.problems.as_slice() {
        [first, ..] if errors.problems.iter().all(is_plugin) => Exception::Plugin.with(first.to_string()),
        problems => case_error(problems),
    }
}

/// Returns the case with its changes, as JSON.
#[pyfunction]
pub fn document(case: Parts) -> PyResult<String> {
    without_panic(|| {
        if let (Some(file), None, _, overrides, _) = &case
            && overrides.is_empty()
        {
            return pullout_case::read_text(file).map(|read| read.to_string()).map_err(|errors| refusal(&errors));
        }
        let source = source(case)?;
        match source.text() {
            Some(document) => Ok(document.to_string()),
            None => {
                Err(source.read().err().map_or_else(|| Exception::Case.with("is no case"), |errors| refusal(&errors)))
            }
        }
    })
}

/// Returns a place as a dotted path, `steps.0.increments`, also from `$.steps[0].increments`.
#[pyfunction]
pub fn dotted(path: &str) -> String {
    pullout_case::dotted(path)
}

/// A curve on a grid, NaN where the run has no value, and what is to be said of turns of the grid; `name` is its first column.
#[pyfunction]
pub fn on_grid<'py>(
    py: Python<'py>,
    name: &str,
    x: PyReadonlyArray1<'py, f64>,
    y: PyReadonlyArray1<'py, f64>,
    grid: PyReadonlyArray1<'py, f64>,
) -> (Bound<'py, PyArray1<f64>>, Option<String>) {
    let [x, y, grid] = [x, y, grid].map(|values| values.as_array().to_vec());
    let OnGrid { values, turns } = OnGrid::of([&x, &y], &grid);
    let values: Vec<f64> = values.into_iter().map(|value| value.unwrap_or(f64::NAN)).collect();
    (values.into_pyarray(py), turns.words(name))
}

/// Says why a run has no value at a point of a grid, if it has none.
#[pyfunction]
pub fn off_grid(
    name: &str,
    x: PyReadonlyArray1<'_, f64>,
    grid: PyReadonlyArray1<'_, f64>,
    point: usize,
) -> Option<String> {
    let [x, grid] = [x, grid].map(|values| values.as_array().to_vec());
    let found = OnGrid::of([&x, &x], &grid).values.get(point).copied()?;
    Some(found.err()?.words(name, grid[point]))
}

/// The schema of cases, as JSON.
#[pyfunction]
pub fn schema() -> PyResult<String> {
    without_panic(|| Ok(pullout_case::schema().to_string()))
}

/// Checks a case; the result is its warnings.
#[pyfunction]
pub fn check(py: Python<'_>, case: Parts) -> PyResult<Vec<String>> {
    without_panic(|| {
        let source = source(case)?;
        let read = || match source.need() {
            Some(_) => source.columns().map(|_| Vec::new()),
            None => source
                .clone()
                .read()
                .map(|prepared| prepared.case().map(|case| case.about().warnings.clone()).unwrap_or_default()),
        };
        py.detach(|| with_stack(read))?.map_err(|errors| refusal(&errors))
    })
}

/// Runs a case. `listener` is called with the part that is done and the present row; `along`: states of another run, along which
/// this one goes; `keeps`: the increments with the states, and the viewer of a specimen; `stop` ends it, with what it has reached;
/// `fields`: the folder for those that the case asks for.
#[pyfunction]
#[pyo3(signature = (case, threads, listener, in_process, along, keeps, stop, fields))]
#[allow(clippy::too_many_arguments, reason = "Python names them")]
pub fn run<'py>(
    py: Python<'py>,
    case: Parts,
    threads: usize,
    listener: Option<Py<PyAny>>,
    in_process: bool,
    along: Option<&Bound<'py, Trail>>,
    keeps: (bool, bool),
    stop: Option<&Bound<'py, Stop>>,
    fields: Option<PathBuf>,
) -> PyResult<Results<'py>> {
    let (records, views) = keeps;
    without_panic(|| {
        let source = source(case)?;
        if in_process {
            source.need().iter().flat_map(|need| need.libraries.keys()).for_each(|library| isolation::let_in(library));
        }
        let stop = stop.map_or_else(Arc::default, |stop| Arc::clone(&stop.get().0));
        let state: Arc<Mutex<State>> = Arc::default();
        let (columns, named) = mpsc::channel();
        let settings = Settings {
            threads: NonZeroUsize::new(threads),
            stop: Arc::clone(&stop),
            records,
            along: along.map(|trail| trail.get().0.clone()),
            views,
            fields,
            columns: Some(Box::new(move |names| {
                let _ = columns.send(names);
            })),
            listener: listener.as_ref().map(|_| {
                let state = Arc::clone(&state);
                let hear = move |part: f64, row: &pullout_run::path::Row<'_>| {
                    let place = [row.step, row.increment].map(f64::from);
                    let values = place.into_iter().chain(row.values.iter().copied()).chain([f64::from(row.iterations)]);
                    *state.lock().unwrap_or_else(PoisonError::into_inner) = Some((part, values.collect()));
                };
                Box::new(hear) as _
            }),
        };
        let work = move || -> Result<Outcome, Error> { source.read()?.run(settings) };
        let (answer, answered) = mpsc::channel();
        // a receiver is shared with no other thread, not even across the release of the GIL
        let answered = Mutex::new(answered);
        let wait = |time| answered.lock().unwrap_or_else(PoisonError::into_inner).recv_timeout(time);
        let thread = std::thread::Builder::new().name("pullout".into()).stack_size(PLUGIN_STACK);
        let thread = thread.spawn(move || {
            let _ = answer.send(work());
        })?;
        let mut names = Vec::new();
        let mut asked_to_end = None;
        let outcome = loop {
            let heard = py.detach(|| wait(LOOK));
            if heard.is_err()
                && stop.load(Ordering::Relaxed)
                && asked_to_end.get_or_insert_with(Instant::now).elapsed() > LONGEST
            {
                return Err(
                    Exception::Stopped.with("the run did not stop when asked to; it continues in the background")
                );
            }
            let notified = py.check_signals().and_then(|()| {
                let Some(listener) = &listener else { return Ok(()) };
                if names.is_empty() {
                    names = named.try_recv().unwrap_or_default();
                }
                let present = state.lock().unwrap_or_else(PoisonError::into_inner).take();
                let is_done = matches!(&heard, Ok(Ok(outcome)) if outcome.is_done());
                present
                    .map_or(Ok(()), |(part, row)| notify(py, listener, &names, if is_done { 1.0 } else { part }, &row))
            });
            match (heard, notified) {
                (Ok(Ok(_)) | Err(RecvTimeoutError::Timeout), Err(error)) => {
                    stop.store(true, Ordering::Relaxed);
                    let _ = py.detach(|| wait(PATIENCE));
                    return Err(error);
                }
                (Ok(outcome), _) => break outcome,
                (Err(RecvTimeoutError::Timeout), Ok(())) => {}
                (Err(RecvTimeoutError::Disconnected), _) => {
                    let panic = thread.join().err();
                    return Err(
                        panic.map_or_else(|| Exception::Pullout.with("the run ended"), |panic| of_panic(&*panic))
                    );
                }
            }
        };
        match outcome {
            Ok(outcome) => results(py, outcome),
            Err(Error::Case(errors)) => Err(refusal(&errors)),
            Err(error @ Error::Stopped) => Err(Exception::Stopped.with(error.to_string())),
            Err(error) => Err(Exception::Pullout.with(error.to_string())),
        }
    })
}

fn notify(py: Python<'_>, listener: &Py<PyAny>, names: &[String], part: f64, row: &[f64]) -> PyResult<()> {
    let columns = PyDict::new(py);
    for (name, value) in names.iter().zip(row) {
        columns.set_item(name, value)?;
    }
    listener.call1(py, (part, columns)).map(|_| ())
}

fn results(py: Python<'_>, outcome: Outcome) -> PyResult<Results<'_>> {
    let is_done = outcome.is_done();
    let mut texts: BTreeMap<String, String> =
        outcome.documents.iter().map(|(name, document)| (name.clone(), document.to_string())).collect();
    texts.insert("summary".into(), outcome.summary.text()?);
    texts.insert("prints".into(), outcome.prints);
    texts.extend(outcome.view.map(|page| ("view".into(), page)));
    let columns = outcome.history.into_columns();
    // the memory is handed over, not copied
    let columns = columns.map(|(name, values)| {
        let unit = Outcome::unit(&name);
        (name, unit, values.into_pyarray(py))
    });
    Ok((columns.collect(), texts, is_done, outcome.trail.map(|trail| Trail(trail.into()))))
}

/// Runs work that may call plugins on a thread with the stack that they may need.
pub fn with_stack<R: Send>(work: impl FnOnce() -> R + Send) -> PyResult<R> {
    in_threads([work]).remove(0)?.map_err(|panic| of_panic(&*panic))
}

/// Sets the files of the program `pullout` and of this module.
#[pyfunction]
pub fn set_program(file: PathBuf, module: PathBuf) {
    pullout_engine::set_program(&file, &module);
}

/// Runs the program with these arguments, the first of which is its name. Returns its exit code.
#[pyfunction]
pub fn main(py: Python<'_>, arguments: Vec<OsString>) -> PyResult<u8> {
    without_panic(|| Ok(py.detach(|| driver::command::main(arguments))))
}

/// The program `pullout`.
#[pyfunction]
pub fn program() -> PyResult<PathBuf> {
    isolation::program().map(Into::into).map_err(|error| Exception::Plugin.with(error.to_string()))
}

/// The cases that came with the package and have all words in path, title or description: file, kind and title of each.
#[pyfunction]
pub fn examples(words: Vec<String>) -> PyResult<Vec<(PathBuf, String, String)>> {
    let found = find_examples(&words).map_err(|error| Exception::Pullout.with(error.to_string()))?;
    Ok(found.into_iter().map(|Example { path, kind, title }| (path, kind, title)).collect())
}

/// Returns the unit of a column; empty for numbers and for unknown columns.
#[pyfunction]
pub fn unit(column: &str) -> &'static str {
    Outcome::unit(column)
}
