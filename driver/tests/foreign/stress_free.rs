//! The temperature without thermal strain: that of the start, of a field where there is one.

use super::run;
use crate::program::{Desk, Run, goes_on_from_a_checkpoint};
use serde_json::{Value, json};
use std::f64::consts::PI;

const E: f64 = 30e3;
const ALPHA: f64 = 1e-5;
const START: f64 = 20.0;
const INNER: f64 = 10.0;
const OUTER: f64 = 30.0;
const CONDUCTIVITY: f64 = 0.05;
const FLUX: f64 = 0.1;

/// A thick cylinder between plates that do not yield, through which heat flows from its bore.
fn cylinder(expansion: Value) -> Value {
    json!({
        "kind": "pullout", "title": "Heated from its bore",
        "mesh": { "specimen": {
            "type": "thick_cylinder", "axisymmetric": true, "inner_radius": INNER, "outer_radius": OUTER, "height": 5,
            "radial_cells": 20, "other_cells": 2,
        } },
        "parts": { "cylinder": { "material": {
            "plugin": "linear_elastic", "props": { "E": E, "nu": 0.2 }, "expansion": expansion,
        } } },
        "supports": { "bottom": { "direction": "y" }, "top": { "direction": "y" } },
        "field": {
            "kind": "temperature", "initial": START, "conductivity": CONDUCTIVITY,
            "fixed": [{ "nodes": "outer", "value": START }], "fluxes": [{ "edges": "inner", "flux": FLUX }],
        },
        "measure": { "load": "top", "exit": [INNER, 0], "direction": "y" },
        "steps": [{ "increments": 2 }],
        "output": { "plots": false, "vtu": false },
    })
}

/// −2π E α ∫ θ r dr: the axial force of a cylinder that is held along its axis, with θ = (q a/k) ln(b/r) above the start.
fn heated() -> f64 {
    let ratio = OUTER / INNER;
    let integral = 0.25 * (OUTER * OUTER - INNER * INNER) - 0.5 * INNER * INNER * ratio.ln();
    -2.0 * PI * E * ALPHA * FLUX * INNER / CONDUCTIVITY * integral
}

/// The axial force of a uniform change of the temperature.
fn warmed(by: f64) -> f64 {
    -PI * (OUTER * OUTER - INNER * INNER) * E * ALPHA * by
}

/// Asserts the axial force at the start and at the end.
#[track_caller]
fn assert_forces(run: &Run, start: f64, end: f64) {
    let load = run.history.column("load");
    let last = run.history.last("load");
    assert!((load[0] - start).abs() < 1e-9 * E && (last / end - 1.0).abs() < 1e-4, "{load:?}, not {start} to {end}");
}

/// Warnings that contain a text.
fn warnings(run: &Run, text: &str) -> usize {
    let all = run.summary["warnings"].as_array().expect("a list").iter();
    all.filter(|warning| warning.as_str().is_some_and(|warning| warning.contains(text))).count()
}

#[test]
fn a_body_with_a_temperature_field_is_free_of_stress_at_the_initial_value_of_the_field() {
    let desk = Desk::new();
    for coupling in ["staggered", "full"] {
        let mut case = cylinder(json!(ALPHA));
        case["field"]["coupling"] = json!(coupling);
        let run = run(&desk, coupling, &case);
        assert_forces(&run, 0.0, heated());
        assert_eq!(warnings(&run, ""), 0, "{}", run.summary["warnings"]);
    }
    // the temperature of the case is that of parts without the field, of which there are none
    let mut case = cylinder(json!(ALPHA));
    case["temperature"] = json!(-50.0);
    let with_another = run(&desk, "another", &case);
    assert_forces(&with_another, 0.0, heated());
    assert_eq!(warnings(&with_another, "$.temperature: has no effect"), 1, "{}", with_another.summary["warnings"]);
    goes_on_from_a_checkpoint(&desk, &desk.case("kept.json", &cylinder(json!(ALPHA))), "1");
}

#[test]
fn a_given_temperature_without_thermal_strain_counts_and_is_warned_of_where_it_stresses_the_start() {
    let desk = Desk::new();
    let with = |name: &str, temperature: f64| {
        run(&desk, name, &cylinder(json!({ "alpha": ALPHA, "initial_temperature": temperature })))
    };
    let same = with("same", START);
    assert_forces(&same, 0.0, heated());
    assert_eq!(warnings(&same, ""), 0, "{}", same.summary["warnings"]);
    let cold = with("cold", 0.0);
    assert_forces(&cold, warmed(START), warmed(START) + heated());
    assert_eq!(warnings(&cold, "changes the initial stress"), 1, "{}", cold.summary["warnings"]);
}
