//! Models that cannot be computed, and runs that end early.

use crate::assembly::PointFailure;
use crate::model::{Measured, Model, ModelError};

/// A run that ended early.
#[derive(Debug, thiserror::Error)]
pub enum RunError {
    /// An increment could not be completed however small.
    #[error("step {step}, increment {increment} ({:.4} % of the step done): {trouble}", 100.0 * progress)]
    Failed {
        /// Step, from 1.
        step: u32,
        /// Increment, from 1; 0: equilibrium before the first step.
        increment: u32,
        /// Part of the step that was done.
        progress: f64,
        /// Cause and place.
        trouble: PointFailure,
    },
    /// The observer could not write.
    #[error(transparent)]
    Write(#[from] std::io::Error),
}

/// Whether the tables of a model have the lengths that they should.
pub(super) fn check(model: &Model) -> Result<(), ModelError> {
    let wrong = |message: String| Err(ModelError(message));
    let drives = model.drives.len();
    if let Some(load) = model.loads.iter().find(|load| load.drive >= drives) {
        return wrong(format!("load '{}' follows a drive that does not exist", load.name));
    }
    let interferences = model.contacts.iter().filter_map(|pair| Some((pair, pair.fit.interference?)));
    if let Some((pair, _)) = interferences.into_iter().find(|(_, interference)| interference.drive >= drives) {
        return Err(ModelError::of_pair(&pair.name, "its interference follows a drive that does not exist"));
    }
    if model.controls.spalling.is_some() && model.measured.slip.is_empty() {
        return wrong("spalling is timed by the slip, and the model measures none".into());
    }
    for (index, step) in model.steps.iter().enumerate() {
        if step.targets.len() != drives {
            return wrong(format!("step {} has {} targets for {drives} drives", index + 1, step.targets.len()));
        }
        if !(step.time > 0.0 && step.time.is_finite()) {
            return wrong(format!("step {} must take a time > 0, found {}", index + 1, step.time));
        }
    }
    let Measured { slip, supports, fibres, .. } = &model.measured;
    if slip.iter().chain(fibres.iter().map(|fibre| &fibre.slip)).any(|&drive| drive >= drives) {
        return wrong("the measured slip is a drive that does not exist".into());
    }
    if supports.iter().chain(fibres.iter().map(|fibre| &fibre.support)).any(|&support| support >= model.supports.len())
    {
        return wrong("the measured load is of a support that does not exist".into());
    }
    Ok(())
}
