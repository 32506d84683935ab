//! Libraries that may run in the program's own process: those built with it, and none that only claims to be.

use super::processes::worker;
use super::program::{Desk, Outcome, Run, command, files, json, timeless};
use super::{Fault, compiled, material, point};
use end_to_end_tests::{Tool, find, plugin, run};
use serde_json::{Value, json};
use std::fs;
use std::path::Path;
use std::process::Stdio;

/// Compiles a library in C that claims to describe laws, and does something when it is loaded; false without a compiler.
fn claiming(desk: &Desk, library: &str, statement: &str) -> bool {
    let Some(mut compiler) = find(Tool::C) else { return false };
    let source = desk.write(
        "claiming.c",
        &format!(
            "#include <stdlib.h>\n#include <unistd.h>\nvoid *pullout_plugin_v1(void) {{ return 0; }}\n\
             void umat_(void) {{}}\nvoid pullout_utilities_job_v1(void) {{ exit(0); }}\n\
             __attribute__((constructor)) static void start(void) {{ {statement} }}\n"
        ),
    );
    let file = desk.write(library, "");
    run(compiler.args(["-shared", "-fPIC", "-Wno-unused-result", "-o"]).arg(file).arg(source));
    true
}

/// One line on the standard error, with these words.
fn one_line(outcome: &Outcome, words: &[&str]) {
    assert_eq!(outcome.stderr.lines().count(), 1, "{}", outcome.stderr);
    for text in words {
        assert!(outcome.stderr.contains(text), "'{text}' is not in {}", outcome.stderr);
    }
}

#[test]
fn metadata_is_no_reason_for_trust() {
    let desk = Desk::new();
    if !claiming(&desk, "libclaiming.so", "exit(0);") {
        return;
    }
    let case = point(json!({ "plugin": "./libclaiming.so", "props": [], "nstatv": 0 }));
    desk.case("case.json", &case);
    desk.case("other.json", &case);
    let study = json!({ "kind": "study", "base": "case.json", "members": [{ "label": "a" }] });
    desk.case("family.json", &study);
    let words = ["libclaiming.so: cannot be loaded: ", "exit code 0"];
    for arguments in [
        &["check", "--quiet", "case.json"][..],
        &["run", "--quiet", "case.json"],
        &["run", "--quiet", "case.json", "--restart", "nowhere"],
        &["study", "family.json"],
        &["plugin", "info", "./libclaiming.so"],
        &["plugin", "check", "./libclaiming.so"],
        &["plugin", "check", "./libclaiming.so", "--case", "case.json"],
    ] {
        let outcome = desk.pullout(arguments);
        let expected = if arguments.contains(&"--restart") { 2 } else { 3 };
        assert_eq!(outcome.code, expected, "{arguments:?}: {}", outcome.stderr);
        if expected == 3 {
            one_line(&outcome, &words);
        }
    }
    let outcome = desk.pullout(["run", "--quiet", "case.json", "other.json"]).expect(3);
    assert_eq!(outcome.stderr.matches("exit code 0").count(), 2, "{}", outcome.stderr);
}

/// The cases of a library of others are read in processes of their own.
#[test]
fn a_study_says_whose_case_is_wrong() {
    let desk = Desk::new();
    if !compiled(&desk, "misbehaving.c", "theirs") {
        return;
    }
    desk.case("case.json", &point(material("theirs", Fault::None as u32)));
    let members = json!([{ "label": "right" }, { "label": "wrong", "set": { "material.nstatv": -1 } }]);
    desk.case("family.json", &json!({ "kind": "study", "base": "case.json", "members": members }));
    let printed = desk.pullout(["study", "family.json", "--out", "out"]).expect(2).stderr;
    let [what, whose] = printed.lines().collect::<Vec<_>>()[..] else { panic!("{printed}") };
    assert!(what.starts_with("case.json: $.material.nstatv: "), "{printed}");
    assert!(whose.starts_with("family.json: ") && whose.ends_with("wrong"), "{printed}");
    assert!(!desk.path("out").exists());
}

