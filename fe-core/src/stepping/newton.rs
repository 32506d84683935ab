//! Equilibrium at the end of an increment by Newton's method.
//!
//! ```text
//! r = Tᵀ(f_ext − f_int)          Tᵀ K T δq = r − Tᵀ K S δa          δu = T δq + S δa
//! ```
//!
//! The first iteration predicts with the tangent of the last converged state; the drives' change enters there as forces,
//! so that no element next to a grip is strained by the whole of it. Under indirect control δa = δλ d is unknown as
//! well, and found from the constraint c(u) = c₀ + Δc by a second solution with the same factor:
//!
//! ```text
//! δq = δq_r + δλ δq_d,   K δq_d = Tᵀ(∂f_ext/∂λ − K S d),   δλ = (c₀ + Δc − c − c,_u·Tδq_r) / c,_u·(Tδq_d + S d)
//! ```

use super::zone::Zone;
use super::{Counts, Energies, ModelError, Statistics};
use crate::assembly::solids::TangentChoice;
use crate::assembly::{
    Blocks, Equations, IncrementContext, Place, Solids, System, Trouble, loaded_freedoms, loads, touching,
};
use crate::contact::{Contact, PointIndex};
use crate::model::Model;
use crate::solver::{SolverError, Symmetry};
use umat_abi::law::Request;

/// The state at the end of the last accepted increment.
#[derive(Clone, Debug, Default)]
pub(super) struct Committed {
    pub(super) displacements: Vec<f64>,
    pub(super) drives: Vec<f64>,
    /// Internal less external forces: reactions at held freedoms, nothing elsewhere.
    pub(super) reactions: Vec<f64>,
    pub(super) external: Vec<f64>,
    pub(super) mean_slip: f64,
    /// Energy that the solids' laws dissipated so far, N mm.
    pub(super) dissipation: f64,
}

/// What the increment shall reach.
#[derive(Clone, Debug)]
pub(super) enum Target {
    /// These values of the drives.
    Drives(Vec<f64>),
    /// This growth of what leads, with the drives on the line from where they are along a direction.
    Led { by: Leader, growth: f64, direction: Vec<f64> },
}

/// What grows where the drives would have to turn back.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Leader {
    /// The slip of a contact point, mm: of the one that breaks, otherwise of the one that slides fastest at the start of the
    /// increment. It grows while a fibre is pulled out; the mean slip turns back where one point breaks.
    PointSlip,
    /// What the solids' laws have dissipated, N·mm: grows while an element fails.
    Dissipation,
}

/// One iteration, as the report tells it.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Iteration {
    /// Largest residual force after it, N.
    pub residual: f64,
    /// The force that it is compared with, N.
    pub scale: f64,
    /// Largest correction of a displacement, mm.
    pub correction: f64,
    /// Which part of the correction was applied (line search).
    pub step_length: f64,
}

/// An attempt that converged.
#[derive(Clone, Debug)]
pub(super) struct Converged {
    pub(super) end: Committed,
    pub(super) iterations: Vec<Iteration>,
}

/// Solids, contact and equations with the memory of an iteration.
pub(super) struct Equilibrium<'m> {
    pub(super) model: &'m Model,
    pub(super) solids: Solids,
    pub(super) contact: Contact,
    pub(super) system: System,
    zone: Zone,
    internal: Vec<f64>,
    contact_forces: Vec<f64>,
    external: Vec<f64>,
    residual: Vec<f64>,
    blocks: Blocks,
    /// Whether a factor of the present pattern exists.
    factorised: bool,
    /// The solids' stiffnesses in the matrix.
    assembled_version: u64,
    /// Whether the last evaluation gave tangents.
    has_tangents: bool,
    /// By which the last correction multiplied the residual.
    last_reduction: f64,
    /// Whether the last evaluation is of the committed state, with the tangents that led there.
    at_committed_state: bool,
    /// The largest force scale so far.
    greatest_scale: f64,
    /// Elements whose stiffness is not the consistent one.
    fallen_back: Vec<usize>,
    /// The largest coordinate, mm.
    extent: f64,
    /// Forces that rounding of positions makes of the largest stiffness, N.
    rounding: f64,
    /// The largest change of a displacement in the last increment, mm.
    last_move: f64,
    /// The contact point that leads, and its slip at the start of the increment.
    leading_point: Option<(PointIndex, f64)>,
    /// A point that broke in this attempt: if the attempt fails it leads the next.
    breaking_point: Option<PointIndex>,
}

