//! Mutated documents, one for each seed: no panic, and no word of the machinery in a message.
//!
//! The long form, with a limit on memory:
//! `(ulimit -v 8000000; PROPTEST_CASES=1000000 cargo test -p driver --lib case::test::random)`; so for `case::test::damaged`.

use super::super::{document, structure};
use super::specimen::pullout_case;
use super::{Bench, interface_case, point_case, schema_accepts};
use end_to_end_tests::fuzz::{self, WILD_NUMBERS, WILD_WORDS};
use fastrand::Rng;
use proptest::test_runner::TestRunner;
use serde_json::{Value, json};
use std::cell::Cell;

fn value(random: &mut Rng) -> Value {
    let f = json!([[1, 0, 0], [0, 1, 0.5], [0, 0, 1]]);
    let choices = [
        json!(null),
        json!(true),
        json!(0),
        json!(-1),
        json!(2.5),
        json!(1e300),
        json!("hold"),
        json!("plane_stress"),
        json!(""),
        json!("abs(s11)"),
        json!([]),
        json!([1, 2]),
        json!([[1, 2]]),
        json!({}),
        json!({ "e11": 1 }),
        json!("path.csv"),
        json!("text.csv"),
        json!({ "table": "path.csv" }),
        f,
        json!({ "repeat": 3, "steps": [{ "increments": 2 }] }),
        json!({ "quantity": "s11", "less_than": 0 }),
        json!([{ "s22": 1, "s11": 0.5 }]),
        json!({ "slip": 1 }),
        json!({ "nodes": "side", "direction": "x" }),
        json!({ "tie": "surface", "to": "hole" }),
        json!({ "hard": {} }),
        json!("hole"),
        json!(18_446_744_073_709_551_615_u64),
        json!(i64::MIN),
        json!("NaN"),
        json!("linear_elastic"),
        json!(random.choice(WILD_WORDS)),
        // not finite: null in JSON
        json!(random.choice(WILD_NUMBERS)),
        nested(random),
    ];
    random.choice(choices).expect("there are some")
}

/// Arrays, objects or cycles in each other, no deeper than what JSON text is read.
fn nested(random: &mut Rng) -> Value {
    let (depth, what) = (random.usize(..60), random.usize(..3));
    (0..depth).fold(json!(1), |inner, _| match what {
        0 => json!([inner]),
        1 => json!({ "steps": inner }),
        _ => json!([{ "repeat": 1, "steps": inner }]),
    })
}

fn key(random: &mut Rng) -> &'static str {
    const KEYS: [&str; 33] = [
        "e11",
        "s22",
        "g12",
        "F",
        "target",
        "time",
        "table",
        "repeat",
        "steps",
        "cycles",
        "until",
        "constraints",
        "props",
        "nstatv",
        "symbol",
        "mode",
        "nlgeom",
        "measure",
        "initial",
        "strain",
        "predef",
        "temperature",
        "compare",
        "E",
        "x y",
        "slip",
        "direction",
        "nodes",
        "width",
        "specimen",
        "increments",
        "thickness",
        "drives",
    ];
    random.choice(KEYS).expect("there are some")
}

/// Changes one place of the document.
fn mutate(random: &mut Rng, document: &mut Value) {
    match document {
        Value::Object(members) if random.usize(..4) > 0 && !members.is_empty() => {
            let place = random.choice(members.keys()).cloned().unwrap_or_default();
            match random.usize(..8) {
                0 => drop(members.shift_remove(&place)),
                1 => drop(members.insert(key(random).into(), value(random))),
                _ => mutate(random, &mut members[&place]),
            }
        }
        Value::Array(elements) if random.usize(..4) > 0 && !elements.is_empty() => {
            let index = random.usize(..elements.len());
            match random.usize(..6) {
                0 => drop(elements.remove(index)),
                1 => elements.push(value(random)),
                _ => mutate(random, &mut elements[index]),
            }
        }
        other => *other = value(random),
    }
}

/// Documents with most keys of their kind: a point of contact, a specimen, a point.
fn full_documents() -> [Value; 3] {
    let mut full = point_case();
    full["initial"] = json!({ "strain": [0, 0, 0, 0, 0, 0], "statev": [0, 0], "time": 1 });
    full["until"] = json!({ "quantity": "abs(e11)", "greater_than": 1 });
    full["compare"] =
        json!([{ "file": "curve.csv", "file_x": "strain", "file_y": "stress_MPa", "x": "e11", "y": "s11" }]);
    full["steps"] = json!([
        { "increments": 3, "target": { "e11": 1 }, "constraints": [{ "s22": 1, "s11": -0.5, "equals": 0 }] },
        { "repeat": 2, "steps": [{ "table": "path.csv" }, { "increments": 1, "target": { "s11": "hold" } }] }
    ]);
    let mut specimen = pullout_case();
    specimen["loads"] = json!({ "side": { "pressure": 1 } });
    specimen["couplings"] = json!([{ "tie": "fibre_bottom", "to": "bottom" }]);
    specimen["controls"] = json!({ "max_iterations": 5 });
    specimen["steps"] = json!([
        { "slip": 0.1, "drives": { "side": 1 }, "increments": { "initial": 0.1 } },
        { "repeat": 2, "steps": [{ "slip": 0, "increments": 3 }] }
    ]);
    [interface_case(), specimen, full]
}

/// A document with one to three places changed.
fn mutated(mut document: Value, random: &mut Rng) -> Value {
    for _ in 0..=random.usize(..3) {
        mutate(random, &mut document);
    }
    document
}

