//! Savings by skipping: all of it, each item alone, and the cost of a larger far field.

use super::{LARGEST_INCREMENT, Specimen};
use crate::page::Page;
use crate::runs::Ran;
use crate::table::Table;
use crate::timing::median;
use crate::{BenchError, Settings};
use fe_core::mesh::specimen::Fibres;
use pullout_report::plots::figure::{Figure, Line, Scale, Style};
use pullout_report::plots::quantity::Quantity;
use pullout_run::number::significant;

/// Pulled so far, mm.
const END: f64 = 0.05;
const QUICK_END: f64 = 0.002;
/// Number of turns of each way.
const ROUNDS: usize = 3;

/// Items that are skipped: their name, in words of the case, and for the picture those that are not skipped.
const WAYS: [(&str, &str, &str); 6] = [
    ("everything", "\"all\"", "none"),
    ("all but unchanged elements", "{\"unchanged_elements\":false}", "elements"),
    ("all but the elastic far field", "{\"elastic_far_field\":false}", "far field"),
    ("all but factors used again", "{\"factor_reuse\":false}", "factors"),
    ("all but contact search", "{\"contact_search\":false}", "search"),
    ("nothing", "\"none\"", "all"),
];

/// The block's area over its usual one, the factor on width and depth, and how many times as long that may take.
const FAR_FIELDS: [(&str, f64, f64); 3] = [("1", 1.0, 1.0), ("4", 2.0, 1.3), ("16", 4.0, 2.0)];
/// Least ratio of the time of a run that skips nothing to that of one that skips everything.
const SKIPPING_TARGET: f64 = 3.0;
/// Loads and works of both ways may differ by so much: a crack opens a little earlier or later in another increment.
const SAME: f64 = 0.02;

/// Runs of one way.
struct Measured {
    name: String,
    seconds: f64,
    /// Median over the rounds of its time over the first way's.
    over_first: f64,
    ran: Ran,
}

/// All ways.
pub(crate) fn measure(settings: &Settings) -> Result<Page, BenchError> {
    let (end, rounds) = if settings.quick { (QUICK_END, 1) } else { (END, ROUNDS) };
    let specimen = Specimen::new(settings, end)?;
    let ways = WAYS.map(|(name, skip, _)| (name.to_owned(), vec![format!("skip={skip}")]));
    let ways = in_turns(&specimen, rounds, &ways)?;
    let Fibres { width, depth, .. } = Fibres::default();
    let block = |name: &str, factor: f64| {
        let [width, depth] = [width, depth].map(|length| factor * length);
        (name.to_owned(), vec![format!("mesh.specimen.width={width}"), format!("mesh.specimen.depth={depth}")])
    };
    let mut blocks = FAR_FIELDS.map(|(name, factor, _)| block(name, factor)).to_vec();
    let [.., (largest, factor, _)] = FAR_FIELDS;
    let (name, mut set) = block(&format!("{largest}, nothing skipped"), factor);
    set.push("skip=\"none\"".into());
    blocks.push((name, set));
    let blocks = in_turns(&specimen, rounds, &blocks)?;
    Ok(page(&ways, &blocks, end, settings.quick))
}

fn in_turns(
    specimen: &Specimen<'_>,
    rounds: usize,
    ways: &[(String, Vec<String>)],
) -> Result<Vec<Measured>, BenchError> {
    let mut runs: Vec<Vec<Ran>> = ways.iter().map(|_| Vec::new()).collect();
    for _ in 0..rounds {
        for ((_, set), runs) in ways.iter().zip(&mut runs) {
            runs.push(specimen.run(LARGEST_INCREMENT, set)?);
        }
    }
    let seconds: Vec<Vec<f64>> = runs.iter().map(|runs| runs.iter().map(|ran| ran.seconds).collect()).collect();
    let measured = ways.iter().zip(runs).zip(&seconds).filter_map(|(((name, _), mut runs), own)| {
        let ratios = own.iter().zip(&seconds[0]).map(|(own, first)| own / first);
        Some(Measured {
            name: name.clone(),
            seconds: median(own.clone()),
            over_first: median(ratios.collect()),
            ran: runs.pop()?,
        })
    });
    Ok(measured.collect())
}

const METHOD: &str = "\
The bent fibre of chapter 7 at 45° (`cases/chapter-7/inclined-fibre.json`) pulled by {end} mm. Times are those of the processor, medians of turns that
alternate. *Per iteration*: ways whose increments differ in number are compared by it. The answer of each way is compared
with that of everything skipped: the load at the end, and the work. *Far field*: the block's area is 1, 4, 16 times the usual one.";

