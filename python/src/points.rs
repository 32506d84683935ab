//! Rows of arrays: what many points are given, and what becomes of them.

use crate::errors::{Exception, wrong};
use pyo3::prelude::*;
use umat_abi::host::{Heat, LawDescription, LoadError, UmatCall, Validation, judge};
use umat_abi::law::Request;

/// A point that could not be updated: its index, the reason, and the fraction of the increment to try next.
pub type Refused = (usize, String, Option<f64>);

/// Values of an input: a row a point, or one for all.
#[derive(Clone, Copy, Debug)]
pub struct Given<'a> {
    /// Name in messages.
    pub name: &'static str,
    /// Row by row.
    pub values: &'a [f64],
    /// Values of a row.
    pub width: usize,
    /// Whether one row is that of all points.
    pub is_one: bool,
}

impl<'a> Given<'a> {
    fn row(&self, point: usize) -> &'a [f64] {
        let row = if self.is_one { 0 } else { point };
        &self.values[row * self.width..(row + 1) * self.width]
    }

    /// The first value that is not finite, with its place.
    fn not_finite(&self) -> Option<PyErr> {
        let k = self.values.iter().position(|value| !value.is_finite())?;
        let [point, place] = [k / self.width, k % self.width];
        let point = if self.is_one { String::new() } else { format!("[{point}]") };
        let place = if self.width == 1 { String::new() } else { format!("[{place}]") };
        Some(wrong(format!("{}{point}{place}", self.name), format!("is {}, not a finite number", self.values[k])))
    }
}

