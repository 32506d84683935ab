//! Where the next increment leads, and what becomes of it.
//!
//! A step goes from progress 0 to 1 on the line between the drives' values at its start and its end. Increments follow
//! the drives; where these would have to turn back (snap-back), the mean contact slip leads and the drives follow,
//! until they advance again.
//!
//! Until the load has peaked no contact point's slip may grow by more than the law's elastic limit or half of its
//! largest slip so far in one increment, and the peak itself is bisected, so that neither depends on the sizes asked for.

use super::newton::{Committed, Converged, Target};
use super::size::{EASY, GROWTH, IncrementSize};
use crate::assembly::{Place, Trouble};
use crate::model::{Model, Step};

/// The load of neighbours of the peak differs by less than this part of it.
const PEAK_RESOLUTION: f64 = 2e-3;
/// After as many failures in a row the mean slip leads.
const FAILURES_BEFORE_SLIP_CONTROL: u32 = 4;
/// The first increment under slip control, as part of the last under the drives.
const FIRST_SLIP: f64 = 0.5;
/// Slip increments shrink to this part of the first.
const LEAST_SLIP: f64 = 1e-6;
/// After as many increments in a row under slip control in which the drives advanced, they lead again,
const ADVANCES_BEFORE_DRIVE_CONTROL: u32 = 5;
/// if increments have grown to this part of the largest under the drives: shorter ones would only be cut again.
const RECOVERED: f64 = 0.5;
/// Aim a little below the greatest admissible slip.
const SLIP_MARGIN: f64 = 0.9;
/// No single judgement makes an increment smaller than this part.
const LEAST_FRACTION: f64 = 0.05;

/// What leads.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Lead {
    Drives,
    Slip { increment: f64, first: f64, advances: u32, easy: bool },
}

/// What a rejected increment means for the run.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Advance {
    /// It is repeated, smaller or otherwise led.
    Repeated,
    /// Nothing smaller is allowed.
    Failed,
}

/// What is known of the load so far.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct LoadHistory {
    pub(super) greatest: f64,
    pub(super) peaked: bool,
}

/// What an increment that converged is judged by.
#[derive(Clone, Copy, Debug)]
pub(super) struct Findings {
    /// |load| at its end.
    pub(super) load: f64,
    /// The largest growth of a contact point's slip, as a multiple of what is admissible.
    pub(super) slip_growth: f64,
}

/// A step under way.
#[derive(Clone, Debug)]
pub(super) struct StepRun {
    start: Vec<f64>,
    end: Vec<f64>,
    duration: f64,
    progress: f64,
    size: IncrementSize,
    lead: Lead,
    /// Progress that the present attempt aims at.
    attempted: f64,
    failures: u32,
    last_progress: f64,
    last_slip: f64,
    /// The largest increment of the mean slip under the drives.
    largest_slip: f64,
    follows_slip: bool,
    locates_peak: bool,
}

impl StepRun {
    pub(super) fn new(step: &Step, drives: &[f64], model: &Model) -> Self {
        let end = step.targets.iter().zip(drives).map(|(target, now)| target.unwrap_or(*now)).collect();
        let size = IncrementSize::new(step.control);
        Self {
            start: drives.to_vec(),
            end,
            duration: step.time,
            progress: 0.0,
            size,
            lead: Lead::Drives,
            attempted: size.next(1.0),
            failures: 0,
            last_progress: 0.0,
            last_slip: 0.0,
            largest_slip: 0.0,
            follows_slip: !model.contacts.is_empty(),
            locates_peak: model.controls.locate_peak && !model.contacts.is_empty(),
        }
    }

    pub(super) fn is_done(&self) -> bool {
        self.progress >= 1.0
    }

    /// From 0 to 1.
    pub(super) fn progress(&self) -> f64 {
        self.progress
    }

    /// Where the next attempt leads.
    pub(super) fn target(&mut self, committed: &Committed) -> Target {
        match self.lead {
            Lead::Drives => {
                let left = 1.0 - self.progress;
                self.attempted = self.size.next(left);
                Target::Drives(self.drives_at(if self.attempted == left {
                    1.0
                } else {
                    self.progress + self.attempted
                }))
            }
            Lead::Slip { increment, .. } => {
                Target::MeanSlip { mean_slip: committed.mean_slip + increment, direction: self.direction() }
            }
        }
    }

    /// Time that the next attempt takes; under slip control as long as the last increment.
    pub(super) fn time_increment(&self) -> f64 {
        let part = match self.lead {
            Lead::Drives => self.attempted,
            Lead::Slip { .. } => self.last_progress.abs().max(self.size.minimum()),
        };
        part * self.duration
    }

    fn direction(&self) -> Vec<f64> {
        self.end.iter().zip(&self.start).map(|(end, start)| end - start).collect()
    }

    fn drives_at(&self, progress: f64) -> Vec<f64> {
        if progress == 1.0 {
            return self.end.clone();
        }
        self.start.iter().zip(&self.end).map(|(start, end)| start + progress * (end - start)).collect()
    }

