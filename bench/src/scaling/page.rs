//! Times, their split, and the powers with which they grow.

use super::{Family, INCREMENTS, Measured, PULLED, ROUNDS};
use crate::page::Page;
use crate::slope::exponent;
use crate::table::{Cell, Table};
use pullout_report::plots::figure::{Figure, Line, Scale, Style};
use pullout_report::plots::quantity::Quantity;
use pullout_run::number::significant;

/// Parts that take less of the largest run have no exponent.
const LEAST_SHARE: f64 = 1e-3;
/// The greatest exponent that is wanted.
const TARGET: f64 = 1.3;

const METHOD: &str = "\
The plate with a hole (`cases/benchmark/plate-with-hole.json`: J2 plasticity, Q8R, 10 increments) and the bent fibre of chapter 7 at 45°
(`cases/chapter-7/inclined-fibre.json`, pulled by {pulled} mm in {increments} increments or more) with finer and finer meshes. Time is that of
the processor, from the model to the end, medians of {rounds} turns; that of an increment, an iteration is without the set-up. The parts are those that
the clock shows, as parts of the processor's time; *rest*: vectors, judgements, output. An exponent is the slope of a straight line through the logarithms, by
least squares over all sizes, and between the last two. Memory is the greatest that the process held while the size was run.";

/// Equations, patterns, orderings and the far field, once before the first increment.
const SET_UP: &str = "set_up";
/// The parts of the time: their names, and what they are called among the findings.
const PARTS: [(&str, &str); 6] = [
    ("set-up", SET_UP),
    ("solids", "analysis_solids"),
    ("contact", "analysis_contact"),
    ("assembly", "analysis_assembly"),
    ("factorisation", "analysis_factorisation"),
    ("solution", "analysis_solution"),
];

impl Measured {
    fn unknowns(&self) -> f64 {
        self.ran.freedoms as f64
    }

    fn per_increment(&self) -> f64 {
        (self.seconds - self.part(SET_UP)) / self.ran.statistics.increments as f64
    }

    fn per_iteration(&self) -> f64 {
        (self.seconds - self.part(SET_UP)) / self.ran.statistics.iterations as f64
    }

    fn factorisations(&self) -> u64 {
        self.ran.findings.statistics.get("factorisations").copied().unwrap_or(0)
    }

    /// Time of a part, s: the processor's, split as the clock splits it.
    fn part(&self, name: &str) -> f64 {
        let time = |name: &str| self.ran.findings.times.get(name).copied().unwrap_or(f64::NAN);
        self.seconds * time(name) / (time("set_up") + time("analysis"))
    }

    fn rest(&self) -> f64 {
        self.seconds - PARTS.iter().map(|(_, name)| self.part(name)).sum::<f64>()
    }
}

pub fn page(measured: &[Measured], quick: bool) -> Page {
    let mut notes = Vec::new();
    if !quick {
        for family in Family::ALL {
            notes.push(target(family, "the run", powers(measured, family, |size| size.seconds)[0]));
            notes.push(target(family, "an increment", powers(measured, family, Measured::per_increment)[0]));
            notes.push(target(family, "an iteration", powers(measured, family, Measured::per_iteration)[0]));
        }
    }
    let method = METHOD.replace("{pulled}", &PULLED.to_string()).replace("{increments}", &INCREMENTS.to_string());
    Page {
        title: "Cost against unknowns",
        method: method.replace("{rounds}", &ROUNDS.to_string()),
        data: data(measured),
        summaries: vec![
            ("Time".into(), times(measured)),
            ("Exponents".into(), exponents(measured)),
            ("Where the time goes".into(), split(measured)),
        ],
        notes,
        figures: vec![figure(measured)],
        failed: None,
    }
}

fn target(family: Family, per: &str, exponent: Option<f64>) -> String {
    let Some(exponent) = exponent else { return format!("{}: no exponent.", family.name()) };
    let word = if exponent <= TARGET { "reached" } else { "**missed**" };
    format!(
        "{}: the time of {per} grows with the power {}; at most {TARGET} is wanted: {word}.",
        family.name(),
        significant(exponent, 3)
    )
}

fn of(measured: &[Measured], family: Family) -> impl Iterator<Item = &Measured> {
    measured.iter().filter(move |measured| measured.family == family)
}

/// Exponents of something over all sizes, and over the last two.
fn powers(measured: &[Measured], family: Family, quantity: impl Fn(&Measured) -> f64) -> [Option<f64>; 2] {
    let points: Vec<(f64, f64)> = of(measured, family).map(|size| (size.unknowns(), quantity(size))).collect();
    [exponent(&points), exponent(&points[points.len().saturating_sub(2)..])]
}

