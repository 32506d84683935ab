//! Cases that another program runs: the same numbers as `pullout run`, no files, and an end when it is wanted.

#[path = "program/mod.rs"]
mod program;

use end_to_end_tests::{Tool, find, run as compile, workspace};
use program::{Desk, cases};
use pullout_case::{JsonPlace, ProblemKind};
use pullout_engine::{CaseSource, Error, Job, Message, Outcome, REPLAY, RunOptions, Settings, set_program};
use pullout_report::history::History;
use pullout_report::summary::Status;
use pullout_run::isolation::Child;
use pullout_run::path::{FailureKind, Row};
use serde_json::{Value, json};
use std::fs;
use std::num::NonZeroUsize;
use std::path::Path;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::sync::{Arc, mpsc};
use std::time::{Duration, Instant};

/// Time in which a run must get under way, on a busy machine too.
const PATIENCE: Duration = Duration::from_secs(60);

/// A case that is not stopped.
fn run(source: CaseSource) -> Outcome {
    let program = Path::new(env!("CARGO_BIN_EXE_pullout"));
    set_program(program, program);
    let prepared = source.read().unwrap_or_else(|errors| panic!("{errors}"));
    prepared.run(Settings::default()).unwrap_or_else(|error| panic!("{error}"))
}

/// Checks that both have the same bits, NaN as well.
fn assert_same(history: &History, file: &Path) {
    let written = History::read(file).expect("a history");
    assert_eq!(history.columns(), written.columns());
    assert_eq!(history.rows(), written.rows());
    for (k, name) in written.columns().iter().enumerate() {
        let bits = |history: &History| -> Vec<u64> {
            history.column_at(k).expect("a column").iter().map(|value| value.to_bits()).collect()
        };
        assert!(bits(history) == bits(&written), "{name}");
    }
}

/// A case file gives in memory what `pullout run` writes.
fn same_as_the_command(case: &Path, overrides: &[&str]) -> Outcome {
    let desk = Desk::new();
    let mut source = CaseSource::file(case);
    source.overrides = overrides.iter().map(|&text| text.to_owned()).collect();
    let outcome = run(source);
    let written = desk.run(case, overrides, "out", 0);
    assert_same(&outcome.history, &written.folder.join("history.csv"));
    let mut summary = serde_json::to_value(&outcome.summary).expect("JSON");
    let mut expected = written.summary;
    for text in [&mut summary, &mut expected] {
        text.as_object_mut().expect("an object").retain(|name, _| !name.contains("time"));
    }
    assert_eq!(summary, expected);
    assert!(outcome.is_done() && !outcome.documents.contains_key(REPLAY));
    outcome
}

#[test]
fn a_material_point() {
    let outcome = same_as_the_command(&cases().join("chapter-4/4.5-compression-plane-strain.json"), &[]);
    assert_eq!(Outcome::unit("s11"), "MPa");
    assert!(outcome.summary.cpu_time_s.is_some_and(|time| time > 0.0));
}

/// Memory that this process has, kB.
fn resident() -> u64 {
    let status = fs::read_to_string("/proc/self/status").expect("Linux");
    let line = status.lines().find_map(|line| line.strip_prefix("VmRSS:")).expect("a line");
    line.trim().trim_end_matches(" kB").parse().expect("a number")
}

/// Memory that runs on two threads, each called from a thread of its own, keep, kB.
fn kept_by(runs: usize, case: &Value) -> u64 {
    let one = |_| {
        let run = || {
            let source = CaseSource::document(case.clone(), &cases());
            let prepared = source.read().unwrap_or_else(|errors| panic!("{errors}"));
            let settings = Settings { threads: NonZeroUsize::new(2), ..Settings::default() };
            assert!(prepared.run(settings).unwrap_or_else(|error| panic!("{error}")).is_done());
        };
        std::thread::scope(|scope| scope.spawn(run).join().expect("a run"));
    };
    (0..200).for_each(one);
    let before = resident();
    (0..runs).for_each(one);
    resident().saturating_sub(before)
}

