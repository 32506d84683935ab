//! `report.html`: one page that needs nothing but itself.

use super::directory::ResultDirectory;
use super::plots::quantity::capital;
use super::plots::{Drawings, Picture};
use super::summary::{self, HistoryLine, Peak, Status, Summary};
use maud::{DOCTYPE, Markup, PreEscaped, Render, html};
use pullout_run::date;
use pullout_run::number::{rounded, significant};
use std::io;
use std::time::SystemTime;

mod account;
mod answer;
mod bridging;
mod specimen;
pub(crate) use account::Account;
use account::Parameter;

#[cfg(test)]
mod test;

const STYLE: &str = include_str!("style.css");

/// Name of the file in the result directory.
pub const FILE: &str = "report.html";

/// Writes the page.
pub(crate) fn write(
    directory: &mut ResultDirectory,
    account: &Account,
    summary: &mut Summary,
    drawings: &Drawings,
    viewer: Option<&Markup>,
) -> io::Result<()> {
    // summary and report both name what could not be drawn
    if !drawings.warnings.is_empty() {
        summary.warnings.extend(drawings.warnings.iter().cloned());
        directory.write(summary::FILE, summary.text()?)?;
    }
    directory.write(FILE, page_of(account, summary, &drawings.pictures, viewer).into_string()).map(|_| ())
}

fn page_of(account: &Account, summary: &Summary, pictures: &[Picture], viewer: Option<&Markup>) -> Markup {
    let title = if summary.title.is_empty() { account.law.as_str() } else { summary.title.as_str() };
    if let Some(findings) = &summary.bridging {
        return page(title, &bridging::body(account, summary, findings, pictures));
    }
    let (solver, results): (Vec<&Picture>, Vec<&Picture>) = pictures.iter().partition(|picture| is_of_solver(picture));
    let (fields, telling): (Vec<&Picture>, Vec<&Picture>) = results.into_iter().partition(|picture| picture.is_field);
    let (first, others) = telling.split_first().map_or((None, &[][..]), |(first, others)| (Some(*first), others));
    let body = html! {
        div.answer {
            (status(summary, &format!("{} increments in", summary.increments)))
            (laws(account))
            div.pictures {
                @if let Some(first) = first { figure { (PreEscaped(&first.svg)) } }
                (answer::numbers(summary))
            }
            @if let Some(findings) = &summary.specimen { (specimen::load(findings)) }
            (warnings(&summary.warnings))
            (description(&account.description))
        }
        @if let Some(viewer) = viewer { h2 { "Over the run" } (viewer) }
        @if !others.is_empty() { h2 { "Pictures" } (gallery(others)) }
        @if !fields.is_empty() {
            details open[viewer.is_none()] { summary { "Fields at the greatest load, at the end, and where asked for" } (gallery(&fields)) }
        }
        (comparison(summary))
        @if let Some(findings) = &summary.specimen { (specimen::energies(findings)) }
        (what_was_run(account, summary))
        (peaks(summary))
        details {
            summary { "Solver" }
            (effort(summary))
            @if let Some(findings) = &summary.specimen { (specimen::work(findings)) }
            (gallery(&solver))
        }
        (provenance(account, summary))
    };
    page(title, &body)
}

/// Returns whether a picture is of the solver's work, not of the result.
fn is_of_solver(picture: &Picture) -> bool {
    let stem = picture.path.file_stem().unwrap_or_default().to_string_lossy();
    ["iterations", "points", "active_zone"].iter().any(|name| stem.starts_with(name))
}

/// A page with this title as its heading.
pub fn page(title: &str, body: &Markup) -> Markup {
    document(title, &html! { h1 { (title) } (body) })
}

/// A page around something that is shown within another one.
pub fn around(title: &str, body: &Markup) -> String {
    document(title, body).into_string()
}

