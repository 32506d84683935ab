//! Omissions and errors of public UMATs, against our own law on the same mesh: no energies, wrong energies, an elastic
//! tangent or none, six components only.

use super::{built, point};
use crate::program::{Desk, Run};
use end_to_end_tests::worst;
use serde_json::{Value, json};

/// E, nu, yield stress, hardening modulus.
const STEEL: [f64; 4] = [210e3, 0.3, 347.0, 2100.0];
/// Energies of `j2_habits.f90`.
const RIGHT: u32 = 0;
const NO_ENERGIES: u32 = 1;
const DOUBLE_ENERGY: u32 = 2;
/// DDSDDE of `j2_habits.f90`.
const CONSISTENT: u32 = 0;
const ELASTIC: u32 = 1;
const NO_TANGENT: u32 = 2;
/// NTENS of `j2_habits.f90`.
const OBEYED: u32 = 0;
const TAKEN_FOR_SIX: u32 = 1;
const STOPS: u32 = 2;

fn foreign(library: &Value, habits: [u32; 3], keys: Value) -> Value {
    let props: Vec<f64> = STEEL.into_iter().chain(habits.map(f64::from)).collect();
    let mut material = json!({ "plugin": library, "props": props, "nstatv": 7 });
    for (key, value) in keys.as_object().into_iter().flatten() {
        material[key] = value.clone();
    }
    material
}

fn own() -> Value {
    let [modulus, nu, yield_stress, hardening] = STEEL;
    let table = json!([[yield_stress, 0.0], [yield_stress + hardening, 1.0]]);
    json!({ "plugin": "j2_plasticity", "props": { "E": modulus, "nu": nu, "hardening": table } })
}

/// A plate with a hole that yields around it.
fn plate(desk: &Desk, name: &str, model: &str, material: Value) -> Run {
    let steps = json!([ { "slip": 0.03, "increments": { "initial": 0.1, "maximum": 0.2 } } ]);
    plate_along(desk, name, model, material, steps)
}

/// The same along other steps.
fn plate_along(desk: &Desk, name: &str, model: &str, material: Value, steps: Value) -> Run {
    let case = json!({
        "kind": "pullout",
        "title": "A plate",
        "mesh": { "specimen": { "type": "plate_with_hole", "cells": 40, "element": "Q4" } },
        "parts": { "plate": { "material": material, "model": model } },
        "grip": { "nodes": "top", "direction": [0, 1], "lateral": "free" },
        "steps": steps,
        "output": { "plots": false, "vtu": false },
    });
    super::run(desk, name, &case)
}

/// A thick cylinder under internal pressure, partly plastic.
fn cylinder(desk: &Desk, name: &str, _model: &str, material: Value) -> Run {
    let case = json!({
        "kind": "pullout",
        "title": "A cylinder",
        "mesh": { "specimen": { "type": "thick_cylinder", "axisymmetric": true, "radial_cells": 6, "other_cells": 1 } },
        "parts": { "cylinder": { "material": material } },
        "loads": { "pressure": { "edges": "inner", "pressure": 1 } },
        "steps": [ { "drives": { "pressure": 240 }, "increments": 6 } ],
        "output": { "plots": false, "vtu": false },
    });
    super::run(desk, name, &case)
}

/// A coarse fibre in elastic concrete that is pulled out.
fn fibre(desk: &Desk, name: &str, material: Value) -> Run {
    super::run(desk, name, &fibre_case(material))
}

fn fibre_case(material: Value) -> Value {
    let elastic = json!({ "plugin": "linear_elastic", "props": { "E": 23.7e3, "nu": 0.2 } });
    json!({
        "kind": "pullout",
        "title": "A coarse fibre",
        "mesh": { "specimen": {
            "type": "perpendicular_fibre", "embedded_elements": 6, "interface_size": 2.0, "largest_size": 6.0,
        } },
        "parts": { "fibre": { "material": material }, "matrix": { "material": elastic } },
        "contact": { "law": { "plugin": "bond_slip", "props": { "k_e": 400.0 } } },
        "steps": [ { "slip": 0.1, "increments": { "initial": 0.01, "maximum": 0.1 } } ],
        "output": { "plots": false },
    })
}

