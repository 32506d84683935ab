//! The iterations: when they end, which factor and which tangents serve.

use super::{
    CUT, Committed, Equilibrium, Iteration, Target, iteration_number, largest, largest_difference, trouble, unsolvable,
};
use crate::assembly::solids::TangentChoice;
use crate::assembly::{IncrementContext, Place, Trouble, touching};
use crate::solver::Symmetry;
use crate::stepping::Statistics;
use crate::stepping::times::timed;
use umat_abi::law::Request;

/// A residual so far below its tolerance needs no small correction to prove convergence: linear problems end at once.
const NEGLIGIBLE_RESIDUAL: f64 = 1e-4;
/// Corrections are compared with the increment's displacements, or with this part of all so far: a tiny increment
/// after many cuts needs no finer ones than the state that it starts from.
const LEAST_RELATIVE_MOVE: f64 = 1e-2;
/// After how many iterations the stiffness of damaging elements out of balance becomes safer (doc.md). That of plastic
/// ones is safe, and the elastic one far too stiff where flow spreads.
const FALLBACKS: [(usize, TangentChoice); 2] = [(6, TangentChoice::Frozen), (12, TangentChoice::Elastic)];
/// A residual that falls faster than this needs no safer stiffness.
const SLOW_REDUCTION: f64 = 0.5;
/// Iterations that still converge as slowly as this after as many put tangents in doubt: Newton's method squares what is
/// left.
const LINEAR_REDUCTION: f64 = 0.1;
const BEFORE_DOUBT: usize = 4;
/// A factor that made the residual smaller by this serves again.
const FAST_REDUCTION: f64 = 0.05;
/// Only while increments need at most so many iterations.
const EASY_WITH_OLD_FACTORS: usize = 6;
/// Positions are known to a few units of their last place.
const POSITION_ROUNDING: f64 = 4.0 * f64::EPSILON;
/// Residuals that grow as often in a row, after as many iterations, diverge.
const DIVERGENCE: usize = 4;

