//! `pullout plugin check` on libraries without metadata: errors planted in Fortran are found and named.

use super::{built, point};
use crate::program::{Desk, Outcome};
use end_to_end_tests::{Tool, find, workspace};
use serde_json::json;

/// The report of one planted error (tests/umats/planted.f), in 3-D or another mode.
fn checked(desk: &Desk, library: &serde_json::Value, error: u32, mode: &str, code: i32) -> Outcome {
    let mut material = json!({ "plugin": library, "props": [30e3, 0.2, 2e5, error], "nstatv": 1 });
    if error != 0 && mode != "3d" {
        // else it is called with six components, which have room for what it does
        material["as"] = json!("plane");
    }
    let steps = json!([{ "increments": 1, "target": { "e11": 1e-3 } }]);
    let case = desk.case("case.json", &point(material, mode, steps));
    let path = library.as_str().expect("a path");
    let case = case.to_str().expect("UTF-8");
    let outcome = desk.pullout(["plugin", "check", path, "--case", case, "--states", "40"]).expect(code);
    println!("error {error}, {mode}:\n{}", outcome.stdout);
    outcome
}

/// The row of a check.
pub(super) fn row<'o>(outcome: &'o Outcome, check: &str) -> &'o str {
    let mut rows = outcome.stdout.lines().filter(|line| line.get(6..).is_some_and(|rest| rest.starts_with(check)));
    rows.next().unwrap_or_else(|| panic!("no row '{check}' in\n{}", outcome.stdout))
}

#[test]
fn a_sound_umat_passes() {
    let desk = Desk::new();
    let Some(library) = built(&desk, "planted.f", &[]) else { return };
    for mode in ["3d", "plane_strain", "plane_stress"] {
        let outcome = checked(&desk, &library, 0, mode, 0);
        for check in ["outside arrays", "data between calls", "double precision", "repeated call", "array bounds"] {
            assert!(row(&outcome, check).starts_with("pass"), "{}", row(&outcome, check));
        }
        assert!(row(&outcome, "consistent tangent").contains("consistent;"), "{}", row(&outcome, "consistent tangent"));
    }
}

/// A case whose library is not there, or is another one, is a path for the library that is named.
#[test]
fn a_library_is_checked_along_the_path_of_a_case_that_names_another() {
    let desk = Desk::new();
    let Some(library) = built(&desk, "planted.f", &[]) else { return };
    let path = library.as_str().expect("a path");
    for (other, error, code) in [("./missing.so", 0, 0), ("linear_elastic", 8, 1)] {
        let material = json!({ "plugin": other, "props": [30e3, 0.2, 2e5, error], "nstatv": 1 });
        let steps = json!([{ "increments": 1, "target": { "e11": 1e-3 } }]);
        let case = desk.case("case.json", &point(material, "3d", steps));
        let case = case.to_str().expect("UTF-8");
        let outcome = desk.pullout(["plugin", "check", path, "--case", case, "--states", "20"]).expect(code);
        assert_eq!(row(&outcome, "consistent tangent").starts_with("FAIL"), error == 8, "{}", outcome.stdout);
    }
}

