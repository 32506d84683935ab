//! An attempt parallel to one of another run ([`crate::stepping::Trail`]).

use super::turn::{Handed, Turn};
use super::{Attempt, Equilibrium, FREE_BODY, IncrementGoal, Leader, RoundEnd, largest, unsolvable};
use crate::assembly::PointFailure;
use crate::model::Model;
use crate::stepping::constants::{GROWTH_ROUNDING, NEGLIGIBLE, PARALLEL_ROUGH_REMAINDER, ROUNDINGS};
use crate::stepping::zone::Zone;
use std::sync::Arc;
use std::sync::atomic::AtomicBool;

/// State at the end of a round of iterations.
#[derive(Clone, Debug, Default)]
pub(in crate::stepping) struct Round {
    displacements: Vec<f64>,
    drives: Vec<f64>,
    /// Residual forces by rows of the equations, N.
    residual: Vec<f64>,
    /// Growth of the leading quantity in the increment so far; 0 where the drives lead.
    growth: f64,
    end: RoundEnd,
}

/// Rounds of an increment that stands, and the elements that iterated at its start.
#[derive(Clone, Debug, Default)]
pub(in crate::stepping) struct Guide {
    pub(super) zone: Option<Zone>,
    pub(in crate::stepping) rounds: Vec<Round>,
}

impl Guide {
    /// Returns whether its arrays have the lengths of an equilibrium of a model.
    pub(in crate::stepping) fn fits(&self, model: &Model) -> bool {
        let freedoms = 2 * model.mesh.nodes().len();
        self.zone.as_ref().is_some_and(|zone| zone.active.len() == model.mesh.elements().len())
            && self.rounds.iter().all(|round| round.displacements.len() == freedoms)
            && self.rounds.iter().all(|round| round.drives.len() == model.drives.len())
    }
}

/// The end of the present round in the other run.
#[derive(Clone, Debug, Default)]
pub(super) struct ParallelRound {
    residual: Vec<f64>,
    /// Goal of the leading quantity.
    pub(super) growth: f64,
    /// How the round ended there.
    pub(super) end: RoundEnd,
    /// Largest residual, N, and growth that are to be corrected at the start of the round. Known after the first evaluation.
    first: Option<[f64; 2]>,
}

impl ParallelRound {
    /// Takes the residual of the other run off.
    pub(super) fn take_off(&self, residual: &mut [f64]) {
        // the zones of the two may have grown apart
        if residual.len() == self.residual.len() {
            residual.iter_mut().zip(&self.residual).for_each(|(own, other)| *own -= other);
        }
    }

    /// Returns whether so little of residual and growth is left that the round is at its end. `rounding`: what residuals are known to, N;
    /// a difference of two may be far smaller, so that one correction is made all the same. `rough`: after a first one by the factor of
    /// another run.
    pub(super) fn is_reached(&mut self, residual: f64, growth: f64, rounding: f64, rough: bool) -> bool {
        let missing = (self.growth - growth).abs();
        let [left, least] = match self.first {
            None => [NEGLIGIBLE, 1.0 / ROUNDINGS],
            Some(_) if rough => PARALLEL_ROUGH_REMAINDER,
            Some(_) => [NEGLIGIBLE, 1.0],
        };
        let first = self.first.get_or_insert([residual, missing]);
        residual <= (left * first[0]).max(least * rounding)
            && missing <= (NEGLIGIBLE * first[1]).max(GROWTH_ROUNDING * self.growth.abs())
    }
}

/// Other runs and threads that a run has to do with.
#[derive(Default)]
pub(in crate::stepping) struct Company {
    /// Flag by which another thread asks for the end ([`crate::stepping::Analysis::stop_at`]).
    pub(in crate::stepping) stop: Option<Arc<AtomicBool>>,
    /// Whether the ways of attempts are kept.
    pub(in crate::stepping) keeps_rounds: bool,
    /// The end of the present round in the run parallel to which this one goes.
    pub(super) parallel: Option<ParallelRound>,
    /// Turn of this run among those that share factors.
    pub(in crate::stepping) turn: Option<Turn>,
    /// A factor that goes round among them.
    pub(super) handed: Option<Handed>,
}

impl Equilibrium<'_> {
    /// Takes the end of a round down, if they are kept.
    pub(super) fn keep_round(&self, attempt: &mut Attempt<'_>, end: RoundEnd) {
        if self.company.keeps_rounds {
            let growth = self.growth(attempt);
            attempt.kept.rounds.push(Round {
                displacements: attempt.trial.displacements.clone(),
                drives: attempt.trial.drives.clone(),
                residual: self.memory.residual.clone(),
                growth,
                end,
            });
        }
    }

    /// Returns how far the leading quantity has grown in the increment; 0 where the drives lead.
    pub(super) fn growth(&self, attempt: &Attempt<'_>) -> f64 {
        match attempt.target {
            IncrementGoal::Led { by: Leader::PointSlip, .. } => {
                self.leading.point.map_or(0.0, |(point, start)| self.contact.slip_of(point) - start)
            }
            IncrementGoal::Led { by: Leader::Dissipation, .. } => {
                self.solids.trial_dissipation() - attempt.start.dissipation
            }
            // a field leads in its passes
            IncrementGoal::Led { by: Leader::Field, .. } | IncrementGoal::Drives(_) | IncrementGoal::Through { .. } => {
                0.0
            }
        }
    }

    /// Takes an attempt to the beginning of a round parallel to the other run's, if there is one.
    pub(super) fn begin_parallel(&mut self, attempt: &mut Attempt<'_>, round: usize) -> Result<(), PointFailure> {
        self.company.parallel = None;
        let Some(lead) = attempt.lead else { return Ok(()) };
        if round == 0
            && let Some(zone) = lead.guide.zone.as_ref().filter(|zone| **zone != self.zone)
        {
            self.set_zone(zone.clone()).map_err(|error| unsolvable(&error, FREE_BODY))?;
        }
        let Some(end) = lead.guide.rounds.get(round) else { return Ok(()) };
        let before = if round == 0 { lead.before } else { lead.guide.rounds.get(round - 1) };
        let shift = |own: &mut [f64], end: &[f64], before: Option<&[f64]>| {
            for (k, (own, end)) in own.iter_mut().zip(end).enumerate() {
                *own += end - before.map_or(0.0, |before| before[k]);
            }
        };
        if round == 0
            && let IncrementGoal::Led { by: Leader::PointSlip, point: Some(point), .. } = attempt.target
            && self.contact.has(*point)
        {
            self.leading.point = Some((*point, self.contact.slip_of(*point)));
        }
        shift(&mut attempt.trial.displacements, &end.displacements, before.map(|round| &*round.displacements));
        shift(&mut attempt.trial.drives, &end.drives, before.map(|round| &*round.drives));
        if round == 0 {
            let largest_drive = largest(&attempt.trial.drives).max(largest(&end.drives));
            attempt.is_off = largest(&attempt.lacking()) > GROWTH_ROUNDING * largest_drive;
        }
        self.company.parallel =
            Some(ParallelRound { residual: end.residual.clone(), growth: end.growth, end: end.end, first: None });
        // the factor is of another state: with it corrections are many, and leave more than rounding
        self.memory.last_reduction = 1.0;
        self.take_turn([lead.at[0], lead.at[1], round as u32]);
        Ok(())
    }
}
