//! Files that the fit of a beam writes.

use super::{BeamFit, FittedBond, POINTS, measured_points};
use crate::output::{MOST_MARKS, rows_of, standard_error, table};
use crate::regression::thinned;
use maud::html;
use pullout_bridging::{
    Estimate, EurocodeClass, IDENTIFIABLE, Matrix, MeasuredBeam, Polyline, Residual, StrengthClass,
};
use pullout_report::directory::ResultDirectory;
use pullout_report::page;
use pullout_report::plots;
use pullout_report::plots::figure::{Figure, Line, Marks};
use pullout_report::plots::quantity::Quantity;
use pullout_report::softening::SofteningTable;
use pullout_run::number::significant;
use serde_json::{Value, json};
use std::fmt::Write as _;
use std::io;

/// Writes everything into a result directory. `case` is the document of the case; with the bond that was found it becomes
/// a case of its own. The result is what the user should be warned of.
///
/// # Errors
/// A file that cannot be written.
pub fn write(
    directory: &mut ResultDirectory,
    source: &str,
    case: &Value,
    test: &MeasuredBeam,
    fit: &BeamFit,
) -> io::Result<Vec<String>> {
    let mut warnings = fit.doubts(test);
    let measured = measured_points(&fit.geometry, test);
    let computed = fit.forces(measured.iter().map(|point| point.0));
    let curve = measured.iter().zip(&computed).map(|(&(cmod, load), &(_, computed))| [cmod, load, computed]);
    directory.write("curve.csv", table("cmod,load,computed", curve))?;
    let stresses = fit.full.openings.iter().zip(fit.of_fibres());
    let row = |(&w, estimate): (&f64, Estimate)| {
        [w, estimate.value, estimate.standard_error, fit.fast.at(w), fit.full.law.at(w)]
    };
    let sigma: Vec<[f64; 5]> = stresses.map(row).collect();
    let header = "w,sigma,standard_error,sigma_fast,sigma_total";
    let sigma = match &fit.full.band {
        None => table(header, sigma),
        Some(band) => {
            let band = band.iter().zip(&fit.matrix).map(|(of_law, matrix)| of_law.map(|stress| stress - matrix));
            let rows = sigma.into_iter().zip(band).map(|([a, b, c, d, e], [low, high])| [a, b, c, d, e, low, high]);
            table(&format!("{header},sigma_05,sigma_95"), rows)
        }
    };
    directory.write("sigma.csv", sigma)?;
    let last = fit.full.openings.last().copied().unwrap_or_default();
    let Matrix { ft, modulus, .. } = fit.full.matrix;
    warnings.extend(SofteningTable::new(&fit.full.law, ft, modulus, last).write(directory, fit.tables)?);
    directory.write("fit.json", format!("{:#}\n", summary(source, fit, &warnings)))?;
    if let Some(case) = with_bond(case, fit) {
        directory.write("bond-case.json", format!("{case:#}\n"))?;
    }
    let drawings = plots::write_all(directory, "plots", &figures(&measured, fit))?;
    warnings.extend(drawings.warnings);
    let rows = fit.numbers();
    let page = page::page(
        "σ(w) from the test of a notched beam",
        &html! {
            h2 { "What was fitted" }
            p { code { (source) } ", " (measured.len()) " points. RMS difference " (percent(fit.full.fitted.rms))
                " of the greatest strength. σ(w) by a rigid hinge was the start." }
            (page::warnings(&warnings))
            (page::pictures(&drawings.pictures))
            h2 { "Numbers" }
            div.scroll tabindex="0" { table {
                tr { th { "Number" } th { "Unit" } th.number { "Value" } th.number { "Standard error" } th { } }
                @for (name, unit, estimate) in &rows {
                    tr {
                        td { code { (name) } } td { (unit) } td.number { (significant(estimate.value, 4)) }
                        td.number { (standard_error(estimate)) }
                        td { @if !estimate.is_identifiable() { "not identifiable" } }
                    }
                }
            } }
            @if let Err(message) = &fit.bond { p { "The bond: " (message) "." } }
            @if let Some(tested) = fit.tested { p { (strengths(tested)) "." } }
            p { "Errors are standard errors to first order. A number whose standard error is above "
                (significant(100.0 * IDENTIFIABLE, 2)) " % of its value is not identifiable: the test does not determine it." }
        },
    );
    directory.write("report.html", page.into_string())?;
    Ok(warnings)
}

fn percent(part: f64) -> String {
    format!("{} %", significant(100.0 * part, 2))
}

/// The classes that a test's strengths would give as characteristic values: of the Model Code 2010, and of EN 1992-1-1:2023.
fn classes(Residual { limit, residual: [f_r1, _, f_r3, _] }: Residual) -> [Option<String>; 2] {
    [
        StrengthClass::new(limit, f_r1, f_r3).map(|class| class.to_string()),
        EurocodeClass::new(f_r1, f_r3).map(|class| class.to_string()),
    ]
}

