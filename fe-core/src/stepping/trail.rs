//! The states through which a run went, along which a run with nearly the same parameters is led: for derivatives of a
//! history by its parameters (doc.md).

use super::newton::{Guide, Round, Turn};
use super::{Recorded, Tried};
use crate::model::{Model, Step};
use std::sync::{Arc, Mutex, PoisonError};

/// States through which a run of a specimen went.
#[derive(Clone, Debug, Default)]
pub struct Trail {
    /// The attempts that stand.
    pub recorded: Recorded,
    /// The way to equilibrium at zero drives.
    pub(super) datum: Guide,
    /// The ways through the increments of each step.
    steps: Vec<Vec<Guide>>,
    /// The steps as the model had them.
    asked: Vec<Step>,
}

/// The trail along which a run goes, by itself or among others that share factors.
#[derive(Clone, Debug)]
pub struct Along {
    /// The trail.
    pub trail: Arc<Trail>,
    /// For the run that begins first.
    turn: Arc<Mutex<Option<Turn>>>,
}

impl From<Arc<Trail>> for Along {
    fn from(trail: Arc<Trail>) -> Self {
        Self { trail, turn: Arc::default() }
    }
}

impl Along {
    /// Returns what as many runs go along, which share factors. They must be under way at once: each waits for others, until they go
    /// on, end, or [`Self::leave`].
    pub fn together(trail: &Arc<Trail>, count: usize) -> Vec<Self> {
        let made = |turn| Self { trail: Arc::clone(trail), turn: Arc::new(Mutex::new(Some(turn))) };
        Turn::all(count).into_iter().map(made).collect()
    }

    /// Lets the others go on without a run that may not have begun.
    pub fn leave(&self) {
        drop(self.take_turn());
    }

    pub(super) fn take_turn(&self) -> Option<Turn> {
        self.turn.lock().unwrap_or_else(PoisonError::into_inner).take()
    }
}

/// The way through an increment of another run, and where it began.
#[derive(Clone, Copy, Debug)]
pub(super) struct Lead<'a> {
    /// Step and increment; 0 at the datum.
    pub(super) at: [u32; 2],
    /// The last round before it.
    pub(super) before: Option<&'a Round>,
    /// The way.
    pub(super) guide: &'a Guide,
}

impl Trail {
    pub(super) fn of(model: &Model) -> Self {
        Self { asked: model.steps.clone(), ..Self::default() }
    }

    /// Returns whether the increments can be those of a model: it has as many steps, which choose theirs in the same way. Their targets
    /// and times may be others.
    pub fn has_steps_of(&self, model: &Model) -> bool {
        self.asked.iter().map(|step| step.control).eq(model.steps.iter().map(|step| step.control))
    }

    /// The times of the steps.
    pub(super) fn times(&self) -> impl Iterator<Item = Option<f64>> {
        self.asked.iter().map(|step| Some(step.time))
    }

    /// Returns whether the states can be those of a model.
    pub(super) fn fits(&self, model: &Model) -> bool {
        self.steps.iter().flatten().chain([&self.datum]).all(|guide| guide.fits(model))
    }

    /// Takes an increment down; steps from 1.
    pub(super) fn push(&mut self, step: u32, tried: Tried, guide: Guide) {
        self.recorded.push(step, vec![tried]);
        self.steps.resize_with(step as usize, Vec::new);
        if let Some(increments) = self.steps.last_mut() {
            increments.push(guide);
        }
    }

    /// Returns the way through an increment; both from 1.
    pub(super) fn lead(&self, step: u32, increment: u32) -> Option<Lead<'_>> {
        let at = [step, increment];
        let index = |number: u32| (number as usize).checked_sub(1);
        let (step, increment) = (index(step)?, index(increment)?);
        let guide = self.steps.get(step)?.get(increment)?;
        let earlier = self.steps[..step].iter().flatten().chain(&self.steps[step][..increment]);
        let before = earlier.last().unwrap_or(&self.datum).rounds.last();
        Some(Lead { at, before, guide })
    }
}
