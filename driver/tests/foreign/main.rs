//! Anybody's UMAT: sources of different make (tests/umats) built by `pullout plugin build` and run by the program,
//! against closed forms.

mod arguments;
mod build;
mod check;
mod check_around;
mod components;
mod coupling;
mod environment;
mod field;
mod finite_strain;
mod first_errors;
mod frame;
mod full;
mod habits;
mod heat;
mod held;
mod import;
mod kept;
mod lab;
mod parts;
mod prints;
#[path = "../program/mod.rs"]
mod program;
mod public;
mod stress_free;
mod umats;
mod unflagged;
mod utilities;
mod verdicts;
mod watch;

use end_to_end_tests::{Tool, find, workspace};
use program::{Desk, Run};
use serde_json::{Value, json};
use std::path::Path;

/// Two roads to one number differ by rounding; free stresses are met to 1e-8 MPa.
const CLOSE: f64 = 1e-9;

/// A library from a source of tests/umats; `None`, after a notice, where its compiler is not installed.
fn built(desk: &Desk, source: &str, flags: &[&str]) -> Option<Value> {
    built_of(desk, &[source], flags)
}

/// A library from several sources of one language, named after the first.
fn built_of(desk: &Desk, sources: &[&str], flags: &[&str]) -> Option<Value> {
    let first = Path::new(sources[0]);
    let (name, suffix) = (first.file_stem()?.to_str()?, first.extension()?.to_str()?);
    find(match suffix {
        "c" => Tool::C,
        "cpp" => Tool::Cpp,
        _ => Tool::Fortran,
    })?;
    let library = desk.path(&format!("lib{name}.so"));
    let mut arguments = vec!["plugin".into(), "build".into(), "-o".into(), library.clone().into_os_string()];
    arguments.extend(sources.iter().map(|source| workspace("tests/umats").join(source).into_os_string()));
    arguments.extend(flags.iter().map(Into::into));
    let outcome = desk.pullout(arguments).expect(0);
    let entries = [": umat_", ": UMAT", ": uinter_", ": fric_"];
    assert!(entries.iter().any(|entry| outcome.stdout.contains(entry)), "{}", outcome.stdout);
    Some(json!(library))
}

/// A case of steps in 3-D with an elastic material.
fn point(material: Value, mode: &str, steps: Value) -> Value {
    json!({ "kind": "point", "title": "foreign", "material": material, "mode": mode, "steps": steps })
}

fn run(desk: &Desk, name: &str, case: &Value) -> Run {
    desk.run(&desk.case(&format!("{name}.json"), case), &[], name, 0)
}

/// Asserts a number.
#[track_caller]
fn close(found: f64, expected: f64) {
    assert!((found - expected).abs() <= CLOSE * expected.abs().max(1.0), "{found} instead of {expected}");
}