/// The force scale does not fall below this part of the largest so far: a fibre that has left carries nothing.
const LEAST_RELATIVE_SCALE: f64 = 1e-4;
/// A residual so far below its tolerance needs no small correction to prove convergence: linear problems end at once.
const NEGLIGIBLE_RESIDUAL: f64 = 1e-4;
/// Corrections are compared with the increment's displacements, or with this part of all so far: a tiny increment
/// after many cuts needs no finer ones than the state that it starts from.
const LEAST_RELATIVE_MOVE: f64 = 1e-2;
/// After how many iterations the stiffness of damaging elements out of balance becomes safer (fe.md §5). That of plastic
/// ones is safe, and the elastic one far too stiff where flow spreads.
const FALLBACKS: [(usize, TangentChoice); 2] = [(6, TangentChoice::Frozen), (12, TangentChoice::Elastic)];
/// A residual that falls faster than this needs no safer stiffness.
const SLOW_REDUCTION: f64 = 0.5;
/// A factor that made the residual smaller by this serves again.
const FAST_REDUCTION: f64 = 0.05;
/// Positions are known to a few units of their last place.
const POSITION_ROUNDING: f64 = 4.0 * f64::EPSILON;
/// A correction that makes the largest residual grow is kept if it leaves no more than this part of the work of the
/// residuals along it: where plastic flow spreads, the largest residual moves on and grows on the best of paths. Not with
/// contact: at the kinks of its laws such steps go to and fro.
const WORK_REDUCTION: f64 = 0.8;
/// Halvings of a correction.
const MAX_HALVINGS: usize = 4;
/// Residuals that grow as often in a row, after as many iterations, diverge.
const DIVERGENCE: usize = 4;
/// Rounds of multiplier updates and openings in one increment.
const MAX_SETTLEMENTS: usize = 200;
/// Derivatives of the dissipation are differences over this part of the last increment.
const PROBE: f64 = 1e-4;
/// but not less than this part of the displacements, which are rounded.
const LEAST_PROBE: f64 = 1e-8;
/// What an attempt that did not converge is repeated with.
const CUT: f64 = 0.25;

impl<'m> Equilibrium<'m> {
    /// Evaluates the virgin state and finds the equations.
    pub(super) fn new(model: &'m Model, equations: Equations) -> Result<Self, ModelError> {
        let mut solids = Solids::new(model)?;
        let contact =
            Contact::new(&model.mesh, &model.contacts, &solids.elastic_moduli(), model.skipping.contact_search)?;
        let freedoms = equations.freedom_count();
        let coupled = coupled_freedoms(model, &contact);
        let zone = Zone::new(model, &equations, &coupled);
        let virgin = vec![0.0; freedoms];
        let context = IncrementContext { step: 1, increment: 1, iteration: 1, ..IncrementContext::default() };
        solids.evaluate(&virgin, &context, Request::StressAndTangent, &mut vec![0.0; freedoms])?;
        let system = zone.system(model, equations, &coupled, &solids)?;
        solids.set_active(zone.active());
        Ok(Self {
            model,
            solids,
            contact,
            system,
            zone,
            internal: vec![0.0; freedoms],
            contact_forces: vec![0.0; freedoms],
            external: vec![0.0; freedoms],
            residual: Vec::new(),
            blocks: Blocks::default(),
            factorised: false,
            assembled_version: 0,
            has_tangents: false,
            last_reduction: 1.0,
            at_committed_state: false,
            greatest_scale: 0.0,
            fallen_back: Vec::new(),
            extent: model.mesh.nodes().iter().flatten().fold(0.0, |largest: f64, x| largest.max(x.abs())),
            rounding: 0.0,
            last_move: 0.0,
            leading_point: None,
            breaking_point: None,
        })
    }

