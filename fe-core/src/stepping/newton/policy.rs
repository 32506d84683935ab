//! Choice of the tangents and the factor of an iteration.

use super::{Attempt, Equilibrium, FREE_BODY, FREE_BODY_OR_FIELD, unsolvable};
use crate::assembly::solids::TangentChoice;
use crate::assembly::{PointFailure, touching};
use crate::field::Field;
use crate::solver::Symmetry;
use crate::stepping::constants::{
    FAST_REDUCTION, LINEAR_REDUCTION, PATIENCE, POSITION_ROUNDING, SLOW_REDUCTION, USUAL_ITERATIONS,
};
use crate::stepping::times::timed;

impl Equilibrium<'_> {
    /// Makes sure of a factor that is good enough: the last one while it converges fast, otherwise one of the present
    /// tangents, or of others where those did not help.
    pub(super) fn prepare_factor(&mut self, attempt: &Attempt<'_>) -> Result<(), PointFailure> {
        let done = attempt.round().len();
        // a safer stiffness of displacements alone leaves them out of step with the field
        let is_slow = self.memory.last_reduction > SLOW_REDUCTION && !self.is_full();
        let fallbacks = [(USUAL_ITERATIONS, TangentChoice::Frozen), (2 * USUAL_ITERATIONS, TangentChoice::Elastic)];
        if let Some((_, choice)) = fallbacks.into_iter().find(|(after, _)| is_slow && *after == done) {
            self.choose_tangents(choice);
        }
        let is_linear = self.memory.last_reduction > LINEAR_REDUCTION;
        if done == PATIENCE as usize && is_linear && self.solids.doubts_tangents() {
            self.judge_tangents(attempt)?;
        }
        if self.may_reuse_factor() {
            return Ok(());
        }
        self.hand_on();
        if !self.memory.has_tangents {
            self.evaluate(attempt)?;
        }
        self.factorise()
    }

    /// Compares tangents in doubt with differences; where they are far off, differences take their place.
    fn judge_tangents(&mut self, attempt: &Attempt<'_>) -> Result<(), PointFailure> {
        self.solids.compare_tangents();
        let compared = self.evaluate(attempt);
        if self.solids.judge_tangents() {
            self.memory.has_tangents = false;
            self.memory.last_reduction = 1.0;
        }
        compared
    }

    /// Makes the stiffness of elements that are out of balance safer: of all elements, back to the consistent one.
    pub(super) fn choose_tangents(&mut self, choice: TangentChoice) {
        if choice == TangentChoice::Consistent {
            for element in std::mem::take(&mut self.memory.fallen_back) {
                self.solids.set_tangent_choice(element, choice);
                self.memory.has_tangents = false;
            }
            return;
        }
        let limit = self.model.controls.force_tolerance * self.force_scale();
        let residual = &self.memory.residual;
        let unbalanced = (0..residual.len()).filter(|&row| residual[row].abs() > limit);
        let freedoms: Vec<usize> = unbalanced.map(|row| 2 * self.system.node_of_row(row)).collect();
        let both: Vec<usize> = freedoms.iter().flat_map(|&freedom| [freedom, freedom + 1]).collect();
        for (element, is_unbalanced) in touching(&self.model.mesh, &both).into_iter().enumerate() {
            if is_unbalanced && self.solids.softens(element) {
                self.solids.set_tangent_choice(element, choice);
                self.memory.fallen_back.push(element);
                self.memory.has_tangents = false;
                self.memory.last_reduction = 1.0;
            }
        }
    }

    /// Returns whether an old factor may be used. After a hard increment it would make the next one harder, because
    /// cracks change the stiffness. A factor of contact laws that were evaluated away from their gaps is used once.
    fn may_reuse_factor(&self) -> bool {
        let was_easy = self.memory.last_iterations <= USUAL_ITERATIONS;
        let is_known = self.memory.factorised && !self.memory.factor_is_elsewhere;
        let converges_fast = self.memory.last_reduction < FAST_REDUCTION;
        self.model.skipping.factor_reuse && was_easy && is_known && converges_fast && !self.is_full()
    }

    /// Makes sure that the next increment finds a factor or tangents. Those of the committed state by itself, in which
    /// nothing grows, would be of an unloading solid, and predict badly.
    pub(super) fn prepare_next(&mut self, attempt: &Attempt<'_>) -> Result<(), PointFailure> {
        if self.memory.has_tangents || self.may_reuse_factor() || self.company.parallel.is_some() {
            return Ok(());
        }
        self.evaluate(attempt)
    }

    /// Factorises the matrix, of which only what has changed since the last time is done again.
    pub(super) fn factorise(&mut self) -> Result<(), PointFailure> {
        let Self { model, solids, contact, field, system, memory, observed, .. } = self;
        let keep = model.skipping.unchanged_elements && memory.factorised;
        let elements_changed = !keep || solids.latest_version() != memory.assembled_version;
        timed(&mut observed.times.assembly, || {
            if elements_changed {
                system.assemble_elements(solids);
            }
            system.set_blocks(&memory.blocks);
        });
        let symmetry = if solids.symmetric() { Symmetry::Symmetric } else { Symmetry::Unsymmetric };
        memory.assembled_version = solids.latest_version();
        let statistics = &mut memory.statistics;
        *if elements_changed { &mut statistics.factorisations } else { &mut statistics.block_factorisations } += 1;
        let result = timed(&mut observed.times.factorisation, || match field {
            Some(field) if field.is_full() => field.factorise_full(system, solids, &model.mesh),
            _ => system.factorise(symmetry).map(drop),
        });
        let extent = model.mesh.nodes().as_flattened().iter().fold(0.0, |largest: f64, x| largest.max(x.abs()));
        memory.rounding = POSITION_ROUNDING * extent * system.largest_diagonal();
        // without time the factor of displacements alone is needed
        memory.factorised = result.is_ok() && !field.as_ref().is_some_and(Field::is_full);
        memory.factor_is_elsewhere = contact.is_elsewhere();
        let question = if field.as_ref().is_some_and(Field::is_full) { FREE_BODY_OR_FIELD } else { FREE_BODY };
        result.map_err(|error| unsolvable(&error, question))
    }
}
