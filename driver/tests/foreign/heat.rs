//! HETVAL and UMATHT of others in a specimen with a field: phase fields against those by RPL and against our law, heat against
//! closed forms, and errors that are planted.

use super::check::row;
use super::coupling::{checked, checked_with};
use super::{built, built_of, close, point, run};
use crate::program::{Desk, Run, goes_on_from_a_checkpoint};
use serde_json::{Value, json};

const YOUNG: f64 = 30e3;
const POISSON: f64 = 0.2;

/// Parameters of a crack of PF-CZM: strength, fracture energy, length, p, a₂, a₃.
const COHESIVE: [f64; 6] = [3.0, 0.09, 4.0, 2.0, -0.5, 0.0];

/// The phase field by HETVAL: 1 is AT2, 2 a cohesive crack.
fn by_hetval(library: &Value, model: u32, error: u32) -> Value {
    let props = [&[YOUNG, POISSON], &COHESIVE[..], &[f64::from(model), f64::from(error)]].concat();
    json!({ "plugin": library, "props": props, "nstatv": 1 })
}

/// A strip with sound ends that is pulled between sides that do not come nearer: the crack is in its middle.
fn strip(material: Value) -> Value {
    json!({
        "kind": "pullout",
        "mesh": { "specimen": { "type": "beam", "length": 10, "height": 1, "cells": [10, 1], "element": "Q8" } },
        "parts": { "beam": { "model": "plane_strain", "thickness": 1, "material": material } },
        "field": {
            "kind": "phase_field",
            "fixed": [{ "nodes": "left", "value": 0 }, { "nodes": "right", "value": 0 }],
        },
        "grip": { "nodes": "right", "direction": "x" },
        "supports": { "left": {}, "bottom": { "direction": "y" }, "top": { "direction": "y" } },
        "steps": [{ "slip": 0.04, "increments": 40 }],
        "output": { "vtu": false, "plots": false },
    })
}

/// Asserts that two runs have the same loads, which fall, and a crack.
fn assert_same_loads(one: &Run, other: &Run, tolerance: f64) {
    let [theirs, ours] = [one, other].map(|run| run.history.column("load"));
    let peak = other.peak("load", "max");
    assert_eq!(theirs.len(), ours.len());
    assert!(ours.last().is_some_and(|last| *last < 0.8 * peak) && other.history.last("field_max") > 0.3, "it cracks");
    for (theirs, ours) in theirs.iter().zip(&ours) {
        assert!((theirs - ours).abs() <= tolerance * peak, "{theirs} {ours}");
    }
}

/// H of this iteration in STATEV, d of the end of the increment, parameters in a module, and inputs that both routines write into.
#[test]
fn a_phase_field_by_hetval_has_the_loads_of_the_same_by_rpl_and_of_our_law() {
    let desk = Desk::new();
    let Some(by_source) = built(&desk, "phase_field_hetval.for", &[]) else { return };
    let Some(by_rpl) = built(&desk, "phase_field.f90", &[]) else { return };
    let [strength, energy, length, p, a_2, a_3] = COHESIVE;
    let own = json!({ "plugin": "concrete_phase_field", "props": {
        "E": YOUNG, "nu": POISSON, "f_t": strength, "G_f": energy, "l": length, "p": p, "a_2": a_2, "a_3": a_3
    } });
    let rpl = json!({ "plugin": by_rpl, "props": [YOUNG, POISSON, energy, length], "nstatv": 1 });
    let foreign = run(&desk, "cohesive", &strip(by_hetval(&by_source, 2, 0)));
    assert_same_loads(&foreign, &run(&desk, "own", &strip(own)), 1e-6);
    let at2 = run(&desk, "at2", &strip(by_hetval(&by_source, 1, 0)));
    assert_same_loads(&at2, &run(&desk, "rpl", &strip(rpl)), 1e-12);
    let words = &foreign.outcome.stderr;
    assert!(!words.contains("not called"), "{words}");
}

