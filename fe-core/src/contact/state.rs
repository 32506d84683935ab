//! The history of all points, as it is kept between runs.

use super::Contact;
use super::pair::{Pair, PairState};
use crate::mesh::Mesh;
use crate::model::{ContactPair, Model, ModelError};
use serde::{Deserialize, Serialize};

/// The history of all pairs, and what their last evaluation left.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct ContactState {
    pairs: Vec<PairState>,
    law_calls: u64,
}

impl PairState {
    /// Adds the points on edges that came to light to a pair that is made anew.
    fn expose(&self, pair: &mut Pair, mesh: &Mesh, of_model: &ContactPair) -> Result<(), ModelError> {
        self.exposed.iter().try_for_each(|edges| pair.add_exposed(mesh, of_model, edges.clone()))
    }
}

impl Contact {
    /// The history, and what the last evaluation left.
    pub fn state(&self) -> ContactState {
        ContactState { pairs: self.pairs.iter().map(|pair| pair.state.clone()).collect(), law_calls: self.law_calls() }
    }

    /// Takes over a history and what the last evaluation left, of the same pairs.
    ///
    /// # Errors
    /// A pair has no surface that can come to light.
    pub(crate) fn set_state(&mut self, state: &ContactState, model: &Model) -> Result<(), ModelError> {
        for ((pair, state), of_model) in self.pairs.iter_mut().zip(&state.pairs).zip(&model.contacts) {
            state.expose(pair, &model.mesh, of_model)?;
        }
        self.take_exposed(&model.mesh);
        self.pairs.iter_mut().zip(&state.pairs).for_each(|(pair, state)| pair.state.clone_from(state));
        // calls that were made to get here have been counted before
        let own: u64 = self.pairs.iter().map(|pair| pair.law.calls()).sum();
        self.earlier_calls = state.law_calls.saturating_sub(own);
        Ok(())
    }
}
