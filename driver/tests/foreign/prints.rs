//! Files that a UMAT reads next to its case, and text that it prints.

use super::{built, close, point};
use crate::program::{Desk, Run, command};
use end_to_end_tests::notice;
use serde_json::{Value, json};

/// The folder of a case with its table, and the case; `aborts`: the increment in which the law ends the process.
fn prepared(desk: &Desk, aborts: u32) -> Option<Value> {
    let library = built(desk, "printing.f", &[])?;
    desk.write("job/modulus.dat", "1000.0\n");
    let material = json!({ "plugin": library, "props": [0.2, aborts], "nstatv": 1 });
    Some(point(material, "3d", json!([{ "increments": 3, "target": { "e11": 1e-3 } }])))
}

/// The lines of increments, in all calls of each.
fn increments(text: &str, unit: &str) -> Vec<u32> {
    let lines = text.lines().filter_map(|line| line.trim().strip_prefix(&format!("{unit} IN INCREMENT")));
    let mut numbers: Vec<u32> = lines.map(|number| number.trim().parse().expect("a number")).collect();
    numbers.dedup();
    numbers
}

fn nothing_was_left(desk: &Desk) {
    for folder in [desk.path(""), desk.path("job")] {
        assert!(!folder.join("fort.7").exists(), "{}", folder.display());
    }
}

#[test]
fn tables_lie_next_to_the_case_and_prints_are_kept_with_the_results() {
    let desk = Desk::new();
    let Some(case) = prepared(&desk, 0) else { return };
    let case = desk.case("job/case.json", &case);
    for place in [&[][..], &["--in-process"]] {
        let run = desk.run_with(&case, place, "out", 0);
        close(run.history.last("s11"), 1.0);
        assert_eq!((run.outcome.stdout.as_str(), run.outcome.stderr.as_str()), ("", ""));
        for unit in ["UNIT SIX", "STAR"] {
            assert_eq!(increments(&run.log(), unit), [1, 2, 3], "{}", run.log());
        }
        assert_eq!(increments(&run.messages(), "UNIT SEVEN"), [1, 2, 3], "{}", run.messages());
        nothing_was_left(&desk);
        // shown on demand, and kept all the same; our own line comes last
        let path = case.to_str().expect("UTF-8");
        let arguments = ["run", path, "--echo", "--out", "echoed"];
        let echoed = desk.pullout(arguments.iter().chain(place)).expect(0);
        let shown = run.log() + &run.messages();
        for line in shown.lines() {
            assert!(echoed.stdout.contains(line), "{line}");
        }
        assert!(echoed.stdout.contains("case: done, 3 increments"), "{}", echoed.stdout);
        assert_eq!(std::fs::read_to_string(desk.path("echoed/umat.log")).expect("kept"), run.log());
    }
}

/// With another malloc in place of the C library's, as clusters have it, Fortran's runtime frees what it took.
#[test]
fn another_malloc_does_not_disturb_a_law_that_prints() {
    ["libjemalloc.so.2", "libtcmalloc_minimal.so.4"].into_iter().for_each(prints_with);
}

fn prints_with(malloc: &str) {
    let desk = Desk::new();
    let with_it = |arguments: &[&str]| {
        let mut process = command();
        let output = process.current_dir(desk.path("")).env("LD_PRELOAD", malloc).args(arguments).output();
        let output = output.expect("the program starts");
        let text = |bytes: &[u8]| String::from_utf8_lossy(bytes).into_owned();
        (output.status.code(), text(&output.stdout), text(&output.stderr))
    };
    if with_it(&["--version"]).2.contains("cannot be preloaded") {
        return notice(&format!("{malloc} is not installed"));
    }
    let Some(case) = prepared(&desk, 0) else { return };
    desk.case("job/case.json", &case);
    let (code, _, stderr) = with_it(&["run", "--quiet", "--out", "out", "job/case.json"]);
    assert_eq!((code, stderr.as_str()), (Some(0), ""), "{malloc}");
    let log = std::fs::read_to_string(desk.path("out/umat.log")).expect("a log");
    assert_eq!(increments(&log, "UNIT SIX"), [1, 2, 3], "{malloc}: {log}");
    let library = case["material"]["plugin"].as_str().expect("a path");
    let (code, info, _) = with_it(&["plugin", "info", library]);
    assert!(code == Some(0) && info.contains("Memory: not the C library's"), "{malloc}: {info}");
    assert!(!desk.pullout(["plugin", "info", library]).expect(0).stdout.contains("Memory:"));
}

/// Text printed before a signal is kept, also that of the call that it ended; the replay finds the table.
#[test]
fn prints_survive_a_law_that_ends_the_process() {
    let desk = Desk::new();
    let Some(case) = prepared(&desk, 2) else { return };
    let run = desk.run(&desk.case("job/case.json", &case), &[], "out", 1);
    assert!(run.summary["message"].as_str().is_some_and(|text| text.contains("SIGABRT")), "{}", run.summary);
    assert_eq!(increments(&run.log(), "UNIT SIX"), [1, 2], "{}", run.log());
    assert_eq!(increments(&run.messages(), "UNIT SEVEN"), [1, 2], "{}", run.messages());
    let again = desk.run(&run.folder.join("replay.json"), &[], "again", 1);
    assert!(again.summary["message"].as_str().is_some_and(|text| text.contains("SIGABRT")), "{}", again.summary);
    nothing_was_left(&desk);
}

#[test]
fn a_law_that_prints_nothing_leaves_no_files() {
    let desk = Desk::new();
    let Some(library) = built(&desk, "elastic.f", &[]) else { return };
    let material = json!({ "plugin": library, "props": [1000, 0.2], "nstatv": 1 });
    let case = point(material, "3d", json!([{ "increments": 2, "target": { "e11": 1e-3 } }]));
    let run: Run = super::run(&desk, "silent", &case);
    for name in ["umat.log", "umat.msg"] {
        assert!(!run.folder.join(name).exists(), "{name}");
    }
}

/// The check calls a law thousands of times: only its verdict is printed.
#[test]
fn a_check_shows_its_verdict_and_no_prints() {
    let desk = Desk::new();
    let Some(case) = prepared(&desk, 0) else { return };
    let case = desk.case("job/case.json", &case);
    let library = desk.path("libprinting.so");
    let paths = [library.to_str().expect("UTF-8"), case.to_str().expect("UTF-8")];
    let checked = desk.pullout(["plugin", "check", paths[0], "--states", "3", "--case", paths[1]]);
    assert!(checked.code == 0 && checked.stdout.contains("pass  "), "{}{}", checked.stdout, checked.stderr);
    assert!(!checked.stdout.contains("IN INCREMENT"), "{}", checked.stdout);
    nothing_was_left(&desk);
}
