//! The FE core beside CalculiX: same mesh, same law, same steps, one thread each, CPU time of either.
//!
//! `cargo bench -p driver --bench calculix`. Without `ccx` on PATH (Debian: `calculix-ccx`) our side is shown alone.
//! Words behind `--` keep the comparisons whose names have one of them. Cases: `cases/benchmark/`. CPU time is that of
//! the process or its child in the kernel's books, in ticks of 10 ms; both sides include reading or meshing, and write
//! nothing but the reaction.

mod deck;

use driver::case::Case;
use end_to_end_tests::{CpuClock, workspace};
use fe_core::model::Model;
use fe_core::stepping::{Analysis, Directive, Observer, Record, Snapshot, Statistics};
use std::io;
use std::path::Path;
use std::process::Command;

/// What the reactions of the plates may differ by.
const REACTION_TOLERANCE: f64 = 1e-3;
/// What our drag of the strip may differ by from the exact one, 15 N.
const DRAG_TOLERANCE: f64 = 5e-3;
/// μ p L of the strip, N.
const EXACT_DRAG: f64 = 15.0;
/// The share of CalculiX's CPU time that we aim to stay below.
const TARGET_SHARE: f64 = 0.2;

/// The last load that is reported.
#[derive(Default)]
struct LastLoad(f64);

impl Observer for LastLoad {
    fn increment(&mut self, record: &Record, _: &Snapshot<'_>) -> io::Result<Directive> {
        self.0 = record.load;
        Ok(Directive::GoOn)
    }
}

/// A side of a comparison.
struct Outcome {
    seconds: f64,
    reaction: f64,
    iterations: u64,
    /// What else there is to tell.
    remark: String,
}

impl Outcome {
    fn print(&self, side: &str) {
        let Self { seconds, reaction, iterations, remark } = self;
        println!("  {side:9} {seconds:8.2} s CPU  {iterations:4} iterations  reaction {reaction:.4} N  {remark}");
    }

    fn seconds_per_iteration(&self) -> f64 {
        self.seconds / self.iterations as f64
    }
}

/// What is compared.
struct Comparison {
    name: String,
    case: &'static str,
    overrides: Vec<String>,
    deck: fn(&Model) -> String,
    /// Component of the reaction.
    component: usize,
}

impl Comparison {
    fn plate(cells: usize, nlgeom: bool) -> Self {
        let strains = if nlgeom { "large displacements" } else { "small strains" };
        Self {
            name: format!("plate with a hole, J2, {strains}, {cells}"),
            case: "cases/benchmark/plate-with-hole.json",
            overrides: vec![format!("mesh.specimen.cells={cells}"), format!("nlgeom={nlgeom}")],
            deck: deck::plate,
            component: 1,
        }
    }

    fn strip() -> Self {
        Self {
            name: "drag-out strip, friction".to_owned(),
            case: "cases/benchmark/drag-out-strip.json",
            overrides: Vec::new(),
            deck: deck::strip,
            component: 0,
        }
    }

    /// Runs both sides; returns both reactions.
    fn run(&self) -> (f64, Option<f64>) {
        let (ours, model) = self.ours();
        println!("\n{}: {} elements, {} nodes", self.name, model.mesh.elements().len(), model.mesh.nodes().len());
        ours.print("ours");
        let Some(theirs) = calculix(&(self.deck)(&model), self.component) else {
            println!("  CalculiX  not installed");
            return (ours.reaction, None);
        };
        theirs.print("CalculiX");
        println!(
            "  share {:.3} in all, {:.3} per iteration (target {TARGET_SHARE}); reactions differ by {:.1e}",
            ours.seconds / theirs.seconds,
            ours.seconds_per_iteration() / theirs.seconds_per_iteration(),
            (ours.reaction / theirs.reaction - 1.0).abs()
        );
        (ours.reaction, Some(theirs.reaction))
    }

