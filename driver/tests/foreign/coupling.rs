//! What a UMAT returns for steps coupled with a temperature, RPL, DDSDDT, DRPLDE and DRPLDT: columns of points against closed forms,
//! and rows of `plugin check` on errors that are planted.

use super::check::row;
use super::{built, close, point, run};
use crate::program::{Desk, Outcome, Run, cases, json as json_of};
use serde_json::{Value, json};

const E: f64 = 200e3;
const NU: f64 = 0.3;
const ALPHA: f64 = 1.2e-5;
/// Yield stress at 20 degrees, its loss for a degree, hardening, heat for work.
const YIELD: f64 = 250.0;
const LOSS: f64 = 1e-3;
const HARDENING: f64 = 2e3;
const ETA: f64 = 0.9;
const MU: f64 = E / (2.0 * (1.0 + NU));
/// −3Kα.
const OF_EXPANSION: f64 = -E * ALPHA / (1.0 - 2.0 * NU);

fn heated(library: &Value, error: u32) -> Value {
    json!({ "plugin": library, "props": [E, NU, ALPHA, YIELD, LOSS, HARDENING, ETA, 20.0, error], "nstatv": 7 })
}

/// A case that shows the columns.
fn shown(material: Value, mode: &str, steps: Value) -> Value {
    let mut case = point(material, mode, steps);
    case["output"] = json!({ "heat": true });
    case["temperature"] = json!(20.0);
    case
}

fn row_at(run: &Run, index: usize, name: &str) -> f64 {
    run.history.column(name)[index]
}

/// Shear at 120 degrees, all other strains held: dp = √3 G Δγ/(3G + H), q = σ_y(T) + H p, RPL = η q dp/dt. Then back, elastically:
/// what the law does not set is 0, not what the call before set.
#[test]
fn heat_of_plastic_work_is_shown_with_its_derivatives() {
    let desk = Desk::new();
    let Some(library) = built(&desk, "heated.f90", &[]) else { return };
    let held = json!({ "e11": 0, "e22": 0, "e33": 0, "g13": 0, "g23": 0 });
    let with = |g12: f64| {
        let mut target = held.clone();
        target["g12"] = json!(g12);
        target
    };
    let steps = json!([
        { "increments": 2, "time": 4.0, "temperature": 120.0, "target": with(0.0) },
        { "increments": 10, "time": 5.0, "target": with(0.02) },
        { "increments": 1, "time": 1.0, "target": with(0.019) },
    ]);
    let run = run(&desk, "sheared", &shown(heated(&library, 0), "3d", steps));
    let at = |index, name| row_at(&run, index, name);
    // held while it grows warm
    close(at(2, "s11"), 100.0 * OF_EXPANSION);
    close(at(2, "ddsddt22"), OF_EXPANSION);
    close(at(2, "rpl"), 0.0);
    let root = 3.0_f64.sqrt();
    let stiffness = 3.0 * MU + HARDENING;
    let plastic = (root * MU * 0.02 - YIELD * (1.0 - 100.0 * LOSS)) / stiffness;
    let stress = YIELD * (1.0 - 100.0 * LOSS) + HARDENING * plastic;
    let increment = root * MU * 0.002 / stiffness;
    close(at(12, "s12"), stress / root);
    close(at(12, "rpl"), ETA * stress * increment / 0.5);
    // dp/dT = σ₀ B/(3G + H), dq/dT = −3G dp/dT
    let softening = YIELD * LOSS / stiffness;
    close(at(12, "drpldt"), ETA / 0.5 * softening * (stress - 3.0 * MU * increment));
    close(at(12, "ddsddt11"), OF_EXPANSION);
    close(at(12, "ddsddt12"), -root * MU * softening);
    // by γ: dp/dγ = √3 G/(3G + H), dq/dγ = H dp/dγ
    let by_shear = root * MU / stiffness;
    close(at(12, "drplde12"), ETA / 0.5 * by_shear * (stress + HARDENING * increment));
    for name in ["drplde11", "drplde13", "ddsddt13"] {
        close(at(12, name), 0.0);
    }
    for name in ["rpl", "drpldt", "drplde12", "ddsddt12"] {
        assert_eq!(at(13, name), 0.0, "{name}");
    }
    close(at(13, "ddsddt33"), OF_EXPANSION);
    // not a word of it where the case does not ask
    let mut silent = shown(heated(&library, 0), "3d", json!([{ "increments": 1, "target": { "e11": 1e-3 } }]));
    silent["output"] = json!({});
    let columns = super::run(&desk, "silent", &silent).history.columns;
    assert!(!columns.iter().any(|name| name == "rpl" || name.starts_with("dd") || name.starts_with("dr")));
}

