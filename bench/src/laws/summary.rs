//! Summary of the measurements.

use super::error::{ROUND_OFF, order};
use super::forty_digits::Comparison;
use super::path::Path;
use super::subject::MeasuredLaw;
use super::{Figures, Measurement, Series};
use crate::table::{Cell, Table};
use pullout_run::number::significant;

/// Returns the successful measurements of one law, path and series.
fn of(
    measurements: &[Measurement],
    subject: usize,
    path: Path,
    series: Series,
) -> impl Iterator<Item = (usize, &Figures)> {
    let is_wanted = move |m: &&Measurement| m.subject == subject && m.path == path && m.series == series;
    measurements.iter().filter(is_wanted).filter_map(|m| Some((m.increments, m.result.as_ref().ok()?)))
}

/// N and error.
fn errors(measurements: &[Measurement], subject: usize, path: Path, series: Series) -> Vec<(usize, f64)> {
    of(measurements, subject, path, series).map(|(n, figures)| (n, figures.error)).collect()
}

fn worst(errors: &[(usize, f64)]) -> Option<f64> {
    errors.iter().map(|(_, error)| *error).reduce(f64::max)
}

/// All tables of the page.
pub(super) fn tables(
    subjects: &[MeasuredLaw],
    measurements: &[Measurement],
    digits: &[Comparison],
) -> Vec<(String, Table)> {
    let mut tables = vec![
        ("Largest error of the law over all N".to_owned(), largest_errors(subjects, measurements)),
        (
            "Non-proportional 3-D path: error, order (power of 1/N), time".to_owned(),
            non_proportional(subjects, measurements),
        ),
        ("The law and the thesis's algorithm".to_owned(), thesis(subjects, measurements)),
        ("The driver: free sides, Newton's method, cut-backs".to_owned(), driver(subjects, measurements)),
    ];
    if !digits.is_empty() {
        tables.push(("Against 40 digits, in fewer and fewer increments".to_owned(), forty_digits(digits)));
    }
    tables
}

fn largest_errors(subjects: &[MeasuredLaw], measurements: &[Measurement]) -> Table {
    let mut table = Table::new(["law", "tension", "compression", "biaxial", "cyclic", "non-proportional"]);
    for (k, subject) in subjects.iter().enumerate() {
        let [a, b, c, d, e] = Path::ALL.map(|path| Cell::from(worst(&errors(measurements, k, path, Series::Law))));
        table.push([subject.name.into(), a, b, c, d, e]);
    }
    table
}

/// N at which single errors are shown.
const SHOWN: usize = 1000;

fn non_proportional(subjects: &[MeasuredLaw], measurements: &[Measurement]) -> Table {
    let mut table =
        Table::new(["law", "series", "error at N = 10", "at N = 1000", "at the finest", "order", "ns/update"]);
    for (k, subject) in subjects.iter().enumerate() {
        for series in [Series::Law, Series::Thesis] {
            let all = errors(measurements, k, Path::NonProportional, series);
            let Some(finest) = all.last() else { continue };
            let at = |wanted: usize| all.iter().find(|(n, _)| *n == wanted).map(|(_, error)| *error);
            let time = of(measurements, k, Path::NonProportional, series).find(|(n, _)| *n == SHOWN);
            table.push([
                subject.name.into(),
                series.name(subject).into(),
                at(10).into(),
                at(SHOWN).into(),
                finest.1.into(),
                order(&all).into(),
                time.map(|(n, figures)| 1e9 * figures.seconds / n as f64).into(),
            ]);
        }
    }
    table
}

fn thesis(subjects: &[MeasuredLaw], measurements: &[Measurement]) -> Table {
    let mut table = Table::new([
        "law",
        "path",
        "largest error of the law",
        "of the box, N = 10",
        "of the box, finest N",
        "order of the box",
        "time of the box / law",
    ]);
    for (k, subject) in subjects.iter().enumerate().filter(|(_, subject)| subject.thesis.is_some()) {
        for path in Path::ALL {
            let own = errors(measurements, k, path, Series::Law);
            let box_errors = errors(measurements, k, path, Series::Thesis);
            let ratio = of(measurements, k, path, Series::Thesis).find(|(n, _)| *n == SHOWN);
            let name = format!("{}, {}", subject.name, Series::Thesis.name(subject));
            table.push([
                name.into(),
                path.name().into(),
                worst(&own).into(),
                box_errors.first().map(|(_, error)| *error).into(),
                box_errors.last().map(|(_, error)| *error).into(),
                order(&box_errors).into(),
                ratio.map(|(_, figures)| figures.time_ratio).into(),
            ]);
        }
    }
    table
}

fn driver(subjects: &[MeasuredLaw], measurements: &[Measurement]) -> Table {
    let mut table =
        Table::new(["law", "path", "largest error", "iterations/increment", "cut-backs", "runs that failed"]);
    for (k, subject) in subjects.iter().enumerate() {
        for path in Path::ALL {
            let runs: Vec<_> = of(measurements, k, path, Series::Driver).collect();
            let tried =
                measurements.iter().filter(|m| m.subject == k && m.path == path && m.series == Series::Driver).count();
            let statistics = || runs.iter().filter_map(|(_, figures)| figures.statistics);
            let increments: u64 = statistics().map(|s| s.increments).sum();
            let iterations: u64 = statistics().map(|s| s.iterations).sum();
            table.push([
                subject.name.into(),
                path.name().into(),
                worst(&errors(measurements, k, path, Series::Driver)).into(),
                (increments > 0).then(|| iterations as f64 / increments as f64).into(),
                statistics().map(|s| s.cutbacks).sum::<u64>().into(),
                (tried - runs.len()).into(),
            ]);
        }
    }
    table
}

fn forty_digits(digits: &[Comparison]) -> Table {
    let mut table = Table::new(["law", "path", "file", "increments", "largest error"]);
    for Comparison { law, path, file, errors } in digits {
        let counts: Vec<String> = errors.iter().map(|(n, _)| n.to_string()).collect();
        let cells = [(*law).into(), (*path).into(), (*file).into(), counts.join(", ").into(), worst(errors).into()];
        table.push(cells);
    }
    table
}

/// Sentences that follow from the numbers.
pub(super) fn notes(subjects: &[MeasuredLaw], measurements: &[Measurement], digits: &[Comparison]) -> Vec<String> {
    let mut notes = Vec::new();
    let mut exact = Vec::new();
    let mut not_exact = Vec::new();
    for (k, subject) in subjects.iter().enumerate() {
        let paths = Path::ALL.into_iter().filter(|path| path.is_met_by_any_increments());
        let error = paths.filter_map(|path| worst(&errors(measurements, k, path, Series::Law))).fold(0.0, f64::max);
        let text = format!("{} ({})", subject.name, significant(error, 2));
        if error <= ROUND_OFF {
            exact.push(text)
        } else {
            not_exact.push(text)
        };
        if subject.is_path_exact && error > ROUND_OFF {
            notes.push(format!(
                "**{} should not depend on N on these paths, but does: {}.**",
                subject.name,
                significant(error, 2)
            ));
        }
    }
    let bound = significant(ROUND_OFF, 2);
    notes.push(format!(
        "On the proportional and the cyclic paths the error is at round-off (≤ {bound}) for every N: {}. It is not: {}.",
        exact.join(", "),
        if not_exact.is_empty() { "none".into() } else { not_exact.join(", ") }
    ));
    if digits.is_empty() {
        notes.push("The 40-digit responses (tests/reference) are not here: run it in the repository's folder.".into());
    }
    notes
}
