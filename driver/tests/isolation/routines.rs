//! SDVINI, SIGINI and UEXTERNALDB that misbehave: the message names the routine, and when it was called.

use super::program::{Desk, json};
use end_to_end_tests::{Tool, find};
use serde_json::{Value, json};

#[derive(Clone, Copy)]
enum Fault {
    Exit0 = 1,
    Abort,
    WildPointer,
    EndlessLoop,
}

/// Routine that misbehaves: SDVINI, SIGINI, or UEXTERNALDB with LOP, in a step and an increment.
#[derive(Clone, Copy)]
enum Routine {
    Sdvini,
    Sigini,
    Uexternaldb([u32; 3]),
}

/// Compiles `routines.c` to `libroutines.so`; false where there is no compiler.
fn compiled(desk: &Desk, routine: Routine, fault: Fault) -> bool {
    if find(Tool::C).is_none() {
        return false;
    }
    let (number, [lop, step, increment]) = match routine {
        Routine::Sdvini => (1, [0; 3]),
        Routine::Sigini => (3, [0; 3]),
        Routine::Uexternaldb(at) => (2, at),
    };
    let defined = format!(
        "#define ROUTINE {number}\n#define FAULT {}\n#define AT_LOP {lop}\n#define AT_STEP {step}\n#define AT_INCREMENT \
         {increment}\n",
        fault as u32
    );
    desk.write("routines.c", &(defined + include_str!("routines.c")));
    desk.pullout(["plugin", "build", "routines.c"]).expect(0);
    true
}

fn material() -> Value {
    json!({ "plugin": "./libroutines.so", "props": [], "nstatv": 1, "call_time_limit_s": 1 })
}

/// Two steps of three increments.
fn point() -> Value {
    let steps = json!([
        { "increments": 3, "target": { "e11": 0.003 } },
        { "increments": 3, "target": { "e11": 0.006 } },
    ]);
    json!({ "kind": "point", "title": "Routines", "material": material(), "mode": "3d", "steps": steps })
}

fn plate() -> Value {
    json!({
        "kind": "pullout",
        "title": "A plate",
        "mesh": { "specimen": { "type": "plate_with_hole", "cells": 4, "element": "Q4" } },
        "parts": { "plate": { "material": material() } },
        "grip": { "nodes": "top", "direction": [0, 1], "lateral": "free" },
        "steps": [{ "slip": 0.003, "increments": 3 }, { "slip": 0.006, "increments": 3 }],
        "output": { "plots": false },
    })
}

/// Runs a case that a routine ends; the lines of its history that are finished.
fn ended(desk: &Desk, case: &Value, place: &str, how: &str) -> usize {
    desk.case("case.json", case);
    let outcome = desk.pullout(["run", "--quiet", "--out", "out", "case.json"]).expect(1);
    let summary = json(&desk.path("out/summary.json"));
    let message = summary["message"].as_str().expect("a message");
    for text in [outcome.stderr.as_str(), message] {
        assert!(
            text.contains(&format!("plugin 'routines', {place}: ")) && text.contains(how),
            "{place}, {how}: {text}"
        );
    }
    assert_eq!(summary["status"], "failed");
    // one call of such a routine is no case
    assert!(!desk.path("out/replay.json").exists() && !message.contains("replay"), "{message}");
    let history = std::fs::read_to_string(desk.path("out/history.csv")).unwrap_or_default();
    history.lines().count().saturating_sub(1)
}

const FAULTS: [(Fault, &str); 4] = [
    (Fault::Exit0, "it ended the process instead of returning, exit code 0 (STOP"),
    (Fault::Abort, "signal SIGABRT"),
    (Fault::WildPointer, "signal SIGSEGV"),
    (Fault::EndlessLoop, "did not return within 1 s"),
];

#[test]
fn sdvini_and_sigini() {
    let desk = Desk::new();
    for (routine, name) in [(Routine::Sdvini, "SDVINI"), (Routine::Sigini, "SIGINI")] {
        for (fault, how) in FAULTS {
            if !compiled(&desk, routine, fault) {
                return;
            }
            let place = format!("{name}, element 1, integration point 1");
            assert_eq!(ended(&desk, &point(), &place, how), 0);
            assert_eq!(ended(&desk, &plate(), &place, how), 0);
        }
    }
}

#[test]
fn uexternaldb() {
    let desk = Desk::new();
    for (fault, how) in FAULTS {
        for (at, place, rows) in [
            ([0, 1, 0], "UEXTERNALDB at the start of the analysis (LOP = 0), step 1, increment 0", 0),
            ([1, 2, 2], "UEXTERNALDB at the start of an increment (LOP = 1), step 2, increment 2", 5),
            ([3, 2, 3], "UEXTERNALDB at the end of the analysis (LOP = 3), step 2, increment 3", 7),
        ] {
            if !compiled(&desk, Routine::Uexternaldb(at), fault) {
                return;
            }
            let of_point = ended(&desk, &point(), place, how);
            assert!(of_point >= rows, "{place}: {of_point}");
            let of_plate = ended(&desk, &plate(), place, how);
            assert!(of_plate >= rows, "{place}: {of_plate}");
        }
    }
}

/// STOP in Fortran, in the routine that is called between two others.
#[test]
fn stop_at_the_end_of_an_increment() {
    if find(Tool::Fortran).is_none() {
        return;
    }
    let desk = Desk::new();
    let source = "      SUBROUTINE UMAT(STRESS,STATEV,DDSDDE,SSE,SPD,SCD,RPL,DDSDDT,\n     1 DRPLDE,DRPLDT,STRAN,DSTRAN)\n      \
                  INCLUDE 'ABA_PARAM.INC'\n      DIMENSION STRESS(6),DDSDDE(6,6),DSTRAN(6)\n      DO I=1,6\n        \
                  DDSDDE(I,I)=1.D3\n        STRESS(I)=STRESS(I)+1.D3*DSTRAN(I)\n      END DO\n      END\n      \
                  SUBROUTINE UEXTERNALDB(LOP,LRESTART,TIME,DTIME,KSTEP,KINC)\n      INCLUDE 'ABA_PARAM.INC'\n      \
                  DIMENSION TIME(2)\n      IF (LOP.EQ.2 .AND. KSTEP.EQ.2) STOP\n      END\n";
    desk.write("routines.f", source);
    desk.pullout(["plugin", "build", "routines.f"]).expect(0);
    let place = "UEXTERNALDB at the end of an increment (LOP = 2), step 2, increment 1";
    assert!(ended(&desk, &point(), place, "exit code 0 (STOP") >= 4);
}
