//! Savings by skipping: all of it and each item alone, in blocks of three sizes and in a plate in plastic flow.

use super::{LARGEST_INCREMENT, Specimen};
use crate::page::Page;
use crate::runs::{Ran, run};
use crate::table::Table;
use crate::timing::median;
use crate::{BenchError, Settings};
use fe_core::mesh::specimen::Fibres;
use pullout_report::plots::figure::{Figure, Line, Scale};
use pullout_report::plots::quantity::Quantity;
use pullout_run::number::significant;

/// Pulled so far, mm.
const END: f64 = 0.05;
const QUICK_END: f64 = 0.002;
/// Number of turns of each way.
const ROUNDS: usize = 3;

/// Skipped items: their name, how a case writes them, and the items that are not skipped, for the picture.
const WAYS: [(&str, &str, &str); 6] = [
    ("everything", "\"all\"", "none"),
    ("all but unchanged elements", "{\"unchanged_elements\":false}", "elements"),
    ("all but the elastic far field", "{\"elastic_far_field\":false}", "far field"),
    ("all but factors used again", "{\"factor_reuse\":false}", "factors"),
    ("all but contact search", "{\"contact_search\":false}", "search"),
    ("nothing", "\"none\"", "all"),
];

/// Blocks: their name, the factor on width and depth, and how many times as long as the usual one they may take.
const BLOCKS: [(&str, f64, f64); 3] = [("usual block", 1.0, 1.0), ("4 times", 2.0, 1.3), ("16 times", 4.0, 2.0)];
const PLATE: &str = "plate";
const PLATE_CASE: &str = include_str!("../../../cases/benchmark/plate-with-hole.json");
/// Least ratio of the time of a run that skips nothing to that of one that skips everything.
const SKIPPING_TARGET: f64 = 3.0;
/// What saves less in every scene is not worth its code.
const WORTH: f64 = 1.05;
/// Loads and works of both ways may differ by so much: a crack opens a little earlier or later in another increment.
const SAME: f64 = 0.02;

/// Runs of one way.
struct Measured {
    seconds: f64,
    /// Median over the rounds of its time over the first way's.
    over_first: f64,
    ran: Ran,
}

/// Runs of all ways in one scene.
struct Scene {
    name: &'static str,
    ways: Vec<Measured>,
}

/// All ways in all scenes.
pub(crate) fn measure(settings: &Settings) -> Result<Page, BenchError> {
    let (end, rounds) = if settings.quick { (QUICK_END, 1) } else { (END, ROUNDS) };
    let specimen = Specimen::new(settings, end)?;
    let Fibres { width, depth, .. } = Fibres::default();
    let mut scenes = Vec::new();
    for (name, factor, _) in BLOCKS {
        let [width, depth] = [("width", width), ("depth", depth)]
            .map(|(name, length)| format!("mesh.specimen.{name}={}", factor * length));
        let one = |skip: String| specimen.run(LARGEST_INCREMENT, &[width.clone(), depth.clone(), skip]);
        scenes.push(Scene { name, ways: in_turns(rounds, one)? });
    }
    let folder = tempfile::tempdir()?;
    let file = folder.path().join("plate.json");
    std::fs::write(&file, PLATE_CASE)?;
    let plate = |skip: String| run(&file, &[skip, "output.plots=false".into()], &settings.plugin_paths, folder.path());
    scenes.push(Scene { name: PLATE, ways: in_turns(rounds, plate)? });
    Ok(page(&scenes, end, settings.quick))
}

/// Runs all ways in turns: `run` takes the override of what is skipped.
fn in_turns(rounds: usize, run: impl Fn(String) -> Result<Ran, BenchError>) -> Result<Vec<Measured>, BenchError> {
    let mut runs: [Vec<Ran>; WAYS.len()] = Default::default();
    for _ in 0..rounds {
        for ((_, skip, _), runs) in WAYS.iter().zip(&mut runs) {
            runs.push(run(format!("skip={skip}"))?);
        }
    }
    let seconds: Vec<Vec<f64>> = runs.iter().map(|runs| runs.iter().map(|ran| ran.seconds).collect()).collect();
    let measured = runs.into_iter().zip(&seconds).filter_map(|(mut runs, own)| {
        let ratios = own.iter().zip(&seconds[0]).map(|(own, first)| own / first);
        Some(Measured { seconds: median(own.clone()), over_first: median(ratios.collect()), ran: runs.pop()? })
    });
    Ok(measured.collect())
}

const METHOD: &str = "\
The bent fibre of chapter 7 at 45° (`cases/chapter-7/inclined-fibre.json`) pulled by {end} mm out of the usual block and of blocks of 4 and 16 times
its area, and the quarter of a plate in plastic flow of `cases/benchmark/plate-with-hole.json`, which has no contact. Times are those of
the processor, medians of turns that alternate, over that of the same scene with everything skipped. *Differs by*: load at the end and
work, the greater of both in all scenes, from those with everything skipped. In the data *per iteration* compares ways whose increments differ in number.";

