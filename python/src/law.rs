//! Laws: found, described, and called for many points at once.

use crate::errors::{Exception, case_error, of_panic, without_panic};
use numpy::{PyReadonlyArray1, PyReadonlyArray2, PyReadwriteArray2, PyReadwriteArray3};
use pullout_case::{ALL_LAWS, hint, not_found, props_from_json};
use pullout_run::PLUGIN_STACK;
use pullout_run::isolation;
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use serde_json::{Value, json};
use std::path::{Path, PathBuf};
use umat_abi::host::{self, Found, Library, Parameter, UmatCall, Validation, judge};
use umat_abi::law::{Request, StressState};
use umat_abi::metadata::{flags, kinds, stress_states};

/// Modes of a material point, with what a law says if it has them.
const MODES: [(&str, StressState, u32); 6] = [
    ("3d", StressState::ThreeD, stress_states::THREE_D),
    ("plane_strain", StressState::PlaneStrainOrAxisymmetric, stress_states::PLANE_STRAIN),
    ("axisymmetric", StressState::PlaneStrainOrAxisymmetric, stress_states::AXISYMMETRIC),
    ("plane_stress", StressState::PlaneStress, stress_states::PLANE_STRESS),
    ("1d", StressState::OneD, 0),
    ("beam", StressState::Beam, 0),
];

/// Points of a thread between two looks at signals.
const BLOCK: usize = 50_000;

/// The file of the plugin of this name, or of the library of this path.
#[pyfunction]
pub fn find(name: &str) -> PyResult<PathBuf> {
    let refuse = |message: String| Err(Exception::Plugin.with(message));
    if host::names_a_file(name) {
        let path = std::path::absolute(name)?;
        return if path.is_file() { Ok(path) } else { refuse(format!("there is no library file {}", path.display())) };
    }
    let folders = host::search_paths(&[]);
    match Found::by_name(name, &folders) {
        Some(found) => Ok(found.path),
        None => refuse(not_found(name, &folders)),
    }
}

/// The names of all plugins on the search path; the library of all laws is none of its own.
#[pyfunction]
pub fn plugins() -> Vec<String> {
    let found = Found::all(&host::search_paths(&[])).into_iter().map(|found| found.name);
    found.filter(|name| name != host::UTILITIES && name != ALL_LAWS).collect()
}

/// Returns whether a library was built with this extension, and so may be loaded into the interpreter.
#[pyfunction]
pub fn is_shipped(path: PathBuf) -> bool {
    isolation::is_shipped(&path)
}

/// A loaded library, and the law of it that is called.
#[derive(Debug)]
#[pyclass(frozen, module = "pullout_fe._core")]
pub struct Plugin {
    library: Library,
    law: Option<host::LawDescription>,
    cmname: String,
}

/// A point that could not be updated: its index, the reason, the fraction of the increment that is worth a try.
type Refused = (usize, String, Option<f64>);

#[pymethods]
impl Plugin {
    /// Loads a library that may run here, or that the user answers for. `law` chooses among several.
    #[new]
    #[pyo3(signature = (path, law=None, in_process=false))]
    fn new(py: Python<'_>, path: PathBuf, law: Option<&str>, in_process: bool) -> PyResult<Self> {
        without_panic(|| {
            if in_process {
                isolation::let_in(&path);
            }
            let library = py.detach(|| isolation::load(&path));
            let library = library.map_err(|error| Exception::Plugin.with(error.to_string()))?;
            let chosen = choose(&library, law)?;
            let name = chosen.as_ref().map_or_else(|| host::library_name(&path), |law| law.name.clone());
            Ok(Self { cmname: law.unwrap_or(&name).to_uppercase(), library, law: chosen })
        })
    }

    /// Returns what the library says of its law, as JSON; "null" if it says nothing.
    fn describe(&self) -> String {
        self.law.as_ref().map_or(Value::Null, description).to_string()
    }

