//! One run by one thread and by several: time by the clock, and whether every row has the same bits.

use super::page::Page;
use super::runs::read;
use super::table::Table;
use super::timing::{median, process_time};
use super::{BenchError, Settings};
use fe_core::threads::Threads;
use pullout_run::in_threads;
use pullout_run::number::significant;
use pullout_run::path::{self, Statistics, Stop};
use pullout_run::pullout::checkpoint::Checkpoints;
use pullout_run::pullout::{self, PulloutProgram};
use std::collections::BTreeSet;
use std::num::NonZeroUsize;
use std::path::Path;
use std::time::Instant;

/// Target speed-up of two threads over one on the plate.
const TARGET: f64 = 1.6;
const ROUNDS: usize = 5;

/// A specimen, its case, what is overridden, and what instead to see only whether it works.
struct Scene {
    name: &'static str,
    case: &'static str,
    set: &'static [&'static str],
    quick: &'static str,
}

const PLATE: &str = "plate with a hole";

const SCENES: [Scene; 2] = [
    Scene {
        name: PLATE,
        case: include_str!("../../cases/benchmark/plate-with-hole.json"),
        set: &["mesh.specimen.cells=20000", "output.plots=false", "output.vtu=false"],
        quick: "mesh.specimen.cells=2000",
    },
    Scene {
        name: "45° fibre",
        case: include_str!("../../cases/chapter-7/inclined-fibre.json"),
        set: &["steps.0.slip=0.05", "output.plots=false", "output.vtu=false"],
        quick: "steps.0.slip=0.002",
    },
];

/// A run.
struct Ran {
    clock: f64,
    processors: f64,
    rows: Rows,
}

/// All numbers of all rows.
#[derive(Default, PartialEq)]
struct Rows(Vec<u64>);

impl path::Observer for Rows {
    fn row(&mut self, row: path::Row<'_>) -> std::io::Result<()> {
        self.0.extend(row.values.iter().map(|value| value.to_bits()));
        Ok(())
    }

    fn increment_done(&mut self, _row: path::Row<'_>, _so_far: Statistics) {}
}

/// Measures both specimens by one, two and all threads, in turns.
pub(super) fn measure(settings: &Settings) -> Result<Page, BenchError> {
    let folder = tempfile::tempdir()?;
    let all = std::thread::available_parallelism().map_or(1, NonZeroUsize::get);
    let counts: BTreeSet<usize> = BTreeSet::from([1, 2, all]);
    let rounds = if settings.quick { 1 } else { ROUNDS };
    let mut data = Table::new(["specimen", "freedoms", "threads", "clock_s", "processors_s", "speedup", "same_bits"]);
    let (mut notes, mut different) = (Vec::new(), Vec::new());
    for scene in &SCENES {
        let file = folder.path().join("case.json");
        std::fs::write(&file, scene.case)?;
        let mut set: Vec<String> = scene.set.iter().map(ToString::to_string).collect();
        set.extend(settings.quick.then(|| scene.quick.to_owned()));
        let program = read(&file, &set, &settings.plugin_paths)?;
        let mut runs: Vec<Vec<Ran>> = counts.iter().map(|_| Vec::new()).collect();
        for _ in 0..rounds {
            for (runs, &threads) in runs.iter_mut().zip(&counts) {
                runs.push(run(scene, &program, threads, folder.path())?);
            }
        }
        let one = &runs[0];
        for (runs, &threads) in runs.iter().zip(&counts) {
            let of = |value: fn(&Ran) -> f64| median(runs.iter().map(value).collect());
            let speedup = median(one.iter().zip(runs).map(|(one, run)| one.clock / run.clock).collect());
            let is_same = runs.iter().all(|run| run.rows == one[0].rows);
            data.push([
                scene.name.into(),
                (2 * program.model.mesh.nodes().len()).into(),
                threads.into(),
                of(|run| run.clock).into(),
                of(|run| run.processors).into(),
                speedup.into(),
                if is_same { "yes" } else { "no" }.into(),
            ]);
            if !is_same {
                different.push(format!("{} by {threads} threads: other bits than by one", scene.name));
            }
            if !settings.quick && threads == 2 && scene.name == PLATE {
                let word = if speedup >= TARGET { "reached" } else { "**missed**" };
                let speedup = significant(speedup, 3);
                notes.push(format!("{PLATE}: two threads are {speedup} times as fast; {TARGET} are wanted: {word}."));
            }
        }
    }
    Ok(Page {
        title: "Threads",
        method: METHOD.into(),
        summaries: vec![(String::new(), data.clone())],
        data,
        notes,
        figures: Vec::new(),
        failed: (!different.is_empty()).then(|| different.join("; ")),
    })
}

const METHOD: &str = "\
One analysis shared among threads (`pullout run --threads`): blocks of elements, the matrix, the parts of its factor. *clock*: from the model to the last row, the
median of turns; *processors*: of all threads together; *speedup*: the median over the turns of the time by one thread over that by so many; *same bits*: every number
of every row is that of one thread.";

/// Runs a scene on a thread of its own, which can be one of those that share the work.
fn run(scene: &Scene, program: &PulloutProgram, threads: usize, folder: &Path) -> Result<Ran, BenchError> {
    let failed = |message: String| BenchError::Failed(format!("{}: {message}", scene.name));
    let count = NonZeroUsize::new(threads).unwrap_or(NonZeroUsize::MIN);
    let work = || {
        let threads = Threads::new(count).map_err(|error| failed(error.to_string()))?;
        let checkpoints = Checkpoints::default();
        let settings =
            pullout::SpecimenSettings { threads, ..pullout::SpecimenSettings::new(program, folder, &checkpoints) };
        let mut rows = Rows::default();
        let (start, processors) = (Instant::now(), process_time());
        let outcome = pullout::run(program, &settings, &mut rows);
        let (clock, processors) = (start.elapsed().as_secs_f64(), (process_time() - processors).as_secs_f64());
        match outcome.result {
            Ok(()) => Ok(Ran { clock, processors, rows }),
            Err(Stop::Failed(failure)) => Err(failed(failure.message)),
            Err(Stop::Write(error)) => Err(error.into()),
        }
    };
    in_threads([work]).remove(0)?.unwrap_or_else(|_| Err(failed("a run panicked".into())))
}