/// Without a field, or where the case says so, nobody calls it; a field without a source stays 0.
#[test]
fn hetval_is_called_where_the_case_has_a_field_that_does_not_leave_it_out() {
    let desk = Desk::new();
    let Some(library) = built(&desk, "phase_field_hetval.for", &[]) else { return };
    let mut case = strip(by_hetval(&library, 1, 0));
    case["steps"][0]["increments"] = json!(2);
    case["field"]["routines"] = json!([]);
    assert_eq!(run(&desk, "left_out", &case).history.last("field_max"), 0.0);
    case.as_object_mut().expect("a case").remove("field");
    let words = run(&desk, "without", &case).outcome.stderr;
    assert!(words.contains("HETVAL is not called") && words.contains("no \"field\""), "{words}");
}

#[test]
fn a_hetval_that_fails_is_named_with_its_place() {
    let desk = Desk::new();
    let Some(library) = built(&desk, "phase_field_hetval.for", &[]) else { return };
    for (error, words) in [
        (4, "FLUX(1) = NaN"),
        (5, "FLUX(3), which has 2 elements"),
        (6, "HETVAL, step 1, increment 1, element 1, integration"),
    ] {
        let case = desk.case("case.json", &strip(by_hetval(&library, 1, error)));
        let outcome = desk.pullout(["run".as_ref(), case.as_os_str()]).expect(1);
        assert!(outcome.stderr.contains(words), "error {error}: {}", outcome.stderr);
    }
}

/// A point shows RPL with FLUX, and keeps what HETVAL writes into STATEV.
#[test]
fn a_point_shows_what_hetval_generates() {
    let desk = Desk::new();
    let Some(library) = built_of(&desk, &["elastic.f", "arrhenius.f90"], &[]) else { return };
    let material = json!({ "plugin": library, "props": [YOUNG, POISSON], "nstatv": 2 });
    let steps = json!([{ "increments": 2, "time": 3.0, "temperature": 1.0, "target": { "e11": 1e-4 } }]);
    let mut case = point(material, "3d", steps);
    case["initial"] = json!({ "statev": [0.7, 0.0] });
    let silent = run(&desk, "silent", &case).outcome.stderr;
    assert!(silent.contains("HETVAL is not called"), "{silent}");
    case["output"] = json!({ "heat": true });
    let history = run(&desk, "shown", &case).history;
    let [middle, end] = [0.5_f64, 1.0].map(|temperature| 0.7 * temperature.exp());
    for name in ["rpl", "drpldt"] {
        close(history.last(name), end);
    }
    close(history.last("sdv2"), 1.5 * (middle + end));
}

#[test]
fn planted_errors_of_hetval_have_their_verdicts() {
    let desk = Desk::new();
    let Some(library) = built(&desk, "phase_field_hetval.for", &[]) else { return };
    let steps = json!([{ "increments": 5, "temperature": 0.6, "target": { "e11": 2e-4 } }]);
    for model in [1, 2] {
        let case = |error: u32| {
            let mut case = point(by_hetval(&library, model, error), "3d", steps.clone());
            case["output"] = json!({ "heat": true });
            case
        };
        for (error, verdict, words) in [
            (0, "pass", "FLUX(1) of HETVAL"),
            (1, "FAIL", "right except for its sign"),
            (2, "FAIL", "0.500 of what it should be"),
            (3, "warn", "left at 0"),
        ] {
            let outcome = checked(&desk, &case(error), i32::from(verdict == "FAIL"));
            let row = row(&outcome, "DRPLDT");
            assert!(row.starts_with(verdict) && row.contains(words), "{verdict} … {words} expected: {row}");
        }
    }
}

/// A law of others may have a source that determines the field, which is known in the run alone.
#[test]
fn a_steady_temperature_that_nothing_determines_is_no_body_that_is_free_to_move() {
    let desk = Desk::new();
    let Some(library) = built(&desk, "elastic.f", &[]) else { return };
    let field = json!({ "kind": "temperature", "fluxes": [{ "edges": "right", "flux": 1 }] });
    let case = desk.case("loose.json", &bar(&library, 10.0, ("Q4", 4), field, json!([{ "increments": 1 }])));
    let words = desk.pullout(["run".as_ref(), case.as_os_str()]).expect(1).stderr;
    assert!(words.contains("it is that of the field"), "{words}");
    assert!(!words.contains("free to move"), "{words}");
}

