//! The replay case: the state before a failed increment, and the increment, as a case file.
//!
//! The first call of a replay case is to the bit that of the first attempt from the state before. Only where an increment at
//! finite strain is given stresses the strain of that call is another, as it begins without the tangent of the increment
//! before. (A call that ended the process is repeated as it was.)

use super::{interface, point};
use crate::program::{
    Control, FieldValues, InterfaceEntry, NormalControl, PointKind, Program, STRAIN_NAMES, STRESS_NAMES, job_folder,
};
use crate::replay::{self, named, rows};
use serde_json::{Map, Value, json};
use umat_abi::host::{self, UmatCall};

/// The case with one step from another state; plugin and files by absolute path. Arguments of the case's first call, which are not
/// those of this one, are left out.
fn frame(program: &Program, [initial, step]: [Value; 2], [start, end]: [&FieldValues; 2]) -> Value {
    let mut case = program.document.as_object().cloned().unwrap_or_default();
    // of the output only what it shows of the call
    let heat = program.document["output"]["heat"].as_bool();
    for key in ["until", "compare", "output", "temperature", "predef", "increments"] {
        case.remove(key);
    }
    case.extend(heat.map(|heat| ("output".to_owned(), json!({ "heat": heat }))));
    let mut case = Value::Object(case);
    let folder = job_folder(&program.about.case_file, &program.document);
    replay::entitle(&mut case, replay::OF_INCREMENT, &program.about.title, &folder);
    if let Some(material) = case.get_mut("material").and_then(Value::as_object_mut) {
        // a plugin found by name is found again; a path is relative to the case file, which moves
        if material.get("plugin").and_then(Value::as_str).is_some_and(host::names_a_file) {
            material.insert("plugin".into(), replay::library(program.plugin.library.path()));
        }
        material.remove("statev0");
        let expansion = program.plugin.frame.as_ref().and_then(|frame| frame.expansion.as_ref());
        if let (Some(given), Some(expansion)) = (material.get_mut("expansion"), expansion) {
            // the run's, not the temperature that the replay begins with
            if !given.is_object() {
                *given = json!({ "alpha": given });
            }
            given["initial_temperature"] = json!(expansion.initial_temperature);
        }
    }
    case["initial"] = initial;
    case["steps"] = json!([step]);
    replay::set_fields(&mut case, start, end);
    if let Some(arguments) = case.get_mut("arguments").and_then(Value::as_object_mut) {
        for key in ["dstran", "dtime", "dtemp", "dpred", "drdisp", "dpress"] {
            arguments.remove(key);
        }
    }
    case
}

/// Replays an attempt of a material point. `first_strain_increment`: DSTRAN of its first call if stresses determine it.
pub(super) fn point(
    program: &Program,
    state: &point::Committed,
    goal: &point::PointIncrementGoal,
    call: &UmatCall,
    first_strain_increment: Option<Vec<f64>>,
) -> Value {
    let PointKind::Point(point) = &program.kind else { return Value::Null };
    let components = point.mode.stress_state().components();
    // what the program finds of plane stress it goes on from
    let strains = if call.is_through_solid() && components.len() == 3 { &[0, 1, 2, 3] } else { components };
    let mut initial = json!({
        "strain": named(&STRAIN_NAMES, strains, &state.strain),
        "stress": named(&STRESS_NAMES, components, &state.stress),
        "statev": state.statev,
        "time": state.total_time,
    });
    if point.nlgeom {
        initial["F"] = rows(state.deformation_gradient.as_slice());
    }
    let mut step = json!({ "increments": 1, "time": goal.step_time.1 - state.step_time });
    if let Some((_, end)) = &goal.deformation_gradient {
        step["F"] = rows(end.as_slice());
    } else {
        let mut target = Map::new();
        for &i in point.mode.controllable() {
            match goal.controls[i] {
                Control::Strain(value) => target.insert(STRAIN_NAMES[i].into(), json!(value)),
                Control::Stress(value) => target.insert(STRESS_NAMES[i].into(), json!(value)),
                Control::HoldStrain | Control::HoldStress | Control::Constraint(_) => None,
            };
        }
        step["target"] = target.into();
        if !goal.relations.is_empty() {
            let relations = goal.relations.iter().map(|relation| {
                let mut terms = Map::new();
                for &i in components {
                    for (names, values) in [(STRAIN_NAMES, relation.strain), (STRESS_NAMES, relation.stress)] {
                        if values[i] != 0.0 {
                            terms.insert(names[i].into(), json!(values[i]));
                        }
                    }
                }
                terms.insert("equals".into(), json!(relation.equals));
                Value::Object(terms)
            });
            step["constraints"] = relations.collect();
        }
    }
    let mut case = frame(program, [initial, step], [&state.fields, &goal.fields[1]]);
    if point.mode.stress_state().is_plane() && program.plugin.law.is_none() {
        // what probing found out at the start of the run
        case["material"]["as"] = json!(if call.is_through_solid() { "3d" } else { "plane" });
    }
    let arguments = &mut case["arguments"];
    arguments["energies"] = json!(state.energies);
    arguments["step_time"] = json!(point.arguments.start() + state.step_time);
    arguments["jstep"] = json!(call.jstep);
    arguments["kinc"] = json!(call.kinc);
    if let Some(increment) = first_strain_increment {
        arguments["dstran"] = json!(increment);
    }
    case
}

/// Replays an increment of a contact point.
pub(super) fn interface(
    program: &Program,
    state: &super::ContactPointState,
    goal: &interface::InterfaceIncrementGoal,
    fields_at_end: &FieldValues,
    counters: [i32; 3],
) -> Value {
    let PointKind::Interface(interface) = &program.kind else { return Value::Null };
    let mut initial = json!({ "statev": state.statev, "time": state.total_time, "slip": state.slip[0] });
    let mut target = json!({ "slip": goal.end[0] });
    if interface.tangential_directions == 2 {
        initial["slip2"] = json!(state.slip[1]);
        target["slip2"] = json!(goal.end[1]);
    }
    if state.gap.is_finite() {
        initial["gap"] = json!(state.gap);
    }
    let normal = match goal.normal {
        NormalControl::Gap => "gap",
        NormalControl::Pressure => "p",
    };
    target[normal] = json!(goal.end[2]);
    let step = json!({ "increments": 1, "time": goal.step_time.1 - state.step_time, "target": target });
    let mut case = frame(program, [initial, step], [&state.fields, fields_at_end]);
    let arguments = &mut case["arguments"];
    arguments["traction"] = json!([state.pressure, state.shear[0], state.shear[1]]);
    arguments["energies"] = json!(state.energies.map(|energy| if energy.is_nan() { 0.0 } else { energy }));
    match interface.entry {
        InterfaceEntry::Uinter => arguments["flags"] = json!(state.flags),
        InterfaceEntry::Fric => {
            arguments["lm"] = json!(state.flags[0]);
            arguments["slip"] = json!(state.inelastic_slip);
        }
    }
    arguments["step_time"] = json!(interface.arguments.start() + state.step_time);
    arguments["time"] = json!([interface.arguments.start() + goal.step_time.1, goal.time_of_step + goal.step_time.1]);
    [arguments["kstep"], arguments["kinc"], _] = counters.map(|counter| json!(counter));
    case
}
