//! Plugins that misbehave: pullout reports which and where, and keeps what was finished.
//!
//! The Rust plugins are those of tests/faulty. The C plugin, compiled here, makes errors that no plugin written with the
//! Rust side of the ABI can make.

use crate::program::{Desk, Run, json};
use end_to_end_tests::{Tool, find, run, worst};
use serde_json::{Value, json};
use std::path::PathBuf;

fn tension(material: Value, end: f64, increments: u32) -> Value {
    let steps = json!([
        { "increments": 3, "target": { "e11": 3e-5 } },
        { "increments": increments, "target": { "e11": end } },
    ]);
    json!({ "kind": "point", "title": "tension", "material": material, "mode": "3d", "steps": steps })
}

/// Checks that the run fails and reports plugin, step and increment, and that all finished increments are in every file.
fn fails(desk: &Desk, case: &Value, place: &str, expected: &str) -> Run {
    let run = desk.run(&desk.case("case.json", case), &[], "out", 1);
    let message = run.summary["message"].as_str().expect("a message").to_owned();
    for text in [place, expected] {
        assert!(run.outcome.stderr.contains(text), "'{text}' is not in {}", run.outcome.stderr);
        assert!(message.contains(text), "'{text}' is not in {message}");
    }
    assert_eq!(run.summary["status"], "failed");
    assert_eq!(run.summary["increments"].as_u64(), Some(run.history.rows.len() as u64 - 1));
    assert!(run.history.column("s11").iter().all(|s| s.is_finite()));
    assert!(run.folder.join("report.html").is_file());
    let again = desk.run(&run.folder.join("replay.json"), &[], "again", 1);
    assert!(again.outcome.stderr.contains(expected), "{}", again.outcome.stderr);
    run
}

#[test]
fn a_panic_ends_the_run_where_it_happens() {
    let desk = Desk::new();
    let case = tension(json!({ "plugin": "panicking" }), 6e-4, 20);
    let run = fails(&desk, &case, "plugin 'panicking', step 2, increment ", "PNEWDT");
    assert!(run.outcome.stderr.contains("panicking: internal error"), "{}", run.outcome.stderr);
    // the sound law takes the same path: the finished rows are its rows
    let sound =
        desk.run(&desk.case("sound.json", &tension(json!({ "plugin": "sound_damage" }), 6e-4, 20)), &[], "s", 0);
    let finished = run.history.rows.len();
    assert!((5..sound.history.rows.len()).contains(&finished), "{finished} rows");
    let stress = |run: &Run| run.history.column("s11")[..finished].to_vec();
    let difference = worst(stress(&run).into_iter().zip(stress(&sound)).map(|(a, b)| (a - b).abs()));
    assert!(difference < 1e-12, "{difference}");
}

#[test]
fn a_write_behind_the_states_ends_the_run_at_once() {
    let desk = Desk::new();
    let case = tension(json!({ "plugin": "state_overrun" }), 6e-4, 20);
    let run = fails(&desk, &case, "plugin 'state_overrun', step 1, increment 1", "STATEV");
    assert_eq!(run.history.rows.len(), 1);
    assert_eq!(run.summary["cutbacks"], 0);
}

#[test]
fn wrong_tangents_cost_iterations_but_not_the_answer() {
    let desk = Desk::new();
    let steps = json!([
        { "increments": 10, "target": { "s11": 2.0, "s12": 1.0 } },
        { "increments": 10, "target": { "e11": 3e-4, "s12": 0.0 } },
    ]);
    let run = |plugin: &str| {
        let mut case = tension(json!({ "plugin": plugin }), 0.0, 1);
        case["steps"] = steps.clone();
        desk.run(&desk.case(&format!("{plugin}.json"), &case), &[], plugin, 0)
    };
    let sound = run("sound_damage");
    for plugin in ["secant_tangent", "halved_tangent", "unset_entry", "hidden_memory"] {
        let faulty = run(plugin);
        for column in ["e11", "e22", "g12", "s11", "s12"] {
            let (a, b) = (faulty.history.column(column), sound.history.column(column));
            let scale = b.iter().fold(0.0_f64, |m, x| m.max(x.abs()));
            let difference = worst(a.iter().zip(&b).map(|(a, b)| (a - b).abs()));
            // 1e-8 MPa in stress, and what that makes in strain on a softening branch
            assert!(difference <= 1e-6 * scale + 2e-8, "{plugin}: {column} differs by {difference}");
        }
        println!("{plugin}: {} iterations, sound {}", faulty.summary["iterations"], sound.summary["iterations"]);
    }
}

