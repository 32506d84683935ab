//! Runs that go on where others were interrupted.
//!
//! A checkpoint holds what the rest of a run depends on, exactly. What cannot be kept (factors, stiffnesses, feet of
//! contact) is forgotten by the run that makes the checkpoint as well: it goes on with an equilibrium made from the
//! checkpoint, as the run does that is restarted from it. So both compute the same to the last bit.

use super::control::StepRun;
use super::newton::{Equilibrium, EquilibriumState};
use super::{Analysis, Present, clock};
use crate::model::{IncrementContext, Model, ModelError};
use serde::{Deserialize, Serialize};
use umat_abi::host::ExternalDatabases;

/// State at the end of an increment on which the rest of a run depends.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct Checkpoint {
    position: Position,
    present: Present,
    equilibrium: EquilibriumState,
}

/// Position of a run within its steps.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub(super) struct Position {
    /// Step from 1.
    pub(super) step: u32,
    pub(super) run: StepRun,
    /// Increments of the step that are done.
    pub(super) increment: u32,
    pub(super) step_time: f64,
}

impl Checkpoint {
    /// Step, from 1, and increments of it that are done.
    pub fn place(&self) -> [u32; 2] {
        [self.position.step, self.position.increment]
    }
}

impl<'m> Analysis<'m> {
    /// Makes a checkpoint after every so many increments, for [`super::IncrementObserver::checkpoint`].
    pub fn checkpoint_every(&mut self, increments: u64) {
        self.checkpoint_every = Some(increments.max(1));
    }

    /// Prepares the rest of a run of this model; a checkpoint of another one makes nonsense or a panic.
    ///
    /// # Errors
    ///
    /// Those of [`Self::new`], and a matrix that has no factor.
    pub fn resume(model: &'m Model, checkpoint: &Checkpoint) -> Result<Self, ModelError> {
        super::error::check(model)?;
        let Position { step, increment, step_time, .. } = checkpoint.position;
        let context = IncrementContext {
            step,
            increment,
            step_time,
            total_time: checkpoint.present.total_time,
            ..IncrementContext::default()
        };
        let databases = ExternalDatabases::resume(model.libraries(), clock(&context, 0.0));
        let equilibrium = Equilibrium::with_state(model, &checkpoint.equilibrium)?;
        Ok(Self {
            last_checkpoint: checkpoint.equilibrium.memory.statistics.increments,
            resumed: Some(checkpoint.position.clone()),
            ..Self::at(model, databases, equilibrium, checkpoint.present.clone())
        })
    }

    /// Returns whether a checkpoint is due before the next increment: after the last one there is nothing to go on with.
    pub(super) fn is_checkpoint_due(&self) -> bool {
        let done = self.statistics().increments;
        done > self.last_checkpoint && self.checkpoint_every.is_some_and(|every| done.is_multiple_of(every))
    }

    /// Returns what the rest of the run depends on.
    pub(super) fn checkpoint(&mut self, position: Position) -> Checkpoint {
        self.last_checkpoint = self.statistics().increments;
        Checkpoint { position, present: self.present.clone(), equilibrium: self.equilibrium.state() }
    }
}
