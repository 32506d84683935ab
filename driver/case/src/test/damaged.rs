//! Any bytes, shipped cases with damage, tables with damage, overrides of anything: read or refused, never a panic.

use super::super::table::{CsvFile, Table};
use super::super::{Case, CaseErrors, json, read_document, schema};
use super::{Bench, point_case};
use end_to_end_tests::fuzz::{self, damage, damaged, wild_word};
use proptest::collection::vec;
use proptest::prelude::*;
use proptest::sample::{Index, select};
use serde_json::Value;
use std::path::{Path, PathBuf};
use std::sync::LazyLock;

/// The cases that are shipped, with their places: data lie next to them.
static SHIPPED: LazyLock<Vec<(PathBuf, Vec<u8>)>> = LazyLock::new(|| {
    fn collect(folder: &Path, files: &mut Vec<(PathBuf, Vec<u8>)>) {
        let entries = std::fs::read_dir(folder).expect("a folder of cases");
        for path in entries.map(|entry| entry.expect("an entry").path()) {
            if path.is_dir() {
                collect(&path, files);
            } else if path.extension().is_some_and(|extension| extension == "json") {
                files.push((path.clone(), std::fs::read(&path).expect("a case")));
            }
        }
    }
    let mut files = Vec::new();
    collect(&end_to_end_tests::workspace("cases"), &mut files);
    // their specimens take long to mesh: the smaller ones of `random`
    files.retain(|(_, text)| !String::from_utf8_lossy(text).contains("_fibre\""));
    files.sort();
    assert!(files.len() > 50, "{} cases", files.len());
    files
});

/// Expects at least one problem, each with a message, and the exit code of bad input.
fn expect_words(outcome: Result<Case, CaseErrors>) {
    if let Err(errors) = outcome {
        assert!(!errors.problems.is_empty() && [2, 3].contains(&errors.exit_code()));
        assert!(errors.problems.iter().all(|problem| !problem.message.is_empty()));
    }
}

/// Reads text as if it stood in a file.
fn read_as(path: &Path, bytes: &[u8]) {
    let Ok(text) = std::str::from_utf8(bytes) else { return };
    if let Ok((document, _)) = json::parse(text) {
        expect_words(read_document(document, path, &[]));
    }
}

/// Characters that JSON is made of, so that some of it is well-formed.
fn json_like() -> impl Strategy<Value = String> {
    let piece = prop_oneof![
        4 => select(&["{", "}", "[", "]", ",", ":", "\"kind\":", "\"point\"", "\"steps\":", "{\"a\":"][..]).prop_map(str::to_owned),
        2 => wild_word(),
        1 => any::<char>().prop_map(String::from),
    ];
    vec(piece, 0..40).prop_map(|pieces| pieces.concat())
}

#[test]
fn nesting_of_any_depth_is_refused_in_words() {
    for (open, close) in [("[", "]"), ("{\"steps\":", "}"), ("[{\"repeat\":1,\"steps\":", "}]")] {
        for depth in [1, 60, 127, 128, 1000, 200_000] {
            let steps = open.repeat(depth) + "1" + &close.repeat(depth);
            let mut text = point_case().to_string();
            text = text.replacen("\"mode\"", &format!("\"description\":{steps},\"mode\""), 1);
            let closed = Bench::new().read_text(&text, &[]).expect_err("no description");
            assert_eq!(closed.exit_code(), 2);
            // never closed
            let open_ended = Bench::new().read_text(open.repeat(depth), &[]).expect_err("no JSON");
            assert!(open_ended.to_string().contains("not valid JSON"), "{open_ended}");
        }
    }
}

#[test]
fn a_specimen_of_too_many_elements_is_refused_before_it_is_made() {
    let case = serde_json::json!({
        "kind": "pullout",
        "mesh": { "specimen": { "type": "cook_membrane", "cells": 100_000 } },
        "parts": { "membrane": { "material": { "plugin": "linear_elastic" } } },
        "steps": [ { "increments": 1 } ]
    });
    let words = Bench::new().read(&case, &[]).expect_err("10^10 elements").to_string();
    assert!(words.contains("$.mesh.specimen: 100000 × 100000 cells are too many"), "{words}");
}

