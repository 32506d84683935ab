//! The increments of a run, so that another one repeats them: snap-backs, refused attempts and all.
//!
//! A run depends on its attempts, in their order: a refused attempt changes tangents, scales and the far field. A run
//! that repeats all of them on the same model reaches the same bits. With other parameters its results are a smooth
//! function of these, since nothing is chosen any more.

use super::control::StepRun;
use super::newton::{IncrementGoal, Leader};
use super::record::{Directive, IncrementObserver};
use super::{Along, Analysis, RunError, Trail};
use crate::assembly::PointFailure;
use crate::contact::PointIndex;
use crate::model::{IncrementContext, Step};
use crate::stepping::constants::SUMMED;
use serde::{Deserialize, Serialize};
use std::sync::Arc;

/// The attempts at each increment of each step of a run, in order.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Recorded {
    /// Attempts by steps and increments; the last one at an increment stands. Of points several may: pieces of an increment.
    pub steps: Vec<Vec<Vec<Tried>>>,
}

/// Attempt at an increment, as it was made.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Tried {
    /// Leading quantity and its goal.
    pub to: LeadingQuantity,
    /// Time that it took, s; points know it themselves.
    #[serde(default, skip_serializing_if = "is_zero")]
    pub time: f64,
    /// Outcome of the attempt.
    #[serde(default, skip_serializing_if = "AttemptVerdict::stands")]
    pub verdict: AttemptVerdict,
    /// Size, if its energies did not balance.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub imbalanced: Option<f64>,
}

/// Leading quantity of an attempt, and its goal.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase", deny_unknown_fields)]
pub enum LeadingQuantity {
    /// The drives: to this part of the step; of a point, to this part of the increment.
    Drives(f64),
    /// The slip of a contact point.
    Slip {
        /// Growth, mm.
        growth: f64,
        /// Indices of the pair and of the point in it; `None`: there was none.
        point: Option<[usize; 2]>,
    },
    /// The dissipation of the solids' laws grows by so much, N·mm.
    Dissipation(f64),
    /// The phase field grows by so much at the node where it grows fastest.
    Field(f64),
    /// Drag on contact holds the specimen back, which is out of balance.
    Through {
        /// The part of the step that the drives are at.
        to: f64,
        /// Resistance at each freedom of contact, N/mm.
        resistance: f64,
    },
}

/// Outcome of an attempt.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum AttemptVerdict {
    /// The attempt is the increment, or a piece of it.
    #[default]
    Stands,
    /// The attempt did not converge, or went too far.
    Refused,
    /// The attempt was made for its findings alone: a look in smaller increments.
    Look,
}

impl AttemptVerdict {
    fn stands(&self) -> bool {
        *self == Self::Stands
    }
}

#[expect(clippy::trivially_copy_pass_by_ref, reason = "as serde calls it")]
fn is_zero(number: &f64) -> bool {
    *number == 0.0
}

impl Recorded {
    /// Returns what no run can have come to, with its place, if anything.
    pub fn mistake(&self) -> Option<(String, &'static str)> {
        for (step, increments) in self.steps.iter().enumerate() {
            for (increment, attempts) in increments.iter().enumerate() {
                let place = |attempt: usize| format!("steps[{step}][{increment}][{attempt}]");
                for (index, tried) in attempts.iter().enumerate() {
                    let (part, number) = match tried.to {
                        LeadingQuantity::Drives(part) => (part, 0.0),
                        LeadingQuantity::Slip { growth, .. }
                        | LeadingQuantity::Dissipation(growth)
                        | LeadingQuantity::Field(growth) => (0.0, growth),
                        LeadingQuantity::Through { to, resistance } => (to, resistance),
                    };
                    let is_sound = number.is_finite() && tried.time >= 0.0 && tried.time.is_finite();
                    if !is_sound || !(0.0..=1.0).contains(&part) {
                        return Some((place(index), "is no part of a step, or takes no time that is a number ≥ 0"));
                    }
                }
                if !attempts.last().is_some_and(|last| last.verdict.stands()) {
                    return Some((place(attempts.len().saturating_sub(1)), "the last attempt at an increment stands"));
                }
            }
        }
        None
    }

    /// Takes an increment down; from 1.
    pub fn push(&mut self, step: u32, attempts: Vec<Tried>) {
        self.steps.resize_with(step as usize, Vec::new);
        if let Some(increments) = self.steps.last_mut() {
            increments.push(attempts);
        }
    }

    /// The attempts at the increments of a step, from 1.
    pub fn of_step(&self, step: u32) -> &[Vec<Tried>] {
        let index = (step as usize).checked_sub(1);
        index.and_then(|index| self.steps.get(index)).map(Vec::as_slice).unwrap_or_default()
    }
}

/// Returns the time of a step of these increments if they came to its end.
fn whole_time(increments: &[Vec<Tried>]) -> Option<f64> {
    let standing = || increments.iter().filter_map(|attempts| attempts.last());
    let is_whole = standing().next_back().is_some_and(|tried| tried.to == LeadingQuantity::Drives(1.0));
    is_whole.then(|| standing().map(|tried| tried.time).sum())
}

