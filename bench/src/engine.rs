//! Cost of a point's run for a program that runs thousands: reading the case, and the run.

use super::page::Page;
use super::table::{Cell, Table};
use super::{BenchError, Settings};
use pullout_engine::{CaseSource, Error, Settings as Wishes};
use pullout_run::number::significant;
use serde_json::{Value, json};
use std::path::Path;

/// Milliseconds that a run of a point may take with its reading.
const TARGET: f64 = 1.0;
const INCREMENTS: usize = 150;

/// A law in a path of as many increments.
fn cases() -> [(&'static str, Value); 3] {
    let point = |material: Value, target: Value| {
        let steps = json!([{ "increments": INCREMENTS, "target": target }]);
        json!({ "kind": "point", "mode": "plane_strain", "material": material, "steps": steps })
    };
    let elastic = json!({ "plugin": "linear_elastic", "props": { "E": 30000.0, "nu": 0.2 } });
    let concrete = json!({ "plugin": "concrete_damage", "props": { "E": 30000.0, "nu": 0.2 } });
    let bond = json!({ "plugin": "bond_slip", "props": { "law": "A", "k_e": 950.0, "a_1": 10.0, "b_1": 0.4 } });
    let slip = json!([{ "increments": INCREMENTS, "target": { "slip": 0.5 } }]);
    [
        ("linear_elastic", point(elastic, json!({ "e11": -0.003 }))),
        ("concrete_damage", point(concrete, json!({ "e11": -0.003, "s22": 0.0 }))),
        ("bond_slip", json!({ "kind": "interface", "material": bond, "steps": slip })),
    ]
}

const METHOD: &str = "\
A case of a point with 150 increments through `pullout-engine`, nothing written: *read* (structure, plugin, parameters, path) and *run* (rows and summary in memory).
Times of the thread's processor, medians of turns; what is needed once (schema, library) is there.";

/// Three laws.
pub(super) fn measure(settings: &Settings) -> Result<Page, BenchError> {
    let mut data = Table::new(["law", "read_ms", "run_ms", "both_ms"]);
    let mut notes = Vec::new();
    for (law, case) in cases() {
        let source =
            CaseSource { plugin_paths: settings.plugin_paths.clone(), ..CaseSource::document(case, Path::new("")) };
        let prepared = source.clone().read()?;
        let outcome = prepared.run(Wishes::default()).map_err(failed)?;
        if !outcome.is_done() || outcome.history.rows() != INCREMENTS + 1 {
            return Err(BenchError::Failed(format!("{law}: {:?}", outcome.summary.message)));
        }
        let times = settings.timing().take_turns(vec![
            Box::new(|| drop(source.clone().read())),
            Box::new(|| drop(prepared.run(Wishes::default()))),
            Box::new(|| drop(source.clone().read().map(|prepared| prepared.run(Wishes::default())))),
        ]);
        let [read, run, both] = [0, 1, 2].map(|way| 1e3 * times.seconds(way));
        data.push([law.into(), Cell::from(read), run.into(), both.into()]);
        if !settings.quick {
            let word = if both <= TARGET { "reached" } else { "**missed**" };
            notes.push(format!("{law}: {} ms; at most {TARGET} ms is wanted: {word}.", significant(both, 3)));
        }
    }
    let summaries = vec![("A run and its parts".into(), data.clone())];
    Ok(Page {
        title: "Runs in memory",
        method: METHOD.into(),
        data,
        summaries,
        notes,
        figures: Vec::new(),
        failed: None,
    })
}

fn failed(error: Error) -> BenchError {
    match error {
        Error::Case(errors) => BenchError::Case(errors),
        other => BenchError::Failed(other.to_string()),
    }
}
