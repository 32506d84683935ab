//! The iterations of a round, and when they end.

use super::{Attempt, Equilibrium, Iteration, RoundEnd, largest, largest_difference, trouble};
use crate::assembly::solids::TangentChoice;
use crate::assembly::{Location, PointFailure};
use crate::stepping::constants::{CUT, FAST_REDUCTION, LEAST_RELATIVE_MOVE, NEAR, NEGLIGIBLE, PATIENCE};

/// Returns how many iterations the round that took most of them has: how hard an increment was. The rounds in which contact settles say
/// nothing of its size, which would shrink without end where each increment needs some of them.
pub(in crate::stepping) fn hardest_round(iterations: &[Iteration]) -> usize {
    iterations.chunk_by(|_, next| !next.begins_round).map(<[Iteration]>::len).max().unwrap_or(0)
}

impl Equilibrium<'_> {
    /// Iterates by Newton's method from the present evaluation until the residual is small, or multipliers are to be updated.
    pub(super) fn newton(&mut self, attempt: &mut Attempt<'_>) -> Result<RoundEnd, PointFailure> {
        if attempt.updated.is_none_or(|updated| updated < attempt.iterations.len()) {
            attempt.before = attempt.iterations.len();
            self.choose_tangents(TangentChoice::Consistent);
        }
        let mut growing = 0;
        loop {
            if self.is_stopped() {
                return Err(trouble(Location::System, "the run was asked to end".into(), CUT));
            }
            let residual = largest(&self.memory.residual);
            let scale = self.force_scale();
            let predicts = attempt.predicts();
            // After a settlement the drives are where they should be, and the increment may be in equilibrium already.
            if !predicts && self.is_converged(attempt, residual, scale) {
                if !self.contact.is_elsewhere() {
                    return Ok(self.company.parallel.as_ref().map_or(RoundEnd::Balanced, |parallel| parallel.end));
                }
                // equilibrium with what the laws say elsewhere is none
                self.contact.end_prediction();
                self.evaluate(attempt)?;
                continue;
            }
            if self.may_update(attempt, residual, scale) {
                attempt.updated = Some(attempt.iterations.len());
                return Ok(RoundEnd::Near);
            }
            if attempt.round().len() >= self.model.controls.max_iterations || growing >= PATIENCE {
                return Err(self.not_converged(attempt, residual, scale));
            }
            self.memory.statistics.iterations += 1;
            self.prepare_factor(attempt)?;
            let direction = self.direction(attempt)?;
            let step_length = self.advance(attempt, &direction)?;
            let after = largest(&self.memory.residual);
            let field_after = largest(&self.field_residual(&attempt.trial.drives));
            let (begins_round, flips) = (attempt.round().is_empty(), self.flips());
            self.memory.last_reduction = if predicts { 1.0 } else { after / residual };
            growing = if !predicts && after > residual { growing + 1 } else { 0 };
            attempt.follows = false;
            attempt.iterations.push(Iteration {
                residual: after,
                field_residual: field_after,
                scale: self.force_scale(),
                correction: step_length * largest(&direction.displacements),
                step_length,
                begins_round,
                flips,
            });
        }
    }

    /// Returns the greatest residual of an equilibrium, N.
    pub(super) fn tolerance(&self, scale: f64) -> f64 {
        (self.model.controls.force_tolerance * scale).max(self.memory.rounding)
    }

    /// Returns whether multipliers are updated before the next iteration: once after each one that is no predictor. Next to another run they are updated
    /// where they were there.
    fn may_update(&self, attempt: &Attempt<'_>, residual: f64, scale: f64) -> bool {
        attempt.iterations.len() > attempt.updated.unwrap_or(1)
            && residual <= NEAR * scale
            && self.company.parallel.is_none()
            && !self.contact.is_elsewhere()
            && self.contact.wants_multipliers()
    }

    fn is_converged(&mut self, attempt: &Attempt<'_>, residual: f64, scale: f64) -> bool {
        let growth = self.growth(attempt);
        let rough = attempt.round().len() == 1 && self.needs_no_tangents();
        if let Some(parallel) = &mut self.company.parallel {
            return parallel.is_reached(residual, growth, self.memory.rounding, rough);
        }
        let tolerance = self.tolerance(scale);
        let displacements = &attempt.trial.displacements;
        let moved = largest_difference(displacements, &attempt.start.displacements);
        let moved = moved.max(LEAST_RELATIVE_MOVE * largest(displacements));
        // where residuals fall fast corrections do, too
        let reduction = self.memory.last_reduction;
        // through drag, where nothing but drag may hold the specimen, small residuals leave more to correct than that
        let left = if reduction < FAST_REDUCTION && attempt.resistance() == 0.0 { reduction } else { 1.0 };
        let is_small = |last: &Iteration| left * last.correction <= self.model.controls.displacement_tolerance * moved;
        let is_balanced = residual <= (NEGLIGIBLE * tolerance).max(self.memory.rounding)
            || (residual <= tolerance && attempt.round().last().is_none_or(is_small));
        is_balanced && (!self.is_full() || self.field_holds(attempt))
    }

    /// Returns whether the last factor makes no correction of a field, solved together with the displacements, of what is left. After a
    /// prediction by the tangents of another state its last correction says nothing.
    fn field_holds(&mut self, attempt: &Attempt<'_>) -> bool {
        let mut left = self.memory.residual.clone();
        let rows = left.len();
        left.extend(self.field_residual(&attempt.trial.drives));
        let is_solved = self.solve(&mut left).is_ok();
        is_solved && self.field.as_ref().is_none_or(|field| field.tolerates(&left[rows..]))
    }

    /// Names the node with the largest residual.
    fn not_converged(&self, attempt: &Attempt<'_>, residual: f64, scale: f64) -> PointFailure {
        let forces = &self.memory.residual;
        let row = (0..forces.len()).max_by(|a, b| forces[*a].abs().total_cmp(&forces[*b].abs()));
        let place = row.map_or(Location::System, |row| {
            let node = self.system.node_of_row(row);
            Location::Node { node, position: self.model.mesh.nodes()[node] }
        });
        let reason = format!(
            "no equilibrium after {} iterations: residual {residual:.3e} N against a force scale of {scale:.3e} N",
            attempt.round().len()
        );
        trouble(place, reason, CUT)
    }
}
