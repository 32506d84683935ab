//! The FE core beside CalculiX: same mesh, same law, same steps, one thread each, CPU time of either.
//!
//! `cargo bench -p driver --bench calculix`. Without `ccx` on PATH (Debian: `calculix-ccx`) our side is shown alone. Cases:
//! `cases/benchmark/`. CPU time is that of the process or its child in the kernel's books, in ticks of 10 ms; both
//! sides include reading or meshing and writing nothing but the reaction.

mod clock;
mod deck;

use clock::CpuClock;
use driver::case::Case;
use end_to_end_tests::workspace;
use fe_core::model::Model;
use fe_core::stepping::{Analysis, Directive, Observer, Record, Snapshot, Statistics};
use std::io;
use std::path::Path;
use std::process::Command;

/// What the reactions may differ by.
const REACTION_TOLERANCE: f64 = 1e-3;
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

/// A side of the comparison.
struct Outcome {
    seconds: f64,
    reaction: f64,
    iterations: u64,
}

fn ours(case: &Path, overrides: &[String]) -> (Outcome, Statistics, Model) {
    let clock = CpuClock::start();
    let model = read(case, overrides);
    let mut load = LastLoad::default();
    let mut analysis = Analysis::new(&model).unwrap_or_else(|error| panic!("{}: {error}", case.display()));
    analysis.run(&mut load).unwrap_or_else(|error| panic!("{}: {error}", case.display()));
    let statistics = analysis.statistics();
    drop(analysis);
    (Outcome { seconds: clock.own(), reaction: load.0, iterations: statistics.iterations }, statistics, model)
}

fn read(case: &Path, overrides: &[String]) -> Model {
    match driver::case::read(case, overrides, &[]) {
        Ok(Case::Pullout(program)) => program.model,
        Ok(_) => panic!("{} is of another kind", case.display()),
        Err(errors) => panic!("{errors}"),
    }
}

/// Runs CalculiX on a deck; `None` without it.
fn calculix(deck: &str, reaction_component: usize) -> Option<Outcome> {
    let folder = tempfile::tempdir().expect("a temporary folder");
    std::fs::write(folder.path().join("job.inp"), deck).expect("the deck is written");
    let clock = CpuClock::start();
    let output = Command::new("ccx").arg("job").current_dir(folder.path()).env("OMP_NUM_THREADS", "1").output().ok()?;
    let seconds = clock.children();
    let log = String::from_utf8_lossy(&output.stdout);
    let text = std::fs::read_to_string(folder.path().join("job.dat")).unwrap_or_default();
    let totals = text.lines().skip_while(|line| !line.contains("total force")).filter_map(|line| {
        let numbers: Vec<f64> = line.split_whitespace().filter_map(|word| word.parse().ok()).collect();
        (numbers.len() == 3).then(|| numbers[reaction_component])
    });
    let Some(reaction) = totals.last() else {
        panic!("CalculiX did not finish:\n{}", log.lines().rev().take(15).collect::<Vec<_>>().join("\n"));
    };
    Some(Outcome { seconds, reaction, iterations: deck::iterations(folder.path()) })
}

fn compare(
    name: &str,
    case: &str,
    overrides: &[String],
    write: impl Fn(&Model) -> String,
    component: usize,
    factor: f64,
) {
    let (ours, statistics, model) = ours(&workspace(case), overrides);
    let (elements, nodes) = (model.mesh.elements().len(), model.mesh.nodes().len());
    println!("\n{name}: {elements} elements, {nodes} nodes");
    println!(
        "  ours      {:8.2} s CPU  {:4} iterations  reaction {:.4} N",
        ours.seconds, ours.iterations, ours.reaction
    );
    println!(
        "            {} factorisations, {} of contact alone, {} solutions",
        statistics.factorisations, statistics.block_factorisations, statistics.solutions
    );
    let Some(theirs) = calculix(&write(&model), component) else {
        println!("  CalculiX  not installed");
        return;
    };
    let reaction = factor * theirs.reaction;
    println!("  CalculiX  {:8.2} s CPU  {:4} iterations  reaction {reaction:.4} N", theirs.seconds, theirs.iterations);
    let difference = (ours.reaction / reaction - 1.0).abs();
    let per_iteration = (ours.seconds / ours.iterations as f64) / (theirs.seconds / theirs.iterations.max(1) as f64);
    let share = ours.seconds / theirs.seconds;
    println!(
        "  share {share:.3} in all, {per_iteration:.3} per iteration (target {TARGET_SHARE}); reactions differ by {difference:.1e}"
    );
    assert!(difference < REACTION_TOLERANCE || name.contains("strip"), "the reactions differ by {difference:.2e}");
}

fn main() {
    let nlgeom = |on: bool| format!("nlgeom={on}");
    for elements in [5000, 20_000] {
        for large in [false, true] {
            let overrides = [format!("mesh.specimen.elements={elements}"), nlgeom(large)];
            let name =
                format!("plate with a hole, J2, {}", if large { "large displacements" } else { "small strains" });
            compare(&name, "cases/benchmark/plate-with-hole.json", &overrides, deck::plate, 1, 1.0);
        }
    }
    compare("drag-out strip, friction", "cases/benchmark/drag-out-strip.json", &[], deck::strip, 0, 1.0);
}