proptest! {
    #![proptest_config(fuzz::config(500))]

    #[test]
    fn any_bytes_do_no_harm(bytes in vec(any::<u8>(), 0..200)) {
        thread_local!(static BENCH: Bench = Bench::new());
        BENCH.with(|bench| expect_words(bench.read_text(&bytes, &[])));
    }

    #[test]
    fn any_signs_of_json_do_no_harm(text in json_like()) {
        read_as(Path::new("case.json"), text.as_bytes());
    }

    #[test]
    fn any_override_does_no_harm(texts in vec((vec(wild_path(), 1..4), wild_word()), 1..4)) {
        let mut document = point_case();
        for (path, value) in texts {
            let _ = json::set(&mut document, &format!("{}={value}", path.join(".")));
        }
        expect_words(read_document(document, Path::new("case.json"), &[]));
    }

    #[test]
    fn damaged_tables_do_no_harm(changes in damage()) {
        thread_local!(static FOLDER: tempfile::TempDir = tempfile::tempdir().expect("a temporary folder"));
        let table = b"# a comment\ntime, e11, s22\n0.5, 1e-4, 0\n2.0, 2e-4, -1.5\n3.0, 1e-4, 1\n";
        FOLDER.with(|folder| {
            let file = folder.path().join("table.csv");
            std::fs::write(&file, damaged(table, &changes)).expect("a table");
            match CsvFile::read(&file).and_then(|csv| Table::of(&csv, &["e11", "s22", "g12"])) {
                Ok(table) => assert_eq!(table.rows.len(), table.time_increments.len()),
                Err(problems) => assert!(!problems.is_empty() && problems.iter().all(|words| !words.is_empty())),
            }
            let _ = CsvFile::read(&file).map(|file| file.numbers(&[0], true));
        });
    }
}

/// Coarse specimens of each type, with the keys that each knows.
static SPECIMENS: LazyLock<Vec<(Value, Vec<String>)>> = LazyLock::new(|| {
    let coarse = |name: &str| match name {
        "perpendicular_fibre" => {
            serde_json::json!({ "type": name, "embedded_elements": 6, "interface_size": 0.6, "largest_size": 5 })
        }
        "inclined_fibre" => serde_json::json!({ "type": name, "mesh_size": 4 }),
        "fibres" => {
            let fibre = |name: &str, exit: f64| serde_json::json!({ "name": name, "exit": exit, "path": [{ "straight": 12.2 }, { "straight": 1.0 }] });
            serde_json::json!({ "type": name, "mesh_size": 4, "fibres": [fibre("a", -3.0), fibre("b", 3.0)] })
        }
        _ => serde_json::json!({ "type": name }),
    };
    let schema = schema();
    let types = schema["$defs"]["Specimen"]["oneOf"].as_array().expect("a union of specimens");
    let specimen = |of_type: &Value| {
        let properties = |of: &Value| of["properties"].as_object().cloned().unwrap_or_default();
        let reference = of_type["$ref"].as_str().and_then(|path| path.strip_prefix('#'));
        let parameters = reference.and_then(|path| schema.pointer(path)).map(properties).unwrap_or_default();
        let own = properties(of_type);
        let name = own["type"]["const"].as_str().expect("a name").to_owned();
        (coarse(&name), own.into_iter().chain(parameters).map(|(key, _)| key).collect())
    };
    types.iter().map(specimen).collect()
});

/// A value of a parameter, hardly the right one.
fn wild_parameter() -> impl Strategy<Value = Value> {
    prop_oneof![
        4 => select(&fuzz::WILD_NUMBERS[..]).prop_map(Value::from),
        4 => prop_oneof![0.0..2.0_f64, 0.0..100.0_f64].prop_map(Value::from),
        2 => (-1_i64..30).prop_map(Value::from),
        1 => select(&[1000_i64, 99_999, 100_000][..]).prop_map(Value::from),
        1 => any::<bool>().prop_map(Value::from),
        1 => select(&["straight", "thesis", "T3", "T6", "Q4", "Q8", ""][..]).prop_map(Value::from),
        1 => vec(0_i64..9, 0..3).prop_map(Value::from),
    ]
}

