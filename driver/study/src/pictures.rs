//! The pictures of a study: curves on top of each other, and what becomes of peak and work along x.

use super::claims::work_unit;
use super::results::{Results, RunResult};
use super::{Columns, Study};
use pullout_report::directory::ResultDirectory;
use pullout_report::plots::export;
use pullout_report::plots::figure::{Figure, Key, Line, Scale, Style};
use pullout_report::plots::quantity::Quantity;
use pullout_report::plots::{self, Drawings};
use pullout_run::number::significant;
use std::io;

/// Draws everything into `plots/` of the result directory, as SVG and, where a font is installed, as PNG.
///
/// # Errors
/// A file that cannot be written.
pub fn draw(directory: &mut ResultDirectory, study: &Study, results: &Results) -> io::Result<Drawings> {
    let mut drawings = plots::write_all(directory, "plots", &figures(study, results))?;
    for picture in &drawings.pictures {
        let name = picture.path.file_stem().unwrap_or_default().to_string_lossy();
        match export::png(&picture.svg) {
            Ok(png) => _ = directory.write(&format!("plots/{name}.png"), png)?,
            // what was computed is worth more than a copy of a picture
            Err(error) => {
                drawings.warnings.push(format!("the pictures are there as SVG, not all as PNG: {error}"));
                break;
            }
        }
    }
    Ok(drawings)
}

/// All pictures; those with nothing to show are left out.
fn figures(study: &Study, results: &Results) -> Vec<Figure> {
    let mut figures = Vec::new();
    let series = 0..study.series.len();
    for columns in std::iter::once(&study.curve).chain(&study.overlays) {
        let stem = format!("{}_{}", columns.y, columns.x);
        if study.series.len() > 1 {
            figures.push(overlay(study, results, columns, &stem, series.clone().collect()));
        }
        for series in series.clone() {
            let name = match study.series.len() {
                1 => stem.clone(),
                _ => format!("{stem}_{}", study.series[series].name),
            };
            figures.push(overlay(study, results, columns, &name, vec![series]));
        }
    }
    let [x_unit, y_unit] = &study.units;
    let end = results
        .work_to
        .map_or(String::new(), |end| format!(" up to {} {x_unit}", significant(end, 4)).trim_end().to_owned());
    let work_unit = work_unit(study);
    let peak: Number = |result| result.peak;
    let work: Number = |result| result.work;
    let first = first_member(study).map_or(String::new(), |member| study.members[member].title.clone());
    for (name, what, unit, number) in
        [("peak", "peak".to_owned(), y_unit, peak), ("work", format!("work{end}"), &work_unit, work)]
    {
        let along = |name: String, quantity: Quantity, normalised: bool| {
            along_x(study, results, name, quantity, number, normalised)
        };
        figures.push(along(name.into(), Quantity { name: what.clone(), unit: unit.into() }, false));
        if study.members.len() > 1 {
            let relative = Quantity { name: format!("{what}, over that at {first}"), unit: String::new() };
            figures.push(along(format!("{name}_normalised"), relative, true));
        }
    }
    figures.retain(|figure| figure.lines.iter().any(|line| line.points.iter().any(|(_, y)| y.is_finite())));
    figures
}

type Number = fn(&RunResult) -> Option<f64>;

/// The member with the least x, or the first.
fn first_member(study: &Study) -> Option<usize> {
    let x = |member: &usize| study.members[*member].x.unwrap_or(0.0);
    (0..study.members.len()).min_by(|a, b| x(a).total_cmp(&x(b)))
}

/// Draws the curves of some series: a colour for each member (a shade if there are more members than colours) and a dash for
/// each series.
fn overlay(study: &Study, results: &Results, columns: &Columns, name: &str, of: Vec<usize>) -> Figure {
    let shaded = study.members.len() > PALETTE;
    let order = if shaded { study.members_by_x() } else { (0..study.members.len()).collect() };
    let mut lines = Vec::new();
    let has_failed = |result: &RunResult| result.status.is_some() && !result.is_done();
    let titles = order.iter().map(|&member| {
        let title = &study.members[member].title;
        let failed = of.iter().filter(|&&series| has_failed(&results.runs[study.run_of(series, member)])).count();
        match failed {
            0 => title.clone(),
            _ if failed == of.len() => format!("{title} (failed)"),
            _ => format!("{title} ({failed} of {} failed)", of.len()),
        }
    });
    let titles = titles.collect();
    for (dash, &series) in of.iter().enumerate() {
        for (color, &member) in order.iter().enumerate() {
            let result = &results.runs[study.run_of(series, member)];
            let mut label = study.members[member].title.clone();
            if of.len() > 1 {
                label = format!("{}, {label}", study.series[series].title);
            }
            if has_failed(result) {
                label += " (failed)";
            }
            lines.push(Line {
                label,
                points: result.curve(columns),
                columns: (columns.x.clone(), columns.y.clone()),
                style: Style { color, dash },
                ..Line::default()
            });
        }
    }
    let dashes = of.iter().map(|&series| study.series[series].title.clone()).collect();
    let apart = of.len() > 1 && order.len() > 1;
    let key = (shaded || apart).then_some(Key { colors: titles, dashes, shaded });
    lines.retain(|line| !line.points.is_empty());
    let title = match of.as_slice() {
        [one] if !study.series[*one].title.is_empty() => format!("{}: {}", study.title, study.series[*one].title),
        _ => study.title.clone(),
    };
    let quantity = |column: &str| Quantity::of(column, &Default::default());
    Figure {
        name: name.into(),
        title,
        x: quantity(&columns.x),
        y: quantity(&columns.y),
        lines,
        key,
        ..Figure::default()
    }
}

/// Titles of the members, or their labels where titles would run into each other.
fn names(study: &Study) -> Vec<String> {
    let room = CHARACTERS / study.members.len().max(1);
    let fits = study.members.iter().all(|member| member.title.chars().count() < room);
    study.members.iter().map(|member| if fits { &member.title } else { &member.label }).cloned().collect()
}

/// Number of characters that fit along the x axis.
const CHARACTERS: usize = 70;
/// Number of colours that are easy to distinguish.
const PALETTE: usize = 7;

/// A number of the runs that are done along x: a line for each series.
fn along_x(study: &Study, results: &Results, name: String, y: Quantity, number: Number, normalised: bool) -> Figure {
    let (order, scale) = match &study.x {
        Some(x) => (study.members_by_x(), if x.logarithmic { Scale::Decades } else { Scale::Linear }),
        None => ((0..study.members.len()).collect(), Scale::Names(names(study))),
    };
    let line = |(k, series): (usize, &super::RunSeries)| {
        let value = |member: usize| {
            let result = &results.runs[study.run_of(k, member)];
            number(result).filter(|_| result.is_done())
        };
        let unit = if normalised { order.first().and_then(|&first| value(first)) } else { Some(1.0) };
        let points = order.iter().map(|&member| {
            let y = value(member).zip(unit).map_or(f64::NAN, |(value, unit)| value / unit);
            (study.members[member].x.unwrap_or(member as f64), y)
        });
        Line {
            label: series.title.clone(),
            points: points.collect(),
            columns: (String::new(), name.clone()),
            style: Style { color: k, dash: k },
            marked: true,
        }
    };
    let x = study.x.as_ref();
    Figure {
        title: study.title.clone(),
        x: Quantity {
            name: x.map_or(String::new(), |x| x.name.clone()),
            unit: x.map_or(String::new(), |x| x.unit.clone()),
        },
        y,
        lines: study.series.iter().enumerate().map(line).collect(),
        scale,
        name: name.clone(),
        ..Figure::default()
    }
}
