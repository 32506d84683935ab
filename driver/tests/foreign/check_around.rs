//! `pullout plugin check` around the path of a case: laws whose scale, time, temperature, gap or deformation gradient only
//! the case determines.

use super::{built, point};
use crate::program::{Desk, Outcome};
use end_to_end_tests::workspace;
use serde_json::{Value, json};

/// The check of a library with a case.
fn checked(desk: &Desk, library: &Value, case: &Value, code: i32) -> Outcome {
    let case = desk.case("case.json", case);
    let library = library.as_str().expect("a path");
    let arguments = ["plugin", "check", library, "--states", "60", "--case", case.to_str().expect("UTF-8")];
    let outcome = desk.pullout(arguments).expect(code);
    println!("{}", outcome.stdout);
    outcome
}

/// The row of a check.
#[track_caller]
pub(super) fn row<'o>(outcome: &'o Outcome, check: &str) -> &'o str {
    let mut rows = outcome.stdout.lines().filter(|line| line.get(6..).is_some_and(|rest| rest.starts_with(check)));
    rows.next().unwrap_or_else(|| panic!("no row '{check}' in\n{}", outcome.stdout))
}

/// A case of `check_laws.f` in uniaxial tension to 1e-3.
fn tension(library: &Value, props: &[f64], nstatv: usize) -> Value {
    let material = json!({ "plugin": library, "props": props, "nstatv": nstatv });
    point(material, "3d", json!([{ "increments": 20, "target": { "e11": 1e-3 } }]))
}

/// Damage from the strain `threshold` on, with one error.
fn damage(library: &Value, threshold: f64, error: u32) -> Value {
    tension(library, &[1.0, 30e3, 0.2, threshold, f64::from(error)], 2)
}

#[test]
fn a_law_that_was_only_seen_elastic_is_not_tested() {
    let desk = Desk::new();
    let Some(library) = built(&desk, "check_laws.f", &[]) else { return };
    let tested = checked(&desk, &library, &damage(&library, 1e-4, 0), 0);
    assert!(row(&tested, "nonlinear states").starts_with("pass"), "{}", row(&tested, "nonlinear states"));
    assert!(row(&tested, "nonlinear states").contains("19 of 20 increments"), "{}", row(&tested, "nonlinear states"));
    // the same law, a thousand times as strong: kappa moves, but no stress shows it, with a right tangent or a wrong one
    for error in [0, 1, 3] {
        let vacuous = checked(&desk, &library, &damage(&library, 0.1, error), 4);
        let row = row(&vacuous, "nonlinear states");
        assert!(row.starts_with("void") && row.contains("not tested: the stress depends on sdv1"), "{row}");
        assert!(vacuous.stdout.contains("\nnot tested: "), "{}", vacuous.stdout);
    }
    // a case that goes there shows both
    let mut far = damage(&library, 0.1, 0);
    far["steps"][0]["target"]["e11"] = json!(0.5);
    checked(&desk, &library, &far, 0);
    far["material"]["props"][4] = json!(1);
    checked(&desk, &library, &far, 1);
}

/// At finite strain as well the law is looked at beyond the case: rubber that was stretched by a millionth shows a straight
/// line.
#[test]
fn a_hyperelastic_law_that_was_hardly_strained_is_not_tested() {
    let desk = Desk::new();
    let Some(library) = built(&desk, "neo_hooke.f90", &[]) else { return };
    for (strain, code) in [(1e-6, 4), (0.5, 0)] {
        let material = json!({ "plugin": library, "props": [0.8, 40.0], "nstatv": 0 });
        let mut case = point(material, "3d", json!([{ "increments": 5, "target": { "e11": strain } }]));
        case["nlgeom"] = json!(true);
        let outcome = checked(&desk, &library, &case, code);
        let row = row(&outcome, "nonlinear states");
        assert_eq!(row.contains("times what was sampled"), code == 4, "{row}");
    }
}

#[test]
fn a_linear_law_is_linear_everywhere_it_was_looked_at() {
    let desk = Desk::new();
    let Some(library) = built(&desk, "elastic.f", &[]) else { return };
    let outcome = checked(&desk, &library, &tension(&library, &[30e3, 0.2], 1), 0);
    assert!(row(&outcome, "nonlinear states").contains("linear everywhere it was checked"), "{}", outcome.stdout);
}

