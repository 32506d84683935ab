//! Error against time, both logarithmic.

use super::error::ROUND_OFF;
use super::path::Path;
use super::subject::Subject;
use super::{Measurement, Series};
use crate::output::plots::figure::{Figure, Line, Scale, Style};
use crate::output::plots::quantity::Quantity;

/// Errors below are drawn here: a logarithm has no zero.
const LEAST_ERROR: f64 = 1e-3 * ROUND_OFF;

/// One picture of the laws for each path, and one for each law that has an algorithm of the thesis.
pub(super) fn figures(subjects: &[Subject], measurements: &[Measurement]) -> Vec<Figure> {
    let of_path = |path: Path| {
        let lines = subjects.iter().enumerate().filter_map(|(k, subject)| {
            let style = Style { color: k % COLORS, dash: k / COLORS };
            line(measurements, k, path, Series::Law, subject.name.into(), style)
        });
        figure(path.stem().into(), format!("Laws: {}", path.name()), lines.collect())
    };
    let of_thesis = |(k, subject): (usize, &Subject)| {
        subject.thesis?;
        let series = [Series::Law, Series::Thesis].into_iter().enumerate();
        let lines = series.flat_map(|(dash, series)| {
            let name = series.name(subject);
            Path::ALL.into_iter().enumerate().filter_map(move |(color, path)| {
                let label = format!("{name}, {}", path.name());
                line(measurements, k, path, series, label, Style { color, dash })
            })
        });
        Some(figure(format!("{}-thesis", subject.law), subject.name.into(), lines.collect()))
    };
    let paths = Path::ALL.into_iter().map(of_path);
    paths.chain(subjects.iter().enumerate().filter_map(of_thesis)).collect()
}

/// Colours of lines before they come again with dashes.
const COLORS: usize = 7;

fn line(
    measurements: &[Measurement],
    subject: usize,
    path: Path,
    series: Series,
    label: String,
    style: Style,
) -> Option<Line> {
    let is_wanted = |m: &&Measurement| m.subject == subject && m.path == path && m.series == series;
    let points: Vec<(f64, f64)> = measurements
        .iter()
        .filter(is_wanted)
        .filter_map(|m| m.result.as_ref().ok())
        .map(|figures| (1e6 * figures.seconds, figures.error.max(LEAST_ERROR)))
        .collect();
    let columns = ("ns_per_increment".into(), "error".into());
    (!points.is_empty()).then_some(Line { label, points, columns, style, marked: true })
}

fn figure(name: String, title: String, lines: Vec<Line>) -> Figure {
    Figure {
        name,
        title,
        x: Quantity { name: "time of the path".into(), unit: "µs".into() },
        y: Quantity { name: "error".into(), unit: String::new() },
        lines,
        marks: Vec::new(),
        scale: Scale::BothDecades,
        equal_units: false,
    }
}
