//! Benefit of skipping: CPU time with everything skipped, nothing skipped, and each item off or on alone.
//!
//! `cargo bench -p driver --bench skipping`; words behind `--` keep the cases whose file names have one of them. The
//! share is what an item alone saves of the time without any. Load curves are compared with that of nothing skipped: the
//! greatest distance of a point of one from the other, loads and slips as parts of their greatest. Automatic increments
//! may end at other slips; the distance then has the chords of the curve in it.

use end_to_end_tests::{CpuClock, workspace};
use fe_core::model::{Model, Skipping};
use fe_core::stepping::{Analysis, Directive, Observer, Record, Snapshot};
use pullout_case::Case;
use std::io;

/// Case files and what is overridden.
const CASES: [(&str, &[&str]); 2] =
    [("cases/benchmark/plate-with-hole.json", &[]), ("cases/chapter-6/6.14-plane.json", &["steps.0.slip=0.1"])];

/// An item: its name, and how it is set.
type Item = (&'static str, fn(&mut Skipping, bool));

const ITEMS: [Item; 4] = [
    ("unchanged elements", |skipping, on| skipping.unchanged_elements = on),
    ("elastic far field", |skipping, on| skipping.elastic_far_field = on),
    ("factor reuse", |skipping, on| skipping.factor_reuse = on),
    ("contact search", |skipping, on| skipping.contact_search = on),
];

/// Slip and load after each increment.
#[derive(Default)]
struct Curve(Vec<[f64; 2]>);

impl Observer for Curve {
    fn increment(&mut self, record: &Record, _: &Snapshot<'_>) -> io::Result<Directive> {
        self.0.push([record.slip, record.load]);
        Ok(Directive::GoOn)
    }
}

impl Curve {
    /// Slips and loads as parts of these.
    fn relative_to(mut self, [slip, load]: [f64; 2]) -> Self {
        self.0.iter_mut().for_each(|[x, y]| (*x, *y) = (*x / slip, *y / load));
        self
    }

    /// The greatest slip and load.
    fn extent(&self) -> [f64; 2] {
        [0, 1].map(|k| self.0.iter().map(|point| point[k].abs()).fold(f64::MIN_POSITIVE, f64::max))
    }

    /// The greatest distance of a point of one curve from the other.
    fn distance(&self, other: &Self) -> f64 {
        self.farthest_from(other).max(other.farthest_from(self))
    }

    fn farthest_from(&self, other: &Self) -> f64 {
        let nearest = |&point: &[f64; 2]| {
            other.0.windows(2).map(|ends| distance_to_segment(point, ends[0], ends[1])).fold(f64::INFINITY, f64::min)
        };
        self.0.iter().map(nearest).fold(0.0, f64::max)
    }
}

fn distance_to_segment([x, y]: [f64; 2], [x1, y1]: [f64; 2], [x2, y2]: [f64; 2]) -> f64 {
    let (dx, dy) = (x2 - x1, y2 - y1);
    let length = dx * dx + dy * dy;
    let along = if length > 0.0 { (((x - x1) * dx + (y - y1) * dy) / length).clamp(0.0, 1.0) } else { 0.0 };
    (x - x1 - along * dx).hypot(y - y1 - along * dy)
}

/// A run's CPU time, iterations and curve.
struct Run {
    seconds: f64,
    iterations: u64,
    curve: Curve,
}

impl Run {
    /// Prepares a run with this skipped; `None` if it fails, which is printed.
    fn new(model: &Model, skipping: Skipping) -> Option<Self> {
        let model = Model { skipping, ..model.clone() };
        let clock = CpuClock::start();
        let mut curve = Curve::default();
        let mut analysis = match Analysis::new(&model) {
            Ok(analysis) => analysis,
            Err(error) => return failed(&error),
        };
        match analysis.run(&mut curve) {
            Ok(()) => Some(Self { seconds: clock.own(), iterations: analysis.statistics().iterations, curve }),
            Err(error) => failed(&error),
        }
    }
}

fn failed(error: &impl std::fmt::Display) -> Option<Run> {
    println!("    failed: {error}");
    None
}

/// All combinations that are measured, with nothing skipped first.
fn variants() -> Vec<(String, Skipping)> {
    let mut variants = vec![("nothing".to_owned(), Skipping::NONE), ("everything".to_owned(), Skipping::ALL)];
    for (name, set) in ITEMS {
        let mut skipping = Skipping::ALL;
        set(&mut skipping, false);
        variants.push((format!("all but {name}"), skipping));
    }
    for (name, set) in ITEMS {
        let mut skipping = Skipping::NONE;
        set(&mut skipping, true);
        variants.push((format!("only {name}"), skipping));
    }
    variants
}

fn measure(case: &str, overrides: &[&str]) {
    let overrides: Vec<String> = overrides.iter().map(|text| (*text).to_owned()).collect();
    let model = match pullout_case::read(&workspace(case), &overrides, &[]) {
        Ok(Case::Pullout(program)) => program.model,
        Ok(_) => panic!("{case} is of another kind"),
        Err(errors) => panic!("{errors}"),
    };
    println!("\n{case} {}: {} elements", overrides.join(" "), model.mesh.elements().len());
    println!(
        "  {:28} {:>9} {:>8} {:>8} {:>10} {:>11}",
        "skipped", "CPU s", "ratio", "saved", "iterations", "difference"
    );
    let mut nothing: Option<(f64, [f64; 2], Curve)> = None;
    for (name, skipping) in variants() {
        let Some(Run { seconds, iterations, curve }) = Run::new(&model, skipping) else {
            println!("  {name:28} {:>9}", "-");
            continue;
        };
        let (base, extent, reference) = nothing.get_or_insert_with(|| {
            let extent = curve.extent();
            (seconds, extent, Curve(curve.0.clone()).relative_to(extent))
        });
        let ratio = seconds / *base;
        let difference = curve.relative_to(*extent).distance(reference);
        println!(
            "  {name:28} {seconds:9.2} {ratio:8.3} {:7.1}% {iterations:10} {difference:11.1e}",
            100.0 * (1.0 - ratio)
        );
    }
}

fn main() {
    let words: Vec<String> = std::env::args().skip(1).filter(|word| !word.starts_with("--")).collect();
    for (case, overrides) in CASES {
        if words.is_empty() || words.iter().any(|word| case.contains(word)) {
            measure(case, overrides);
        }
    }
}
