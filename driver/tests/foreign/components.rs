//! Laws of one or two components, laws that follow DFGRD1 alone, and laws of six that leave their own arrays in a plane.

use super::{built, close, point, run};
use crate::program::Desk;
use serde_json::{Value, json};

/// E, G, yield stress, hardening modulus of `line.f90`.
const WIRE: [f64; 4] = [200e3, 80e3, 300.0, 2e3];

fn wire(library: &Value, mode: &str, target: Value) -> Value {
    let material = json!({ "plugin": library, "props": WIRE, "nstatv": 1 });
    point(material, mode, json!([{ "increments": 10, "target": target }]))
}

/// ε = σ/E + (σ − σ_y)/H.
fn strain_of_wire(stress: f64) -> f64 {
    stress / WIRE[0] + (stress - WIRE[2]) / WIRE[3]
}

#[test]
fn laws_of_one_and_two_components_are_called_as_they_are_meant() {
    let desk = Desk::new();
    let Some(library) = built(&desk, "line.f90", &[]) else { return };
    let stretched = run(&desk, "stretched", &wire(&library, "1d", json!({ "e11": strain_of_wire(320.0) })));
    close(stretched.history.last("s11"), 320.0);
    let pulled = run(&desk, "pulled", &wire(&library, "1d", json!({ "s11": 320.0 })));
    close(pulled.history.last("e11"), strain_of_wire(320.0));
    assert!(pulled.history.last("e22").is_nan(), "nobody knows the strain across");
    let beam = run(&desk, "beam", &wire(&library, "beam", json!({ "s11": 320.0, "s12": 40.0 })));
    close(beam.history.last("e11"), strain_of_wire(320.0));
    close(beam.history.last("g12"), 40.0 / WIRE[1]);
    for mode in ["1d", "beam"] {
        let case = desk.case("case.json", &wire(&library, mode, json!({ "e11": strain_of_wire(320.0) })));
        let file = library.as_str().expect("a path");
        let check = desk.pullout(["plugin", "check", file, "--case", case.to_str().expect("UTF-8")]).expect(0);
        let ntens = if mode == "1d" { "1d, NTENS 1" } else { "beam, NTENS 2" };
        assert!(check.stdout.contains(ntens) && !check.stdout.contains("FAIL"), "{}", check.stdout);
    }
}

/// What a law knows nothing of makes the system singular: it is left alone, and a warning says so.
#[test]
fn stresses_that_a_law_knows_nothing_of_are_left_alone() {
    let desk = Desk::new();
    let Some(library) = built(&desk, "line.f90", &[]) else { return };
    let pulled = run(&desk, "pulled", &wire(&library, "3d", json!({ "s11": 320.0 })));
    close(pulled.history.last("e11"), strain_of_wire(320.0));
    assert_eq!(pulled.history.last("e22"), 0.0);
    let warnings = pulled.summary["warnings"].to_string();
    assert!(warnings.contains("s22, s33, s12, s13, s23") && !warnings.contains("s11"), "{warnings}");
    let pressed = desk.case("pressed.json", &wire(&library, "3d", json!({ "s11": 320.0, "s22": 5.0 })));
    let pressed = desk.run(&pressed, &[], "pressed", 1);
    assert!(pressed.outcome.stderr.contains("leave s22 out"), "{}", pressed.outcome.stderr);
    let own = json!({ "plugin": "linear_elastic", "props": { "E": 1e3, "nu": 0.2 } });
    let strain = json!([{ "increments": 1, "target": { "e11": 1e-3 } }]);
    let across = json!([{ "increments": 1, "target": { "e22": 1e-3 } }]);
    let mut large = wire(&library, "1d", json!({ "e11": 1e-3 }));
    large["nlgeom"] = json!(true);
    let mut as_solid = wire(&library, "beam", json!({ "e11": 1e-3 }));
    as_solid["material"]["as"] = json!("3d");
    for (case, place) in [
        (point(own, "1d", strain), "$.mode"),
        (point(large["material"].clone(), "1d", across), "$.steps[0].target.e22"),
        (large, "$.nlgeom"),
        (as_solid, "$.material.as"),
    ] {
        let case = desk.case("wrong.json", &case);
        let refused = desk.pullout(["run".as_ref(), case.as_os_str()]).expect(2);
        assert!(refused.stderr.contains(place), "{}", refused.stderr);
    }
}

