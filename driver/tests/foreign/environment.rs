//! Information that a law gets besides its strain: temperature, field variables, the initial stress, and notice of the
//! beginning and end of analysis, steps and increments.

use super::{built, point, run};
use crate::program::{Desk, Run};
use end_to_end_tests::{Tool, find, workspace};
use serde_json::{Value, json};

const E: f64 = 1000.0;
const NU: f64 = 0.25;
const ALPHA: f64 = 1e-5;
/// Effect of the field variable on the modulus.
const BETA: f64 = 0.5;

#[track_caller]
fn close(found: f64, expected: f64) {
    assert!((found - expected).abs() <= 1e-9 * expected.abs().max(1e-3), "{found} instead of {expected}");
}

fn thermal(library: &Value) -> Value {
    json!({ "plugin": library, "props": [E, NU, ALPHA, 20.0, BETA], "nstatv": 2 })
}

/// The plane-strain modulus E(1−ν)/((1+ν)(1−2ν)) of a strain whose neighbours are held.
fn confined() -> f64 {
    E * (1.0 - NU) / ((1.0 + NU) * (1.0 - 2.0 * NU))
}

#[test]
fn a_thermo_elastic_point_follows_temperature_and_fields() {
    let desk = Desk::new();
    let Some(library) = built(&desk, "heat_and_field.f", &[]) else { return };
    let mut case = point(
        thermal(&library),
        "3d",
        json!([
            { "increments": 4, "temperature": 120.0 },
            { "increments": 3, "target": { "e11": 0.0 }, "temperature": 70.0, "predef": [1.0] },
        ]),
    );
    case["temperature"] = json!(20.0);
    case["predef"] = json!([0.0]);
    let run = run(&desk, "free", &case);
    let row = |name: &str, index: usize| run.history.column(name)[index];
    // free: ε = α (T − T₀), no stress
    for (index, temperature) in [45.0, 70.0, 95.0, 120.0].into_iter().enumerate() {
        close(row("e11", index + 1), ALPHA * (temperature - 20.0));
        close(row("s11", index + 1), 0.0);
        close(row("sdv1", index + 1), temperature);
    }
    // pushed back along 1: σ₁₁ = E(F) (0 − α (T − T₀))
    close(run.history.last("s11"), -E * (1.0 + BETA) * ALPHA * 50.0);
    close(run.history.last("sdv2"), 1.0);
}

#[test]
fn a_table_has_columns_of_temperature_and_field_variables() {
    let desk = Desk::new();
    let Some(library) = built(&desk, "heat_and_field.f", &[]) else { return };
    let rows = [(1e-3, 70.0, 0.25), (2e-3, 30.0, 1.0), (0.0, 20.0, 0.5)];
    let text = rows.iter().map(|(e, t, f)| format!("{e},{t},{f}\n")).collect::<String>();
    desk.write("path.csv", &format!("e11,temperature,predef1\n{text}"));
    let mut case = point(thermal(&library), "3d", json!([{ "table": "path.csv" }]));
    case["temperature"] = json!(20.0);
    case["predef"] = json!([0.0]);
    let run = run(&desk, "table", &case);
    for (index, (strain, temperature, field)) in rows.into_iter().enumerate() {
        let stress = E * (1.0 + BETA * field) * (strain - ALPHA * (temperature - 20.0));
        close(run.history.column("s11")[index + 1], stress);
    }
    // a field that the case does not have, and a temperature from two sides
    case["predef"] = json!([]);
    case["steps"][0]["temperature"] = json!(5.0);
    let refused = desk.case("refused.json", &case);
    let outcome = desk.pullout(["check", refused.to_str().expect("UTF-8")]).expect(2);
    assert!(outcome.stderr.contains("'predef1'"), "{}", outcome.stderr);
    case["predef"] = json!([0.0]);
    let refused = desk.case("refused.json", &case);
    let outcome = desk.pullout(["check", refused.to_str().expect("UTF-8")]).expect(2);
    assert!(outcome.stderr.contains("the temperature is given twice"), "{}", outcome.stderr);
}