/// Documents of all kinds with much that they may hold.
fn all_documents() -> Vec<Value> {
    let columns = json!({ "x": "slip", "y": "load" });
    let study = json!({
        "kind": "study", "title": "a", "base": "case.json", "set": { "nlgeom": true }, "x": { "name": "E", "unit": "MPa" },
        "members": [{ "label": "a", "x": 1, "set": { "steps.0.increments": 2 } }], "series": [{ "name": "s", "base": "b.json" }],
        "curve": columns, "work_to": 1, "overlays": [columns],
        "claims": [
            { "claim": "it grows", "series": "s", "members": ["a", 1], "quantity": { "column": "load", "at": 0.5, "over": ["x"] },
              "expect": { "trend": "increasing", "tolerance": 0.1 } },
            { "claim": "it is near", "series": ["s"], "quantity": "peak", "expect": { "within": 0.1, "of": 1 } }
        ]
    });
    let sweep = json!({
        "kind": "sweep", "base": { "kind": "point" }, "set": { "nlgeom": true }, "parameters": { "a": [1, 2] },
        "points": [{ "a": 1 }], "design": "table.csv", "quantities": { "q": "end", "r": { "column": "load", "at": "peak" } },
        "curve": columns, "work_to": 1, "curves": ["load"], "grid": [1, 2]
    });
    let law = json!([[0.01, 3], [1, 0]]);
    let bridging = json!({
        "kind": "bridging",
        "fibre": { "model": "shear_lag", "diameter": 0.55, "length": 30, "E": 200000, "law": law, "inclination": { "type": "exp", "f": 0.5 } },
        "volume_fraction": 0.01,
        "matrix": { "E": 30000, "ft": 3, "Gf": 0.1 },
        "orientation": { "type": "random3d" }, "openings": { "to": 1, "points": 5, "spacing": "even" }, "beam": {}, "scatter": {},
        "compare": [{ "file": "curve.csv", "file_x": "strain", "file_y": "stress_MPa", "x": "w", "y": "sigma" }]
    });
    full_documents().into_iter().chain([study, sweep, bridging]).collect()
}

/// Returns what serde says against a document.
fn refusal_by_serde(document: &Value) -> Option<String> {
    fn refusal<T: serde::de::DeserializeOwned>(document: &Value) -> Option<String> {
        T::deserialize(document).err().map(|error| error.to_string())
    }
    match document["kind"].as_str() {
        Some("interface") => refusal::<document::InterfaceCase>(document),
        Some("pullout") => refusal::<document::PulloutCase>(document),
        Some("bridging") => refusal::<document::bridging::BridgingCase>(document),
        Some(structure::STUDY) => refusal::<document::study::StudyFile>(document),
        Some(structure::SWEEP) => refusal::<document::sweep::SweepFile>(document),
        _ => refusal::<document::PointCase>(document),
    }
}

#[test]
fn serde_reads_all_documents_whose_structure_is_right() {
    let documents = all_documents();
    for document in &documents {
        assert_eq!(structure::check(document["kind"].as_str().expect("a kind"), document), [], "{document}");
    }
    let mut read = vec![0; documents.len()];
    for seed in 0..12_000 {
        let mut random = Rng::with_seed(seed);
        let index = seed as usize % documents.len();
        let document = mutated(documents[index].clone(), &mut random);
        let kind = document["kind"].as_str().unwrap_or_default();
        if structure::schema_of_kind(kind).is_some() && structure::check(kind, &document).is_empty() {
            assert_eq!(refusal_by_serde(&document), None, "{document}");
            read[index] += 1;
        }
    }
    assert!(read.iter().all(|count| *count > 20), "{read:?}");
}

/// `schema_accepts` compares all that our own check finds with what the crate `jsonschema` finds.
#[test]
fn our_check_of_documents_agrees_with_jsonschema_on_ten_thousand_mutated_ones() {
    let documents = all_documents();
    let mut refused = 0;
    for seed in 0..10_000 {
        let mut random = Rng::with_seed(seed);
        let document = mutated(documents[seed as usize % documents.len()].clone(), &mut random);
        refused += u32::from(!schema_accepts(&document));
    }
    assert!((2_000..9_800).contains(&refused), "{refused} refused");
}

#[test]
fn mutated_documents_are_refused_in_plain_words_or_read() {
    let bench = Bench::new();
    let [contact, specimen, full] = full_documents();
    let (accepted, refused) = (Cell::new(0), Cell::new(0));
    let check = |round: u8, seed: u64| {
        let mut random = Rng::with_seed(seed);
        let document = match round {
            0 => &contact,
            1 => &specimen,
            _ => &full,
        };
        let document = mutated(document.clone(), &mut random);
        let fits = schema_accepts(&document);
        match bench.read(&document, &[]) {
            Ok(_) => {
                accepted.set(accepted.get() + 1);
                assert!(fits, "read, but not by the schema: {document}");
            }
            Err(errors) => {
                refused.set(refused.get() + 1);
                let text = errors.to_string();
                assert!(!errors.problems.is_empty() && [2, 3].contains(&errors.exit_code()));
                for noise in
                    ["anyOf", "oneOf", "untagged", "did not match any variant", ": cannot be read:", "under any of"]
                {
                    assert!(!text.contains(noise), "{document}:\n{text}");
                }
                let structural =
                    structure::kind_of(&document).map_or(true, |kind| !structure::check(kind, &document).is_empty());
                assert_eq!(structural, !fits, "{document}:\n{text}");
            }
        }
    };
    let documents = (0..4_u8, 1..=u64::MAX);
    let outcome = TestRunner::new(fuzz::config(1600)).run(&documents, |(round, seed)| {
        check(round, seed);
        Ok(())
    });
    outcome.unwrap_or_else(|error| panic!("{error}"));
    assert!(accepted.get() > 20 && refused.get() > 300, "{} accepted, {} refused", accepted.get(), refused.get());
}
