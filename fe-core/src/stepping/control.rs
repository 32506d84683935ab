//! Where the next increment leads, and what follows from one that stands ([`judgement`] says which do) or does not.
//!
//! A step goes from progress 0 to 1 on the line between the drives' values at its start and its end. Increments follow
//! the drives; where these would have to turn back (snap-back), the contact point that slides fastest leads and the drives
//! follow, until they advance again. Where that does not help (an element that fails unloads all else), the dissipation of
//! the solids leads, or the phase field if there is one. Where nothing leads on, no equilibrium is near: the drives stand, and the specimen goes through a fluid that
//! drags at its contact to the next one.
//!
//! Automatic increments under the drives are repeated with less where their energies do not balance.
//!
//! Until the load has peaked no contact point's slip may grow by more than the law's elastic limit or half of its
//! largest slip so far in one increment, and the peak itself is bisected, so that neither depends on the sizes asked for.

use super::newton::{Committed, Converged, IncrementGoal, Leader, hardest_round};
use super::recorded::LeadingQuantity;
use super::size::IncrementSize;
use crate::assembly::PointFailure;
use crate::model::{Model, ScalarField, Step};
use crate::stepping::constants::{
    ADVANCES_BEFORE_DRIVE_CONTROL, AIM, CAUTIOUS, CRAWLING, CREEPING, EASING, EASY, FADING, FIELD_GROWTH, FIRST_LED,
    GREATEST_RESISTANCE, GROWTH, LARGER, LARGER_NUDGE, LARGEST_PART, LEADS, LEAST_LED, LIMIT_POINT, LOAD_CHANGE,
    MOST_THROUGH, MOST_TURNS, PATIENCE, RESISTANCE, THROUGH_DRAG,
};
use serde::{Deserialize, Serialize};

mod judgement;
#[cfg(test)]
mod test;

pub(super) use judgement::{Findings, Judgement};

/// The quantity that leads an increment.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
enum Lead {
    #[default]
    Drives,
    /// A slip or the dissipation grows by a given amount; the drives follow.
    Other(Led),
    /// The forces out of balance lead, held back by drag.
    Drag(Dragged),
}

/// Increments through drag: the first takes the drives a little on, in the others they stand.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
struct Dragged {
    /// Resistance at each freedom of contact, N/mm.
    resistance: f64,
    greatest: f64,
    increments: u32,
    /// How many of them went back on the way of the one before.
    turns: u32,
}

/// Increments of the quantity that leads instead of the drives.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
struct Led {
    by: Leader,
    increment: f64,
    first: f64,
    /// Number of increments in a row in which the drives advanced.
    advances: u32,
    /// Whether the last increment was easy.
    easy: bool,
}

impl Led {
    fn new(by: Leader, usual: f64) -> Self {
        let first = FIRST_LED * usual;
        Self { by, increment: first, first, advances: 0, easy: false }
    }

    fn least(&self) -> f64 {
        LEAST_LED * self.first
    }
}

/// Consequence of a rejected increment for the run.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Advance {
    /// The increment is repeated, smaller or with another lead.
    Repeated,
    /// The run fails: nothing smaller is allowed, and no other lead is left.
    Failed,
}

/// Load in the course of the run, N.
#[derive(Clone, Copy, Debug, Default, Serialize, Deserialize)]
pub(super) struct LoadHistory {
    pub(super) greatest: f64,
    pub(super) last: f64,
    /// Load that rounding makes of 0, N.
    pub(super) noise: f64,
    pub(super) peaked: bool,
}

