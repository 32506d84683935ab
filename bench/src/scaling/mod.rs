//! Cost of a specimen against its number of unknowns, from a thousand to two hundred thousand.

mod memory;
mod page;

use super::fibre::Specimen;
use super::page::Page;
use super::runs::{Ran, run};
use super::timing::median;
use super::{BenchError, Settings};

/// The plate with a hole, as in the comparison with CalculiX.
const PLATE: &str = include_str!("../../../cases/benchmark/plate-with-hole.json");
/// Number of elements.
const CELLS: [usize; 6] = [170, 500, 1_600, 5_000, 16_000, 33_500];
/// Factors on all sizes of the bent fibre's mesh.
const FIBRE_MESHES: [f64; 6] = [2.0, 1.0, 0.5, 0.25, 0.125, 0.063];
/// Displacement of the grip, mm, and number of increments; few, since the cost per increment is measured.
const PULLED: f64 = 5e-4;
const INCREMENTS: usize = 4;
/// Number of turns of each size.
const ROUNDS: usize = 3;
/// Sizes and rounds if quick.
const QUICK: (usize, usize) = (2, 1);
/// Shortest measured time of a turn, s; shorter runs are repeated.
const TURN: f64 = 0.2;
const MOST_REPEATS: usize = 10;

/// Specimen that is refined.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Family {
    Plate,
    Fibre,
}

impl Family {
    const ALL: [Self; 2] = [Self::Plate, Self::Fibre];

    /// Returns the name in tables and pictures.
    fn name(self) -> &'static str {
        match self {
            Self::Plate => "plate with a hole",
            Self::Fibre => "45° fibre",
        }
    }

    /// A size as an override of the case.
    fn setting(self, k: usize) -> String {
        match self {
            Self::Plate => format!("mesh.specimen.cells={}", CELLS[k]),
            Self::Fibre => format!("mesh.specimen.mesh_size={}", FIBRE_MESHES[k]),
        }
    }
}

/// Runs of a size.
struct Measured {
    family: Family,
    /// Setting of the case.
    setting: String,
    /// Median of the processors' time, s.
    seconds: f64,
    ran: Ran,
    /// MB, of the whole process.
    peak_memory: Option<f64>,
}

/// All sizes of both families.
pub(super) fn measure(settings: &Settings) -> Result<Page, BenchError> {
    let folder = tempfile::tempdir()?;
    let plate = folder.path().join("plate.json");
    std::fs::write(&plate, PLATE)?;
    let fibre = Specimen::new(settings, PULLED)?;
    let run_once = |family: Family, setting: String| match family {
        Family::Plate => {
            let set = [setting, "output.plots=false".into(), "output.vtu=false".into()];
            let ran = run(&plate, &set, &settings.plugin_paths, folder.path())?;
            match ran.stopped {
                Some(message) => Err(BenchError::Failed(format!("{}: {message}", set.join(" ")))),
                None => Ok(ran),
            }
        }
        Family::Fibre => fibre.run(PULLED, &[setting, format!("steps.0.increments={INCREMENTS}")]),
    };
    let (count, rounds) = if settings.quick { QUICK } else { (CELLS.len(), ROUNDS) };
    // by size: what the process held for another one before is then no more than it needs now
    let mut jobs: Vec<Job> = Vec::new();
    for k in 0..count {
        jobs.extend(Family::ALL.map(|family| Job::new(family, k)));
    }
    for round in 0..rounds {
        for job in &mut jobs {
            let family = job.family;
            job.turn(round, |setting| run_once(family, setting))?;
        }
    }
    let measured: Vec<Measured> = jobs.into_iter().filter_map(Job::measured).collect();
    Ok(page::page(&measured, settings.quick))
}

/// Problem size of a family, with its timings.
struct Job {
    family: Family,
    setting: String,
    seconds: Vec<f64>,
    /// The fastest run by the clock: its breakdown is disturbed the least.
    best: Option<Ran>,
    peak_memory: Option<f64>,
}

impl Job {
    fn new(family: Family, k: usize) -> Self {
        Self { family, setting: family.setting(k), seconds: Vec::new(), best: None, peak_memory: None }
    }

    fn turn(&mut self, round: usize, run: impl Fn(String) -> Result<Ran, BenchError>) -> Result<(), BenchError> {
        memory::forget_peak();
        let mut turn = Vec::new();
        loop {
            let ran = run(self.setting.clone())?;
            turn.push(ran.seconds);
            if self.best.as_ref().is_none_or(|best| clock(&ran) < clock(best)) {
                self.best = Some(ran);
            }
            if turn.len() >= MOST_REPEATS || turn.iter().sum::<f64>() > TURN {
                break;
            }
        }
        self.seconds.push(median(turn));
        if round == 0 {
            self.peak_memory = memory::peak();
        }
        Ok(())
    }

    fn measured(self) -> Option<Measured> {
        let Self { family, setting, seconds, best, peak_memory } = self;
        Some(Measured { family, setting, seconds: median(seconds), ran: best?, peak_memory })
    }
}

/// Time by the clock, s.
fn clock(ran: &Ran) -> f64 {
    ["set_up", "analysis"].iter().filter_map(|name| ran.findings.times.get(*name)).sum()
}
