//! The states that a case asks pictures of, in addition to those of the greatest load and of the end.

use super::{PictureAt, SavedState};
use fe_core::output::Fields;
use fe_core::stepping::{Record, Snapshot};
use serde::{Deserialize, Serialize};

/// The states at the moments that are wanted, in their order, as far as they came.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct Moments(Vec<Option<SavedState>>);

impl Moments {
    /// Keeps these.
    pub fn new(wanted: &[PictureAt]) -> Self {
        Self(wanted.iter().map(|_| None).collect())
    }

    /// Takes an increment into account, the `number`-th of the run from 1; returns whether it is one of the moments.
    pub fn observe(&mut self, wanted: &[PictureAt], number: u64, record: &Record, snapshot: &Snapshot<'_>) -> bool {
        let mut is_one = false;
        for (wanted, state) in wanted.iter().zip(&mut self.0) {
            let is_now = match *wanted {
                PictureAt::Slip(slip) => record.slip.abs() >= slip * (1.0 - ROUNDING),
                PictureAt::Increment(increment) => number == increment,
            };
            if record.step > 0 && state.is_none() && is_now {
                *state = Some(SavedState { slip: record.slip, load: record.load, fields: Fields::of(snapshot) });
                is_one = true;
            }
        }
        is_one
    }

    /// Returns a warning that names what was wanted and did not come.
    pub fn missed(&self, wanted: &[PictureAt]) -> Option<String> {
        let missed = wanted.iter().zip(&self.0).filter(|(_, state)| state.is_none());
        let names = missed.map(|(wanted, _)| match wanted {
            PictureAt::Slip(slip) => format!("a slip of {slip} mm"),
            PictureAt::Increment(increment) => format!("increment {increment}"),
        });
        let names: Vec<String> = names.collect();
        (!names.is_empty())
            .then(|| format!("pictures_at: the run did not reach {}: no picture of it", names.join(", ")))
    }

    /// Returns the requested moments that were reached, in the order of the case.
    pub fn into_states(self, wanted: &[PictureAt]) -> Vec<(PictureAt, SavedState)> {
        wanted.iter().copied().zip(self.0).filter_map(|(wanted, kept)| Some((wanted, kept?))).collect()
    }
}

/// A slip is reached within this part of it: increments add up.
const ROUNDING: f64 = 1e-9;
