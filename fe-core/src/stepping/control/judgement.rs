//! Whether an increment that converged may stand.

use super::{Dragged, Lead, Led, LoadHistory, StepRun};
use crate::assembly::{Location, PointFailure, Setback};
use crate::stepping::constants::{
    AIM, BREAK_RESOLUTION, CAUTIOUS, ENERGY_BUDGET, ENERGY_TOLERANCE, LARGEST_FALL, LARGEST_TURN, LEAST_FOR_OVERSTRESS,
    LEAST_SHARE, MAX_ENERGY_LOOKS, MAX_REFUSALS, PEAK_RESOLUTION, SMALLER, STABILISATION_BUDGET, THROUGH_DRAG,
};
use crate::stepping::newton::{Converged, Leader};

/// Quantities that a converged increment is judged by.
#[derive(Clone, Copy, Debug, Default)]
pub(in crate::stepping) struct Findings {
    /// |load| at its end.
    pub(in crate::stepping) load: f64,
    /// How much of what breaks it the wire carries that is nearest to breaking, before the increment and at its end.
    pub(in crate::stepping) wire_utilisations: [f64; 2],
    /// The largest growth of a contact point's slip, as a multiple of what is admissible.
    pub(in crate::stepping) slip_growth: f64,
    /// Whether the drive of the slip went where the load pulls.
    pub(in crate::stepping) pulls_on: bool,
    /// Whether the passes of a field left an unstable state.
    pub(in crate::stepping) field_departs: bool,
    /// Addition of the increment to the imbalance of the energies, and that imbalance before it, relative to the work.
    pub(in crate::stepping) energy_error: f64,
    pub(in crate::stepping) energy_error_before: f64,
    /// The work of the overstress of laws that extrapolate in the increment, and of all stabilisation before it, likewise.
    pub(in crate::stepping) overstress: f64,
    pub(in crate::stepping) stabilisation_before: f64,
    /// Whether the drives took energy back that was stored: elastic unloading.
    pub(in crate::stepping) gives_back: bool,
}

impl Findings {
    /// Returns how much the increment adds to the imbalance of energies, relative to the allowed amount.
    fn imbalance_excess(&self) -> f64 {
        let spent = self.energy_error_before * self.energy_error.signum() / ENERGY_BUDGET;
        self.energy_error.abs() / (ENERGY_TOLERANCE * share_left(spent))
    }

    /// Returns how much the increment spends on overstress, as a multiple of what it may.
    fn overstress_excess(&self) -> f64 {
        self.overstress / (ENERGY_TOLERANCE * share_left(self.stabilisation_before / STABILISATION_BUDGET))
    }
}

/// Returns which part of its usual share of a budget an increment may take when this part of the budget is spent.
fn share_left(spent: f64) -> f64 {
    (1.0 - spent).clamp(LEAST_SHARE, 1.0)
}

/// Why an increment that converged may not stand.
#[derive(Debug)]
pub(in crate::stepping) struct Judgement {
    pub(in crate::stepping) trouble: PointFailure,
    /// Whether it is worth no more than one that did not converge.
    pub(in crate::stepping) has_failed: bool,
}

impl StepRun {
    /// Whether a converged increment may stand; otherwise with which part of it to try again.
    pub(in crate::stepping) fn judge(
        &mut self,
        converged: &Converged,
        load: LoadHistory,
        findings: Findings,
    ) -> Result<(), Judgement> {
        if let Lead::Drag(_) = self.lead {
            return self.judge_through_drag(load, &findings);
        }
        if let Lead::Other(Led { by, .. }) = self.lead {
            let progress = self.progress_of(&converged.end.drives);
            if progress >= 1.0 {
                // the step's end lies within: go there
                self.lead = Lead::Drives;
                self.size.restart(1.0 - self.progress);
                return Err(repeat("the increment passes the end of the step", 1.0));
            }
            let turns = (progress - self.progress).abs() > LARGEST_TURN * self.last_progress.abs();
            if by == Leader::Dissipation && turns && !self.is_least() {
                return Err(failed("the drives leave the path of the last increments"));
            }
        }
        // a crack that grows does not unload, however brittle it is
        if matches!(self.lead, Lead::Other(Led { by: Leader::PointSlip | Leader::Dissipation, .. }))
            && findings.gives_back
        {
            return Err(failed(
                "the drives turn back, and what they take back was stored: the specimen unloads elastically",
            ));
        }
        let fall = (load.last - findings.load) / load.greatest;
        let jumps = match self.lead {
            Lead::Drives => {
                let may_jump = self.follows_slip || (self.follows_field && findings.field_departs);
                may_jump && !self.stabilised && findings.pulls_on && fall > LARGEST_FALL
            }
            Lead::Drag(_) => false,
            Lead::Other(_) => fall.abs() > LARGEST_FALL,
        };
        if jumps && load.greatest > load.noise && self.jumps_refused < MAX_REFUSALS && !self.is_least() {
            self.jumps_refused += 1;
            return Err(failed("the load jumps"));
        }
        if self.refuses_energies(&findings).is_some() {
            let excess = self.energy_excess(&findings);
            match self.missed {
                // the error of trapezoidal sums falls with the square of the size at least; one that falls more slowly than
                // with the root has another cause: contact that opens in the first increment
                Some([size, missed]) if excess > missed * (self.attempted / size).sqrt() => {
                    self.size.restart(size);
                }
                _ => {
                    self.energy_refused += 1;
                    self.missed = Some([self.attempted, excess]);
                    let fraction = excess.recip().sqrt().min(CAUTIOUS);
                    return Err(repeat("the energies of the increment do not balance", self.allowed(fraction)));
                }
            }
        }
        if self.is_least() {
            return Ok(());
        }
        let [before, end] = findings.wire_utilisations;
        if before < 1.0 && end > 1.0 + BREAK_RESOLUTION {
            let fraction = (1.0 + 0.5 * BREAK_RESOLUTION - before) / (end - before);
            return Err(repeat("a wire breaks within the increment", self.allowed(fraction)));
        }
        if !self.locates_peak || load.peaked {
            return Ok(());
        }
        if findings.slip_growth > 1.0 {
            return Err(repeat(
                "the slip of a contact point grows too fast to follow its law",
                self.allowed(AIM / findings.slip_growth),
            ));
        }
        if findings.load < load.greatest * (1.0 - PEAK_RESOLUTION) {
            return Err(repeat("the load has a peak within the increment", 0.5));
        }
        Ok(())
    }

