//! Laws of specimens that misbehave.

use super::program::{Desk, json};
use super::{Fault, compiled, fails_and_replays, material};
use serde_json::{Value, json};

/// A plate with a hole in 2 × 4 increments.
pub(super) fn plate(material: Value, nlgeom: bool) -> Value {
    json!({
        "kind": "pullout",
        "title": "A plate",
        "mesh": { "specimen": { "type": "plate_with_hole", "cells": 4, "element": "Q4" } },
        "parts": { "plate": { "material": material } },
        "grip": { "nodes": "top", "direction": [0, 1], "lateral": "free" },
        "nlgeom": nlgeom,
        "steps": [ { "slip": 0.01, "increments": 4 }, { "slip": 0.5, "increments": 4 } ],
    })
}

/// A fibre of linear elasticity whose bond is the misbehaving one.
fn fibre(law: Value) -> Value {
    let elastic =
        |modulus: f64| json!({ "material": { "plugin": "linear_elastic", "props": { "E": modulus, "nu": 0.2 } } });
    let mut contact = json!({ "law": law, "enforcement": "penalty" });
    if law["entry"] == "fric" {
        contact = json!({ "law": law, "normal": { "hard": {} } });
    }
    json!({
        "kind": "pullout",
        "title": "A fibre",
        "mesh": { "specimen": {
            "type": "perpendicular_fibre", "embedded_elements": 6, "interface_size": 2.0, "largest_size": 6.0,
        } },
        "parts": { "fibre": elastic(210e3), "matrix": elastic(23.7e3) },
        "contact": contact,
        "steps": [ { "slip": 0.001, "increments": 2 }, { "slip": 0.01, "increments": 4 } ],
    })
}

#[test]
fn a_law_of_a_part() {
    let desk = Desk::new();
    if !compiled(&desk, "misbehaving.c", "misbehaving") {
        return;
    }
    for (fault, expected) in [
        (Fault::Exit0, "exit code 0 (STOP"),
        (Fault::WildPointer, "SIGSEGV"),
        (Fault::EndlessLoop, "did not return within 1 s"),
    ] {
        let mut material = material("misbehaving", fault as u32);
        material["call_time_limit_s"] = json!(1.0);
        let case = desk.case("case.json", &plate(material, false));
        let place = "plugin 'misbehaving', step 2, increment 3";
        let run = fails_and_replays(&desk, &case, place, expected);
        let message = run.summary["message"].as_str().expect("a message");
        assert!(message.contains("element 1, integration point 1"), "{message}");
        // the initial state, four increments, two increments
        assert_eq!(run.history.rows.len(), 7);
        assert!(run.history.last("load") > 0.0 && run.folder.join("fields.pvd").is_file());
    }
}

#[test]
fn a_law_of_contact() {
    let desk = Desk::new();
    if !compiled(&desk, "misbehaving.c", "misbehaving") {
        return;
    }
    for entry in ["uinter", "fric"] {
        let mut law = material("misbehaving", Fault::Abort as u32);
        law["entry"] = json!(entry);
        let case = desk.case("case.json", &fibre(law));
        let run = fails_and_replays(&desk, &case, "plugin 'misbehaving', step 2, increment 3", "SIGABRT");
        let message = run.summary["message"].as_str().expect("a message");
        assert!(message.contains(", contact point "), "{message}");
        assert_eq!((run.history.last("step"), run.history.last("increment")), (2.0, 2.0), "{entry}");
        assert_eq!(run.summary["plugins"].as_array().map(Vec::len), Some(3));
    }
}

/// The arguments of the FE core come back as well: element, point, place, rotation.
#[test]
fn arguments_of_points() {
    let desk = Desk::new();
    if !compiled(&desk, "misbehaving.c", "misbehaving") {
        return;
    }
    let print = || material("misbehaving", Fault::Print as u32);
    let mut contact = [print(), print()];
    contact[1]["entry"] = json!("fric");
    let [uinter, fric] = contact;
    for case in [plate(print(), false), plate(print(), true), fibre(uinter), fibre(fric)] {
        let printed = super::arguments::replays(&desk, &case);
        let value = |name: &str| super::arguments::value(&printed, name).to_owned();
        assert_eq!(value("kinc"), "3");
        assert_ne!(value("coords"), "0 0 0");
    }
}

/// The virgin tangent is asked for when a case is read: nothing has begun then.
#[test]
fn a_law_that_ends_the_process_at_its_first_call() {
    let desk = Desk::new();
    if !compiled(&desk, "misbehaving.c", "misbehaving") {
        return;
    }
    let mut material = material("misbehaving", Fault::Exit0 as u32);
    material["props"] = json!([1000.0, Fault::Exit0 as u32, 1, 1]);
    let case = desk.case("case.json", &plate(material, false));
    // an earlier run's rows are not this run's
    desk.write("out/history.csv", "step\n1\n");
    let outcome = desk.pullout(["run", "--quiet", "--overwrite", "--out", "out", "case.json"]).expect(1);
    let summary = json(&desk.path("out/summary.json"));
    for text in [outcome.stderr.as_str(), summary["message"].as_str().expect("a message")] {
        assert!(text.contains("plugin 'misbehaving', step 1, increment 1"), "{text}");
        assert!(text.contains("exit code 0"), "{text}");
    }
    assert!(!desk.path("out/history.csv").exists());
    let replay = desk.run(&desk.path("out/replay.json"), &[], "again", 1);
    assert!(replay.outcome.stderr.contains("exit code 0"), "{}", replay.outcome.stderr);
    desk.pullout(["check".as_ref(), case.as_os_str()]).expect(1);
}