/// In plane stress through six components ε33 follows the temperature: −Eα/(1 − ν) where nothing yields; and where it does, what the
/// differences of three runs say.
#[test]
fn plane_stress_through_six_components_has_derivatives_of_its_own() {
    let desk = Desk::new();
    let Some(library) = built(&desk, "heated.f90", &[]) else { return };
    let mut material = heated(&library, 0);
    material["as"] = json!("3d");
    let end = |name: &str, temperature: f64, e11: f64, g12: f64| {
        let target = json!({ "e11": e11, "e22": 0.001, "g12": g12 });
        let steps = json!([{ "increments": 1, "time": 2.0, "temperature": temperature, "target": target }]);
        run(&desk, name, &shown(material.clone(), "plane_stress", steps)).history
    };
    let elastic = end("elastic", 30.0, 1e-4, 0.0);
    close(elastic.last("ddsddt11"), -E * ALPHA / (1.0 - NU));
    close(elastic.last("ddsddt33"), 0.0);
    let here = end("here", 90.0, 0.006, 0.004);
    assert!(here.last("rpl") > 0.1);
    let by = |name: &str, sides: [[f64; 3]; 2], width: f64| {
        let [below, above] = sides.map(|[temperature, e11, g12]| end("side", temperature, e11, g12).last(name));
        (above - below) / width
    };
    let heat = [[89.0, 0.006, 0.004], [91.0, 0.006, 0.004]];
    let stretch = [[90.0, 0.00599, 0.004], [90.0, 0.00601, 0.004]];
    let shear = [[90.0, 0.006, 0.00399], [90.0, 0.006, 0.00401]];
    for (column, differences) in [
        ("ddsddt11", by("s11", heat, 2.0)),
        ("ddsddt22", by("s22", heat, 2.0)),
        ("ddsddt12", by("s12", heat, 2.0)),
        ("drpldt", by("rpl", heat, 2.0)),
        ("drplde11", by("rpl", stretch, 2e-5)),
        ("drplde12", by("rpl", shear, 2e-5)),
    ] {
        let found = here.last(column);
        // central differences err by the square of their width
        assert!((found - differences).abs() < 1e-5 * found.abs(), "{column}: {found} instead of {differences}");
    }
}

/// In other axes the same material is the same, and the derivatives have the components of the case.
#[test]
fn local_axes_turn_the_derivatives_back() {
    let desk = Desk::new();
    let Some(library) = built(&desk, "heated.f90", &[]) else { return };
    let steps =
        json!([{ "increments": 3, "temperature": 60.0, "target": { "e11": 0.004, "e22": -0.001, "g12": 0.003 } }]);
    let [plain, turned] = [Value::Null, json!(25.0)].map(|angle| {
        let mut material = heated(&library, 0);
        if !angle.is_null() {
            material["orientation"] = angle;
        }
        run(&desk, "turned", &shown(material, "3d", steps.clone())).history
    });
    assert!(plain.last("rpl") > 0.1 && plain.last("drplde12") > 1.0);
    for name in ["rpl", "drpldt", "ddsddt11", "ddsddt22", "ddsddt33", "ddsddt12", "drplde11", "drplde22", "drplde12"] {
        let (found, expected) = (turned.last(name), plain.last(name));
        assert!((found - expected).abs() < 1e-7 * expected.abs().max(1e-3), "{name}: {found} instead of {expected}");
    }
}

/// `plugin check` with a case.
pub(super) fn checked(desk: &Desk, case: &Value, code: i32) -> Outcome {
    checked_with(desk, case, &[], code)
}

/// The same with more arguments.
pub(super) fn checked_with(desk: &Desk, case: &Value, more: &[&str], code: i32) -> Outcome {
    let library = case["material"]["plugin"].as_str().expect("a path").to_owned();
    let case = desk.case("case.json", case);
    let arguments = ["plugin", "check", &library, "--states", "40", "--case"];
    let words = arguments.iter().map(AsRef::as_ref).chain([case.as_os_str()]);
    let outcome = desk.pullout(words.chain(more.iter().map(AsRef::as_ref))).expect(code);
    println!("{}", outcome.stdout);
    outcome
}

/// A path that grows warm, yields and is sheared.
fn path(material: Value, mode: &str) -> Value {
    let steps = json!([
        { "increments": 10, "time": 5.0, "temperature": 80.0, "target": { "e11": 0.004, "g12": 0.003 } },
        { "increments": 10, "time": 5.0, "temperature": 60.0, "target": { "e11": 0.002, "g12": 0.006 } },
    ]);
    let mut case = point(material, mode, steps);
    case["temperature"] = json!(20.0);
    case
}

