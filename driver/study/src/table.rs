//! `study.csv` and `study.json`.

use super::claims::{Finding, work_unit};
use super::results::{Results, RunResult};
use super::{Run, Study};
use pullout_report::directory::ResultDirectory;
use pullout_report::summary::Status;
use pullout_run::number;
use serde_json::{Value, json};
use std::io;

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

/// A run's line in tables.
#[derive(Clone, Debug)]
pub(super) struct Line<'a> {
    pub series: &'a str,
    pub label: &'a str,
    pub x: Option<f64>,
    pub status: &'static str,
    pub result: &'a RunResult,
    pub increments: Option<u64>,
    pub iterations: Option<u64>,
    pub cutbacks: Option<u64>,
    pub energy_error_max: Option<f64>,
    pub cpu_time_s: Option<f64>,
    pub wall_time_s: Option<f64>,
}

impl<'a> Line<'a> {
    pub fn of(study: &'a Study, run: &Run, result: &'a RunResult) -> Self {
        let summary = result.summary.as_ref();
        Self {
            series: &study.series[run.series].name,
            label: &study.members[run.member].label,
            x: study.members[run.member].x,
            status: match result.status {
                Some(Status::Done) => "done",
                Some(Status::Failed) => "failed",
                Some(Status::Interrupted) => "interrupted",
                None => "not run",
            },
            result,
            increments: summary.map(|summary| summary.increments),
            iterations: summary.map(|summary| summary.iterations),
            cutbacks: summary.map(|summary| summary.cutbacks),
            energy_error_max: summary
                .and_then(|summary| summary.specimen.as_ref())
                .and_then(|specimen| specimen.energy_error_max),
            cpu_time_s: summary.and_then(|summary| summary.cpu_time_s),
            wall_time_s: summary.map(|summary| summary.wall_time_s),
        }
    }
}

/// The lines of all runs.
pub(super) fn lines<'a>(study: &'a Study, results: &'a Results) -> impl Iterator<Item = (&'a Run, Line<'a>)> {
    study.runs.iter().zip(&results.runs).map(|(run, result)| (run, Line::of(study, run, result)))
}

/// Writes `study.csv`.
///
/// # Errors
/// The file cannot be written.
pub fn write_csv(directory: &mut ResultDirectory, study: &Study, results: &Results) -> io::Result<()> {
    let text = csv_of(study, results).map_err(|error| io::Error::other(error.to_string()))?;
    directory.write("study.csv", text).map(|_| ())
}

fn csv_of(study: &Study, results: &Results) -> Result<Vec<u8>, Box<dyn std::error::Error>> {
    let exact = |value: Option<f64>| value.map_or_else(String::new, number::exact);
    let count = |count: Option<u64>| count.map_or(String::new(), |count| count.to_string());
    let mut writer = csv::Writer::from_writer(Vec::new());
    writer.write_record(COLUMNS)?;
    for (run, line) in lines(study, results) {
        let result = line.result;
        writer.write_record([
            line.series.to_owned(),
            line.label.to_owned(),
            exact(line.x),
            line.status.to_owned(),
            exact(result.peak),
            exact(result.slip_at_peak),
            exact(result.work),
            exact(results.work_to),
            exact(result.end),
            exact(result.reach),
            count(line.increments),
            count(line.iterations),
            count(line.cutbacks),
            exact(line.energy_error_max),
            exact(line.cpu_time_s),
            exact(line.wall_time_s),
            run.folder.display().to_string(),
            result.message.clone().unwrap_or_default(),
        ])?;
    }
    Ok(writer.into_inner().map_err(|error| error.to_string())?)
}

/// Writes `study.json`.
///
/// # Errors
/// The file cannot be written.
pub fn write_json(
    directory: &mut ResultDirectory,
    study: &Study,
    results: &Results,
    findings: &[Finding],
) -> io::Result<()> {
    let run = |(run, line): (&Run, Line<'_>)| {
        let result = line.result;
        json!({
            "series": line.series, "label": line.label, "title": study.members[run.member].title, "x": line.x,
            "status": line.status, "message": result.message, "kept": result.is_kept,
            "peak": result.peak, "slip_at_peak": result.slip_at_peak, "work": result.work, "end": result.end,
            "reach": result.reach, "increments": line.increments, "iterations": line.iterations,
            "cutbacks": line.cutbacks, "energy_error_max": line.energy_error_max, "cpu_time_s": line.cpu_time_s,
            "wall_time_s": line.wall_time_s, "folder": run.folder, "base": run.base, "set": run.overrides,
            "fingerprint": run.fingerprint, "warnings": run.warnings,
        })
    };
    let x = study.x.as_ref().map(|x| json!({ "name": x.name, "unit": x.unit, "logarithmic": x.logarithmic }));
    let document: Value = json!({
        "title": study.title,
        "file": study.file,
        "x": x,
        "curve": { "x": study.curve.x, "y": study.curve.y, "units": study.units, "work_unit": work_unit(study) },
        "work_to": results.work_to,
        "series": study.series.iter().map(|series| json!({ "name": series.name, "title": series.title })).collect::<Vec<_>>(),
        "runs": lines(study, results).map(run).collect::<Vec<_>>(),
        "claims": findings,
    });
    directory.write("study.json", format!("{document:#}\n")).map(|_| ())
}
