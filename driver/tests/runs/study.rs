//! `pullout study`: a family of material points, whose peaks are known, and of specimens.

use crate::program::{self, Desk, Table, json, send};
use rustix::process::Signal;
use serde_json::{Value, json as value};

/// J2 in uniaxial tension: the peak is the yield stress (no hardening), the work follows.
fn family(members: &[f64], claims: Value) -> Value {
    let member = |stress: &f64| value!({ "label": stress.to_string(), "x": stress, "set": { "material.props.hardening": [[stress, 0.0]] } });
    value!({
        "kind": "study",
        "base": "cases/base.json",
        "x": { "name": "σ_{y}", "unit": "MPa" },
        "members": members.iter().map(member).collect::<Vec<_>>(),
        "series": [
            { "name": "stiff" },
            { "name": "soft", "set": { "material.props.E": 100_000.0 } }
        ],
        "claims": claims
    })
}

const STIFF: f64 = 200_000.0;

fn desk() -> Desk {
    let desk = Desk::new();
    let base = value!({
        "kind": "point",
        "material": { "plugin": "j2_plasticity", "props": { "E": STIFF, "nu": 0.3, "hardening": [[1.0, 0.0]] } },
        "mode": "3d",
        "steps": [{ "increments": 100, "target": { "e11": 0.01 } }],
        "output": { "plots": false }
    });
    desk.case("cases/base.json", &base);
    desk
}

#[test]
fn a_family_of_points_has_its_peaks_works_tables_and_claims() {
    let desk = desk();
    let claims = value!([
        { "claim": "the peak grows", "expect": { "trend": "increasing" } },
        { "claim": "the stiffer one has more work", "series": "stiff", "quantity": "work", "expect": { "above": "soft" } },
        { "claim": "300 is the least", "expect": { "minimum_at": 300 } }
    ]);
    desk.case("family.json", &family(&[400.0, 200.0, 300.0], claims));
    let printed = desk.pullout(["study", "family.json", "--out", "out", "--jobs", "2"]).expect(0).stdout;
    assert!(printed.contains("[6/6] ") && printed.contains("6 of 6 runs done"), "{printed}");
    let table = std::fs::read_to_string(desk.path("out/study.csv")).expect("study.csv");
    let header = "series,label,x,status,peak,slip_at_peak,work,work_to,end,reach,increments,iterations,cutbacks";
    assert!(table.starts_with(header) && table.lines().count() == 7, "{table}");
    let study = json(&desk.path("out/study.json"));
    for run in study["runs"].as_array().expect("runs") {
        let (yield_stress, modulus) = (run["x"].as_f64().unwrap(), if run["series"] == "stiff" { STIFF } else { 1e5 });
        let peak = run["peak"].as_f64().unwrap();
        assert!((peak / yield_stress - 1.0).abs() < 1e-6, "{run}");
        // σ_y ε − σ_y²/(2E), yield at a line of the history or between two
        let work = yield_stress * 0.01 - yield_stress.powi(2) / (2.0 * modulus);
        assert!((run["work"].as_f64().unwrap() / work - 1.0).abs() < 2e-3, "{run}");
        assert!(desk.path("out").join(run["folder"].as_str().unwrap()).join("history.csv").is_file());
    }
    let verdicts: Vec<&str> =
        study["claims"].as_array().unwrap().iter().map(|claim| claim["verdict"].as_str().unwrap()).collect();
    assert_eq!(verdicts, ["found", "found", "not found"]);
    for picture in ["s11_e11", "s11_e11_soft", "peak", "peak_normalised", "work", "work_normalised"] {
        for kind in ["svg", "png"] {
            assert!(desk.path(&format!("out/plots/{picture}.{kind}")).is_file(), "{picture}.{kind}");
        }
    }
    // the pictures of a run and an overlay of runs come as PNG on demand
    let arguments = ["plot", "out/soft/300", "out/stiff/300", "--out", "overlay", "--png"];
    assert_eq!(desk.pullout(arguments).code, 2, "this case draws no pictures");
    // those of a study as PDF
    assert_eq!(desk.pullout(["plot", "out"]).code, 2, "no format is named");
    desk.pullout(["plot", "out", "--pdf"]).expect(0);
    assert!(std::fs::read(desk.path("out/plots/peak.pdf")).expect("a PDF").starts_with(b"%PDF-"));
    let report = std::fs::read_to_string(desk.path("out/report.html")).expect("report.html");
    assert!(report.contains("fails") && report.contains("<svg") && !report.contains("<img"));
    assert_eq!(Table::read(&desk.path("out/soft/300/history.csv")).rows.len(), 101);
}