fn warnings(run: &Run) -> String {
    let texts = run.summary["warnings"].as_array().expect("a list").iter();
    texts.map(|text| text.as_str().expect("text")).collect::<Vec<_>>().join("\n")
}

#[track_caller]
fn same(found: &Run, expected: &Run, column: &str, tolerance: f64) {
    let (found, expected) = (found.history.last(column), expected.history.last(column));
    assert!((found - expected).abs() <= tolerance * expected.abs(), "{column}: {found} instead of {expected}");
}

fn iterations(run: &Run) -> u64 {
    run.summary["iterations"].as_u64().expect("a number")
}

#[test]
fn a_fibre_without_energies_is_pulled_out_as_one_with() {
    let desk = Desk::new();
    let Some(library) = built(&desk, "j2_habits.f90", &[]) else { return };
    let expected = fibre(&desk, "own", own());
    assert!(!warnings(&expected).contains("energies"), "{}", warnings(&expected));
    let right = fibre(&desk, "right", foreign(&library, [RIGHT, CONSISTENT, OBEYED], json!({})));
    same(&right, &expected, "load", 1e-5);
    // its plane stress needs six components
    assert!(!warnings(&right).contains("energies"), "{}", warnings(&right));
    assert!(right.summary["energies"]["unaccounted_energy"].is_null());
    for (name, habit, words) in [
        ("none", NO_ENERGIES, "part 'fibre': its UMAT reports no energies"),
        (
            "double",
            DOUBLE_ENERGY,
            "part 'fibre': the energies that its UMAT reports (SSE + SPD + SCD) contradict its stresses: 2.0",
        ),
    ] {
        let run = fibre(&desk, name, foreign(&library, [habit, CONSISTENT, OBEYED], json!({})));
        same(&run, &expected, "load", 1e-5);
        same(&run, &expected, "slip", 1e-12);
        let text = warnings(&run);
        assert!(text.matches(words).count() == 1 && run.outcome.stderr.contains(words), "{text}");
        // what the fibre stored is what our law says it stored
        let energy = |run: &Run, name: &str| run.summary["energies"][name].as_f64().unwrap_or(0.0);
        let stored = energy(&right, "elastic_energy") - energy(&run, "elastic_energy");
        let unaccounted = energy(&run, "unaccounted_energy");
        assert!(stored > 0.0 && (unaccounted / stored - 1.0).abs() < 1e-2, "{unaccounted} instead of {stored}");
        assert!(run.summary["energy_error_max"].as_f64().expect("a number") < 2e-3);
        println!("{name}: {} increments, own law {}", run.summary["increments"], expected.summary["increments"]);
    }
}

/// Equal increments are never refused for their energies: energies that contradict the work are reported all the same, and the
/// increments stay those that the step asks for.
#[test]
fn wrong_energies_are_found_under_equal_increments() {
    let desk = Desk::new();
    let Some(library) = built(&desk, "j2_habits.f90", &[]) else { return };
    let pulled = |habit: u32| {
        let mut case = fibre_case(foreign(&library, [habit, CONSISTENT, OBEYED], json!({})));
        case["steps"][0]["increments"] = json!(8);
        super::run(&desk, "fibre", &case)
    };
    let (right, double) = (pulled(RIGHT), pulled(DOUBLE_ENERGY));
    assert!(!warnings(&right).contains("energies"), "{}", warnings(&right));
    let words = "part 'fibre': the energies that its UMAT reports (SSE + SPD + SCD) contradict its stresses: 2.0";
    assert!(warnings(&double).contains(words), "{}", warnings(&double));
    assert_eq!(double.history.column("slip"), right.history.column("slip"));
    same(&double, &right, "load", 1e-9);
    assert!(double.summary["energies"]["unaccounted_energy"].as_f64() > Some(0.0));
}

