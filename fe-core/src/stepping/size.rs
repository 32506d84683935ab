//! How far the next increment goes: automatic growth and cut-back.

use crate::model::StepControl;
use serde::{Deserialize, Serialize};

#[cfg(test)]
mod test;

/// Increments that need at most so many iterations are easy.
pub(super) const EASY: usize = 9;
/// Increments that need more are hard.
const HARD: usize = 13;
/// After as many easy increments in a row the size grows.
const STREAK: usize = 2;
/// Factor by which an increment may grow.
pub(super) const GROWTH: f64 = 1.5;
/// A hard increment makes the next smaller by this.
const SHRINKAGE: f64 = 0.75;
/// What is left of a step is taken as a whole rather than leave less than this part of an increment.
const REMAINDER: f64 = 1e-9;

/// Sizes as fractions of the step.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub(super) struct IncrementSize {
    size: f64,
    maximum: f64,
    minimum: f64,
    /// Equal increments return to this size after a cut.
    fixed: bool,
    streak: usize,
}

impl IncrementSize {
    pub(super) fn new(control: StepControl) -> Self {
        match control {
            StepControl::Fixed { increments } => {
                let size = 1.0 / increments.max(1) as f64;
                // Equal increments may be cut as deep as thirty halvings go.
                Self { size, maximum: size, minimum: size * 2.0_f64.powi(-30), fixed: true, streak: 0 }
            }
            StepControl::Automatic { initial, maximum, minimum } => {
                Self { size: initial.min(maximum), maximum, minimum, fixed: false, streak: 0 }
            }
        }
    }

    /// Returns whether a step that began with `first` can have come to it.
    pub(super) fn may_follow(&self, first: &Self) -> bool {
        let Self { size, maximum, minimum, fixed, streak } = *self;
        size > 0.0
            && size.is_finite()
            && streak <= STREAK
            && (maximum, minimum, fixed) == (first.maximum, first.minimum, first.fixed)
    }

    /// The next increment when this much of the step is left.
    pub(super) fn next(&self, left: f64) -> f64 {
        if self.size >= left * (1.0 - REMAINDER) { left } else { self.size }
    }

    /// An increment was accepted.
    pub(super) fn accepted(&mut self, iterations: usize) {
        if iterations <= EASY {
            self.streak += 1;
            if self.streak >= STREAK || self.fixed {
                self.size = (self.size * GROWTH).min(self.maximum);
                self.streak = 0;
            }
        } else {
            self.streak = 0;
            if iterations > HARD && !self.fixed {
                self.size = (self.size * SHRINKAGE).max(self.minimum);
            }
        }
    }

    /// The attempted increment is repeated with a fraction of it; `false` if that is below the least.
    pub(super) fn cut(&mut self, attempted: f64, fraction: f64) -> bool {
        self.size = attempted * fraction;
        self.streak = 0;
        self.size >= self.minimum
    }

    /// The next increment shall not exceed this.
    pub(super) fn limit(&mut self, size: f64) {
        self.size = self.size.min(size.max(self.minimum));
    }

    /// Returns whether sizes are free; equal ones stay as they are asked for.
    pub(super) fn is_automatic(&self) -> bool {
        !self.fixed
    }

    /// The least increment.
    pub(super) fn minimum(&self) -> f64 {
        self.minimum
    }

    /// The greatest increment.
    pub(super) fn maximum(&self) -> f64 {
        self.maximum
    }

    /// Starts again from a size.
    pub(super) fn restart(&mut self, size: f64) {
        self.size = size.clamp(self.minimum, self.maximum);
        self.streak = 0;
    }
}
