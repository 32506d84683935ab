//! Files that a fit writes: cases, the curves, pictures, a report.

use super::curve::LoadSlipCurve;
use super::law::LawQuantity;
use super::uncertainty::Uncertainty;
use super::{CURVE_FILE, FitRequest, FittedLaw, specimen};
use crate::doubt::doubts;
use crate::regression::thinned;
use nalgebra::DMatrix;
use pullout_bridging::{Estimate, IDENTIFIABLE};
use pullout_report::directory::ResultDirectory;
use pullout_report::plots;
use pullout_report::plots::figure::{Figure, Line, Marks, Style};
use pullout_report::plots::quantity::Quantity as AxisQuantity;
use pullout_run::number::significant;
use serde_json::{Map, Value, json};
use std::collections::BTreeMap;
use std::f64::consts::PI;
use std::fmt::Write as _;
use std::io;

mod report;

/// Measured points in a picture: more would be a band.
pub(crate) const MOST_MARKS: usize = 150;
/// End of the picture of the peak, as a multiple of the slip at the peak.
const PEAK_VIEW: f64 = 4.0;
/// Points of a law's curve.
const LAW_POINTS: usize = 400;

/// Writes everything into a result directory. The result is what the user should be warned of.
///
/// # Errors
/// A file that cannot be written.
pub fn write(
    directory: &mut ResultDirectory,
    source: &str,
    curve: &LoadSlipCurve,
    request: &FitRequest,
    laws: &[FittedLaw],
) -> io::Result<Vec<String>> {
    let mut warnings = doubts_of(curve, request, laws);
    let mut file = |name: &str, content: &str| directory.write(name, content).map(|_| ());
    let load_slip =
        |slips: &[f64], loads: &[f64]| table("slip,load", slips.iter().zip(loads).map(|(&slip, &load)| [slip, load]));
    file(CURVE_FILE, &load_slip(&curve.slips, &curve.loads))?;
    for law in laws {
        let form = law.law.form();
        file(&format!("{form}-law.json"), &format!("{:#}\n", specimen::fragment(&law.case)))?;
        file(&format!("{form}-case.json"), &format!("{:#}\n", law.case))?;
        let simulated = &law.simulated;
        file(&format!("{form}-curve.csv"), &load_slip(&simulated.slips, &simulated.loads))?;
    }
    file("fit.json", &format!("{:#}\n", summary(source, request, laws, &warnings)))?;
    let drawings = plots::write_all(directory, "plots", &figures(curve, request, laws))?;
    warnings.extend(drawings.warnings);
    let page = report::page(source, curve, request, laws, (&drawings.pictures, &warnings));
    directory.write("report.html", page.into_string())?;
    Ok(warnings)
}

/// Warns of data in other units, and of laws that miss them.
fn doubts_of(curve: &LoadSlipCurve, request: &FitRequest, laws: &[FittedLaw]) -> Vec<String> {
    let fibre = &request.fibre;
    let traction = curve.peak().load / (PI * fibre.diameter * fibre.embedded_length);
    let data = [
        ("mean traction at the greatest load", traction, "MPa", [0.05, 100.0]),
        ("greatest slip", curve.largest_slip(), "mm", [0.05, 100.0]),
    ];
    doubts(&data, laws.iter().map(|law| (law.law.form(), law.quality.rms)))
}

/// A CSV table of numbers.
pub(crate) fn table<const N: usize>(header: &str, rows: impl IntoIterator<Item = [f64; N]>) -> String {
    let lines = rows.into_iter().map(|row| row.map(|number| number.to_string()).join(",") + "\n");
    std::iter::once(format!("{header}\n")).chain(lines).collect()
}

