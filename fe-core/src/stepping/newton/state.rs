//! What an equilibrium remembers between increments, as it is kept between runs.

use super::{Equilibrium, coupled_freedoms};
use crate::assembly::Equations;
use crate::assembly::solids::SolidsState;
use crate::contact::ContactState;
use crate::model::Model;
use crate::stepping::ModelError;
use crate::stepping::zone::Zone;
use serde::{Deserialize, Serialize};

/// States, the elements that iterate, and the scales that tolerances are relative to. No factor and no stiffness: they
/// follow from these.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct EquilibriumState {
    solids: SolidsState,
    contact: ContactState,
    zone: Zone,
    greatest_scale: f64,
    rounding: f64,
    last_move: f64,
    last_iterations: usize,
}

impl EquilibriumState {
    /// Whether the scales are numbers.
    pub(in crate::stepping) fn is_finite(&self) -> bool {
        [self.greatest_scale, self.rounding, self.last_move].into_iter().all(f64::is_finite)
    }
}

impl<'m> Equilibrium<'m> {
    /// What it remembers at the end of an increment.
    pub(in crate::stepping) fn state(&self) -> EquilibriumState {
        EquilibriumState {
            solids: self.solids.state(),
            contact: self.contact.state(),
            zone: self.zone.clone(),
            greatest_scale: self.greatest_scale,
            rounding: self.rounding,
            last_move: self.last_move,
            last_iterations: self.last_iterations,
        }
    }

    /// An equilibrium of a model that has no more memory than this.
    ///
    /// # Errors
    ///
    /// Those of [`Self::new`], and a state of another model.
    pub(in crate::stepping) fn with_state(model: &'m Model, state: &EquilibriumState) -> Result<Self, ModelError> {
        let mut made = Self::new(model, Equations::new(model)?)?;
        if !state.zone.may_follow(&made.zone) {
            return Err(foreign_state());
        }
        if made.zone != state.zone {
            // the solids are virgin still: what is condensed is elastic, and was so
            made.zone = state.zone.clone();
            let equations = made.system.equations().clone();
            made.system = made.zone.system(model, equations, &coupled_freedoms(model, &made.contact), &made.solids)?;
            made.solids.set_active(made.zone.active());
        }
        if !(made.solids.set_state(&state.solids) && made.contact.set_state(&state.contact)) {
            return Err(foreign_state());
        }
        made.greatest_scale = state.greatest_scale;
        made.rounding = state.rounding;
        made.last_move = state.last_move;
        made.last_iterations = state.last_iterations;
        Ok(made)
    }
}

/// A checkpoint of another model, or one that no run has made.
pub(in crate::stepping) fn foreign_state() -> ModelError {
    ModelError::Inconsistent("the states to go on from are those of another model".into())
}
