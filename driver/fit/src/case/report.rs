//! `report.html` of the fit of a case.

use super::{CaseFit, CaseRequest, FittedTest, Test};
use crate::output::{explanation, percent, standard_error};
use maud::{Markup, html};
use pullout_report::page;
use pullout_report::plots::Picture;
use pullout_run::number::significant;

pub(super) fn page(fit: &CaseFit, request: &CaseRequest, pictures: &[Picture]) -> Markup {
    let [made, here] = fit.searches;
    let misfit = |test: &FittedTest, y: &str| {
        html! { (significant(test.rms(), 4)) ", " (percent(test.rms() / test.scale())) " of the greatest measured " code { (y) } }
    };
    let row = |key: &str, value: String| html! { tr { td.key { (key) } td { (value) } } };
    page::page(
        if fit.tests.len() > 1 {
            "Parameters of cases from measured curves"
        } else {
            "Parameters of a case from a measured curve"
        },
        &html! {
            p {
                @match fit.trouble { None => span.done { "done" }, Some(_) => span.failed { "failed" } }
                " RMS difference "
                @match &fit.tests[..] {
                    [test] => { (misfit(test, &request.tests[0].curve[1])) }
                    _ => { (percent(fit.rms)) " of the greatest measured values" }
                }
                "; " (here) " of " (made) " searches ended here."
            }
            @if let Some(message) = &fit.trouble { div.message { (message) } }
            (page::warnings(&fit.warnings))
            (page::pictures(pictures))
            h2 { "Parameters" }
            div.scroll tabindex="0" { table {
                tr {
                    th { "Parameter" } th.number { "Value" } th.number { "Standard error" } th.number { "of the value" }
                    th.number { "Start" } th.number { "Bounds" } td {}
                }
                @for ((free, estimate), start) in fit.free.iter().zip(&fit.estimates).zip(&fit.starts) {
                    tr {
                        td { code { (free.path) } }
                        td.number { (significant(estimate.value, 6)) }
                        td.number { (standard_error(estimate)) }
                        td.number { (percent(estimate.relative())) }
                        td.number { (significant(*start, 6)) }
                        td.number { (significant(free.bounds[0], 6)) " … " (significant(free.bounds[1], 6)) }
                        td {
                            @if !estimate.is_identifiable() { "not identifiable" }
                            @if let Some(bound) = free.bound(estimate.value) { " on its bound " (significant(bound, 6)) }
                        }
                    }
                }
            } }
            @if fit.free.len() > 1 {
                h2 { "Correlation" }
                div.scroll tabindex="0" { table {
                    tr { td {} @for free in &fit.free { th.number { code { (free.path) } } } }
                    @for (free, row) in fit.free.iter().zip(fit.correlation.row_iter()) {
                        tr {
                            td.key { code { (free.path) } }
                            @for value in row.iter() { td.number { (significant(*value, 2)) } }
                        }
                    }
                } }
            }
            p { (explanation()) }
            h2 { "What was fitted" }
            table {
                @for (test, fitted) in request.tests.iter().zip(&fit.tests) {
                    (row("Case", test.source.file.display().to_string()))
                    (row("Data", words(test, fitted)))
                    @if fit.tests.len() > 1 {
                        tr { td.key { "RMS difference" } td { (misfit(fitted, &test.curve[1])) } }
                    }
                }
                (row("Runs", fit.runs.to_string()))
                (row("Program", format!("pullout {}", env!("CARGO_PKG_VERSION"))))
            }
        },
    )
}

/// What was measured in a test.
fn words(test: &Test, fitted: &FittedTest) -> String {
    let [x, y] = &test.curve;
    let weight = if test.weight == 1.0 { String::new() } else { format!(", weight {}", test.weight) };
    format!("{}, {} points of {y} over {x}{weight}", test.data.display(), fitted.rows.len())
}
