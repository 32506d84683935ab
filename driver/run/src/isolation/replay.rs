//! The replay case of a recorded call: one increment with the arguments of that call.

use super::need::{CALL_TIME_LIMIT, Need};
use super::trust;
use crate::program::{FieldValues, STRAIN_NAMES, STRESS_NAMES};
use crate::replay::{self, named, rows};
use serde_json::{Value, json};
use umat_abi::host::recorder::{CallRecord, FricRecord, RecordedArguments, UinterRecord, UmatRecord};
use umat_abi::law::StressState;

/// Returns a case that makes this call of a process that ended, and no other before it. `None`: an argument is not a
/// number, which JSON cannot express, or the call is of a routine other than the entry points, which every run calls.
pub(super) fn of(call: &CallRecord, need: &Need) -> Option<Value> {
    let mut case = of_call(call)?;
    let material = &mut case["material"];
    if trust::may_run_here(&call.library) {
        // it was isolated because the case said so
        material["isolate"] = json!(true);
    }
    let limit = need.time_limit(&call.library);
    if limit != CALL_TIME_LIMIT {
        material["call_time_limit_s"] = json!(limit);
    }
    (!has_null(&case)).then_some(case)
}

/// Returns a case that makes this call, and no other before it, without its title; `None` for routines other than the
/// entry points.
pub(crate) fn of_call(call: &CallRecord) -> Option<Value> {
    let (mut case, props, statev, entry) = match &call.arguments {
        RecordedArguments::Umat(umat) => (point(umat, call.wants_tangent), &umat.props, &umat.statev, "umat"),
        RecordedArguments::Uinter(uinter) => (uinter_case(uinter), &uinter.props, &uinter.statev, "uinter"),
        RecordedArguments::Fric(fric) => (fric_case(fric), &fric.props, &fric.statev, "fric"),
        _ => return None,
    };
    case["title"] = json!("");
    case["material"] = json!({
        "plugin": replay::library(&call.library),
        "cmname": call.cmname,
        "entry": entry,
        "props": props,
        "nstatv": statev.len(),
    });
    if let Some(symbol) = &call.symbol {
        case["material"]["symbol"] = json!(symbol);
    }
    Some(case)
}

/// Returns whether a number is missing: NaN and infinity become null.
fn has_null(value: &Value) -> bool {
    match value {
        Value::Null => true,
        Value::Array(values) => values.iter().any(has_null),
        Value::Object(entries) => entries.values().any(has_null),
        Value::Bool(_) | Value::Number(_) | Value::String(_) => false,
    }
}

/// Entry `k`; a record that a plugin has destroyed may have fewer.
fn at(values: &[f64], k: usize) -> f64 {
    values.get(k).copied().unwrap_or_default()
}

fn array<const N: usize>(values: &[f64]) -> [f64; N] {
    std::array::from_fn(|k| at(values, k))
}

/// The first values of an input, as many as the call has components.
fn first<'a, const N: usize>(input: &'a [f64; N], components: &[f64]) -> &'a [f64] {
    &input[..components.len().min(N)]
}

/// A duration of a step, s, which takes some time; equilibrium before the first step takes none.
fn duration(time_increment: f64) -> f64 {
    if time_increment > 0.0 { time_increment } else { 1.0 }
}

/// Returns the arguments that the path of a case of kind "point" leaves open, and the increments, which its ends give
/// only up to rounding.
fn umat_arguments(call: &UmatRecord, wants_tangent: bool) -> Value {
    let mut arguments = json!({
        "dstran": first(&call.dstran, &call.stress),
        "dtime": call.dtime,
        "dtemp": call.dtemp,
        "energies": array::<3>(&call.energies),
        "step_time": call.time[0],
        "coords": call.coords,
        "drot": rows(call.drot.as_flattened()),
        "dfgrd0": rows(call.dfgrd0.as_flattened()),
        "dfgrd1": rows(call.dfgrd1.as_flattened()),
        "noel": call.noel,
        "npt": call.npt,
        "jstep": call.jstep,
        "kinc": call.kinc,
        "ddsdde": wants_tangent,
    });
    if !is_no_variable([&call.predef, &call.dpred]) {
        arguments["dpred"] = json!(call.dpred);
    }
    arguments
}