    /// PROPS of what a case's `props` say, as JSON.
    fn props(&self, props: &str) -> PyResult<Vec<f64>> {
        let props: Value = serde_json::from_str(props).map_err(|error| PyValueError::new_err(error.to_string()))?;
        let Some(law) = &self.law else {
            return serde_json::from_value(props).map_err(|_| {
                let message = "the library describes no parameters (it has no metadata): give an array in PROPS order";
                Exception::Case.with(message)
            });
        };
        let values = props_from_json(law, &props).map_err(|problems| case_error(&problems))?;
        match law.validate(&values, None) {
            Validation::Valid | Validation::NeedsCharacteristicLength(_) => Ok(values),
            Validation::Invalid(message) => Err(Exception::Case.with(format!("{}: {message}", law.name))),
        }
    }

    /// Returns why the law needs the characteristic length of each point with these PROPS; `None`: it does not.
    fn needs_length(&self, props: PyReadonlyArray1<'_, f64>) -> PyResult<Option<String>> {
        let Some(law) = &self.law else { return Ok(None) };
        Ok(match law.validate(props.as_slice()?, None) {
            Validation::NeedsCharacteristicLength(message) => Some(message),
            Validation::Valid | Validation::Invalid(_) => None,
        })
    }

    /// Updates points: each row of the arrays is one. `stress` and `state` are those of the start, and become those of the
    /// end; what came in stays where a point is refused.
    #[allow(clippy::too_many_arguments, reason = "they are a UMAT's")]
    #[pyo3(signature = (mode, props, strain, dstrain, stress, state, tangent, lengths, time, threads))]
    fn evaluate(
        &self,
        py: Python<'_>,
        mode: &str,
        props: PyReadonlyArray1<'_, f64>,
        strain: PyReadonlyArray2<'_, f64>,
        dstrain: PyReadonlyArray2<'_, f64>,
        mut stress: PyReadwriteArray2<'_, f64>,
        mut state: PyReadwriteArray2<'_, f64>,
        mut tangent: Option<PyReadwriteArray3<'_, f64>>,
        lengths: Option<PyReadonlyArray1<'_, f64>>,
        time: [f64; 2],
        threads: usize,
    ) -> PyResult<Vec<Refused>> {
        without_panic(|| {
            let stress_state = self.stress_state(mode)?;
            let (rows, components) = (stress.as_array().nrows(), stress_state.components().len());
            let nstatv = state.as_array().ncols();
            let shapes = [strain.as_array().dim(), dstrain.as_array().dim(), stress.as_array().dim()];
            let fits = shapes.iter().all(|shape| *shape == (rows, components))
                && state.as_array().nrows() == rows
                && tangent.as_ref().is_none_or(|array| array.as_array().dim() == (rows, components, components))
                && lengths.as_ref().is_none_or(|array| array.as_array().len() == rows);
            if !fits {
                return Err(PyValueError::new_err(format!(
                    "mode {mode} has {components} components; shapes {shapes:?}"
                )));
            }
            let props = props.as_slice()?;
            let call = UmatCall::new(&self.library, None, &self.cmname, stress_state, nstatv, props);
            let mut first = call.map_err(|error| Exception::Plugin.with(error.to_string()))?;
            let points = Points {
                first: 0,
                components,
                nstatv,
                strain: strain.as_slice()?,
                dstrain: dstrain.as_slice()?,
                stress: stress.as_slice_mut()?,
                state: state.as_slice_mut()?,
                tangent: tangent.as_mut().map(|array| array.as_slice_mut()).transpose()?,
                lengths: lengths.as_ref().map(|array| array.as_slice()).transpose()?,
                time,
            };
            let is_vouched_for = isolation::is_shipped(self.library.path());
            let make = || UmatCall::new(&self.library, None, &self.cmname, stress_state, nstatv, props);
            let (mut rest, mut refused) = (points, Vec::new());
            loop {
                let count = rest.count().min(BLOCK * threads.max(1));
                let [block, behind] = rest.split(count);
                rest = behind;
                refused.extend(if threads <= 1 && is_vouched_for {
                    py.detach(|| block.update(&mut first))
                } else {
                    py.detach(|| in_threads(block, threads.max(1), make))?
                });
                if rest.count() == 0 {
                    return Ok(refused);
                }
                py.check_signals()?;
            }
        })
    }
}