/// Error number, mode, check, verdict, words.
const PLANTED: [(u32, &str, &str, &str, &str); 20] = [
    (1, "3d", "repeated call", "FAIL", "stress"),
    (1, "3d", "data between calls", "warn", "variable count"),
    (2, "3d", "order of calls", "FAIL", "hidden memory"),
    (2, "3d", "data between calls", "warn", "COMMON /KHIDE/"),
    (3, "3d", "data between calls", "warn", "COMMON /KHIDE/"),
    (4, "3d", "outside arrays", "FAIL", "reads PROPS(5), which has 4 elements"),
    (5, "3d", "outside arrays", "FAIL", "writes STATEV(2), which has 1 elements"),
    (5, "3d", "array bounds", "FAIL", "STATEV"),
    (6, "3d", "outside arrays", "FAIL", "reads STATEV(0), which has 1 elements"),
    (7, "3d", "outside arrays", "FAIL", "writes DDSDDE(37), which has 36 elements"),
    (8, "3d", "consistent tangent", "FAIL", "wrong"),
    (9, "3d", "consistent tangent", "warn", "secant-like"),
    (10, "3d", "consistent tangent", "warn", "elastic"),
    (11, "3d", "tangent entries set", "FAIL", "(2,1)"),
    (12, "3d", "double precision", "FAIL", "REAL*4"),
    (15, "3d", "double precision", "FAIL", "stresses jump by"),
    (16, "3d", "answers", "FAIL", "SPD(1) = NaN"),
    (18, "3d", "double precision", "warn", ": an iteration that ends early, single precision somewhere"),
    (14, "plane_strain", "outside arrays", "FAIL", "STRESS(6), which has 4 elements"),
    (
        17,
        "3d",
        "inputs untouched",
        "warn",
        ": writes to COORDS, DFGRD0, DFGRD1, DROT, DSTRAN, PROPS, STRAN, TEMP, TIME",
    ),
];

#[test]
fn every_planted_error_is_found_and_named() {
    let desk = Desk::new();
    let Some(library) = built(&desk, "planted.f", &[]) else { return };
    for (error, mode, check, verdict, words) in PLANTED {
        let fails = PLANTED.iter().any(|other| other.0 == error && other.3 == "FAIL");
        let outcome = checked(&desk, &library, error, mode, i32::from(fails));
        let row = row(&outcome, check);
        assert!(row.starts_with(verdict) && row.contains(words), "error {error}: {row}");
    }
}

/// Stresses are right, the tangent went through REAL*4: the error is 1e-8 or so of it, too little for the differences.
#[test]
fn a_tangent_in_single_precision_is_found() {
    let desk = Desk::new();
    let Some(library) = built(&desk, "planted.f", &[]) else { return };
    let outcome = checked(&desk, &library, 13, "3d", 1);
    let row = row(&outcome, "double precision");
    assert!(row.starts_with("FAIL") && row.contains("DDSDDE has 24 bits") && !row.contains("STRESS"), "{row}");
}

/// A UMAT that takes F33 for 1 in plane stress is no other than the right one at small strains, and has the tangent of what it computes.
#[test]
fn plane_stress_that_forgets_the_thickness_is_found() {
    let desk = Desk::new();
    let Some(library) = built(&desk, "thickness.f90", &[]) else { return };
    let path = library.as_str().expect("a path");
    for (error, code, verdict, words) in [(0, 0, "pass", "as with NTENS 6"), (1, 1, "FAIL", "present thickness")] {
        let material = json!({ "plugin": library, "props": [80.0, 300.0, error], "nstatv": 0 });
        let steps = json!([{ "increments": 5, "target": { "e11": 0.2, "e22": -0.05, "g12": 0.1 } }]);
        let mut case = point(material, "plane_stress", steps);
        case["nlgeom"] = json!(true);
        let case = desk.case("case.json", &case);
        let case = case.to_str().expect("UTF-8");
        let outcome = desk.pullout(["plugin", "check", path, "--case", case, "--states", "40"]).expect(code);
        println!("{}", outcome.stdout);
        let row = row(&outcome, "thickness");
        assert!(row.starts_with(verdict) && row.contains(words), "{row}");
        assert!(self::row(&outcome, "consistent tangent").starts_with("pass"), "{}", outcome.stdout);
    }
}