#[test]
fn a_small_error_is_reported_with_its_size_and_place() {
    let desk = Desk::new();
    let Some(library) = built(&desk, "check_laws.f", &[]) else { return };
    let outcome = checked(&desk, &library, &damage(&library, 1e-4, 1), 1);
    let row = row(&outcome, "consistent tangent");
    assert!(row.contains("the part due to loading is off by 4.0e-4 of itself"), "{row}");
    assert!(row.contains(" increment ") && row.contains("d(s") && row.contains("at e11 = "), "{row}");
    assert!(!row.contains("1.000 of what it should be"), "{row}");
}

/// A tangent that forgets DTIME is right only where DTIME is 1, which it is not in the case.
#[test]
fn the_time_increment_is_that_of_the_case() {
    let desk = Desk::new();
    let Some(library) = built(&desk, "check_laws.f", &[]) else { return };
    for (error, code) in [(0, 0), (1, 1)] {
        let mut case = tension(&library, &[2.0, 30e3, 0.2, 50.0, 0.3, f64::from(error)], 6);
        case["steps"][0]["time"] = json!(400.0);
        let outcome = checked(&desk, &library, &case, code);
        assert!(row(&outcome, "nonlinear states").starts_with("pass"), "{}", row(&outcome, "nonlinear states"));
        let row = row(&outcome, "consistent tangent");
        assert!(row.starts_with(if error == 0 { "pass" } else { "FAIL" }), "{row}");
    }
}

/// The law ends the process at 0 degrees, where nothing of the case is.
#[test]
fn temperatures_are_those_of_the_case() {
    let desk = Desk::new();
    let Some(library) = built(&desk, "check_laws.f", &[]) else { return };
    let mut case = tension(&library, &[3.0, 30e3, 0.2, 1e-5, 1e-3], 0);
    (case["temperature"], case["steps"][0]["temperature"]) = (json!(293.0), json!(393.0));
    let outcome = checked(&desk, &library, &case, 0);
    assert!(row(&outcome, "virgin state").starts_with("pass"), "{}", row(&outcome, "virgin state"));
    assert!(row(&outcome, "consistent tangent").starts_with("pass"), "{}", row(&outcome, "consistent tangent"));
}

/// Free expansion raises no stress but what rounding leaves of two thermal ones: that is not nonlinear.
#[test]
fn free_expansion_is_linear() {
    let desk = Desk::new();
    let Some(library) = built(&desk, "check_laws.f", &[]) else { return };
    let mut case = tension(&library, &[3.0, 30e3, 0.2, 1e-5, 0.0], 0);
    case["temperature"] = json!(293.0);
    let free = json!({ "increments": 10, "target": {}, "temperature": 393.0 });
    case["steps"] = json!([free, { "increments": 10, "target": { "e11": 2e-3 } }]);
    let outcome = checked(&desk, &library, &case, 0);
    let row = row(&outcome, "nonlinear states");
    assert!(row.contains("linear everywhere it was checked") && row.contains("0 of 20 increments"), "{row}");
}

/// The check calls FRIC with the LM that a run calls it with: 1 at first, not 0.
#[test]
fn friction_begins_sticking() {
    let desk = Desk::new();
    let source = std::fs::read_to_string(workspace("tests/umats/contact_with_state.F")).expect("a source");
    let first = "      IF (STATEV(2).EQ.0.D0 .AND. LM.NE.1) CALL XIT\n      STATEV(2)=1.D0\n";
    let source = source.replacen("      AK=PROPS(1)\n", &format!("{first}      AK=PROPS(1)\n"), 1);
    let source = desk.write("begins.F", &source);
    let Some(_) = end_to_end_tests::find(end_to_end_tests::Tool::Fortran) else { return };
    desk.pullout(["plugin", "build", source.to_str().expect("UTF-8"), "-o", "libbegins.so"]).expect(0);
    let library = json!(desk.path("libbegins.so"));
    let case = json!({
        "kind": "interface",
        "title": "friction",
        "material": { "plugin": library, "entry": "fric", "props": [1e3, 0.6, 0.3, 0.05], "nstatv": 2 },
        "steps": [
            { "increments": 5, "target": { "p": 10.0 } },
            { "increments": 20, "target": { "slip": 0.1 } },
        ],
    });
    checked(&desk, &library, &case, 0);
}