/// PROPS: the error's number, and the strain 11 beyond which it is made.
const SOURCE: &str = r#"
#include <math.h>
#include <stddef.h>
void umat_(double *stress, double *statev, double *ddsdde, double *sse, double *spd, double *scd,
           double *rpl, double *ddsddt, double *drplde, double *drpldt, const double *stran,
           const double *dstran, const double *time, const double *dtime, const double *temp,
           const double *dtemp, const double *predef, const double *dpred, const char *cmname,
           const int *ndi, const int *nshr, const int *ntens, const int *nstatv, const double *props,
           const int *nprops, const double *coords, const double *drot, double *pnewdt)
{
    const double e = 1000.0;
    const int fault = stran[0] + dstran[0] > props[1] ? (int)props[0] : 0;
    for (int i = 0; i < *ntens; i++) {
        stress[i] = (i < *ndi ? e : 0.5 * e) * (stran[i] + dstran[i]);
        for (int j = 0; j < *ntens; j++)
            ddsdde[i + *ntens * j] = i != j ? 0.0 : i < *ndi ? e : 0.5 * e;
    }
    switch (fault) {
    case 1: stress[0] = NAN; break;
    case 2: stress[1] = INFINITY; break;
    case 3: *pnewdt = 0.1; break;
    case 4: stress[*ntens] = 1.0; break;
    case 5: ddsdde[*ntens * *ntens] = 1.0; break;
    case 6: for (int i = 0; i < *ntens * *ntens; i++) ddsdde[i] = NAN; break;
    case 7: for (int i = 0; i < *ntens * *ntens; i++) ddsdde[i] = (i * 7919) % 13 - 6.0; break;
    case 8: for (int i = 0; i < *ntens * *ntens; i++) ddsdde[i] = 0.0; break;
    case 9: statev[*nstatv] = 1.0; break;
    }
}
"#;

fn compiled(desk: &Desk) -> Option<PathBuf> {
    let mut compiler = find(Tool::C)?;
    let source = desk.write("misbehaving.c", SOURCE);
    let library = desk.path("libmisbehaving.so");
    run(compiler.args(["-shared", "-fPIC", "-O1", "-o"]).arg(&library).arg(source));
    Some(library)
}

/// The C plugin with an error beyond e11 = 0.0045, which increment 5 of 10 passes.
fn misbehaving(fault: u32) -> Value {
    let material = json!({ "plugin": "./libmisbehaving.so", "nstatv": 1, "props": [fault, 0.0045] });
    let steps = json!([ { "increments": 10, "target": { "e11": 0.01 } } ]);
    json!({ "kind": "point", "title": "C", "material": material, "mode": "3d", "steps": steps })
}

#[test]
fn a_c_plugin_that_misbehaves_is_named() {
    let desk = Desk::new();
    if compiled(&desk).is_none() {
        return;
    }
    for (fault, expected) in [
        (1, "returned STRESS(1) = NaN"),
        (2, "returned STRESS(2) = inf"),
        (3, "asks for smaller increments (PNEWDT = 0.1)"),
        (4, "STRESS"),
        (5, "DDSDDE"),
        (9, "STATEV"),
    ] {
        let run = fails(&desk, &misbehaving(fault), "plugin 'misbehaving', step 1, increment 5", expected);
        assert_eq!(run.history.rows.len(), 5, "fault {fault}");
        assert_eq!(run.history.last("e11"), 0.004, "fault {fault}");
    }
}

#[test]
fn a_c_plugin_with_a_useless_tangent_is_driven_all_the_same() {
    let desk = Desk::new();
    if compiled(&desk).is_none() {
        return;
    }
    for fault in [0, 6, 7, 8] {
        let run = desk.run(&desk.case("case.json", &misbehaving(fault)), &[], "out", 0);
        assert!((run.history.last("s11") - 10.0).abs() < 1e-7, "fault {fault}");
        assert!(run.history.column("s22").iter().all(|s| s.abs() < 1e-7), "fault {fault}");
        assert_eq!(json(&run.folder.join("summary.json"))["status"], "done");
    }
}