fn document(title: &str, body: &Markup) -> Markup {
    html! {
        (DOCTYPE)
        html lang="en" {
            head {
                meta charset="utf-8";
                meta name="viewport" content="width=device-width, initial-scale=1";
                title { (title) }
                style { (PreEscaped(STYLE)) }
            }
            body { main { (body) } }
        }
    }
}

fn status(summary: &Summary, effort: &str) -> Markup {
    html! {
        p {
            @match summary.status {
                Status::Done => span.done { "done" },
                Status::Failed => span.failed { "failed" },
                Status::Interrupted => span.failed { "interrupted" },
            }
            " " (effort) " " (significant(summary.wall_time_s, 3)) " s"
        }
        @if let Some(message) = &summary.message { div.message { (message) } }
    }
}

/// Which laws were run, and where.
fn laws(account: &Account) -> Markup {
    html! {
        @if !account.laws.is_empty() {
            p { @for (k, law) in account.laws.iter().enumerate() { @if k > 0 { ", " } (law.subject) ": " (law.law) } }
        } @else if !account.law.is_empty() { p { "Law: " (account.law) } }
    }
}

/// Pictures below each other, with a heading.
pub fn pictures(pictures: &[Picture]) -> Markup {
    html! {
        h2 { "Pictures" }
        (gallery(&pictures.iter().collect::<Vec<_>>()))
    }
}

fn gallery(pictures: &[&Picture]) -> Markup {
    html! { div.pictures { @for picture in pictures { figure { (PreEscaped(&picture.svg)) } } } }
}

/// Warnings as a list, if there are any.
pub fn warnings(warnings: &[impl Render]) -> Markup {
    html! {
        @if !warnings.is_empty() {
            h2 { "Warnings" }
            ul.warnings { @for warning in warnings { li { (warning) } } }
        }
    }
}

fn what_was_run(account: &Account, summary: &Summary) -> Markup {
    let row = |key: &str, value: Markup| html! { tr { td.key { (key) } td { (value) } } };
    html! {
        h2 { "What was run" }
        table {
            (row("Case", html! { code { (account.case_file) } }))
            @if !account.law.is_empty() && account.laws.is_empty() {
                (row("Law", html! { (account.law) " " (summary.plugin.version)
                    @if !account.law_description.is_empty() { " – " (account.law_description) } }))
            }
            (row("Mode", html! { (account.mode) }))
            @for (key, value) in &account.settings { (row(key, html! { (value) })) }
        }
        @if !account.parameters.is_empty() {
            h2 { "Parameters" }
            (table_of(&account.parameters))
        }
        @for law in &account.laws {
            h2 { (capital(&law.subject)) ": " (law.law) }
            @if !law.description.is_empty() { p { (law.description) } }
            (table_of(&law.parameters))
        }
        @if !summary.notes.is_empty() {
            h2 { "Notes" }
            ul { @for note in &summary.notes { li { (note) } } }
        }
        h2 { "Path" }
        ol { @for step in &account.steps { li { (step) } } }
        @if account.steps_left_out > 0 { p { "… and " (account.steps_left_out) " more steps." } }
        @if !account.defaults.is_empty() {
            details {
                summary { "Defaults used" }
                ul { @for line in &account.defaults { li { code { (line) } } } }
            }
        }
    }
}

/// The description of a case: its first paragraph is the caption, the rest is folded.
pub fn description(text: &str) -> Markup {
    let (caption, details) = text.split_once("\n\n").unwrap_or((text, ""));
    html! {
        @if !caption.is_empty() { p.description { (caption) } }
        @if !details.is_empty() {
            details { summary { "About this case" } @for paragraph in details.split("\n\n") { p { (paragraph) } } }
        }
    }
}

