//! Typical first errors of a UMAT and pullout's messages about them: a wrong tangent, a missing constant, a write past the end of
//! an input, six components in a check alone, the thickness of plane stress at finite strain.

use super::{built, check, close, point};
use crate::program::{Desk, Run};
use end_to_end_tests::workspace;
use serde_json::{Value, json};

/// Returns `j2_habits.f90` with another text after its tangent, and a material of it.
fn changed(desk: &Desk, name: &str, statements: &str) -> Option<Value> {
    let source = std::fs::read_to_string(workspace("tests/umats/j2_habits.f90")).expect("a source");
    let place = "   statev(1) = statev(1) + multiplier\n";
    assert!(source.contains(place));
    let file = desk.write(&format!("{name}.f90"), &source.replace(place, &format!("{statements}{place}")));
    let library = built(desk, file.to_str().expect("UTF-8"), &[])?;
    Some(json!({ "plugin": library, "props": [200e3, 0.3, 250, 1000, 0, 0, 0], "nstatv": 7 }))
}

fn warnings(run: &Run) -> String {
    let texts = run.summary["warnings"].as_array().expect("a list").iter();
    texts.map(|text| text.as_str().expect("text")).collect::<Vec<_>>().join("\n")
}

const NAN: &str = "   if (multiplier > 0) ddsdde(1) = sqrt(-abs(ddsdde(1)))\n";

#[test]
fn a_tangent_that_is_nan_is_reported() {
    let desk = Desk::new();
    let Some(mut material) = changed(&desk, "nan", NAN) else { return };
    material["tangent"] = json!("compare");
    let confined = json!([{ "increments": 4,
        "target": { "e11": 0.01, "e22": 0, "e33": 0, "g12": 0, "g13": 0, "g23": 0 } }]);
    let run = super::run(&desk, "compared", &point(material, "3d", confined));
    assert!(warnings(&run).contains("DDSDDE has entries that are NaN or infinite"), "{}", warnings(&run));
}

/// Stress control with a tangent that is wrong beyond yielding.
#[test]
fn a_wrong_tangent_is_blamed_for_what_it_does() {
    let desk = Desk::new();
    let beyond = |value: &str| format!("   if (multiplier > 0) ddsdde(1:n*n) = {value}\n");
    let variants = [
        ("nan", NAN.to_owned(), "it returned DDSDDE(1,1) = NaN"),
        ("zero", beyond("0"), "its tangent is wrong: "),
        ("large", beyond("1e6*ddsdde(1:n*n)"), "its tangent is wrong: "),
    ];
    for (name, statements, words) in variants {
        let Some(mut material) = changed(&desk, name, &statements) else { return };
        let pulled = json!([{ "increments": 13, "target": { "s11": 400 } }]);
        let reported = desk.case("case.json", &point(material.clone(), "3d", pulled.clone()));
        let run = desk.run(&reported, &[], name, 1);
        let message = &run.outcome.stderr;
        assert!(message.contains(words), "{name}: {message}");
        assert!(message.contains("\"tangent\": \"numerical\" finds an equilibrium"), "{name}: {message}");
        assert!(!message.contains("peak"), "{name}: {message}");
        material["tangent"] = json!("numerical");
        let run = super::run(&desk, "numerical", &point(material, "3d", pulled));
        close(run.history.last("s11"), 400.0);
    }
}

/// A peak is still called one.
#[test]
fn a_peak_is_not_blamed_on_the_tangent() {
    let desk = Desk::new();
    let Some(mut material) = changed(&desk, "softening", "") else { return };
    material["props"] = json!([200e3, 0.3, 250, -1000, 0, 0, 0]);
    let pulled = json!([{ "increments": 13, "target": { "s11": 300 } }]);
    let run = desk.run(&desk.case("case.json", &point(material, "3d", pulled)), &[], "peak", 1);
    let message = &run.outcome.stderr;
    assert!(message.contains("stress control cannot pass a peak") && !message.contains("tangent"), "{message}");
}

/// PROPS has one constant less than the UMAT reads, whose value makes NaN of the stress.
#[test]
fn a_constant_too_few_is_named() {
    let desk = Desk::new();
    let Some(mut material) = changed(&desk, "few", "   stress(1) = stress(1) + 1e-300*props(nprops + 1)\n") else {
        return;
    };
    let case = point(material.take(), "3d", json!([{ "increments": 2, "target": { "e11": 1e-3 } }]));
    let file = desk.case("case.json", &case);
    let message = desk.run(&file, &[], "few", 1).outcome.stderr;
    assert!(message.contains("STRESS(1) = NaN; it reads PROPS(8), which has 7 elements"), "{message}");
    let library = case["material"]["plugin"].as_str().expect("a path");
    let case = file.to_str().expect("UTF-8");
    let outcome = desk.pullout(["plugin", "check", library, "--case", case, "--states", "20"]).expect(1);
    // reported once: no check that needs an answer follows
    let row = check::row(&outcome, "case's path");
    assert!(row.starts_with("FAIL") && row.contains("reads PROPS(8), which has 7 elements"), "{row}");
    assert!(outcome.stdout.contains("1 check: 1 failed"), "{}", outcome.stdout);
}