/// Describes a law in a few lines for the terminal.
pub fn describe(law: &FittedLaw) -> String {
    let mut text = format!(
        "{}: RMS {} % of the peak (regression alone: {} %), R² {:.5}, {} runs\n",
        law.law.form(),
        significant(100.0 * law.quality.rms, 3),
        significant(100.0 * law.regression_rms, 3),
        law.quality.r_squared,
        law.runs
    );
    for (quantity, estimate) in numbers(law) {
        let error = estimate.map_or(String::new(), |estimate| {
            let doubt = if estimate.is_identifiable() { "" } else { ", NOT IDENTIFIABLE" };
            if estimate.is_given() {
                " (the end of the curve)".to_owned()
            } else {
                format!(" ± {} ({}{doubt})", significant(estimate.standard_error, 2), percent(estimate.relative()))
            }
        });
        let unit = if quantity.unit == "-" { String::new() } else { format!(" {}", quantity.unit) };
        // writing to a String cannot fail
        let line = format!("  {:<8} {}{unit}{error}", quantity.name, significant(quantity.value, 5));
        let _ = writeln!(text, "{line}");
    }
    text
}

/// The numbers of a law, each with what is known of its error.
fn numbers(law: &FittedLaw) -> Vec<(LawQuantity, Option<&Estimate>)> {
    let quantities = law.law.quantities().into_iter().enumerate();
    let estimate = |k: usize| law.uncertainty.as_ref().and_then(|uncertainty| uncertainty.estimates.get(k));
    quantities.map(|(k, quantity)| (quantity, estimate(k))).collect()
}

/// Returns the names of the parameters that the curve does not determine.
fn unidentifiable(law: &FittedLaw) -> Vec<String> {
    let described = |(quantity, estimate): (LawQuantity, Option<&Estimate>)| {
        estimate
            .filter(|estimate| !estimate.is_identifiable())
            .map(|estimate| format!("{} (standard error {} of its value)", quantity.name, percent(estimate.relative())))
    };
    numbers(law).into_iter().filter_map(described).collect()
}

pub(crate) fn percent(part: f64) -> String {
    if part.is_finite() { format!("{} %", significant(100.0 * part, 2)) } else { "infinite".into() }
}

fn summary(source: &str, request: &FitRequest, laws: &[FittedLaw], warnings: &[String]) -> Value {
    let forms: Map<String, Value> = laws.iter().map(|law| (law.law.form().to_owned(), form(law))).collect();
    let fibre = &request.fibre;
    json!({
        "curve": source,
        "slip_at": request.slip_at.column(),
        "fibre": {
            "diameter": fibre.diameter,
            "embedded_length": fibre.embedded_length,
            "free_length": fibre.free_length,
            "E": fibre.youngs_modulus,
        },
        "warnings": warnings,
        "forms": forms,
    })
}

/// JSON has no infinity: an error of which nothing is known is null.
fn form(law: &FittedLaw) -> Value {
    let number = |(quantity, estimate): (LawQuantity, Option<&Estimate>)| {
        let mut entry = json!({ "value": quantity.value, "unit": quantity.unit });
        if let Some(estimate) = estimate {
            entry["standard_error"] = json!(estimate.standard_error);
            entry["identifiable"] = json!(estimate.is_identifiable());
        }
        (quantity.name, entry)
    };
    let parameters: Map<String, Value> = numbers(law).into_iter().map(number).collect();
    let names: Vec<String> = law.law.quantities().into_iter().map(|quantity| quantity.name).collect();
    let correlation = |known: &Uncertainty| json!({ "names": names, "matrix": rows_of(&known.correlation) });
    let regression = law.regression.quantities().into_iter();
    let regression: Map<String, Value> =
        regression.map(|quantity| (quantity.name, json!({ "value": quantity.value, "unit": quantity.unit }))).collect();
    json!({
        "status": if law.trouble.is_none() { "done" } else { "failed" },
        "message": law.trouble,
        "rms_of_peak": law.quality.rms,
        "r_squared": law.quality.r_squared,
        "runs": law.runs,
        "parameters": parameters,
        "correlation": law.uncertainty.as_ref().map(correlation),
        "regression": { "parameters": regression, "rms_of_peak": law.regression_rms },
    })
}