    fn progress_of(&self, drives: &[f64]) -> f64 {
        let direction = self.direction();
        let length: f64 = direction.iter().map(|d| d * d).sum();
        let along: f64 = drives.iter().zip(&self.start).zip(&direction).map(|((a, start), d)| (a - start) * d).sum();
        if length > 0.0 { along / length } else { 1.0 }
    }

    /// Whether a converged increment may stand; otherwise with which part of it to try again.
    pub(super) fn judge(
        &mut self,
        converged: &Converged,
        load: LoadHistory,
        findings: Findings,
    ) -> Result<(), Trouble> {
        if let Lead::Slip { .. } = self.lead
            && self.progress_of(&converged.end.drives) >= 1.0
        {
            // the step's end lies within: go there
            self.lead = Lead::Drives;
            self.size.restart(1.0 - self.progress);
            return Err(repeat("the increment passes the end of the step", 1.0));
        }
        if !self.locates_peak || load.peaked || self.is_least() {
            return Ok(());
        }
        if findings.slip_growth > 1.0 {
            let fraction = (SLIP_MARGIN / findings.slip_growth).max(LEAST_FRACTION);
            return Err(repeat("the slip of a contact point grows too fast to follow its law", fraction));
        }
        if findings.load < load.greatest * (1.0 - PEAK_RESOLUTION) {
            return Err(repeat("the load has a peak within the increment", 0.5));
        }
        Ok(())
    }

    /// Whether a smaller increment is not allowed.
    fn is_least(&self) -> bool {
        match self.lead {
            Lead::Drives => self.attempted * 0.5 < self.size.minimum(),
            Lead::Slip { increment, first, .. } => increment * 0.5 < first * LEAST_SLIP,
        }
    }

    /// Takes note of an accepted increment; its time.
    pub(super) fn accept(&mut self, start: &Committed, converged: &Converged, findings: Findings, peaked: bool) -> f64 {
        let time = self.time_increment();
        let iterations = converged.iterations.len();
        self.failures = 0;
        self.last_slip = converged.end.mean_slip - start.mean_slip;
        let before = self.progress;
        match &mut self.lead {
            Lead::Drives => {
                self.largest_slip = self.largest_slip.max(self.last_slip);
                let left = 1.0 - self.progress;
                self.progress = if self.attempted == left { 1.0 } else { self.progress + self.attempted };
                self.size.accepted(iterations);
                if self.locates_peak && !peaked && findings.slip_growth > 0.0 {
                    self.size.limit(self.attempted * SLIP_MARGIN / findings.slip_growth);
                }
                self.last_progress = self.progress - before;
            }
            Lead::Slip { .. } => {
                self.progress = self.progress_of(&converged.end.drives);
                self.last_progress = self.progress - before;
                self.after_slip_increment(iterations);
            }
        }
        time
    }

    fn after_slip_increment(&mut self, iterations: usize) {
        let largest = self.largest_slip;
        let Lead::Slip { increment, advances, easy, .. } = &mut self.lead else { return };
        let was_easy = iterations <= EASY;
        if was_easy && *easy {
            *increment = (*increment * GROWTH).min(largest);
        }
        *easy = was_easy;
        *advances = if self.last_progress > 0.0 { *advances + 1 } else { 0 };
        if *advances >= ADVANCES_BEFORE_DRIVE_CONTROL && *increment >= RECOVERED * largest {
            self.lead = Lead::Drives;
            self.size.restart(self.last_progress);
        }
    }

    /// An attempt failed or was judged too large.
    pub(super) fn reject(&mut self, trouble: &Trouble, converged: bool) -> Advance {
        let Some(fraction) = trouble.fraction else { return Advance::Failed };
        if fraction >= 1.0 {
            return Advance::Repeated;
        }
        self.failures = if converged { 0 } else { self.failures + 1 };
        match &mut self.lead {
            Lead::Drives => {
                let possible = self.size.cut(self.attempted, fraction);
                let slip_can_lead = self.follows_slip && self.last_slip > 0.0;
                if slip_can_lead && (self.failures >= FAILURES_BEFORE_SLIP_CONTROL || !possible) {
                    let first = FIRST_SLIP * self.last_slip;
                    self.lead = Lead::Slip { increment: first, first, advances: 0, easy: false };
                    self.failures = 0;
                    return Advance::Repeated;
                }
                if possible { Advance::Repeated } else { Advance::Failed }
            }
            Lead::Slip { increment, first, easy, .. } => {
                *increment *= fraction;
                *easy = false;
                if *increment >= *first * LEAST_SLIP { Advance::Repeated } else { Advance::Failed }
            }
        }
    }
}

fn repeat(reason: &str, fraction: f64) -> Trouble {
    Trouble { place: Place::System, reason: reason.into(), fraction: Some(fraction) }
}