#[test]
fn a_list_stands_what_lies_in_the_folders() {
    let desk = Desk::new();
    if !claiming(&desk, "plugins/libends.so", "_exit(0);") {
        return;
    }
    claiming(&desk, "plugins/libaborts.so", "abort();");
    claiming(&desk, "plugins/libhangs.so", "for (;;) sleep(1);");
    claiming(&desk, "plugins/libfalls.so", "*(volatile int *)16 = 1;");
    desk.write("plugins/libtext.so", "pullout_plugin_v1");
    let sound = fs::read(plugin("sound_damage")).expect("a library");
    fs::write(desk.path("plugins/libsound.so"), &sound).expect("a copy");
    for (name, part) in [("libhalf.so", sound.len() / 2), ("libhead.so", 4096), ("libempty.so", 0)] {
        fs::write(desk.path("plugins").join(name), &sound[..part]).expect("a part");
    }
    let mut hollow = sound.clone();
    // its table of segments
    hollow[64..400].fill(0xff);
    fs::write(desk.path("plugins/libhollow.so"), hollow).expect("a damaged library");
    let outcome = desk.pullout(["plugin", "list", "--plugin-path", "plugins"]).expect(0);
    let listed = |name: &str| outcome.stdout.lines().any(|line| line.contains(&format!("plugins/lib{name}.so")));
    assert!(listed("sound") && outcome.stdout.contains("linear_elastic"), "{}", outcome.stdout);
    for (name, how) in [
        ("ends", "exit code 0"),
        ("aborts", "SIGABRT"),
        ("hangs", "longer than 5 s"),
        ("falls", "SIGSEGV"),
        ("text", "cannot be read as a library"),
        ("half", "cannot be"),
        ("head", "cannot be"),
        ("empty", "cannot be read as a library"),
        ("hollow", "cannot be"),
    ] {
        let mut lines = outcome.stderr.lines().filter(|line| line.contains(&format!("plugins/lib{name}.so: ")));
        assert!(!listed(name), "{}", outcome.stdout);
        assert!(lines.next().is_some_and(|line| line.contains(how)), "{name}: {}", outcome.stderr);
        assert_eq!(lines.next(), None, "{name}: {}", outcome.stderr);
    }
}

/// Starts a run that lasts; whether it has a worker.
fn has_worker(desk: &Desk, material: Value, more: &[&str]) -> bool {
    let mut case = point(material);
    case["steps"][0]["increments"] = json!(10_000_000);
    case["output"] = json!({ "plots": false });
    desk.case("case.json", &case);
    let mut process = command();
    process.current_dir(desk.path("")).args(["run", "--quiet", "--out", "out", "case.json"]).args(more);
    let mut child = process.stderr(Stdio::null()).spawn().expect("the program starts");
    let found = worker(&mut child, &desk.path("out/history.csv")).is_some();
    child.kill().expect("a child");
    child.wait().expect("an end");
    found
}

#[test]
fn who_runs_in_the_program() {
    let copy = |desk: &Desk, law: &str| {
        fs::copy(plugin(law), desk.path(&format!("lib{law}.so"))).expect("a copy");
        json!({ "plugin": format!("./lib{law}.so") })
    };
    let has = |material: &dyn Fn(&Desk) -> Value, more: &[&str]| {
        let desk = Desk::new();
        let material = material(&desk);
        has_worker(&desk, material, more)
    };
    // a user's law with all its metadata, and one of ours that is no longer what it was
    let users = |desk: &Desk| copy(desk, "sound_damage");
    assert!(has(&users, &[]));
    assert!(!has(&users, &["--in-process"]));
    let printed =
        |library: &str| Desk::new().pullout(["plugin".as_ref(), "info".as_ref(), plugin(library).as_os_str()]);
    assert!(printed("sound_damage").stdout.contains("Process: a separate one"));
    assert!(printed("linear_elastic").stdout.contains("Process: pullout's own"));
    let ours = |desk: &Desk| copy(desk, "linear_elastic");
    assert!(!has(&ours, &[]));
    let changed = |desk: &Desk| {
        let material = ours(desk);
        let path = desk.path("liblinear_elastic.so");
        fs::write(&path, [&fs::read(&path).expect("a library")[..], b"\0"].concat()).expect("one byte more");
        material
    };
    assert!(has(&changed, &[]));
    let by_symbol = |_: &Desk| json!({ "plugin": "linear_elastic", "symbol": "linear_elastic_umat_" });
    assert!(has(&by_symbol, &[]));
}