fn data(measured: &[Measured]) -> Table {
    let mut table = Table::new([
        "specimen",
        "setting",
        "freedoms",
        "increments",
        "iterations",
        "factorisations",
        "cpu_s",
        "cpu_per_increment_s",
        "cpu_per_iteration_s",
        "set_up_s",
        "solids_s",
        "contact_s",
        "assembly_s",
        "factorisation_s",
        "solution_s",
        "rest_s",
        "peak_memory_MB",
    ]);
    for size in measured {
        let [set_up, solids, contact, assembly, factorisation, solution] =
            PARTS.map(|(_, name)| Cell::from(size.part(name)));
        table.push([
            size.family.name().into(),
            size.setting.as_str().into(),
            size.ran.freedoms.into(),
            size.ran.statistics.increments.into(),
            size.ran.statistics.iterations.into(),
            size.factorisations().into(),
            size.seconds.into(),
            size.per_increment().into(),
            size.per_iteration().into(),
            set_up,
            solids,
            contact,
            assembly,
            factorisation,
            solution,
            size.rest().into(),
            size.peak_memory.into(),
        ]);
    }
    table
}

fn times(measured: &[Measured]) -> Table {
    let mut table = Table::new([
        "specimen",
        "unknowns",
        "increments",
        "iterations",
        "factorisations",
        "CPU [s]",
        "per increment [s]",
        "per iteration [s]",
        "per factorisation [s]",
        "memory [MB]",
    ]);
    for size in measured {
        table.push([
            size.family.name().into(),
            size.ran.freedoms.into(),
            size.ran.statistics.increments.into(),
            size.ran.statistics.iterations.into(),
            size.factorisations().into(),
            size.seconds.into(),
            size.per_increment().into(),
            size.per_iteration().into(),
            (size.part("analysis_factorisation") / size.factorisations() as f64).into(),
            size.peak_memory.into(),
        ]);
    }
    table
}

fn exponents(measured: &[Measured]) -> Table {
    let mut table = Table::new(["specimen", "time", "all sizes", "last two", "share of the largest size [%]"]);
    for family in Family::ALL {
        let Some(largest) = of(measured, family).last() else { continue };
        let mut push = |name: &str, quantity: &dyn Fn(&Measured) -> f64, share: Cell| {
            let [all, last] = powers(measured, family, quantity).map(Cell::from);
            table.push([family.name().into(), name.into(), all, last, share]);
        };
        let share = |time: f64| Cell::from(100.0 * time / largest.seconds);
        push("the run", &|size| size.seconds, 100.0.into());
        let increments = |size: &Measured| size.seconds - size.part(SET_UP);
        push("an increment", &Measured::per_increment, share(increments(largest)));
        push("an iteration", &Measured::per_iteration, share(increments(largest)));
        for (part, name) in PARTS.into_iter().filter(|(_, name)| largest.part(name) > LEAST_SHARE * largest.seconds) {
            push(part, &|size| size.part(name), share(largest.part(name)));
        }
        push("rest", &Measured::rest, share(largest.rest()));
        let each = |size: &Measured| size.part("analysis_factorisation") / size.factorisations() as f64;
        push("a factorisation", &each, Cell::Absent("–"));
    }
    table
}

fn split(measured: &[Measured]) -> Table {
    let mut table = Table::new([
        "specimen",
        "unknowns",
        "set-up [%]",
        "solids [%]",
        "contact [%]",
        "assembly [%]",
        "factorisation [%]",
        "solution [%]",
        "rest [%]",
    ]);
    for size in measured {
        let share = |part: f64| Cell::from(100.0 * part / size.seconds);
        let [set_up, solids, contact, assembly, factorisation, solution] =
            PARTS.map(|(_, name)| share(size.part(name)));
        table.push([
            size.family.name().into(),
            size.ran.freedoms.into(),
            set_up,
            solids,
            contact,
            assembly,
            factorisation,
            solution,
            share(size.rest()),
        ]);
    }
    table
}

fn figure(measured: &[Measured]) -> Figure {
    let line = |(k, family): (usize, Family), dash: usize, per: &str, quantity: &dyn Fn(&Measured) -> f64| Line {
        label: format!("{}, {per}", family.name()),
        points: of(measured, family).map(|size| (size.unknowns(), quantity(size))).collect(),
        columns: ("freedoms".into(), format!("cpu_per_{per}_s")),
        style: Style { color: k, dash },
        marked: true,
    };
    let lines = Family::ALL.into_iter().enumerate().flat_map(|family| {
        [line(family, 0, "increment", &Measured::per_increment), line(family, 1, "iteration", &Measured::per_iteration)]
    });
    let mut lines: Vec<Line> = lines.collect();
    lines.extend(reference(measured));
    Figure {
        name: "unknowns".into(),
        title: format!("Time against unknowns; dots: the power {TARGET}"),
        x: Quantity { name: "unknowns".into(), unit: String::new() },
        y: Quantity { name: "CPU time".into(), unit: "s".into() },
        lines,
        marks: Vec::new(),
        scale: Scale::BothDecades,
        key: None,
        equal_units: false,
    }
}

/// The target's slope, from the plate's first size on.
fn reference(measured: &[Measured]) -> Option<Line> {
    let first = of(measured, Family::Plate).next()?;
    let ends = [first, of(measured, Family::Plate).last()?];
    let along =
        |size: &Measured| (size.unknowns(), first.per_increment() * (size.unknowns() / first.unknowns()).powf(TARGET));
    Some(Line {
        label: format!("power {TARGET}"),
        points: ends.map(along).into(),
        columns: ("freedoms".into(), "cpu_per_increment_s".into()),
        style: Style { color: 6, dash: 2 },
        marked: false,
    })
}