/// If a UMAT works with the three components of plane stress alone, nothing was compared: that is no pass.
#[test]
fn plane_stress_alone_at_finite_strain_is_not_tested() {
    let desk = Desk::new();
    let source = std::fs::read_to_string(workspace("tests/umats/thickness.f90")).expect("a source");
    let only = "  if (ntens /= 3) call xit\n  mu = props(1)\n";
    let source = desk.write("only.f90", &source.replacen("  mu = props(1)\n", only, 1));
    let Some(_) = find(Tool::Fortran) else { return };
    desk.pullout(["plugin", "build", source.to_str().expect("UTF-8"), "-o", "libonly.so"]).expect(0);
    let material = json!({ "plugin": desk.path("libonly.so"), "props": [80.0, 300.0, 1.0], "nstatv": 0 });
    let mut case = point(material, "plane_stress", json!([{ "increments": 5, "target": { "e11": 0.2 } }]));
    case["nlgeom"] = json!(true);
    let case = desk.case("case.json", &case);
    let [library, case] = [desk.path("libonly.so"), case];
    let arguments = ["plugin", "check", "--states", "40", "--case"].map(AsRef::as_ref).into_iter();
    let outcome = desk.pullout(arguments.chain([case.as_os_str(), library.as_os_str()])).expect(4);
    let row = row(&outcome, "thickness");
    assert!(row.starts_with("void") && row.contains("does not support NTENS 6"), "{row}");
}

/// The report of a contact law (tests/umats/planted_contact.f) with one planted error.
fn contact_checked(
    desk: &Desk,
    library: &serde_json::Value,
    entry: &str,
    slips: usize,
    error: u32,
    code: i32,
) -> Outcome {
    let material = json!({ "plugin": library, "entry": entry, "props": [100.0, 5.0, error], "nstatv": 1 });
    let normal = if entry == "fric" { "p" } else { "gap" };
    let mut target = json!({ "slip": 0.1, normal: 0.01 });
    if slips == 2 {
        target["slip2"] = json!(0.05);
    }
    let case = json!({ "kind": "interface", "material": material, "steps": [{ "increments": 1, "target": target }] });
    let case = desk.case("contact.json", &case);
    let arguments = ["plugin", "check", library.as_str().expect("a path"), "--states", "40", "--case"];
    let outcome = desk.pullout(arguments.iter().map(AsRef::as_ref).chain([case.as_os_str()])).expect(code);
    println!("{entry}, error {error}:\n{}", outcome.stdout);
    outcome
}

/// Errors planted in both contact laws are reported in these words; those of arrays whose lengths follow the tangential
/// directions, with one direction and with two.
#[test]
fn contact_laws_that_leave_their_arrays_are_reported() {
    let desk = Desk::new();
    let Some(library) = built(&desk, "planted_contact.f", &[]) else { return };
    for (entry, slips) in [("uinter", 1), ("uinter", 2), ("fric", 1), ("fric", 2)] {
        let directions = slips + usize::from(entry == "uinter");
        let (slip, tangent) = if entry == "uinter" { ("RDISP", "DDSDDR") } else { ("DGAM", "DDTDDG") };
        let (next, entries) = (directions + 1, directions * directions);
        let sound = contact_checked(&desk, &library, entry, slips, 0, 0);
        assert!(row(&sound, "outside arrays").starts_with("pass"), "{}", row(&sound, "outside arrays"));
        assert!(row(&sound, "consistent tangent").contains("consistent;"), "{}", row(&sound, "consistent tangent"));
        let errors = [
            (1, "reads PROPS(4), which has 3 elements".to_owned()),
            (2, "writes STATEV(2), which has 1 elements".to_owned()),
            (3, "reads STATEV(0), which has 1 elements".to_owned()),
            (4, format!("reads {slip}({next}), which has {directions} elements")),
            (5, format!("writes {tangent}({}), which has {entries} elements", entries + 1)),
            (6, "reads PREDEF(3), which has 2 elements".to_owned()),
        ];
        for (error, words) in errors.into_iter().filter(|(error, _)| slips == 2 || [4, 5].contains(error)) {
            let outcome = contact_checked(&desk, &library, entry, slips, error, 1);
            // where the case cannot even begin, its row has said it: "wrote" in place of "writes"
            let (_, place) = words.split_once(' ').expect("a verb");
            let is_reported = outcome.stdout.lines().any(|row| row.starts_with("FAIL") && row.contains(place));
            assert!(is_reported, "{entry}, error {error}: {}", outcome.stdout);
        }
    }
}

