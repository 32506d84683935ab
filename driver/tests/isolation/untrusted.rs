//! `--untrusted`: a file from an unknown source chooses neither the plugins that are called nor the files that are read.

use super::point;
use super::program::Desk;
use end_to_end_tests::plugin;
use serde_json::{Value, json};
use std::os::unix::fs::symlink;

/// Makes a case within its folder, with a table, a measured curve, and links next to it.
fn desk() -> Desk {
    let desk = Desk::new();
    desk.write("secret.csv", "time,e11,s11\n1,0.001,30\n2,0.002,60\n");
    desk.write("job/tables/own.csv", "time,e11\n1,0.001\n2,0.002\n");
    desk.write("job/tables/curve.csv", "e11,s11\n0.001,30\n0.002,60\n");
    symlink("tables/own.csv", desk.path("job/within.csv")).expect("a link");
    symlink("../secret.csv", desk.path("job/out.csv")).expect("a link");
    symlink("..", desk.path("job/up")).expect("a link");
    desk
}

fn elastic() -> Value {
    point(json!({ "plugin": "linear_elastic" }))
}

fn with_table(table: &str) -> Value {
    let mut case = elastic();
    case["steps"] = json!([{ "table": table }]);
    case
}

fn with_curve(curve: &str) -> Value {
    let mut case = elastic();
    case["compare"] = json!([{ "file": curve, "file_x": "e11", "file_y": "s11", "x": "e11", "y": "s11" }]);
    case
}

fn with_mesh(file: &str) -> Value {
    json!({
        "kind": "pullout",
        "mesh": { "file": file },
        "parts": { "fibre": { "material": { "plugin": "linear_elastic" } } },
        "steps": [{ "slip": 0.01, "increments": 1 }],
    })
}

fn interface(table: &str) -> Value {
    json!({
        "kind": "interface",
        "material": { "plugin": "bond_slip" },
        "steps": [{ "table": table }],
    })
}

#[test]
fn what_a_case_may_name() {
    let desk = desk();
    let mut of_folder = elastic();
    of_folder["job_folder"] = json!("tables");
    let allowed = [
        elastic(),
        of_folder,
        with_table("tables/own.csv"),
        with_table("./within.csv"),
        with_curve("tables/curve.csv"),
    ];
    for case in allowed {
        desk.case("job/case.json", &case);
        desk.pullout(["check", "--untrusted", "job/case.json"]).expect(0);
        desk.pullout(["run", "--untrusted", "--quiet", "job/case.json", "--out", "out"]).expect(0);
    }
    let absolute = desk.path("secret.csv").to_string_lossy().into_owned();
    let library = plugin("linear_elastic").to_string_lossy().into_owned();
    let material = |material: Value| point(material);
    let folder = |folder: &str| {
        let mut case = elastic();
        case["job_folder"] = json!(folder);
        case
    };
    let refused = [
        ("$.material.plugin: is a file", material(json!({ "plugin": library }))),
        ("$.material.plugin: is a file", material(json!({ "plugin": "./libmine.so" }))),
        ("$.material.symbol: ", material(json!({ "plugin": "linear_elastic", "symbol": "linear_elastic_umat_" }))),
        ("$.steps[0].table: ", with_table(&absolute)),
        ("$.steps[0].table: ", with_table("../secret.csv")),
        ("$.steps[0].table: ", with_table("tables/../../secret.csv")),
        ("$.steps[0].table: ", with_table("out.csv")),
        ("$.steps[0].table: ", with_table("up/secret.csv")),
        ("$.steps[0].table: ", interface("up/secret.csv")),
        ("$.compare[0].file: ", with_curve("out.csv")),
        ("$.mesh.file: ", with_mesh("up/secret.csv")),
        ("$.job_folder: ", folder("..")),
        ("$.job_folder: ", folder("up")),
        ("$.job_folder: ", folder("/")),
    ];
    for (place, case) in refused {
        desk.case("job/case.json", &case);
        for command in ["check", "run"] {
            let outcome = desk.pullout([command, "--untrusted", "job/case.json"]).expect(2);
            assert!(outcome.stderr.contains(place), "'{place}' is not in {}", outcome.stderr);
            assert!(outcome.stderr.contains("--untrusted"), "{}", outcome.stderr);
        }
    }
    assert!(!desk.path("out/case").exists());
    let outcome = desk.pullout(["check", "--untrusted", "--in-process", "job/case.json"]).expect(2);
    assert!(outcome.stderr.contains("cannot be used with"), "{}", outcome.stderr);
}

