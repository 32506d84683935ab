//! Comparison with other programs, where they are installed: specimens in CalculiX, a material point in simcoon,
//! jaxmat and singlepointsim.

mod calculix;
mod deck;
mod points;
mod rival;
mod specimens;

use super::page::Page;
use super::table::{Cell, Table};
use super::{BenchError, Settings};
use pullout_report::plots::figure::{Figure, Line, Scale};
use pullout_report::plots::quantity::Quantity;
use pullout_run::number::significant;

/// The share of CalculiX's time that we aim to stay below on the plates of the most elements and on the strip.
const TARGET_SHARE: f64 = 0.125;
const TARGETS: [&str; 2] = ["plate, 20000", "drag-out strip"];
/// Factor by which a point is to be faster than a peer.
const TARGET_RATIO: f64 = 5.0;

/// A program on a specimen.
#[derive(Clone, Debug)]
struct Side {
    /// Name and version.
    program: String,
    /// Time of the processor, s.
    seconds: f64,
    /// Reaction at the end, N.
    result: f64,
    iterations: u64,
}

impl Side {
    fn per_iteration(&self) -> f64 {
        self.seconds / self.iterations as f64
    }
}

const ABSENT: Cell = Cell::Absent("not installed");

const METHOD: &str = "\
**Specimens** (`cases/benchmark/`): the same mesh, law and steps in CalculiX (`ccx` of the PATH), one thread each; the processor's time of either with reading or meshing,
and nothing written but the reaction; medians of turns that alternate. The strip's exact drag is 15 N. **Points**: uniaxial stress to a strain of 0.02 with
free sides, the law's parameters the same, in simcoon with its own laws in C++, in jaxmat with its own laws compiled by JAX, and in singlepointsim with a UMAT in
Fortran (`--python PYTHON` or `PULLOUT_PYTHON` names a Python that has them). *Analysis*: the processor's time of the solvers alone, in a process that is running;
*process*: of a process from start to end; JAX compiles in each. Errors are the worst of all stresses against the exact ones at the strain that was reached,
relative to the largest; singlepointsim records the equivalent stress alone. A ratio is the median over the turns of the peer's time over ours.";

/// All comparisons.
pub(super) fn measure(settings: &Settings) -> Result<Page, BenchError> {
    let points = points::compare(settings)?;
    let specimens = specimens::compare(settings)?;
    let mut notes = Vec::new();
    if !settings.quick {
        notes.extend(specimens.iter().filter_map(share_note));
        notes.extend(points.iter().flat_map(ratio_notes));
    }
    let trouble: Vec<String> = specimens.iter().filter_map(specimens::Compared::trouble).collect();
    Ok(Page {
        title: "The same work in other programs",
        method: METHOD.into(),
        data: data(&specimens, &points),
        summaries: vec![
            ("Specimens".into(), specimen_table(&specimens)),
            ("Points: the analysis".into(), point_table(&points, 0, |run| run.analysis)),
            ("Points: the whole process".into(), point_table(&points, 1, |run| run.process)),
        ],
        notes,
        figures: figure(&specimens, &points).into_iter().collect(),
        failed: (!trouble.is_empty()).then(|| trouble.join("; ")),
    })
}

fn word(is_reached: bool) -> &'static str {
    if is_reached { "reached" } else { "**missed**" }
}

fn share_note(compared: &specimens::Compared) -> Option<String> {
    let share = compared.share.filter(|_| TARGETS.iter().any(|target| compared.name.starts_with(target)))?;
    Some(format!(
        "{}: {} of CalculiX's time; at most {TARGET_SHARE} is wanted: {}.",
        compared.name,
        significant(share, 3),
        word(share <= TARGET_SHARE)
    ))
}

fn ratio_notes(compared: &points::Compared) -> impl Iterator<Item = String> {
    compared
        .theirs
        .iter()
        .filter_map(|peer| peer.run.as_ref())
        .map(|(theirs, [ratio, _])| ratio_note(compared, theirs, *ratio))
}

fn ratio_note(compared: &points::Compared, theirs: &points::Run, ratio: f64) -> String {
    let is_as_good = compared.ours.error <= theirs.error;
    format!(
        "{}: {} times as fast as {} with an error of {} against {}; at least {TARGET_RATIO} times with no greater error is wanted: {}.",
        compared.law,
        significant(ratio, 3),
        theirs.program,
        significant(compared.ours.error, 2),
        significant(theirs.error, 2),
        word(ratio >= TARGET_RATIO && is_as_good)
    )
}

