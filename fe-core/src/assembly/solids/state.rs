//! The states of all points, as they are kept between runs.

use super::points::States;
use super::record::Record;
use super::{Counters, Solids};
use serde::{Deserialize, Serialize};

/// The committed states of all points, and the displacements that they belong to.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct SolidsState {
    /// Part by part.
    points: Vec<States>,
    displacements: Vec<[f64; 2]>,
    counters: Counters,
}

impl Solids {
    /// The committed states.
    pub fn state(&self) -> SolidsState {
        SolidsState {
            points: self.bodies.iter().map(|body| body.points.committed.clone()).collect(),
            displacements: self.committed.clone(),
            counters: self.counters(),
        }
    }

    /// Takes over committed states; `false`, and nothing done, if they are of other solids. Stiffnesses stay until the
    /// next evaluation.
    #[must_use]
    pub fn set_state(&mut self, state: &SolidsState) -> bool {
        let fits = self.bodies.len() == state.points.len()
            && self.committed.len() == state.displacements.len()
            && self.bodies.iter().zip(&state.points).all(|(body, states)| body.points.committed.fits(states));
        if fits {
            for (body, states) in self.bodies.iter_mut().zip(&state.points) {
                body.points.committed.clone_from(states);
                body.points.trial.clone_from(states);
            }
            self.committed.copy_from_slice(&state.displacements);
            self.records.iter_mut().for_each(Record::forget);
            let Counters { umat_calls, evaluations, skipped_evaluations, stiffness_builds } = state.counters;
            // the sum over the parts is what counts
            self.bodies.iter_mut().take(1).for_each(|body| body.points.calls += umat_calls);
            self.counters.evaluations += evaluations;
            self.counters.skipped_evaluations += skipped_evaluations;
            self.counters.stiffness_builds += stiffness_builds;
        }
        fits
    }
}
