//! UMATs as the laws of a specimen's parts.

use super::built;
use crate::program::{Desk, Run};
use serde_json::{Value, json};

const E: f64 = 1000.0;
const NU: f64 = 0.2;

/// A plate with a hole, pulled a little; the law of its points as given.
fn pulled(desk: &Desk, name: &str, material: Value) -> Run {
    let case = json!({
        "kind": "pullout",
        "title": "A plate",
        "mesh": { "specimen": { "type": "plate_with_hole", "cells": 4, "element": "Q4" } },
        "parts": { "plate": { "material": material } },
        "grip": { "nodes": "top", "direction": [0, 1], "lateral": "free" },
        "steps": [ { "slip": 0.01, "increments": 3 } ],
        "output": { "plots": false, "vtu": 3 },
    });
    super::run(desk, name, &case)
}

/// Checks that the loads of two runs agree up to rounding.
fn same_load(a: &Run, b: &Run, factor: f64) {
    let (a, b) = (a.history.last("load"), factor * b.history.last("load"));
    assert!(b.abs() > 1e-3 && (a - b).abs() <= 1e-10 * b.abs(), "{a} instead of {b}");
}

fn elastic(desk: &Desk) -> Run {
    pulled(desk, "elastic", json!({ "plugin": "linear_elastic", "props": { "E": E, "nu": NU } }))
}

#[test]
fn a_part_has_the_initial_states_of_sdvini_or_of_the_case() {
    let desk = Desk::new();
    let Some(library) = built(&desk, "state_modulus.f", &[]) else { return };
    let mut material = json!({ "plugin": library, "props": [E, NU], "nstatv": 1 });
    same_load(&pulled(&desk, "sdvini", material.clone()), &elastic(&desk), 2.0);
    material["statev0"] = json!([2.5]);
    same_load(&pulled(&desk, "states", material), &elastic(&desk), 2.5);
}

#[test]
fn a_part_has_what_uexternaldb_sets_up() {
    let desk = Desk::new();
    let Some(library) = built(&desk, "database.f", &[]) else { return };
    let run = pulled(&desk, "database", json!({ "plugin": library, "props": [NU], "nstatv": 4 }));
    // E = 1000 comes from UEXTERNALDB
    same_load(&run, &elastic(&desk), 1.0);
    // that of the run: what the law printed while the case was read belongs to no run
    let log = run.log();
    let closed = log.lines().filter(|line| line.contains("DATABASE CLOSED")).collect::<Vec<_>>();
    assert!(closed.last().is_some_and(|line| line.split_whitespace().skip(3).eq(["3.0", "1", "3"])), "{closed:?}");
}