/// LM is 0, 1 or 2; the case does not go where it is 3.
#[test]
fn friction_of_no_meaning_is_an_error() {
    let desk = Desk::new();
    let source = std::fs::read_to_string(workspace("tests/umats/contact_with_state.F")).expect("a source");
    let source = source.replacen("      LM=0\n", "      LM=0\n      IF (SLIP(1)+DGAM(1).LT.0.D0) LM=3\n", 1);
    let source = desk.write("means.F", &source);
    let Some(_) = end_to_end_tests::find(end_to_end_tests::Tool::Fortran) else { return };
    desk.pullout(["plugin", "build", source.to_str().expect("UTF-8"), "-o", "libmeans.so"]).expect(0);
    let library = json!(desk.path("libmeans.so"));
    let material = json!({ "plugin": library, "entry": "fric", "props": [1e3, 0.6, 0.3, 0.05], "nstatv": 2 });
    let steps = json!([{ "increments": 5, "target": { "p": 10.0 } }, { "increments": 20, "target": { "slip": 0.1 } }]);
    let case = json!({ "kind": "interface", "material": material, "steps": steps });
    let outcome = checked(&desk, &library, &case, 1);
    let row = row(&outcome, "answers");
    assert!(row.starts_with("FAIL") && row.contains("it returned LM = 3"), "{row}");
}

#[test]
fn no_friction_is_no_error() {
    let desk = Desk::new();
    let Some(library) = built(&desk, "check_contact.f", &[]) else { return };
    let material = json!({ "plugin": library, "entry": "fric", "props": [1.0], "nstatv": 0 });
    let steps = json!([{ "increments": 10, "target": { "slip": 0.1, "p": 5.0 } }]);
    let case = json!({ "kind": "interface", "material": material, "steps": steps });
    let outcome = checked(&desk, &library, &case, 0);
    let row = row(&outcome, "consistent tangent");
    assert!(row.starts_with("pass") && !row.contains("NaN"), "{row}");
}

/// A cohesive crack that begins open and opens farther: its own scale is the case's.
#[test]
fn an_opening_crack_is_looked_at_where_it_opens() {
    let desk = Desk::new();
    let Some(library) = built(&desk, "check_contact.f", &[]) else { return };
    for (error, verdict) in [(0, "pass"), (1, "warn")] {
        let material = json!({ "plugin": library, "entry": "uinter", "props": [1e3, 0.05, error], "nstatv": 1 });
        let steps = json!([{ "increments": 10, "target": { "slip": 0.1, "gap": 0.15 } }]);
        let initial = json!({ "gap": 0.02 });
        let case = json!({ "kind": "interface", "material": material, "initial": initial, "steps": steps });
        let outcome = checked(&desk, &library, &case, 0);
        assert!(row(&outcome, "typical size").contains("penetration 1.50e-1, slip1 1.00e-1"), "{}", outcome.stdout);
        assert!(row(&outcome, "nonlinear states").contains("10 of 10 increments"), "{}", outcome.stdout);
        let row = row(&outcome, "consistent tangent");
        assert!(row.starts_with(verdict), "{row}");
    }
}

/// Neo-Hooke with its own tangent, that of the Cauchy stress, and one with a wrong factor.
#[test]
fn jaumann_tangents_of_hyperelasticity() {
    let desk = Desk::new();
    let source = std::fs::read_to_string(workspace("tests/umats").join("neo_hooke.f90")).expect("a source");
    let last = "*one(l, m)\n    end do";
    let variants = [
        ("right", source.clone(), 0, "consistent with the Jaumann rate of the Kirchhoff stress"),
        (
            "cauchy",
            source.replace(last, "*one(l, m) - stress(a)*one(l, m)\n    end do"),
            0,
            "of the Jaumann rate of the Cauchy stress",
        ),
        ("wrong", source.replace("- 2.0_dp/3.0_dp*(b", "- 1.6_dp/3.0_dp*(b"), 1, "wrong; relative errors"),
    ];
    for (name, text, code, words) in variants {
        assert!(name == "right" || text != source, "{name}");
        let file = desk.write(&format!("{name}.f90"), &text);
        let Some(library) = built(&desk, file.to_str().expect("UTF-8"), &[]) else { return };
        let material = json!({ "plugin": library, "props": [80.0, 500.0], "nstatv": 0 });
        let f = [[1.3, 0.2, 0.0], [0.0, 0.9, 0.0], [0.0, 0.0, 1.1]];
        let mut case = point(material, "3d", json!([{ "increments": 10, "F": f }]));
        case["nlgeom"] = json!(true);
        let outcome = checked(&desk, &library, &case, code);
        assert!(row(&outcome, "consistent tangent").contains(words), "{}", row(&outcome, "consistent tangent"));
        assert!(row(&outcome, "objectivity").starts_with("pass"), "{}", row(&outcome, "objectivity"));
    }
}

