//! Plugins that end, block or destroy the process that calls them: pullout survives, reports which plugin did what
//! and where, keeps what was finished, and writes a case that repeats it.

mod arguments;
mod libraries;
mod misbehaviour;
mod processes;
#[path = "../program/mod.rs"]
mod program;
mod routines;
mod specimen;
mod trust;
mod untrusted;

use end_to_end_tests::{Tool, find, run, workspace};
use program::{Desk, Run, json};
use serde_json::{Value, json};
use std::path::Path;

/// Faults of `misbehaving.c`.
#[derive(Clone, Copy)]
#[repr(u32)]
enum Fault {
    None,
    Exit0,
    Exit7,
    Abort,
    WildPointer,
    EndlessLoop,
    Stack,
    Trap,
    CloseStdout,
    Print,
    HangAtExit,
    ForkMany,
    ForkApart,
    ForkAndHang,
    TraceItself,
    TraceAndCrash,
    KillGroup,
    ChangeUser,
    FewDescriptors,
    SmallFiles,
}

/// Young's modulus of the sources, MPa.
const MODULUS: f64 = 1000.0;

/// Compiles a source next to this file to `lib<name>.so` on a desk. Returns false if the compiler is missing.
fn compiled(desk: &Desk, source: &str, name: &str) -> bool {
    let tool = if source.ends_with(".c") { Tool::C } else { Tool::Fortran };
    let Some(mut compiler) = find(tool) else { return false };
    let source = workspace("driver/tests/isolation").join(source);
    let flags: &[&str] = match tool {
        Tool::Fortran => &["-fcheck=bounds", "-fstack-arrays", "-J"],
        _ => &["-Wall", "-Wno-infinite-recursion", "-I"],
    };
    let folder = if tool == Tool::C { workspace("umat-abi/include") } else { desk.path("") };
    let library = desk.path(&format!("lib{name}.so"));
    run(compiler.args(["-shared", "-fPIC", "-O1"]).args(flags).arg(folder).arg("-o").arg(library).arg(source));
    true
}

/// A material that makes a fault in step 2, increment 3.
fn material(name: &str, fault: u32) -> Value {
    json!({ "plugin": format!("./lib{name}.so"), "nstatv": 2, "props": [MODULUS, fault, 2, 3] })
}

/// Two steps of five increments each.
fn point(material: Value) -> Value {
    let steps = json!([
        { "increments": 5, "target": { "e11": 0.005 } },
        { "increments": 5, "target": { "e11": 0.01, "e22": -0.002 } },
    ]);
    json!({ "kind": "point", "title": "Misbehaving", "material": material, "mode": "3d", "steps": steps })
}

/// Increments that are finished when the fault is made.
const FINISHED: usize = 7;
const PLACE: &str = "step 2, increment 3";

/// The run fails as expected, with every result that a failing run has, and its replay fails alike.
fn fails_and_replays(desk: &Desk, case: &Path, place: &str, expected: &str) -> Run {
    let failed = |run: &Run| {
        let message = run.summary["message"].as_str().expect("a message").to_owned();
        for text in [place, expected] {
            assert!(run.outcome.stderr.contains(text), "'{text}' is not in {}", run.outcome.stderr);
            assert!(message.contains(text), "'{text}' is not in {message}");
        }
        assert_eq!(run.outcome.stderr.matches(place).count(), 1, "{}", run.outcome.stderr);
        assert_eq!(run.summary["status"], "failed");
        assert_eq!(run.summary["plugin"]["sha256"].as_str().map(str::len), Some(64));
        assert!(run.folder.join("report.html").is_file() && run.folder.join("plots").is_dir());
    };
    let run = desk.run(case, &[], "out", 1);
    failed(&run);
    let mut replay = run.folder.join("replay.json");
    for folder in ["again", "and_again"] {
        let checked = desk.pullout(["check".as_ref(), replay.as_os_str()]).expect(0);
        assert!(checked.stdout.contains("no errors"), "{}", checked.stdout);
        let again = desk.run(&replay, &[], folder, 1);
        failed(&again);
        let next = again.folder.join("replay.json");
        assert_eq!(json(&replay)["title"], json(&next)["title"]);
        assert_eq!(json(&replay)["arguments"], json(&next)["arguments"]);
        assert_eq!(json(&replay)["initial"], json(&next)["initial"]);
        replay = next;
    }
    run
}