#[test]
fn a_plate_without_a_true_tangent_converges_by_differences() {
    let desk = Desk::new();
    let Some(library) = built(&desk, "j2_habits.f90", &[]) else { return };
    let run = |name: &str, tangent: u32, keys: Value| {
        plate(&desk, name, "plane_strain", foreign(&library, [RIGHT, tangent, OBEYED], keys))
    };
    let expected = plate(&desk, "own", "plane_strain", own());
    assert!(expected.history.last("yielding_points") > 20.0);
    let consistent = run("consistent", CONSISTENT, json!({}));
    assert!(!warnings(&consistent).contains("DDSDDE"), "{}", warnings(&consistent));
    let automatic = run("automatic", ELASTIC, json!({}));
    assert_eq!(warnings(&automatic).matches("part 'plate': DDSDDE of its UMAT is not the derivative").count(), 1);
    let numerical = run("numerical", NO_TANGENT, json!({ "tangent": "numerical" }));
    for run in [&consistent, &automatic, &numerical] {
        same(run, &expected, "load", 1e-5);
    }
    let counts = [&expected, &consistent, &automatic, &numerical].map(iterations);
    println!("iterations: own law, consistent, replaced, numerical: {counts:?}");
    assert!(counts[3] <= counts[0] + 1 && counts[2] <= counts[0] + 8, "{counts:?}");
}

#[test]
fn a_comparison_shows_how_far_the_tangent_is_off_and_where() {
    let desk = Desk::new();
    let Some(library) = built(&desk, "j2_habits.f90", &[]) else { return };
    let deviation = |run: &Run| {
        let text = warnings(run);
        let words = text.split("differences of the stress by ").nth(1).expect("a comparison");
        assert!(words.contains("(step 1, increment "), "{text}");
        words.split(' ').next().and_then(|number| number.parse::<f64>().ok()).expect("a number")
    };
    for (tangent, is_true) in [(CONSISTENT, true), (ELASTIC, false)] {
        let material = foreign(&library, [RIGHT, tangent, OBEYED], json!({ "tangent": "compare" }));
        if is_true {
            // with the elastic one iterations crawl
            let run = plate(&desk, "plate", "plane_strain", material.clone());
            assert!(deviation(&run) < 1e-5, "{}", warnings(&run));
        }
        let steps = json!([{ "increments": 20, "target": { "e11": 0.01 } }]);
        let run = super::run(&desk, "point", &point(material, "3d", steps));
        assert_eq!(deviation(&run) < 1e-5, is_true, "{}", warnings(&run));
    }
}

#[test]
fn six_components_serve_in_a_plane() {
    let desk = Desk::new();
    let Some(library) = built(&desk, "j2_habits.f90", &[]) else { return };
    let steps = json!([{ "increments": 20, "target": { "e11": 0.01, "g12": 0.004 } }, { "increments": 5, "target": { "e11": 0.008 } }]);
    for (mode, free) in [("plane_strain", "e22"), ("axisymmetric", "e33"), ("plane_stress", "e33")] {
        let expected = super::run(&desk, "own", &point(own(), mode, steps.clone())).history;
        for (name, habit, keys) in [
            ("asked", OBEYED, json!({ "as": "3d" })),
            ("asked-numerical", OBEYED, json!({ "as": "3d", "tangent": "numerical" })),
            ("found", TAKEN_FOR_SIX, json!({})),
            ("stops", STOPS, json!({})),
        ] {
            let material = foreign(&library, [RIGHT, CONSISTENT, habit], keys);
            let run = super::run(&desk, &format!("{mode}-{name}"), &point(material, mode, steps.clone()));
            for column in ["s11", "s22", "s33", "s12", free] {
                let (found, expected) = (run.history.last(column), expected.last(column));
                assert!(
                    (found - expected).abs() <= 1e-8 * expected.abs().max(1.0),
                    "{mode} {name} {column}: {found} {expected}"
                );
            }
            let says = warnings(&run).contains("is called with NTENS = 6: with NTENS = ");
            assert_eq!(says, habit != OBEYED, "{}", warnings(&run));
        }
    }
}

