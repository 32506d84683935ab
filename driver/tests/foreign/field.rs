//! Phase-field UMATs of others in a specimen with a field: an element of closed form, and the loads of our own law.

use super::{built, run};
use crate::program::{Desk, Run};
use serde_json::{Value, json};

const YOUNG: f64 = 30e3;
const POISSON: f64 = 0.2;

/// Length of the strip, mm: so short that its load does not fall with the slip.
const LENGTH: f64 = 10.0;

/// A strip that is pulled between sides that do not come nearer: only e11 is not 0.
fn strip(material: Value, fixed: Value, slip: f64) -> Value {
    json!({
        "kind": "pullout",
        "mesh": { "specimen": { "type": "beam", "length": LENGTH, "height": 1, "cells": [10, 1], "element": "Q8" } },
        "parts": { "beam": { "model": "plane_strain", "thickness": 1, "material": material } },
        "field": { "kind": "phase_field", "fixed": fixed },
        "grip": { "nodes": "right", "direction": "x" },
        "supports": { "left": {}, "bottom": { "direction": "y" }, "top": { "direction": "y" } },
        "steps": [{ "slip": slip, "increments": 40 }],
        "output": { "vtu": false, "plots": false },
    })
}

/// AT2 in a uniform bar: d = 2 l H/(G_c + 2 l H) with H = ½ (λ + 2μ) ε², σ = ((1 − d)² + 1e-6)(λ + 2μ) ε.
#[test]
fn a_uniform_bar_of_a_foreign_phase_field_is_that_of_the_closed_form() {
    let desk = Desk::new();
    let Some(library) = built(&desk, "phase_field.f90", &[]) else { return };
    let (toughness, length) = (0.1, 2.0);
    let material = json!({ "plugin": library, "props": [YOUNG, POISSON, toughness, length], "nstatv": 1 });
    let mut case = strip(material, json!([]), 0.0125);
    case["field"]["tolerance"] = json!(1e-8);
    let run = run(&desk, "uniform", &case);
    let modulus = YOUNG * (1.0 - POISSON) / ((1.0 + POISSON) * (1.0 - 2.0 * POISSON));
    let [slip, load] = ["slip", "load"].map(|name| run.history.column(name));
    for (slip, load) in slip.iter().zip(load) {
        let strain = slip / LENGTH;
        let energy = 0.5 * modulus * strain * strain;
        let d = 2.0 * length * energy / (toughness + 2.0 * length * energy);
        let expected = ((1.0 - d).powi(2) + 1e-6) * modulus * strain;
        assert!((load - expected).abs() <= 1e-6 * expected.max(1.0), "{slip}: {load} for {expected}");
    }
}

/// Tension alone, one direction open: the split of our law takes all of the stress, as this UMAT does.
#[test]
fn a_foreign_cohesive_phase_field_has_the_loads_of_our_law() {
    let desk = Desk::new();
    let Some(library) = built(&desk, "cohesive_phase_field.f90", &[]) else { return };
    let [strength, energy, length, p, a_2, a_3] = [3.0, 0.09, 4.0, 2.0, -0.5, 0.0];
    let foreign = json!({
        "plugin": library, "props": [YOUNG, POISSON, strength, energy, length, p, a_2, a_3], "nstatv": 1
    });
    let own = json!({ "plugin": "concrete_phase_field", "props": {
        "E": YOUNG, "nu": POISSON, "f_t": strength, "G_f": energy, "l": length, "p": p, "a_2": a_2, "a_3": a_3
    } });
    // sound ends: the crack is in the middle
    let fixed = json!([{ "nodes": "left", "value": 0 }, { "nodes": "right", "value": 0 }]);
    let [foreign, own]: [Run; 2] = [("foreign", foreign), ("own", own)]
        .map(|(name, material)| run(&desk, name, &strip(material, fixed.clone(), 0.04)));
    let [theirs, ours] = [&foreign, &own].map(|run| run.history.column("load"));
    let peak = own.peak("load", "max");
    assert_eq!(theirs.len(), ours.len());
    assert!(ours.last().is_some_and(|last| *last < 0.8 * peak) && own.history.last("field_max") > 0.3, "it cracks");
    for (theirs, ours) in theirs.iter().zip(&ours) {
        assert!((theirs - ours).abs() <= 1e-6 * peak, "{theirs} {ours}");
    }
}

/// Small lengths: the stress falls by a₁ = 2500 times d, also where a law does not name its parameters. (Where the change of the field
/// alone decided, no pass changed 3e-4, and the load was twice the strength.)
#[test]
fn a_bar_with_a_small_length_bears_its_strength() {
    let desk = Desk::new();
    let [strength, energy, length, p, a_2, a_3] = [3.0, 0.09, 0.15, 2.0, -0.5, 0.0];
    let own = json!({ "plugin": "concrete_phase_field", "props": {
        "E": YOUNG, "nu": 0.0, "f_t": strength, "G_f": energy, "l": length, "p": p, "a_2": a_2, "a_3": a_3
    } });
    let foreign = built(&desk, "cohesive_phase_field.f90", &[]).map(|library| {
        json!({ "plugin": library, "props": [YOUNG, 0.0, strength, energy, length, p, a_2, a_3], "nstatv": 1 })
    });
    for (name, material) in [("own", Some(own)), ("foreign", foreign)] {
        let Some(material) = material else { continue };
        let case = json!({
            "kind": "pullout",
            "mesh": { "specimen": { "type": "beam", "length": 0.6, "height": 0.1, "cells": [12, 1], "element": "Q8" } },
            "parts": { "beam": { "model": "plane_strain", "thickness": 1, "material": material } },
            "field": { "kind": "phase_field" },
            "grip": { "nodes": "right", "direction": "x" },
            "supports": { "left": { "direction": "x" }, "bottom": { "direction": "y" } },
            "steps": [{ "slip": 1.2e-4, "increments": 20 }],
            "output": { "vtu": false, "plots": false },
        });
        let peak = run(&desk, name, &case).peak("load", "max");
        assert!((0.3 * 0.999..0.3 * 1.001).contains(&peak), "{name}: {peak}");
    }
}

/// At the onset a pass leaves some 0.97 of the error of a long wave: what follows is summed up. (One by one they went beyond the limit
/// of an increment, and 475 increments were taken.)
#[test]
fn a_bar_at_the_onset_of_its_crack_settles_to_many_digits() {
    let desk = Desk::new();
    let case = |tolerance: f64| {
        json!({
            "kind": "pullout",
            "mesh": { "specimen": { "type": "beam", "length": 6, "height": 1, "cells": [6, 1], "element": "Q8" } },
            "parts": { "beam": { "model": "plane_stress", "thickness": 1, "material": {
                "plugin": "concrete_phase_field",
                "props": { "E": YOUNG, "nu": POISSON, "f_t": 3.0, "G_f": 0.09, "l": 4.0, "p": 2.0, "a_2": -0.5, "a_3": 0.0 }
            } } },
            "field": { "kind": "phase_field", "tolerance": tolerance },
            "grip": { "nodes": "right", "direction": "x" },
            "supports": { "left": { "direction": "x" }, "bottom": { "direction": "y" } },
            "steps": [{ "slip": 1.08e-3, "increments": 20 }],
            "output": { "vtu": false, "plots": false },
        })
    };
    let [rough, fine] = [1e-8, 1e-10].map(|tolerance| {
        let history = run(&desk, "onset", &case(tolerance)).history;
        assert_eq!(history.column("load").len(), 21, "{tolerance:e}");
        history.last("load")
    });
    assert!((rough - fine).abs() <= 1e-9 * fine, "{rough} {fine}");
}