/// A rectangle of one element, 4 × 2 × 1 mm.
fn rectangle(material: Value, model: &str, supports: Value, grip: Value, steps: Value) -> Value {
    json!({
        "kind": "pullout",
        "title": "One element",
        "mesh": { "specimen": { "type": "beam", "length": 4, "height": 2, "cells": [1, 1], "element": "Q4" } },
        "parts": { "beam": { "model": model, "thickness": 1, "material": material } },
        "supports": supports,
        "grip": grip,
        "steps": steps,
        "output": { "plots": false, "vtu": false },
    })
}

#[test]
fn a_clamped_element_is_stressed_by_heat_and_fields() {
    let desk = Desk::new();
    let Some(library) = built(&desk, "heat_and_field.f", &[]) else { return };
    let supports = json!({ "left": { "direction": "x" }, "bottom": { "direction": "y" } });
    let grip = json!({ "nodes": "right", "direction": [1, 0], "lateral": "free" });
    let steps = json!([
        { "slip": 0.0, "increments": 2, "temperature": 120.0, "predef": [1.0] },
        { "slip": 0.004, "increments": 2 },
    ]);
    let mut case = rectangle(thermal(&library), "plane_stress", supports, grip, steps);
    case["temperature"] = json!(20.0);
    case["predef"] = json!([0.0]);
    let run = run(&desk, "clamped", &case);
    let load = run.history.column("load");
    // σ₁₁ = E(F) (ε − α (T − T₀)) on 2 mm²; half the way, half of each
    close(load[0], 0.0);
    close(load[1], -2.0 * E * (1.0 + BETA / 2.0) * ALPHA * 50.0);
    close(load[2], -2.0 * E * (1.0 + BETA) * ALPHA * 100.0);
    close(load[4], 2.0 * E * (1.0 + BETA) * (1e-3 - ALPHA * 100.0));
}

fn warned(run: &Run, text: &str) -> bool {
    let warnings = run.summary["warnings"].as_array().expect("a list");
    warnings.iter().any(|warning| warning.as_str().is_some_and(|warning| warning.contains(text)))
}

#[test]
fn a_point_starts_from_the_stress_of_sigini_or_of_the_case() {
    let desk = Desk::new();
    let Some(library) = built(&desk, "initial_stress.f", &[]) else { return };
    let material = json!({ "plugin": library, "props": [E, NU], "nstatv": 1 });
    let steps = json!([{ "increments": 2, "target": { "e11": 0, "e22": 1e-3, "e33": 0 } }]);
    let mut case = point(material, "3d", steps);
    let own = run(&desk, "sigini", &case);
    close(own.history.column("s22")[0], -10.0);
    close(own.history.column("s11")[0], -5.0);
    close(own.history.last("s22"), -10.0 + confined() * 1e-3);
    assert!(warned(&own, "its SIGINI sets the initial stress"), "{}", own.summary);
    case["initial"] = json!({ "stress": { "s22": -7.0 } });
    let given = run(&desk, "given", &case);
    close(given.history.column("s22")[0], -7.0);
    close(given.history.column("s11")[0], 0.0);
    assert!(warned(&given, "its SIGINI is not called"), "{}", given.summary);
}

/// σ₁₁ = −5 − 2y, σ₂₂ = −10, σ₃₃ = −5: in equilibrium without forces on the volume.
#[test]
fn a_plate_starts_in_equilibrium_with_the_stress_of_sigini() {
    let desk = Desk::new();
    let Some(library) = built(&desk, "initial_stress.f", &[]) else { return };
    let material = json!({ "plugin": library, "props": [E, NU], "nstatv": 0 });
    let supports = json!({
        "left": { "direction": "x" }, "right": { "direction": "x" }, "bottom": { "direction": "y" },
    });
    let grip = json!({ "nodes": "top", "direction": [0, 1], "lateral": "free" });
    let steps = json!([{ "slip": 0.002, "increments": 2 }]);
    let mut case = rectangle(material, "plane_strain", supports, grip, steps);
    case["mesh"]["specimen"]["cells"] = json!([4, 2]);
    let held = run(&desk, "held", &case);
    // the grip holds σ₂₂ on 4 mm² before it moves, and 1e-3 more strain in the end
    close(held.history.column("load")[0], -40.0);
    close(held.history.last("load"), -40.0 + 4.0 * confined() * 1e-3);
    assert!(warned(&held, "its SIGINI sets the initial stress"), "{}", held.summary);
    assert!(!warned(&held, "not in equilibrium"), "{}", held.summary);

    // the case's stress goes before; without a support at the right the part moves until σ₁₁ is 0:
    // σ₁₁⁰ + M ε₁ = 0, σ₂₂ = σ₂₂⁰ + λ ε₁ with λ = M ν/(1−ν)
    case["parts"]["beam"]["initial"] = json!({ "stress": { "s11": -3.0, "s22": -10.0 } });
    case["supports"].as_object_mut().expect("an object").remove("right");
    let moved = run(&desk, "moved", &case);
    close(moved.history.column("load")[0], 4.0 * (-10.0 + 3.0 * NU / (1.0 - NU)));
    assert!(warned(&moved, "its SIGINI is not called"), "{}", moved.summary);
    assert!(warned(&moved, "not in equilibrium"), "{}", moved.summary);
}