#[test]
fn six_components_serve_in_parts() {
    type Specimen = fn(&Desk, &str, &str, Value) -> Run;
    let desk = Desk::new();
    let Some(library) = built(&desk, "j2_habits.f90", &[]) else { return };
    let specimens: [(Specimen, &str); 3] =
        [(plate, "plane_stress"), (plate, "plane_strain"), (cylinder, "axisymmetric")];
    for (specimen, model) in specimens {
        let expected = specimen(&desk, "own", model, own());
        assert!(expected.history.last("yielding_points") > 3.0, "{model}");
        for (habit, keys) in [(OBEYED, json!({ "as": "3d" })), (TAKEN_FOR_SIX, json!({})), (STOPS, json!({}))] {
            let run = specimen(&desk, model, model, foreign(&library, [RIGHT, CONSISTENT, habit], keys));
            same(&run, &expected, "external_work", 1e-8);
            let says = warnings(&run).contains("is called with NTENS = 6: with NTENS");
            assert_eq!(says, habit != OBEYED, "{}", warnings(&run));
            println!("{model}: {} iterations, own law {}", iterations(&run), iterations(&expected));
        }
    }
}

/// Pulled and brought back in other increments a plate of a material with right energies is left with a little work of the trapezoidal
/// sums, and no energy: little of the largest work.
#[test]
fn work_that_comes_back_is_no_measure_of_energies() {
    let desk = Desk::new();
    let Some(library) = built(&desk, "stiffening.f90", &[]) else { return };
    let there = json!({ "slip": 0.03, "increments": 4 });
    let back = json!({ "slip": 0.0, "increments": 3 });
    for (name, steps) in [("there", json!([there])), ("back", json!([there, back]))] {
        let material = json!({ "plugin": library, "props": [1e3, 3e5, 1.0], "nstatv": 0 });
        let run = plate_along(&desk, name, "plane_strain", material, steps);
        assert!(!warnings(&run).contains("energies that its UMAT reports"), "{name}: {}", warnings(&run));
        let work = run.history.column("external_work");
        let largest = worst(work.iter().copied());
        println!("{name}: work at most {largest:.4}, at the end {:.2e} N·mm", run.history.last("external_work"));
        assert!(name == "there" || run.history.last("external_work").abs() > 1e-6 * largest);
    }
}

/// A law that counts what lies on its yield surface as loading has the tangent of loading at every converged state, within rounding. A step
/// to a lower stress unloads all the same: back along E, not on along the softening branch.
#[test]
fn a_step_to_a_lower_stress_unloads_whatever_the_tangent_on_the_surface() {
    let desk = Desk::new();
    let Some(library) = built(&desk, "j2_habits.f90", &[]) else { return };
    for hardening in [-2000.0, -500.0, 0.0, 1000.0] {
        for (loaded, count) in [(0.004, 7), (0.0123, 7), (0.0123, 40), (0.02, 40)] {
            for target in [json!({}), json!({ "s11": 50.0 })] {
                let end = target["s11"].as_f64().unwrap_or(0.0);
                let material =
                    json!({ "plugin": library, "props": [2e5, 0.3, 250.0, hardening, 0, 0, 0], "nstatv": 7 });
                let steps = json!([
                    { "increments": count, "target": { "e11": loaded } },
                    { "increments": 10, "target": target },
                ]);
                let name = format!("unloading-{hardening}-{loaded}-{count}-{end}");
                let run = super::run(&desk, &name, &point(material, "3d", steps));
                let stress = run.history.column("s11")[count];
                let back = loaded - (stress - end) / 2e5;
                let strain = run.history.last("e11");
                assert!((strain - back).abs() < 1e-9, "{hardening} {loaded} {count} {end}: {strain}, not {back}");
            }
        }
    }
}
