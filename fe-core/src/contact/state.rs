//! The history of all points, as it is kept between runs.

use super::Contact;
use super::pair::{Pair, PairState};
use crate::assembly::GREATEST_COUNT;
use crate::mesh::{ElementEdge, Mesh};
use crate::model::{ContactPair, Model};
use serde::{Deserialize, Serialize};

/// The history of all pairs, and what their last evaluation left.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct ContactState {
    pairs: Vec<PairState>,
    law_calls: u64,
}

impl PairState {
    /// Returns whether a state that was read may take the place of the one that was `made` with its pair: it is of the same sizes,
    /// its numbers are sound, and it names no node beyond `nodes`.
    fn may_follow(&self, made: &Self, nodes: usize) -> bool {
        let Self { exposed: _, committed, trial, kinematics, tangents, weight_slopes, shear_stiffness } = self;
        let mut numbers = tangents.as_flattened().as_flattened().iter().chain(weight_slopes).chain(shear_stiffness);
        made.committed.fits(committed)
            && made.trial.fits(trial)
            && kinematics.len() == made.kinematics.len()
            && tangents.len() == made.tangents.len()
            && weight_slopes.len() == made.weight_slopes.len()
            && shear_stiffness.len() == made.shear_stiffness.len()
            && kinematics.iter().flatten().all(|kinematics| kinematics.is_sound(nodes))
            && numbers.all(|number| number.is_finite())
    }

    /// Adds the points on edges that came to light to a pair that is made anew; `false` if it cannot have such edges.
    fn expose(&self, pair: &mut Pair, mesh: &Mesh, of_model: &ContactPair) -> bool {
        self.exposed.iter().all(|edges| {
            let is_edge = |edge: &ElementEdge| {
                mesh.elements().get(edge.element).is_some_and(|element| edge.edge < element.kind().corner_count())
            };
            edges.iter().all(is_edge) && pair.add_exposed(mesh, of_model, edges.clone()).is_ok()
        })
    }
}

impl Contact {
    /// The history, and what the last evaluation left.
    pub fn state(&self) -> ContactState {
        ContactState { pairs: self.pairs.iter().map(|pair| pair.state.clone()).collect(), law_calls: self.law_calls() }
    }

    /// Takes over a history and what the last evaluation left; `false` if it is of other pairs.
    #[must_use]
    pub(crate) fn set_state(&mut self, state: &ContactState, model: &Model) -> bool {
        let nodes = self.reference.len();
        let mut exposed = self.pairs.iter_mut().zip(&state.pairs).zip(&model.contacts);
        let fits = state.pairs.len() == model.contacts.len()
            && state.law_calls < GREATEST_COUNT
            && exposed.all(|((pair, state), of_model)| state.expose(pair, &model.mesh, of_model))
            && self.pairs.iter().zip(&state.pairs).all(|(pair, state)| state.may_follow(&pair.state, nodes));
        if fits {
            self.take_exposed(&model.mesh);
            self.pairs.iter_mut().zip(&state.pairs).for_each(|(pair, state)| pair.state.clone_from(state));
            // calls that were made to get here have been counted before
            let own: u64 = self.pairs.iter().map(|pair| pair.law.calls()).sum();
            self.earlier_calls = state.law_calls.saturating_sub(own);
        }
        fits
    }
}