fn page(scenes: &[Scene], end: f64, quick: bool) -> Page {
    let mut data = Table::new([
        "scene",
        "skipped",
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
    let mut fields =
        Table::new(["scene", "freedoms", "CPU [s]", "over the usual", "increments", "iterations", "nothing skipped"]);
    let mut failed = Vec::new();
    for Scene { name: scene, ways } in scenes {
        let [first, .., none] = ways.as_slice() else { continue };
        for ((way, ..), Measured { seconds, over_first, ran }) in WAYS.iter().zip(ways) {
            let count = |name: &str| ran.findings.statistics.get(name).copied().unwrap_or(0);
            let [_, load, work] = ran.end;
            let iterations = |ran: &Ran| ran.statistics.iterations as f64;
            data.push([
                (*scene).into(),
                (*way).into(),
                ran.freedoms.into(),
                (*seconds).into(),
                (*over_first).into(),
                ran.statistics.increments.into(),
                ran.statistics.iterations.into(),
                (over_first * iterations(&first.ran) / iterations(ran)).into(),
                load.into(),
                work.into(),
                count("umat_calls").into(),
                count("factorisations").into(),
            ]);
            if difference(ran, &first.ran) > SAME {
                failed.push(format!("{scene}: with {way} skipped the answer is another one"));
            }
        }
        fields.push([
            (*scene).into(),
            first.ran.freedoms.into(),
            first.seconds.into(),
            (*scene != PLATE).then_some(first.seconds / scenes[0].ways[0].seconds).into(),
            first.ran.statistics.increments.into(),
            first.ran.statistics.iterations.into(),
            none.over_first.into(),
        ]);
    }
    let [usual, four, sixteen] = BLOCKS.map(|(name, ..)| name);
    let mut items = Table::new(["skipped", usual, four, sixteen, PLATE, "differs by"]);
    let mut notes = Vec::new();
    for (k, (way, ..)) in WAYS.iter().enumerate() {
        let [a, b, c, d] = std::array::from_fn(|scene| scenes[scene].ways[k].over_first);
        let differs = scenes.iter().map(|scene| difference(&scene.ways[k].ran, &scene.ways[0].ran)).fold(0.0, f64::max);
        items.push([(*way).into(), a.into(), b.into(), c.into(), d.into(), differs.into()]);
        if !quick && k > 0 && [a, b, c, d].iter().all(|ratio| *ratio < WORTH) {
            notes.push(format!("With {way} skipped no scene takes 5 % longer: **that item is not worth its code**."));
        }
    }
    if !quick {
        let none = scenes[0].ways[WAYS.len() - 1].over_first;
        notes.push(target("Skipping saves a factor of", none, SKIPPING_TARGET, true));
        for (scene, (name, _, most)) in scenes.iter().zip(BLOCKS).skip(1) {
            let what = format!("A block of {name} the area costs a factor of");
            notes.push(target(&what, scene.ways[0].seconds / scenes[0].ways[0].seconds, most, false));
        }
    }
    Page {
        title: "Skipping what a scene does not need",
        method: METHOD.replace("{end}", &end.to_string()),
        data,
        summaries: vec![("Time over that with everything skipped".into(), items), ("Scenes".into(), fields)],
        notes,
        figures: vec![figure(scenes)],
        failed: (!failed.is_empty()).then(|| failed.join("; ")),
    }
}

/// The greater of the relative differences of load and work.
fn difference(ran: &Ran, other: &Ran) -> f64 {
    let relative = |k: usize| (ran.end[k] / other.end[k] - 1.0).abs();
    relative(1).max(relative(2))
}

fn target(what: &str, ratio: f64, limit: f64, at_least: bool) -> String {
    let reached = if at_least { ratio >= limit } else { ratio <= limit };
    let (word, side) = (if reached { "reached" } else { "**missed**" }, if at_least { "at least" } else { "at most" });
    format!("{what} {}; {side} {} is wanted: {word}.", significant(ratio, 3), significant(limit, 2))
}

fn figure(scenes: &[Scene]) -> Figure {
    let names = WAYS.iter().map(|(.., not_skipped)| (*not_skipped).to_owned());
    let line = |(number, scene): (usize, &Scene)| {
        let points = scene.ways.iter().enumerate().map(|(k, measured)| (k as f64, measured.over_first)).collect();
        Line { marked: true, ..Line::numbered(scene.name, points, number) }
    };
    Figure {
        name: "items".into(),
        title: "Time if this is not skipped, over that with everything skipped".into(),
        x: Quantity { name: String::new(), unit: String::new() },
        y: Quantity { name: "time ratio".into(), unit: String::new() },
        lines: scenes.iter().enumerate().map(line).collect(),
        marks: Vec::new(),
        scale: Scale::Names(names.collect()),
        key: None,
        equal_units: false,
    }
}