fn point(call: &UmatRecord, wants_tangent: bool) -> Value {
    let stress_state = match call.stress.len() {
        6 => StressState::ThreeD,
        3 => StressState::PlaneStress,
        2 => StressState::Beam,
        1 => StressState::OneD,
        _ => StressState::PlaneStrainOrAxisymmetric,
    };
    let components = stress_state.components();
    let (stran, dstran) = (&call.stran, &call.dstran);
    let has_strain_33 = stran[2] != 0.0 || dstran[2] != 0.0;
    // the components whose strains are targets; the others are 0, or the law's business
    let (mode, driven): (_, &[usize]) = match stress_state {
        StressState::ThreeD => ("3d", &[0, 1, 2, 3, 4, 5]),
        StressState::PlaneStress => ("plane_stress", &[0, 1, 3]),
        StressState::OneD => ("1d", components),
        StressState::Beam => ("beam", components),
        // as in axial symmetry, or in plane strain where an element's dilatation is averaged: the mode has the NTENS and NDI of both
        StressState::PlaneStrainOrAxisymmetric if has_strain_33 => ("axisymmetric", &[0, 1, 2, 3]),
        StressState::PlaneStrainOrAxisymmetric => ("plane_strain", &[0, 1, 3]),
    };
    let six = |value: &dyn Fn(usize) -> f64| {
        let mut six = [0.0; 6];
        components.iter().enumerate().for_each(|(k, &component)| six[component] = value(k));
        six
    };
    let step = json!({
        "increments": 1,
        "time": duration(call.dtime),
        "target": named(&STRAIN_NAMES, driven, &six(&|k| stran[k] + dstran[k])),
    });
    let mut case = json!({
        "kind": "point",
        "mode": mode,
        "initial": {
            "strain": named(&STRAIN_NAMES, components, &six(&|k| stran[k])),
            "stress": named(&STRESS_NAMES, components, &six(&|k| at(&call.stress, k))),
            "statev": call.statev,
            "time": call.time[1].max(0.0),
        },
        "arguments": umat_arguments(call, wants_tangent),
    });
    set_length(&mut case, call.celent);
    case["steps"] = json!([step]);
    set_fields(&mut case, [call.temp, call.temp + call.dtemp], {
        let ends = call.predef.iter().zip(&call.dpred).map(|(start, increment)| start + increment);
        [call.predef.clone(), ends.collect()]
    });
    case
}

/// Returns whether these are the host's one variable of 0, that of a case without any.
fn is_no_variable(variables: [&[f64]; 2]) -> bool {
    variables == [[0.0], [0.0]]
}

/// Sets temperature and field variables at both ends.
fn set_fields(case: &mut Value, temperature: [f64; 2], mut variables: [Vec<f64>; 2]) {
    if is_no_variable([&variables[0], &variables[1]]) {
        variables = [Vec::new(), Vec::new()];
    }
    let ([start, end], [first, last]) = (temperature, variables);
    let start = FieldValues { temperature: start, variables: first };
    replay::set_fields(case, &start, &FieldValues { temperature: end, variables: last });
}

fn set_length(case: &mut Value, length: f64) {
    if length > 0.0 {
        case["characteristic_length"] = json!(length);
    }
}

