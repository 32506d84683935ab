//! Processes: what is read before anything runs, what ends with what, libraries that cannot even be loaded.

use super::program::{Desk, Table, command, json, send};
use super::{Fault, compiled, material, point};
use end_to_end_tests::{Tool, find, run};
use rustix::process::Signal;
use serde_json::json;
use std::path::Path;
use std::process::{Child, Stdio};
use std::time::{Duration, Instant};

/// Long enough for a run that is watched.
const MANY: u32 = 90_000_000;

#[test]
fn bad_input_is_told_before_anything_runs() {
    let desk = Desk::new();
    if !compiled(&desk, "misbehaving.c", "misbehaving") {
        return;
    }
    desk.case("good.json", &point(material("misbehaving", Fault::None as u32)));
    let mut case = point(material("misbehaving", Fault::None as u32));
    case["steps"][0]["increments"] = json!(0);
    case["titel"] = json!("x");
    desk.case("bad.json", &case);
    for arguments in [&["run", "bad.json"][..], &["run", "good.json", "bad.json"], &["check", "bad.json"]] {
        let outcome = desk.pullout(arguments).expect(2);
        for text in ["bad.json: $.steps[0].increments", "bad.json: $.titel"] {
            assert_eq!(outcome.stderr.matches(text).count(), 1, "{arguments:?}: {}", outcome.stderr);
        }
        assert!(!desk.has_results());
    }
    assert!(desk.pullout(["check", "good.json"]).expect(0).stdout.contains("good.json: no errors"));
    let mut case = point(material("misbehaving", Fault::None as u32));
    case["material"]["symbol"] = json!("absent_umat_");
    desk.case("absent.json", &case);
    desk.pullout(["run", "absent.json"]).expect(3);
    assert!(!desk.has_results());
}

#[test]
fn several_cases_all_run() {
    let desk = Desk::new();
    if !compiled(&desk, "misbehaving.c", "misbehaving") {
        return;
    }
    desk.case("first.json", &point(material("misbehaving", Fault::Abort as u32)));
    desk.case("second.json", &point(material("misbehaving", Fault::None as u32)));
    desk.case("third.json", &point(json!({ "plugin": "linear_elastic" })));
    desk.pullout(["run", "--quiet", "first.json", "second.json", "third.json"]).expect(1);
    let status = |case: &str| json(&desk.path(&format!("out/{case}/summary.json")))["status"].clone();
    assert_eq!(["first", "second", "third"].map(status), ["failed", "done", "done"]);
}

/// The overrides and the folders of plugins reach the worker.
#[test]
fn a_library_by_name_in_a_given_folder() {
    let desk = Desk::new();
    if !compiled(&desk, "misbehaving.c", "misbehaving") {
        return;
    }
    let mut case = point(material("misbehaving", Fault::None as u32));
    case["material"]["plugin"] = json!("misbehaving");
    desk.case("cases/case.json", &case);
    let arguments =
        ["run", "cases/case.json", "--plugin-path", ".", "--set", "steps.0.increments=2", "--set", "title=-x"];
    desk.pullout(arguments).expect(0);
    let summary = json(&desk.path("out/case/summary.json"));
    assert_eq!((&summary["increments"], &summary["title"]), (&json!(7), &json!("-x")));
}

/// Compiles a line of C to `libloading.so`.
fn loading(desk: &Desk, source: &str) -> bool {
    let Some(mut compiler) = find(Tool::C) else { return false };
    let file = desk.write("loading.c", source);
    run(compiler.args(["-shared", "-fPIC", "-o"]).arg(desk.path("libloading.so")).arg(file));
    true
}

#[test]
fn a_library_that_ends_the_process_when_it_is_loaded() {
    let desk = Desk::new();
    let source = "#include <stdlib.h>\n__attribute__((constructor)) static void start(void) { exit(0); }\n\
                  void umat_(void) {}\n";
    if !loading(&desk, source) {
        return;
    }
    desk.case("case.json", &point(material("loading", 0)));
    for verb in ["run", "check"] {
        let outcome = desk.pullout([verb, "case.json"]).expect(3);
        assert!(outcome.stderr.contains("libloading.so: cannot be loaded: "), "{}", outcome.stderr);
        assert!(outcome.stderr.contains("exit code 0"), "{}", outcome.stderr);
        assert!(!desk.has_results());
    }
}

#[test]
fn a_library_that_blocks_when_it_is_loaded() {
    let desk = Desk::new();
    let source = "#include <unistd.h>\n__attribute__((constructor)) static void start(void) { for (;;) sleep(1); }\n\
                  void umat_(void) {}\n";
    if !loading(&desk, source) {
        return;
    }
    let mut material = material("loading", 0);
    material["call_time_limit_s"] = json!(0.5);
    desk.case("case.json", &point(material));
    let outcome = desk.pullout(["run", "case.json"]).expect(3);
    assert!(outcome.stderr.contains("longer than 0.5 s"), "{}", outcome.stderr);
}

/// All is done: an exit handler of the plugin that never returns changes nothing.
#[test]
fn a_plugin_that_blocks_the_exit() {
    let desk = Desk::new();
    if !compiled(&desk, "misbehaving.c", "misbehaving") {
        return;
    }
    let mut material = material("misbehaving", Fault::HangAtExit as u32);
    material["call_time_limit_s"] = json!(0.5);
    let run = desk.run(&desk.case("case.json", &point(material)), &[], "out", 0);
    assert_eq!(run.summary["status"], "done");
}