#[test]
fn a_part_with_an_initial_stress_starts_with_its_load_on() {
    let desk = Desk::new();
    let Some(library) = built(&desk, "elastic.f", &[]) else { return };
    let material = json!({ "plugin": library, "props": [E, NU], "nstatv": 0 });
    let supports = json!({
        "left": { "direction": "x" }, "right": { "direction": "x" }, "bottom": { "direction": "y" },
    });
    let steps = json!([{ "drives": { "weight": 25 }, "increments": 3 }]);
    let mut case = rectangle(material, "plane_strain", supports, Value::Null, steps);
    case.as_object_mut().expect("an object").remove("grip");
    case["parts"]["beam"]["initial"] = json!({ "stress": { "s11": -4.0, "s22": -10.0, "s33": -4.0 } });
    case["loads"] = json!({ "weight": { "edges": "top", "pressure": 1 } });
    case["measure"] = json!({ "exit": [4, 1], "direction": [0, 1] });
    case["initial"] = json!({ "drives": { "weight": 10 } });
    let at_rest = run(&desk, "at_rest", &case);
    let settled = at_rest.history.column("slip_exit");
    assert!(settled[0].abs() < 1e-12, "{settled:?}");
    assert!(!warned(&at_rest, "not in equilibrium"), "{}", at_rest.summary);
    // 15 MPa more on 2 mm
    close(at_rest.history.last("slip_exit") * confined(), -15.0 * 2.0);
    // without its load it moves first
    case.as_object_mut().expect("an object").remove("initial");
    let moved = run(&desk, "moved", &case);
    close(moved.history.column("slip_exit")[0] * confined(), 10.0 * 2.0);
    assert!(warned(&moved, "not in equilibrium"), "{}", moved.summary);
    case["initial"] = json!({ "drives": { "none": 1.0 } });
    let refused = desk.case("refused.json", &case);
    let outcome = desk.pullout(["check", refused.to_str().expect("UTF-8")]).expect(2);
    assert!(outcome.stderr.contains("$.initial.drives.none"), "{}", outcome.stderr);
}

/// LOP, KSTEP, KINC, TIME(1), TIME(2), DTIME of each call of UEXTERNALDB.
fn occasions(run: &Run) -> Vec<Vec<f64>> {
    let numbers = |line: &str| line.split_whitespace().skip(1).map(|word| word.parse().expect("a number")).collect();
    run.log().lines().filter(|line| line.trim().starts_with("LOP")).map(numbers).collect()
}