/// Runs in memory keep none afterwards, however many threads are offered. A pool for each run kept 10 kB: 15 MB here.
#[test]
fn many_runs_take_no_more_memory_than_some() {
    let point = json!({ "kind": "point", "material": { "plugin": "linear_elastic" },
        "steps": [{ "increments": 2, "target": { "e11": 1e-6 } }] });
    let patch = fs::read(cases().join("verification/contact-patch.json")).expect("a case");
    let mut specimen: Value = serde_json::from_slice(&patch).expect("JSON");
    specimen["mesh"]["specimen"] = json!({ "type": "two_blocks", "edges": [2, 1], "rows": [1, 1] });
    for case in [point, specimen] {
        let grown = kept_by(1500, &case);
        assert!(grown < 6000, "{grown} kB: {}", case["kind"]);
    }
}

#[test]
fn a_contact_point() {
    let desk = Desk::new();
    let case = desk.case("bond.json", &bond());
    same_as_the_command(&case, &[]);
}

fn bond() -> Value {
    json!({
        "kind": "interface",
        "material": { "plugin": "bond_slip", "props": { "law": "A", "k_e": 950.0, "a_1": 10.0, "b_1": 0.4 } },
        "steps": [{ "increments": 20, "target": { "slip": 0.5 } }],
    })
}

#[test]
fn a_specimen() {
    let case = cases().join("chapter-6/6.14-plane.json");
    let outcome = same_as_the_command(&case, &["steps.0.slip=0.02", "output.plots=false", "output.vtu=false"]);
    assert!(outcome.summary.specimen.is_some_and(|findings| findings.peak_load.is_some()));
}

#[test]
fn bridging_runs_in_a_child() {
    let outcome = run(CaseSource::file(
        &fs::read_dir(cases().join("bridging"))
            .expect("a folder")
            .flatten()
            .map(|entry| entry.path())
            .filter(|path| path.extension().is_some_and(|extension| extension == "json"))
            .min()
            .expect("a case"),
    ));
    assert!(
        outcome.history.column("w").or(outcome.history.column("opening")).is_some(),
        "{:?}",
        outcome.history.columns()
    );
    assert!(outcome.summary.bridging.is_some());
}

#[test]
fn a_document_names_files_relative_to_its_folder() {
    let desk = Desk::new();
    desk.write("measured.csv", "slip,tau\n0.0,0.0\n0.25,5.0\n0.5,6.0\n");
    let mut case = bond();
    case["compare"] = json!([{ "file": "measured.csv", "x": "slip", "y": "tau", "file_x": "slip", "file_y": "tau" }]);
    let outcome = run(CaseSource::document(case, &desk.path("")));
    assert_eq!(outcome.summary.compare[0].points, 3);
    assert_eq!(outcome.summary.title, "case");
}

#[test]
fn what_is_wrong_has_its_place() {
    // structure first, then meaning
    for (overrides, expected) in [
        (["steps.0.increments=-1", "material.props.k=3"], vec!["$.steps[0].increments"]),
        (["steps.0.increments=2", "material.props.k=3"], vec!["$.material.props.k"]),
    ] {
        let mut source = CaseSource::document(bond(), Path::new(""));
        source.overrides = overrides.map(String::from).to_vec();
        let errors = source.read().expect_err("errors");
        let places: Vec<&str> =
            errors.problems.iter().map(|problem| problem.place.as_ref().expect("a place").as_str()).collect();
        assert_eq!(places, expected);
    }
    let desk = Desk::new();
    desk.case("case.json", &bond());
    desk.case("study.json", &json!({ "kind": "study", "base": "case.json", "members": [{ "label": "a" }] }));
    desk.write("commented.json", "{\n  // of steel\n}");
    let found = |file: &str| {
        let problems = CaseSource::file(&desk.path(file)).read().expect_err("an error").problems;
        let [problem] = &problems[..] else { panic!("{problems:?}") };
        (problem.kind, problem.place.as_ref().map(|place| place.as_str().to_owned()))
    };
    assert_eq!(found("commented.json"), (ProblemKind::Input, None));
    assert_eq!(found("study.json"), (ProblemKind::Structure, Some("$.kind".to_owned())));
}

