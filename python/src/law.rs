//! Laws: found, described, and called for many points at once.

use crate::analysis::Analysis;
use crate::errors::{Exception, case_error, of_panic, without_panic, wrong};
use crate::points::{Given, Inputs, Refused, Rows, Work, numbers};
use crate::run::with_stack;
use numpy::{PyReadonlyArray1, PyReadonlyArray2, PyReadwriteArray2};
use pullout_case::{ALL_LAWS, frame_from_json, hint, not_found, props_from_json};
use pullout_run::program::Mode;
use pullout_run::{isolation, sources};
use pyo3::exceptions::{PyKeyError, PyValueError};
use pyo3::prelude::*;
use pyo3::types::PyDict;
use serde_json::{Value, json};
use std::path::{Path, PathBuf};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use umat_abi::host::{
    self, ExternalDatabases, Found, Frame, InitialPoint, InitialStates, InitialStresses, Library, LoadError, Manner,
    Parameter, Validation,
};
use umat_abi::law::StressState;
use umat_abi::metadata::{flags, kinds, stress_states};

/// Modes of a material point, with what a law says if it has them.
const MODES: [(Mode, u32); 6] = [
    (Mode::ThreeD, stress_states::THREE_D),
    (Mode::PlaneStrain, stress_states::PLANE_STRAIN),
    (Mode::Axisymmetric, stress_states::AXISYMMETRIC),
    (Mode::PlaneStress, stress_states::PLANE_STRESS),
    (Mode::OneD, 0),
    (Mode::Beam, 0),
];

/// Points of a thread between two looks at signals.
const BLOCK: usize = 50_000;