/// Error, check, verdict, words.
const PLANTED: [(u32, &str, &str, &str); 7] = [
    (1, "DDSDDT", "FAIL", "right except for its sign"),
    (2, "DDSDDT", "FAIL", "wrong"),
    (3, "DDSDDT", "warn", "left at 0"),
    (4, "DRPLDE", "FAIL", "right except for shears: 2.000"),
    (5, "DRPLDE", "FAIL", "0.500 of what it should be"),
    (6, "DRPLDT", "warn", "left at 0"),
    (8, "DRPLDT", "FAIL", "RPL is NaN"),
];

#[test]
fn planted_errors_of_the_derivatives_have_their_verdicts() {
    let desk = Desk::new();
    let Some(library) = built(&desk, "heated.f90", &[]) else { return };
    for mode in ["3d", "plane_strain"] {
        let outcome = checked(&desk, &path(heated(&library, 0), mode), 0);
        for check in ["consistent tangent", "DDSDDT", "DRPLDE", "DRPLDT"] {
            let row = row(&outcome, check);
            assert!(row.starts_with("pass") && row.contains("on the case's path itself"), "{row}");
        }
    }
    for (error, check, verdict, words) in PLANTED {
        let code = i32::from(verdict == "FAIL");
        let outcome = checked(&desk, &path(heated(&library, error), "3d"), code);
        for other in ["DDSDDT", "DRPLDE", "DRPLDT"] {
            let row = row(&outcome, other);
            let is_planted = other == check || (error == 8 && other == "DRPLDE");
            let (verdict, words) = if is_planted { (verdict, words) } else { ("pass", "consistent") };
            assert!(
                row.starts_with(verdict) && row.contains(words),
                "error {error}: {verdict} … {words} expected: {row}"
            );
        }
    }
    // what writes none of it is not asked for it
    let outcome = checked(&desk, &path(heated(&library, 7), "3d"), 0);
    assert!(!outcome.stdout.contains("DDSDDT") && !outcome.stdout.contains("DRPL"), "{}", outcome.stdout);
}

/// A phase field: RPL = 2(1 − d)H/(G_c l) − d/l² with H the elastic energy and d the temperature; the other blocks are left at 0.
#[test]
fn a_phase_field_in_the_place_of_the_temperature() {
    let desk = Desk::new();
    let Some(library) = built(&desk, "phase_field.f90", &[]) else { return };
    let (young, toughness, length) = (30e3, 0.1, 2.0);
    let material = json!({ "plugin": library, "props": [young, 0.0, toughness, length], "nstatv": 1 });
    let steps = json!([{ "increments": 5, "temperature": 0.6, "target": { "e11": 2e-4 } }]);
    let mut case = point(material, "3d", steps);
    case["output"] = json!({ "heat": true });
    let history = run(&desk, "field", &case).history;
    let energy = 0.5 * young * 2e-4 * 2e-4;
    close(history.last("s11"), (0.16 + 1e-6) * young * 2e-4);
    close(history.last("rpl"), 0.8 * energy / (toughness * length) - 0.6 / (length * length));
    close(history.last("drpldt"), -2.0 * energy / (toughness * length) - 1.0 / (length * length));
    let outcome = checked(&desk, &case, 0);
    for (check, verdict, words) in
        [("DDSDDT", "warn", "left at 0"), ("DRPLDE", "warn", "left at 0"), ("DRPLDT", "pass", "consistent")]
    {
        let row = row(&outcome, check);
        assert!(row.starts_with(verdict) && row.contains(words), "{verdict} … {words} expected: {row}");
    }
}

/// A contact law has no such columns, and the case that repeats a failed increment keeps them.
#[test]
fn the_key_is_of_points_alone_and_stays_in_a_replay() {
    let desk = Desk::new();
    let contact = cases().join("chapter-8/8.1-bond-monotonic-law-a.json");
    let arguments = ["check".as_ref(), contact.as_os_str(), "--set".as_ref(), "output.heat=true".as_ref()];
    let outcome = desk.pullout(arguments).expect(0);
    assert!(format!("{}{}", outcome.stdout, outcome.stderr).contains("$.output.heat"), "{}", outcome.stderr);
    let material = json!({ "plugin": "concrete_damage" });
    let case = shown(material, "3d", json!([{ "increments": 5, "target": { "s11": 4.0 } }]));
    let folder = desk.run(&desk.case("pulled.json", &case), &[], "pulled", 1).folder;
    let replay = json_of(&folder.join("replay.json"));
    assert_eq!(replay["output"], json!({ "heat": true }), "{replay}");
}