fn data(specimens: &[specimens::Compared], points: &[points::Compared]) -> Table {
    let mut table = Table::new([
        "part",
        "case",
        "program",
        "freedoms",
        "increments",
        "iterations",
        "cpu_s",
        "process_cpu_s",
        "result",
        "exact_error",
        "time_over_ours",
        "process_time_over_ours",
    ]);
    for compared in specimens {
        let mut push = |side: Option<&Side>, ratio: Option<f64>| {
            let number = |of: fn(&Side) -> f64| side.map(of).map_or(ABSENT, Cell::from);
            let error = side.and_then(|side| compared.exact.map(|exact| (side.result / exact - 1.0).abs()));
            table.push([
                "specimen".into(),
                compared.name.as_str().into(),
                side.map_or("CalculiX", |side| &side.program).into(),
                compared.freedoms.into(),
                compared.increments.into(),
                side.map_or(ABSENT, |side| side.iterations.into()),
                number(|side| side.seconds),
                Cell::Absent(""),
                number(|side| side.result),
                error.into(),
                ratio.into(),
                Cell::Absent(""),
            ]);
        };
        push(Some(&compared.ours), Some(1.0));
        push(compared.theirs.as_ref(), compared.share.map(f64::recip));
    }
    for compared in points {
        let mut push = |name: &str, run: Option<&points::Run>, ratios: Option<[f64; 2]>| {
            let number = |of: fn(&points::Run) -> f64| run.map(of).map_or(ABSENT, Cell::from);
            table.push([
                "point".into(),
                compared.law.into(),
                run.map_or(name, |run| &run.program).into(),
                Cell::Absent(""),
                compared.increments.into(),
                Cell::Absent(""),
                number(|run| run.analysis),
                number(|run| run.process),
                number(|run| run.result),
                number(|run| run.error),
                ratios.map(|[analysis, _]| analysis).into(),
                ratios.map(|[_, process]| process).into(),
            ]);
        };
        push("pullout", Some(&compared.ours), Some([1.0; 2]));
        for points::Peer { name, run } in &compared.theirs {
            push(name, run.as_ref().map(|(run, _)| run), run.as_ref().map(|(_, ratios)| *ratios));
        }
    }
    table
}

fn specimen_table(specimens: &[specimens::Compared]) -> Table {
    let mut table = Table::new([
        "specimen",
        "unknowns",
        "ours [s]",
        "CalculiX [s]",
        "share",
        "our iterations",
        "its iterations",
        "share per iteration",
        "our reaction [N]",
        "reactions differ by",
        "our error",
        "its error",
    ]);
    for compared in specimens {
        let specimens::Compared { ours, theirs, exact, .. } = compared;
        let its = |of: &dyn Fn(&Side) -> f64| theirs.as_ref().map_or(ABSENT, |side| of(side).into());
        let error = |side: &Side| exact.map(|exact| (side.result / exact - 1.0).abs());
        table.push([
            compared.name.as_str().into(),
            compared.freedoms.into(),
            ours.seconds.into(),
            its(&|side| side.seconds),
            compared.share.map_or(ABSENT, Cell::from),
            ours.iterations.into(),
            theirs.as_ref().map_or(ABSENT, |side| side.iterations.into()),
            its(&|side| ours.per_iteration() / side.per_iteration()),
            ours.result.into(),
            its(&|side| (ours.result / side.result - 1.0).abs()),
            error(ours).into(),
            theirs.as_ref().and_then(error).into(),
        ]);
    }
    table
}

fn point_table(points: &[points::Compared], which: usize, seconds: impl Fn(&points::Run) -> f64) -> Table {
    let mut table = Table::new(["law", "program", "increments", "increments/s", "ratio", "error", "turns"]);
    for compared in points {
        let mut push = |name: &str, run: Option<&points::Run>, ratio: Option<f64>| {
            let speed = |run: &points::Run| compared.increments as f64 / seconds(run);
            table.push([
                compared.law.into(),
                run.map_or(name, |run| &run.program).into(),
                compared.increments.into(),
                run.map_or(ABSENT, |run| speed(run).into()),
                ratio.into(),
                run.map_or(ABSENT, |run| run.error.into()),
                compared.rounds.into(),
            ]);
        };
        push("pullout", Some(&compared.ours), Some(1.0));
        for points::Peer { name, run } in &compared.theirs {
            push(name, run.as_ref().map(|(run, _)| run), run.as_ref().map(|(_, ratios)| ratios[which]));
        }
    }
    table
}

/// Draws the ratios of the peers' times to ours; `None` for peers that are not installed.
fn figure(specimens: &[specimens::Compared], points: &[points::Compared]) -> Option<Figure> {
    let of_specimens = specimens.iter().filter_map(|compared| {
        let name = if compared.name.starts_with("plate") {
            // labels stand side by side
            let size = compared.name.split(' ').nth(1).unwrap_or_default();
            format!("{size}{}", if compared.name.contains("large") { "*" } else { "" })
        } else {
            "strip".to_owned()
        };
        compared.share.map(|share| (name, share.recip()))
    });
    let of_points = points.iter().filter_map(|compared| {
        let name = if compared.law == "linear_elastic" { "elastic" } else { "J2" };
        // the first of them; the tables have all
        compared.theirs.first()?.run.as_ref().map(|(_, [analysis, _])| (name.to_owned(), *analysis))
    });
    let (names, ratios): (Vec<String>, Vec<f64>) = of_specimens.chain(of_points).unzip();
    let bars = ratios.iter().enumerate().map(|(k, ratio)| (k as f64, *ratio));
    (!ratios.is_empty()).then(|| Figure {
        name: "ratios".into(),
        title: "Time over ours: CalculiX (plates, * large displacements; strip), simcoon (points)".into(),
        x: Quantity { name: String::new(), unit: String::new() },
        y: Quantity { name: "time ratio".into(), unit: String::new() },
        lines: vec![Line { marked: true, ..Line::numbered("peer", bars.collect(), 0) }],
        marks: Vec::new(),
        scale: Scale::Names(names),
        key: None,
        equal_units: false,
    })
}
