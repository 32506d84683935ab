//! How far the next increment goes: automatic growth and cut-back.

use crate::model::StepControl;
use crate::stepping::constants::{EASY, GROWTH, HARD, SHRINKAGE, STREAK, SUMMED};
use serde::{Deserialize, Serialize};

#[cfg(test)]
mod test;

/// Sizes of the increments of a step, as fractions of it.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub(super) struct IncrementSize {
    size: f64,
    pub(super) maximum: f64,
    pub(super) minimum: f64,
    /// Whether increments are equal: they keep the size that was asked for, and return to it after cuts.
    pub(super) fixed: bool,
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

    /// Returns the next increment, when this much of the step is left.
    pub(super) fn next(&self, left: f64) -> f64 {
        if self.size >= left * (1.0 - SUMMED) { left } else { self.size }
    }

    /// Chooses the next size after an accepted increment: larger after few iterations in all, smaller after a hard round of them. In how
    /// many rounds contact settles says nothing of the size: it would shrink without end where each increment needs some.
    pub(super) fn accepted(&mut self, iterations: usize, hardest: usize) {
        if iterations <= EASY {
            self.streak += 1;
            if self.streak >= STREAK || self.fixed {
                self.size = (self.size * GROWTH).min(self.maximum);
                self.streak = 0;
            }
        } else {
            self.streak = 0;
            if hardest > HARD && !self.fixed {
                self.size = (self.size * SHRINKAGE).max(self.minimum);
            }
        }
    }

    /// Cuts the attempted increment to a fraction of it; `false` if that is below the least one.
    pub(super) fn cut(&mut self, attempted: f64, fraction: f64) -> bool {
        self.size = attempted * fraction;
        self.streak = 0;
        self.size >= self.minimum
    }

    /// Bounds the next increment by this size.
    pub(super) fn limit(&mut self, size: f64) {
        self.size = self.size.min(size.max(self.minimum));
    }

    /// Starts again from a given size.
    pub(super) fn restart(&mut self, size: f64) {
        self.size = size.clamp(self.minimum, self.maximum);
        self.streak = 0;
    }
}
