//! At a contact point.

use super::{Argument, FRIC_ALWAYS, IDENTITY, UINTER_ALWAYS, calls, expect};
use crate::program::Desk;
use crate::{built, run};
use serde_json::json;

#[test]
fn uinter_at_a_point() {
    let desk = Desk::new();
    let Some(library) = built(&desk, "print.c", &[]) else { return };
    let case = json!({
        "kind": "interface", "characteristic_length": 2.5, "temperature": 20, "predef": [1, 2],
        "material": { "plugin": library, "props": [100, 6], "nstatv": 1, "cmname": "bond" },
        "initial": { "slip": 0.01, "gap": 0.02, "time": 5 },
        "steps": [{
            "increments": 2, "time": 4, "target": { "slip": 0.05, "gap": -0.02 }, "temperature": 30, "predef": [3, 6],
        }],
    });
    let run = run(&desk, "uinter", &case);
    let calls = calls(&run.log(), "UINTER");
    assert_eq!(calls.len(), 3, "one at the initial place, then one per increment");
    assert_eq!((&*calls[0]["lopenclose"], &*calls[0]["lstate"]), ("-1", "-1"));
    // the last call: from gap 0, slip 0.03 to penetration 0.02, slip 0.05; everything at the end of the increment
    let expected: &[Argument<'_>] = &[
        ("stress", &[2.0, 2.0]),
        ("statev", &[1.0]),
        // what the call at the initial place stored, and one more
        ("sed", &[2.0]),
        ("sfd", &[2.0]),
        ("spd", &[3.0]),
        ("svd", &[4.0]),
        ("scd", &[5.0]),
        ("rdisp", &[0.02, 0.05]),
        ("drdisp", &[0.02, 0.02]),
        ("time", &[4.0, 9.0]),
        ("dtime", &[2.0]),
        ("coords", &[0.0; 3]),
        // column 1 is the normal
        ("alocaldir", &IDENTITY),
        ("area", &[1.0]),
        ("chrlngth", &[2.5]),
        ("node", &[1.0]),
        ("kstep", &[1.0]),
        ("kinc", &[2.0]),
        ("kit", &[1.0]),
    ];
    expect(
        &calls[2],
        &[UINTER_ALWAYS, expected].concat(),
        &[("ciname", "BOND"), ("slname", "SLAVE"), ("msname", "MASTER")],
    );
}

#[test]
fn fric_at_a_point() {
    let desk = Desk::new();
    let Some(library) = built(&desk, "print.c", &[]) else { return };
    let case = json!({
        "kind": "interface", "temperature": 20, "predef": [1, 2],
        "material": { "plugin": library, "entry": "fric", "props": [100], "nstatv": 1 },
        "steps": [{
            "increments": 2, "time": 4, "target": { "slip": 0.04, "p": 6 }, "temperature": 30, "predef": [3, 6],
        }],
    });
    let run = run(&desk, "fric", &case);
    let calls = calls(&run.log(), "FRIC");
    assert_eq!(calls.len(), 2);
    assert_eq!(calls[0]["lm"], "1", "sticking until the plugin says otherwise");
    let expected: &[Argument<'_>] = &[
        ("lm", &[0.0]),
        ("tau", &[2.0]),
        ("sed", &[1.0]),
        ("sfd", &[2.0]),
        ("statev", &[1.0]),
        ("dgam", &[0.02]),
        // at the end, and its increment
        ("press", &[6.0]),
        ("dpress", &[3.0]),
        // what the plugin called slip so far: half of it
        ("slip", &[0.01]),
        ("kstep", &[1.0]),
        ("kinc", &[2.0]),
        // at the end
        ("time", &[4.0, 4.0]),
        ("dtime", &[2.0]),
        ("node", &[1.0]),
        ("coords", &[0.0; 3]),
        ("rcoord", &[0.0; 3]),
        ("chrlngth", &[1.0]),
    ];
    expect(
        &calls[1],
        &[FRIC_ALWAYS, expected].concat(),
        &[("ciname", "PRINT"), ("slname", "SLAVE"), ("msname", "MASTER")],
    );
}

