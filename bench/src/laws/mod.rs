//! Work–precision of the laws: error against run time over the number of increments.

pub(super) mod driven;
mod error;
mod forty_digits;
mod path;
mod pictures;
mod subject;
mod summary;
#[cfg(test)]
mod test;
mod thesis;

use super::page::Page;
use super::table::{Cell, Table};
use super::timing::{Times, Way};
use super::{BenchError, Settings};
use driven::Driven;
use path::{Components, Path};
use pullout_run::path::Statistics;
use std::hint::black_box;
use std::path::PathBuf;
use subject::{MeasuredLaw, subjects};

/// Algorithm that finds the stress.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Series {
    /// The law's own update, along given strains.
    Law,
    /// The thesis's algorithm, along the same strains.
    Thesis,
    /// The program with the plugin, sides free of stress.
    Driver,
}

/// A path in some number of increments.
#[derive(Clone, Debug)]
struct Measurement {
    subject: usize,
    path: Path,
    series: Series,
    increments: usize,
    result: Result<Figures, String>,
}

/// Figures of one measurement.
#[derive(Clone, Copy, Debug)]
struct Figures {
    /// max |σ − σ_ref|/max |σ_ref|.
    error: f64,
    /// Time of a whole path, s.
    seconds: f64,
    /// Ratio of that time to the law's own in the same turns.
    time_ratio: f64,
    /// Statistics of the driver.
    statistics: Option<Statistics>,
}

/// Finer than the finest run.
const REFERENCE_REFINEMENT: usize = 10;

/// Numbers of increments, and the greatest of them that the driver runs.
struct Counts {
    all: Vec<usize>,
    driver_most: usize,
}

impl Counts {
    fn new(quick: bool) -> Self {
        let most = if quick { 1_000 } else { 100_000 };
        let series = [1, 2, 5].into_iter().flat_map(|digit| (1..6).map(move |power| digit * 10_usize.pow(power)));
        let mut all: Vec<usize> = series.filter(|&n| n <= most && (!quick || n.to_string().starts_with('1'))).collect();
        all.sort_unstable();
        Self { all, driver_most: if quick { 100 } else { 10_000 } }
    }

    fn most(&self) -> usize {
        self.all.last().copied().unwrap_or(1)
    }

    /// Returns those of the driver; on the non-proportional path each increment is a step of its own, and there are
    /// fewer.
    fn of_driver(&self, path: Path) -> impl Iterator<Item = usize> + '_ {
        let most = if path == Path::NonProportional { self.driver_most / 10 } else { self.driver_most };
        self.all.iter().copied().filter(move |&n| n <= most)
    }
}

/// Measures all laws on all paths.
pub(super) fn measure(settings: &Settings) -> Result<Page, BenchError> {
    let subjects = subjects();
    let counts = Counts::new(settings.quick);
    let mut measurements = Vec::new();
    for (index, subject) in subjects.iter().enumerate() {
        for path in Path::ALL {
            measurements.extend(measure_path(index, subject, path, &counts, settings)?);
        }
    }
    let digits = forty_digits::compare()?;
    Ok(Page {
        title: "Error against run time of the laws",
        method: METHOD.replace("{most}", &(REFERENCE_REFINEMENT * counts.most()).to_string()),
        data: data(&subjects, &measurements),
        summaries: summary::tables(&subjects, &measurements, &digits),
        notes: summary::notes(&subjects, &measurements, &digits),
        figures: pictures::figures(&subjects, &measurements),
        failed: None,
    })
}