/// A bar of quadrilaterals, or of those with midside nodes, that is at rest.
fn bar(library: &Value, length: f64, (element, columns): (&str, u32), field: Value, steps: Value) -> Value {
    let material = json!({ "plugin": library, "props": [YOUNG, POISSON], "nstatv": 2 });
    json!({
        "kind": "pullout",
        "mesh": { "specimen": { "type": "beam", "length": length, "height": 1, "cells": [columns, 1], "element": element } },
        "parts": { "beam": { "model": "plane_strain", "thickness": 1, "material": material } },
        "field": field,
        "supports": { "left": {} },
        "steps": steps,
        "output": { "vtu": false, "plots": false },
    })
}

/// θ″ + δ exp θ = 0, θ′(0) = 0, θ(1) = 0: δ = 2 exp(−θ₀) arcosh²(exp(θ₀/2)) (Frank-Kamenetskii 1938).
#[test]
fn a_reacting_slab_heats_itself_as_frank_kamenetskii_says() {
    let desk = Desk::new();
    let Some(library) = built_of(&desk, &["elastic.f", "arrhenius.f90"], &[]) else { return };
    let hottest = 0.8_f64;
    let rate = 2.0 * (-hottest).exp() * (0.5 * hottest).exp().acosh().powi(2);
    let [coarse, fine] = [8, 16].map(|columns| {
        let field = json!({ "kind": "temperature", "fixed": [{ "nodes": "right", "value": 0 }] });
        let mut case = bar(&library, 1.0, ("Q8", columns), field, json!([{ "increments": 1 }]));
        case["parts"]["beam"]["material"]["statev0"] = json!([rate, 0]);
        (run(&desk, &format!("slab{columns}"), &case).history.last("field_max") - hottest).abs()
    });
    let order = (coarse / fine).log2();
    assert!(order > 3.9 && fine < 2e-7, "order {order}, {fine:e}");
}

/// k (1 + b θ): θ + b θ²/2 is linear (Kirchhoff 1894), exactly so at the nodes of linear elements. Each iteration squares the error.
#[test]
fn conduction_that_grows_with_the_temperature_is_kirchhoffs_and_converges_quadratically() {
    let desk = Desk::new();
    let Some(library) = built_of(&desk, &["elastic.f", "conducting.f90"], &[]) else { return };
    let (length, conductivity, growth, flux) = (4.0, 2.5, 0.6, 3.0);
    let bar = |error: u32, tolerance: f64| {
        let field = json!({
            "kind": "temperature", "tolerance": tolerance,
            "umatht": { "props": [conductivity, growth, 1.0, 0.0, error] },
            "fixed": [{ "nodes": "left", "value": 1 }], "fluxes": [{ "edges": "right", "flux": flux }],
        });
        let run = run(&desk, "kirchhoff", &bar(&library, length, ("Q4", 5), field, json!([{ "increments": 1 }])));
        let passes = run.summary["statistics"]["field_passes"].as_u64().expect("a count");
        (run.history.last("field_max"), passes)
    };
    let transformed = 1.0 + 0.5 * growth + flux * length / conductivity;
    let hottest = ((1.0 + 2.0 * growth * transformed).sqrt() - 1.0) / growth;
    let [(_, rough), (_, middle), (found, fine)] = [1e-3, 1e-6, 1e-12].map(|tolerance| bar(0, tolerance));
    close(found, hottest);
    assert!(middle <= rough + 1 && fine <= middle + 1, "{rough} {middle} {fine} passes");
    // without DFDT, or with another DFDG, it gets there by and by
    for error in [1, 2] {
        let (found, passes) = bar(error, 1e-12);
        close(found, hottest);
        assert!(passes > fine + 5, "error {error}: {passes} passes");
    }
}