    /// Whether a converged increment through drag may stand.
    fn judge_through_drag(&mut self, load: LoadHistory, findings: &Findings) -> Result<(), Judgement> {
        let limit = THROUGH_DRAG * load.last.max(THROUGH_DRAG * load.greatest);
        // what the drives pull through the drag adds to the load
        if findings.load - load.last > limit && self.attempted > self.size.minimum {
            self.attempted = (SMALLER * self.attempted).max(self.size.minimum);
            return Err(repeat("the drives go too far through drag", 1.0));
        }
        let falls = load.last - findings.load > limit;
        if (falls || self.refuses_energies(findings).is_some()) && !self.is_least() {
            self.energy_refused += 1;
            return Err(repeat("the specimen goes too fast through drag", SMALLER));
        }
        Ok(())
    }

    /// The size of an increment that is refused because its energies do not balance.
    pub(in crate::stepping) fn refuses_energies(&self, findings: &Findings) -> Option<f64> {
        let refuses = !self.size.fixed
            && self.misses_energies(findings)
            && self.energy_refused < MAX_REFUSALS
            && !self.is_least();
        refuses.then_some(self.attempted)
    }

    /// Returns whether an increment under the drives, or through drag, adds more to the imbalance of the energies than it may.
    fn misses_energies(&self, findings: &Findings) -> bool {
        !matches!(self.lead, Lead::Other(_)) && self.energy_excess(findings) > 1.0
    }

    /// Returns how much an increment adds to the imbalance of the energies, or spends on overstress, as a multiple of what it may.
    /// A snap-back costs its overstress in increments of any size; so it cuts them to some size only.
    fn energy_excess(&self, findings: &Findings) -> f64 {
        let cuts = matches!(self.lead, Lead::Drives) && self.attempted > LEAST_FOR_OVERSTRESS * self.size.maximum;
        let overstress = if cuts { findings.overstress_excess() } else { 0.0 };
        findings.imbalance_excess().max(overstress)
    }

    /// Bounds the increment after an accepted one, so that it need not be repeated for its energies.
    pub(super) fn foresee_energies(&mut self, findings: &Findings) {
        let excess = self.energy_excess(findings);
        // an increment accepted in spite of its energies is no measure
        if !self.size.fixed && excess > 0.0 && excess <= 1.0 {
            self.size.limit(self.attempted * AIM / excess.sqrt());
        }
    }

    /// A part of the attempted increment that is not below the least: what converged is no reason to fail.
    fn allowed(&self, fraction: f64) -> f64 {
        match self.lead {
            Lead::Drives => fraction.max(self.size.minimum / self.attempted),
            Lead::Other(_) | Lead::Drag(_) => fraction,
        }
    }

    /// Returns smaller repeats of the increment, which show whether its energies miss the work because of its size.
    /// They are needed where a step asks for equal increments, and so refuses none for their energies. Empty: the
    /// energies do not miss the work, or this was checked too often.
    pub(in crate::stepping) fn smaller_looks(&mut self, findings: &Findings) -> Vec<Self> {
        if !self.size.fixed || self.energy_looks == MAX_ENERGY_LOOKS || !self.misses_energies(findings) {
            return Vec::new();
        }
        self.energy_looks += 1;
        let part = |power| {
            let mut look = self.clone();
            look.size.cut(self.attempted, SMALLER.powi(power));
            look
        };
        vec![part(1), part(2)]
    }

    /// Returns whether a smaller increment is not allowed.
    pub(super) fn is_least(&self) -> bool {
        match self.lead {
            Lead::Drives => self.attempted * 0.5 < self.size.minimum,
            Lead::Other(led) => led.increment * 0.5 < led.least(),
            Lead::Drag(Dragged { resistance, greatest, .. }) => resistance * 2.0 > greatest,
        }
    }
}

pub(super) fn repeat(reason: &str, fraction: f64) -> Judgement {
    let trouble = Setback { reason: reason.into(), fraction: Some(fraction) }.at(Location::System);
    Judgement { trouble, has_failed: false }
}

fn failed(reason: &str) -> Judgement {
    Judgement { has_failed: true, ..repeat(reason, SMALLER) }
}