/// The file of the plugin of this name, or of the library of this path.
#[pyfunction]
pub fn find(name: &str) -> PyResult<PathBuf> {
    let refuse = |message: String| Err(Exception::Plugin.with(message));
    if host::names_a_file(name) {
        let path = std::path::absolute(name)?;
        if !path.is_file() {
            return refuse(format!("there is no library file {}", path.display()));
        }
        driver::command::compile_sources(false);
        return sources::library_of(path).map_err(|message| Exception::Plugin.with(message));
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

/// Axes and free strains of the last call: the request, the mode, and the result.
type LastFrame = (String, Mode, Option<Arc<Frame>>);

/// A loaded library, and the law of it that is called.
#[derive(Debug)]
#[pyclass(frozen, module = "pullout_fe._core")]
pub(crate) struct Plugin {
    library: Library,
    law: Option<host::LawDescription>,
    cmname: String,
    /// Whether every thread that calls it has the stack that plugins may want.
    has_stack: bool,
    analysis: Arc<Mutex<Analysis>>,
    /// Why calls with the components of a plane go through six instead, once trial calls have shown it.
    planes: Mutex<Vec<(StressState, Option<String>)>>,
    /// The frame that was read last, with the text and the mode that it is of.
    frame: Mutex<Option<LastFrame>>,
}

#[pymethods]
impl Plugin {
    /// Loads a library that may run here, or that the user trusts. `law` chooses among several; `has_stack`: the calling threads
    /// have the stack that plugins may need.
    #[new]
    #[pyo3(signature = (path, law=None, in_process=false, has_stack=false))]
    fn new(py: Python<'_>, path: PathBuf, law: Option<&str>, in_process: bool, has_stack: bool) -> PyResult<Self> {
        without_panic(|| {
            if in_process {
                isolation::let_in(&path);
            }
            let library = py.detach(|| isolation::load(&path));
            let library = library.map_err(|error| Exception::Plugin.with(error.to_string()))?;
            let chosen = choose(&library, law)?;
            let name = chosen.as_ref().map_or_else(|| host::library_name(&path), |law| law.name.clone());
            Ok(Self {
                cmname: law.unwrap_or(&name).to_uppercase(),
                law: chosen,
                has_stack: has_stack || isolation::is_shipped(&path),
                analysis: Analysis::of(&library),
                planes: Mutex::default(),
                frame: Mutex::default(),
                library,
            })
        })
    }

    /// Returns the library's description of its law (`null` if there is none) and its other routines, as JSON.
    fn describe(&self) -> String {
        let routines: Vec<_> = self.library.routines().iter().map(|routine| routine.symbol).collect();
        json!({ "law": self.law.as_ref().map(description), "routines": routines }).to_string()
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

    /// Fills stresses and states, one row per point, with the initial values of the library's SIGINI and SDVINI. If the library lacks
    /// one of them, its array is unchanged. `coords`: one row per point, or one for all. `frame`: as in [`Self::evaluate`].
    #[allow(clippy::too_many_arguments, reason = "Python names them")]
    #[pyo3(signature = (mode, coords, per_element, stress, state, frame=""))]
    fn initial(
        &self,
        py: Python<'_>,
        mode: &str,
        coords: PyReadonlyArray2<'_, f64>,
        per_element: usize,
        mut stress: PyReadwriteArray2<'_, f64>,
        mut state: PyReadwriteArray2<'_, f64>,
        frame: &str,
    ) -> PyResult<()> {
        without_panic(|| {
            let (mode, _) = self.mode(mode)?;
            let frame = self.frame(frame, mode)?;
            let (count, components) = stress.as_array().dim();
            let nstatv = state.as_array().ncols();
            let (stress, state) = (stress.as_slice_mut()?, state.as_slice_mut()?);
            let coords = coords.as_slice()?;
            let fill = || -> Result<(), String> {
                // what UEXTERNALDB reads is there for them
                self.analysis().begin(&self.library);
                let mut states = InitialStates::new(&self.library, None, nstatv);
                let mut stresses = InitialStresses::new(&self.library, None, components);
                for k in 0..count {
                    let [element, point] = numbers(k, per_element);
                    let row = if coords.len() == 3 { 0 } else { 3 * k };
                    let coordinates = std::array::from_fn(|i| coords[row + i]);
                    let point = InitialPoint { coordinates, element, point };
                    if !states.are_zero() {
                        state[k * nstatv..(k + 1) * nstatv].copy_from_slice(&states.of_point(&point)?);
                    }
                    if !stresses.are_zero() {
                        let mut values = stresses.of_point(&point, mode.element_type())?;
                        if let Some(frame) = &frame {
                            // SIGINI speaks of the local axes
                            frame.stress_outside(&mut values, mode.stress_state());
                        }
                        stress[k * components..(k + 1) * components].copy_from_slice(&values);
                    }
                }
                Ok(())
            };
            self.on_stack(py, fill)?.map_err(|message| Exception::Pullout.with(message))
        })
    }

    /// Updates points: each row of an array is one, and an input with one row is that of all. Of `arrays`, by name, `stress`, `state` and,
    /// if they are there, `energies` are those of the start and become those of the end, `tangent` and `heat` (RPL, DRPLDT, DDSDDT,
    /// DRPLDE) become those of the end; what came in stays where a point is refused. `frame`: what a case's material says of `expansion`,
    /// `shrinkage` and `orientation`, as JSON, or nothing. A point whose input is not finite is refused if it may be, else an error.
    ///
    /// The result: the points that are refused, and why calls in a plane go through six components, if they do.
    #[allow(clippy::too_many_arguments, reason = "Python names them")]
    #[pyo3(signature = (mode, arrays, time, per_element, threads, may_refuse, frame=""))]
    fn evaluate(
        &self,
        py: Python<'_>,
        mode: &str,
        arrays: &Bound<'_, PyDict>,
        time: [f64; 2],
        per_element: usize,
        threads: usize,
        may_refuse: bool,
        frame: &str,
    ) -> PyResult<(Vec<Refused>, Option<String>)> {
        without_panic(|| {
            let case_mode = self.mode(mode)?.0;
            let state = case_mode.stress_state();
            let frame = self.frame(frame, case_mode)?;
            let components = state.components().len();
            let mut results = [None, None, None, None, None];
            for (result, name) in results.iter_mut().zip(["stress", "state", "tangent", "energies", "heat"]) {
                let array = arrays.get_item(name)?;
                *result = array.map(|array| array.extract::<PyReadwriteArray2<'_, f64>>()).transpose()?;
            }
            let count = results[0].as_ref().map_or(0, |stress| stress.as_array().nrows());
            let [stress, states, tangent, energies, heat] = results.each_mut().map(Option::as_mut);
            let fits = |array: &PyReadwriteArray2<'_, f64>, width| array.as_array().dim() == (count, width);
            let (Some(stress), Some(states)) = (stress, states) else {
                return Err(PyKeyError::new_err("stress, state"));
            };
            let nstatv = states.as_array().ncols();
            let all_fit = fits(stress, components)
                && states.as_array().nrows() == count
                && tangent.as_ref().is_none_or(|array| fits(array, components * components))
                && energies.as_ref().is_none_or(|array| fits(array, 3))
                && heat.as_ref().is_none_or(|array| fits(array, 2 + 2 * components));
            let rows = Rows {
                first: 0,
                count,
                stress: stress.as_slice_mut()?,
                state: states.as_slice_mut()?,
                tangent: tangent.map(|array| array.as_slice_mut()).transpose()?,
                energies: energies.map(|array| array.as_slice_mut()).transpose()?,
                heat: heat.map(|array| array.as_slice_mut()).transpose()?,
            };
            let mut read = Vec::new();
            for (name, width) in GIVEN {
                let array =
                    arrays.get_item(name)?.map(|array| array.extract::<PyReadonlyArray2<'_, f64>>()).transpose()?;
                read.extend(array.map(|array| (name, width.unwrap_or(components), array)));
            }
            let mut given = Vec::new();
            for (name, width, array) in &read {
                let (rows, columns) = array.as_array().dim();
                let is_right = (rows == count || rows == 1) && (*width == 0 || columns == *width);
                if !is_right || !all_fit {
                    return Err(PyValueError::new_err(format!("mode {mode} has {components} components; {name}")));
                }
                given.push(Given { name, values: array.as_slice()?, width: columns, is_one: rows == 1 });
            }
            let find = |name| given.iter().find(|given| given.name == name).copied();
            let needed = |name| find(name).ok_or_else(|| PyKeyError::new_err(name));
            let mut inputs = Inputs {
                time,
                increment: 1,
                per_element: per_element.max(1),
                props: needed("props")?,
                strain: needed("strain")?,
                dstrain: needed("dstrain")?,
                length: find("length"),
                temperature: ["temperature", "dtemperature"].map(find),
                fields: ["fields", "dfields"].map(find),
                gradients: ["dfgrd0", "dfgrd1"].map(find),
                rotation: find("drot"),
                coords: find("coords"),
            };
            if count == 0 {
                return Ok((Vec::new(), None));
            }
            inputs.check(&rows, self.law.as_ref(), may_refuse)?;
            let mut prepare = || {
                inputs.increment = self.analysis().increment(&self.library, time);
                self.through_six(state, &inputs, nstatv)
            };
            // a thread takes longer than the update of a few points
            let may_call = ExternalDatabases::is_in([&self.library]) || state != StressState::ThreeD;
            let prepared = if may_call { self.on_stack(py, prepare)? } else { prepare() };
            let reason = prepared.map_err(|error| Exception::Plugin.with(error.to_string()))?;
            if let (Some(reason), StressState::PlaneStress) = (&reason, state) {
                let message =
                    format!("{reason}, which \"3d\" has; a case of mode \"plane_stress\" finds the strain 33 for them");
                return Err(wrong("mode", message));
            }
            let (six, inputs) = (reason.is_some(), inputs);
            let make = |props: &[f64]| {
                let plugin = host::Plugin { frame: frame.clone(), ..self.plugin(nstatv, props, six) };
                let mut call = plugin.umat(state)?;
                inputs.prepare(&mut call);
                Ok(call)
            };
            let work = Work { inputs: &inputs, law: self.law.as_ref(), may_refuse, make: &make };
            let mut rest = rows;
            let mut refused = Vec::new();
            loop {
                let block = rest.count.min(BLOCK * threads.max(1));
                let [block, behind] = rest.split(block);
                rest = behind;
                refused.extend(if threads <= 1 && self.has_stack {
                    py.detach(|| block.update(&work))?
                } else {
                    py.detach(|| in_threads(block, threads.max(1), &work))?
                });
                if rest.count == 0 {
                    return Ok((refused, reason));
                }
                py.check_signals()?;
            }
        })
    }
}

/// What points are given besides stress, state and energies at the start, and the number of values; `None`: components, 0: any.
const GIVEN: [(&str, Option<usize>); 12] = [
    ("props", Some(0)),
    ("strain", None),
    ("dstrain", None),
    ("length", Some(1)),
    ("temperature", Some(1)),
    ("dtemperature", Some(1)),
    ("fields", Some(0)),
    ("dfields", Some(0)),
    ("dfgrd0", Some(9)),
    ("dfgrd1", Some(9)),
    ("drot", Some(9)),
    ("coords", Some(3)),
];

impl Plugin {
    /// A mode that the law has, with its stress state as metadata have it.
    fn mode(&self, name: &str) -> PyResult<(Mode, u32)> {
        let names = MODES.map(|(mode, _)| mode.name());
        let Some(found) = MODES.into_iter().find(|(mode, _)| mode.name() == name) else {
            return Err(wrong(
                "mode",
                format!("'{name}' is not one of the modes {}{}", names.join(", "), hint(name, names)),
            ));
        };
        match &self.law {
            Some(law) if law.kinds & kinds::UMAT == 0 => Err(Exception::Case
                .with(format!("{} is a law of a contact point: run a case of kind \"interface\"", law.name))),
            Some(law) if law.stress_states & found.1 == 0 => {
                let supported = modes(law).join(", ");
                Err(wrong("mode", format!("{} does not support mode {name}; supported: {supported}", law.name)))
            }
            _ => Ok(found),
        }
    }

    /// The frame that a text says for points of a mode; `None`: the law sees what its caller has.
    fn frame(&self, text: &str, mode: Mode) -> PyResult<Option<Arc<Frame>>> {
        if text.is_empty() {
            return Ok(None);
        }
        let mut last = self.frame.lock().unwrap_or_else(PoisonError::into_inner);
        if let Some((known, of_mode, frame)) = &*last
            && (known.as_str(), *of_mode) == (text, mode)
        {
            return Ok(frame.clone());
        }
        let material: Value = serde_json::from_str(text).map_err(|error| PyValueError::new_err(error.to_string()))?;
        let frame = frame_from_json(&material, mode).map_err(|problems| case_error(&problems))?;
        *last = Some((text.to_owned(), mode, frame.clone()));
        Ok(frame)
    }

    fn analysis(&self) -> MutexGuard<'_, Analysis> {
        self.analysis.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Does something that may call the library without the GIL, on a thread with the stack that plugins may want.
    fn on_stack<R: Send>(&self, py: Python<'_>, work: impl FnOnce() -> R + Send) -> PyResult<R> {
        if self.has_stack { Ok(py.detach(work)) } else { py.detach(|| with_stack(work)) }
    }

    /// The law with everything that its calls need.
    fn plugin(&self, nstatv: usize, props: &[f64], six: bool) -> host::Plugin {
        host::Plugin {
            library: self.library.clone(),
            law: self.law.clone(),
            name: self.cmname.clone(),
            symbol: None,
            cmname: self.cmname.clone(),
            props: props.to_vec(),
            nstatv,
            frame: None,
            manner: Manner { as_three_d: Some(six), tangent: None },
        }
    }

    /// Returns why calls in a plane go through six components, if a library without metadata needs that. Trial calls show it, once
    /// for each stress state, as in a run.
    fn through_six(&self, state: StressState, inputs: &Inputs<'_>, nstatv: usize) -> Result<Option<String>, LoadError> {
        if self.law.is_some() || state == StressState::ThreeD {
            return Ok(None);
        }
        let mut planes = self.planes.lock().unwrap_or_else(PoisonError::into_inner);
        if let Some((_, reason)) = planes.iter().find(|(known, _)| *known == state) {
            return Ok(reason.clone());
        }
        let mut plugin = self.plugin(nstatv, inputs.first_props(), false);
        plugin.manner = Manner::default();
        let mut call = plugin.umat(state)?;
        inputs.prepare(&mut call);
        inputs.set(&mut call, 0);
        let [element, point] = [call.noel, call.npt];
        let point = InitialPoint { coordinates: call.coords, element, point };
        if let Ok(states) = InitialStates::new(&self.library, None, nstatv).of_point(&point) {
            let nothing = vec![0.0; state.components().len()];
            call.set_point([&nothing; 3].map(Vec::as_slice), &states, [0.0; 3]);
        }
        let reason = plugin.probe(&mut call)?;
        planes.push((state, reason.clone()));
        Ok(reason)
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
    MODES.into_iter().filter(|(_, bit)| law.stress_states & bit != 0).map(|(mode, _)| mode.name()).collect()
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

/// Updates pieces of the points, each in a thread with the stack that plugins may want.
fn in_threads(points: Rows<'_>, threads: usize, work: &Work<'_>) -> PyResult<Vec<Refused>> {
    let size = points.count.div_ceil(threads).max(1);
    let (mut rest, mut pieces) = (points, Vec::new());
    while rest.count > 0 {
        let count = rest.count.min(size);
        let [piece, behind] = rest.split(count);
        rest = behind;
        pieces.push(move || piece.update(work));
    }
    let mut refused = Vec::new();
    for ended in pullout_run::in_threads(pieces) {
        refused.extend(ended?.map_err(|panic| of_panic(&*panic))??);
    }
    Ok(refused)
}

/// SHA-256 of a file, in hexadecimal digits.
#[pyfunction]
pub fn sha256(path: PathBuf) -> PyResult<String> {
    let hash = |path: &Path| pullout_run::input::hash(path, pullout_run::input::Input::Library);
    let hash = hash(&path).map_err(|error| Exception::Plugin.with(format!("{}: {error}", path.display())))?;
    Ok(pullout_run::input::digits(hash))
}
