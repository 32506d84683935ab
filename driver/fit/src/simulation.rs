//! Curves of the case with trial laws, and how far they are from the measured one.

use super::curve::LoadSlipCurve;
use super::geometry::SlipAt;
use super::law::BondSlipLaw;
use super::search::{self, Increments, STEP, Simulation, root_mean_square};
use super::specimen::Specimen;
use nalgebra::{DMatrix, DVector};
use pullout_engine::{CaseSource, Outcome};
use serde::{Deserialize, Serialize};
use std::path::PathBuf;
use std::sync::Arc;

/// The step of differences of runs that are not led by another, most of whose coordinates are logarithms: their curves are smooth to
/// about 1e-4 of the peak.
const STEP_OF_FREE_RUNS: f64 = 0.02;

/// Weighting of the curve's rows.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, clap::ValueEnum)]
pub enum Weights {
    /// Rising and softening branch count the same, however many rows each has.
    Balanced,
    /// Every row counts the same.
    Equal,
}

impl Weights {
    /// Returns the weight of each row; their mean is 1.
    pub fn of(self, curve: &LoadSlipCurve) -> Vec<f64> {
        let peak = curve.peak().slip;
        let rises = |slip: f64| slip <= peak;
        let count = curve.slips.len() as f64;
        let rising = curve.slips.iter().filter(|&&slip| rises(slip)).count() as f64;
        let weight = |&slip: &f64| match self {
            Self::Equal => 1.0,
            Self::Balanced => 0.5 * count / if rises(slip) { rising } else { count - rising },
        };
        curve.slips.iter().map(weight).collect()
    }
}

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
    fn of(outcome: &Outcome, slip_at: SlipAt) -> Self {
        let column = |name: &str| outcome.history.column(name).unwrap_or_default();
        let failure = outcome.summary.message.clone().filter(|_| !outcome.is_done());
        let mut curve = Self { failure, ..Self::default() };
        for (&slip, &load) in column(slip_at.column()).iter().zip(column("load")) {
            if curve.slips.last().is_none_or(|&last| slip > last) {
                curve.slips.push(slip);
                curve.loads.push(load);
            }
        }
        curve
    }

    /// Reason why there is no more of it than a point.
    pub fn failure_at_once(&self) -> Option<&String> {
        self.failure.as_ref().filter(|_| self.slips.len() < 2)
    }

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

/// A law that was tried.
#[derive(Clone)]
pub struct TriedLaw {
    pub law: BondSlipLaw,
    pub curve: SimulatedCurve,
    increments: Option<Increments>,
}

/// Computes the curves of laws of one form.
pub struct Simulator<'c> {
    /// Case without its law.
    pub specimen: &'c Specimen,
    /// Place where the slip is measured.
    pub slip_at: SlipAt,
    /// Folders where plugins are looked for first.
    pub plugin_paths: &'c [PathBuf],
    /// A law of the form.
    pub form: &'c BondSlipLaw,
    /// The measured curve.
    pub curve: &'c LoadSlipCurve,
    /// Weights of its rows.
    pub weights: &'c [f64],
}

impl Simulator<'_> {
    fn tried(&self, coordinates: &[f64], on: Option<&Increments>) -> Result<TriedLaw, String> {
        let law = self.form.at(coordinates);
        let source = CaseSource {
            document: Some(self.specimen.computed(&law)),
            plugin_paths: self.plugin_paths.to_vec(),
            ..CaseSource::file(&self.specimen.file)
        };
        let (outcome, increments) = search::outcome(source, on, &Arc::default())?;
        Ok(TriedLaw { law, curve: SimulatedCurve::of(&outcome, self.slip_at), increments })
    }

    /// Computed less measured loads, as parts of the measured peak.
    pub fn off(&self, computed: &SimulatedCurve) -> DVector<f64> {
        let peak = self.curve.peak().load;
        let rows = self.curve.slips.iter().zip(&self.curve.loads);
        let differences = rows.map(|(&slip, load)| (computed.load_at(slip) - load) / peak);
        DVector::from_iterator(self.curve.slips.len(), differences)
    }

    /// The derivatives of [`Self::off`] by the law's coordinates.
    ///
    /// # Errors
    /// A law with a changed coordinate gives no curve.
    pub fn slopes(&self, coordinates: &[f64], tried: &TriedLaw) -> Result<DMatrix<f64>, String> {
        let increments = tried.increments.as_ref();
        let step = if increments.is_some() { STEP } else { STEP_OF_FREE_RUNS };
        let run = |coordinates: &[f64], on: Option<&Increments>| Ok(self.off(&self.tried(coordinates, on)?.curve));
        search::derivatives(coordinates, &self.off(&tried.curve), increments, |_| step, run)
    }
}

impl Simulation for Simulator<'_> {
    type Run = TriedLaw;

    fn run(&self, coordinates: &[f64]) -> Result<TriedLaw, String> {
        self.tried(coordinates, None)
    }

    fn differences(&self, tried: &TriedLaw) -> DVector<f64> {
        let mut differences = self.off(&tried.curve);
        differences.iter_mut().zip(self.weights).for_each(|(difference, weight)| *difference *= weight.sqrt());
        differences
    }

    fn derivatives(&self, coordinates: &[f64], tried: &TriedLaw) -> Result<DMatrix<f64>, String> {
        let mut slopes = self.slopes(coordinates, tried)?;
        slopes.row_iter_mut().zip(self.weights).for_each(|(mut row, weight)| row *= weight.sqrt());
        Ok(slopes)
    }

    fn rms(&self, tried: &TriedLaw) -> f64 {
        root_mean_square(&self.off(&tried.curve))
    }
}
