//! Bridging on the report's page: a page that a designer may file.

use super::answer::{self, Row, row};
use super::{Account, comparison, status, warnings};
use crate::plots::Picture;
use crate::summary::Summary;
use maud::{Markup, PreEscaped, html};
use pullout_run::bridging::{BeamFindings, Findings, ScatterFindings, Spread, WorkToOpening};
use pullout_run::number::{rounded, significant};

pub(super) fn body(account: &Account, summary: &Summary, findings: &Findings, pictures: &[Picture]) -> Markup {
    let (first, others) = pictures.split_first().map_or((None, &[][..]), |(first, others)| (Some(first), others));
    html! {
        div.answer {
            (status(summary, ""))
            div.pictures {
                @if let Some(first) = first { figure { (PreEscaped(&first.svg)) } }
                (answer::table(numbers(findings)))
            }
            @if let Some(beam) = &findings.beam { (strengths(beam, findings.scatter.as_ref())) }
            (warnings(&summary.warnings))
            (super::description(&account.description))
        }
        (crack(findings))
        @if !others.is_empty() { (super::pictures(others)) }
        (comparison(summary))
        h2 { "What was run" }
        table {
            tr { td.key { "Case" } td { code { (account.case_file) } } }
            @for (key, value) in &account.settings { tr { td.key { (key) } td { (value) } } }
        }
        (super::provenance(account, summary))
    }
}

/// Strengths of the beam, or of the crack without one.
fn numbers(findings: &Findings) -> Vec<Row> {
    let Some(beam) = &findings.beam else {
        return vec![
            row("Greatest σ", findings.sigma_peak, "MPa"),
            row("at w =", findings.w_peak, "mm"),
            row("Greatest σ of the fibres", findings.sigma_fibre_peak, "MPa"),
            row("Orientation factor η", findings.efficiency, ""),
            row("Fibres per cm²", findings.fibres_per_cm2, ""),
        ];
    };
    let [f_r1, _, f_r3, _] = beam.residual;
    let Some(scatter) = &findings.scatter else {
        let residual = beam.residual.into_iter().enumerate();
        let rows = residual.map(|(k, strength)| row(&format!("f_{{R{}}}", k + 1), strength, "MPa"));
        return std::iter::once(row("f_{L}", beam.limit, "MPa")).chain(rows).collect();
    };
    let [class, eurocode] =
        [&scatter.class, &scatter.class_en_1992_2023].map(|class| class.as_deref().unwrap_or("none"));
    let [f_r1k, _, f_r3k, _] = &scatter.residual;
    vec![
        ("Class".to_owned(), class.to_owned(), "fib Model Code 2010".to_owned()),
        ("Class".to_owned(), eurocode.to_owned(), "EN 1992-1-1:2023, annex L".to_owned()),
        row("f_{R1k}, characteristic", f_r1k.characteristic, "MPa"),
        row("f_{R3k}, characteristic", f_r3k.characteristic, "MPa"),
        row("f_{R1}, mean", f_r1, "MPa"),
        row("f_{R3}, mean", f_r3, "MPa"),
    ]
}

fn number(value: f64) -> String {
    significant(value, 4)
}

fn crack(findings: &Findings) -> Markup {
    let line =
        |what: &str, value: String, unit: &str| html! { tr { td.key { (what) } td.number { (value) } td { (unit) } } };
    let at = |opening: f64| format!(" at w = {} mm", number(opening));
    html! {
        h2 { "The crack" }
        table {
            (line("Orientation factor η", number(findings.efficiency), ""))
            @if let Some(zones) = findings.efficiency_by_zones {
                (line("η by zones", number(zones), "Dupont, Vandewalle 2005"))
            }
            (line("Fibres", number(findings.fibres_per_cm2), "per cm²"))
            (line("Greatest σ", number(findings.sigma_peak) + &at(findings.w_peak), "MPa"))
            (line("Greatest σ of the fibres", number(findings.sigma_fibre_peak) + &at(findings.w_fibre_peak), "MPa"))
            @for work in &findings.work {
                (line(&format!("Work up to {} mm", rounded(work.to)), number(work.work), "N/mm"))
            }
            (line("Greatest error of σ of the fibres, relative to the peak", significant(findings.error, 2), ""))
            (line("Greatest error of the work, relative", significant(error_of_work(&findings.work), 2), ""))
        }
    }
}

/// The greatest estimated error of works as a part of each.
fn error_of_work(works: &[WorkToOpening]) -> f64 {
    let relative = |work: &WorkToOpening| if work.work > 0.0 { work.error / work.work } else { 0.0 };
    works.iter().map(relative).fold(0.0, f64::max)
}

fn strengths(beam: &BeamFindings, scatter: Option<&ScatterFindings>) -> Markup {
    let names = ["f_L", "f_R1", "f_R2", "f_R3", "f_R4"];
    let means: Vec<f64> = std::iter::once(beam.limit).chain(beam.residual).collect();
    let spreads: Vec<&Spread> =
        scatter.iter().flat_map(|scatter| std::iter::once(&scatter.limit).chain(&scatter.residual)).collect();
    let code = &beam.model_code_2010;
    html! {
        h2 { "The notched beam" }
        div.scroll { table.cards {
            tr {
                th { "Strength" } th.number { "by the mean σ(w)" }
                @if scatter.is_some() {
                    th.number { "mean of beams" } th.number { "coefficient of variation" } th.number { "characteristic (5 %)" }
                }
            }
            @for (k, name) in names.iter().enumerate() {
                tr {
                    td { (name) " [MPa]" } td.number data-label="by the mean σ(w)" { (number(means[k])) }
                    @if let Some(spread) = spreads.get(k) {
                        td.number data-label="mean of beams" { (number(spread.mean)) }
                        td.number data-label="coefficient of variation" { (significant(100.0 * spread.cv, 3)) " %" }
                        td.number data-label="characteristic (5 %)" { (number(spread.characteristic)) }
                    }
                }
            }
        } }
        @if let Some(scatter) = scatter {
            p {
                (scatter.beams) " beams with " (significant(scatter.fibres.mean, 4)) " fibres across the ligament on average (coefficient of variation "
                (significant(100.0 * scatter.fibres.cv, 3)) " %). Class of the fib Model Code 2010: "
                (scatter.class.as_deref().unwrap_or("none")) "; of EN 1992-1-1:2023, annex L: "
                (scatter.class_en_1992_2023.as_deref().unwrap_or("none")) ". "
                @if scatter.structural { "Fibres may replace bars." } @else { "Fibres may not replace bars." }
            }
        }
        p {
            "By the fib Model Code 2010 from f_R1 and f_R3, w_u = 2.5 mm: rigid-plastic f_Ftu = " (number(code.rigid_plastic))
            " MPa; linear f_Fts = " (number(code.serviceability)) " and f_Ftu = " (number(code.ultimate))
            " MPa. The σ(w) that they represent: " (number(code.sigma[0])) " MPa at 0.5 mm, " (number(code.sigma[1]))
            " MPa at 2.5 mm."
        }
    }
}
