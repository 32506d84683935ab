//! The states that a case asks pictures of, beside those of the greatest load and of the end.

use super::peak::KeptFields;
use super::{PictureAt, State};
use fe_core::mesh::Mesh;
use fe_core::output::Fields;
use fe_core::stepping::{Record, Snapshot};
use serde::{Deserialize, Serialize};

/// Keeps the fields of the moments that are wanted.
#[derive(Debug)]
pub struct Moments<'p> {
    mesh: &'p Mesh,
    wanted: &'p [PictureAt],
    /// In the order of `wanted`.
    states: Vec<Option<State<'p>>>,
}

/// Moments that are kept so far, without the mesh: slip, load and fields.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
pub struct KeptMoments(Vec<Option<(f64, f64, KeptFields)>>);

impl KeptMoments {
    /// Returns whether a run on this mesh that wants so many can have come to it.
    pub fn fits(&self, mesh: &Mesh, wanted: usize) -> bool {
        let fits = |(slip, load, fields): &(f64, f64, KeptFields)| {
            slip.is_finite() && load.is_finite() && fields.clone().on(mesh).check().is_ok()
        };
        self.0.len() == wanted && self.0.iter().flatten().all(fits)
    }
}

impl<'p> Moments<'p> {
    /// Keeps these.
    pub fn new(mesh: &'p Mesh, wanted: &'p [PictureAt]) -> Self {
        Self { mesh, wanted, states: wanted.iter().map(|_| None).collect() }
    }

    /// Goes on from what was kept.
    pub fn resumed(mesh: &'p Mesh, wanted: &'p [PictureAt], kept: KeptMoments) -> Self {
        let state = |(slip, load, fields): (f64, f64, KeptFields)| State { slip, load, fields: fields.on(mesh) };
        Self { mesh, wanted, states: kept.0.into_iter().map(|kept| kept.map(state)).collect() }
    }

    /// Returns the moments that are kept so far.
    pub fn kept(&self) -> KeptMoments {
        let kept = |state: &State<'_>| (state.slip, state.load, KeptFields::of(state.fields.clone()));
        KeptMoments(self.states.iter().map(|state| state.as_ref().map(kept)).collect())
    }

    /// Takes an increment into account, the `number`-th of the run from 1; returns whether it is one of the moments.
    pub fn observe(&mut self, number: u64, record: &Record, snapshot: &Snapshot<'_>) -> bool {
        let mut is_one = false;
        for (wanted, state) in self.wanted.iter().zip(&mut self.states) {
            let is_now = match *wanted {
                PictureAt::Slip(slip) => record.slip.abs() >= slip * (1.0 - ROUNDING),
                PictureAt::Increment(increment) => number == increment,
            };
            if record.step > 0 && state.is_none() && is_now {
                let fields = Fields::of(snapshot).kept(self.mesh);
                *state = Some(State { slip: record.slip, load: record.load, fields });
                is_one = true;
            }
        }
        is_one
    }

    /// Returns a warning that names what was wanted and did not come.
    pub fn missed(&self) -> Option<String> {
        let missed = self.wanted.iter().zip(&self.states).filter(|(_, state)| state.is_none());
        let names = missed.map(|(wanted, _)| match wanted {
            PictureAt::Slip(slip) => format!("a slip of {slip} mm"),
            PictureAt::Increment(increment) => format!("increment {increment}"),
        });
        let names: Vec<String> = names.collect();
        (!names.is_empty())
            .then(|| format!("pictures_at: the run did not reach {}: no picture of it", names.join(", ")))
    }

    /// Returns the requested moments that were reached, in the order of the case.
    pub fn into_states(self) -> Vec<(PictureAt, State<'p>)> {
        self.wanted.iter().copied().zip(self.states).filter_map(|(wanted, state)| Some((wanted, state?))).collect()
    }
}

/// A slip is reached within this part of it: increments add up.
const ROUNDING: f64 = 1e-9;