/// A UMAT that also stores 2 into an element of an argument.
fn spoilt(desk: &Desk, element: &str) -> Option<Value> {
    let spoil = "subroutine spoil(a, n)\n   real(8) :: a(*)\n   integer :: n\n   a(n) = 2\nend subroutine\n";
    desk.write("spoil.f90", spoil);
    let source = std::fs::read_to_string(workspace("tests/umats/j2_habits.f90")).expect("a source");
    let place = "   statev(1) = statev(1) + multiplier\n";
    let source = source.replace("real(dp), intent(in) :: stran(*)", "external spoil\n   real(dp) :: stran(*)");
    let source = source.replace("predef(*), dpred(*)\n   real(dp), intent(in)", "predef(*), dpred(*)\n   real(dp)");
    let file = desk.write("mine.f90", &source.replace(place, &format!("   call spoil({element})\n{place}")));
    let spoil = desk.path("spoil.f90");
    let library = super::built_of(desk, &[file.to_str().expect("UTF-8"), spoil.to_str().expect("UTF-8")], &[])?;
    let material = json!({ "plugin": library, "props": [200e3, 0.3, 250, 1000, 0, 0, 0], "nstatv": 7 });
    Some(point(material, "3d", json!([{ "increments": 2, "target": { "e11": 1e-3 } }])))
}

/// If inputs lie next to each other, a write past the end of one is a write into the next, and a write before its start a write
/// into the previous one.
#[test]
fn a_write_next_to_an_input_names_both() {
    let desk = Desk::new();
    for (element, words) in [
        ("stran, 7", "writes DSTRAN (or STRAN past its end, where DSTRAN lies), which"),
        ("time, 3", "writes DTIME (or TIME past its end, where DTIME lies), which"),
        ("dstran, 1", "writes DSTRAN (or STRAN past its end, where DSTRAN lies), which"),
        ("dstran, 2", "writes DSTRAN, which"),
        ("dstran, 0", "writes STRAN (or DSTRAN in front of its beginning, where STRAN lies), which"),
        ("coords, 0", "writes DTEMP (or COORDS in front of its beginning, where DTEMP lies), which"),
        (
            "celent, 1",
            "writes CELENT (or DROT past its end, or DFGRD0 in front of its beginning, where CELENT lies), which",
        ),
    ] {
        let Some(case) = spoilt(&desk, element) else { return };
        let run = super::run(&desk, "spoilt", &case);
        assert!(warnings(&run).contains(words), "{element}: {}", warnings(&run));
    }
}

/// A write before the start of the first input, or of an output, is reported as that, not as a write past the end of the array
/// before it.
#[test]
fn a_write_in_front_of_an_argument_names_it() {
    let desk = Desk::new();
    for (element, words) in [
        ("stran, 0", "it wrote STRAN(0), which has 6 elements"),
        ("sse, 0", "it wrote SSE(0), which has 1 elements"),
        ("ddsddt, 0", "it wrote DDSDDT(0), which has 6 elements"),
        ("drplde, 0", "it wrote DRPLDE(0), which has 6 elements"),
        ("pnewdt, 2", "it wrote PNEWDT(2), which has 1 elements"),
    ] {
        let Some(case) = spoilt(&desk, element) else { return };
        let message = desk.run(&desk.case("spoilt.json", &case), &[], "spoilt", 1).outcome.stderr;
        assert!(message.contains(words), "{element}: {message}");
    }
}

/// The cases of a study are checked in their own processes: an error that all of them share is reported once, with their names.
#[test]
fn a_study_reports_what_is_wrong_with_all_runs_once() {
    let desk = Desk::new();
    let Some(library) = built(&desk, "elastic.f", &[]) else { return };
    let material = json!({ "plugin": library, "props": [200e3, 0.3], "nstatv": 1 });
    desk.case("case.json", &point(material, "3d", json!([{ "increments": 2, "target": { "e99": 1e-3 } }])));
    let member = |label: &str, modulus: f64| json!({ "label": label, "set": { "material.props.0": modulus } });
    let members = json!([member("soft", 1e5), member("usual", 2e5), member("stiff", 3e5)]);
    desk.case("study.json", &json!({ "kind": "study", "base": "case.json", "members": members }));
    let printed = desk.pullout(["study", "study.json", "--out", "out"]).expect(2).stderr;
    assert_eq!(printed.matches("$.steps[0].target.e99").count(), 1, "{printed}");
    for run in ["runs/soft", "runs/usual", "runs/stiff"] {
        assert_eq!(printed.matches(&format!("that is the case of {run}\n")).count(), 1, "{printed}");
    }
}