/// The check of elasticity in C with a statement before all others.
fn checked_with(statement: &str, code: i32) -> Option<Outcome> {
    altered("    const int n = *ntens;\n", statement, code)
}

/// Checks elasticity in C with a statement after a line.
fn altered(line: &str, statement: &str, code: i32) -> Option<Outcome> {
    let desk = Desk::new();
    find(Tool::C)?;
    let source = std::fs::read_to_string(workspace("tests/umats/elastic.c")).expect("a source");
    let headers = "#include <stdlib.h>\n#include <unistd.h>\n";
    let source = source.replacen(line, &format!("{line}    {statement}\n"), 1);
    let source = desk.write("altered.c", &format!("{headers}{source}"));
    desk.pullout(["plugin", "build", source.to_str().expect("UTF-8"), "-o", "libaltered.so"]).expect(0);
    let material = json!({ "plugin": "./libaltered.so", "props": [30e3, 0.2], "nstatv": 0 });
    desk.case("case.json", &point(material, "3d", json!([{ "increments": 3, "target": { "e11": 1e-3 } }])));
    let outcome = desk.pullout(["plugin", "check", "./libaltered.so", "--case", "case.json"]).expect(code);
    println!("{}", outcome.stdout);
    Some(outcome)
}

/// A path that ends is reported with its reason, which is no cut-back request if PNEWDT was left alone. If the stress grows in
/// time, another reason is named. NaN for a zero step, which hosts ask for first, is an error of any law.
#[test]
fn reasons_are_the_true_ones() {
    let behind = |statement: &str, code| altered("    *spd = 0.0;\n", statement, code);
    let Some(outcome) = behind("if (dstran[0] == 0.0) stress[0] = 0.0 / 0.0;", 1) else { return };
    let line = row(&outcome, "energy balance");
    assert!(line.contains("no path led to its end: it returned STRESS(1) = NaN"), "{line}");
    for check in ["virgin state", "zero increment"] {
        let line = row(&outcome, check);
        assert!(line.starts_with("FAIL") && line.contains("it returned STRESS(1) = NaN"), "{line}");
    }
    let states = [("100.0 * *dtime", "pass", ""), ("1e-9", "warn", "s11 = -1e-9 after a step of zero, 0e0 before")];
    for (stress, verdict, words) in states {
        let statement = format!("stress[0] -= {stress};");
        let Some(outcome) = behind(&statement, 0) else { return };
        let line = row(&outcome, "virgin state");
        assert!(line.starts_with(verdict) && line.contains(words), "{line}");
        assert_eq!(line.contains("after a step of zero"), verdict == "warn", "{line}");
    }
}

/// A linear law that keeps its strains in STATEV: they move, and every way back undoes them.
#[test]
fn strains_kept_in_states_are_seen() {
    let desk = Desk::new();
    let source = std::fs::read_to_string(workspace("tests/umats/elastic.c")).expect("a source");
    let kept = source.replace("strain = stran[i] + dstran[i];", "strain = (statev[i] += dstran[i]);");
    assert_ne!(kept, source);
    let file = desk.write("kept.c", &kept);
    let Some(library) = built(&desk, file.to_str().expect("UTF-8"), &[]) else { return };
    let material = json!({ "plugin": library, "props": [30e3, 0.2], "nstatv": 6 });
    let case = desk.case("case.json", &point(material, "3d", json!([{ "increments": 3, "target": { "e11": 1e-3 } }])));
    let arguments = ["plugin", "check", library.as_str().expect("a path"), "--case", case.to_str().expect("UTF-8")];
    let outcome = desk.pullout(arguments).expect(0);
    let line = row(&outcome, "nonlinear states");
    assert!(line.starts_with("pass") && line.contains("linear everywhere it was checked"), "{line}");
}

