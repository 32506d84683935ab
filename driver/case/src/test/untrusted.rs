//! Cases from unknown sources: each text of the format that names a file goes through [`crate::Reader`].

use super::{Bench, interface_case, point_case};
use crate::{Reader, read_by, schema};
use serde_json::{Value, json};
use std::collections::BTreeSet;

/// Members of the format that name files or folders.
const PATHS: [&str; 7] = ["base", "cache", "design", "file", "files", "job_folder", "table"];
/// Members whose texts are no paths: names within the case, words to be shown, members of other cases.
const NAMES: [&str; 41] = [
    "$schema",
    "above",
    "angle_key",
    "below",
    "claim",
    "cmname",
    "column",
    "concrete",
    "curves",
    "description",
    "drive",
    "edges",
    "exit",
    "file_x",
    "file_y",
    "label",
    "length_key",
    "load",
    "master",
    "maximum_at",
    "members",
    "minimum_at",
    "name",
    "node",
    "nodes",
    "of",
    "over",
    "over_series",
    "parts",
    "quantity",
    "ratio_of",
    "series",
    "slave",
    "slip",
    "supports",
    "tail",
    "tie",
    "title",
    "to",
    "unit",
    "x",
];
/// Names of laws and of what is called in a library, which have tests of their own.
const OF_PLUGINS: [&str; 3] = ["plugin", "symbol", "y"];

/// Adds the members of a schema whose values are texts or lists of texts.
fn collect(schema: &Value, all: &Value, found: &mut BTreeSet<String>) {
    match schema {
        Value::Object(members) => {
            for (name, member) in members.get("properties").and_then(Value::as_object).into_iter().flatten() {
                if is_text(member, all) {
                    found.insert(name.clone());
                }
            }
            members.values().for_each(|member| collect(member, all, found));
        }
        Value::Array(entries) => entries.iter().for_each(|entry| collect(entry, all, found)),
        _ => {}
    }
}

fn is_text(schema: &Value, all: &Value) -> bool {
    if !schema["enum"].is_null() || !schema["const"].is_null() {
        return false;
    }
    if let Some(reference) = schema["$ref"].as_str() {
        return all.pointer(reference.trim_start_matches('#')).is_some_and(|schema| is_text(schema, all));
    }
    let has_type =
        |word: &str| schema["type"] == word || schema["type"].as_array().is_some_and(|t| t.contains(&word.into()));
    let branches = ["anyOf", "oneOf"].into_iter().filter_map(|key| schema[key].as_array()).flatten();
    has_type("string")
        || has_type("array") && is_text(&schema["items"], all)
        || branches.into_iter().any(|branch| is_text(branch, all))
}

/// A new member of the format whose value is a text is listed above, and if it names a file, tried below.
#[test]
fn each_text_of_the_format_is_known_to_name_a_file_or_not() {
    let (schema, mut found) = (schema(), BTreeSet::new());
    collect(&schema, &schema, &mut found);
    let known: BTreeSet<String> =
        PATHS.iter().chain(&NAMES).chain(&OF_PLUGINS).map(|name| (*name).to_owned()).collect();
    assert_eq!(found, known);
}

/// What leads out of the folder is refused at its place: absolute, upwards, by a link, by a link to what is not there.
#[test]
fn each_path_of_a_case_goes_through_the_reader() {
    let bench = Bench::new();
    let outside = tempfile::tempdir().expect("a folder");
    std::fs::write(outside.path().join("path.csv"), "time,e11\n1,1e-4\n").expect("a file");
    let link = |to: &std::path::Path, name: &str| {
        std::os::unix::fs::symlink(to, bench.0.path().join(name)).expect("a link");
    };
    link(outside.path(), "out");
    link(&outside.path().join("absent"), "dangling");
    let set = |mut case: Value, place: &str, value: Value| {
        *case.pointer_mut(place).expect("a place") = value;
        case
    };
    let with = |mut case: Value, key: &str, value: Value| {
        case[key] = value;
        case
    };
    let compare = json!([{ "file": "@", "file_x": "e11", "file_y": "s11", "x": "e11", "y": "s11" }]);
    let mesh = json!({
        "kind": "pullout", "mesh": { "file": "@" },
        "parts": { "fibre": { "material": { "plugin": "linear_elastic" } } }, "steps": [{ "slip": 0.01, "increments": 1 }],
    });
    let bridging = |fibre: Value| {
        json!({
            "kind": "bridging", "volume_fraction": 0.01, "matrix": { "E": 30000, "ft": 3 },
            "fibre": fibre,
        })
    };
    let closed = json!({ "diameter": 0.4, "length": 30, "E": 2e5, "model": "closed", "tau": 2 });
    let of_model = |model: &str, key: &str| {
        let mut fibre = json!({ "diameter": 0.4, "length": 30, "E": 2e5, "model": model, "base": "fibre.json" });
        fibre[key] = json!("@");
        bridging(fibre)
    };
    let cases = [
        ("steps[0].table", with(point_case(), "steps", json!([{ "table": "@" }]))),
        ("steps[0].table", with(interface_case(), "steps", json!([{ "table": "@" }]))),
        ("increments.recorded", with(point_case(), "increments", json!({ "recorded": "@" }))),
        ("compare[0].file", with(point_case(), "compare", compare)),
        ("files[0]", with(point_case(), "files", json!(["@"]))),
        ("job_folder", with(point_case(), "job_folder", json!("@"))),
        ("mesh.file", mesh),
        ("orientation.file", with(bridging(closed), "orientation", json!({ "type": "histogram", "file": "@" }))),
        ("fibre.file", bridging(json!({ "diameter": 0.4, "length": 30, "E": 2e5, "model": "table", "file": "@" }))),
        ("fibre.base", set(of_model("fe", "base"), "/fibre/base", json!("@"))),
        ("fibre.cache", of_model("fe", "cache")),
    ];
    let absolute = outside.path().join("path.csv").display().to_string();
    for (place, case) in &cases {
        for name in [absolute.as_str(), "../path.csv", "out/path.csv", "out/absent", "dangling"] {
            // the cache lies in the folder in which the program works
            if *place == "fibre.cache" && !name.starts_with(['.', '/']) {
                continue;
            }
            let text = case.to_string().replace("\"@\"", &json!(name).to_string());
            std::fs::write(bench.path(), text).expect("the case file");
            let file = bench.path();
            let reader = Reader::new(file.parent().expect("a folder"), &[], true);
            let errors = read_by(reader, &file, None, &[]).expect_err("it is refused");
            let at_place = |problem: &crate::CaseProblem| {
                problem.place.as_ref().is_some_and(|at| at.to_string() == format!("$.{place}"))
                    && problem.message.contains("leads out")
            };
            assert!(errors.problems.iter().any(at_place), "{place}, {name}: {errors}");
        }
    }
}
