//! Sources in the habits of public ones: each is built without a flag, and judged for what it is.

use super::check::row;
use super::{built, close, point, run};
use crate::program::{Desk, Outcome, command, send};
use end_to_end_tests::{Tool, find, has_library, workspace};
use rustix::process::Signal;
use serde_json::{Value, json};
use std::time::{Duration, Instant};

/// E, nu, a coefficient, an error.
const PROPS: [f64; 4] = [30e3, 0.2, 1e3, 1.0];

/// A tension with shear.
fn solid(library: &Value, props: &[f64]) -> Value {
    let material = json!({ "plugin": library, "props": props, "nstatv": 1 });
    point(material, "3d", json!([{ "increments": 4, "target": { "e11": 1e-3, "g12": 1e-3 } }]))
}

/// A slip under pressure, in a plane.
fn contact(library: &Value, entry: &str, props: &[f64]) -> Value {
    let normal = if entry == "fric" { ("p", 10.0) } else { ("gap", -1e-3) };
    let material = json!({ "plugin": library, "entry": entry, "props": props, "nstatv": 0 });
    let steps = json!([{ "increments": 4, "target": { "slip": 0.02, (normal.0): normal.1 } }]);
    json!({ "kind": "interface", "material": material, "steps": steps })
}

fn checked(desk: &Desk, library: &Value, case: &Value, code: i32) -> Outcome {
    let case = desk.case("case.json", case);
    let arguments = ["plugin", "check", library.as_str().expect("a path"), "--states", "40", "--case"];
    let outcome = desk.pullout(arguments.iter().map(AsRef::as_ref).chain([case.as_os_str()])).expect(code);
    println!("{}", outcome.stdout);
    outcome
}

/// Asserts rows of the report, by their beginnings.
#[track_caller]
fn assert_rows(outcome: &Outcome, rows: &[(&str, &str, &str)]) {
    for (check, verdict, words) in rows {
        let row = row(outcome, check);
        assert!(row.starts_with(verdict) && row.contains(words), "{verdict} … {words} expected: {row}");
    }
}

const CONSISTENT: (&str, &str, &str) = ("consistent tangent", "pass", "consistent");

/// Isotropic elasticity in every dress: E ε along the axis, the tangent its derivative, nothing failed.
fn elastic(source: &str) {
    let desk = Desk::new();
    let Some(library) = built(&desk, source, &[]) else { return };
    let case = solid(&library, &PROPS);
    let run = run(&desk, "case", &case);
    close(run.history.last("s11"), 30.0);
    close(run.history.last("s12"), 12.5);
    assert_rows(&checked(&desk, &library, &case, 0), &[CONSISTENT, ("outside arrays", "pass", "")]);
}

#[test]
fn operators_of_its_own_whose_dots_are_close_to_names() {
    elastic("operators.f90");
}

#[test]
fn procedures_in_submodules() {
    elastic("submodules.f90");
}

#[test]
fn structures_and_records() {
    elastic("structures.for");
}

#[test]
fn implicit_none_before_the_include_that_is_implicit() {
    elastic("typed.for");
}

#[test]
fn lapack_that_nobody_names() {
    if find(Tool::Cpp).is_some() && has_library("LAPACK", &["-llapack", "-lblas"]) {
        elastic("solves_by_lapack.f90");
    }
}

#[test]
fn matrices_of_eigen() {
    if find(Tool::Cpp).is_some() && has_library("Eigen", &["-include", "/usr/include/eigen3/Eigen/Core"]) {
        elastic("eigen.cpp");
    }
}

/// A secant is a choice, and no clean pass: the last line counts it. σ11 = (1 + b q) E ε in uniaxial stress, q = ε:ε.
#[test]
fn free_form_under_the_suffix_of_fixed_form() {
    let desk = Desk::new();
    let Some(library) = built(&desk, "free_form.for", &[]) else { return };
    let case = solid(&library, &PROPS);
    let end = run(&desk, "case", &case).history;
    let strains = ["e11", "e22", "e33", "g12"].map(|name| end.last(name));
    close(end.last("s11"), (1.0 + 1e3 * strains.iter().map(|e| e * e).sum::<f64>()) * 30.0);
    let outcome = checked(&desk, &library, &case, 0);
    assert_rows(&outcome, &[("consistent tangent", "warn", "secant-like")]);
    assert!(
        outcome.stdout.contains(": none failed, 2 warnings: consistent tangent, energy balance"),
        "{}",
        outcome.stdout
    );
    // of the sample more than an order beyond the path: both are reported
    assert!(row(&outcome, "consistent tangent").contains("on the case's path itself 1.8e-3 at most"));
}