/// Without `nlgeom` a law that reads F has no stress, and would be done with that.
#[test]
fn a_law_that_follows_the_deformation_gradient_alone_is_not_run_on_small_strains() {
    let desk = Desk::new();
    let Some(library) = built(&desk, "neo_hooke.f90", &[]) else { return };
    let material = json!({ "plugin": library, "props": [1.0, 0.78], "nstatv": 0 });
    let mut case = point(material.clone(), "3d", json!([{ "increments": 4, "target": { "e11": 0.2 } }]));
    let small = desk.case("small.json", &case);
    let refused = desk.run(&small, &[], "small", 1);
    assert!(refused.outcome.stderr.contains("\"nlgeom\": true"), "{}", refused.outcome.stderr);
    let file = library.as_str().expect("a path");
    let check = desk.pullout(["plugin", "check", file, "--case", small.to_str().expect("UTF-8")]).expect(1);
    assert!(check.stdout.contains("nlgeom") && !check.stdout.contains("consistent tangent"), "{}", check.stdout);
    case["nlgeom"] = json!(true);
    // σ of a stretch of e^0.2 with free sides
    let stress = run(&desk, "large", &case).history.last("s11");
    assert!((stress / 0.40649 - 1.0).abs() < 1e-4, "{stress}");
    let specimen = json!({
        "kind": "pullout",
        "mesh": { "specimen": { "type": "plate_with_hole", "cells": 4, "element": "Q4" } },
        "parts": { "plate": { "material": material, "model": "plane_strain" } },
        "grip": { "nodes": "top", "direction": [0, 1], "lateral": "free" },
        "steps": [ { "slip": 0.03, "increments": 1 } ],
        "output": { "plots": false, "vtu": false },
    });
    let specimen = desk.case("specimen.json", &specimen);
    let refused = desk.pullout(["run".as_ref(), specimen.as_os_str()]);
    assert!(refused.code != 0 && refused.stderr.contains("\"nlgeom\": true"), "{} {}", refused.code, refused.stderr);
}

/// In a plane the law reads past the ends of its arrays as if stresses were there: a warning before the results, and a message
/// if it crashes.
#[test]
fn a_law_of_six_components_that_leaves_its_own_arrays_is_named() {
    let desk = Desk::new();
    let Some(library) = built(&desk, "own_arrays.f90", &[]) else { return };
    let steps = json!([{ "increments": 20, "target": { "g12": 0.01 } }]);
    let case = |ends: f64, called: Option<&str>| {
        let mut material =
            json!({ "plugin": library, "props": [200e3, 0.3, 300.0, 2e3, ends], "nstatv": 1, "tangent": "numerical" });
        if let Some(called) = called {
            material["as"] = json!(called);
        }
        point(material, "plane_strain", steps.clone())
    };
    let warned = run(&desk, "warned", &case(0.0, None));
    let warnings = warned.summary["warnings"].to_string();
    assert!(warnings.contains("\\\"as\\\": \\\"3d\\\""), "{warnings}");
    // τ of the linear hardening: σ_y/√3 + ...
    let shear = 200e3 / 2.6;
    let slope = shear * 2e3 / (3.0 * shear + 2e3);
    let yield_stress = 300.0 / 3.0_f64.sqrt();
    let right = run(&desk, "right", &case(0.0, Some("3d")));
    close(right.history.last("s12"), yield_stress + slope * (0.01 - yield_stress / shear));
    assert!(right.summary["warnings"].as_array().is_none_or(Vec::is_empty), "{}", right.summary["warnings"]);
    let crashed = desk.case("crashed.json", &case(1.0, Some("plane")));
    let crashed = desk.pullout(["run".as_ref(), crashed.as_os_str()]).expect(1);
    assert!(crashed.stderr.contains("\"as\": \"3d\""), "{}", crashed.stderr);
}

/// Where a soft contact carries pressure at the start, its energy is there with it: nothing jumps where nothing moves.
#[test]
fn a_soft_contact_begins_with_the_energy_of_its_pressure() {
    let desk = Desk::new();
    let mut case = crate::program::json(&end_to_end_tests::workspace("cases/chapter-6/6.9-soft-contact.json"));
    case["steps"] = json!([{ "increments": 1, "target": { "gap": "hold" } }]);
    case["output"] = json!({ "plots": false });
    for key in ["compare", "until"] {
        case.as_object_mut().expect("a case").remove(key);
    }
    let history = run(&desk, "soft", &case).history;
    let [pressure, energy] = [history.column("p"), history.column("sed")];
    close(pressure[0], pressure[1]);
    assert!(pressure[0] > 0.0 && energy[0] > 0.0, "{pressure:?} {energy:?}");
    close(energy[0], energy[1]);
}