/// LM by what the point did in the increment before: 1 at first, 0 where it slipped, 2 where nothing pressed.
#[test]
fn fric_is_given_whether_it_was_open() {
    let desk = Desk::new();
    let Some(library) = built(&desk, "print.c", &[]) else { return };
    let step = |slip: f64, p: f64| json!({ "increments": 1, "target": { "slip": slip, "p": p } });
    let case = json!({
        "kind": "interface",
        "material": { "plugin": library, "entry": "fric", "props": [100], "nstatv": 1 },
        "steps": [step(0.01, 5.0), step(0.02, -1.0), step(0.03, 5.0), step(0.03, 6.0), step(0.04, 5.0)],
    });
    let calls = calls(&run(&desk, "open", &case).log(), "FRIC");
    let modes: Vec<_> = calls.iter().map(|call| &*call["lm"]).collect();
    // a step without slip sticks
    assert_eq!(modes, ["1", "0", "2", "0", "1"]);
}

/// A table's columns, and the values given at the initial place; without field variables there is one of 0 to read.
#[test]
fn a_table_has_temperatures_of_a_contact_point() {
    let desk = Desk::new();
    let Some(library) = built(&desk, "print.c", &[]) else { return };
    desk.write("path.csv", "slip,temperature\n0.01,70\n0.02,40\n");
    let mut case = json!({
        "kind": "interface", "temperature": 20,
        "material": { "plugin": library, "props": [100, 6], "nstatv": 1 },
        "steps": [{ "table": "path.csv" }, { "increments": 1, "target": { "slip": 0.03 } }],
    });
    let calls = calls(&run(&desk, "table", &case).log(), "UINTER");
    let temperatures: Vec<_> = calls.iter().map(|call| [&*call["temp"], &*call["dtemp"]]).collect();
    assert_eq!(temperatures, [["20,20", "0,0"], ["70,70", "50,50"], ["40,40", "-30,-30"], ["40,40", "0,0"]]);
    assert!(calls.iter().all(|call| call["npred"] == "1" && call["predef"] == "0,0"));
    case["steps"][0]["predef"] = json!([1.0]);
    let refused = desk.case("refused.json", &case);
    let outcome = desk.pullout(["check", refused.to_str().expect("UTF-8")]).expect(2);
    assert!(outcome.stderr.contains("$.steps[0].predef: 1 values given"), "{}", outcome.stderr);
}

/// Two tangential directions: every array that has them.
#[test]
fn contact_in_space() {
    let desk = Desk::new();
    let Some(library) = built(&desk, "print.c", &[]) else { return };
    let last = |entry: &str, target: serde_json::Value| {
        let case = json!({
            "kind": "interface", "material": { "plugin": library, "entry": entry, "props": [100], "nstatv": 1 },
            "steps": [{ "increments": 2, "target": target }],
        });
        let run = run(&desk, entry, &case);
        calls(&run.log(), &entry.to_uppercase()).pop().expect("a call")
    };
    let check = |call: &super::Printed, expected: &[(&str, &[f64])]| {
        let some = call.iter().filter(|(name, _)| expected.iter().any(|(wanted, _)| wanted == name));
        expect(&some.map(|(name, value)| (name.clone(), value.clone())).collect(), expected, &[]);
    };
    let uinter = last("uinter", json!({ "slip": 0.04, "slip2": -0.02, "gap": -0.01 }));
    let half: &[f64] = &[0.005, 0.02, -0.01];
    check(
        &uinter,
        &[
            ("ndir", &[3.0]),
            ("rdisp", &[0.01, 0.04, -0.02]),
            ("drdisp", half),
            ("stress", &[0.5, 2.0, -1.0]),
            ("ddsddr", &[0.0; 9]),
            ("dviscous", &[0.0; 9]),
            ("dstructural", &[0.0; 9]),
            ("ddsddt", &[0.0; 6]),
            ("ddfddr", &[0.0; 6]),
            // the normal, then both tangents
            ("alocaldir", &IDENTITY),
        ],
    );
    let fric = last("fric", json!({ "slip": 0.04, "slip2": -0.02, "p": 3 }));
    check(
        &fric,
        &[
            ("nfdir", &[2.0]),
            ("dgam", &[0.02, -0.01]),
            ("tau", &[2.0, -1.0]),
            ("slip", &[0.01, -0.005]),
            ("press", &[3.0]),
            ("dpress", &[1.5]),
            ("ddtddg", &[0.0; 4]),
            ("ddtddp", &[0.0; 2]),
            ("dslip", &[0.0; 2]),
            ("ddtddt", &[0.0; 4]),
            ("taulm", &[0.0; 2]),
        ],
    );
}