/// What points are given.
#[derive(Clone, Debug)]
pub struct Inputs<'a> {
    /// Time at the start of the increment, and the increment, s.
    pub time: [f64; 2],
    /// KINC.
    pub increment: i32,
    /// Number of points of an element; they follow one another.
    pub per_element: usize,
    /// PROPS.
    pub props: Given<'a>,
    /// STRAN.
    pub strain: Given<'a>,
    /// DSTRAN.
    pub dstrain: Given<'a>,
    /// CELENT.
    pub length: Option<Given<'a>>,
    /// TEMP and DTEMP.
    pub temperature: [Option<Given<'a>>; 2],
    /// PREDEF and DPRED.
    pub fields: [Option<Given<'a>>; 2],
    /// DFGRD0 and DFGRD1, row by row.
    pub gradients: [Option<Given<'a>>; 2],
    /// DROT, row by row.
    pub rotation: Option<Given<'a>>,
    /// COORDS.
    pub coords: Option<Given<'a>>,
}

/// State of the points at the start and at the end, one row per point.
#[derive(Debug)]
pub(crate) struct Rows<'a> {
    /// Index of the first.
    pub first: usize,
    /// Their number.
    pub count: usize,
    /// STRESS.
    pub stress: &'a mut [f64],
    /// STATEV.
    pub state: &'a mut [f64],
    /// DDSDDE, if requested.
    pub tangent: Option<&'a mut [f64]>,
    /// SSE, SPD and SCD, if they are wanted.
    pub energies: Option<&'a mut [f64]>,
    /// RPL, DRPLDT, DDSDDT and DRPLDE, if requested.
    pub heat: Option<&'a mut [f64]>,
}

/// NOEL and NPT of a point.
pub fn numbers(point: usize, per_element: usize) -> [i32; 2] {
    [point / per_element, point % per_element].map(|index| i32::try_from(index + 1).unwrap_or(i32::MAX))
}

/// A matrix as Fortran has it, of one row by row.
fn by_columns(rows: &[f64]) -> [[f64; 3]; 3] {
    std::array::from_fn(|j| std::array::from_fn(|i| rows[3 * i + j]))
}

impl<'a> Inputs<'a> {
    fn all(&self) -> impl Iterator<Item = &Given<'a>> {
        [&self.props, &self.strain, &self.dstrain]
            .into_iter()
            .chain([&self.length, &self.rotation, &self.coords].into_iter().flatten())
            .chain([&self.temperature, &self.fields, &self.gradients].into_iter().flatten().flatten())
    }

    /// Refuses input that no smaller increment can mend: numbers that are not finite, parameters that the law does not admit. If
    /// single points may be refused, only parameters and values shared by all points are checked here.
    pub fn check(&self, rows: &Rows<'_>, law: Option<&LawDescription>, may_refuse: bool) -> PyResult<()> {
        let looked_at = self.all().filter(|given| !may_refuse || given.is_one || given.name == "props");
        let width = |values: &[f64]| values.len() / rows.count;
        let start = [("stress", &*rows.stress), ("state", &*rows.state)].into_iter();
        let start = start.chain(rows.energies.as_deref().map(|energies| ("energies", energies)));
        let start = start.map(|(name, values)| Given { name, values, width: width(values), is_one: false });
        let start: Vec<_> = start.filter(|given| !may_refuse && given.width > 0).collect();
        if let Some(error) = looked_at.chain(&start).find_map(Given::not_finite) {
            return Err(error);
        }
        let Some(law) = law else { return Ok(()) };
        let mut last: Option<&[f64]> = None;
        for point in 0..if self.props.is_one { 1 } else { rows.count } {
            let props = self.props.row(point);
            if last.replace(props) == Some(props) {
                continue;
            }
            let place = |name: &str| if self.props.is_one { name.to_owned() } else { format!("{name}[{point}]") };
            match law.validate(props, None) {
                Validation::NeedsCharacteristicLength(message) if self.length.is_none() => {
                    return Err(wrong(place("length"), format!("is missing: {}: {message}", law.name)));
                }
                Validation::Invalid(message) => return Err(wrong(place("props"), format!("{}: {message}", law.name))),
                Validation::Valid | Validation::NeedsCharacteristicLength(_) => {}
            }
        }
        Ok(())
    }

    /// Sets everything that does not depend on the state of a point.
    pub fn set(&self, call: &mut UmatCall, point: usize) {
        [call.noel, call.npt] = numbers(point, self.per_element);
        if let Some(length) = &self.length {
            call.celent = length.row(point)[0];
        }
        let [temperature, increment] = &self.temperature;
        call.temp = temperature.map_or(0.0, |given| given.row(point)[0]);
        call.dtemp = increment.map_or(0.0, |given| given.row(point)[0]);
        for (to, given) in [&mut call.predef, &mut call.dpred].into_iter().zip(&self.fields) {
            if let Some(given) = given {
                to.clear();
                to.extend_from_slice(given.row(point));
            }
        }
        if let [Some(start), Some(end)] = &self.gradients {
            [call.dfgrd0, call.dfgrd1] = [start, end].map(|given| by_columns(given.row(point)));
        }
        if let Some(rotation) = &self.rotation {
            call.drot = by_columns(rotation.row(point));
        }
        if let Some(coords) = &self.coords {
            call.coords.copy_from_slice(coords.row(point));
        }
    }

    /// Prepares calls: what is the same for all points.
    pub fn prepare(&self, call: &mut UmatCall) {
        (call.time, call.dtime, call.kinc) = ([self.time[0]; 2], self.time[1], self.increment);
        call.jstep[2] = i32::from(self.gradients[1].is_some());
    }

    /// PROPS of the first point.
    pub fn first_props(&self) -> &'a [f64] {
        self.props.row(0)
    }
}

/// What is done with all rows.
#[derive(Clone, Copy)]
pub(crate) struct Work<'a> {
    /// What points are given.
    pub inputs: &'a Inputs<'a>,
    /// What the library says of its law.
    pub law: Option<&'a LawDescription>,
    /// Whether a point that is given what no increment is right for is refused, and not an error.
    pub may_refuse: bool,
    /// Prepares calls with some PROPS.
    pub make: &'a (dyn Fn(&[f64]) -> Result<UmatCall, LoadError> + Sync),
}

/// Splits off the values of `rest` rows of `count`.
fn halves(values: &mut [f64], count: usize, rest: usize) -> [&mut [f64]; 2] {
    let row = values.len() / count.max(1);
    values.split_at_mut((count - rest) * row).into()
}