/// A step under way.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
pub(super) struct StepRun {
    start: Vec<f64>,
    end: Vec<f64>,
    duration: f64,
    /// From 0 to 1.
    pub(super) progress: f64,
    size: IncrementSize,
    lead: Lead,
    /// Size of the present attempt.
    pub(super) attempted: f64,
    failures: u32,
    last_progress: f64,
    /// Growths in the last increments: of the drives, of the mean slip, of the solids' dissipation.
    usual_progress: f64,
    usual_slip: f64,
    usual_dissipation: f64,
    /// Quantity that led through the last snap-back.
    helped: Leader,
    /// Attempts at the present increment that were refused because the load jumps.
    jumps_refused: u32,
    /// and because its energies do not balance.
    energy_refused: u32,
    /// Size and excess of the last of these.
    missed: Option<[f64; 2]>,
    /// Equal increments of the step that were looked at in smaller ones because their energies do not balance.
    energy_looks: u32,
    /// The largest increment of the mean slip under the drives.
    largest_slip: f64,
    /// Load over slip of the last increments, N/mm.
    usual_stiffness: f64,
    /// Growth of the displacement that grows fastest over that of the progress, mm: of the last increment under the drives, with its
    /// freedom, and the least of the step.
    flexibility: f64,
    fastest: usize,
    least_flexibility: Option<f64>,
    /// Leads that were tried since an increment stood.
    changes: u32,
    /// Equilibria that drag has led to since the drives led to one.
    nudges: u32,
    follows_slip: bool,
    /// Whether a phase field may lead.
    follows_field: bool,
    stabilised: bool,
    /// Whether the stabilisation is that of laws that extrapolate: their points are led well by nothing but the drives.
    extrapolates: bool,
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
            size,
            attempted: size.next(1.0),
            follows_slip: !model.contacts.is_empty(),
            follows_field: model.field.as_ref().is_some_and(ScalarField::may_lead),
            stabilised: model.controls.relaxation_time > 0.0 || model.extrapolates(),
            extrapolates: model.extrapolates(),
            locates_peak: model.controls.locate_peak && !model.contacts.is_empty(),
            ..Self::default()
        }
    }

    pub(super) fn is_done(&self) -> bool {
        self.progress >= 1.0
    }

    /// Returns where the next attempt leads.
    pub(super) fn target(&mut self) -> IncrementGoal {
        match self.lead {
            Lead::Drives => {
                self.attempted = self.size.next(1.0 - self.progress);
                IncrementGoal::Drives(self.drives_at(self.aim()))
            }
            Lead::Other(Led { by, increment, .. }) => {
                IncrementGoal::Led { by, growth: increment, direction: self.direction(), point: None }
            }
            Lead::Drag(Dragged { resistance, .. }) => {
                IncrementGoal::Through { goal: self.drives_at(self.aim()), resistance }
            }
        }
    }

    /// The progress that the present attempt leads to under the drives.
    fn aim(&self) -> f64 {
        if self.attempted == 1.0 - self.progress { 1.0 } else { self.progress + self.attempted }
    }

    /// Returns where the present attempt leads; `leading`: the contact point that leads, if one does.
    pub(super) fn way(&self, leading: Option<[usize; 2]>) -> LeadingQuantity {
        match self.lead {
            Lead::Drives => LeadingQuantity::Drives(self.aim()),
            Lead::Other(Led { by: Leader::PointSlip, increment, .. }) => {
                LeadingQuantity::Slip { growth: increment, point: leading }
            }
            Lead::Other(Led { by: Leader::Dissipation, increment, .. }) => LeadingQuantity::Dissipation(increment),
            Lead::Other(Led { by: Leader::Field, increment, .. }) => LeadingQuantity::Field(increment),
            Lead::Drag(Dragged { resistance, .. }) => LeadingQuantity::Through { to: self.aim(), resistance },
        }
    }

    /// Time that the next attempt takes: the part of the time left that it is of the progress left, under another lead what
    /// the last increment was of it. So a step takes its time and no more, whatever leads how often, and what depends on
    /// time (temperature, field variables) reaches the step's end with it.
    pub(super) fn time_increment(&self, step_time: f64) -> f64 {
        let left = 1.0 - self.progress;
        let part = match self.lead {
            Lead::Drives => self.attempted / left,
            Lead::Other(_) | Lead::Drag(_) => {
                (self.last_progress.abs().max(self.size.minimum) / left).min(LARGEST_PART)
            }
        };
        part * (self.duration - step_time)
    }

    pub(super) fn direction(&self) -> Vec<f64> {
        self.end.iter().zip(&self.start).map(|(end, start)| end - start).collect()
    }

    pub(super) fn drives_at(&self, progress: f64) -> Vec<f64> {
        if progress == 1.0 {
            return self.end.clone();
        }
        self.start.iter().zip(&self.end).map(|(start, end)| start + progress * (end - start)).collect()
    }

    pub(super) fn progress_of(&self, drives: &[f64]) -> f64 {
        let direction = self.direction();
        let length: f64 = direction.iter().map(|d| d * d).sum();
        let along: f64 = drives.iter().zip(&self.start).zip(&direction).map(|((a, start), d)| (a - start) * d).sum();
        if length > 0.0 { along / length } else { 1.0 }
    }

    /// Takes note of an accepted increment.
    pub(super) fn accept(&mut self, start: &Committed, converged: &Converged, findings: Findings, load: LoadHistory) {
        self.jumps_refused = 0;
        self.energy_refused = 0;
        self.missed = None;
        let iterations = converged.iterations.len();
        self.failures = 0;
        self.changes = 0;
        let slip = converged.end.mean_slip - start.mean_slip;
        if let Lead::Drag(dragged) = &mut self.lead {
            dragged.increments += 1;
            // between two states to and fro, it was too thin to be led by what is out of balance
            dragged.turns += u32::from(converged.turns);
            dragged.resistance *= match converged.turns {
                true => LARGER,
                false if iterations <= EASY => EASING,
                false => CAUTIOUS,
            };
            let is_there = converged.drag <= 1.0 || dragged.turns >= MOST_TURNS;
            self.progress = self.aim();
            self.attempted = 0.0;
            if is_there {
                self.nudges += 1;
                self.lead = Lead::Drives;
                self.size.restart(self.usual_progress);
            }
            return;
        }
        self.usual_slip = slip.max(FADING * self.usual_slip);
        self.usual_dissipation = (converged.end.dissipation - start.dissipation).max(FADING * self.usual_dissipation);
        let (before, greatest) = (self.progress, load.greatest);
        match &mut self.lead {
            Lead::Drives => {
                self.largest_slip = self.largest_slip.max(slip);
                self.note_flexibility(start, &converged.end);
                self.progress = self.aim();
                self.size.accepted(iterations, hardest_round(&converged.iterations));
                if self.locates_peak && !load.peaked && findings.slip_growth > 0.0 {
                    self.size.limit(self.attempted * AIM / findings.slip_growth);
                }
                self.foresee_energies(&findings);
                self.nudges = 0;
                self.last_progress = self.progress - before;
                self.usual_progress = self.last_progress.max(FADING * self.usual_progress);
            }
            Lead::Other(led) => {
                self.helped = led.by;
                self.progress = self.progress_of(&converged.end.drives);
                self.last_progress = self.progress - before;
                let iterations = match self.helped {
                    // each pass takes some
                    Leader::Field => hardest_round(&converged.iterations),
                    Leader::PointSlip | Leader::Dissipation => iterations,
                };
                self.after_led_increment(iterations, [load.last, findings.load].map(|load| load / greatest));
            }
            Lead::Drag(_) => {}
        }
        if self.usual_slip > 0.0 {
            self.usual_stiffness = load.last / self.usual_slip;
        }
    }

    /// Takes note of how fast displacements grow with the drives.
    fn note_flexibility(&mut self, start: &Committed, end: &Committed) {
        let changes = end.displacements.iter().zip(&start.displacements).map(|(end, start)| (end - start).abs());
        let Some((freedom, change)) = changes.enumerate().max_by(|(_, a), (_, b)| a.total_cmp(b)) else { return };
        (self.fastest, self.flexibility) = (freedom, change / self.attempted);
        self.least_flexibility =
            Some(self.least_flexibility.map_or(self.flexibility, |least| least.min(self.flexibility)));
    }

    /// The freedom whose displacement grows fastest with the drives, and how many times as fast as the fastest did in the step, if
    /// this is a limit point.
    pub(super) fn limit_point(&self) -> Option<(usize, f64)> {
        let ratio = self.flexibility / self.least_flexibility?;
        (ratio > LIMIT_POINT).then_some((self.fastest, ratio))
    }

    /// `loads`: before it and after it, as parts of the greatest.
    fn after_led_increment(&mut self, iterations: usize, loads: [f64; 2]) {
        let largest_slip = self.largest_slip;
        let load_change = (loads[1] - loads[0]).abs();
        let Lead::Other(led) = &mut self.lead else { return };
        let (was_easy, largest, recovered) = match led.by {
            Leader::PointSlip => (iterations <= EASY, largest_slip, led.increment >= FIRST_LED * largest_slip),
            Leader::Dissipation | Leader::Field => {
                if load_change > 2.0 * LOAD_CHANGE {
                    led.increment *= LOAD_CHANGE / load_change;
                }
                let largest = if led.by == Leader::Field { LARGEST_PART } else { f64::INFINITY };
                (iterations <= EASY && load_change < LOAD_CHANGE, largest, true)
            }
        };
        if was_easy && led.easy {
            led.increment = (led.increment * GROWTH).min(largest);
        }
        led.easy = was_easy;
        led.advances = if self.last_progress > 0.0 { led.advances + 1 } else { 0 };
        let is_broken = led.by == Leader::Field && loads[1] <= LOAD_CHANGE;
        if (led.advances >= ADVANCES_BEFORE_DRIVE_CONTROL && recovered) || is_broken {
            self.drives_lead_again();
        }
    }

    /// Lets the drives lead again, with increments as they were.
    fn drives_lead_again(&mut self) {
        self.lead = Lead::Drives;
        self.size.restart(if self.last_progress > 0.0 { self.last_progress } else { self.usual_progress });
    }

    /// An attempt failed or was judged too large.
    pub(super) fn reject(&mut self, trouble: &PointFailure, has_failed: bool) -> Advance {
        let Some(fraction) = trouble.fraction else { return Advance::Failed };
        if fraction >= 1.0 {
            return Advance::Repeated;
        }
        self.failures = if has_failed { self.failures + 1 } else { 0 };
        let (possible, creeps, crawls) = match &mut self.lead {
            Lead::Drives => {
                let possible = self.size.cut(self.attempted, fraction);
                let is_small = self.attempted * fraction < CREEPING * self.usual_progress;
                // stabilised solids may creep for a while
                let crawls = self.follows_slip && self.attempted * fraction < CRAWLING * self.size.maximum;
                (possible, is_small && has_failed && !self.stabilised, crawls && has_failed)
            }
            Lead::Other(led) => {
                led.increment *= fraction;
                led.easy = false;
                (led.increment >= led.least(), false, false)
            }
            Lead::Drag(dragged) => {
                dragged.resistance /= fraction;
                let possible = dragged.resistance <= dragged.greatest && dragged.increments < MOST_THROUGH;
                return if possible { Advance::Repeated } else { Advance::Failed };
            }
        };
        if self.failures < PATIENCE && possible && !creeps && !crawls {
            return Advance::Repeated;
        }
        let next = self.next_lead();
        let have_all_failed = self.changes >= LEADS || (next.is_none() && (crawls || !possible));
        let next = if have_all_failed { self.drag().or(next) } else { next };
        match next {
            Some(next) => {
                self.changes += 1;
                self.lead = next;
                if next == Lead::Drives {
                    self.drives_lead_again();
                }
                self.failures = 0;
                Advance::Repeated
            }
            None if possible => Advance::Repeated,
            None => Advance::Failed,
        }
    }

    /// Returns drag as what leads: no equilibrium is near.
    fn drag(&mut self) -> Option<Lead> {
        let nudge = THROUGH_DRAG * LARGER_NUDGE.powi(self.nudges.min(10).cast_signed());
        let resistance = RESISTANCE * self.usual_stiffness / nudge;
        let may_lead = self.follows_slip && self.usual_progress > 0.0 && resistance > 0.0 && resistance.is_finite();
        may_lead.then(|| {
            self.attempted =
                (nudge * self.usual_progress).max(self.size.minimum).min(LARGEST_PART * (1.0 - self.progress));
            Lead::Drag(Dragged { resistance, greatest: GREATEST_RESISTANCE * resistance, increments: 0, turns: 0 })
        })
    }

    /// Returns what may lead where the present lead fails: what helped last time first. With stabilisation the drives lead while they
    /// can, since what would snap back in the solids takes its time instead; the contact of a fibre that leaves has no
    /// viscosity, and then its slip leads. Laws that extrapolate are led by the drives alone.
    fn next_lead(&self) -> Option<Lead> {
        let led = |by, growth: f64| (growth > 0.0).then(|| Lead::Other(Led::new(by, growth)));
        let slip = || led(Leader::PointSlip, if self.follows_slip { self.usual_slip } else { 0.0 });
        let dissipation = || match self.follows_field {
            // once the drives have led
            true => led(Leader::Field, if self.usual_progress > 0.0 { FIELD_GROWTH } else { 0.0 }),
            false => led(Leader::Dissipation, self.usual_dissipation),
        };
        match self.lead {
            Lead::Drives if self.extrapolates => None,
            Lead::Drives if self.stabilised => slip(),
            Lead::Other(_) if self.stabilised => (self.last_progress > 0.0).then_some(Lead::Drives),
            Lead::Drives if self.helped != Leader::PointSlip => dissipation().or_else(slip),
            Lead::Drives => slip().or_else(dissipation),
            Lead::Other(Led { by: Leader::PointSlip, .. }) => dissipation(),
            // Where all that can fail has failed, nothing dissipates until the drives have advanced.
            Lead::Other(Led { by: Leader::Dissipation, .. }) => (self.last_progress > 0.0).then_some(Lead::Drives),
            // a crack that is open grows no more
            Lead::Other(Led { by: Leader::Field, .. }) => Some(Lead::Drives),
            Lead::Drag(_) => None,
        }
    }
}