/// A law that adds C : DSTRAN, in a case that turns and stretches; and one that is stiffer along axis 1, which does not turn.
#[test]
fn a_small_strain_law_in_a_large_deformation() {
    let desk = Desk::new();
    let source = std::fs::read_to_string(workspace("tests/umats").join("elastic.f")).expect("a source");
    let stiffer = source.replace("   20 CONTINUE\n", "   20 CONTINUE\n      DDSDDE(1,1)=2.0D0*DIAG\n");
    assert_ne!(stiffer, source);
    let strained_by_f =
        stiffer.replace("      RETURN\n", "      STRESS(1)=STRESS(1)+E*(DFGRD1(1,1)-DFGRD0(1,1))\n      RETURN\n");
    assert_ne!(strained_by_f, stiffer);
    for (name, text, code, verdict, words) in [
        ("isotropic", &source, 0, "pass", "F1 = Q F0"),
        ("stiffer", &stiffer, 0, "warn", "(*ORIENTATION in ABAQUS)"),
        ("strained_by_f", &strained_by_f, 1, "FAIL", ", expected ["),
    ] {
        let file = desk.write(&format!("{name}.f"), text);
        let Some(library) = built(&desk, file.to_str().expect("UTF-8"), &[]) else { return };
        let material = json!({ "plugin": library, "props": [100.0, 0.25], "nstatv": 1 });
        let f = [[1.0, 0.8, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
        let mut case = point(material, "3d", json!([{ "increments": 20, "F": f }]));
        case["nlgeom"] = json!(true);
        let outcome = checked(&desk, &library, &case, code);
        let row_of = |check| row(&outcome, check);
        let tangent = row_of("consistent tangent");
        if code == 0 {
            assert!(tangent.contains("consistent with DSTRAN; DFGRD1 is not read"), "{}", outcome.stdout);
        }
        let line = row_of("objectivity");
        assert!(line.starts_with(verdict) && line.contains(words), "{line}");
    }
}

/// The rows of a report as JSON.
fn in_json(desk: &Desk, library: &Value, case: &Value, more: &[&str], code: i32) -> Value {
    let case = desk.case("case.json", case);
    let arguments = ["plugin", "check", "--json", "--states", "60", "--case", case.to_str().expect("UTF-8")];
    let library = library.as_str().expect("a path");
    let outcome = desk.pullout(arguments.into_iter().chain(more.iter().copied()).chain([library])).expect(code);
    serde_json::from_str(&outcome.stdout).unwrap_or_else(|error| panic!("{error}: {}", outcome.stdout))
}

/// The row of a check in a report as JSON.
#[track_caller]
fn json_row<'r>(report: &'r Value, check: &str) -> &'r Value {
    let rows = report["laws"][0]["rows"].as_array().expect("rows");
    rows.iter().find(|row| row["check"] == check).unwrap_or_else(|| panic!("no row '{check}' in {report:#}"))
}

#[test]
fn flags_change_the_case_and_a_report_is_json() {
    let desk = Desk::new();
    let Some(library) = built(&desk, "check_laws.f", &[]) else { return };
    let case = damage(&library, 1e-4, 0);
    let report = in_json(&desk, &library, &case, &[], 0);
    assert_eq!((&report["verdict"], &report["laws"][0]["verdict"]), (&json!("pass"), &json!("pass")));
    assert_eq!(json_row(&report, "consistent tangent")["verdict"], "pass");
    let report = in_json(&desk, &library, &case, &["--props", "1,30e3,0.2,0.1,0"], 4);
    assert_eq!(report["verdict"], "not tested");
    assert_eq!(json_row(&report, "nonlinear states")["verdict"], "not tested");
    in_json(&desk, &library, &case, &["--set", "material.props.3=0.1"], 4);
    let report = in_json(&desk, &library, &case, &["--mode", "plane_stress", "--nstatv", "3"], 0);
    assert_eq!(json_row(&report, "answers")["stress_state"], "plane stress, NTENS 3");
    let report = in_json(&desk, &library, &damage(&library, 1e-4, 1), &[], 1);
    assert_eq!(report["verdict"], "fail");
    // they change a case, and a library without metadata needs one
    let library = library.as_str().expect("a path");
    for flags in [&["--nstatv", "3"][..], &["--props", "1,2"], &[]] {
        let outcome = desk.pullout(["plugin", "check", library].iter().chain(flags)).expect(2);
        assert!(outcome.stderr.contains("--case"), "{}", outcome.stderr);
    }
}