/// A law whose calls take long is looked at as far as the time goes; what was left out is said, and nothing passes for it.
#[test]
fn a_slow_law_is_not_tested_beyond_the_time_for_it() {
    let Some(outcome) = checked_with("sleep(2);", 4) else { return };
    assert!(outcome.stdout.contains("not tested: no time left after"), "{}", outcome.stdout);
    for left_out in ["what a sample of states shows", "DDSDDE", "threads", "increments", "input that makes no sense"] {
        assert!(outcome.stdout.contains(left_out), "{left_out}");
    }
    assert!(outcome.stdout.contains("\nnot tested: "), "{}", outcome.stdout);
}

#[test]
fn a_law_that_ends_in_its_first_increment_is_judged_in_the_virgin_state_only() {
    let Some(outcome) = checked_with("if (dstran[0] != 0.0) exit(3);", 1) else { return };
    assert!(row(&outcome, "case's path").starts_with("FAIL"), "{}", outcome.stdout);
    let row = row(&outcome, "answers");
    assert!(row.starts_with("void") && row.contains("only the virgin state was judged"), "{row}");
}

/// Memory that is full once the case has been run: later calls find it the same, however they follow each other.
#[test]
fn memory_that_is_full_is_found() {
    const STRAIN: &str = "const double e = stran[0] + dstran[0];";
    for memory in [
        "static double most; if (e > most) most = e; const double part = most > 5e-4 ? 5e-4 / most : 1.0;",
        "static int cracked; if (e > 5e-4) cracked = 1; const double part = cracked ? 0.5 : 1.0;",
        // one that begins anew with a run, where the sides have not moved yet, and with no state of the sample
        "static double *most; if (!most) most = calloc(1, sizeof *most); if (*kinc == 1 && dstran[1] == 0.0) *most = 0.0; \
         if (e > *most) *most = e; const double part = *most > 5e-4 ? 5e-4 / *most : 1.0;",
    ] {
        let weaker = "const double weaker[2] = { part * props[0], props[1] }; props = weaker;";
        let Some(outcome) = checked_with(&format!("{STRAIN} {memory} {weaker}"), 1) else { return };
        let row = row(&outcome, "order of calls");
        assert!(row.starts_with("FAIL") && row.contains("hidden memory") && row.contains("gave s11 = "), "{row}");
    }
}

/// Counters that UEXTERNALDB advances in between go on where a case is run again: no error of the law.
#[test]
fn what_uexternaldb_changes_is_no_hidden_memory() {
    let desk = Desk::new();
    let Some(library) = built(&desk, "database.f", &[]) else { return };
    let material = json!({ "plugin": library, "props": [0.2], "nstatv": 4 });
    let case = desk.case("case.json", &point(material, "3d", json!([{ "increments": 3, "target": { "e11": 1e-3 } }])));
    let paths = [library.as_str().expect("a path"), case.to_str().expect("UTF-8")];
    let outcome = desk.pullout(["plugin", "check", paths[0], "--states", "20", "--case", paths[1]]);
    let row = row(&outcome, "order of calls");
    assert!(row.starts_with("pass") && row.contains("UEXTERNALDB"), "{row}");
}

/// Each call finds on the stack what the last one left there, so that it seems to depend on nothing.
#[test]
fn a_variable_that_is_used_before_it_is_set_is_found() {
    // volatile: read from the stack whatever the compiler makes of it; in the middle, where no other call writes
    let unset = "volatile double unset[64]; const double part = unset[32] != 0.0 ? 0.999 : 1.0;";
    let weaker = "const double weaker[2] = { part * props[0], props[1] }; props = weaker;";
    let Some(outcome) = checked_with(&format!("{unset} {weaker}"), 1) else { return };
    let row = row(&outcome, "repeated call");
    assert!(row.starts_with("FAIL") && row.contains("a variable is used before it is set"), "{row}");
}