    fn ours(&self) -> (Outcome, Model) {
        let case = workspace(self.case);
        let clock = CpuClock::start();
        let model = read(&case, &self.overrides);
        let mut load = LastLoad::default();
        let mut analysis = Analysis::new(&model).unwrap_or_else(|error| panic!("{}: {error}", case.display()));
        analysis.run(&mut load).unwrap_or_else(|error| panic!("{}: {error}", case.display()));
        let statistics = analysis.statistics();
        drop(analysis);
        let outcome = Outcome {
            seconds: clock.own(),
            reaction: load.0,
            iterations: statistics.iterations,
            remark: in_words(&statistics),
        };
        (outcome, model)
    }
}

fn in_words(statistics: &Statistics) -> String {
    let Statistics { evaluations, factorisations, block_factorisations, solutions, settlements, cutbacks, .. } =
        statistics;
    format!(
        "({evaluations} evaluations, {factorisations} + {block_factorisations} factorisations, {solutions} solutions, \
         {settlements} settlements, {cutbacks} cutbacks)"
    )
}

fn read(case: &Path, overrides: &[String]) -> Model {
    match driver::case::read(case, overrides, &[]) {
        Ok(Case::Pullout(program)) => program.model,
        Ok(_) => panic!("{} is of another kind", case.display()),
        Err(errors) => panic!("{errors}"),
    }
}

/// Runs CalculiX on a deck; `None` without it.
fn calculix(deck: &str, component: usize) -> Option<Outcome> {
    let folder = tempfile::tempdir().expect("a temporary folder");
    std::fs::write(folder.path().join("job.inp"), deck).expect("the deck is written");
    let clock = CpuClock::start();
    let output = Command::new("ccx").arg("job").current_dir(folder.path()).env("OMP_NUM_THREADS", "1").output().ok()?;
    let seconds = clock.children();
    let log = String::from_utf8_lossy(&output.stdout);
    let text = std::fs::read_to_string(folder.path().join("job.dat")).unwrap_or_default();
    let totals = text.lines().skip_while(|line| !line.contains("total force")).filter_map(|line| {
        let numbers: Vec<f64> = line.split_whitespace().filter_map(|word| word.parse().ok()).collect();
        (numbers.len() == 3).then(|| numbers[component])
    });
    let Some(reaction) = totals.last().filter(|_| log.contains("Job finished")) else {
        panic!("CalculiX did not finish:\n{}", last_lines(&log));
    };
    let solver = log.lines().rfind(|line| line.contains("solver")).map_or("", str::trim);
    Some(Outcome { seconds, reaction, iterations: deck::iterations(folder.path()), remark: format!("({solver})") })
}

fn last_lines(log: &str) -> String {
    let lines: Vec<&str> = log.lines().collect();
    lines[lines.len().saturating_sub(15)..].join("\n")
}

/// Whether the words of the command line ask for a comparison; cargo adds `--bench`.
fn is_wanted(name: &str) -> bool {
    let mut words = std::env::args().skip(1).filter(|word| !word.starts_with("--")).peekable();
    words.peek().is_none() || words.any(|word| name.contains(&word))
}

fn main() {
    for cells in [5000, 20_000] {
        for plate in [Comparison::plate(cells, false), Comparison::plate(cells, true)] {
            if is_wanted(&plate.name)
                && let (ours, Some(theirs)) = plate.run()
            {
                let difference = (ours / theirs - 1.0).abs();
                assert!(difference < REACTION_TOLERANCE, "the reactions differ by {difference:.2e}");
            }
        }
    }
    let strip = Comparison::strip();
    if is_wanted(&strip.name) {
        let (ours, _) = strip.run();
        let error = (ours / EXACT_DRAG - 1.0).abs();
        println!("  our drag is {error:.1e} off the exact {EXACT_DRAG} N");
        assert!(error < DRAG_TOLERANCE, "the drag is {error:.2e} off");
    }
}
