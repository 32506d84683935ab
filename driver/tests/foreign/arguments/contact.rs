//! At a contact point of a specimen: a block is moved as a whole over another that is held.

use super::mesh::Patch;
use super::{Argument, FRIC_ALWAYS, Printed, UINTER_ALWAYS, calls, expect_within};
use crate::program::Desk;
use crate::{built, run};
use serde_json::{Value, json};

/// MPa/mm.
const STIFFNESS: f64 = 100.0;
/// Displacements go through text, sums of drives and shape functions.
const ROUNDING: f64 = 1e-11;
/// Increments, duration, s, displacement of the upper block at the end, mm, temperature and field variables there.
type Step = (usize, f64, [f64; 2], f64, [f64; 2]);
const STEPS: [Step; 2] = [(2, 4.0, [-0.04, -0.01], 20.0, [1.0, 2.0]), (4, 2.0, [-0.12, -0.03], 40.0, [5.0, 10.0])];
/// Thickness of both blocks, mm.
const THICKNESS: f64 = 2.5;
const E: f64 = 1000.0;

/// A block of 2 × 1 mm upon one of 4 × 1 mm, and a square for the grip.
fn patch() -> Patch {
    Patch {
        nodes: vec![
            [0.0, -1.0],
            [4.0, -1.0],
            [4.0, 0.0],
            [0.0, 0.0],
            [1.0, 0.0],
            [3.0, 0.0],
            [3.0, 1.0],
            [1.0, 1.0],
            [8.0, 0.0],
            [9.0, 0.0],
            [9.0, 1.0],
            [8.0, 1.0],
        ],
        parts: vec![("lower", vec![[1, 2, 3, 4]]), ("upper", vec![[5, 6, 7, 8]]), ("spare", vec![[9, 10, 11, 12]])],
        edges: vec![("below", [3, 4]), ("above", [5, 6]), ("foot", [9, 10]), ("grip", [11, 12])],
    }
}

fn case(mut contact: Value) -> Value {
    let patch = patch();
    let mut supports = patch.supports(5..=8);
    supports.insert("foot".into(), json!({}));
    supports.insert("lower".into(), json!({}));
    contact["slave"] = json!("above");
    contact["master"] = json!("below");
    contact["width"] = json!("part");
    let steps = STEPS.map(|(increments, time, displacement, temperature, predef)| {
        let drives = patch.drives(5..=8, |_| displacement);
        let mut step = json!({ "slip": 0.001, "drives": drives, "time": time, "increments": increments });
        (step["temperature"], step["predef"]) = (json!(temperature), json!(predef));
        step
    });
    let part = json!({
        "material": { "plugin": "linear_elastic", "props": { "E": E, "nu": 0 } },
        "model": "plane_stress", "thickness": THICKNESS,
    });
    json!({
        "kind": "pullout", "title": "Two blocks", "temperature": 10, "predef": [0, 2],
        "mesh": { "file": "blocks.msh" },
        "parts": { "lower": part, "upper": part, "spare": part },
        "contact": [contact],
        "supports": supports,
        "grip": { "nodes": "grip", "direction": "y", "lateral": "free" },
        "steps": steps,
        "controls": { "locate_peak": false },
        "output": { "plots": false, "vtu": false },
    })
}

/// The last call of an increment at a contact point.
fn call<'c>(calls: &'c [Printed], step: &str, increment: &str, node: &str) -> &'c Printed {
    let wanted = [("kstep", step), ("kinc", increment), ("node", node)];
    calls.iter().rfind(|call| wanted.iter().all(|(name, value)| call[*name] == *value)).expect("a call for it")
}

/// Position of the upper block a quarter of the way through the second step, half of the way, and the increment.
const FROM: [f64; 2] = [-0.06, -0.015];
const TO: [f64; 2] = [-0.08, -0.02];
const BY: [f64; 2] = [-0.02, -0.005];

/// The second of two Gauss points on the edge from (1, 0) to (3, 0).
fn place() -> [f64; 2] {
    [2.0 + 1.0 / 3.0_f64.sqrt() + TO[0], TO[1]]
}

/// The body below lies on the left of its edge, which leads to −x: so do the tangent and the slip.
const NORMAL_AND_TANGENTS: [f64; 9] = [0.0, 1.0, 0.0, -1.0, 0.0, 0.0, 0.0, 0.0, 1.0];

