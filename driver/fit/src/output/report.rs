//! `report.html` of a fit.

use super::{explanation, numbers, percent, unidentifiable};
use crate::{FitRequest, FittedLaw, LoadSlipCurve, SlipAt};
use maud::{Markup, html};
use pullout_report::page;
use pullout_report::plots::Picture;
use pullout_run::number::significant;

pub fn page(
    source: &str,
    curve: &LoadSlipCurve,
    request: &FitRequest,
    laws: &[FittedLaw],
    (pictures, warnings): (&[Picture], &[String]),
) -> Markup {
    page::page(
        "Bond law from a load–slip curve",
        &html! {
            (what_was_fitted(source, curve, request))
            (page::warnings(warnings))
            (page::pictures(pictures))
            @for law in laws { (fitted(law)) }
            p { (explanation()) }
        },
    )
}

fn what_was_fitted(source: &str, curve: &LoadSlipCurve, request: &FitRequest) -> Markup {
    let fibre = &request.fibre;
    let row = |key: &str, value: String| html! { tr { td.key { (key) } td { (value) } } };
    let peak = curve.peak();
    let at = match request.slip_at {
        SlipAt::Grip => "at the grip",
        SlipAt::Exit => "at the exit face",
    };
    let simulation = request.specimen_case.as_ref();
    html! {
        h2 { "What was fitted" }
        table {
            (row("Curve", format!("{source}, {} rows", curve.slips.len())))
            (row("Slip", format!("{at}, up to {} mm", significant(curve.largest_slip(), 4))))
            (row("Greatest load", format!("{} N at {} mm", significant(peak.load, 4), significant(peak.slip, 3))))
            (row("Fibre", format!(
                "diameter {} mm, embedded {} mm, free {} mm, E {} MPa",
                fibre.diameter, fibre.embedded_length, fibre.free_length, fibre.youngs_modulus
            )))
            (row("Simulation", simulation.map_or("perpendicular_fibre".into(), |file| file.display().to_string())))
            (row("Program", format!("pullout {}", env!("CARGO_PKG_VERSION"))))
        }
    }
}

fn fitted(law: &FittedLaw) -> Markup {
    let (regression, quantities) = (law.regression.quantities(), law.law.quantities());
    let unidentifiable = unidentifiable(law);
    html! {
        h2 { "Form " (law.law.form()) }
        @if let Some(message) = &law.trouble { div.message { (message) } }
        p {
            "RMS difference " (percent(law.quality.rms)) " of the peak, by regression alone " (percent(law.regression_rms))
            "; R² " (format!("{:.5}", law.quality.r_squared)) "; " (law.runs) " runs."
        }
        @if !unidentifiable.is_empty() { p.warnings { "Not identifiable: " (unidentifiable.join(", ")) "." } }
        div.scroll tabindex="0" { table {
            tr {
                th { "Number" } th { "Unit" } th.number { "Regression" } th.number { "Value" }
                th.number { "Standard error" } th.number { "of the value" }
            }
            @for ((quantity, estimate), start) in numbers(law).iter().zip(&regression) {
                tr {
                    td.key { code { (quantity.name) } }
                    td { (quantity.unit) }
                    td.number { (significant(start.value, 4)) }
                    td.number { (significant(quantity.value, 5)) }
                    @match estimate {
                        Some(estimate) if !estimate.is_given() => {
                            td.number { (significant(estimate.standard_error, 2)) }
                            td.number { (percent(estimate.relative())) }
                        },
                        _ => { td.number { "–" } td.number { "–" } },
                    }
                }
            }
        } }
        @if let Some(uncertainty) = &law.uncertainty {
            h3 { "Correlation" }
            div.scroll tabindex="0" { table {
                tr { td {} @for quantity in &quantities { th.number { (quantity.name) } } }
                @for (quantity, row) in quantities.iter().zip(uncertainty.correlation.row_iter()) {
                    tr {
                        td.key { code { (quantity.name) } }
                        @for value in row.iter() { td.number { (format!("{value:.2}")) } }
                    }
                }
            } }
        }
    }
}
