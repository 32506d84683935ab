//! Displacements and field in one system, `"coupling": "full"`: implicit gradient damage, which converges quadratically, and heat of
//! plastic work, against the same in turn.

use super::{built_of, run};
use crate::program::{Desk, Run, cases};
use serde_json::{Value, json};

/// ε at which damage begins.
const ONSET: f64 = 1e-4;

/// Half of a bar of 60 mm, 5 % weaker next to its middle, that is pulled in steps of 0.002 mm while damage localises there.
fn bar(library: &Value, coupling: &str, increments: u32) -> Value {
    let material = |onset: f64| json!({ "plugin": library, "props": [30e3, 0.2, onset, 0.96, 100.0], "nstatv": 2 });
    let part = |onset: f64| json!({ "model": "plane_strain", "thickness": 1, "material": material(onset) });
    json!({
        "kind": "pullout",
        "mesh": { "file": cases().join("verification/snap-back-bar.msh") },
        "parts": { "bar": part(ONSET), "weak": part(0.95 * ONSET) },
        "field": { "kind": "temperature", "coupling": coupling, "umatht": { "props": [12.5] } },
        "grip": { "nodes": "end", "direction": [-1, 0], "lateral": "free" },
        "supports": { "middle": { "direction": "x" }, "base": { "direction": "y" } },
        "steps": [{ "slip": 0.002 * f64::from(increments), "increments": increments }],
        "controls": { "force_tolerance": 1e-9 },
        "output": { "vtu": false, "plots": false },
    })
}

/// The iterations of each increment of the bar, with tolerances of forces and field as parts of their largest.
fn iterations(desk: &Desk, library: &Value, tolerance: f64) -> Vec<f64> {
    let mut case = bar(library, "full", 25);
    case["field"]["tolerance"] = json!(tolerance);
    case["controls"]["force_tolerance"] = json!(tolerance);
    run(desk, &format!("to-{tolerance:e}"), &case).history.column("iterations")
}

/// From a residual of 1e-5 one iteration leads to 1e-10: it squares what is left, where damage grows and localises as well.
#[test]
fn gradient_damage_converges_quadratically() {
    let desk = Desk::new();
    let Some(library) = built_of(&desk, &["gradient_damage.f90"], &[]) else { return };
    let [rough, fine] = [1e-5, 1e-10].map(|tolerance| iterations(&desk, &library, tolerance));
    println!("{rough:?}\n{fine:?}");
    assert!(rough.len() == 26 && fine.len() == 26);
    for (rough, fine) in rough.iter().zip(&fine) {
        assert!(*fine <= rough + 1.0 && *fine <= 6.0, "{rough} {fine}");
    }
}

/// Past the peak, where damage localises, both ways lead to the same state.
#[test]
fn gradient_damage_ends_where_the_staggered_one_does() {
    let desk = Desk::new();
    let Some(library) = built_of(&desk, &["gradient_damage.f90"], &[]) else { return };
    let [together, in_turn] = ["full", "staggered"].map(|coupling| run(&desk, coupling, &bar(&library, coupling, 6)));
    let load = in_turn.history.column("load");
    assert!(load[6] < load[4] && in_turn.history.last("field_max") > 2.0 * ONSET, "{load:?}");
    let [few, many] = [&together, &in_turn].map(|run| run.history.column("iterations").iter().sum::<f64>());
    assert!(10.0 * few < many, "{few} and {many} iterations");
    assert_same(&together, &in_turn, 1e-6);
}

/// A bar that yields, heats itself by its plastic work, softens with it, and conducts the heat to its cold end: the same loads and
/// temperatures together and in turn.
#[test]
fn a_bar_that_heats_itself_is_the_same_together_and_in_turn() {
    let desk = Desk::new();
    let Some(library) = built_of(&desk, &["heated.f90"], &[]) else { return };
    let case = |coupling: &str| {
        let props = json!([200e3, 0.3, 1.2e-5, 250.0, 1e-3, 2e3, 0.9, 20.0, 0]);
        json!({
            "kind": "pullout",
            "mesh": { "specimen": { "type": "beam", "length": 20, "height": 4, "cells": [10, 2], "element": "Q8" } },
            "parts": { "beam": { "model": "plane_strain", "thickness": 1,
                                 "material": { "plugin": library, "props": props, "nstatv": 7 } } },
            "field": { "kind": "temperature", "coupling": coupling, "initial": 20, "conductivity": 2.0, "capacity": 0.6,
                       "fixed": [{ "nodes": "left", "value": 20 }] },
            "grip": { "nodes": "right", "direction": "x" },
            "supports": { "left": {} },
            "steps": [{ "slip": 0.1, "increments": 1, "time": 2.0 }],
            "output": { "vtu": false, "plots": false },
        })
    };
    let [together, in_turn] = ["full", "staggered"].map(|coupling| run(&desk, coupling, &case(coupling)));
    // hot enough to matter: in turn, larger slips need increments 60 times as small
    assert!(in_turn.history.last("field_max") > 21.5, "{}", in_turn.history.last("field_max"));
    assert_same(&together, &in_turn, 1e-6);
    assert_eq!(together.summary["statistics"]["field_passes"], 0);
}

/// Asserts that two runs have the same loads and the same largest values of the field, as parts of their largest.
fn assert_same(one: &Run, other: &Run, tolerance: f64) {
    for name in ["load", "field_max"] {
        let [one, other] = [one, other].map(|run| run.history.column(name));
        let largest = other.iter().fold(0.0_f64, |most, value| most.max(value.abs()));
        assert_eq!(one.len(), other.len());
        let worst = one.iter().zip(&other).map(|(one, other)| (one - other).abs()).fold(0.0, f64::max) / largest;
        println!("{name}: {worst:e} of {largest}");
        assert!(worst <= tolerance, "{name}: {worst:e}");
    }
}
