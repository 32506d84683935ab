//! Drag: what holds contact back while a specimen goes to an equilibrium that may be far.

use crate::assembly::Equations;
use crate::solver::Blocks;
use serde::{Deserialize, Serialize};

/// Viscous forces on the freedoms of contact, f = c (u − u_n), and their work: where no equilibrium is near, what is out of
/// balance moves contact through a fluid until it balances again.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
pub(super) struct Drag {
    /// Forces of drag at the end of the last increment by freedoms, N; empty where there was none.
    start: Vec<f64>,
    /// Work of drag up to the end of the last increment, N·mm.
    pub(super) work: f64,
    /// Forces and work of drag at the trial state.
    trial: Vec<f64>,
    pub(super) trial_work: f64,
}

impl Drag {
    /// Adds the forces of drag at a trial state and their stiffness; freedoms that are held have none.
    ///
    /// `resistance`: c, N/mm at each freedom; 0: none. `moved`: u − u_n by freedoms, mm.
    pub(super) fn evaluate(
        &mut self,
        resistance: f64,
        freedoms: &[usize],
        moved: impl Fn(usize) -> f64,
        equations: &Equations,
        forces: &mut [f64],
        blocks: &mut Blocks,
    ) {
        self.trial.clear();
        self.trial_work = self.work;
        if resistance == 0.0 && self.start.is_empty() {
            return;
        }
        if resistance > 0.0 {
            self.trial.resize(forces.len(), 0.0);
            for &freedom in freedoms.iter().filter(|&&freedom| !equations.equations_of(freedom).is_empty()) {
                self.trial[freedom] = resistance * moved(freedom);
                forces[freedom] += self.trial[freedom];
                blocks.push(&[freedom], &[resistance]);
            }
        }
        // a trapezoid, as that of all other forces
        let at = |forces: &[f64], freedom: usize| forces.get(freedom).copied().unwrap_or_default();
        let mean = |freedom| 0.5 * (at(&self.start, freedom) + at(&self.trial, freedom));
        self.trial_work += freedoms.iter().map(|&freedom| mean(freedom) * moved(freedom)).sum::<f64>();
    }

    /// Makes the trial state that of the last increment.
    pub(super) fn commit(&mut self) {
        self.start.clone_from(&self.trial);
        self.work = self.trial_work;
    }

    /// Returns the largest force of drag at the trial state, N.
    pub(super) fn largest(&self) -> f64 {
        super::largest(&self.trial)
    }

    /// Returns whether the trial state turns back on the way of the last increment: it was passed by.
    pub(super) fn turns(&self) -> bool {
        super::dot(&self.start, &self.trial) < 0.0
    }
}