impl Plugin {
    fn stress_state(&self, mode: &str) -> PyResult<StressState> {
        let names = MODES.map(|(name, ..)| name);
        let Some((_, stress_state, bit)) = MODES.into_iter().find(|(name, ..)| *name == mode) else {
            let message = format!("'{mode}' is not one of the modes {}{}", names.join(", "), hint(mode, names));
            return Err(Exception::Case.with(message));
        };
        match &self.law {
            Some(law) if law.kinds & kinds::UMAT == 0 => Err(Exception::Case
                .with(format!("{} is a law of a contact point: run a case of kind \"interface\"", law.name))),
            Some(law) if law.stress_states & bit == 0 => {
                let message =
                    format!("{} does not support mode {mode}; supported: {}", law.name, modes(law).join(", "));
                Err(Exception::Case.with(message))
            }
            _ => Ok(stress_state),
        }
    }
}

/// The law of a library that is meant.
fn choose(library: &Library, law: Option<&str>) -> PyResult<Option<host::LawDescription>> {
    let laws = library.laws();
    let names = || laws.iter().map(|law| law.name.as_str()).collect::<Vec<_>>();
    match (laws, law) {
        ([] | [_], None) => Ok(laws.first().cloned()),
        (_, None) => {
            let message = format!("the library has several laws: name one of {} as law=…", names().join(", "));
            Err(Exception::Plugin.with(message))
        }
        (_, Some(law)) => match host::LawDescription::named(laws, law) {
            None if !laws.is_empty() => {
                let message = format!("'{law}' begins with the name of no law of the library{}", hint(law, names()));
                Err(Exception::Plugin.with(message))
            }
            found => Ok(found.cloned()),
        },
    }
}

fn modes(law: &host::LawDescription) -> Vec<&'static str> {
    MODES.into_iter().filter(|(_, _, bit)| law.stress_states & bit != 0).map(|(name, ..)| name).collect()
}

fn description(law: &host::LawDescription) -> Value {
    // what is unbounded is null
    let finite = |value: f64| value.is_finite().then_some(value);
    let parameter = |p: &Parameter| {
        json!({
            "name": p.name, "unit": p.unit, "default": finite(p.default_value), "doc": p.doc,
            "lower": finite(p.lower), "upper": finite(p.upper), "bounds": p.bounds(), "typical": p.typical,
            "choices": p.choices.iter().map(|c| (c.name.clone(), json!(c.value))).collect::<serde_json::Map<_, _>>(),
        })
    };
    json!({
        "name": law.name,
        "version": law.version,
        "description": law.description,
        "entries": law.entry_points(),
        "modes": modes(law),
        "parameters": law.parameters.iter().map(parameter).collect::<Vec<_>>(),
        "repeated": law.group.as_ref().map(|group| json!({ "name": group.name, "size": group.size })),
        "states": law.states.iter().map(|s| json!({ "name": s.name, "unit": s.unit, "doc": s.doc })).collect::<Vec<_>>(),
        "symmetric_tangent": law.has(flags::SYMMETRIC_TANGENT),
        "uses_length": law.has(flags::USES_CELENT),
    })
}

/// Rows of the arrays.
struct Points<'a> {
    /// Index of the first.
    first: usize,
    components: usize,
    nstatv: usize,
    strain: &'a [f64],
    dstrain: &'a [f64],
    stress: &'a mut [f64],
    state: &'a mut [f64],
    tangent: Option<&'a mut [f64]>,
    lengths: Option<&'a [f64]>,
    /// Time at the start of the increment, and the increment, s.
    time: [f64; 2],
}

impl<'a> Points<'a> {
    fn count(&self) -> usize {
        self.stress.len() / self.components
    }