/// The process that a supervisor has started, once its history grows.
pub(super) fn worker(child: &mut Child, history: &Path) -> Option<u32> {
    let deadline = Instant::now() + Duration::from_secs(60);
    while !std::fs::metadata(history).is_ok_and(|file| file.len() > 100_000) {
        assert!(Instant::now() < deadline && child.try_wait().expect("a child").is_none(), "no rows");
        std::thread::sleep(Duration::from_millis(2));
    }
    let tasks = std::fs::read_dir(format!("/proc/{}/task", child.id())).expect("threads");
    let children = tasks.flatten().filter_map(|task| std::fs::read_to_string(task.path().join("children")).ok());
    children.flat_map(|text| text.split_whitespace().map(str::to_owned).collect::<Vec<_>>()).next()?.parse().ok()
}

fn long_run(desk: &Desk, isolate: bool) -> Child {
    let mut case = point(json!({ "plugin": "linear_elastic", "isolate": isolate }));
    case["steps"][0]["increments"] = json!(MANY);
    case["output"] = json!({ "plots": false });
    desk.case("case.json", &case);
    let mut process = command();
    process.current_dir(desk.path("")).args(["run", "--quiet", "--out", "out", "case.json"]).stderr(Stdio::piped());
    process.spawn().expect("the program starts")
}

/// Our own plugins are called in the program itself unless the case says otherwise; a worker that is killed is reported.
#[test]
fn who_has_a_worker() {
    for isolate in [false, true] {
        let desk = Desk::new();
        let mut child = long_run(&desk, isolate);
        let worker = worker(&mut child, &desk.path("out/history.csv"));
        assert_eq!(worker.is_some(), isolate);
        match worker {
            None => child.kill().expect("a child"),
            Some(worker) => send(Signal::KILL, worker),
        }
        let output = child.wait_with_output().expect("an end");
        assert_eq!(output.status.code(), isolate.then_some(1));
        let stderr = String::from_utf8(output.stderr).expect("UTF-8");
        assert_eq!(stderr.contains("plugin 'linear_elastic', step 1, increment "), isolate, "{stderr}");
        assert_eq!(stderr.contains("signal SIGKILL (from outside"), isolate, "{stderr}");
        assert!(Table::read(&desk.path("out/history.csv")).rows.len() > 300);
        if isolate {
            // the replay of a sound call is sound, and isolated as its run was
            let replay = desk.run(&desk.path("out/replay.json"), &[], "again", 0);
            assert_eq!(json(&desk.path("out/replay.json"))["material"]["isolate"], true);
            assert_eq!(replay.summary["status"], "done");
        }
    }
}

/// Whatever ends the supervisor ends the worker: SIGKILL cannot be passed on.
#[test]
fn no_worker_outlives_its_supervisor() {
    // not SIGINT: a shell that starts us in the background has it ignored
    for (signal, code) in [(Signal::KILL, None), (Signal::TERM, Some(143))] {
        let desk = Desk::new();
        let mut child = long_run(&desk, true);
        let worker = worker(&mut child, &desk.path("out/history.csv")).expect("a worker");
        send(signal, child.id());
        assert_eq!(child.wait().expect("an end").code(), code, "{signal:?}");
        let deadline = Instant::now() + Duration::from_secs(60);
        let alive = || std::fs::read_to_string(format!("/proc/{worker}/stat")).is_ok_and(|stat| !stat.contains(") Z "));
        while alive() {
            assert!(Instant::now() < deadline, "the worker lives on");
            std::thread::sleep(Duration::from_millis(2));
        }
        // the signal may have ended a write in the middle of a line; all lines before it are whole
        let history = desk.path("out/history.csv");
        let text = std::fs::read_to_string(&history).expect("a history");
        let whole = text.rfind('\n').map_or(0, |end| end + 1);
        std::fs::write(&history, &text[..whole]).expect("the whole lines");
        assert!(Table::read(&history).rows.len() > 300);
    }
}

/// The first Ctrl-C asks a run to end with its increment; one that hangs in a call ends at the second, with its worker.
#[test]
fn a_second_signal_ends_a_run_that_hangs() {
    let desk = Desk::new();
    if !compiled(&desk, "misbehaving.c", "misbehaving") {
        return;
    }
    desk.case("case.json", &point(material("misbehaving", Fault::EndlessLoop as u32)));
    let mut process = command();
    process.current_dir(desk.path("")).args(["run", "--quiet", "--out", "out", "case.json"]);
    let mut child = process.spawn().expect("the program starts");
    // a header and the seven states before the call that does not return
    let history = desk.path("out/history.csv");
    let deadline = Instant::now() + Duration::from_secs(60);
    while std::fs::read_to_string(&history).unwrap_or_default().lines().count() < 9 {
        assert!(Instant::now() < deadline && child.try_wait().expect("a child").is_none(), "no rows");
        std::thread::sleep(Duration::from_millis(2));
    }
    let tasks = std::fs::read_dir(format!("/proc/{}/task", child.id())).expect("threads");
    let children = tasks.flatten().filter_map(|task| std::fs::read_to_string(task.path().join("children")).ok());
    let worker: u32 = children.collect::<String>().trim().parse().expect("one worker");
    // SIGINT may be ignored by what started the tests
    send(Signal::TERM, child.id());
    std::thread::sleep(Duration::from_millis(200));
    assert!(Path::new(&format!("/proc/{worker}")).exists(), "the first signal is passed on, and waits for the call");
    send(Signal::TERM, child.id());
    assert_eq!(child.wait().expect("an end").code(), Some(143));
    while std::fs::read_to_string(format!("/proc/{worker}/stat")).is_ok_and(|stat| !stat.contains(") Z ")) {
        assert!(Instant::now() < deadline, "the worker lives on");
        std::thread::sleep(Duration::from_millis(2));
    }
    assert_eq!(Table::read(&history).rows.len(), 8);
}
