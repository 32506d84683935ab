//! The correction of an iteration, under direct and indirect control, and how much of it is applied.

use super::{
    Attempt, Committed, Equilibrium, FREE_BODY, FREE_FIELD, IncrementGoal, Leader, add_loads, largest, trouble,
    unsolvable,
};
use crate::assembly::{Location, PointFailure};
use crate::contact::PointIndex;
use crate::field::Correction;
use crate::model::IncrementContext;
use crate::stepping::constants::{
    CUT, LARGER, LEAST_OF_BRACKET, LEAST_PROBE, MINIMUM_REACHED, MOST_TRIALS, PATIENCE, PROBE, USUAL_ITERATIONS,
    WORK_REDUCTION,
};
use crate::stepping::line_search;
use crate::stepping::times::timed;
use umat_abi::law::Request;

/// Growth of the leading quantity in the increment, and its derivatives along the two parts of a correction.
#[derive(Clone, Copy, Debug, Default)]
struct Progress {
    so_far: f64,
    along_residual: f64,
    along_drives: f64,
}

/// How far the drives go that follow a field, along their line, and by how much a force changes with it, N.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Followed {
    pub(super) share: f64,
    pub(super) force: f64,
}

/// Correction of displacements and drives in one Newton iteration.
#[derive(Clone, Debug)]
pub(super) struct Direction {
    pub(super) displacements: Vec<f64>,
    pub(super) drives: Vec<f64>,
    /// That of the field, if it is solved together with the displacements.
    field: Vec<f64>,
}

impl Direction {
    /// Displaces a state by a part of the correction.
    fn place(&self, from: &[f64], length: f64, trial: &mut Committed) {
        for ((u, from), change) in trial.displacements.iter_mut().zip(from).zip(&self.displacements) {
            *u = from + length * change;
        }
    }

    fn plus(mut self, factor: f64, other: &Self) -> Self {
        self.displacements.iter_mut().zip(&other.displacements).for_each(|(a, b)| *a += factor * b);
        self.drives.iter_mut().zip(&other.drives).for_each(|(a, b)| *a += factor * b);
        self.field.iter_mut().zip(&other.field).for_each(|(a, b)| *a += factor * b);
        self
    }
}