impl StepRun {
    /// Returns where a recorded attempt leads.
    fn recorded_target(&self, to: LeadingQuantity) -> IncrementGoal {
        let led = |by, growth, point| IncrementGoal::Led { by, growth, direction: self.direction(), point };
        match to {
            LeadingQuantity::Drives(part) => IncrementGoal::Drives(self.drives_at(part)),
            LeadingQuantity::Slip { growth, point } => {
                led(Leader::PointSlip, growth, point.map(|[pair, point]| PointIndex { pair, point }))
            }
            LeadingQuantity::Dissipation(growth) => led(Leader::Dissipation, growth, None),
            LeadingQuantity::Field(growth) => led(Leader::Field, growth, None),
            LeadingQuantity::Through { to, resistance } => {
                IncrementGoal::Through { goal: self.drives_at(to), resistance }
            }
        }
    }
}

impl Analysis<'_> {
    /// Repeats the increments of another run, whatever the steps say of theirs; those of a step that came to its end take the time of
    /// the step. No checkpoints are made.
    pub fn repeat(&mut self, recorded: Recorded) {
        let times: Vec<Option<f64>> = recorded.steps.iter().map(|increments| whole_time(increments)).collect();
        self.repeat_in_own_times(recorded, times);
    }

    /// Repeats increments of steps that took these times, where they are known, in the times of the model's steps.
    fn repeat_in_own_times(&mut self, mut recorded: Recorded, times: impl IntoIterator<Item = Option<f64>>) {
        for ((increments, step), time) in recorded.steps.iter_mut().zip(&self.model.steps).zip(times) {
            if let Some(time) = time.filter(|time| (step.time - time).abs() > SUMMED * time) {
                increments.iter_mut().flatten().for_each(|tried| tried.time *= step.time / time);
            }
        }
        self.repeats = Some(recorded);
    }

    /// Keeps the states of the run from here on: two arrays of the displacements' length for each round of iterations.
    pub fn keep_trail(&mut self) {
        self.equilibrium.company.keeps_rounds = true;
        self.trail = Some(Trail::of(self.model));
    }

    /// Returns the states of the run so far, if they were kept.
    pub fn take_trail(&mut self) -> Option<Trail> {
        self.trail.take()
    }

    /// Goes along the states of a run of the same model with nearly the same parameters, whose difference to them is then
    /// that of the solutions, whatever the tolerance. Steps may lead elsewhere, in other times. Of a model with another mesh it repeats
    /// the increments; with other steps ([`Trail::has_steps_of`]) it goes its own way.
    pub fn follow(&mut self, along: &Along) {
        if !along.trail.has_steps_of(self.model) {
            along.leave();
            return;
        }
        self.repeat_in_own_times(along.trail.recorded.clone(), along.trail.times());
        self.along = Some(Arc::clone(&along.trail)).filter(|trail| trail.fits(self.model));
        self.equilibrium.company.turn = along.take_turn().filter(|_| self.along.is_some());
    }

    /// Returns where the attempt that was just made leads.
    pub(super) fn way(&self, run: &StepRun) -> LeadingQuantity {
        run.way(self.equilibrium.leading.point.map(|(point, _)| [point.pair, point.point]))
    }

    /// Takes down an attempt that was made to learn something of energies.
    pub(super) fn record_look(&mut self, run: &StepRun, time: f64) {
        let (to, imbalanced) = (self.way(run), Some(run.attempted));
        self.tried.push(Tried { to, time, verdict: AttemptVerdict::Look, imbalanced });
    }

    /// Repeats the increments of a step.
    pub(super) fn repeat_step(
        &mut self,
        step: &Step,
        number: u32,
        increments: &[Vec<Tried>],
        observer: &mut dyn IncrementObserver,
    ) -> Result<Directive, RunError> {
        let run = StepRun::new(step, &self.present.committed.drives, self.model);
        let (mut step_time, mut progress) = (0.0, 0.0);
        for (attempts, increment) in increments.iter().zip(1..) {
            let mut cutbacks = 0;
            for tried in attempts {
                let context = IncrementContext {
                    step: number,
                    increment,
                    iteration: 1,
                    step_time,
                    total_time: self.present.total_time,
                    time_increment: tried.time,
                };
                let attempt = self.attempt(&run.recorded_target(tried.to), context);
                if let Ok(converged) = &attempt {
                    let findings = self.findings(converged);
                    self.believed_findings(findings, converged, tried.imbalanced);
                }
                self.tried.push(*tried);
                if !tried.verdict.stands() {
                    self.equilibrium.restore();
                    let counts = u32::from(tried.verdict == AttemptVerdict::Refused);
                    cutbacks += counts;
                    self.equilibrium.memory.statistics.cutbacks += u64::from(counts);
                    continue;
                }
                match attempt {
                    Ok(converged) => {
                        step_time += tried.time;
                        progress = run.progress_of(&converged.end.drives);
                        let directive = self.stands(converged, context, cutbacks, observer)?;
                        if directive != Directive::GoOn {
                            return Ok(directive);
                        }
                        cutbacks = 0;
                    }
                    Err(_) if self.is_stopped() => return Ok(Directive::EndRun),
                    Err(trouble) => {
                        let reason =
                            format!("{} (the increment is a recorded one, which is repeated as it is)", trouble.reason);
                        let trouble = PointFailure { reason, fraction: None, ..trouble };
                        return Err(RunError::Failed { step: number, increment, progress, trouble });
                    }
                }
            }
        }
        Ok(Directive::GoOn)
    }
}