/// Strengths of the test with their classes, as a sentence.
fn strengths(tested: Residual) -> String {
    let number = |value: f64| significant(value, 4);
    let [model_code, eurocode] = classes(tested).map(|class| class.unwrap_or_else(|| "none".into()));
    let limit = if tested.limit.is_nan() { String::new() } else { format!("f_L {} MPa, ", number(tested.limit)) };
    format!(
        "test: {limit}f_R1–4 {} MPa; as characteristic values these would be class {model_code} (Model Code 2010), {eurocode} (EN \
         1992-1-1:2023)",
        tested.residual.map(number).join(", ")
    )
}

/// The fit in a few lines for the terminal.
pub fn describe(fit: &BeamFit) -> String {
    let mut text = format!("RMS {} of the greatest strength\n", percent(fit.full.fitted.rms));
    for (name, unit, estimate) in fit.numbers() {
        let doubt = if estimate.is_identifiable() { "" } else { ", NOT IDENTIFIABLE" };
        let value = significant(estimate.value, 4);
        // writing to a String cannot fail
        let _ = writeln!(
            text,
            "{}",
            format!("  {name:<12} {value} {unit} ± {}{doubt}", standard_error(&estimate)).replace("  ±", " ±")
        );
    }
    if let Err(message) = &fit.bond {
        let _ = writeln!(text, "  bond: {message}");
    }
    if let Some(tested) = fit.tested {
        let _ = writeln!(text, "  {}", strengths(tested));
    }
    text
}

fn summary(source: &str, fit: &BeamFit, warnings: &[String]) -> Value {
    let numbers = fit.numbers().into_iter().map(|(name, unit, estimate)| {
        // JSON has no infinity: an error of which nothing is known is null
        let entry = json!({
            "value": estimate.value, "unit": unit, "standard_error": estimate.standard_error,
            "identifiable": estimate.is_identifiable(),
        });
        (name, entry)
    });
    let numbers: serde_json::Map<String, Value> = numbers.collect();
    json!({
        "test": source,
        "strengths": fit.tested.map(|tested| {
            let [class, class_en_1992_2023] = classes(tested);
            json!({
                "f_L": tested.limit, "f_R": tested.residual, "class": class, "class_en_1992_2023": class_en_1992_2023,
            })
        }),
        "rms_of_greatest": fit.full.fitted.rms,
        "warnings": warnings,
        "penalty_weight": fit.full.weight,
        "numbers": numbers,
        "correlation": rows_of(&fit.full.fitted.correlation),
        "bond": match &fit.bond {
            Ok(FittedBond { fitted, .. }) => {
                json!({ "rms_of_greatest": fitted.rms, "correlation": fitted.correlation.get((0, 1)) })
            }
            Err(message) => json!({ "message": message }),
        },
    })
}

/// The case with the bond that was found.
fn with_bond(case: &Value, fit: &BeamFit) -> Option<Value> {
    let bond = fit.bond.as_ref().ok()?;
    let mut case = case.clone();
    for ((name, _), estimate) in bond.names.iter().zip(&bond.fitted.estimates) {
        match *name {
            "f" => case["fibre"]["inclination"] = json!({ "type": "exp", "f": estimate.value }),
            name => case["fibre"][name] = json!(estimate.value),
        }
    }
    Some(case)
}

fn figures(measured: &[(f64, f64)], fit: &BeamFit) -> [Figure; 2] {
    let quantity = |column: &str| Quantity::of(column, &Default::default());
    let end = fit.full.openings.last().copied().unwrap_or_default();
    let law = |law: &Polyline| law.points().filter(|point| point.0 <= end).collect::<Vec<_>>();
    let cmod = measured.last().map_or(0.0, |point| point.0);
    let cmods = (0..POINTS).map(|k| cmod * (k as f64 / (POINTS - 1) as f64).powi(2));
    let figure = |name: &str, title: &str, [x, y]: [&str; 2], lines: Vec<Line>, marks: Vec<Marks>| Figure {
        name: name.into(),
        title: title.into(),
        x: quantity(x),
        y: quantity(y),
        lines,
        marks,
        ..Figure::default()
    };
    [
        figure(
            "sigma_w",
            "σ(w) from the test",
            ["w", "sigma"],
            vec![
                Line::numbered("from the test", law(&fit.full.law), 0),
                Line::numbered("by a rigid hinge", law(&fit.fast), 1),
                Line::numbered("the case's own", law(&fit.predicted), 2),
            ],
            Vec::new(),
        ),
        figure(
            "load_cmod",
            "Measured and computed load",
            ["cmod", "load"],
            vec![Line::numbered("computed", fit.forces(cmods), 0)],
            vec![Marks { label: "measured".into(), points: thinned(measured, MOST_MARKS), line: None }],
        ),
    ]
}