    /// Finds equilibrium for a target from the committed state.
    pub(super) fn attempt(
        &mut self,
        start: &Committed,
        target: &Target,
        context: IncrementContext,
        statistics: &mut Statistics,
    ) -> Result<Converged, Trouble> {
        let mut trial = start.clone();
        let mut iterations: Vec<Iteration> = Vec::new();
        if !self.at_committed_state {
            self.evaluate(&trial, context, Request::StressAndTangent, statistics)?;
        }
        self.at_committed_state = false;
        let mut settlements = 0;
        loop {
            let round = self.newton(start, &mut trial, target, context, iterations.len(), statistics)?;
            iterations.extend(round);
            if self.contact.settle().again {
                settlements += 1;
                if settlements > MAX_SETTLEMENTS {
                    return Err(trouble(Place::System, "contact multipliers do not settle".into(), CUT));
                }
                statistics.settlements += 1;
            } else if self.far_field_holds(&mut trial, context)? {
                break;
            } else {
                statistics.expansions += 1;
            }
            let context = IncrementContext { iteration: iteration_number(iterations.len()), ..context };
            self.evaluate(&trial, context, Request::StressAndTangent, statistics)?;
        }
        trial.mean_slip = self.contact.mean_slip();
        trial.dissipation = self.solids.trial_dissipation();
        trial.external.clone_from(&self.external);
        trial.reactions = self.internal.iter().zip(&self.external).map(|(i, e)| i - e).collect();
        Ok(Converged { end: trial, iterations })
    }

    /// Expands the far field and calls its laws: whether it is in equilibrium with what they say. If not, the elements
    /// that are no longer elastic iterate from now on.
    fn far_field_holds(&mut self, trial: &mut Committed, context: IncrementContext) -> Result<bool, Trouble> {
        if !self.zone.condenses() {
            return Ok(true);
        }
        self.system.expand(&mut trial.displacements).map_err(|error| unsolvable(&error))?;
        self.system.add_far_forces(&trial.displacements, -1.0, &mut self.internal);
        let far: Vec<bool> = self.zone.active().iter().map(|active| !active).collect();
        self.solids.set_active(&far);
        let called = self.solids.evaluate(&trial.displacements, &context, Request::Stress, &mut self.internal);
        self.solids.set_active(self.zone.active());
        called?;
        let equations = self.system.equations();
        let mut residual = vec![0.0; equations.count()];
        equations.reduce(&self.unbalanced(), &mut residual);
        let limit = (self.model.controls.force_tolerance * self.force_scale()).max(self.rounding);
        let unbalanced: Vec<bool> = residual.iter().map(|force| force.abs() > limit).collect();
        if !unbalanced.contains(&true) {
            return Ok(true);
        }
        let equations = self.system.equations();
        let at_fault = |freedom: &usize| equations.equations_of(*freedom).iter().any(|(e, _)| unbalanced[*e]);
        let freedoms: Vec<usize> = (0..equations.freedom_count()).filter(at_fault).collect();
        let equations = equations.clone();
        if !self.zone.take_in(&self.model.mesh, &freedoms) {
            let reason = "equilibrium is lost between the far field and the zone".into();
            return Err(trouble(Place::System, reason, CUT));
        }
        self.system = self
            .zone
            .system(self.model, equations, &coupled_freedoms(self.model, &self.contact), &self.solids)
            .map_err(|error| unsolvable(&error))?;
        self.solids.set_active(self.zone.active());
        self.factorised = false;
        Ok(false)
    }

    /// The last attempt becomes the committed state.
    pub(super) fn commit(&mut self, start: &Committed, end: &Committed) {
        self.breaking_point = None;
        self.last_move = largest_difference(&end.displacements, &start.displacements);
        self.solids.commit(&end.displacements);
        self.contact.commit();
        self.at_committed_state = true;
    }

