//! `pullout plugin build`: what it makes, and what it says where it cannot.

use super::close;
use crate::program::{Desk, command, pullout_in};
use end_to_end_tests::{Tool, find};
use serde_json::json;
use std::path::Path;

/// A UMAT in a few lines: `call` is made in it, `name` is its name.
fn source(name: &str, call: &str) -> String {
    format!(
        "      SUBROUTINE {name}(STRESS,STATEV,DDSDDE,SSE,SPD,SCD,RPL,DDSDDT,\n     1 DRPLDE,DRPLDT,STRAN,DSTRAN)\n      \
         INCLUDE 'aba_param.inc'\n      DIMENSION STRESS(6),DDSDDE(6,6),DSTRAN(6)\n      DO I=1,6\n        \
         DDSDDE(I,I)=100.D0\n        STRESS(I)=STRESS(I)+100.D0*DSTRAN(I)\n      END DO\n{call}      END\n"
    )
}

/// The error of a build that fails.
fn refused(desk: &Desk, sources: &[&str], code: i32) -> String {
    let outcome = desk.pullout(["plugin", "build"].iter().chain(sources)).expect(code);
    assert!(!desk.path("libmine.so").exists(), "nothing half-made is left");
    outcome.stderr
}

#[test]
fn several_sources_make_one_library_under_the_first_ones_name() {
    if [Tool::Fortran, Tool::C, Tool::Cpp].into_iter().any(|tool| find(tool).is_none()) {
        return;
    }
    let desk = Desk::new();
    desk.write("mine.f", &source("UMAT", "      CALL HELPER(STRESS)\n      CALL COUNTS(STRESS)\n"));
    desk.write("helper.c", "void helper_(double *stress) { stress[0] *= 2.0; }\n");
    desk.write(
        "counts.cpp",
        "#include <vector>\nextern \"C\" void counts_(double *s) { std::vector<double> v(3, 0.5); s[0] += v[1] + v[2]; }\n",
    );
    let outcome = desk.pullout(["plugin", "build", "mine.f", "helper.c", "counts.cpp"]).expect(0);
    assert_eq!(outcome.stdout, "libmine.so: umat_\n");
    let case = json!({ "kind": "point", "mode": "3d",
        "material": { "plugin": "./libmine.so", "props": [], "nstatv": 0 },
        "steps": [{ "increments": 1, "target": { "e11": 0.01, "e22": 0, "e33": 0, "g12": 0, "g13": 0, "g23": 0 } }] });
    close(desk.run(&desk.case("case.json", &case), &[], "out", 0).history.last("s11"), 2.0 * 1.0 + 1.0);
    let info = desk.pullout(["plugin", "info", "./libmine.so"]).expect(0).stdout;
    assert!(info.contains("without metadata"), "{info}");
}

#[test]
fn a_form_can_be_told() {
    if find(Tool::Fortran).is_none() {
        return;
    }
    let desk = Desk::new();
    desk.write("mine.f", "subroutine umat(stress)\ndouble precision :: stress(6)\nstress = 1d0\nend subroutine\n");
    let words = refused(&desk, &["mine.f"], 1);
    assert!(words.contains("mine.f:1") && words.contains("--free"), "{words}");
    desk.pullout(["plugin", "build", "--free", "mine.f"]).expect(0);
}

#[test]
fn what_is_undefined_is_named() {
    if find(Tool::Fortran).is_none() {
        return;
    }
    let desk = Desk::new();
    // XIT is offered; the others are not
    let calls = "      CALL XIT\n      CALL KEISER(STRESS)\n      CALL DGETRF(STRESS)\n";
    desk.write("mine.f", &source("UMAT", calls));
    let words = refused(&desk, &["mine.f"], 1);
    assert!(words.contains("libmine.so: not built: undefined symbols: dgetrf_, keiser_; "), "{words}");
}

#[test]
fn a_missing_umat_is_explained() {
    if [Tool::Fortran, Tool::Cpp].into_iter().any(|tool| find(tool).is_none()) {
        return;
    }
    let desk = Desk::new();
    desk.write("mine.f", &source("KUMATX", ""));
    let words = refused(&desk, &["mine.f"], 1);
    assert!(words.contains("none of the symbols umat_") && words.contains("-o libkumatx.so"), "{words}");
    desk.pullout(["plugin", "build", "mine.f", "-o", "libkumatx.so"]).expect(0);
    desk.write("mine.f90", "module m\ncontains\nsubroutine umat(s)\nreal(8) :: s\ns = 1\nend subroutine\nend module\n");
    let words = refused(&desk, &["mine.f90"], 1);
    assert!(words.contains("__m_MOD_umat is a procedure of a MODULE"), "{words}");
    desk.write("mine.cpp", "void umat_(double *s) { *s = 1; }\n");
    let words = refused(&desk, &["mine.cpp"], 1);
    assert!(words.contains("extern \"C\""), "{words}");
    desk.write("mine.f", &source("KOTHER", ""));
    let words = refused(&desk, &["mine.f"], 1);
    assert!(words.contains("SUBROUTINE UMAT"), "{words}");
}

#[test]
fn wrong_sources_are_bad_input() {
    let desk = Desk::new();
    desk.write("mine.py", "");
    assert!(refused(&desk, &["mine.py"], 2).contains("mine.py: its suffix tells no language"));
    assert!(refused(&desk, &["mine.f"], 2).contains("mine.f: "));
    desk.pullout(["plugin", "build"]).expect(2);
    desk.pullout(["plugin", "build", "--free", "--fixed", "mine.f"]).expect(2);
}

#[test]
fn a_compiler_that_is_not_installed_is_named() {
    let desk = Desk::new();
    desk.write("mine.f", &source("UMAT", ""));
    desk.write("empty/nothing", "");
    let mut program = command();
    let output = program
        .current_dir(desk.path("."))
        .env("PATH", desk.path("empty"))
        .args(["plugin", "build", "mine.f"])
        .output()
        .expect("the program starts");
    assert_eq!(output.status.code(), Some(1));
    let words = String::from_utf8_lossy(&output.stderr);
    assert!(words.contains("mine.f: gfortran is needed for it and is not installed"), "{words}");
    let other = pullout_in(Path::new(&desk.path(".")), ["plugin", "info", "./libmine.so"]);
    assert_eq!(other.code, 3);
}
