//! Curves of the case with trial laws, several at a time.

use super::geometry::SlipAt;
use super::law::BondLaw;
use super::specimen::Specimen;
use pullout_case::{Case, CaseErrors};
use pullout_run::PLUGIN_STACK;
use pullout_run::columns::place_in_specimen;
use pullout_run::path::{Observer, Row, Statistics, Stop};
use pullout_run::pullout;
use pullout_run::pullout::checkpoint::Checkpoints;
use std::io;
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::{Mutex, PoisonError};
use umat_abi::metadata::flags;

/// A computed load–slip curve.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct SimulatedCurve {
    /// Slips where the curve's were measured, mm, rising: where the fibre snaps back, a test sees a drop.
    pub slips: Vec<f64>,
    /// Loads, N.
    pub loads: Vec<f64>,
    /// Reason why it ended early.
    pub failure: Option<String>,
}

impl SimulatedCurve {
    /// The load at a slip by linear interpolation; 0 before the first, that of the end beyond it.
    pub fn load_at(&self, slip: f64) -> f64 {
        let right = self.slips.partition_point(|&x| x < slip);
        if right == 0 {
            return self.loads.first().copied().unwrap_or(0.0);
        }
        let Some(&end) = self.slips.get(right) else { return self.loads[right - 1] };
        let part = (slip - self.slips[right - 1]) / (end - self.slips[right - 1]);
        self.loads[right - 1] + part * (self.loads[right] - self.loads[right - 1])
    }
}

/// Computes curves.
#[derive(Clone, Debug)]
pub struct Simulator {
    specimen: Specimen,
    slip_at: SlipAt,
    plugin_paths: Vec<PathBuf>,
    threads: usize,
}

impl Simulator {
    /// Makes a simulator of a specimen; reads its case once, with a law.
    ///
    /// # Errors
    /// Problems with the case.
    pub fn new(
        specimen: Specimen,
        slip_at: SlipAt,
        plugin_paths: &[PathBuf],
        law: &BondLaw,
    ) -> Result<Self, CaseErrors> {
        let case = pullout_case::read_document(specimen.computed(law), &specimen.file, plugin_paths)?;
        let is_shared = match &case {
            Case::Pullout(program) => program
                .laws()
                .iter()
                .all(|(_, law)| law.law.as_ref().is_some_and(|law| law.flags & flags::THREAD_SAFE != 0)),
            Case::Path(_) | Case::Bridging(_) => false,
        };
        let threads = if is_shared { std::thread::available_parallelism().map_or(1, usize::from) } else { 1 };
        Ok(Self { specimen, slip_at, plugin_paths: plugin_paths.to_vec(), threads })
    }

    /// The case.
    pub fn specimen(&self) -> &Specimen {
        &self.specimen
    }

    /// The curve with a law; `None` if the law cannot be.
    pub fn curve(&self, law: &BondLaw) -> Option<SimulatedCurve> {
        let read = pullout_case::read_document(self.specimen.computed(law), &self.specimen.file, &self.plugin_paths);
        let Ok(Case::Pullout(program)) = read else { return None };
        let mut recorder = CurveRecorder::new(self.slip_at);
        let outcome = pullout::run(&program, Path::new(""), &Checkpoints::default(), &mut recorder);
        let failure = match outcome.result {
            Ok(()) => None,
            Err(Stop::Failed(failure)) => Some(failure.message),
            Err(Stop::Write(error)) => Some(error.to_string()),
        };
        Some(SimulatedCurve { failure, ..recorder.curve })
    }

    /// The curves with several laws, on all cores if the plugins allow it.
    pub fn curves(&self, laws: &[BondLaw]) -> Vec<Option<SimulatedCurve>> {
        let next = AtomicUsize::new(0);
        let curves = Mutex::new(vec![None; laws.len()]);
        let work = || {
            while let Some((k, law)) = Some(next.fetch_add(1, Ordering::Relaxed)).and_then(|k| Some((k, laws.get(k)?)))
            {
                let curve = self.curve(law);
                curves.lock().unwrap_or_else(PoisonError::into_inner)[k] = curve;
            }
        };
        std::thread::scope(|scope| {
            // this thread works as well: it is there even if no other can be started
            for _ in 1..self.threads.min(laws.len()) {
                let _ = std::thread::Builder::new().stack_size(PLUGIN_STACK).spawn_scoped(scope, work);
            }
            work();
        });
        curves.into_inner().unwrap_or_else(PoisonError::into_inner)
    }
}

/// Keeps slip and load of each increment.
struct CurveRecorder {
    curve: SimulatedCurve,
    /// Their places in a row.
    places: [usize; 2],
}

impl CurveRecorder {
    fn new(slip_at: SlipAt) -> Self {
        let place = |name: &str| place_in_specimen(name).unwrap_or_default();
        Self { curve: SimulatedCurve::default(), places: [place(slip_at.column()), place("load")] }
    }
}

impl Observer for CurveRecorder {
    fn row(&mut self, row: Row<'_>) -> io::Result<()> {
        let [slip, load] = self.places.map(|place| row.values[place]);
        if self.curve.slips.last().is_none_or(|&last| slip > last) {
            self.curve.slips.push(slip);
            self.curve.loads.push(load);
        }
        Ok(())
    }

    fn increment_done(&mut self, _row: Row<'_>, _so_far: Statistics) {}
}
