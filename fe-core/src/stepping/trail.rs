//! The states through which a run went, along which a run with nearly the same parameters is led: for derivatives of a
//! history by its parameters (doc.md).

use super::newton::{Guide, Round};
use super::{Recorded, Tried};
use crate::model::Model;

/// States through which a run of a specimen went.
#[derive(Clone, Debug, Default)]
pub struct Trail {
    /// The attempts that stand.
    pub recorded: Recorded,
    /// The way to equilibrium at zero drives.
    pub(super) datum: Guide,
    /// The ways through the increments of each step.
    steps: Vec<Vec<Guide>>,
}

/// The way through an increment of another run, and where it began.
#[derive(Clone, Copy, Debug)]
pub(super) struct Lead<'a> {
    /// The last round before it.
    pub(super) before: Option<&'a Round>,
    /// The way.
    pub(super) guide: &'a Guide,
}

impl Trail {
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
        let index = |number: u32| (number as usize).checked_sub(1);
        let (step, increment) = (index(step)?, index(increment)?);
        let guide = self.steps.get(step)?.get(increment)?;
        let earlier = self.steps[..step].iter().flatten().chain(&self.steps[step][..increment]);
        let before = earlier.last().unwrap_or(&self.datum).rounds.last();
        Some(Lead { before, guide })
    }
}
