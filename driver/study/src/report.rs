//! `report.html` of a study: one page that needs nothing but itself.

use super::Study;
use super::claims::{ClaimFinding, Verdict, work_unit};
use super::results::Results;
use maud::{Markup, html};
use pullout_report::directory::ResultDirectory;
use pullout_report::page;
use pullout_report::plots::Picture;
use pullout_run::date;
use pullout_run::number::{rounded, significant};
use std::io;
use std::time::SystemTime;

/// Writes the page.
///
/// # Errors
/// The file cannot be written.
pub fn write(
    directory: &mut ResultDirectory,
    study: &Study,
    results: &Results,
    findings: &[ClaimFinding],
    pictures: &[Picture],
) -> io::Result<()> {
    let body = html! {
        (state(results))
        (page::description(&study.description))
        (claims(findings))
        (page::pictures(pictures))
        (table(study, results))
        (troubles(study, results))
        (what_was_run(study))
    };
    directory.write("report.html", page::page(&study.title, &body).into_string()).map(|_| ())
}

fn state(results: &Results) -> Markup {
    let count = results.runs.len();
    let done = results.runs.iter().filter(|run| run.is_done()).count();
    let not_run = results.runs.iter().filter(|run| run.status.is_none()).count();
    html! {
        p {
            @if done == count { span.done { "done" } } @else { span.failed { (done) " of " (count) " runs done" } }
            " " (count) " runs"
            @if not_run > 0 { ", " (not_run) " not run" }
        }
    }
}

fn claims(findings: &[ClaimFinding]) -> Markup {
    html! {
        @if !findings.is_empty() {
            h2 { "Claims" }
            div.scroll { table.cards {
                tr { th { "Claim" } th { "Verdict" } th { "Figures" } }
                @for finding in findings {
                    tr {
                        td { div { (finding.claim) br; small { (finding.expected) } } }
                        td.key data-label="Verdict" {
                            @match finding.verdict {
                                Verdict::Holds => span.done { (finding.verdict.words()) },
                                _ => span.failed { (finding.verdict.words()) },
                            }
                        }
                        td data-label="Figures" { div { @for line in &finding.figures { (line) br; } } }
                    }
                }
            } }
        }
    }
}

fn table(study: &Study, results: &Results) -> Markup {
    let number = |value: Option<f64>| value.map_or("–".into(), rounded);
    let count = |value: Option<u64>| value.map_or("–".into(), |count| count.to_string());
    let short = |value: Option<f64>| value.map_or("–".into(), |value| significant(value, 3));
    let with = |name: &str, unit: &str| if unit.is_empty() { name.to_owned() } else { format!("{name} [{unit}]") };
    let [x_unit, y_unit] = &study.units;
    let several = study.series.len() > 1;
    html! {
        h2 { "Runs" }
        div.scroll { table.cards {
            tr {
                @if several { th { "Series" } }
                th { "Run" } th { "Status" }
                th.number { (with("Peak", y_unit)) }
                th.number { (with("at", x_unit)) }
                th.number { (with("Work", &work_unit(study))) }
                th.number { "Increments" } th.number { "Cutbacks" } th.number { "Energy error" }
                th.number { "CPU [s]" }
            }
            @for (run, result) in study.runs.iter().zip(&results.runs) {
                @let summary = result.summary.as_ref();
                tr {
                    @if several { td { (study.series[run.series].title) } }
                    td data-label="Run" { (study.members[run.member].title) }
                    td data-label="Status" { (result.status_in_words()) }
                    td.number data-label=(with("Peak", y_unit)) { (number(result.peak)) }
                    td.number data-label=(with("at", x_unit)) { (number(result.slip_at_peak)) }
                    td.number data-label=(with("Work", &work_unit(study))) { (number(result.work)) }
                    td.number data-label="Increments" { (count(summary.map(|summary| summary.increments))) }
                    td.number data-label="Cutbacks" { (count(summary.map(|summary| summary.cutbacks))) }
                    td.number data-label="Energy error" { (short(result.energy_error_max())) }
                    td.number data-label="CPU [s]" { (short(summary.and_then(|summary| summary.cpu_time_s))) }
                }
            }
        } }
        p { "Peak: the greatest " (study.curve.y) " in magnitude. Work: "
            @match results.work_to {
                Some(end) => { "up to " (study.curve.x) " = " (significant(end, 6))
                    @if !x_unit.is_empty() { " " (x_unit) } "." }
                None => { "along the whole path." }
            }
        }
    }
}

fn troubles(study: &Study, results: &Results) -> Markup {
    let messages = study.runs.iter().zip(&results.runs);
    let messages: Vec<(String, &str)> =
        messages.filter_map(|(run, result)| Some((study.name_of(run), result.message.as_deref()?))).collect();
    let mut warnings: Vec<&str> = study.runs.iter().flat_map(|run| &run.warnings).map(String::as_str).collect();
    warnings.sort_unstable();
    warnings.dedup();
    html! {
        @if !messages.is_empty() {
            h2 { "Runs that failed" }
            @for (name, message) in messages { div.message { (name) ": " (message) } }
        }
        (page::warnings(&warnings))
    }
}

fn what_was_run(study: &Study) -> Markup {
    html! {
        h2 { "What was run" }
        div.scroll { table.cards {
            tr { th { "Results" } th { "Case" } th { "Overrides" } }
            @for run in &study.runs {
                tr {
                    td { code { (run.folder.display()) } }
                    td data-label="Case" { code { (run.case.file.display()) } }
                    td data-label="Overrides" { div { @for text in &run.case.overrides { code { (text) } br; } } }
                }
            }
        } }
        p { "pullout " (env!("CARGO_PKG_VERSION")) ", " (date::moment(SystemTime::now())) }
    }
}
