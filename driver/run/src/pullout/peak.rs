//! The state at the greatest load.

use super::SavedState;
use fe_core::output::Fields;
use fe_core::stepping::{Record, Snapshot};
use serde::{Deserialize, Serialize};

/// The increment with the greatest load so far.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct PeakLoad {
    /// Load, N: the greatest in magnitude, with its sign.
    pub load: f64,
    /// Slip there, mm.
    pub slip: f64,
    /// Step, from 1.
    pub step: u32,
    /// Increment, from 1.
    pub increment: u32,
    /// Total time, s.
    pub time: f64,
}

/// Keeps the greatest load, with displacements and released elements at that load, and the fields if pictures are
/// wanted.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
pub struct PeakKeeper {
    /// The greatest load; `None`: there was none.
    pub(super) peak: Option<PeakLoad>,
    displacements: Vec<f64>,
    spalled: Vec<usize>,
    fields: Option<Fields>,
}

impl PeakKeeper {
    /// Takes an increment into account; the first of equal ones is the peak.
    pub fn observe(&mut self, record: &Record, snapshot: &Snapshot<'_>, keeps_fields: bool) {
        if self.rises(record) {
            self.displacements.clear();
            self.displacements.extend_from_slice(snapshot.displacements());
            self.spalled = snapshot.solids().spalled();
            self.fields = keeps_fields.then(|| Fields::of(snapshot));
        }
    }

    /// Returns whether the load is greater than ever; then it is the peak from now on.
    fn rises(&mut self, record: &Record) -> bool {
        let greatest = self.peak.map_or(0.0, |peak| peak.load.abs());
        // before the first step there is no load but rounding
        let rises = record.step > 0 && record.load.abs() > greatest;
        if rises {
            let &Record { load, slip, step, increment, time, .. } = record;
            self.peak = Some(PeakLoad { load, slip, step, increment, time });
        }
        rises
    }

    /// The displacements there, and the elements that had been released.
    pub fn shape(&self) -> Option<(&[f64], &[usize])> {
        self.peak.is_some().then_some((&self.displacements, &self.spalled))
    }

    /// The state there.
    pub fn into_state(self) -> Option<SavedState> {
        let PeakLoad { load, slip, .. } = self.peak?;
        Some(SavedState { slip, load, fields: self.fields? })
    }
}

#[cfg(test)]
mod test;