/// A bar that cools, by UMATHT with U added to and with U set, is the bar of the keys conductivity and capacity.
#[test]
fn what_umatht_stores_is_capacity() {
    let desk = Desk::new();
    let Some(library) = built_of(&desk, &["elastic.f", "conducting.f90"], &[]) else { return };
    let cooled = |name: &str, more: Value| {
        let mut field = json!({ "kind": "temperature", "initial": 20, "fixed": [{ "nodes": "left", "value": 0 }] });
        field.as_object_mut().expect("a field").extend(more.as_object().expect("keys").clone());
        let steps = json!([{ "increments": 10, "time": 2.0 }]);
        run(&desk, name, &bar(&library, 4.0, ("Q8", 6), field, steps)).history.column("field_max")
    };
    let own = cooled("own", json!({ "routines": [], "conductivity": 2.5, "capacity": 0.6 }));
    assert!(own.len() == 11 && own[10] < 0.9 * own[0], "{own:?}");
    for way in [0.0, 1.0] {
        let theirs = cooled("theirs", json!({ "umatht": { "props": [2.5, 0.0, 3.0, way, 0.0], "density": 0.2 } }));
        theirs.iter().zip(&own).for_each(|(theirs, own)| close(*theirs, *own));
    }
}

/// Error, row, verdict, words.
const PLANTED: [(u32, &str, &str, &str); 6] = [
    (1, "DFDT", "warn", "left at 0"),
    (2, "DFDG", "FAIL", "1.250 of what it should be"),
    (6, "DUDT", "FAIL", "0.500 of what it should be"),
    (7, "DUDG", "FAIL", "d(U)/d(DTEMDX1) = 0.0"),
    (8, "DFDT", "FAIL", "right except for its sign"),
    (9, "DFDG", "FAIL", "left at 0"),
];

/// k (1 + b θ) and c θ, with U added to and with U set.
#[test]
fn planted_errors_of_umatht_have_their_verdicts() {
    let desk = Desk::new();
    let Some(library) = built_of(&desk, &["elastic.f", "conducting.f90"], &[]) else { return };
    let rows = ["DUDT", "DUDG", "DFDT", "DFDG"];
    let steps = json!([{ "increments": 5, "temperature": 60.0, "target": { "e11": 2e-4 } }]);
    let mut case = point(json!({ "plugin": library, "props": [YOUNG, POISSON], "nstatv": 2 }), "plane_strain", steps);
    case["temperature"] = json!(20.0);
    let with = |error: u32, way: u32, code: i32| {
        checked_with(&desk, &case, &["--umatht-props", &format!("2.5,0.6,3.0,{way},{error}")], code)
    };
    for way in [0, 1] {
        let outcome = with(0, way, 0);
        for name in rows {
            let row = row(&outcome, name);
            assert!(row.starts_with("pass") && row.contains("on the case's path itself"), "{row}");
        }
    }
    for (error, check, verdict, words) in PLANTED {
        let outcome = with(error, error % 2, i32::from(verdict == "FAIL"));
        for name in rows {
            let row = row(&outcome, name);
            let (verdict, words) = if name == check { (verdict, words) } else { ("pass", "consistent") };
            assert!(row.starts_with(verdict) && row.contains(words), "{error}: {verdict} … {words} expected: {row}");
        }
    }
    let outcome = with(10, 0, 1);
    for name in rows {
        let row = row(&outcome, name);
        assert!(row.starts_with("FAIL") && row.contains("in all states"), "{row}");
    }
    // its parameters are not those of UMAT
    let outcome = checked(&desk, &case, 0);
    let row = row(&outcome, "UMATHT");
    assert!(row.starts_with("info") && row.contains("--umatht-props"), "{row}");
}