/// A case of a specimen that is complete, except for what its type asks for in addition to parts of these names.
fn specimen_case(specimen: Value) -> Value {
    let parts = [
        "fibre", "matrix", "plate", "cylinder", "membrane", "beam", "lower", "upper", "base", "strip", "block",
        "channel",
    ];
    let material = serde_json::json!({ "material": { "plugin": "linear_elastic" } });
    serde_json::json!({
        "kind": "pullout",
        "mesh": { "specimen": specimen },
        "parts": parts.map(|name| (name.to_owned(), material.clone())).into_iter().collect::<serde_json::Map<_, _>>(),
        "contact": { "law": { "plugin": "bond_slip", "props": { "normal_law": "hard" } } },
        "steps": [ { "slip": 0.1 } ]
    })
}

#[test]
fn every_type_of_specimen_has_keys() {
    assert!(SPECIMENS.len() > 10);
    assert!(SPECIMENS.iter().all(|(_, keys)| keys.len() > 2), "{:?}", *SPECIMENS);
}

proptest! {
    #![proptest_config(fuzz::config(300))]

    #[test]
    fn wild_specimens_do_no_harm(of_type in any::<Index>(), changes in vec((any::<Index>(), wild_parameter()), 1..4)) {
        let (mut specimen, keys) = SPECIMENS[of_type.index(SPECIMENS.len())].clone();
        for (key, value) in changes {
            specimen[&keys[key.index(keys.len())]] = value;
        }
        expect_words(read_document(specimen_case(specimen), Path::new("case.json"), &[]));
    }
}

proptest! {
    #![proptest_config(fuzz::config(2000))]

    #[test]
    fn damaged_cases_do_no_harm(case in any::<Index>(), changes in damage()) {
        let (path, text) = &SHIPPED[case.index(SHIPPED.len())];
        read_as(path, &damaged(text, &changes));
    }
}

/// A step of a path of `--set`, known or not.
fn wild_path() -> impl Strategy<Value = String> {
    prop_oneof![
        6 => select(&["material", "props", "E", "steps", "0", "1", "target", "e11", "mode", "kind", "increments", "until"][..])
            .prop_map(str::to_owned),
        1 => wild_word(),
    ]
}

#[test]
fn of_very_many_problems_the_first_are_reported_and_the_others_counted() {
    let mut case = point_case();
    for k in 0..100_000 {
        case[format!("unknown {k}")] = k.into();
    }
    let errors = Bench::new().read(&case, &[]).expect_err("unknown keys");
    assert_eq!(errors.problems.len(), 100_000);
    let text = errors.to_string();
    assert_eq!(text.lines().count(), 51);
    assert!(text.ends_with("case.json: and 99950 more problems"), "{text}");
    // wrong both in structure and in meaning
    let steps: Vec<Value> = (0..10_000).map(|_| serde_json::json!({ "increments": 0, "target": { "x": 1 } })).collect();
    let mut case = point_case();
    case["steps"] = steps.into();
    let errors = Bench::new().read(&case, &[]).expect_err("wrong steps");
    assert!(errors.problems.len() >= 20_000 && errors.to_string().lines().count() == 51);
}

#[test]
fn a_case_of_too_many_values_is_refused_before_they_are_read() {
    let mut case = point_case();
    case["material"]["props"] = vec![0; 1_000_000].into();
    let words = Bench::new().read(&case, &[]).expect_err("a million numbers").to_string();
    assert!(words.contains(": more than 1000000 values: numbers by the thousand belong into tables"), "{words}");
    case["material"]["props"] = vec![0; 900_000].into();
    let words = Bench::new().read(&case, &[]).expect_err("too many parameters").to_string();
    assert!(words.contains("$.material.props") && words.len() < 1000, "{words}");
}

#[test]
fn texts_that_would_act_on_a_terminal_are_refused_and_long_ones_cut() {
    let words = |key: &str, text: &str| {
        let mut case = point_case();
        case[key] = text.into();
        Bench::new().read(&case, &[]).map(drop).map_err(|errors| errors.to_string())
    };
    for (key, text) in [("title", "a\u{1b}[2J"), ("title", "two\nlines"), ("description", "\u{9b}"), ("a\u{7}", "b")] {
        let said = words(key, text).expect_err("a control character");
        assert!(said.contains("has a control character"), "{said}");
    }
    assert_eq!(words("description", "two\n\tlines"), Ok(()));
    let said = words("mode", &"long".repeat(30_000)).expect_err("no mode");
    assert!(said.len() < 1200 && !said.contains('\n'), "{said}");
}