/// Returns the text of a standard error, which may be unknown.
pub(crate) fn standard_error(estimate: &Estimate) -> String {
    if estimate.standard_error.is_finite() { significant(estimate.standard_error, 2) } else { "unknown".into() }
}

/// A matrix row by row.
pub(crate) fn rows_of(matrix: &DMatrix<f64>) -> Vec<Vec<f64>> {
    matrix.row_iter().map(|row| row.iter().copied().collect()).collect()
}

/// Returns the figures of the curves, of the curves around the peak, and of the laws.
fn figures(curve: &LoadSlipCurve, request: &FitRequest, laws: &[FittedLaw]) -> Vec<Figure> {
    let units = BTreeMap::new();
    let column = request.slip_at.column();
    let every = curve.slips.len().div_ceil(MOST_MARKS).max(1);
    let peak_end = PEAK_VIEW * curve.peak().slip;
    let figure = |name: &str, title: &str, end: f64, every: usize| Figure {
        name: name.into(),
        title: title.into(),
        x: AxisQuantity::of(column, &units),
        y: AxisQuantity::of("load", &units),
        lines: laws
            .iter()
            .enumerate()
            .map(|(k, law)| {
                let points = law.simulated.slips.iter().copied().zip(law.simulated.loads.iter().copied());
                let points = points.take_while(|(slip, _)| *slip <= end).collect();
                line(k, law, points, (column, "load"))
            })
            .collect(),
        marks: vec![Marks {
            label: "measured".into(),
            points: (curve.slips.iter().copied().zip(curve.loads.iter().copied()))
                .filter(|(slip, _)| *slip <= end)
                .step_by(every)
                .collect(),
            line: None,
        }],
        ..Figure::default()
    };
    let end = curve.largest_slip();
    let near = curve.slips.iter().filter(|&&slip| slip <= peak_end).count().div_ceil(MOST_MARKS).max(1);
    vec![
        figure("load-slip", "Measured and computed load", end, every),
        figure("load-slip-peak", "Measured and computed load around the peak", peak_end, near),
        Figure {
            name: "bond-law".into(),
            title: "Bond laws".into(),
            x: AxisQuantity { name: "slip of the bond".into(), unit: "mm".into() },
            y: AxisQuantity { name: "bond traction".into(), unit: "MPa".into() },
            lines: laws.iter().enumerate().map(|(k, law)| law_line(k, law, end)).collect(),
            marks: vec![Marks {
                label: "mean traction of the regression".into(),
                points: thinned(&request.fibre.mean_bond(curve, request.slip_at), MOST_MARKS)
                    .iter()
                    .map(|point| (point.slip, point.traction))
                    .collect(),
                line: None,
            }],
            ..Figure::default()
        },
    ]
}

fn line(k: usize, law: &FittedLaw, points: Vec<(f64, f64)>, columns: (&str, &str)) -> Line {
    Line {
        label: law.law.form().into(),
        points,
        columns: (columns.0.into(), columns.1.into()),
        style: Style { color: k, dash: k },
        ..Line::default()
    }
}

/// A law's traction, closer where the slip is small.
fn law_line(k: usize, law: &FittedLaw, end: f64) -> Line {
    let slips: Vec<f64> = (0..=LAW_POINTS).map(|i| end * (i as f64 / LAW_POINTS as f64).powi(3)).collect();
    let tractions = law.law.tractions(&slips, law.residual).unwrap_or_default();
    line(k, law, slips.into_iter().zip(tractions).collect(), ("slip", "tau"))
}

/// Returns what an error is worth, for readers of the report.
pub(crate) fn explanation() -> String {
    format!(
        "Errors are standard errors to first order, from the derivatives of the computed curve and the scatter that is \
         left; they hold if this scatter is noise. A number whose standard error is above {} % of its value is not identifiable: the curve does not determine it.",
        significant(100.0 * IDENTIFIABLE, 2)
    )
}