/// If both forms have errors, those of the form with fewer are reported, not a thousand of the other.
#[test]
fn errors_are_those_of_the_likelier_form() {
    let desk = Desk::new();
    if find(Tool::Fortran).is_none() {
        return;
    }
    let text = std::fs::read_to_string(workspace("tests/umats/free_form.for")).expect("a source");
    desk.write("wrong.for", &text.replace("factor = 1 +", "factor = one +"));
    let words = desk.pullout(["plugin", "build", "wrong.for"]).expect(1).stderr;
    assert!(words.contains("'one'") && words.contains("in free form"), "{words}");
    assert!(words.lines().count() < 20, "{words}");
}

/// A user element that nothing calls: said in build, info, check and run; and HETVAL, which is called where there is heat.
#[test]
fn what_nobody_calls_is_named_everywhere() {
    let desk = Desk::new();
    let Some(library) = built(&desk, "element_pair.for", &[]) else { return };
    let case = solid(&library, &PROPS);
    let source = workspace("tests/umats/element_pair.for");
    let build = desk.pullout(["plugin", "build", source.to_str().expect("UTF-8"), "-o", "again.so"]).expect(0).stderr;
    let info = desk.pullout(["plugin", "info", library.as_str().expect("a path")]).expect(0).stdout;
    let run = desk.pullout(["run", desk.case("run.json", &case).to_str().expect("UTF-8")]).expect(0).stderr;
    let outcome = checked(&desk, &library, &case, 0);
    for words in [&build, &info, &run, row(&outcome, "other routines")] {
        assert!(words.contains("UEL") && words.contains("not called"), "{words}");
    }
    assert!(info.contains("HETVAL,") && run.contains("HETVAL is not called"), "{info}{run}");
    assert!(outcome.stdout.contains("none failed, 1 warning: other routines"), "{}", outcome.stdout);
}

#[test]
fn a_library_of_explicit_alone_is_reported_as_never_called() {
    let desk = Desk::new();
    if find(Tool::Fortran).is_none() {
        return;
    }
    desk.write("fast.f", "      SUBROUTINE VUMAT(NBLOCK)\n      INTEGER NBLOCK\n      END\n");
    let words = desk.pullout(["plugin", "build", "fast.f"]).expect(1).stderr;
    assert!(words.contains("it has VUMAT, which this program does not call"), "{words}");
}

/// In its own mode nothing is wrong with a wire; with six components it sets one of 36 entries of DDSDDE.
#[test]
fn a_law_of_a_wire() {
    let desk = Desk::new();
    let Some(library) = built(&desk, "wire.f", &[]) else { return };
    let material = json!({ "plugin": library, "props": PROPS, "nstatv": 1 });
    let wire = point(material, "1d", json!([{ "increments": 4, "target": { "e11": 1e-3 } }]));
    close(run(&desk, "case", &wire).history.last("s11"), 30.0);
    let outcome = checked(&desk, &library, &wire, 0);
    assert_rows(
        &outcome,
        &[
            CONSISTENT,
            ("outside arrays", "pass", ""),
            ("tangent entries set", "pass", ""),
            ("energy balance", "pass", ""),
        ],
    );
    assert!(row(&outcome, "consistent tangent").contains("1d, NTENS 1"), "{}", outcome.stdout);
    let outcome = checked(&desk, &library, &solid(&library, &PROPS), 1);
    assert_rows(&outcome, &[("tangent entries set", "FAIL", "35 unset")]);
}

/// UINTER that has three directions whatever NDIR says: τ = k s (1 − s/2 s₀), p = k_n (−gap).
#[test]
fn an_interface_that_knows_space_alone_is_called_so_in_a_plane() {
    let desk = Desk::new();
    let Some(library) = built(&desk, "space_interface.for", &[]) else { return };
    let case = contact(&library, "uinter", &[1e3, 100.0, 0.1]);
    let run = run(&desk, "case", &case);
    close(run.history.last("tau"), 100.0 * 0.02 * (1.0 - 0.5 * 0.02 / 0.1));
    close(run.history.last("p"), 1.0);
    assert!(
        run.outcome.stderr.contains("two slip directions") || run.summary["warnings"].to_string().contains("slip2")
    );
    let outcome = checked(&desk, &library, &case, 0);
    assert_rows(
        &outcome,
        &[CONSISTENT, ("outside arrays", "pass", ""), ("case's path", "warn", "two slip directions")],
    );
    assert!(row(&outcome, "consistent tangent").contains("UINTER, NDIR 3"));
}