#[test]
fn what_is_done_is_kept_until_its_case_changes() {
    let desk = desk();
    let write = |claims: Value, members: &[f64]| desk.case("family.json", &family(members, claims));
    write(value!([]), &[200.0, 300.0]);
    let study = |more: &[&str]| {
        let arguments = [&["study", "family.json", "--out", "out"], more].concat();
        let printed = desk.pullout(arguments).expect(0).stdout;
        printed.lines().filter(|line| line.starts_with('[')).count()
    };
    assert_eq!(study(&[]), 4);
    assert_eq!(study(&[]), 0);
    // no number depends on the words of a case
    let mut base = json(&desk.path("cases/base.json"));
    base["title"] = "Corrected".into();
    base["description"] = "Nobody had described it.".into();
    desk.case("cases/base.json", &base);
    assert_eq!(study(&[]), 0);
    // claims make no run necessary, another member makes its own
    write(value!([{ "claim": "it grows", "expect": { "trend": "increasing" } }]), &[200.0, 300.0, 350.0]);
    assert_eq!(study(&[]), 2);
    assert_eq!(study(&["--only", "soft/200"]), 1);
    assert_eq!(study(&["--only", "*/350"]), 2);
    assert_eq!(study(&["--set", "steps.0.increments=50", "--only", "stiff"]), 3);
    // the others are no longer those of the case
    let states: Vec<Value> = json(&desk.path("out/study.json"))["runs"].as_array().unwrap().clone();
    assert_eq!(states.iter().filter(|run| run["status"] == "not run").count(), 3);
    assert_eq!(json(&desk.path("out/study.json"))["claims"][0]["verdict"], "cannot be told");
    assert_eq!(study(&["--force"]), 6);
    let printed = desk.pullout(["study", "family.json", "--only", "sofd/200"]).expect(2).stderr;
    assert!(printed.contains("there is no such run") && printed.contains("soft/200"), "{printed}");
}

#[test]
fn a_run_that_fails_keeps_its_rows_and_the_others_go_on() {
    let desk = desk();
    // a stress beyond the yield stress cannot be reached
    let mut study =
        family(&[200.0, 300.0], value!([{ "claim": "the peak grows", "expect": { "trend": "increasing" } }]));
    study["members"][0]["set"]["steps.0.target"] = value!({ "s11": 250 });
    desk.case("family.json", &study);
    let outcome = desk.pullout(["study", "family.json", "--out", "out"]).expect(1);
    assert!(outcome.stderr.contains("stiff/200: ") && outcome.stdout.contains("2 of 4 runs done"), "{outcome:?}");
    let result = json(&desk.path("out/study.json"));
    assert_eq!(result["runs"][0]["status"], "failed");
    assert_eq!(result["claims"][0]["verdict"], "cannot be told");
    assert!(Table::read(&desk.path("out/stiff/200/history.csv")).rows.len() > 10);
    let report = std::fs::read_to_string(desk.path("out/report.html")).expect("report.html");
    assert!(report.contains("Runs that failed") && report.contains("200 MPa (failed)"));
    // one of two series alone
    let beyond = study["members"][0]["set"].as_object_mut().and_then(|set| set.remove("steps.0.target"));
    study["series"][1]["set"]["steps.0.target"] = beyond.expect("the target from above");
    desk.case("family.json", &study);
    desk.pullout(["study", "family.json", "--out", "half"]).expect(1);
    let report = std::fs::read_to_string(desk.path("half/report.html")).expect("report.html");
    assert!(report.contains("200 MPa (1 of 2 failed)"));
}