#[test]
fn what_a_study_may_name() {
    let desk = desk();
    desk.case("case.json", &elastic());
    desk.case("job/case.json", &elastic());
    desk.case("job/reads.json", &with_table("out.csv"));
    let study = |base: &str, series: Value| {
        let members = json!([{ "label": "a", "set": { "material.props.E": 1000.0 } }]);
        let mut study = json!({ "kind": "study", "base": base, "members": members });
        if series.is_array() {
            study["series"] = series;
        }
        desk.case("job/family.json", &study);
    };
    study("case.json", Value::Null);
    desk.pullout(["study", "--untrusted", "job/family.json", "--out", "out", "--quiet"]).expect(0);
    let run = std::fs::read_to_string(desk.path("out/runs/a/run.json")).expect("a mark");
    assert!(run.contains("case.json"), "{run}");
    for (base, series, place) in [
        ("../case.json", Value::Null, "$.base: "),
        ("up/case.json", Value::Null, "$.base: "),
        ("case.json", json!([{ "name": "s", "base": "../case.json" }]), "$.series[0].base: "),
        ("reads.json", Value::Null, "$.steps[0].table: "),
    ] {
        study(base, series);
        for command in ["check", "study"] {
            let outcome = desk.pullout([command, "--untrusted", "job/family.json"]).expect(2);
            assert!(outcome.stderr.contains(place) && outcome.stderr.contains("--untrusted"), "{}", outcome.stderr);
        }
    }
}

#[test]
fn what_a_sweep_may_name() {
    let desk = desk();
    let sweep = |base: Value| {
        desk.case("job/sweep.json", &json!({ "kind": "sweep", "base": base, "parameters": { "title": ["a", "b"] } }));
    };
    let plan = |flags: &[&str], code: i32| {
        desk.pullout(["sweep", "plan", "job/sweep.json", "--out", "store"].iter().chain(flags)).expect(code)
    };
    let work = |code: i32| desk.pullout(["sweep", "work", "store", "--untrusted", "--quiet"]).expect(code);
    for table in ["../secret.csv", "out.csv"] {
        sweep(with_table(table));
        let refused = plan(&["--untrusted"], 2);
        assert!(
            refused.stderr.contains("steps[0].table") && refused.stderr.contains("--untrusted"),
            "{}",
            refused.stderr
        );
    }
    sweep(with_table("tables/own.csv"));
    plan(&["--untrusted"], 0);
    work(0);
    // a library that the plan brought along
    sweep(point(json!({ "plugin": plugin("sound_damage").to_string_lossy(), "props": [] })));
    plan(&["--untrusted"], 2);
    sweep(point(json!({ "plugin": "linear_elastic", "symbol": "linear_elastic_umat_" })));
    plan(&["--untrusted"], 2);
    plan(&[], 0);
    let refused = work(2);
    assert!(refused.stderr.contains("linear_elastic_umat_"), "{}", refused.stderr);
    // a plan that leads out of its own folder, and other files than were planned
    sweep(with_table("tables/own.csv"));
    plan(&[], 0);
    let file = desk.path("store/sweep.json");
    let whole = std::fs::read_to_string(&file).expect("a plan");
    let bundle = crate::program::json(&file)["bundles"][0].as_str().expect("a name").to_owned();
    for forged in ["../../job", "..", "/", "files"] {
        std::fs::write(&file, whole.replace(&bundle, forged)).expect("a plan");
        for flags in [&["--untrusted"][..], &[]] {
            desk.pullout(["sweep", "work", "store"].iter().chain(flags)).expect(2);
        }
    }
    std::fs::write(&file, &whole).expect("a plan");
    desk.write(&format!("store/files/{bundle}/tables/own.csv"), "time,e11\n1,0.5\n2,0.6\n");
    let refused = work(2);
    assert!(refused.stderr.contains(&bundle), "{}", refused.stderr);
}