/// The same in a specimen: as the law that obeys NDIR, to the last bit, and the summary says it.
#[test]
fn an_interface_that_knows_space_alone_holds_a_fibre() {
    let desk = Desk::new();
    if find(Tool::Fortran).is_none() {
        return;
    }
    let text = std::fs::read_to_string(workspace("tests/umats/space_interface.for")).expect("a source");
    desk.write("space.for", &text);
    let obeys = [
        ("STRESS(3),DDSDDR(3,3),RDISP(3)", "STRESS(NDIR),DDSDDR(NDIR,NDIR),RDISP(NDIR)"),
        ("RDISP(2)**2+RDISP(3)**2", "RDISP(2)**2"),
        ("=1,3\n", "=1,NDIR\n"),
        ("      STRESS(3)=F*RDISP(3)\n", ""),
    ];
    desk.write("plane.for", &obeys.iter().fold(text, |text, (from, to)| text.replace(from, to)));
    let runs = ["space", "plane"].map(|name| {
        let source = desk.path(&format!("{name}.for"));
        let library = desk.path(&format!("{name}.so"));
        let arguments = ["plugin".as_ref(), "build".as_ref(), source.as_os_str(), "-o".as_ref(), library.as_os_str()];
        desk.pullout(arguments).expect(0);
        let elastic = json!({ "plugin": "linear_elastic", "props": { "E": 30e3, "nu": 0.2 } });
        let law = json!({ "plugin": library, "props": [1e4, 100.0, 10.0], "nstatv": 0 });
        let case = json!({
            "kind": "pullout",
            "mesh": { "specimen": crate::program::coarse_fibre() },
            "parts": { "fibre": { "material": elastic }, "matrix": { "material": elastic } },
            "contact": { "law": law, "enforcement": "penalty" },
            "steps": [{ "slip": 0.02, "increments": { "initial": 0.1, "maximum": 0.5 } }],
            "output": { "plots": false, "vtu": false },
        });
        run(&desk, name, &case)
    });
    let [space, plane] = runs.each_ref().map(|run| run.history.last("load"));
    assert!(space > 1.0 && space.to_bits() == plane.to_bits(), "{space} instead of {plane}");
    let [warned, silent] = runs.map(|run| run.summary["warnings"].to_string().contains("two slip directions"));
    assert!(warned && !silent);
}

/// FRIC likewise: τ = k s.
#[test]
fn a_friction_that_knows_space_alone_is_called_so_in_a_plane() {
    let desk = Desk::new();
    let Some(library) = built(&desk, "space_friction.for", &[]) else { return };
    let case = contact(&library, "fric", &[100.0]);
    close(run(&desk, "case", &case).history.last("tau"), 2.0);
    let outcome = checked(&desk, &library, &case, 0);
    assert_rows(
        &outcome,
        &[CONSISTENT, ("outside arrays", "pass", ""), ("case's path", "warn", "two slip directions")],
    );
    assert!(row(&outcome, "consistent tangent").contains("FRIC, NFDIR 2"));
}

#[test]
fn a_tangent_by_rows_and_doubled_shears_have_names() {
    let desk = Desk::new();
    let Some(library) = built(&desk, "by_rows.c", &[]) else { return };
    for (error, code, verdict, words) in
        [(0.0, 0, "pass", "consistent"), (1.0, 1, "FAIL", "stored by rows"), (2.0, 1, "FAIL", "2 mu in place of mu")]
    {
        let outcome = checked(&desk, &library, &solid(&library, &[30e3, 0.2, 1e3, error]), code);
        assert_rows(&outcome, &[("consistent tangent", verdict, words)]);
    }
    let Some(library) = built(&desk, "engineering_shear.f", &[]) else { return };
    // the tangent is that of a wrong stress: 2.5e4 where an isotropic law with C11 - C12 = 2.5e4 has 1.25e4
    let outcome = checked(&desk, &library, &solid(&library, &PROPS), 0);
    assert_rows(&outcome, &[CONSISTENT, ("shear stiffness", "warn", "(C11 - C12)/2 = 1.250000e4")]);
}