    /// The last attempt is forgotten.
    pub(super) fn restore(&mut self) {
        self.last_reduction = 1.0;
        self.solids.restore();
        self.contact.restore();
        self.at_committed_state = false;
    }

    /// Energies of the committed state but for the external work.
    pub(super) fn energies(&self) -> Energies {
        let (solids, contact) = (self.solids.energies(), self.contact.energies());
        let opening = contact.opening + contact.released;
        Energies {
            external_work: 0.0,
            elastic: solids.stored,
            plastic: solids.plastic,
            damage: solids.damage,
            interface: contact.work - opening,
            opening,
            stabilisation: solids.viscous,
        }
    }

    /// Forces that rounding makes, N.
    pub(super) fn rounding(&self) -> f64 {
        self.rounding
    }

    pub(super) fn counts(&self) -> Counts {
        let (solids, contact) = (self.solids.counts(), self.contact.counts());
        Counts {
            damaged: solids.damaged,
            yielding: solids.plastic,
            sticking: contact.sticking,
            slipping: contact.slipping,
            open: contact.open,
            released: contact.released,
        }
    }

    /// Newton's iterations until the residual is small, from the present evaluation.
    fn newton(
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
                return Ok(history);
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
            self.prepare_factor(trial, context, statistics)?;
            let direction = self.direction(start, trial, target, (pending, context), statistics)?;
            let request = if pending { Request::StressAndTangent } else { self.request_after(residual, scale) };
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

    /// What the residual is compared with: the largest of reactions, loads and contact forces.
    fn force_scale(&mut self) -> f64 {
        let equations = self.system.equations();
        let held = |freedom: usize| equations.equations_of(freedom).is_empty();
        let reactions = self.internal.iter().zip(&self.external).enumerate();
        let reaction = reactions.filter(|(f, _)| held(*f)).map(|(_, (i, e))| (i - e).abs()).fold(0.0, f64::max);
        let scale = reaction.max(largest(&self.external)).max(largest(&self.contact_forces));
        self.greatest_scale = self.greatest_scale.max(scale);
        scale.max(LEAST_RELATIVE_SCALE * self.greatest_scale)
    }

    /// Forces, residual and, if wanted, tangents at a trial state.
    fn evaluate(
        &mut self,
        trial: &Committed,
        context: IncrementContext,
        request: Request,
        statistics: &mut Statistics,
    ) -> Result<(), Trouble> {
        statistics.evaluations += 1;
        self.has_tangents = request.wants_tangent();
        self.internal.fill(0.0);
        self.solids.evaluate(&trial.displacements, &context, request, &mut self.internal)?;
        if self.has_tangents {
            self.blocks.clear();
        }
        self.contact_forces.fill(0.0);
        let Self { contact, contact_forces, blocks, .. } = self;
        contact.evaluate(&trial.displacements, &context, request, contact_forces, blocks)?;
        self.internal.iter_mut().zip(&self.contact_forces).for_each(|(sum, force)| *sum += force);
        self.external.fill(0.0);
        for load in &self.model.loads {
            let factor = trial.drives[load.drive];
            let blocks = request.wants_tangent().then_some(&mut self.blocks);
            let Model { mesh, nlgeom, .. } = self.model;
            loads::external(mesh, *nlgeom, &load.kind, factor, &trial.displacements, &mut self.external, blocks);
        }
        self.system.add_far_forces(&trial.displacements, 1.0, &mut self.internal);
        let unbalanced = self.unbalanced();
        self.residual = self.system.reduce(&unbalanced);
        match unbalanced.iter().position(|force| !force.is_finite()) {
            None => Ok(()),
            Some(freedom) => {
                let node = freedom / 2;
                let place = Place::Node { node, position: self.model.mesh.nodes()[node] };
                Err(trouble(place, "the internal force is not a finite number".into(), CUT))
            }
        }
    }

    /// External less internal forces.
    fn unbalanced(&self) -> Vec<f64> {
        self.external.iter().zip(&self.internal).map(|(e, i)| e - i).collect()
    }

    /// The work of the unbalanced forces along a correction, N mm: 0 where a shorter or longer one gains nothing.
    fn work_along(&self, direction: &Direction) -> f64 {
        let forces = self.external.iter().zip(&self.internal);
        forces.zip(&direction.displacements).map(|((external, internal), change)| (external - internal) * change).sum()
    }

    /// The correction of this iteration.
    fn direction(
        &mut self,
        start: &Committed,
        trial: &Committed,
        target: &Target,
        (pending, context): (bool, IncrementContext),
        statistics: &mut Statistics,
    ) -> Result<Direction, Trouble> {
        let mut correction = self.residual.clone();
        match target {
            Target::Drives(goal) => {
                let drives: Vec<f64> = goal.iter().zip(&trial.drives).map(|(to, from)| to - from).collect();
                if pending {
                    let change = self.drive_force(start, &drives);
                    correction.iter_mut().zip(&change).for_each(|(c, f)| *c += f);
                }
                self.solve(&mut correction, statistics)?;
                Ok(self.as_direction(&correction, drives))
            }
            Target::Led { by, growth, direction } => {
                let mut along = self.drive_force(start, direction);
                self.solve(&mut correction, statistics)?;
                self.solve(&mut along, statistics)?;
                let zero = vec![0.0; direction.len()];
                let from_residual = self.as_direction(&correction, zero);
                let from_drives = self.as_direction(&along, direction.clone());
                let progress = match by {
                    Leader::PointSlip => self.slip_progress(&from_residual, &from_drives, pending),
                    Leader::Dissipation => {
                        self.dissipation_progress([start, trial], &from_residual, &from_drives, context)?
                    }
                };
                let share = (growth - progress.so_far - progress.along_residual) / progress.along_drives;
                if !share.is_finite() {
                    let reason = "what leads does not follow the drives".into();
                    return Err(trouble(Place::System, reason, CUT));
                }
                Ok(from_residual.plus(share, &from_drives))
            }
        }
    }

    /// How far the leading point has slid; chosen where the increment starts.
    fn slip_progress(&mut self, from_residual: &Direction, from_drives: &Direction, pending: bool) -> Progress {
        if pending {
            let breaking = self.contact.breaking_point().or(self.breaking_point.take());
            let leading = breaking.or_else(|| self.contact.fastest_point(&from_drives.displacements));
            self.leading_point = leading.map(|point| (point, self.contact.slip_of(point)));
        } else if let Some(point) = self.contact.breaking_point() {
            self.breaking_point = Some(point);
        }
        self.leading_point.map_or(Progress::default(), |(point, start)| Progress {
            so_far: self.contact.slip_of(point) - start,
            along_residual: self.contact.slip_along(point, &from_residual.displacements),
            along_drives: self.contact.slip_along(point, &from_drives.displacements),
        })
    }

    /// The solids' dissipation and its derivatives along two corrections, by differences: a UMAT reports the energy, not
    /// its derivatives. The points' trial state is lost.
    fn dissipation_progress(
        &mut self,
        [start, trial]: [&Committed; 2],
        from_residual: &Direction,
        from_drives: &Direction,
        context: IncrementContext,
    ) -> Result<Progress, Trouble> {
        let now = self.dissipation_at(&trial.displacements, context)?;
        let probe = (PROBE * self.last_move).max(LEAST_PROBE * largest(&trial.displacements));
        let mut slope = |along: &Direction| -> Result<f64, Trouble> {
            let greatest = largest(&along.displacements);
            if greatest == 0.0 {
                return Ok(0.0);
            }
            let length = probe / greatest;
            let mut growth = |length: f64| -> Result<f64, Trouble> {
                let probe = trial.displacements.iter().zip(&along.displacements).map(|(u, du)| u + length * du);
                Ok((self.dissipation_at(&probe.collect::<Vec<f64>>(), context)? - now) / length)
            };
            // At the start of an increment dissipation grows to one side only: to where the points load.
            let (ahead, back) = (growth(length)?, growth(-length)?);
            Ok(if ahead >= -back { ahead } else { back })
        };
        let so_far = now - start.dissipation;
        Ok(Progress { so_far, along_residual: slope(from_residual)?, along_drives: slope(from_drives)? })
    }

    fn dissipation_at(&mut self, displacements: &[f64], context: IncrementContext) -> Result<f64, Trouble> {
        let mut forces = vec![0.0; displacements.len()];
        self.solids.evaluate(displacements, &context, Request::Stress, &mut forces)?;
        Ok(self.solids.trial_dissipation())
    }

    /// Tᵀ(∂f_ext/∂a − K S) d, with loads where the increment starts.
    fn drive_force(&self, start: &Committed, drives: &[f64]) -> Vec<f64> {
        let mut forces = self.system.drive_stiffness(&self.solids, drives);
        forces.iter_mut().for_each(|force| *force = -*force);
        let mut external = vec![0.0; start.displacements.len()];
        for load in &self.model.loads {
            let Model { mesh, nlgeom, .. } = self.model;
            loads::external(mesh, *nlgeom, &load.kind, drives[load.drive], &start.displacements, &mut external, None);
        }
        let reduced = self.system.reduce(&external);
        forces.iter_mut().zip(&reduced).for_each(|(force, load)| *force += load);
        forces
    }

    fn as_direction(&self, unknowns: &[f64], drives: Vec<f64>) -> Direction {
        Direction { displacements: self.system.displacements(unknowns, &drives), drives }
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

    fn may_reuse_factor(&self) -> bool {
        self.model.skipping.factor_reuse && self.factorised && self.last_reduction < FAST_REDUCTION
    }

    /// What to ask of the points after a correction: no tangents if the next iteration will not use them.
    fn request_after(&self, residual: f64, scale: f64) -> Request {
        let expected = self.last_reduction * residual;
        let converges = expected < NEGLIGIBLE_RESIDUAL * self.model.controls.force_tolerance * scale;
        if self.model.skipping.unused_tangents
            && self.last_reduction < FAST_REDUCTION
            && (converges || self.may_reuse_factor())
        {
            Request::Stress
        } else {
            Request::StressAndTangent
        }
    }

    /// Factorises what has changed since the last time.
    fn factorise(&mut self, statistics: &mut Statistics) -> Result<(), Trouble> {
        let keep = self.model.skipping.unchanged_elements && self.factorised;
        let elements_changed = !keep || self.solids.latest_version() != self.assembled_version;
        if elements_changed {
            self.assembled_version = self.solids.latest_version();
            self.system.assemble_elements(&self.solids);
        }
        self.system.set_blocks(&self.blocks);
        let symmetric = self.model.skipping.symmetric_solver && self.solids.symmetric();
        let symmetry = if symmetric { Symmetry::Symmetric } else { Symmetry::Unsymmetric };
        let result = if elements_changed {
            statistics.factorisations += 1;
            self.system.factorise(symmetry)
        } else {
            statistics.block_factorisations += 1;
            self.system.factorise_blocks()
        };
        self.rounding = POSITION_ROUNDING * self.extent * self.system.largest_diagonal();
        self.factorised = result.is_ok();
        result.map(|_| ()).map_err(|error| unsolvable(&error))
    }

    fn solve(&mut self, right_side: &mut [f64], statistics: &mut Statistics) -> Result<(), Trouble> {
        statistics.solutions += 1;
        self.system.solve(right_side).map_err(|error| unsolvable(&error))
    }

    /// Applies a correction and evaluates; a shorter one if the residual grows. `(predicting, before, request)`: whether
    /// the drives move, the residual before, what to ask of the points.
    fn advance(
        &mut self,
        trial: &mut Committed,
        direction: &Direction,
        context: IncrementContext,
        (predicting, before, request): (bool, f64, Request),
        statistics: &mut Statistics,
    ) -> Result<f64, Trouble> {
        let from = trial.displacements.clone();
        let work_before = self.work_along(direction);
        for (drive, change) in trial.drives.iter_mut().zip(&direction.drives) {
            *drive += change;
        }
        let place = |length: f64, trial: &mut Committed| {
            for ((u, from), change) in trial.displacements.iter_mut().zip(&from).zip(&direction.displacements) {
                *u = from + length * change;
            }
        };
        place(1.0, trial);
        self.evaluate(trial, context, request, statistics)?;
        let moves_drives = direction.drives.iter().any(|change| *change != 0.0);
        let full = largest(&self.residual);
        if !self.model.controls.line_search || predicting || moves_drives || full <= before {
            return Ok(1.0);
        }
        let spreads = if self.model.contacts.is_empty() { WORK_REDUCTION } else { 0.0 };
        let limit = spreads * work_before.abs();
        if self.work_along(direction).abs() <= limit {
            return Ok(1.0);
        }
        let mut best = (full, 1.0);
        let mut length = 1.0;
        for _ in 0..MAX_HALVINGS {
            length *= 0.5;
            place(length, trial);
            self.evaluate(trial, context, Request::Stress, statistics)?;
            let residual = largest(&self.residual);
            if residual < best.0 {
                best = (residual, length);
            }
            if residual <= before || self.work_along(direction).abs() <= limit {
                break;
            }
        }
        place(best.1, trial);
        self.evaluate(trial, context, Request::StressAndTangent, statistics)?;
        Ok(best.1)
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
}

/// How far what leads has grown in the increment, and its derivatives along the two parts of a correction.
#[derive(Clone, Copy, Debug, Default)]
struct Progress {
    so_far: f64,
    along_residual: f64,
    along_drives: f64,
}

/// A correction of displacements and drives.
#[derive(Clone, Debug)]
struct Direction {
    displacements: Vec<f64>,
    drives: Vec<f64>,
}

impl Direction {
    fn plus(mut self, factor: f64, other: &Self) -> Self {
        self.displacements.iter_mut().zip(&other.displacements).for_each(|(a, b)| *a += factor * b);
        self.drives.iter_mut().zip(&other.drives).for_each(|(a, b)| *a += factor * b);
        self
    }
}

/// The freedoms that blocks may couple, ascending: those of contact, and of loads that follow the body.
fn coupled_freedoms(model: &Model, contact: &Contact) -> Vec<usize> {
    let mut freedoms = contact.freedoms().to_vec();
    if model.nlgeom {
        freedoms.extend(loaded_freedoms(model));
        freedoms.sort_unstable();
        freedoms.dedup();
    }
    freedoms
}

fn unsolvable(error: &SolverError) -> Trouble {
    trouble(Place::System, error.to_string(), CUT)
}

fn trouble(place: Place, reason: String, fraction: f64) -> Trouble {
    Trouble { place, reason, fraction: Some(fraction) }
}

fn iteration_number(done: usize) -> u32 {
    u32::try_from(done + 1).unwrap_or(u32::MAX)
}

pub(super) fn largest(values: &[f64]) -> f64 {
    values.iter().fold(0.0, |greatest, value| value.abs().max(greatest))
}

fn largest_difference(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max)
}

pub(super) fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

#[cfg(test)]
impl Equilibrium<'_> {
    /// The residual at a trial state.
    pub(super) fn residual_at(
        &mut self,
        trial: &Committed,
        context: IncrementContext,
        request: Request,
    ) -> Result<Vec<f64>, Trouble> {
        self.evaluate(trial, context, request, &mut Statistics::default())?;
        Ok(self.residual.clone())
    }

    /// K times unknowns by rows, with the tangents of the last evaluation.
    pub(super) fn tangent_times(&mut self, unknowns: &[f64]) -> Vec<f64> {
        self.system.assemble_elements(&self.solids);
        self.system.set_blocks(&self.blocks);
        self.system.multiply(unknowns)
    }
}
