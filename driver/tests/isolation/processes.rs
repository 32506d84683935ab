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
fn bad_input_is_reported_before_anything_runs() {
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
    worker_of(child.id())
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

/// The worker of a supervisor: the child of its keeper.
fn worker_of(supervisor: u32) -> Option<u32> {
    let only_child = |process: u32| {
        let tasks = std::fs::read_dir(format!("/proc/{process}/task")).ok()?.flatten();
        let children = tasks.filter_map(|task| std::fs::read_to_string(task.path().join("children")).ok());
        children.collect::<String>().split_whitespace().next()?.parse().ok()
    };
    only_child(only_child(supervisor)?)
}

/// The state of a process as the kernel has it; `Z` if it is none.
fn state(process: u32) -> char {
    let stat = std::fs::read_to_string(format!("/proc/{process}/stat")).unwrap_or_default();
    stat.rsplit_once(") ").and_then(|(_, rest)| rest.chars().next()).unwrap_or('Z')
}

/// Starts a run whose plugin makes a fault that hangs, and waits until it does.
fn hanging(desk: &Desk, fault: Fault) -> (Child, u32) {
    // rows of a run before are not waited for
    let _ = std::fs::remove_dir_all(desk.path("out"));
    desk.case("case.json", &point(material("misbehaving", fault as u32)));
    let mut process = command();
    process.env("HANGING", desk.path("")).stderr(Stdio::piped());
    process.current_dir(desk.path("")).args(["run", "--quiet", "--out", "out", "case.json"]);
    let mut child = process.spawn().expect("the program starts");
    // a header and the seven states before the call that does not return
    let history = desk.path("out/history.csv");
    let deadline = Instant::now() + Duration::from_secs(60);
    while std::fs::read_to_string(&history).unwrap_or_default().lines().count() < 9 {
        assert!(Instant::now() < deadline && child.try_wait().expect("a child").is_none(), "no rows");
        std::thread::sleep(Duration::from_millis(2));
    }
    let worker = worker_of(child.id()).expect("a worker");
    (child, worker)
}

/// Asserts that nothing of a run of this desk is alive two seconds later.
fn nothing_is_left(desk: &Desk) {
    let mark = format!("HANGING={}", desk.path("").display());
    let deadline = Instant::now() + Duration::from_secs(2);
    let is_of_it = |process: &std::fs::DirEntry| {
        let variables = std::fs::read(process.path().join("environ")).unwrap_or_default();
        variables.split(|byte| *byte == 0).any(|variable| variable == mark.as_bytes())
    };
    loop {
        let left: Vec<_> = std::fs::read_dir("/proc").expect("processes").flatten().filter(is_of_it).collect();
        if left.is_empty() {
            return;
        }
        assert!(Instant::now() < deadline, "{left:?} live on");
        std::thread::sleep(Duration::from_millis(10));
    }
}

/// One SIGTERM is enough, also while a call hangs; what the plugin started ends with it.
#[test]
fn one_signal_ends_a_run_that_hangs() {
    let desk = Desk::new();
    if !compiled(&desk, "misbehaving.c", "misbehaving") {
        return;
    }
    for fault in [Fault::EndlessLoop, Fault::ForkAndHang] {
        let (child, worker) = hanging(&desk, fault);
        std::thread::sleep(Duration::from_millis(100));
        let start = Instant::now();
        // SIGINT may be ignored by what started the tests
        send(Signal::TERM, child.id());
        std::thread::sleep(Duration::from_millis(200));
        let is_alive = state(worker) != 'Z';
        // a second later the worker is ended
        assert!(
            is_alive || start.elapsed() > Duration::from_secs(1),
            "the signal is passed on, and waits for the call"
        );
        let output = child.wait_with_output().expect("an end");
        let time = start.elapsed();
        assert_eq!(output.status.code(), Some(143));
        // far below the limit of a call, 60 s, also on a busy machine
        assert!(time < Duration::from_secs(20), "{time:?}");
        let stderr = String::from_utf8(output.stderr).expect("UTF-8");
        assert_eq!(stderr.lines().count(), 1, "{stderr}");
        assert!(stderr.contains("interrupted by SIGTERM") && stderr.contains("'misbehaving'"), "{stderr}");
        assert_eq!(json(&desk.path("out/summary.json"))["status"], "interrupted");
        assert_eq!(Table::read(&desk.path("out/history.csv")).rows.len(), 8);
        nothing_is_left(&desk);
    }
}

/// The second signal ends all at once, and so does SIGKILL.
#[test]
fn what_a_plugin_started_ends_with_the_supervisor() {
    let desk = Desk::new();
    if !compiled(&desk, "misbehaving.c", "misbehaving") {
        return;
    }
    for (signals, code) in [(&[Signal::TERM, Signal::TERM][..], Some(143)), (&[Signal::KILL], None)] {
        let (child, worker) = hanging(&desk, Fault::ForkAndHang);
        for signal in signals {
            send(*signal, child.id());
            std::thread::sleep(Duration::from_millis(50));
        }
        assert_eq!(child.wait_with_output().expect("an end").status.code(), code);
        nothing_is_left(&desk);
        assert_eq!(state(worker), 'Z');
        assert_eq!(Table::read(&desk.path("out/history.csv")).rows.len(), 8);
    }
}

/// What a plugin started, as its child or as a daemon, ends with the run or at the limit of its call, and a thread that
/// traces itself is no reason to wait.
#[test]
fn what_a_plugin_started_ends_with_the_run() {
    let desk = Desk::new();
    if !compiled(&desk, "misbehaving.c", "misbehaving") {
        return;
    }
    for (fault, code, words) in [
        (Fault::ForkMany, 0, ""),
        (Fault::ForkApart, 0, ""),
        (Fault::TraceItself, 0, ""),
        (Fault::TraceAndCrash, 1, "SIGSEGV"),
        (Fault::ForkAndHang, 1, "did not return within 0.5 s"),
        (Fault::KillGroup, 1, "SIGKILL"),
        (Fault::SmallFiles, 1, "it lowered the limit of the size of files"),
    ] {
        let mut material = material("misbehaving", fault as u32);
        // two hundred forks take their time
        material["call_time_limit_s"] = json!(if words.contains("within 0.5 s") { 0.5 } else { 60.0 });
        desk.case("case.json", &point(material));
        let mut process = command();
        process.env("HANGING", desk.path("")).current_dir(desk.path("")).args(["run", "--quiet", "case.json"]);
        let output = process.output().expect("an end");
        let stderr = String::from_utf8(output.stderr).expect("UTF-8");
        assert_eq!(output.status.code(), Some(code), "{stderr}");
        assert_eq!(stderr.lines().count(), usize::from(code > 0), "{stderr}");
        assert!(
            stderr.contains(words) && (code == 0 || stderr.contains("'misbehaving', step 2, increment 3")),
            "{stderr}"
        );
        let status = json(&desk.path("out/case/summary.json"))["status"].clone();
        assert_eq!(status, if code == 0 { "done" } else { "failed" });
        nothing_is_left(&desk);
    }
}

/// The capability of lifting limits.
const CAP_SYS_RESOURCE: u32 = 24;

/// Only the superuser can become somebody else, and only with a capability can limits be lifted again.
#[test]
fn a_plugin_that_changes_the_user_or_limits_is_named() {
    let desk = Desk::new();
    if !compiled(&desk, "misbehaving.c", "misbehaving") {
        return;
    }
    let is_superuser = rustix::process::geteuid().is_root();
    let user = if is_superuser { (1, "it changed the user") } else { (1, "exit code 77") };
    let capabilities = std::fs::read_to_string("/proc/self/status").expect("a status");
    let capabilities = capabilities.lines().find_map(|line| line.strip_prefix("CapEff:")).expect("capabilities");
    let may_lift = u64::from_str_radix(capabilities.trim(), 16).expect("bits") >> CAP_SYS_RESOURCE & 1 == 1;
    let limit = if may_lift { (0, "") } else { (1, "it lowered the limit of open files") };
    for (fault, (code, words)) in [(Fault::ChangeUser, user), (Fault::FewDescriptors, limit)] {
        let case = desk.case("case.json", &point(material("misbehaving", fault as u32)));
        let run = desk.run(&case, &[], "out", code);
        assert!(run.outcome.stderr.contains(words), "{}", run.outcome.stderr);
        assert_eq!(run.outcome.stderr.lines().count(), usize::from(code > 0), "{}", run.outcome.stderr);
        assert_eq!(run.summary["status"], if code == 0 { "done" } else { "failed" });
    }
}

/// A run without descriptors says so.
#[test]
fn few_descriptors_are_named() {
    let desk = Desk::new();
    if !compiled(&desk, "misbehaving.c", "misbehaving") {
        return;
    }
    desk.case("case.json", &point(material("misbehaving", Fault::None as u32)));
    for count in 4..24 {
        let mut shell = std::process::Command::new("sh");
        let line = format!("ulimit -n {count}; exec \"$0\" run --quiet --overwrite case.json");
        let output = shell.args(["-c", &line, env!("CARGO_BIN_EXE_pullout")]).current_dir(desk.path("")).output();
        let output = output.expect("a shell");
        let stderr = String::from_utf8(output.stderr).expect("UTF-8");
        // the loader itself needs some
        let is_started = !stderr.contains("shared libraries");
        let code = output.status.code();
        assert!(
            !is_started || code == Some(0) || (matches!(code, Some(1 | 2)) && !stderr.is_empty()),
            "{count}: {code:?} {stderr}"
        );
        assert!(!stderr.contains("panicked"), "{count}: {stderr}");
    }
}

/// Ctrl-Z stops the worker, which the terminal does not know, with its supervisor.
#[test]
fn a_run_is_stopped_and_goes_on() {
    let desk = Desk::new();
    let mut child = long_run(&desk, true);
    worker(&mut child, &desk.path("out/history.csv"));
    let worker = worker_of(child.id()).expect("a worker");
    let until = |is_stopped: bool| {
        let deadline = Instant::now() + Duration::from_secs(60);
        while [worker, child.id()].iter().any(|process| (state(*process) == 'T') != is_stopped) {
            assert!(Instant::now() < deadline, "{} {}", state(worker), state(child.id()));
            std::thread::sleep(Duration::from_millis(5));
        }
    };
    send(Signal::TSTP, child.id());
    until(true);
    send(Signal::CONT, child.id());
    until(false);
    send(Signal::TERM, child.id());
    assert_eq!(child.wait().expect("an end").code(), Some(143));
}