#[test]
fn stresses_of_hybrid_elements_are_named() {
    let desk = Desk::new();
    let Some(library) = built(&desk, "hybrid_total.f", &[]) else { return };
    let outcome = checked(&desk, &library, &solid(&library, &PROPS), 1);
    assert_rows(&outcome, &[("outside arrays", "FAIL", "HYBRID FORMULATION=TOTAL")]);
}

/// A law whose state must start at 1, and which writes one too many in every call: it is judged from its own start, SDVINI's or the
/// case's with its initial stress, and the run's message comes first.
#[test]
fn a_case_that_fails_in_its_first_increment_is_judged_from_its_own_start() {
    let desk = Desk::new();
    if find(Tool::Fortran).is_none() {
        return;
    }
    let text = std::fs::read_to_string(workspace("tests/umats/starts_at_one.f90")).expect("a source");
    let without = text.find("subroutine umat").expect("a UMAT");
    desk.write("given.f90", &text[without..]);
    desk.write("sdvini.f90", &text);
    for (name, statev0, stress) in [("sdvini", Value::Null, false), ("given", json!([1]), true)] {
        desk.pullout(["plugin", "build", &format!("{name}.f90"), "-o", &format!("{name}.so")]).expect(0);
        let library = json!(desk.path(&format!("{name}.so")));
        let mut case = solid(&library, &[30e3, 0.2, 0.0]);
        if !statev0.is_null() {
            case["material"]["statev0"] = statev0;
        }
        if stress {
            case["initial"] = json!({ "stress": [-5, -5, -5, 0, 0, 0] });
        }
        let outcome = checked(&desk, &library, &case, 1);
        let first = outcome.stdout.lines().nth(1).expect("a row");
        assert!(first.starts_with("FAIL  case's path") && first.contains("it wrote STATEV(2)"), "{first}");
        // nothing of it is NaN, and the tangent is the one that it is
        assert!(!outcome.stdout.contains("NaN,") && !outcome.stdout.contains("= NaN\n"), "{}", outcome.stdout);
        assert_rows(&outcome, &[CONSISTENT, ("answers", "pass", "40/40")]);
    }
    // a law that never answers is reported once
    let library = json!(desk.path("given.so"));
    let case = solid(&library, &[30e3, 0.2, 0.0]);
    let outcome = checked(&desk, &library, &case, 1);
    assert!(outcome.stdout.contains("1 check: 1 failed"), "{}", outcome.stdout);
}

/// gfortran's message comes with its place in one line, without frames of this program; nothing else is judged.
#[test]
fn an_error_of_the_runtime_is_one_line() {
    let desk = Desk::new();
    if find(Tool::Fortran).is_none() {
        return;
    }
    let text = "subroutine umat(stress)\n  double precision :: stress(6)\n  call knext(stress)\nend\nsubroutine knext(s)\n  double \
                precision :: s(6)\n  real(8), allocatable :: a(:)\n  allocate(a(3))\n  allocate(a(nint(s(1)) + 5))\n  s = \
                a(1)\nend\n";
    desk.write("twice.f90", text);
    desk.pullout(["plugin", "build", "twice.f90", "-o", "twice.so"]).expect(0);
    let library = json!(desk.path("twice.so"));
    let case = solid(&library, &PROPS);
    let outcome = desk.pullout(["run", "--quiet", desk.case("case.json", &case).to_str().expect("UTF-8")]).expect(1);
    let lines: Vec<&str> = outcome.stderr.lines().collect();
    assert_eq!(lines.len(), 1, "{}", outcome.stderr);
    assert!(lines[0].contains("knext, twice.f90:9") && lines[0].contains("Fortran runtime error: "), "{}", lines[0]);
    let outcome = checked(&desk, &library, &case, 1);
    assert!(outcome.stdout.contains("1 check: 1 failed"), "{}", outcome.stdout);
}

