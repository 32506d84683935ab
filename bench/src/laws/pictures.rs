//! Error against time, both logarithmic.

use super::error::ROUND_OFF;
use super::path::Path;
use super::subject::MeasuredLaw;
use super::{Measurement, Series};
use pullout_report::plots::figure::{Figure, Line, Scale, Style};
use pullout_report::plots::quantity::Quantity;

/// Errors below are drawn here: a logarithm has no zero.
const LEAST_ERROR: f64 = 1e-3 * ROUND_OFF;

/// One picture of the laws for each path, one for each law that has an algorithm of the thesis, one of model IV and what
/// it was made into.
pub(super) fn figures(subjects: &[MeasuredLaw], measurements: &[Measurement]) -> Vec<Figure> {
    let of_path = |path: Path| {
        let lines = subjects.iter().enumerate().filter_map(|(k, subject)| {
            let style = Style { color: k % COLORS, dash: k / COLORS };
            line(measurements, k, path, Series::Law, subject.name.into(), style)
        });
        figure(path.stem().into(), format!("Laws: {}", path.name()), lines.collect())
    };
    let of_thesis = |(k, subject): (usize, &MeasuredLaw)| {
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
    let with_thesis = subjects.iter().enumerate().filter_map(of_thesis);
    paths.chain(with_thesis).chain([concrete(subjects, measurements)]).collect()
}

/// `concrete_damage`, model IV and its box: a proportional path, one with reversals, one that turns.
fn concrete(subjects: &[MeasuredLaw], measurements: &[Measurement]) -> Figure {
    let number = |name: &str| subjects.iter().position(|subject| subject.name.starts_with(name));
    let series = [
        ("concrete_damage (IV-H)", Series::Law, "concrete_damage"),
        ("biaxial_damage", Series::Law, "model IV"),
        ("biaxial_damage", Series::Thesis, "model IV by Box 5.1"),
    ];
    let paths = [Path::Compression, Path::Cyclic, Path::NonProportional].into_iter().enumerate();
    let lines = paths.flat_map(|(color, path)| {
        series.into_iter().enumerate().filter_map(move |(dash, (name, series, shown))| {
            let label = format!("{shown}, {}", path.name());
            line(measurements, number(name)?, path, series, label, Style { color, dash })
        })
    });
    figure("concrete".into(), "Error against run time: concrete_damage and model IV".into(), lines.collect())
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
        key: None,
        equal_units: false,
    }
}