/// The utility routines are loaded into the program itself: a folder of plugins cannot bring others.
#[test]
fn utility_routines_are_the_programs_own() {
    let desk = Desk::new();
    if !claiming(&desk, "plugins/libpullout_utilities.so", "_exit(0);") {
        return;
    }
    desk.case("case.json", &point(json!({ "plugin": "linear_elastic" })));
    let mut process = command();
    process.current_dir(desk.path("")).args(["check", "case.json", "--plugin-path", "plugins"]);
    let output = process.env("PULLOUT_PLUGIN_PATH", desk.path("plugins")).output().expect("the program starts");
    assert_eq!(String::from_utf8_lossy(&output.stdout), "case.json: no errors\n");
}

/// A fibre in its block, with laws that are called at many points at a time and by several threads.
fn fibre(place: &Value) -> Value {
    let with_place = |mut material: Value| {
        material["isolate"] = place.clone();
        material
    };
    json!({
        "kind": "pullout",
        "title": "A fibre",
        "mesh": { "specimen": {
            "type": "perpendicular_fibre", "embedded_elements": 6, "interface_size": 2.0, "largest_size": 6.0,
        } },
        "parts": {
            "fibre": { "material": with_place(json!({ "plugin": "j2_plasticity", "props": {
                "E": 210e3, "nu": 0.3, "hardening": [[40.0, 0.0], [2140.0, 1.0]],
            } })) },
            "matrix": { "material": with_place(json!({ "plugin": "concrete_damage" })) },
        },
        "contact": { "law": with_place(json!({ "plugin": "bond_slip" })) },
        "steps": [ { "slip": 0.02, "increments": 4 }, { "slip": 0.05, "increments": 6 } ],
    })
}

/// Checks that two folders have the same results, to the bit.
fn same(one: &Path, other: &Path) {
    let (one_files, other_files) = (files(one), files(other));
    assert!(one_files.keys().eq(other_files.keys()), "{:?} {:?}", one_files.keys(), other_files.keys());
    for (name, content) in one_files {
        assert!(content == other_files[&name], "{name}");
    }
    assert_eq!(timeless(one), timeless(other));
}

#[test]
fn a_specimen_gives_the_same_bits_in_a_worker_also_after_a_restart() {
    let desk = Desk::new();
    let here = desk.case("here/case.json", &fibre(&Value::Null));
    let apart = desk.case("apart/case.json", &fibre(&json!(true)));
    let plain = desk.run_with(&here, &["--threads", "2", "--checkpoint-every", "4"], "plain", 0);
    let isolated = desk.run_with(&apart, &["--threads", "3", "--checkpoint-every", "4"], "isolated", 0);
    assert!(isolated.history.rows.len() > 10);
    same(&plain.folder, &isolated.folder);
    let as_plain = |words: &str| words.replace("apart/case.json", "here/case.json");
    assert_eq!(as_plain(&isolated.outcome.stderr), plain.outcome.stderr);
    fs::remove_file(isolated.folder.join("summary.json")).expect("it was there");
    let folder = isolated.folder.to_string_lossy();
    let restart = |case: &Path, code| {
        desk.pullout(["run", "--quiet", "--restart", &folder, "--checkpoint-every", "4", &case.to_string_lossy()])
            .expect(code)
    };
    assert_eq!(as_plain(&restart(&apart, 0).stderr), plain.outcome.stderr);
    same(&plain.folder, &isolated.folder);
    fs::write(isolated.folder.join("checkpoint.bin"), "damaged").expect("a file");
    let before = files(&isolated.folder);
    assert!(restart(&apart, 2).stderr.contains("checkpoint"));
    assert_eq!(files(&isolated.folder), before);
}