/// A call that never returns, and a signal: the run ends within two seconds, and says so once.
#[test]
fn a_signal_ends_a_call_that_hangs() {
    let desk = Desk::new();
    if find(Tool::C).is_none() {
        return;
    }
    desk.write(
        "hangs.c",
        "void umat_(double *stress) { volatile double x = 0; while (x < 1) x *= 0.5; stress[0] = x; }\n",
    );
    desk.pullout(["plugin", "build", "hangs.c", "-o", "hangs.so"]).expect(0);
    let case = desk.case("case.json", &solid(&json!(desk.path("hangs.so")), &PROPS));
    let mut command = command();
    command.current_dir(desk.path("")).args(["run", "--quiet"]).arg(case).stderr(std::process::Stdio::piped());
    let child = command.spawn().expect("it starts");
    // until the first row is there, the call hangs or will
    let rows = desk.path("out/case/history.csv");
    let start = Instant::now();
    while !rows.exists() {
        assert!(start.elapsed() < Duration::from_secs(60), "no rows");
        std::thread::sleep(Duration::from_millis(20));
    }
    let signalled = Instant::now();
    send(Signal::TERM, child.id());
    let output = child.wait_with_output().expect("an end");
    let words = String::from_utf8_lossy(&output.stderr);
    assert_eq!(output.status.code(), Some(143), "{words}");
    assert!(words.contains("it did not return within"), "{words}");
    assert_eq!(words.matches("interrupted by SIGTERM").count(), 1, "{words}");
    // far below the limit of a call, 60 s, also on a busy machine
    assert!(signalled.elapsed() < Duration::from_secs(20), "{:?}", signalled.elapsed());
}

/// A source in place of a library is built into the user's cache, once, and refused where nobody vouches for the case.
#[test]
fn a_source_is_built_where_a_library_is_expected() {
    let desk = Desk::new();
    if find(Tool::Fortran).is_none() {
        return;
    }
    let text = std::fs::read_to_string(workspace("tests/umats/operators.f90")).expect("a source");
    desk.write("law.f90", &text);
    let case = desk.case("case.json", &solid(&json!("law.f90"), &PROPS));
    let cache = desk.path("cache");
    let run = |arguments: &[&str]| {
        let mut command = command();
        command.current_dir(desk.path("")).env("XDG_CACHE_HOME", &cache).args(arguments).arg(&case);
        let output = command.output().expect("it starts");
        (output.status.code(), String::from_utf8_lossy(&output.stderr).into_owned())
    };
    let (code, words) = run(&["run", "--untrusted"]);
    assert!(code == Some(2) && words.contains("$.material.plugin") && words.contains("--untrusted"), "{words}");
    assert!(!cache.exists());
    for is_new in [true, false] {
        let (code, words) = run(&["run"]);
        assert_eq!(code, Some(0), "{words}");
        assert_eq!(words.matches("law.f90: built as ").count(), usize::from(is_new), "{words}");
    }
    let (code, words) = run(&["plugin", "check", "law.f90", "--states", "10", "--case"]);
    assert!(code == Some(0) && !words.contains("built as"), "{words}");
    desk.write("law.f90", &text.replace("2*mu/3", "2*mu/"));
    let (code, words) = run(&["run"]);
    assert!(code != Some(0) && words.contains("$.material.plugin") && words.contains("law.f90"), "{words}");
}

#[test]
fn rows_of_axisymmetry_are_called_so() {
    let desk = Desk::new();
    let Some(library) = built(&desk, "elastic.f", &[]) else { return };
    let mut case = solid(&library, &[30e3, 0.2]);
    case["mode"] = json!("axisymmetric");
    let outcome = checked(&desk, &library, &case, 0);
    assert!(row(&outcome, "consistent tangent").contains("axisymmetric, NTENS 4"), "{}", outcome.stdout);
}

/// The energy of a hyperelastic law is per reference volume unless it is divided by J. The check reports that for any number of
/// increments. J = 1.014 at the end of the path.
#[test]
fn energies_at_finite_strain_have_one_verdict() {
    let desk = Desk::new();
    let Some(library) = built(&desk, "neo_hooke.f90", &[]) else { return };
    for increments in [4, 40, 400] {
        let material = json!({ "plugin": library, "props": [0.8, 40.0], "nstatv": 0 });
        let mut case = point(material, "3d", json!([{ "increments": increments, "target": { "e11": 0.5 } }]));
        case["nlgeom"] = json!(true);
        let outcome = checked(&desk, &library, &case, 0);
        assert_rows(&outcome, &[("energy balance", "warn", "1.000 if per reference volume")]);
    }
}