#[test]
fn the_analysis_its_steps_and_its_increments_are_reported_once_each() {
    let desk = Desk::new();
    let Some(library) = built(&desk, "occasions.f", &[]) else { return };
    let material = json!({ "plugin": library, "props": [E, NU, 1.5], "nstatv": 0 });
    // free lateral strains: before a step's first increment the law is asked for its unloading tangent
    let steps = json!([
        { "increments": 2, "time": 2.0, "target": { "e11": 1e-3 } },
        { "increments": 1, "time": 2.0, "target": { "e11": 2e-3 } },
    ]);
    let at_point = run(&desk, "point", &point(material.clone(), "3d", steps));
    let expected: [[f64; 6]; 15] = [
        [0.0, 1.0, 0.0, 0.0, 0.0, 0.0],
        [5.0, 1.0, 0.0, 0.0, 0.0, 1.0],
        [1.0, 1.0, 1.0, 0.0, 0.0, 1.0],
        [2.0, 1.0, 1.0, 1.0, 1.0, 1.0],
        [1.0, 1.0, 2.0, 1.0, 1.0, 1.0],
        [2.0, 1.0, 2.0, 2.0, 2.0, 1.0],
        [6.0, 1.0, 2.0, 2.0, 2.0, 1.0],
        [5.0, 2.0, 0.0, 0.0, 2.0, 2.0],
        // the law refuses 2 s: the increment begins again, in two pieces with numbers of their own
        [1.0, 2.0, 1.0, 0.0, 2.0, 2.0],
        [1.0, 2.0, 1.0, 0.0, 2.0, 1.0],
        [2.0, 2.0, 1.0, 1.0, 3.0, 1.0],
        [1.0, 2.0, 2.0, 1.0, 3.0, 1.0],
        [2.0, 2.0, 2.0, 2.0, 4.0, 1.0],
        [6.0, 2.0, 2.0, 2.0, 4.0, 1.0],
        [3.0, 2.0, 2.0, 2.0, 4.0, 1.0],
    ];
    assert_eq!(occasions(&at_point), expected);

    let supports = json!({ "left": { "direction": "x" }, "bottom": { "direction": "y" } });
    let grip = json!({ "nodes": "right", "direction": [1, 0], "lateral": "free" });
    let steps = json!([{ "slip": 0.004, "increments": 2, "time": 2.0 }]);
    let specimen = run(&desk, "specimen", &rectangle(material, "plane_stress", supports, grip, steps));
    let expected: [[f64; 6]; 8] = [
        expected[0],
        expected[1],
        expected[2],
        expected[3],
        expected[4],
        expected[5],
        expected[6],
        [3.0, 1.0, 2.0, 2.0, 2.0, 1.0],
    ];
    assert_eq!(occasions(&specimen), expected);
}

/// Reading the case is no analysis of its own: a file that LOP = 0 opens is opened once a run, and once by `pullout check`.
#[test]
fn an_analysis_begins_and_ends_once() {
    let desk = Desk::new();
    let source = std::fs::read_to_string(workspace("tests/umats/occasions.f")).expect("a source");
    let append = "OPEN(99,FILE='calls.txt',POSITION='APPEND')\n      WRITE(99,";
    let source = source.replace("WRITE(6,", append).replace("TIME,DTIME\n", "TIME,DTIME\n      CLOSE(99)\n");
    let Some(_) = find(Tool::Fortran) else { return };
    let source = desk.write("calls.f", &source);
    desk.pullout(["plugin", "build", source.to_str().expect("UTF-8"), "-o", "libcalls.so"]).expect(0);
    let supports = json!({ "left": { "direction": "x" }, "bottom": { "direction": "y" } });
    let grip = json!({ "nodes": "right", "direction": [1, 0], "lateral": "free" });
    let steps = json!([{ "slip": 0.004, "increments": 1, "time": 9.0 }]);
    // what takes longer than the law wants is cut twice, not oftener
    for (in_process, largest_time, code) in [(false, 10.0, 0), (true, 10.0, 0), (false, 2.0, 1)] {
        let material = json!({ "plugin": "./libcalls.so", "props": [E, NU, largest_time], "nstatv": 0 });
        let place = if in_process { "--in-process" } else { "--quiet" };
        let mut case = rectangle(material, "plane_stress", supports.clone(), grip.clone(), steps.clone());
        case["controls"] = json!({ "max_cutbacks": 2 });
        let [case, other] = ["case.json", "other.json"].map(|name| desk.case(name, &case));
        let calls = || {
            let text = std::fs::read_to_string(desk.path("calls.txt")).expect("a file");
            std::fs::remove_file(desk.path("calls.txt")).expect("a file");
            let words = |line: &str| line.split_whitespace().nth(1).and_then(|word| word.parse().ok());
            text.lines().map(|line| words(line).expect("a number")).collect::<Vec<u32>>()
        };
        let [case, other] = [&case, &other].map(|path| path.to_str().expect("UTF-8"));
        desk.pullout(["run", place, "--overwrite", case]).expect(code);
        let calls_once = calls();
        assert_eq!([calls_once[0], calls_once[1], calls_once[calls_once.len() - 1]], [0, 5, 3], "{calls_once:?}");
        assert_eq!(calls_once.iter().filter(|lop| [0, 3].contains(lop)).count(), 2, "{calls_once:?}");
        desk.pullout(["run", place, "--overwrite", case, other]).expect(code);
        assert_eq!(calls(), [calls_once.clone(), calls_once].concat());
        desk.pullout(["check", place, case]).expect(0);
        assert_eq!(calls(), [0, 3]);
    }
}