    /// Splits off the rows from `count` on.
    fn split(self, count: usize) -> [Self; 2] {
        let Self { first, components, nstatv, time, .. } = self;
        let (strain, dstrain) = (self.strain.split_at(count * components), self.dstrain.split_at(count * components));
        let (stress, rest_stress) = self.stress.split_at_mut(count * components);
        let (state, rest_state) = self.state.split_at_mut(count * nstatv);
        let (tangent, rest_tangent) = self.tangent.map(|t| t.split_at_mut(count * components * components)).unzip();
        let (lengths, rest_lengths) = self.lengths.map(|lengths| lengths.split_at(count)).unzip();
        let rest = Self {
            first: first + count,
            components,
            nstatv,
            strain: strain.1,
            dstrain: dstrain.1,
            stress: rest_stress,
            state: rest_state,
            tangent: rest_tangent,
            lengths: rest_lengths,
            time,
        };
        let beginning = Self {
            first,
            components,
            nstatv,
            strain: strain.0,
            dstrain: dstrain.0,
            stress,
            state,
            tangent,
            lengths,
            time,
        };
        [beginning, rest]
    }

    /// Calls the law for each row.
    fn update(mut self, call: &mut UmatCall) -> Vec<Refused> {
        let (components, nstatv) = (self.components, self.nstatv);
        let request = if self.tangent.is_some() { Request::StressAndTangent } else { Request::Stress };
        let mut refused = Vec::new();
        (call.time, call.dtime) = ([self.time[0]; 2], self.time[1]);
        for k in 0..self.count() {
            let row = k * components..(k + 1) * components;
            let states = k * nstatv..(k + 1) * nstatv;
            let point = [&self.strain[row.clone()], &self.dstrain[row.clone()], &self.stress[row.clone()]];
            call.set_point(point, &self.state[states.clone()], [0.0; 3]);
            call.noel = i32::try_from(self.first + k + 1).unwrap_or(i32::MAX);
            if let Some(lengths) = self.lengths {
                call.celent = lengths[k];
            }
            let outcome = call.call(request);
            let moduli = || request.wants_tangent().then(|| call.moduli_not_finite()).flatten();
            match judge(outcome, call.not_finite().or_else(moduli)) {
                Ok(()) => {
                    self.stress[row].copy_from_slice(call.stress());
                    self.state[states].copy_from_slice(call.statev());
                    if let Some(tangent) = &mut self.tangent {
                        let size = components * components;
                        let rows = tangent[k * size..(k + 1) * size].chunks_exact_mut(components);
                        for (i, row) in rows.enumerate() {
                            row.iter_mut().enumerate().for_each(|(j, value)| *value = call.tangent(i, j));
                        }
                    }
                }
                Err(failure) => {
                    refused.push((self.first + k, failure.to_string(), failure.fraction(0.25)));
                }
            }
        }
        refused
    }
}

/// Updates pieces of the points, each in a thread with the stack that plugins may want.
fn in_threads(
    points: Points<'_>,
    threads: usize,
    make: impl Fn() -> Result<UmatCall, host::LoadError>,
) -> PyResult<Vec<Refused>> {
    let size = points.count().div_ceil(threads).max(1);
    std::thread::scope(|scope| {
        let mut rest = points;
        let mut handles = Vec::new();
        loop {
            let count = rest.count().min(size);
            let [piece, behind] = rest.split(count);
            rest = behind;
            let mut call = make().map_err(|error| Exception::Plugin.with(error.to_string()))?;
            let thread = std::thread::Builder::new().stack_size(PLUGIN_STACK);
            handles.push(thread.spawn_scoped(scope, move || piece.update(&mut call))?);
            if rest.count() == 0 {
                break;
            }
        }
        let mut refused = Vec::new();
        for handle in handles {
            refused.extend(handle.join().map_err(|panic| of_panic(&*panic))?);
        }
        Ok(refused)
    })
}

/// SHA-256 of a file, in hexadecimal digits.
#[pyfunction]
pub fn sha256(path: PathBuf) -> PyResult<String> {
    let hash = |path: &Path| pullout_run::input::hash(path, pullout_run::input::Input::Library);
    let hash = hash(&path).map_err(|error| Exception::Plugin.with(format!("{}: {error}", path.display())))?;
    Ok(pullout_run::input::digits(hash))
}