/// A UMAT of six components is checked as it is run: with six, by itself and because the case says so.
#[test]
fn a_umat_of_six_components_is_checked_with_six() {
    let desk = Desk::new();
    let Some(library) = built(&desk, "j2_habits.f90", &[]) else { return };
    for (mode, keys, words) in [
        ("plane_strain", json!({}), "called with NTENS = 6, as a run calls it: with NTENS = 4 it "),
        ("plane_stress", json!({}), "called with NTENS = 6, as a run calls it: with NTENS = 3 it "),
        ("plane_strain", json!({ "as": "3d" }), ""),
    ] {
        let mut material = json!({ "plugin": library, "props": [200e3, 0.3, 250, 1000, 0, 0, 1], "nstatv": 7 });
        for (key, value) in keys.as_object().expect("keys") {
            material[key] = value.clone();
        }
        let steps = json!([{ "increments": 10, "target": { "e11": 0.01, "g12": 0.005 } }]);
        let case = desk.case("case.json", &point(material, mode, steps));
        let arguments = ["plugin", "check", library.as_str().expect("a path"), "--states", "40", "--case"];
        let outcome = desk.pullout(arguments.iter().map(AsRef::as_ref).chain([case.as_os_str()])).expect(0);
        println!("{mode}:\n{}", outcome.stdout);
        let row = check::row(&outcome, "case's path");
        assert!(row.contains(words) && row.starts_with(if words.is_empty() { "info" } else { "warn" }), "{row}");
        for name in ["consistent tangent", "outside arrays", "array bounds"] {
            let row = check::row(&outcome, name);
            assert!(row.starts_with("pass") && row.contains("3D, NTENS 6"), "{row}");
        }
    }
}

/// The thickness of plane stress is found if six components work, asked for or not: no warning, F33 = exp e33, and nominal
/// stresses are the three-dimensional ones with free thickness.
#[test]
fn the_thickness_of_plane_stress_is_known_where_it_is_found() {
    let desk = Desk::new();
    let Some(library) = built(&desk, "neo_hooke.f90", &[]) else { return };
    let case = |mode: &str, keys: &[(&str, Value)], measure: &str| {
        let mut material = json!({ "plugin": library, "props": [80.0, 500.0], "nstatv": 0 });
        for (key, value) in keys {
            material[*key] = value.clone();
        }
        let mut case = point(material, mode, json!([{ "increments": 5, "target": { "e11": 0.4 } }]));
        (case["nlgeom"], case["measure"]) = (json!(true), json!(measure));
        case
    };
    let six = [("as", json!("3d"))];
    for (measure, keys) in [("logarithmic", &six[..]), ("logarithmic", &[]), ("nominal", &six[..]), ("nominal", &[])] {
        let plane = super::run(&desk, "plane", &case("plane_stress", keys, measure));
        let solid = super::run(&desk, "solid", &case("3d", &[], measure));
        assert!(!warnings(&plane).contains("NaN"), "{}", warnings(&plane));
        for column in ["s11", "e22", "e33", "F33"] {
            let (found, expected) = (plane.history.last(column), solid.history.last(column));
            assert!((found - expected).abs() < 1e-7 * expected.abs().max(1.0), "{column}: {found}, not {expected}");
        }
    }
    let three = [("as", json!("plane"))];
    let refused = desk.case("nominal.json", &case("plane_stress", &three, "nominal"));
    let refused = desk.pullout(["check".as_ref(), refused.as_os_str()]).expect(2);
    assert!(refused.stderr.contains("$.measure") && refused.stderr.contains("\"as\": \"3d\""), "{}", refused.stderr);
}

/// A stress that depends on F at the end alone does not depend on the number of increments.
#[test]
fn hyperelasticity_does_not_depend_on_the_size_of_increments() {
    let desk = Desk::new();
    let Some(library) = built(&desk, "neo_hooke.f90", &[]) else { return };
    let material = json!({ "plugin": library, "props": [80.0, 500.0], "nstatv": 0 });
    let mut case = point(material, "3d", json!([{ "increments": 20, "target": { "e11": 0.8 } }]));
    case["nlgeom"] = json!(true);
    let case = desk.case("case.json", &case);
    let arguments = ["plugin", "check", library.as_str().expect("a path"), "--states", "40", "--case"];
    let outcome = desk.pullout(arguments.iter().map(AsRef::as_ref).chain([case.as_os_str()])).expect(0);
    let row = check::row(&outcome, "increment size");
    let figure: f64 =
        row.get(50..).and_then(|rest| rest.split_whitespace().next()).and_then(|x| x.parse().ok()).expect(row);
    assert!(figure < 1e-9, "{row}");
}