/// A run that goes on from a checkpoint: LOP = 0, so that tables are there, and LOP = 4; not the start of a step again.
#[test]
fn a_restart_is_reported() {
    let desk = Desk::new();
    let Some(library) = built(&desk, "occasions.f", &[]) else { return };
    let material = json!({ "plugin": library, "props": [E, NU, 10.0], "nstatv": 0 });
    let supports = json!({ "left": { "direction": "x" }, "bottom": { "direction": "y" } });
    let grip = json!({ "nodes": "right", "direction": [1, 0], "lateral": "free" });
    let steps = json!([{ "slip": 0.004, "increments": 3, "time": 3.0 }]);
    desk.case("case.json", &rectangle(material, "plane_stress", supports, grip, steps));
    desk.pullout(["run", "case.json", "--quiet", "--out", "out", "--checkpoint-every", "1"]).expect(0);
    let kept = || std::fs::read_to_string(desk.path("out/umat.log")).expect("a log");
    let before = kept();
    desk.pullout(["run", "case.json", "--quiet", "--restart", "out"]).expect(0);
    let after = kept();
    let numbers = |line: &str| line.split_whitespace().skip(1).map(|word| word.parse().expect("a number")).collect();
    let calls: Vec<Vec<f64>> = after.strip_prefix(&before).expect("the log goes on").lines().map(numbers).collect();
    assert_eq!(
        calls,
        [
            [0.0, 1.0, 0.0, 0.0, 0.0, 0.0],
            [4.0, 1.0, 2.0, 2.0, 2.0, 0.0],
            [1.0, 1.0, 3.0, 2.0, 2.0, 1.0],
            [2.0, 1.0, 3.0, 3.0, 3.0, 1.0],
            [6.0, 1.0, 3.0, 3.0, 3.0, 1.0],
            [3.0, 1.0, 3.0, 3.0, 3.0, 1.0],
        ]
    );
}

#[test]
fn plugin_info_lists_the_routines_around_the_laws() {
    let desk = Desk::new();
    let Some(_) = built(&desk, "database.f", &[]) else { return };
    let outcome = desk.pullout(["plugin", "info", "./libdatabase.so"]).expect(0);
    assert!(outcome.stdout.contains("Other routines: UEXTERNALDB, SDVINI"), "{}", outcome.stdout);
    let Some(_) = built(&desk, "initial_stress.f", &[]) else { return };
    let outcome = desk.pullout(["plugin", "info", "./libinitial_stress.so"]).expect(0);
    assert!(outcome.stdout.contains("Other routines: SIGINI"), "{}", outcome.stdout);
    // UVARM computes output variables, of which there are none
    let source = std::fs::read_to_string(workspace("tests/umats/occasions.f")).expect("a source");
    let source = source.replace("SUBROUTINE UEXTERNALDB", "SUBROUTINE UVARM");
    let source = desk.write("with_uvarm.f", &source);
    desk.pullout(["plugin", "build", source.to_str().expect("UTF-8"), "-o", "libuvarm.so"]).expect(0);
    let outcome = desk.pullout(["plugin", "info", "./libuvarm.so"]).expect(0);
    assert!(outcome.stdout.contains("Other routines: UVARM (not called by this program)"), "{}", outcome.stdout);
    let material = json!({ "plugin": "./libuvarm.so", "props": [E, NU, 10.0], "nstatv": 0 });
    let run = run(&desk, "uvarm", &point(material, "3d", json!([{ "increments": 1, "target": { "e11": 1e-3 } }])));
    assert!(warned(&run, "its UVARM is not called"), "{}", run.summary);
}

#[test]
fn plane_stress_says_why_a_strain_is_missing() {
    let desk = Desk::new();
    let Some(library) = built(&desk, "heat_and_field.f", &[]) else { return };
    let steps = json!([{ "increments": 1, "target": { "e11": 1e-3 } }]);
    let run = run(&desk, "plane", &point(thermal(&library), "plane_stress", steps));
    assert!(run.history.last("e33").is_nan());
    assert!(warned(&run, "the column e33 is NaN"), "{}", run.summary);
}