impl Equilibrium<'_> {
    /// Newton's iterations until the residual is small, from the present evaluation.
    pub(super) fn newton(
        &mut self,
        start: &Committed,
        trial: &mut Committed,
        target: &Target,
        context: IncrementContext,
        done: usize,
        statistics: &mut Statistics,
    ) -> Result<Vec<Iteration>, Trouble> {
        let controls = &self.model.controls;
        let mut history: Vec<Iteration> = Vec::new();
        // After a settlement the drives are where they should be, and the increment may be in equilibrium already.
        let mut pending = done == 0;
        let mut growing = 0;
        self.choose_tangents(TangentChoice::Consistent);
        loop {
            let residual = largest(&self.residual);
            let scale = self.force_scale();
            if !pending && self.is_converged(residual, scale, history.last(), start, trial) {
                if !self.contact.is_elsewhere() {
                    return Ok(history);
                }
                // equilibrium with what the laws say elsewhere is none
                self.contact.foretell_nothing();
                self.evaluate(trial, context, Request::StressAndTangent, statistics)?;
                continue;
            }
            if history.len() >= controls.max_iterations || growing >= DIVERGENCE {
                return Err(self.not_converged(residual, scale, history.len()));
            }
            statistics.iterations += 1;
            let is_slow = self.last_reduction > SLOW_REDUCTION;
            if let Some((_, choice)) = FALLBACKS.iter().find(|(after, _)| is_slow && *after == history.len()) {
                self.choose_tangents(*choice);
            }
            let context = IncrementContext { iteration: iteration_number(done + history.len()), ..context };
            if history.len() == BEFORE_DOUBT && self.last_reduction > LINEAR_REDUCTION && self.solids.doubts_tangents()
            {
                self.judge_tangents(trial, context, statistics)?;
            }
            self.prepare_factor(trial, context, statistics)?;
            let direction = self.direction(start, trial, target, (pending, context), statistics)?;
            let request = if pending { Request::StressAndTangent } else { self.request_after() };
            let step_length = self.advance(trial, &direction, context, (pending, residual, request), statistics)?;
            let after = largest(&self.residual);
            self.last_reduction = if pending { 1.0 } else { after / residual };
            growing = if !pending && after > residual { growing + 1 } else { 0 };
            pending = false;
            history.push(Iteration {
                residual: after,
                scale: self.force_scale(),
                correction: step_length * largest(&direction.displacements),
                step_length,
            });
        }
    }

    /// Compares tangents in doubt with differences; where they are far off, differences take their place.
    fn judge_tangents(
        &mut self,
        trial: &Committed,
        context: IncrementContext,
        statistics: &mut Statistics,
    ) -> Result<(), Trouble> {
        self.solids.compare_tangents();
        let compared = self.evaluate(trial, context, Request::StressAndTangent, statistics);
        if self.solids.judge_tangents() {
            self.has_tangents = false;
            self.last_reduction = 1.0;
        }
        compared
    }

    /// Makes the stiffness of elements that are out of balance safer: of all elements, back to the consistent one.
    fn choose_tangents(&mut self, choice: TangentChoice) {
        if choice == TangentChoice::Consistent {
            for element in std::mem::take(&mut self.fallen_back) {
                self.solids.set_tangent_choice(element, choice);
                self.has_tangents = false;
            }
            return;
        }
        let limit = self.model.controls.force_tolerance * self.force_scale();
        let unbalanced = (0..self.residual.len()).filter(|&row| self.residual[row].abs() > limit);
        let freedoms: Vec<usize> = unbalanced.map(|row| 2 * self.system.node_of_row(row)).collect();
        let both: Vec<usize> = freedoms.iter().flat_map(|&freedom| [freedom, freedom + 1]).collect();
        for (element, is_unbalanced) in touching(&self.model.mesh, &both).into_iter().enumerate() {
            if is_unbalanced && self.solids.softens(element) {
                self.solids.set_tangent_choice(element, choice);
                self.fallen_back.push(element);
                self.has_tangents = false;
                self.last_reduction = 1.0;
            }
        }
    }

    fn is_converged(
        &self,
        residual: f64,
        scale: f64,
        last: Option<&Iteration>,
        start: &Committed,
        trial: &Committed,
    ) -> bool {
        let controls = &self.model.controls;
        let tolerance = (controls.force_tolerance * scale).max(self.rounding);
        let moved = largest_difference(&trial.displacements, &start.displacements);
        let moved = moved.max(LEAST_RELATIVE_MOVE * largest(&trial.displacements));
        let small_correction = last.is_none_or(|last| last.correction <= controls.displacement_tolerance * moved);
        residual <= (NEGLIGIBLE_RESIDUAL * tolerance).max(self.rounding) || (residual <= tolerance && small_correction)
    }

    /// Names the node with the largest residual.
    fn not_converged(&self, residual: f64, scale: f64, iterations: usize) -> Trouble {
        let row = (0..self.residual.len()).max_by(|a, b| self.residual[*a].abs().total_cmp(&self.residual[*b].abs()));
        let place = row.map_or(Place::System, |row| {
            let node = self.system.node_of_row(row);
            Place::Node { node, position: self.model.mesh.nodes()[node] }
        });
        let reason = format!(
            "no equilibrium after {iterations} iterations: residual {residual:.3e} N against a force scale of {scale:.3e} N"
        );
        trouble(place, reason, CUT)
    }

    /// Makes sure of a factor that is good enough: the last one while it converges fast, otherwise one of the present
    /// tangents.
    fn prepare_factor(
        &mut self,
        trial: &Committed,
        context: IncrementContext,
        statistics: &mut Statistics,
    ) -> Result<(), Trouble> {
        if self.may_reuse_factor() {
            return Ok(());
        }
        if !self.has_tangents {
            self.evaluate(trial, context, Request::StressAndTangent, statistics)?;
        }
        self.factorise(statistics)
    }

    /// Where the last increment was hard an old factor makes the next one harder: cracks turn the stiffness over. One of
    /// contact laws that were asked elsewhere than at their gaps serves once.
    fn may_reuse_factor(&self) -> bool {
        let was_easy = self.last_iterations <= EASY_WITH_OLD_FACTORS;
        let is_known = self.factorised && !self.factor_is_elsewhere;
        self.model.skipping.factor_reuse && was_easy && is_known && self.last_reduction < FAST_REDUCTION
    }

    /// What to ask of the points after a correction: no tangents if an old factor serves the next iteration. The tangents
    /// of the last iteration of an increment are not for nothing: the next increment begins with them.
    fn request_after(&self) -> Request {
        if self.model.skipping.unused_tangents && self.may_reuse_factor() {
            Request::Stress
        } else {
            Request::StressAndTangent
        }
    }

    /// Makes sure that the next increment finds a factor or tangents. Those of the committed state by itself, in which
    /// nothing grows, would be of an unloading solid, and predict badly.
    pub(super) fn prepare_next(
        &mut self,
        trial: &Committed,
        context: IncrementContext,
        statistics: &mut Statistics,
    ) -> Result<(), Trouble> {
        if self.has_tangents || self.may_reuse_factor() {
            return Ok(());
        }
        self.evaluate(trial, context, Request::StressAndTangent, statistics)
    }

    /// Factorises what has changed since the last time.
    fn factorise(&mut self, statistics: &mut Statistics) -> Result<(), Trouble> {
        let keep = self.model.skipping.unchanged_elements && self.factorised;
        let elements_changed = !keep || self.solids.latest_version() != self.assembled_version;
        let Self { solids, system, blocks, times, .. } = self;
        timed(&mut times.assembly, || {
            if elements_changed {
                system.assemble_elements(solids);
            }
            system.set_blocks(blocks);
        });
        let symmetric = self.model.skipping.symmetric_solver && solids.symmetric();
        let symmetry = if symmetric { Symmetry::Symmetric } else { Symmetry::Unsymmetric };
        let result = if elements_changed {
            self.assembled_version = solids.latest_version();
            statistics.factorisations += 1;
            timed(&mut times.factorisation, || system.factorise(symmetry))
        } else {
            statistics.block_factorisations += 1;
            timed(&mut times.factorisation, || system.factorise_blocks())
        };
        self.rounding = POSITION_ROUNDING * self.extent * self.system.largest_diagonal();
        self.factorised = result.is_ok();
        self.factor_is_elsewhere = self.contact.is_elsewhere();
        result.map(|_| ()).map_err(|error| unsolvable(&error))
    }

    pub(super) fn solve(&mut self, right_side: &mut [f64], statistics: &mut Statistics) -> Result<(), Trouble> {
        statistics.solutions += 1;
        let Self { system, times, .. } = self;
        timed(&mut times.solution, || system.solve(right_side)).map_err(|error| unsolvable(&error))
    }
}