const METHOD: &str = "\
Each law follows five strain paths in N increments, stress only. The error is the largest |σ − σ_ref| of a path over the
largest |σ_ref|; the reference is the law itself in {most} increments. *Law*: the law's own update. *Thesis*: the
algorithm of the thesis's box, along the same strains, against the same reference. *Driver*: the program with the plugin
on the corresponding path with free sides (Newton's method, cut-backs), against itself in ten times as many increments as its
finest run; on the non-proportional path, where all strains are given, against the law's reference.

Paths: uniaxial tension and compression and biaxial compression are proportional (the sides follow as in elastic uniaxial
or −1/−0.52 stress); the reverse cyclic path has five straight legs, whose ends are met by every N; on the
non-proportional 3-D path the principal directions rotate and maxima are passed between increments. Times are medians of
turns that alternate between the series.";

/// The series of a path, and the times of the same N in turns.
fn measure_path(
    index: usize,
    subject: &MeasuredLaw,
    path: Path,
    counts: &Counts,
    settings: &Settings,
) -> Result<Vec<Measurement>, BenchError> {
    let strained = |message: String| BenchError::Failed(format!("{} in {}: {message}", subject.name, path.name()));
    let finest = REFERENCE_REFINEMENT * counts.most();
    let reference = (subject.ours)(&subject.props, &path.strains(&subject.extent, finest), REFERENCE_REFINEMENT)
        .map_err(strained)?;
    let driver_reference = driver_reference(subject, path, counts, &reference, &settings.plugin_paths)?;
    let driven: Vec<usize> = counts.of_driver(path).collect();
    let mut measurements = Vec::new();
    for &n in &counts.all {
        let strains = path.strains(&subject.extent, n);
        let follow = |follow: subject::Follow| follow(&subject.props, &strains, 1);
        let mut results = vec![(Series::Law, follow(subject.ours).map(|stresses| (stresses, None)))];
        if let Some((_, thesis)) = subject.thesis {
            results.push((Series::Thesis, follow(thesis).map(|stresses| (stresses, None))));
        }
        let driver = match driven.contains(&n) {
            true => Some(Driven::new(subject, path, n, &settings.plugin_paths)?),
            false => None,
        };
        if let Some(driver) = &driver {
            results.push((Series::Driver, driver.run().map(|run| (run.stresses, Some(run.statistics)))));
        }
        let timed: Vec<Series> =
            results.iter().filter(|(_, result)| result.is_ok()).map(|(series, _)| *series).collect();
        let times = time(subject, &strains, driver.as_ref(), &timed, settings);
        let position = |wanted: Series| timed.iter().position(|series| *series == wanted);
        for (series, result) in results {
            let reference = if series == Series::Driver { driver_reference.as_ref() } else { Ok(&reference) };
            let figures = |(stresses, statistics): (Vec<Components>, Option<Statistics>)| {
                let reference = reference.map_err(String::clone)?;
                let way = position(series).ok_or("not timed")?;
                let error = error::error(&stresses, reference, error::largest(reference));
                if !error.is_finite() {
                    return Err("the stress is no number".into());
                }
                Ok(Figures {
                    error,
                    seconds: times.seconds(way),
                    time_ratio: position(Series::Law).map_or(f64::NAN, |law| times.ratio(way, law)),
                    statistics,
                })
            };
            let result = result.and_then(figures);
            measurements.push(Measurement { subject: index, path, series, increments: n, result });
        }
    }
    Ok(measurements)
}

/// The driver's own reference, with the stresses at the increments of its finest run; or why it has none.
fn driver_reference(
    subject: &MeasuredLaw,
    path: Path,
    counts: &Counts,
    reference: &[Components],
    plugin_paths: &[PathBuf],
) -> Result<Result<Vec<Components>, String>, BenchError> {
    if path == Path::NonProportional {
        return Ok(Ok(reference.to_vec()));
    }
    let most = counts.of_driver(path).max().unwrap_or(1);
    let run = Driven::new(subject, path, REFERENCE_REFINEMENT * most, plugin_paths)?.run();
    Ok(run.map(|run| run.stresses))
}

fn time(
    subject: &MeasuredLaw,
    strains: &[Components],
    driver: Option<&Driven>,
    timed: &[Series],
    settings: &Settings,
) -> Times {
    let way = |series: &Series| -> Way<'_> {
        let follow = |follow: subject::Follow| -> Way<'_> {
            Box::new(move || {
                let _ = black_box(follow(black_box(&subject.props), black_box(strains), 1));
            })
        };
        match (series, subject.thesis, driver) {
            (Series::Thesis, Some((_, thesis)), _) => follow(thesis),
            (Series::Driver, _, Some(driver)) => Box::new(move || {
                let _ = black_box(driver.run());
            }),
            _ => follow(subject.ours),
        }
    };
    settings.timing().take_turns(timed.iter().map(way).collect())
}

impl Series {
    fn name(self, subject: &MeasuredLaw) -> &'static str {
        match self {
            Self::Law => "law",
            Self::Thesis => subject.thesis.map_or("thesis", |(name, _)| name),
            Self::Driver => "driver",
        }
    }
}

fn data(subjects: &[MeasuredLaw], measurements: &[Measurement]) -> Table {
    let mut table = Table::new([
        "law",
        "path",
        "series",
        "increments",
        "error",
        "ns_per_increment",
        "time_over_law",
        "iterations_per_increment",
        "cutbacks",
        "message",
    ]);
    for Measurement { subject, path, series, increments, result } in measurements {
        let subject = &subjects[*subject];
        let figures = result.as_ref().ok();
        let statistics = figures.and_then(|figures| figures.statistics);
        let number = |number: fn(&Figures) -> f64| Cell::from(figures.map(number));
        let count = *increments as f64;
        table.push([
            subject.name.into(),
            path.name().into(),
            series.name(subject).into(),
            (*increments).into(),
            number(|figures| figures.error),
            figures.map(|figures| 1e9 * figures.seconds / count).into(),
            number(|figures| figures.time_ratio),
            statistics.map(|statistics| statistics.iterations as f64 / count).into(),
            statistics.map_or(Cell::Absent(""), |statistics| statistics.cutbacks.into()),
            result.as_ref().err().cloned().unwrap_or_default().into(),
        ]);
    }
    table
}
