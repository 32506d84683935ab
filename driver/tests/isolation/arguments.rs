//! A replay calls the plugin with what it was called with.

use super::program::Desk;
use super::{Fault, MODULUS, compiled, material, point};
use serde_json::{Value, json};

/// Sums of an increment and its start are off by rounding.
const ROUNDING: f64 = 1e-15;

/// The arguments that the plugin printed last, by name.
fn printed(stdout: &str) -> Vec<(String, String)> {
    let block = stdout.rsplit("CALL\n").next().expect("a call");
    let lines = block.lines().filter_map(|line| line.split_once(' '));
    lines.map(|(name, values)| (name.to_owned(), values.trim().to_owned())).collect()
}

/// Both calls got the same: numbers but for rounding, names to the letter.
fn compare(log: &str, replayed: &str) {
    let (first, second) = (printed(log), printed(replayed));
    assert!(first.len() > 20, "{first:?}");
    assert_eq!(first.len(), second.len());
    for ((name, values), (other, replayed)) in first.iter().zip(&second) {
        assert_eq!(name, other);
        let numbers = |text: &str| text.split(' ').map(|word| word.parse().ok()).collect::<Option<Vec<f64>>>();
        match numbers(values).zip(numbers(replayed)) {
            Some((values, replayed)) => {
                assert_eq!(values.len(), replayed.len(), "{name}");
                for (a, b) in values.iter().zip(&replayed) {
                    assert!((a - b).abs() <= ROUNDING * a.abs().max(1.0), "{name}: {a} replayed as {b}");
                }
            }
            None => assert_eq!(values, replayed, "{name}"),
        }
    }
}

pub fn replays(desk: &Desk, case: &Value) -> Vec<(String, String)> {
    let run = desk.run(&desk.case("case.json", case), &[], "out", 1);
    let again = desk.run(&run.folder.join("replay.json"), &[], "again", 1);
    compare(&run.log(), &again.log());
    printed(&run.log())
}

pub fn value<'p>(printed: &'p [(String, String)], name: &str) -> &'p str {
    printed.iter().find(|(other, _)| other == name).map(|(_, values)| values.as_str()).expect(name)
}

#[test]
fn of_umat_at_a_point() {
    let desk = Desk::new();
    if !compiled(&desk, "misbehaving.c", "misbehaving") {
        return;
    }
    let mut case = point(material("misbehaving", Fault::Print as u32));
    case["characteristic_length"] = json!(2.5);
    case["temperature"] = json!(20.0);
    case["predef"] = json!([3.0]);
    case["material"]["cmname"] = json!("STEEL-7");
    case["steps"][1]["temperature"] = json!(40.0);
    case["steps"][1]["predef"] = json!([5.0]);
    case["steps"][1]["time"] = json!(4.0);
    for (mode, ntens) in [("3d", "6"), ("axisymmetric", "4"), ("plane_strain", "4"), ("plane_stress", "3")] {
        case["mode"] = json!(mode);
        let printed = replays(&desk, &case);
        assert_eq!((value(&printed, "ntens"), value(&printed, "kinc")), (ntens, "3"));
        assert_eq!(value(&printed, "jstep"), "2 1 0 0");
        // step time and total time at the start of the third of five increments in 4 s, after a step of 1 s
        assert_eq!(value(&printed, "time"), "1.6000000000000001 2.6000000000000001");
        assert_eq!((value(&printed, "celent"), value(&printed, "temp")), ("2.5", "28"));
        assert!(value(&printed, "cmname").starts_with("STEEL-7"));
    }
}

#[test]
fn of_umat_under_large_rotations() {
    let desk = Desk::new();
    if !compiled(&desk, "misbehaving.c", "misbehaving") {
        return;
    }
    let mut case = point(material("misbehaving", Fault::Print as u32));
    case["nlgeom"] = json!(true);
    case["steps"] = json!([
        { "increments": 2, "F": [[1.1, 0.2, 0], [0, 1, 0], [0, 0, 1]] },
        { "increments": 4, "F": [[0.9, -0.5, 0], [0.5, 1, 0.1], [0, 0, 1]] },
    ]);
    let printed = replays(&desk, &case);
    assert_eq!(value(&printed, "jstep"), "2 1 1 0");
    let drot: Vec<f64> = value(&printed, "drot").split(' ').map(|word| word.parse().expect("a number")).collect();
    assert!(drot[1].abs() > 0.01 && (drot[1] + drot[3]).abs() < 0.1, "{drot:?}");
}

#[test]
fn of_uinter_and_fric_at_a_point() {
    let desk = Desk::new();
    if !compiled(&desk, "misbehaving.c", "misbehaving") {
        return;
    }
    for (entry, second) in [("uinter", false), ("uinter", true), ("fric", false), ("fric", true)] {
        let mut material = material("misbehaving", Fault::Print as u32);
        material["entry"] = json!(entry);
        let normal = if entry == "fric" { "p" } else { "gap" };
        let mut steps = json!([
            { "increments": 5, "target": { "slip": 0.1, normal: 0.3 } },
            { "increments": 5, "target": { "slip": -0.2, normal: -0.1 } },
        ]);
        if second {
            steps[1]["target"]["slip2"] = json!(0.7);
        }
        let case = json!({ "kind": "interface", "title": entry, "material": material, "steps": steps,
            "characteristic_length": 4.0, "initial": { "statev": [1.0, 2.0], "time": 3.0 } });
        let printed = replays(&desk, &case);
        let directions = if second { "2" } else { "1" };
        if entry == "fric" {
            assert_eq!((value(&printed, "nfdir"), value(&printed, "kinc")), (directions, "3"));
        } else {
            assert_eq!((value(&printed, "kstep"), value(&printed, "chrlngth")), ("2", "4"));
        }
        assert_eq!(value(&printed, "props").split(' ').next(), Some(MODULUS.to_string().as_str()));
    }
}