impl Equilibrium<'_> {
    /// Returns the correction of this iteration.
    pub(super) fn direction(&mut self, attempt: &Attempt<'_>) -> Result<Direction, PointFailure> {
        let &Attempt { start, target, ref trial, .. } = attempt;
        let mut correction = self.memory.residual.clone();
        correction.extend(self.field_residual(&trial.drives));
        let predicts = attempt.predicts();
        let leads = matches!(target, IncrementGoal::Led { by: Leader::PointSlip | Leader::Dissipation, .. });
        let may_lack = !leads || (predicts && attempt.is_off);
        let drives = if may_lack { attempt.lacking() } else { vec![0.0; trial.drives.len()] };
        if predicts && may_lack {
            let change = self.drive_force(start, &drives);
            correction.iter_mut().zip(&change).for_each(|(c, f)| *c += f);
        }
        match target {
            // those that follow a field are found with it
            IncrementGoal::Drives(_) | IncrementGoal::Through { .. } | IncrementGoal::Led { by: Leader::Field, .. } => {
                self.solve(&mut correction)?;
                Ok(self.as_direction(&correction, drives))
            }
            IncrementGoal::Led { by, growth, direction, point } => {
                let mut along = self.drive_force(start, direction);
                self.solve(&mut correction)?;
                self.solve(&mut along)?;
                let from_residual = self.as_direction(&correction, drives);
                let from_drives = self.as_direction(&along, direction.clone());
                let progress = match by {
                    Leader::PointSlip => {
                        self.slip_progress(&from_residual, &from_drives, predicts && attempt.lead.is_none(), *point)
                    }
                    Leader::Dissipation => self.dissipation_progress(attempt, &from_residual, &from_drives)?,
                    Leader::Field => Progress::default(),
                };
                let growth = self.company.parallel.as_ref().map_or(*growth, |parallel| parallel.growth);
                let share = (growth - progress.so_far - progress.along_residual) / progress.along_drives;
                if !share.is_finite() {
                    let reason = "what leads does not follow the drives".into();
                    return Err(trouble(Location::System, reason, CUT));
                }
                Ok(from_residual.plus(share, &from_drives))
            }
        }
    }

    pub(super) fn solve(&mut self, right_side: &mut [f64]) -> Result<(), PointFailure> {
        self.memory.statistics.solutions += 1;
        let Self { system, field, observed, .. } = self;
        let solved = timed(&mut observed.times.solution, || match field {
            Some(field) if field.is_full() => field.solve_full(right_side),
            _ => system.solve(right_side),
        });
        solved.map_err(|error| unsolvable(&error, FREE_BODY))
    }

    /// Residual of a field that is solved together with the displacements; empty without one.
    pub(super) fn field_residual(&self, drives: &[f64]) -> Vec<f64> {
        let field = self.field.as_ref().filter(|field| field.is_full());
        field.map_or_else(Vec::new, |field| field.residual(drives, &self.solids))
    }

    /// Returns how far the leading point has slid; chosen where the increment starts.
    fn slip_progress(
        &mut self,
        from_residual: &Direction,
        from_drives: &Direction,
        predicts: bool,
        known: Option<PointIndex>,
    ) -> Progress {
        if predicts {
            let breaking = self.contact.breaking_point().or(self.leading.breaking.take());
            let leading = breaking.or_else(|| self.contact.fastest_point(&from_drives.displacements));
            let leading = known.filter(|point| self.contact.has(*point)).or(leading);
            self.leading.point = leading.map(|point| (point, self.contact.slip_of(point)));
        } else if let Some(point) = self.contact.breaking_point() {
            self.leading.breaking = Some(point);
        }
        self.leading.point.map_or(Progress::default(), |(point, start)| Progress {
            so_far: self.contact.slip_of(point) - start,
            along_residual: self.contact.slip_along(point, &from_residual.displacements),
            along_drives: self.contact.slip_along(point, &from_drives.displacements),
        })
    }

    /// The solids' dissipation and its derivatives along two corrections, by differences: a UMAT reports the energy, not
    /// its derivatives. The points' trial state is lost.
    fn dissipation_progress(
        &mut self,
        attempt: &Attempt<'_>,
        from_residual: &Direction,
        from_drives: &Direction,
    ) -> Result<Progress, PointFailure> {
        let (trial, context) = (&attempt.trial, attempt.context());
        // the last evaluation was of this trial state
        let now = self.solids.trial_dissipation();
        let probe = self.probe(trial);
        let mut slope = |along: &Direction| -> Result<f64, PointFailure> {
            let greatest = largest(&along.displacements);
            if greatest == 0.0 {
                return Ok(0.0);
            }
            let length = probe / greatest;
            let mut growth = |length: f64| -> Result<f64, PointFailure> {
                let probe = trial.displacements.iter().zip(&along.displacements).map(|(u, du)| u + length * du);
                Ok((self.dissipation_at(&probe.collect::<Vec<f64>>(), context)? - now) / length)
            };
            // At the start of an increment dissipation grows to one side only: to where the points load.
            let (ahead, back) = (growth(length)?, growth(-length)?);
            Ok(if ahead >= -back { ahead } else { back })
        };
        let so_far = now - attempt.start.dissipation;
        Ok(Progress { so_far, along_residual: slope(from_residual)?, along_drives: slope(from_drives)? })
    }

    /// Adds to a correction of a field that leads what the drives add that follow it. Their change with the field is that of the heat at
    /// displacements a little further along their line, which UMATs do not give by itself. The points' trial state is lost.
    pub(super) fn follow_field(
        &mut self,
        attempt: &Attempt<'_>,
        correction: &mut Correction,
    ) -> Result<Followed, PointFailure> {
        let IncrementGoal::Led { by: Leader::Field, direction, .. } = attempt.target else {
            return Ok(Followed::default());
        };
        let (trial, context) = (&attempt.trial, attempt.context());
        if !self.memory.factorised {
            self.factorise()?;
        }
        let mut along = self.drive_force(attempt.start, direction);
        self.solve(&mut along)?;
        let along = self.as_direction(&along, direction.clone());
        let mut length = self.probe(trial) / largest(&along.displacements);
        for _ in 0..MOST_TRIALS {
            let there = trial.displacements.iter().zip(&along.displacements).map(|(u, du)| u + length * du);
            let there: Vec<f64> = there.collect();
            let mut forces = vec![0.0; there.len()];
            let Self { solids, field: Some(field), observed, memory, .. } = self else { break };
            timed(&mut observed.times.solids, || solids.evaluate(&there, &context, Request::Stress, &mut forces))?;
            let response = field.response(correction, length, &trial.drives, solids);
            let response = response.map_err(|error| unsolvable(&error, FREE_FIELD))?;
            if response.iter().all(|by| *by <= 0.0) {
                // nothing loads so near: it has unloaded, or does not crack yet
                length *= LARGER;
                continue;
            }
            let share = field.lead(correction, &response);
            let internal = memory.internal.iter().zip(&memory.contact_forces).map(|(all, contact)| all - contact);
            let change = forces.iter().zip(internal).map(|(there, here)| (there - here).abs()).fold(0.0, f64::max);
            if share.is_finite() && change.is_finite() {
                return Ok(Followed { share, force: (share / length).abs() * change });
            }
            break;
        }
        Err(trouble(Location::System, "no crack follows the drives".into(), CUT))
    }

    /// Returns the greatest displacement in a step of differences at a trial state, mm.
    fn probe(&self, trial: &Committed) -> f64 {
        (PROBE * self.memory.last_move).max(LEAST_PROBE * largest(&trial.displacements))
    }

    fn dissipation_at(&mut self, displacements: &[f64], context: IncrementContext) -> Result<f64, PointFailure> {
        let mut forces = vec![0.0; displacements.len()];
        let Self { solids, observed, .. } = self;
        timed(&mut observed.times.solids, || solids.evaluate(displacements, &context, Request::Stress, &mut forces))?;
        Ok(self.solids.trial_dissipation())
    }

    /// Tᵀ(∂f_ext/∂a − ∂f_int/∂a − K S) d, with loads where the increment starts; interferences alone press by their drives. The same of a
    /// field that is solved together with the displacements follows.
    pub(super) fn drive_force(&self, start: &Committed, drives: &[f64]) -> Vec<f64> {
        let mut forces = self.system.drive_stiffness(&self.solids, drives);
        forces.iter_mut().for_each(|force| *force = -*force);
        let mut external = vec![0.0; start.displacements.len()];
        add_loads(self.model, &self.solids, drives, &start.displacements, &mut external, None);
        self.contact.add_drive_forces(drives, &mut external);
        let reduced = self.system.reduce(&external);
        forces.iter_mut().zip(&reduced).for_each(|(force, load)| *force += load);
        if let Some(field) = self.field.as_ref().filter(|field| field.is_full()) {
            let held = self.system.displacements(&vec![0.0; forces.len()], drives);
            forces.extend(field.drive_residual(drives, &held, &self.solids));
        }
        forces
    }

    fn as_direction(&self, unknowns: &[f64], drives: Vec<f64>) -> Direction {
        let (rows, field) = unknowns.split_at(self.system.row_count());
        Direction { displacements: self.system.displacements(rows, &drives), drives, field: field.to_vec() }
    }

    /// Applies a correction and evaluates; a shorter one if the residual grows. Returns which part of it was applied.
    pub(super) fn advance(&mut self, attempt: &mut Attempt<'_>, direction: &Direction) -> Result<f64, PointFailure> {
        let predicts = attempt.predicts();
        let from = attempt.trial.displacements.clone();
        let (before, work_before) = (largest(&self.memory.residual), self.work_along(direction));
        for (drive, change) in attempt.trial.drives.iter_mut().zip(&direction.drives) {
            *drive += change;
        }
        if self.company.parallel.is_none() {
            self.contact.predict_gaps(&direction.displacements, predicts);
        }
        direction.place(&from, 1.0, &mut attempt.trial);
        let is_full = self.is_full();
        if let Some(field) = self.field.as_mut().filter(|_| is_full) {
            field.advance_full(&direction.field, &attempt.trial.drives, &mut self.solids);
        }
        self.evaluate(attempt)?;
        let moves_drives = direction.drives.iter().any(|change| *change != 0.0);
        let full = largest(&self.memory.residual);
        let contact_changes = self.leading.changes > 0 && attempt.iterations.len() <= USUAL_ITERATIONS;
        if !self.model.controls.line_search || is_full || predicts || moves_drives || contact_changes || full <= before
        {
            return Ok(1.0);
        }
        let spreads = if self.model.contacts.is_empty() { WORK_REDUCTION } else { 0.0 };
        let limit = spreads * work_before.abs();
        if self.work_along(direction).abs() <= limit {
            return Ok(1.0);
        }
        if self.model.extrapolates() {
            return self.least_work(attempt, direction, &from, work_before);
        }
        let mut best = (full, 1.0);
        let mut last = 1.0;
        line_search::halved(0.5, PATIENCE, |length| {
            self.place(attempt, direction, &from, length)?;
            let residual = largest(&self.memory.residual);
            if residual < best.0 {
                best = (residual, length);
            }
            last = length;
            Ok(residual <= before || self.work_along(direction).abs() <= limit)
        })?;
        if best.1 != last {
            self.place(attempt, direction, &from, best.1)?;
        }
        Ok(best.1)
    }

    /// Displaces by a part of a correction and evaluates.
    fn place(
        &mut self,
        attempt: &mut Attempt<'_>,
        direction: &Direction,
        from: &[f64],
        length: f64,
    ) -> Result<(), PointFailure> {
        self.contact.set_predicted_part(length);
        direction.place(from, length, &mut attempt.trial);
        self.evaluate(attempt)
    }

    /// Applies the part of a correction that minimises the energy along it, starting from the full one, which passes
    /// the minimum. With extrapolating laws the energy is convex, with kinks where cracks close. Beyond these kinks the
    /// next tangent is the right one; short of them the same correction would be found again.
    fn least_work(
        &mut self,
        attempt: &mut Attempt<'_>,
        direction: &Direction,
        from: &[f64],
        work_before: f64,
    ) -> Result<f64, PointFailure> {
        // regula falsi in Illinois' form
        let (mut low, mut high) = ((0.0, work_before), (1.0, self.work_along(direction)));
        let mut length = 1.0;
        for _ in 0..MOST_TRIALS {
            if high.1 * work_before >= 0.0 || high.1.abs() <= MINIMUM_REACHED * work_before.abs() {
                break;
            }
            length = low.0 + (high.0 - low.0) * (low.1 / (low.1 - high.1)).max(LEAST_OF_BRACKET);
            self.place(attempt, direction, from, length)?;
            let work = self.work_along(direction);
            if work.abs() <= MINIMUM_REACHED * work_before.abs() {
                break;
            }
            if work * work_before > 0.0 {
                low = (length, work);
                high.1 *= 0.5;
            } else {
                high = (length, work);
                low.1 *= 0.5;
            }
        }
        Ok(length)
    }

    /// The work of the unbalanced forces along a correction, N mm: 0 where a shorter or longer one gains nothing.
    fn work_along(&self, direction: &Direction) -> f64 {
        let forces = self.memory.external.iter().zip(&self.memory.internal);
        forces.zip(&direction.displacements).map(|((external, internal), change)| (external - internal) * change).sum()
    }
}