/// A UMAT of a plate that ends the process in its second half, and ends it there again when the run goes on.
#[test]
fn a_law_that_fails_after_a_restart() {
    let desk = Desk::new();
    if !compiled(&desk, "misbehaving.c", "misbehaving") {
        return;
    }
    let case = |fault: Fault, increment: u32| {
        let mut material = material("misbehaving", fault as u32);
        material["props"] = json!([1000.0, fault as u32, 2, increment]);
        desk.case("case.json", &super::specimen::plate(material, false))
    };
    let failed = |run: &Run| {
        assert!(run.outcome.stderr.contains("plugin 'misbehaving', step 2, increment 4"), "{}", run.outcome.stderr);
        assert_eq!(run.summary["status"], "failed");
        assert!(run.folder.join("report.html").is_file() && run.folder.join("replay.json").is_file());
    };
    let first = desk.run_with(&case(Fault::Exit0, 4), &["--checkpoint-every", "3"], "out", 1);
    failed(&first);
    let restart = |code| desk.pullout(["run", "--quiet", "case.json", "--restart", "out"]).expect(code);
    let again = Run::read(&first.folder, restart(1));
    failed(&again);
    assert_eq!(again.history.column("load"), first.history.column("load"));
    assert_eq!(again.history.rows.len(), 8, "the initial state, four increments, three increments");
    // of another case nothing goes on, whether it is refused or ends the process while it is read
    let before = files(&first.folder);
    case(Fault::None, 4);
    assert!(restart(2).stderr.contains("checkpoint"));
    let mut ends = material("misbehaving", Fault::Exit0 as u32);
    ends["props"] = json!([1000.0, Fault::Exit0 as u32, 1, 1]);
    desk.case("case.json", &super::specimen::plate(ends, false));
    assert!(restart(1).stderr.contains("step 1, increment 1"));
    assert_eq!(files(&first.folder), before);
    assert_eq!(json(&first.folder.join("summary.json")), again.summary);
    // what it may keep in its own memory is reported
    case(Fault::None, 4);
    let sound = desk.run_with(&desk.path("case.json"), &["--checkpoint-every", "3"], "sound", 0);
    let warning = "libmisbehaving.so: what it keeps in its own memory (SAVE, COMMON) is in no checkpoint";
    assert!(sound.outcome.stderr.contains(warning), "{}", sound.outcome.stderr);
}

#[test]
fn a_fit_runs_in_one_worker() {
    let desk = Desk::new();
    let curve = super::program::cases().join("data").join("perpendicular_fibre_load_slip.csv");
    let fit = |case: &str, out: &str, more: &[&str]| {
        let curve = curve.to_string_lossy();
        let common = ["fit", "bond", &curve, "--diameter", "0.406", "--length", "12.2", "--quiet", "--max-runs", "3"];
        let own = ["--form", "powers", "--specimen-case", case, "--out", out];
        desk.pullout(common.iter().chain(&own).chain(more))
    };
    let specimen = |material: Value| {
        let mut case = fibre(&Value::Null);
        case["parts"]["matrix"]["material"] = material;
        case
    };
    let elastic = |isolate: bool| json!({ "plugin": "linear_elastic", "isolate": isolate });
    desk.case("here.json", &specimen(elastic(false)));
    desk.case("apart.json", &specimen(elastic(true)));
    let (here, apart) = (fit("here.json", "here", &[]), fit("apart.json", "apart", &[]));
    assert_eq!((here.code, apart.code), (1, 1), "three runs are too few: {}{}", here.stderr, apart.stderr);
    assert_eq!(here.stderr, apart.stderr);
    for file in ["powers-law.json", "powers-curve.csv", "fit.json"] {
        let [here, apart] = ["here", "apart"].map(|folder| fs::read(desk.path(folder).join(file)).expect("a result"));
        assert_eq!(here, apart, "{file}");
    }
    // a law that ends the process ends the worker
    if !compiled(&desk, "misbehaving.c", "misbehaving") {
        return;
    }
    let mut ends = material("misbehaving", Fault::Exit0 as u32);
    ends["props"] = json!([1000.0, Fault::Exit0 as u32, 1, 1]);
    desk.case("ends.json", &specimen(ends));
    let outcome = fit("ends.json", "ends", &[]).expect(1);
    assert!(outcome.stderr.contains("plugin 'misbehaving', step 1, increment "), "{}", outcome.stderr);
    assert!(outcome.stderr.contains("exit code 0"), "{}", outcome.stderr);
    assert!(json(&desk.path("apart/fit.json")).is_object());
}
