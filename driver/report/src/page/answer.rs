//! The first numbers of a report: what came out, in five rows.

use crate::plots::quantity::{Quantity, capital, group_of};
use crate::summary::{Peak, Summary};
use maud::{Markup, PreEscaped, html};
use pullout_run::columns::Group;
use pullout_run::number::significant;
use pullout_run::program::STRESS_NAMES;
use std::path::Path;

/// Rows at most.
const MOST_ROWS: usize = 5;

/// A name, a value and a unit.
pub(super) type Row = (String, String, String);

/// The table of the first numbers.
pub(super) fn numbers(summary: &Summary) -> Markup {
    table(if summary.specimen.is_some() { of_specimen(summary) } else { of_point(summary) })
}

/// The first rows as a table.
pub(super) fn table(rows: Vec<Row>) -> Markup {
    html! {
        table.numbers {
            @for (name, value, unit) in rows.into_iter().take(MOST_ROWS) {
                tr { td.key { (PreEscaped(indexed(&name))) } td.number { (value) } td { (unit) } }
            }
        }
    }
}

fn of_specimen(summary: &Summary) -> Vec<Row> {
    let peaks = summary.peaks_without_rounding();
    let Some(findings) = &summary.specimen else { return Vec::new() };
    let load = findings.peak_load.iter();
    let loads = load.flat_map(|peak| [row("Greatest load", peak.load, "N"), row("at a slip of", peak.slip, "mm")]);
    let work = findings.energies.get("external_work").map(|work| row("Work", *work, "N·mm"));
    let most = |column: &str, name: &str, unit: &str| {
        let most = peaks.get(column).and_then(|peak| peak.max).filter(|most| *most != 0.0);
        most.map(|most| row(name, most, unit))
    };
    let of_fibre = [
        most("slip", "Greatest slip", "mm"),
        most("stress_max", "Greatest stress of the fibre", "MPa"),
        most("plastic_strain_max", "Greatest plastic strain of the fibre", ""),
    ];
    compared(summary).into_iter().chain(loads).chain(work).chain(of_fibre.into_iter().flatten()).collect()
}

/// The stress or traction that goes furthest, where it does so, and the damage.
fn of_point(summary: &Summary) -> Vec<Row> {
    let peaks = summary.peaks_without_rounding();
    let magnitude = |peak: &Peak| peak.max.unwrap_or(0.0).abs().max(peak.min.unwrap_or(0.0).abs());
    let of_stress = STRESS_NAMES.into_iter().chain(["tau", "p"]).filter_map(|name| Some((name, peaks.get(name)?)));
    let greatest = of_stress.max_by(|a, b| magnitude(a.1).total_cmp(&magnitude(b.1)));
    let damages = peaks.iter().filter(|(name, _)| group_of(name) == Group::Damage || **name == "peeq");
    let mut rows = compared(summary);
    for (name, peak) in greatest.into_iter().chain(damages.map(|(name, peak)| (*name, peak))) {
        let Quantity { name, unit } = Quantity::of(name, &Default::default());
        let ends = [("greatest", peak.max), ("least", peak.min)];
        let moved = ends.into_iter().filter_map(|(end, value)| Some((end, value.filter(|value| *value != 0.0)?)));
        rows.extend(moved.map(|(end, value)| row(&capital(&format!("{end} {name}")), value, &unit)));
    }
    rows
}

/// A row with four digits.
pub(super) fn row(name: &str, value: f64, unit: &str) -> Row {
    (name.to_owned(), significant(value, 4), unit.to_owned())
}

/// How far the run is from the first measured curve.
fn compared(summary: &Summary) -> Vec<Row> {
    let first = summary.compare.first().and_then(|first| Some((first, first.rms?)));
    let of = |(first, rms): (&crate::compare::Comparison, f64)| {
        let unit = Quantity::of(&first.y, &Default::default()).unit;
        let file = Path::new(&first.file).file_name().unwrap_or_default().to_string_lossy();
        row(&format!("RMS difference from {file}"), rms, &unit)
    };
    first.map(of).into_iter().collect()
}

/// Markup of the pictures (`_{11}`) as that of a page.
fn indexed(name: &str) -> String {
    let escaped = html! { (name) }.into_string();
    escaped.replace("_{", "<sub>").replace('}', "</sub>")
}