#[test]
fn uinter_at_a_contact_point() {
    let desk = Desk::new();
    let Some(library) = built(&desk, "print.c", &[]) else { return };
    desk.write("blocks.msh", &patch().file());
    let law = json!({ "plugin": library, "props": [STIFFNESS, 6], "nstatv": 1, "cmname": "bond" });
    let run = run(&desk, "uinter", &case(json!({ "law": law, "enforcement": "penalty" })));
    let calls = calls(&run.log(), "UINTER");
    // LOPENCLOSE and LSTATE: -1 until the plugin has said what they are
    for call in &calls {
        let expected = if call["statev"] == "0" { ("-1", "-1") } else { ("1", "2") };
        assert_eq!((&*call["lopenclose"], &*call["lstate"]), expected);
    }
    assert_eq!(calls[0]["statev"], "0");
    let found = call(&calls, "2", "2", "2");
    let expected: &[Argument<'_>] = &[
        // pressure and shear at the start
        ("stress", &[-STIFFNESS * FROM[1], -STIFFNESS * FROM[0]]),
        // after three increments, and the equilibrium at the start
        ("statev", &[4.0]),
        ("sed", &[4.0]),
        ("sfd", &[8.0]),
        ("spd", &[12.0]),
        ("svd", &[16.0]),
        ("scd", &[20.0]),
        // penetration and slip at the end
        ("rdisp", &[-TO[1], -TO[0]]),
        ("drdisp", &[-BY[1], -BY[0]]),
        // at the end
        ("time", &[1.0, 5.0]),
        ("dtime", &[0.5]),
        ("coords", &[place()[0], place()[1], 0.0]),
        ("alocaldir", &NORMAL_AND_TANGENTS),
        // half of the edge × the thickness; the edge
        ("area", &[THICKNESS]),
        ("chrlngth", &[2.0]),
        ("node", &[2.0]),
        ("kstep", &[2.0]),
        ("kinc", &[2.0]),
        ("kit", &[found["kit"].parse().expect("a number")]),
    ];
    expect_within(
        ROUNDING,
        found,
        &[UINTER_ALWAYS, expected].concat(),
        &[("ciname", "BOND"), ("slname", "SLAVE"), ("msname", "MASTER")],
    );
    // KIT counts the iterations of the increment from 1
    let same = |call: &&Printed| ["kstep", "kinc", "node"].iter().all(|name| call[*name] == found[*name]);
    let iterations: Vec<_> = calls.iter().filter(same).map(|call| call["kit"].clone()).collect();
    assert_eq!(iterations.first().map(String::as_str), Some("1"), "{iterations:?}");
    assert!(iterations.is_sorted_by_key(|kit| kit.parse::<u32>().expect("a number")), "{iterations:?}");
}

#[test]
fn fric_at_a_contact_point() {
    let desk = Desk::new();
    let Some(library) = built(&desk, "print.c", &[]) else { return };
    desk.write("blocks.msh", &patch().file());
    let law = json!({ "plugin": library, "entry": "fric", "props": [STIFFNESS], "nstatv": 1 });
    let contact = json!({ "law": law, "normal": { "hard": {} }, "enforcement": "penalty", "penalty_factor": 2 });
    let run = run(&desk, "fric", &case(contact));
    let calls = calls(&run.log(), "FRIC");
    assert_eq!(call(&calls, "1", "1", "2")["lm"], "1", "sticking until the plugin says otherwise");
    // 2 E t/(h · width)
    let penalty = 2.0 * E;
    let expected: &[Argument<'_>] = &[
        ("lm", &[0.0]),
        ("tau", &[-STIFFNESS * FROM[0]]),
        // after three increments, and the equilibrium at the start, where the surfaces touch
        ("sed", &[4.0]),
        ("sfd", &[8.0]),
        ("statev", &[4.0]),
        ("dgam", &[-BY[0]]),
        ("press", &[-penalty * TO[1]]),
        ("dpress", &[-penalty * BY[1]]),
        // what the plugin called slip so far: half of it
        ("slip", &[-0.5 * FROM[0]]),
        ("kstep", &[2.0]),
        ("kinc", &[2.0]),
        // at the end
        ("time", &[1.0, 5.0]),
        ("dtime", &[0.5]),
        ("node", &[2.0]),
        ("coords", &[place()[0], place()[1], 0.0]),
        ("rcoord", &[place()[0], 0.0, 0.0]),
        ("chrlngth", &[2.0]),
    ];
    let names = [("ciname", "PRINT"), ("slname", "SLAVE"), ("msname", "MASTER")];
    expect_within(ROUNDING, call(&calls, "2", "2", "2"), &[FRIC_ALWAYS, expected].concat(), &names);
}