/// Returns program, machine and the files of the plugins.
fn provenance(account: &Account, summary: &Summary) -> Markup {
    let row = |key: &str, value: Markup| html! { tr { td.key { (key) } td { (value) } } };
    let machine = format!("{} {}", std::env::consts::OS, std::env::consts::ARCH);
    html! {
        h2 { "Program and files" }
        table {
            (row("Date", html! { (date::moment(SystemTime::now())) }))
            (row("Program", html! { "pullout " (env!("CARGO_PKG_VERSION")) ", " (machine) }))
            @for plugin in &summary.plugins {
                (row(&capital(&plugin.subject), html! { (plugin.law) " " (plugin.file.version) br;
                    code { (plugin.file.path) } br; code { (plugin.file.sha256) } }))
            }
            @if summary.plugins.is_empty() && !account.law.is_empty() {
                (row("Plugin", html! { code { (summary.plugin.path) } }))
                (row("SHA-256", html! { code { (summary.plugin.sha256) } }))
            }
        }
    }
}

fn table_of(parameters: &[Parameter]) -> Markup {
    html! {
        div.scroll { table.cards {
            tr { th { "Name" } th.number { "Value" } th { "Unit" } th { "Meaning" } }
            @for parameter in parameters {
                tr {
                    td { code { (parameter.name) } }
                    td.number data-label="Value" { (parameter.value) }
                    td data-label="Unit" { @if parameter.unit != "-" { (parameter.unit) } }
                    td data-label="Meaning" { (parameter.meaning) }
                }
            }
        } }
    }
}

fn comparison(summary: &Summary) -> Markup {
    html! {
        @if !summary.compare.is_empty() {
            h2 { "Comparison" }
            div.scroll { table.cards {
                tr { th { "File" } th { "Compared" } th.number { "RMS difference" } th.number { "Points" } th.number { "Outside" } }
                @for entry in &summary.compare {
                    tr {
                        td { code { (entry.file) } }
                        td data-label="Compared" { (entry.y) " at " (entry.x) }
                        td.number data-label="RMS difference" { @match entry.rms { Some(rms) => (rounded(rms)), None => "nothing to compare" } }
                        td.number data-label="Points" { (entry.points) }
                        td.number data-label="Outside" { (entry.outside) }
                    }
                }
            } }
        }
    }
}

fn effort(summary: &Summary) -> Markup {
    html! {
        h2 { "Effort" }
        table {
            tr { td.key { "Increments" } td.number { (summary.increments) } }
            tr { td.key { "Iterations" } td.number { (summary.iterations) } }
            tr { td.key { "Plugin calls" } td.number { (summary.plugin_calls) } }
            tr { td.key { "Cutbacks" } td.number { (summary.cutbacks) } }
            tr { td.key { "Time" } td.number { (significant(summary.wall_time_s, 4)) " s" } }
        }
    }
}

fn peaks(summary: &Summary) -> Markup {
    let number = |value: Option<f64>| value.map_or("–".into(), rounded);
    let line = |line: Option<HistoryLine>| match line {
        Some(HistoryLine { step, increment, .. }) => format!("{step} / {increment}"),
        None => "–".into(),
    };
    let moves = |peak: &Peak| peak.max.is_some() && (peak.max != Some(0.0) || peak.min != Some(0.0));
    let peaks = summary.peaks_without_rounding();
    let still: Vec<&str> = peaks.iter().filter(|(_, peak)| !moves(peak)).map(|(name, _)| *name).collect();
    html! {
        details {
        summary { "Peaks of all columns" }
        div.scroll { table.cards {
            tr {
                th { "Column" } th.number { "Greatest" } th.number { "step / increment" }
                th.number { "Least" } th.number { "step / increment" }
            }
            @for (name, peak) in peaks.iter().filter(|(_, peak)| moves(peak)) {
                tr {
                    td { code { (name) } }
                    td.number data-label="Greatest" { (number(peak.max)) }
                    td.number data-label="step / increment" { (line(peak.max_at)) }
                    td.number data-label="Least" { (number(peak.min)) }
                    td.number data-label="step / increment" { (line(peak.min_at)) }
                }
            }
        } }
        @if !still.is_empty() { p { "Zero throughout or unknown: " code { (still.join(", ")) } } }
        }
    }
}