#[test]
fn everything_wrong_is_reported_at_once_and_nothing_is_run() {
    let desk = desk();
    let mut study = family(
        &[200.0, 300.0],
        value!([
            { "claim": "a", "series": "sofd", "expect": { "trend": "increasing" } },
            { "claim": "b", "expect": { "maximum_at": 45 } },
            { "claim": "c", "quantity": { "column": "s1" }, "expect": { "greater_than": 1 } },
            { "claim": "d", "expect": { "trend": "increasing" } },
            { "claim": "e", "expect": { "greater_than": 2, "less_than": 1 } },
            { "claim": "f", "expect": { "trend": "increasing" } },
            { "claim": "g", "expect": { "maximum_between": [200, 300] } },
            { "claim": "h", "expect": { "maximum_between": [100, 400] } }
        ]),
    );
    study["members"][1]["set"]["material.props.F"] = value!(1);
    study["members"][0]["label"] = value!("a/b");
    let mut of_structure = study.clone();
    of_structure["serie"] = value!([]);
    for (index, expectation) in [(3, value!({ "trend": "upwards" })), (5, value!({ "increasing": true }))] {
        of_structure["claims"][index]["expect"] = expectation;
    }
    let printed = |study: &Value| {
        desk.case("family.json", study);
        desk.pullout(["study", "family.json", "--out", "out"]).expect(2).stderr
    };
    let first = printed(&of_structure);
    for expected in [
        "$.serie: unknown key; nearest valid name: 'series'",
        "$.claims[3].expect.trend: ",
        "$.claims[5].expect.increasing: unknown key; valid names: above, below, curve_within, done, greater_than, less_than, \
         maximum_at, maximum_between, minimum_at, of, over_series, ratio_of, to, tolerance, trend, within",
    ] {
        assert!(first.contains(expected), "{expected}\n{first}");
    }
    let then = printed(&study);
    for expected in [
        "$.members[0].label: 'a/b' names a directory",
        "$.members[1]: stiff/300, soft/300: cases/base.json: $.material.props.F: ",
        "$.claims[0].series: there is no series 'sofd'; nearest valid name: 'soft'",
        "$.claims[1].expect.maximum_at: no member has x = 45; valid are 200, 300",
        "$.claims[2].quantity.column: the histories have no column 's1'; nearest valid name: 's11'",
        "$.claims[4].expect: nothing is greater than 2 and less than 1",
        "$.claims[6].expect.maximum_between: no member has an x strictly between 200 and 300",
        "$.claims[7].expect.maximum_between: every member has an x strictly between 100 and 400",
    ] {
        assert!(then.contains(expected), "{expected}\n{then}");
    }
    assert!(!desk.path("out").exists());
    // in the right command
    let printed = desk.pullout(["run", "family.json"]).expect(2).stderr;
    assert!(printed.contains("`pullout study` runs it"), "{printed}");
    let printed = desk.pullout(["study", "cases/base.json"]).expect(2).stderr;
    assert!(printed.contains("$.kind: a study has the kind \"study\", this is a case of kind 'point'"), "{printed}");
    let printed = desk.pullout(["check", "family.json"]).expect(2).stderr;
    assert!(printed.contains("$.claims[0].series"), "{printed}");
}

#[test]
fn names_that_no_folder_or_page_takes_are_refused_with_their_place() {
    let desk = desk();
    let refused = |change: &dyn Fn(&mut Value), expected: &str| {
        let mut study = family(&[200.0, 300.0], value!([]));
        change(&mut study);
        desk.case("family.json", &study);
        let stderr = desk.pullout(["study", "family.json", "--out", "out"]).expect(2).stderr;
        assert!(stderr.contains(expected), "{stderr}");
        assert!(!desk.path("out").exists());
    };
    refused(
        &|study| study["series"][0]["name"] = value!("study.csv"),
        "$.series[0].name: is a name in the study's own",
    );
    refused(
        &|study| study["series"][1]["name"] = value!("Report.html"),
        "$.series[1].name: is a name in the study's own",
    );
    refused(
        &|study| study["members"][1]["label"] = value!("a".repeat(300)),
        "$.members[1].label: names a directory: 1 to",
    );
    refused(&|study| study["members"][0]["title"] = value!("a\u{7}b"), "$.members[0].title: has a control character");
    refused(&|study| study["title"] = value!("a\nb"), "$.title: has a control character");
}

#[test]
fn an_interrupted_study_keeps_what_is_done_and_goes_on() {
    let desk = desk();
    let mut study = family(&[200.0, 300.0], value!([]));
    study["members"][1]["set"]["steps.0.increments"] = value!(100_000_000);
    desk.case("family.json", &study);
    let mut process = program::command();
    process.current_dir(desk.path("")).args(["study", "family.json", "--out", "out", "--jobs", "1"]);
    process.stdout(std::process::Stdio::null()).stderr(std::process::Stdio::piped());
    let mut child = process.spawn().expect("the program starts");
    let history = desk.path("out/stiff/300/history.csv");
    let deadline = std::time::Instant::now() + std::time::Duration::from_secs(120);
    while !std::fs::metadata(&history).is_ok_and(|file| file.len() > 100_000) {
        assert!(std::time::Instant::now() < deadline && child.try_wait().expect("a child").is_none(), "no rows");
        std::thread::sleep(std::time::Duration::from_millis(2));
    }
    send(Signal::TERM, child.id());
    let output = child.wait_with_output().expect("an end");
    let stderr = String::from_utf8(output.stderr).expect("UTF-8");
    assert_eq!(output.status.code(), Some(143), "{stderr}");
    assert!(stderr.contains("interrupted by SIGTERM: 1 of 4 runs are done and kept"), "{stderr}");
    let statuses = |study: Value| -> Vec<String> {
        study["runs"]
            .as_array()
            .expect("runs")
            .iter()
            .map(|run| run["status"].as_str().expect("a status").into())
            .collect()
    };
    assert_eq!(statuses(json(&desk.path("out/study.json"))), ["done", "interrupted", "not run", "not run"]);
    study["members"][1]["set"]["steps.0.increments"] = value!(100);
    desk.case("family.json", &study);
    let printed = desk.pullout(["study", "family.json", "--out", "out"]).expect(0).stdout;
    assert!(printed.contains("4 of 4 runs done (1 as they were)"), "{printed}");
}
