//! Each way in which a plugin can misbehave, at a material point.

use super::program::{Desk, command, json};
use super::{FINISHED, Fault, MODULUS, PLACE, compiled, fails_and_replays, material, point};
use serde_json::json;

/// The rows that were finished are those of elasticity: σ11 = E ε11.
fn misbehaves(desk: &Desk, name: &str, fault: u32, expected: &str, finished: usize) {
    let mut material = material(name, fault);
    // gfortran's backtrace takes its time
    material["call_time_limit_s"] = json!(if expected.contains("within 1 s") { 1.0 } else { 60.0 });
    let case = desk.case("case.json", &point(material));
    let run = fails_and_replays(desk, &case, &format!("plugin '{name}', {PLACE}"), expected);
    assert_eq!(run.history.rows.len(), finished + 1, "fault {fault}");
    assert_eq!(run.summary["increments"].as_u64(), Some(finished as u64), "fault {fault}");
    assert!(run.summary["plugin_calls"].as_u64() > Some(finished as u64), "fault {fault}");
    for (strain, stress) in run.history.column("e11").into_iter().zip(run.history.column("s11")) {
        assert!((stress - MODULUS * strain).abs() < 1e-9, "fault {fault}: {stress} at {strain}");
    }
    let last = run.history.last("s11");
    assert_eq!(run.peak("s11", "max"), last, "fault {fault}");
}

#[test]
fn plugins_in_c() {
    let desk = Desk::new();
    if !compiled(&desk, "misbehaving.c", "misbehaving") {
        return;
    }
    for (fault, expected) in [
        (Fault::Exit0, "ended the process instead of returning, exit code 0"),
        (Fault::Exit7, "ended the process instead of returning, exit code 7"),
        (Fault::Abort, "SIGABRT"),
        (Fault::WildPointer, "SIGSEGV"),
        (Fault::EndlessLoop, "did not return within 1 s"),
        (Fault::Trap, "SIGFPE (a floating-point exception"),
    ] {
        misbehaves(&desk, "misbehaving", fault as u32, expected, FINISHED);
    }
}

#[test]
fn a_stack_that_is_used_up() {
    let desk = Desk::new();
    if !compiled(&desk, "misbehaving.c", "misbehaving") {
        return;
    }
    // a guard page is met: SIGABRT after a message, or missed: SIGSEGV
    misbehaves(&desk, "misbehaving", Fault::Stack as u32, "stack", FINISHED);
}

#[test]
fn a_plugin_that_closes_the_standard_output() {
    let desk = Desk::new();
    if !compiled(&desk, "misbehaving.c", "misbehaving") {
        return;
    }
    // its own increment is finished
    misbehaves(&desk, "misbehaving", Fault::CloseStdout as u32, "closed the standard output", FINISHED + 1);
}

#[test]
fn plugins_in_fortran() {
    let desk = Desk::new();
    if !compiled(&desk, "misbehaving.f90", "fortran") {
        return;
    }
    for (fault, expected) in [
        (1, "exit code 0 (STOP"),
        (2, "exit code 0 (STOP"),
        (3, "exit code 3 (STOP"),
        (4, "exit code 1 (STOP"),
        (5, "exit code 2 (STOP"),
        (6, "automatic arrays beyond the stack"),
    ] {
        misbehaves(&desk, "fortran", fault, expected, FINISHED);
    }
}

/// 40 MB of automatic arrays fit, with and without isolation.
#[test]
fn automatic_arrays_fit_on_the_stack() {
    let desk = Desk::new();
    if !compiled(&desk, "misbehaving.f90", "fortran") {
        return;
    }
    let case = desk.case("case.json", &point(material("fortran", 7)));
    for place in [&[][..], &["--in-process"]] {
        let run = desk.run_with(&case, place, "out", 0);
        assert_eq!(run.history.rows.len(), 11);
    }
}

/// Text that a plugin prints is kept; a reader of the program's own lines that has gone away ends neither.
#[test]
fn what_a_plugin_prints() {
    let desk = Desk::new();
    if !compiled(&desk, "misbehaving.f90", "fortran") {
        return;
    }
    let case = desk.case("case.json", &point(material("fortran", 8)));
    let run = desk.run(&case, &[], "out", 0);
    assert!(run.log().contains("a line on the standard output"), "{}", run.log());
    assert_eq!(run.outcome.stdout, "");
    let (reader, writer) = std::io::pipe().expect("a pipe");
    drop(reader);
    let mut process = command();
    process.current_dir(desk.path("")).args(["run", "case.json", "--out", "closed"]).stdout(writer);
    assert_eq!(process.output().expect("the program starts").status.code(), Some(0));
    assert_eq!(json(&desk.path("closed/summary.json"))["increments"], 10);
}

#[test]
fn a_sound_library_gives_the_same_with_and_without_isolation() {
    let desk = Desk::new();
    if !compiled(&desk, "misbehaving.c", "misbehaving") {
        return;
    }
    let case = desk.case("case.json", &point(material("misbehaving", Fault::None as u32)));
    let isolated = desk.run(&case, &[], "isolated", 0);
    let plain = desk.run_with(&case, &["--in-process"], "plain", 0);
    let text = |folder: &str| std::fs::read(desk.path(folder).join("history.csv")).expect("a history");
    assert_eq!(text("isolated"), text("plain"));
    assert_eq!(isolated.history.rows.len(), 11);
    let mut summaries = [isolated.summary, plain.summary];
    for summary in &mut summaries {
        (summary["wall_time_s"], summary["cpu_time_s"]) = (json!(0), json!(0));
    }
    assert_eq!(summaries[0], summaries[1]);
    let outcome = desk.pullout(["run", "case.json"]).expect(0);
    assert!(outcome.stdout.contains("case: done, 10 increments"), "{}", outcome.stdout);
    assert_eq!(outcome.stderr, "");
}

#[test]
fn isolation_is_switched_off_by_the_command_line_alone() {
    let desk = Desk::new();
    if !compiled(&desk, "misbehaving.c", "misbehaving") {
        return;
    }
    let mut wishing = material("misbehaving", Fault::Exit7 as u32);
    wishing["isolate"] = json!(false);
    desk.case("case.json", &point(wishing));
    let outcome = desk.pullout(["run", "case.json"]).expect(1);
    assert!(outcome.stderr.contains("\"isolate\": false needs --in-process"), "{}", outcome.stderr);
    assert!(outcome.stderr.contains("exit code 7"), "{}", outcome.stderr);
    assert_eq!(json(&desk.path("out/case/summary.json"))["status"], "failed");
    let outcome = desk.pullout(["check", "case.json"]).expect(0);
    assert_eq!(outcome.stderr.lines().count(), 1, "{}", outcome.stderr);
    let outcome = desk.pullout(["run", "case.json", "--quiet", "--out=-quiet"]).expect(1);
    assert_eq!(outcome.stderr.lines().count(), 1, "{}", outcome.stderr);
    assert!(desk.path("-quiet/summary.json").is_file());
    // the plugin ends the program itself: its rows are all that is left
    desk.pullout(["run", "case.json", "--in-process", "--out", "in"]).expect(7);
    assert!(desk.path("in/history.csv").is_file() && !desk.path("in/summary.json").exists());
    // a case may still wish the contrary
    let set = ["--set", "material.isolate=true"];
    desk.pullout(["run", "case.json", "--in-process", "--out", "apart"].into_iter().chain(set)).expect(1);
    assert!(desk.path("apart/summary.json").is_file());
}