#[test]
fn a_run_that_fails_keeps_its_rows_and_can_be_repeated() {
    let case = json!({
        "kind": "point", "mode": "3d",
        "material": { "plugin": "j2_plasticity", "props": { "E": 200000.0, "nu": 0.3, "hardening": [[275.0, 0.0]] } },
        // beyond yield no equilibrium
        "steps": [{ "increments": 10, "target": { "s11": 500.0 } }],
    });
    let outcome = run(CaseSource::document(case, Path::new("")));
    assert_eq!(outcome.summary.status, Status::Failed);
    let failed_at = outcome.summary.failed_at.expect("a place");
    assert_eq!((failed_at.kind, failed_at.step, failed_at.increment), (FailureKind::Failed, 1, 6));
    assert_eq!(outcome.history.rows(), 6);
    let again = run(CaseSource::document(outcome.documents[REPLAY].clone(), Path::new("")));
    assert_eq!(again.summary.status, Status::Failed);
}

/// Runs a case, and sets its flag from another thread as soon as the run reports that it is under way.
fn stopped(source: CaseSource) -> (Outcome, Duration) {
    let program = Path::new(env!("CARGO_BIN_EXE_pullout"));
    set_program(program, program);
    let prepared = source.read().unwrap_or_else(|errors| panic!("{errors}"));
    let stop = Arc::new(AtomicBool::new(false));
    let (reports, reported) = mpsc::channel();
    let listener = Box::new(move |part, _: &Row<'_>| reports.send(part).unwrap_or_default());
    let settings = Settings { stop: Arc::clone(&stop), listener: Some(listener), ..Settings::default() };
    std::thread::scope(|scope| {
        let run = scope.spawn(|| prepared.run(settings));
        while reported.recv_timeout(PATIENCE).expect("an increment in time") == 0.0 {}
        stop.store(true, Ordering::Relaxed);
        let asked = Instant::now();
        let outcome = run.join().expect("no panic").unwrap_or_else(|error| panic!("{error}"));
        (outcome, asked.elapsed())
    })
}

#[test]
fn another_thread_ends_a_run() {
    let mut point = bond();
    point["steps"][0]["increments"] = json!(20_000_000);
    point["output"] = json!({ "every": 1_000_000 });
    let (outcome, waited) = stopped(CaseSource::document(point, Path::new("")));
    assert_eq!(outcome.summary.status, Status::Interrupted);
    assert!(waited < PATIENCE / 6, "{waited:?}");

    let mut specimen = CaseSource::file(&cases().join("chapter-7/inclined-fibre.json"));
    specimen.overrides = vec!["output.plots=false".into()];
    let (outcome, waited) = stopped(specimen);
    assert_eq!(outcome.summary.status, Status::Interrupted);
    assert!(outcome.history.rows() > 0);
    assert!(waited < PATIENCE / 6, "{waited:?}");
}

#[test]
fn a_listener_hears_how_far_it_is() {
    let mut point = bond();
    point["steps"][0]["increments"] = json!(300_000);
    let heard = Arc::new(AtomicU64::new(0));
    let counts = Arc::clone(&heard);
    let settings = Settings {
        listener: Some(Box::new(move |part, row| {
            assert!((0.0..=1.0).contains(&part) && row.step == 1);
            counts.fetch_add(1, Ordering::Relaxed);
        })),
        ..Settings::default()
    };
    let prepared = CaseSource::document(point, Path::new("")).read().expect("a case");
    assert!(prepared.run(settings).expect("a run").is_done());
    assert!(heard.load(Ordering::Relaxed) > 2);
}

/// The misbehaving plugin of the tests of isolation; `fault` in step 1, increment 3.
fn misbehaving(desk: &Desk, fault: u32) -> Option<Value> {
    let mut compiler = find(Tool::C)?;
    let source = workspace("driver/tests/isolation/misbehaving.c");
    let include = workspace("umat-abi/include");
    let library = desk.path("libmisbehaving.so");
    compile(compiler.args(["-shared", "-fPIC", "-O1", "-I"]).arg(include).arg("-o").arg(library).arg(source));
    Some(json!({
        "kind": "point", "mode": "3d",
        "material": { "plugin": "./libmisbehaving.so", "nstatv": 2, "props": [1000.0, fault, 1, 3],
                      "call_time_limit_s": 1.0 },
        "steps": [{ "increments": 5, "target": { "e11": 0.005 } }],
    }))
}

#[test]
fn libraries_of_others_run_in_a_child() {
    let desk = Desk::new();
    for (fault, kind) in
        [(0, None), (1, Some(FailureKind::Crashed)), (4, Some(FailureKind::Crashed)), (5, Some(FailureKind::Timeout))]
    {
        let Some(case) = misbehaving(&desk, fault) else { return };
        let source = CaseSource::document(case, &desk.path(""));
        assert!(source.need().is_some());
        let outcome = run(source);
        assert_eq!(outcome.summary.failed_at.map(|at| (at.kind, at.step, at.increment)), kind.map(|kind| (kind, 1, 3)));
        assert_eq!(outcome.documents.contains_key(REPLAY), kind.is_some());
        let stress = outcome.history.column("s11").expect("a column");
        assert_eq!(stress.len(), if kind.is_some() { 3 } else { 6 });
        assert!((stress[2] - 2.0).abs() < 1e-12, "{stress:?}");
    }
}

/// A case that only a child reads is wrong in the same way as any other.
#[test]
fn what_a_child_refuses_is_wrong_with_the_case() {
    let desk = Desk::new();
    let Some(mut case) = misbehaving(&desk, 0) else { return };
    case["steps"][0]["increments"] = json!(-1);
    let source = CaseSource::document(case, &desk.path(""));
    let program = Path::new(env!("CARGO_BIN_EXE_pullout"));
    set_program(program, program);
    let refused = source.columns().expect_err("wrong");
    assert!(refused.to_string().contains("$.steps[0].increments"), "{refused}");
    match source.read().expect("a case").run(Settings::default()) {
        Err(Error::Case(errors)) => {
            let [problem] = &errors.problems[..] else { panic!("{errors}") };
            assert_eq!(problem.place.as_ref().map(JsonPlace::as_str), Some("$.steps[0].increments"));
            assert_eq!(problem.kind, ProblemKind::Input);
        }
        other => panic!("{other:?}"),
    }
}

#[test]
fn a_hanging_child_is_ended() {
    let desk = Desk::new();
    let Some(mut case) = misbehaving(&desk, 5) else { return };
    case["material"]["call_time_limit_s"] = json!(60.0);
    let source = CaseSource::document(case, &desk.path(""));
    let program = Path::new(env!("CARGO_BIN_EXE_pullout"));
    set_program(program, program);
    let prepared = source.read().expect("a case");
    let stop = Arc::new(AtomicBool::new(false));
    let settings = Settings { stop: Arc::clone(&stop), ..Settings::default() };
    let start = Instant::now();
    std::thread::scope(|scope| {
        let run = scope.spawn(|| prepared.run(settings));
        std::thread::sleep(Duration::from_millis(500));
        stop.store(true, Ordering::Relaxed);
        let ended = run.join().expect("no panic");
        assert!(matches!(ended, Err(Error::Stopped)), "{ended:?}");
    });
    // far below the limit of its call
    assert!(start.elapsed() < Duration::from_secs(40));
}

#[test]
fn a_child_outlives_the_thread_that_asked_for_it() {
    let desk = Desk::new();
    let mut case = bond();
    case["steps"][0]["increments"] = json!(200_000);
    let case = desk.case("case.json", &case);
    let program = Path::new(env!("CARGO_BIN_EXE_pullout"));
    set_program(program, program);
    let job = Job::new(CaseSource::file(&case), desk.path("out"), RunOptions { quiet: true, ..RunOptions::default() });
    let asked = std::thread::spawn(move || Child::start(&job, None).expect("a child"));
    let mut child = asked.join().expect("no panic");
    let status = child.wait(&|| None, None, &mut |_: Vec<Message>| {}).expect("a status");
    assert_eq!(status.code(), Some(0));
}