fn page(ways: &[Measured], blocks: &[Measured], end: f64, quick: bool) -> Page {
    let mut data = Table::new([
        "part",
        "way",
        "freedoms",
        "cpu_s",
        "time_over_first",
        "increments",
        "iterations",
        "time_per_iteration_over_first",
        "load_N",
        "work_Nmm",
        "umat_calls",
        "factorisations",
    ]);
    let mut items = Table::new([
        "skipped",
        "CPU [s]",
        "over everything",
        "increments",
        "iterations",
        "per iteration",
        "load differs by",
        "work differs by",
    ]);
    let mut fields = Table::new(["far field", "freedoms", "CPU [s]", "over the usual", "increments", "iterations"]);
    let per_iteration = |measured: &Measured, first: &Measured| {
        let iterations = |measured: &Measured| measured.ran.statistics.iterations as f64;
        measured.over_first * iterations(first) / iterations(measured)
    };
    for (part, group) in [("skipped", ways), ("far field", blocks)] {
        let Some(first) = group.first() else { continue };
        for measured in group {
            let Measured { name, seconds, over_first, ran } = measured;
            let count = |name: &str| ran.findings.statistics.get(name).copied().unwrap_or(0);
            let [_, load, work] = ran.end;
            let statistics = &ran.statistics;
            data.push([
                part.into(),
                name.as_str().into(),
                ran.freedoms.into(),
                (*seconds).into(),
                (*over_first).into(),
                statistics.increments.into(),
                statistics.iterations.into(),
                per_iteration(measured, first).into(),
                load.into(),
                work.into(),
                count("umat_calls").into(),
                count("factorisations").into(),
            ]);
        }
    }
    let mut notes = Vec::new();
    let mut failed = Vec::new();
    if let Some(first) = ways.first() {
        for measured in ways {
            let difference = |k: usize| (measured.ran.end[k] / first.ran.end[k] - 1.0).abs();
            items.push([
                measured.name.as_str().into(),
                measured.seconds.into(),
                measured.over_first.into(),
                measured.ran.statistics.increments.into(),
                measured.ran.statistics.iterations.into(),
                per_iteration(measured, first).into(),
                difference(1).into(),
                difference(2).into(),
            ]);
            if difference(1).max(difference(2)) > SAME {
                failed.push(format!("with {} skipped the answer is another one", measured.name));
            }
        }
    }
    for measured in blocks {
        fields.push([
            measured.name.as_str().into(),
            measured.ran.freedoms.into(),
            measured.seconds.into(),
            measured.over_first.into(),
            measured.ran.statistics.increments.into(),
            measured.ran.statistics.iterations.into(),
        ]);
    }
    if !quick {
        notes.extend(
            ways.last().map(|none| target("Skipping saves a factor of", none.over_first, SKIPPING_TARGET, true)),
        );
        for (measured, (.., most)) in blocks.iter().zip(FAR_FIELDS).skip(1) {
            let what = format!("A far field {} times as large costs a factor of", measured.name);
            notes.push(target(&what, measured.over_first, most, false));
        }
        if let [.., large, unskipped] = blocks {
            notes.push(format!(
                "On the largest block skipping saves a factor of {}.",
                significant(unskipped.seconds / large.seconds, 3)
            ));
        }
    }
    Page {
        title: "Skipping what a scene does not need",
        method: METHOD.replace("{end}", &end.to_string()),
        data,
        summaries: vec![("Skipped".into(), items), ("Far field".into(), fields)],
        notes,
        figures: vec![figure(ways)],
        failed: (!failed.is_empty()).then(|| failed.join("; ")),
    }
}

fn target(what: &str, ratio: f64, limit: f64, at_least: bool) -> String {
    let reached = if at_least { ratio >= limit } else { ratio <= limit };
    let (word, side) = (if reached { "reached" } else { "**missed**" }, if at_least { "at least" } else { "at most" });
    format!("{what} {}; {side} {} is wanted: {word}.", significant(ratio, 3), significant(limit, 2))
}

fn figure(ways: &[Measured]) -> Figure {
    let names = WAYS.iter().map(|(.., not_skipped)| (*not_skipped).to_owned());
    Figure {
        name: "items".into(),
        title: "Time if this is not skipped, over that with everything skipped".into(),
        x: Quantity { name: String::new(), unit: String::new() },
        y: Quantity { name: "time ratio".into(), unit: String::new() },
        lines: vec![Line {
            label: "45°, bent".into(),
            points: ways.iter().enumerate().map(|(k, measured)| (k as f64, measured.over_first)).collect(),
            columns: ("way".into(), "time_over_first".into()),
            style: Style::default(),
            marked: true,
        }],
        marks: Vec::new(),
        scale: Scale::Names(names.collect()),
        key: None,
        equal_units: false,
    }
}
