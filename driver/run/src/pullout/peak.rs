//! The state at the greatest load.

use super::State;
use fe_core::mesh::Mesh;
use fe_core::output::{Activity, ContactPoint, Fields};
use fe_core::stepping::{Record, Snapshot};
use serde::{Deserialize, Serialize};
use std::borrow::Cow;

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

/// Keeps the greatest load with the displacements and the released elements there, and the fields if pictures are wanted.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
pub struct PeakKeeper {
    /// The greatest load; `None`: there was none.
    pub(super) peak: Option<PeakLoad>,
    displacements: Vec<f64>,
    spalled: Vec<usize>,
    fields: Option<KeptFields>,
}

/// Fields without their mesh.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub(super) struct KeptFields {
    time: f64,
    displacements: Vec<f64>,
    reactions: Vec<f64>,
    stresses: Vec<[f64; 4]>,
    strains: Vec<[f64; 4]>,
    states: Vec<f64>,
    state_names: Vec<Vec<String>>,
    pairs: Vec<String>,
    contact: Vec<ContactPoint>,
    activities: Vec<Activity>,
    behind: Vec<usize>,
}

impl KeptFields {
    pub(super) fn of(fields: Fields<'_>) -> Self {
        Self {
            displacements: fields.displacements.into_owned(),
            time: fields.time,
            reactions: fields.reactions,
            stresses: fields.stresses,
            strains: fields.strains,
            states: fields.states,
            state_names: fields.state_names,
            pairs: fields.pairs,
            contact: fields.contact,
            activities: fields.activities,
            behind: fields.behind,
        }
    }

    pub(super) fn on(self, mesh: &Mesh) -> Fields<'_> {
        Fields {
            mesh,
            displacements: Cow::Owned(self.displacements),
            time: self.time,
            reactions: self.reactions,
            stresses: self.stresses,
            strains: self.strains,
            states: self.states,
            state_names: self.state_names,
            pairs: self.pairs,
            contact: self.contact,
            activities: self.activities,
            behind: self.behind,
        }
    }
}

impl PeakKeeper {
    /// Returns whether a run on this mesh can have come to it.
    pub fn fits(&self, mesh: &Mesh) -> bool {
        let count = if self.peak.is_some() { 2 * mesh.nodes().len() } else { 0 };
        self.peak.is_none_or(|peak| [peak.load, peak.slip, peak.time].into_iter().all(f64::is_finite))
            && self.displacements.len() == count
            && self.displacements.iter().all(|displacement| displacement.is_finite())
            && self.spalled.iter().all(|&element| element < mesh.elements().len())
            && self.fields.clone().is_none_or(|fields| fields.on(mesh).check().is_ok())
    }

    /// Takes an increment into account; the first of equal ones is the peak.
    pub fn observe(&mut self, record: &Record, snapshot: &Snapshot<'_>, keeps_fields: bool) {
        if self.rises(record) {
            self.displacements.clear();
            self.displacements.extend_from_slice(snapshot.displacements());
            self.spalled = snapshot.solids().spalled();
            self.fields = keeps_fields.then(|| KeptFields::of(Fields::of(snapshot)));
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
    pub fn into_state(self, mesh: &Mesh) -> Option<State<'_>> {
        let PeakLoad { load, slip, .. } = self.peak?;
        Some(State { slip, load, fields: self.fields?.on(mesh) })
    }
}

#[cfg(test)]
mod test;