/// U and FLUX of the last increment, STATEV, the field and the one before it are in the checkpoint.
#[test]
fn transient_heat_goes_on_from_a_checkpoint_to_the_same_bits() {
    let desk = Desk::new();
    let Some(library) = built_of(&desk, &["elastic.f", "conducting.f90"], &[]) else { return };
    let fields = [
        json!({ "routines": [], "conductivity": 2.5, "capacity": 0.6 }),
        json!({ "umatht": { "props": [2.5, 0.6, 3.0, 0, 0], "density": 0.2 } }),
        json!({ "umatht": { "props": [2.5, 0.6, 3.0, 1, 0], "density": 0.2 } }),
    ];
    for more in fields {
        let mut field = json!({
            "kind": "temperature", "initial": 20, "fixed": [{ "nodes": "left", "value": 0 }],
            "fluxes": [{ "edges": "right", "flux": 3.0, "drive": "heat" }],
        });
        field.as_object_mut().expect("a field").extend(more.as_object().expect("keys").clone());
        let steps = json!([{ "increments": 20, "time": 2.0, "drives": { "heat": 1.0 } }]);
        let mut case = bar(&library, 4.0, ("Q8", 6), field, steps);
        case["output"] = json!({ "plots": false, "vtu": 5 });
        goes_on_from_a_checkpoint(&desk, &desk.case("cooled.json", &case), "13");
    }
}

#[test]
fn a_umatht_that_fails_is_named_and_one_that_asks_for_less_gets_it() {
    let desk = Desk::new();
    let Some(library) = built_of(&desk, &["elastic.f", "conducting.f90"], &[]) else { return };
    let case = |error: u32| {
        let field = json!({
            "kind": "temperature", "umatht": { "props": [2.5, 0.0, 3.0, 0.0, error], "density": 0.2 },
            "fixed": [{ "nodes": "left", "value": 1 }],
        });
        bar(&library, 4.0, ("Q4", 5), field, json!([{ "increments": 1, "time": 1.0 }]))
    };
    for (error, words) in [(3, "FLUX(1) = NaN"), (5, "FLUX(3), which has 2 elements")] {
        let case = desk.case("case.json", &case(error));
        let outcome = desk.pullout(["run".as_ref(), case.as_os_str()]).expect(1);
        assert!(outcome.stderr.contains(words), "error {error}: {}", outcome.stderr);
    }
    let run = run(&desk, "cut", &case(4));
    assert!(run.history.column("time").len() >= 5, "{:?}", run.history.column("time"));
}

/// A library with both: the case names one. Keys that nothing reads are reported.
#[test]
fn a_library_with_both_routines_needs_a_choice() {
    let desk = Desk::new();
    let Some(library) = built_of(&desk, &["elastic.f", "arrhenius.f90", "conducting.f90"], &[]) else { return };
    let info = desk.pullout(["plugin", "info", library.as_str().expect("a path")]).expect(0).stdout;
    assert!(info.contains("HETVAL, UMATHT"), "{info}");
    let printed = |more: Value, code: i32| {
        let mut field = json!({ "kind": "temperature", "fixed": [{ "nodes": "left", "value": 1 }] });
        field.as_object_mut().expect("a field").extend(more.as_object().expect("keys").clone());
        let case = desk.case("case.json", &bar(&library, 4.0, ("Q4", 5), field, json!([{ "increments": 1 }])));
        let outcome = desk.pullout(["check".as_ref(), case.as_os_str()]).expect(code);
        outcome.stdout + &outcome.stderr
    };
    for more in [json!({}), json!({ "routines": ["hetval", "umatht"] })] {
        let words = printed(more, 2);
        assert!(words.contains("$.field.routines: name one"), "{words}");
    }
    let words = printed(json!({ "routines": ["hetval"], "umatht": { "props": [1] } }), 0);
    assert!(words.contains("$.field.umatht: has no effect"), "{words}");
    let words = printed(json!({ "routines": ["umatht"], "umatht": { "props": [1, 0, 0, 0, 0] }, "capacity": 1 }), 0);
    assert!(words.contains("$.field.capacity: has no effect"), "{words}");
}