/// A UMAT that ends the process in its five hundredth increment, which only one check makes.
#[test]
fn the_end_of_one_group_is_not_that_of_the_others() {
    let desk = Desk::new();
    let source = std::fs::read_to_string(workspace("tests/umats/elastic.f")).expect("a source");
    let file =
        desk.write("ends.f", &source.replace("      E=PROPS(1)\n", "      E=PROPS(1)\n      IF (KINC.GT.500) STOP\n"));
    let Some(library) = built(&desk, file.to_str().expect("UTF-8"), &[]) else { return };
    desk.write("plugin-check-replay.json", "mine");
    let report = in_json(&desk, &library, &tension(&library, &[30e3, 0.2], 0), &[], 1);
    let row = json_row(&report, "increment size");
    assert_eq!((&row["verdict"], &row["figure"]), (&json!("fail"), &json!("ended")));
    let words = row["detail"].as_str().expect("words");
    // 1 + 10 + 100 increments, then those of the path in 1000
    assert!(words.contains("call 612 of this check: plugin 'ends', step 1, increment 501: it ended"), "{words}");
    for check in ["nonlinear states", "consistent tangent", "outside arrays", "zero increment", "NaN and infinity"] {
        json_row(&report, check);
    }
    assert_eq!(report["laws"][0]["replays"].as_array().map(Vec::len), Some(1));
    // what has the name already stays
    assert_eq!(std::fs::read_to_string(desk.path("plugin-check-replay.json")).expect("a file"), "mine");
    assert!(words.contains("(replay case: plugin-check-replay-2.json)"), "{words}");
    let replayed = desk.pullout(["run", "--quiet", "plugin-check-replay-2.json"]).expect(1);
    assert!(replayed.stderr.contains("increment 501: it ended the process"), "{}", replayed.stderr);
    // a replay that was changed stays, one of the same call is used again
    in_json(&desk, &library, &tension(&library, &[30e3, 0.2], 0), &[], 1);
    assert!(!desk.path("plugin-check-replay-3.json").exists());
    desk.write("plugin-check-replay-2.json", "changed");
    in_json(&desk, &library, &tension(&library, &[30e3, 0.2], 0), &[], 1);
    assert_eq!(std::fs::read_to_string(desk.path("plugin-check-replay-2.json")).expect("a file"), "changed");
    assert!(desk.path("plugin-check-replay-3.json").exists());
}

#[test]
fn an_end_at_input_that_makes_no_sense_is_reported() {
    let desk = Desk::new();
    let Some(library) = built(&desk, "check_laws.f", &[]) else { return };
    let outcome = checked(&desk, &library, &damage(&library, 1e-4, 2), 0);
    let row = row(&outcome, "NaN and infinity");
    assert!(row.starts_with("warn") && row.contains("it ended the process"), "{row}");
    assert!(
        outcome.stdout.contains(": none failed, ") && outcome.stdout.contains("NaN and infinity\n"),
        "{}",
        outcome.stdout
    );
}

/// A law that stops a little beyond its case: the states that lead there are left out, the others are judged.
#[test]
fn states_that_a_law_does_not_survive_are_left_out() {
    let desk = Desk::new();
    let source = std::fs::read_to_string(workspace("tests/umats/check_laws.f")).expect("a source");
    let limited = "        EQ=SQRT(Q)\n        IF (EQ.GT.1.3D-3) STOP\n";
    let file = desk.write("limited.f", &source.replace("        EQ=SQRT(Q)\n", limited));
    let Some(library) = built(&desk, file.to_str().expect("UTF-8"), &[]) else { return };
    let case = desk.case("case.json", &damage(&library, 1e-4, 0));
    let library = library.as_str().expect("a path");
    let arguments = ["plugin", "check", "--states", "60", library, "--case", case.to_str().expect("UTF-8")];
    let outcome = desk.pullout(arguments);
    println!("{}", outcome.stdout);
    assert!(outcome.stdout.contains("ended") && outcome.stdout.contains("state "), "{}", outcome.stdout);
    assert!(row(&outcome, "consistent tangent").contains("consistent;"), "{}", row(&outcome, "consistent tangent"));
}