impl Rows<'_> {
    /// Splits off the rows from `count` on.
    pub fn split(self, count: usize) -> [Self; 2] {
        let rest = self.count - count;
        let half = |values| halves(values, self.count, rest);
        let [stress, rest_stress] = half(self.stress);
        let [state, rest_state] = half(self.state);
        let (tangent, rest_tangent) = self.tangent.map(|values| half(values).into()).unzip();
        let (energies, rest_energies) = self.energies.map(|values| half(values).into()).unzip();
        let (heat, rest_heat) = self.heat.map(|values| half(values).into()).unzip();
        let behind = Self {
            first: self.first + count,
            count: rest,
            stress: rest_stress,
            state: rest_state,
            tangent: rest_tangent,
            energies: rest_energies,
            heat: rest_heat,
        };
        [Self { first: self.first, count, stress, state, tangent, energies, heat }, behind]
    }

    /// Calls the law for each row.
    ///
    /// # Errors
    /// The library has no such entry point; a point's parameters are not admitted with its length.
    pub fn update(mut self, work: &Work<'_>) -> PyResult<Vec<Refused>> {
        let Work { inputs, law, may_refuse, make } = *work;
        let count = self.count.max(1);
        let (components, nstatv) = (self.stress.len() / count, self.state.len() / count);
        let request = if self.tangent.is_some() { Request::StressAndTangent } else { Request::Stress };
        let mut refused = Vec::new();
        let mut prepared: Option<(UmatCall, &[f64])> = None;
        for k in 0..self.count {
            let at = self.first + k;
            let props = inputs.props.row(at);
            let call = match &mut prepared {
                Some((call, of_call)) if inputs.props.is_one || *of_call == props => call,
                other => {
                    let mut call = make(props).map_err(|error| Exception::Plugin.with(error.to_string()))?;
                    if self.heat.is_some() {
                        call.generate_heat();
                    }
                    &mut other.insert((call, props)).0
                }
            };
            inputs.set(call, at);
            let row = k * components..(k + 1) * components;
            let states = k * nstatv..(k + 1) * nstatv;
            let mut energies = [0.0; 3];
            if let Some(all) = &self.energies {
                energies.copy_from_slice(&all[3 * k..3 * k + 3]);
            }
            let start = [inputs.strain.row(at), inputs.dstrain.row(at), &self.stress[row.clone()]];
            let has_numbers = !may_refuse
                || inputs.all().all(|given| given.row(at).iter().all(|value| value.is_finite()))
                    && [start[2], &self.state[states.clone()], &energies]
                        .iter()
                        .copied()
                        .flatten()
                        .all(|value| value.is_finite());
            if !has_numbers {
                refused.push((at, "what it is given is not finite".to_owned(), None));
                continue;
            }
            call.set_point(start, &self.state[states.clone()], energies);
            let outcome = call.call(request).and_then(|outcome| call.add_generated_heat().map(|()| outcome));
            let moduli = || request.wants_tangent().then(|| call.moduli_not_finite()).flatten();
            if let Err(failure) = judge(outcome, call.not_finite().or_else(moduli).or_else(|| call.heat_not_finite())) {
                let length = inputs.length.map(|length| length.row(at)[0]);
                let verdict = law.map(|law| law.validate(props, length));
                if let (Some(Validation::Invalid(message)), false) = (verdict, may_refuse) {
                    return Err(wrong(format!("length[{at}]"), message));
                }
                refused.push((at, failure.to_string(), failure.fraction(0.25)));
                continue;
            }
            self.stress[row].copy_from_slice(call.stress());
            self.state[states].copy_from_slice(call.statev());
            if let Some(energies) = &mut self.energies {
                energies[3 * k..3 * k + 3].copy_from_slice(&call.energies);
            }
            if let Some(heat) = &mut self.heat {
                let Heat { rpl, ddsddt, drplde, drpldt } = call.heat();
                let values = [&[rpl, drpldt], &ddsddt[..components], &drplde[..components]].concat();
                heat[k * values.len()..(k + 1) * values.len()].copy_from_slice(&values);
            }
            if let Some(tangent) = &mut self.tangent {
                let size = components * components;
                let rows = tangent[k * size..(k + 1) * size].chunks_exact_mut(components);
                for (i, row) in rows.enumerate() {
                    row.iter_mut().enumerate().for_each(|(j, value)| *value = call.tangent(i, j));
                }
            }
        }
        Ok(refused)
    }
}
