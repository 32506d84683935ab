//! `study.csv` and `study.json`.

use super::claims::{ClaimFinding, work_unit};
use super::results::{Results, RunResult};
use super::{Study, StudyRun};
use pullout_report::directory::ResultDirectory;
use pullout_run::number;
use serde_json::{Value, json};
use std::io;

/// Name of the file with all results of a study, in its directory.
pub const FILE: &str = "study.json";

/// The columns of `study.csv`. Empty fields are not known.
const COLUMNS: [&str; 18] = [
    "series",
    "label",
    "x",
    "status",
    "peak",
    "slip_at_peak",
    "work",
    "work_to",
    "end",
    "reach",
    "increments",
    "iterations",
    "cutbacks",
    "energy_error_max",
    "cpu_time_s",
    "wall_time_s",
    "folder",
    "message",
];

/// Writes `study.csv`.
///
/// # Errors
/// The file cannot be written.
pub fn write_csv(directory: &mut ResultDirectory, study: &Study, results: &Results) -> io::Result<()> {
    let text = csv_of(study, results).map_err(|error| io::Error::other(error.to_string()))?;
    directory.write("study.csv", text).map(|_| ())
}

fn csv_of(study: &Study, results: &Results) -> Result<Vec<u8>, Box<dyn std::error::Error>> {
    let field = |value: &Value| match value {
        Value::Null => String::new(),
        Value::String(text) => text.clone(),
        Value::Number(number) if number.is_f64() => number.as_f64().map_or_else(String::new, number::exact),
        other => other.to_string(),
    };
    let mut writer = csv::Writer::from_writer(Vec::new());
    writer.write_record(COLUMNS)?;
    let work_to = json!(results.work_to);
    for run in of_runs(study, results) {
        writer.write_record(COLUMNS.map(|name| field(if name == "work_to" { &work_to } else { &run[name] })))?;
    }
    Ok(writer.into_inner().map_err(|error| error.to_string())?)
}

/// What is known of each run: in `study.json` all of it, in `study.csv` its [`COLUMNS`].
fn of_runs(study: &Study, results: &Results) -> Vec<Value> {
    let of_run = |(run, result): (&StudyRun, &RunResult)| {
        let (member, summary) = (&study.members[run.member], result.summary.as_ref());
        json!({
            "series": study.series[run.series].name, "label": member.label, "title": member.title, "x": member.x,
            "status": result.status_in_words(), "message": result.message, "kept": result.is_kept,
            "peak": result.peak, "slip_at_peak": result.slip_at_peak, "work": result.work, "end": result.end,
            "reach": result.reach,
            "increments": summary.map(|summary| summary.increments),
            "iterations": summary.map(|summary| summary.iterations),
            "cutbacks": summary.map(|summary| summary.cutbacks),
            "energy_error_max": result.energy_error_max(),
            "cpu_time_s": summary.and_then(|summary| summary.cpu_time_s),
            "wall_time_s": summary.map(|summary| summary.wall_time_s),
            "folder": run.folder, "base": run.case.file, "set": run.case.overrides,
            "fingerprint": run.fingerprint, "warnings": run.warnings,
        })
    };
    study.runs.iter().zip(&results.runs).map(of_run).collect()
}

/// Writes `study.json`.
///
/// # Errors
/// The file cannot be written.
pub fn write_json(
    directory: &mut ResultDirectory,
    study: &Study,
    results: &Results,
    findings: &[ClaimFinding],
) -> io::Result<()> {
    let x = study.x.as_ref().map(|x| json!({ "name": x.name, "unit": x.unit, "logarithmic": x.logarithmic }));
    let document: Value = json!({
        "title": study.title,
        "file": study.file,
        "x": x,
        "curve": { "x": study.curve.x, "y": study.curve.y, "units": study.units, "work_unit": work_unit(study) },
        "work_to": results.work_to,
        "series": study.series.iter().map(|series| json!({ "name": series.name, "title": series.title })).collect::<Vec<_>>(),
        "runs": of_runs(study, results),
        "claims": findings,
    });
    directory.write(FILE, format!("{document:#}\n")).map(|_| ())
}
