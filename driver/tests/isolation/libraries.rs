//! `pullout plugin info` and `check` of libraries that end, block or destroy the process: the program survives them, and
//! what was found before is printed.

use super::program::{Desk, Outcome};
use super::{Fault, compiled, material, point};
use end_to_end_tests::{Tool, find};
use serde_json::{Value, json};

/// A library of a text in C, `libmine.so`; false where there is no compiler.
fn built(desk: &Desk, name: &str, text: &str) -> bool {
    let tool = if name.ends_with(".c") { Tool::C } else { Tool::Fortran };
    if find(tool).is_none() {
        return false;
    }
    desk.write(name, text);
    desk.pullout(["plugin", "build", name, "-o", "libmine.so"]).expect(0);
    true
}

fn checked(desk: &Desk, case: &Value, library: &str, code: i32) -> Outcome {
    desk.case("case.json", case);
    desk.pullout(["plugin", "check", library, "--case", "case.json", "--states", "20"]).expect(code)
}

#[test]
fn a_constructor_that_does_not_return() {
    for (what, how) in [
        ("abort();", "SIGABRT"),
        ("exit(0);", "exit code 0"),
        ("_exit(0);", "exit code 0"),
        ("*(volatile int *)16 = 1;", "SIGSEGV"),
    ] {
        let desk = Desk::new();
        let text = format!(
            "#include <stdlib.h>\n#include <unistd.h>\n__attribute__((constructor)) static void start(void) {{ {what} }}\n\
             void umat_(void) {{}}\n"
        );
        if !built(&desk, "mine.c", &text) {
            return;
        }
        let case = point(json!({ "plugin": "./libmine.so", "props": [], "nstatv": 0 }));
        let outcomes = [
            desk.pullout(["plugin", "info", "./libmine.so"]).expect(3),
            desk.pullout(["plugin", "info", "--abaqus", "./libmine.so"]).expect(3),
            desk.pullout(["plugin", "check", "./libmine.so"]).expect(3),
            checked(&desk, &case, "./libmine.so", 3),
        ];
        for outcome in outcomes {
            let words = outcome.stderr;
            assert!(words.contains("libmine.so: cannot be loaded: ") && words.contains(how), "{what}: {words}");
            assert_eq!(words.lines().count(), 1, "{words}");
        }
    }
}

#[test]
fn a_sound_library_is_reported_as_before() {
    let desk = Desk::new();
    if !compiled(&desk, "misbehaving.c", "misbehaving") {
        return;
    }
    let outcome = desk.pullout(["plugin", "info", "./libmisbehaving.so"]).expect(0);
    assert!(outcome.stdout.contains("without metadata; entry points: umat, uinter, fric;"), "{}", outcome.stdout);
    // by its name, in a folder that only the command line knows
    let outcome = desk.pullout(["plugin", "info", "misbehaving", "--plugin-path", "."]).expect(0);
    assert!(outcome.stdout.contains("libmisbehaving.so: a library without metadata"), "{}", outcome.stdout);
    let outcome = desk.pullout(["plugin", "check", "./libmisbehaving.so"]).expect(2);
    assert!(outcome.stderr.contains("cannot be checked without a --case"), "{}", outcome.stderr);
    let sound = point(material("misbehaving", Fault::None as u32));
    let outcome = checked(&desk, &sound, "./libmisbehaving.so", 0);
    assert!(outcome.stdout.contains(" checks: none failed, 2 warnings: "), "{}", outcome.stdout);
    // the same words where it is called in the program itself
    let arguments = ["plugin", "check", "./libmisbehaving.so", "--case", "case.json", "--states", "20", "--in-process"];
    assert_eq!(desk.pullout(arguments).expect(0).stdout, outcome.stdout);
    let arguments = ["plugin", "info", "./libmisbehaving.so", "--in-process"];
    assert!(desk.pullout(arguments).expect(0).stdout.contains("entry points: umat, uinter, fric;"));
}

/// A plugin that tampers with its own standard output takes nothing from the report.
#[test]
fn a_library_that_closes_the_standard_output() {
    let desk = Desk::new();
    if !compiled(&desk, "misbehaving.c", "misbehaving") {
        return;
    }
    let outcome = checked(&desk, &point(material("misbehaving", Fault::CloseStdout as u32)), "./libmisbehaving.so", 0);
    assert!(outcome.stdout.contains(" checks: none failed, 2 warnings: "), "{}", outcome.stdout);
}

/// A UMAT that executes `statement` beyond a strain of 1e-4 in direction 1.
fn beyond(statement: &str) -> String {
    format!(
        "      SUBROUTINE UMAT(STRESS,STATEV,DDSDDE,SSE,SPD,SCD,RPL,DDSDDT,\n     1 DRPLDE,DRPLDT,STRAN,DSTRAN)\n      \
         INCLUDE 'ABA_PARAM.INC'\n      DIMENSION STRESS(6),DDSDDE(6,6),STRAN(6),DSTRAN(6)\n      \
         IF (STRAN(1)+DSTRAN(1).GT.1.D-4) {statement}\n      DO J=1,6\n        DO I=1,6\n          \
         DDSDDE(I,J)=0.D0\n        END DO\n        DDSDDE(J,J)=1.D3\n        \
         STRESS(J)=STRESS(J)+1.D3*DSTRAN(J)\n      END DO\n      END\n"
    )
}

#[test]
fn a_umat_that_ends_the_check() {
    for (statement, how) in [
        ("STOP", "it ended the process instead of returning, exit code 0 (STOP"),
        ("CALL XIT", "the plugin ended the analysis (it called XIT)"),
        ("CALL ABORT", "signal SIGABRT"),
    ] {
        let desk = Desk::new();
        if !built(&desk, "mine.f", &beyond(statement)) {
            return;
        }
        let case = point(json!({ "plugin": "./libmine.so", "props": [], "nstatv": 0 }));
        let outcome = checked(&desk, &case, "./libmine.so", 1);
        // one row for the cause
        let ends: Vec<&str> = outcome.stdout.lines().filter(|line| line.contains(how)).collect();
        assert!(ends.len() == 1 && ends[0].starts_with("FAIL"), "{statement}: {}", outcome.stdout);
        // what was found before
        assert!(outcome.stdout.contains("pass  virgin state"), "{}", outcome.stdout);
    }
}

#[test]
fn a_umat_that_never_returns_is_ended() {
    let desk = Desk::new();
    if !built(
        &desk,
        "mine.f",
        &beyond("GOTO 7").replace("      DO J=1,6\n", "      GOTO 8\n 7    GOTO 7\n 8    DO J=1,6\n"),
    ) {
        return;
    }
    let case = point(json!({ "plugin": "./libmine.so", "props": [], "nstatv": 0, "call_time_limit_s": 0.5 }));
    let outcome = checked(&desk, &case, "./libmine.so", 1);
    assert!(outcome.stdout.contains("did not return within 0.5 s"), "{}", outcome.stdout);
}