/// A case of kind "interface". TIME is that of the increment's end, a case's of its start.
fn interface(time: [f64; 2], dtime: f64, statev: &[f64], mut arguments: Value, [step, increment]: [i32; 2]) -> Value {
    let start = time.map(|end| end - dtime);
    for (name, value) in [("time", json!(time)), ("dtime", json!(dtime)), ("step_time", json!(start[0]))] {
        arguments[name] = value;
    }
    [arguments["kstep"], arguments["kinc"]] = [step, increment].map(|number| json!(number));
    json!({
        "kind": "interface",
        "initial": { "statev": statev, "time": start[1].max(0.0) },
        "arguments": arguments,
        "steps": [{ "increments": 1, "time": duration(dtime), "target": {} }],
    })
}

/// Sets temperature and field variables from the ends and the increments of a call, the same at both surfaces.
fn set_contact_fields(case: &mut Value, temp: &[f64], predef: &[f64], dpred: &[f64]) {
    let [end, increment] = array(temp);
    let ends = || predef.iter().copied().step_by(2);
    let starts = ends().zip(dpred.iter().step_by(2)).map(|(end, increment)| end - increment);
    set_fields(case, [end - increment, end], [starts.collect(), ends().collect()]);
    let arguments = &mut case["arguments"];
    arguments["dtemp"] = json!(increment);
    let ends: Vec<f64> = ends().collect();
    let increments: Vec<f64> = dpred.iter().copied().step_by(2).collect();
    if !is_no_variable([&ends, &increments]) {
        arguments["dpred"] = json!(increments);
    }
}

/// Sets the slips at both ends.
fn set_slips(case: &mut Value, ends: &[[f64; 2]]) {
    for (name, [start, end]) in ["slip", "slip2"].into_iter().zip(ends) {
        case["initial"][name] = json!(start);
        case["steps"][0]["target"][name] = json!(end);
    }
}

fn uinter_case(call: &UinterRecord) -> Value {
    let [step, increment, iteration] = call.counters;
    let increments = first(&call.drdisp, &call.stress);
    let arguments = json!({
        "traction": array::<3>(&call.stress),
        "energies": array::<5>(&call.energies),
        "flags": array::<2>(&call.flags).map(|flag| flag as i32),
        "coords": call.coords,
        "alocaldir": call.local_directions,
        "area": call.area,
        "node": call.node,
        "kit": iteration,
        "drdisp": array::<3>(increments),
    });
    let mut case = interface(call.time, call.dtime, &call.statev, arguments, [step, increment]);
    let ends: Vec<[f64; 2]> = call.rdisp.iter().zip(increments).map(|(end, by)| [end - by, *end]).collect();
    let [normal, slips @ ..] = ends.as_slice() else { return case };
    // RDISP(1) > 0 is penetration
    [case["initial"]["gap"], case["steps"][0]["target"]["gap"]] = normal.map(|penetration| json!(-penetration));
    set_slips(&mut case, slips);
    set_contact_fields(&mut case, &call.temp, &call.predef, &call.dpred);
    set_length(&mut case, call.chrlngth);
    case
}

fn fric_case(call: &FricRecord) -> Value {
    let [pressure, increment] = call.pressure;
    let arguments = json!({
        "traction": [pressure - increment, at(&call.tau, 0), at(&call.tau, 1)],
        "energies": [at(&call.energies, 0), at(&call.energies, 1), 0.0, 0.0, 0.0],
        "lm": at(&call.lm, 0) as i32,
        "dpress": increment,
        "slip": array::<2>(first(&call.slip, &call.tau)),
        "coords": call.coords,
        "rcoord": call.rcoord,
        "node": call.node,
    });
    let mut case = interface(call.time, call.dtime, &call.statev, arguments, call.counters);
    // only the increment of the slip is an argument
    let slips: Vec<[f64; 2]> = first(&call.dgam, &call.tau).iter().map(|by| [0.0, *by]).collect();
    set_slips(&mut case, &slips);
    case["steps"][0]["target"]["p"] = json!(pressure);
    set_contact_fields(&mut case, &call.temp, &call.predef, &call.dpred);
    set_length(&mut case, call.chrlngth);
    case
}
