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

mod correction;
mod drag;
mod flips;
mod iteration;
mod parallel;
mod policy;
mod state;
mod turn;

pub use flips::Flips;
pub(super) use iteration::hardest_round;
pub(super) use parallel::{Guide, Round};
pub(super) use state::EquilibriumState;
pub(super) use turn::Turn;

use super::times::timed;
use super::trail::Lead;
use super::zone::Zone;
use super::{Counts, Energies, Times};
use crate::assembly::loads::{Bearers, Shares};
use crate::assembly::solids::SolidEnergies;
use crate::assembly::{
    Equations, Location, PointFailure, Setback, Solids, System, USUAL_FRACTION, loaded_freedoms, loads,
};
use crate::contact::{self, Contact, PointIndex, PointStatus};
use crate::field::{FORCE_CHANGE, Field, Pass};
use crate::model::{IncrementContext, Model, ModelError};
use crate::solver::{Blocks, SolverError};
use crate::stepping::constants::{CUT, NEGLIGIBLE};
use crate::threads::Threads;
use correction::Followed;
use parallel::Company;
use serde::{Deserialize, Serialize};
use state::Memory;
use std::sync::atomic::Ordering;
use umat_abi::law::Request;

/// The state at the end of the last accepted increment.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
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

/// Goal of an increment.
#[derive(Clone, Debug)]
pub(super) enum IncrementGoal {
    /// The drives reach these values, mm.
    Drives(Vec<f64>),
    /// The drives reach these values, mm, in balance with drag on contact: `resistance`, N/mm at each of its freedoms.
    Through { goal: Vec<f64>, resistance: f64 },
    /// The leading quantity grows by this much, with the drives on the line from where they are along a direction. `point`: the contact
    /// point that leads, if it is known.
    Led { by: Leader, growth: f64, direction: Vec<f64>, point: Option<PointIndex> },
}

/// Quantity that grows steadily where the drives would have to turn back.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub(super) enum Leader {
    /// The slip of a contact point, mm: of the one that breaks, otherwise of the one that slides fastest at the start of the
    /// increment. It grows while a fibre is pulled out; the mean slip turns back where one point breaks.
    #[default]
    PointSlip,
    /// Dissipation of the solids' laws, N·mm: grows while an element fails.
    Dissipation,
    /// The phase field at the node where it grows fastest with the drives: grows while a crack does.
    Field,
}

/// Residual and correction of one iteration, for the report.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Iteration {
    /// Largest residual force after the iteration, N.
    pub residual: f64,
    /// Force scale that the residual is compared with, N.
    pub scale: f64,
    /// Largest correction of a displacement, mm.
    pub correction: f64,
    /// Largest residual of a field that is solved together with the displacements; otherwise 0.
    pub field_residual: f64,
    /// Part of the correction that was applied (line search).
    pub step_length: f64,
    /// Whether a round of iterations begins with it: the increment's first, or after contact has settled or the far field shrunk.
    pub begins_round: bool,
    /// What it led to another branch, where [`super::Analysis::watch_flips`] was called.
    pub flips: Flips,
}

/// How a round of iterations ends.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) enum RoundEnd {
    /// In balance.
    #[default]
    Balanced,
    /// Near balance: the next iteration corrects for new multipliers as well.
    Near,
}

/// Attempt at an increment: trial state, goal and iterations so far.
pub(super) struct Attempt<'a> {
    start: &'a Committed,
    target: &'a IncrementGoal,
    context: IncrementContext,
    trial: Committed,
    iterations: Vec<Iteration>,
    /// Iterations before this round: between rounds contact settles and the far field shrinks.
    before: usize,
    /// Iterations before multipliers were last updated near balance.
    updated: Option<usize>,
    /// The increment of another run that it is led along.
    lead: Option<Lead<'a>>,
    /// Whether the drives of that increment are not where the target has them.
    is_off: bool,
    /// Values of drives that follow a field, and whether they have changed since the last iteration.
    followed: Vec<f64>,
    follows: bool,
    /// The way that it takes, if it is kept.
    kept: Guide,
}

impl<'a> Attempt<'a> {
    pub(super) fn new(
        start: &'a Committed,
        target: &'a IncrementGoal,
        context: IncrementContext,
        lead: Option<Lead<'a>>,
    ) -> Self {
        let (trial, iterations, kept) = (start.clone(), Vec::new(), Guide::default());
        let followed = start.drives.clone();
        Self {
            start,
            target,
            context,
            trial,
            iterations,
            before: 0,
            updated: None,
            lead,
            is_off: false,
            followed,
            follows: false,
            kept,
        }
    }

    /// Returns the iterations of this round.
    fn round(&self) -> &[Iteration] {
        &self.iterations[self.before..]
    }

    /// Returns whether the next correction is a predictor, which takes the drives to their goal.
    fn predicts(&self) -> bool {
        self.follows || (self.iterations.is_empty() && (self.lead.is_none() || self.is_off))
    }

    /// Returns what the drives lack to be where the target has them; of a leading quantity on their line, if they may be off it.
    fn lacking(&self) -> Vec<f64> {
        let (now, start) = (&self.trial.drives, &self.start.drives);
        match self.target {
            IncrementGoal::Drives(goal) | IncrementGoal::Through { goal, .. } => {
                goal.iter().zip(now).map(|(to, from)| to - from).collect()
            }
            IncrementGoal::Led { by: Leader::Field, .. } => {
                self.followed.iter().zip(now).map(|(to, from)| to - from).collect()
            }
            IncrementGoal::Led { direction, .. } => {
                let length: f64 = direction.iter().map(|d| d * d).sum();
                let along: f64 = now.iter().zip(start).zip(direction).map(|((now, start), d)| (now - start) * d).sum();
                let share = if length > 0.0 { along / length } else { 0.0 };
                now.iter().zip(start).zip(direction).map(|((now, start), d)| start + share * d - now).collect()
            }
        }
    }

    /// Returns the resistance of drag, N/mm; 0 without drag.
    fn resistance(&self) -> f64 {
        if let IncrementGoal::Through { resistance, .. } = self.target { *resistance } else { 0.0 }
    }

    /// Returns step, increment and iteration as the laws receive them in the next iteration.
    fn context(&self) -> IncrementContext {
        IncrementContext { iteration: u32::try_from(self.iterations.len() + 1).unwrap_or(u32::MAX), ..self.context }
    }
}

/// Converged attempt: the state that it leads to.
#[derive(Clone, Debug, Default)]
pub(super) struct Converged {
    pub(super) end: Committed,
    pub(super) iterations: Vec<Iteration>,
    /// The largest force of drag, as a multiple of what a residual may be.
    pub(super) drag: f64,
    /// Whether the increment went back on the way of the one before, both through drag.
    pub(super) turns: bool,
    /// The way to it, if it is kept.
    pub(super) guide: Guide,
}

/// Solids, contact and equations with the memory of an iteration.
pub(super) struct Equilibrium<'m> {
    pub(super) model: &'m Model,
    pub(super) solids: Solids,
    pub(super) contact: Contact,
    /// The scalar field.
    pub(super) field: Option<Field>,
    pub(super) system: System,
    zone: Zone,
    pub(super) memory: Memory,
    pub(super) leading: Leading,
    pub(super) company: Company,
    pub(super) observed: Observed,
}

/// Contact points on which control depends.
#[derive(Default)]
pub(super) struct Leading {
    /// The point that leads, and its slip at the start of the increment.
    pub(super) point: Option<(PointIndex, f64)>,
    /// A point that broke in this attempt: if the attempt fails it leads the next.
    breaking: Option<PointIndex>,
    /// Number of points that opened or closed in the last evaluation.
    changes: usize,
}

/// What is counted of a run; nothing of it leads back.
#[derive(Default)]
pub(super) struct Observed {
    pub(super) times: Times,
    /// Branches of all points, if flips are counted.
    watch: Option<Box<flips::Watch>>,
}

impl<'m> Equilibrium<'m> {
    /// Evaluates the virgin state and numbers the equations.
    pub(super) fn new(model: &'m Model, equations: Equations) -> Result<Self, ModelError> {
        let mut solids = Solids::new(model)?;
        let contact = contact_of(model, &solids)?;
        let freedoms = equations.freedom_count();
        let coupled = coupled_freedoms(model, &contact);
        let zone = Zone::new(model, &equations, &coupled);
        let virgin = vec![0.0; freedoms];
        let field = model.field.as_ref().map(|definition| Field::new(definition, &model.mesh));
        field.iter().for_each(|field| field.hand_over(&mut solids));
        let context = IncrementContext { step: 1, increment: 1, iteration: 1, ..IncrementContext::default() };
        let evaluated = solids.evaluate(&virgin, &context, Request::StressAndTangent, &mut vec![0.0; freedoms]);
        evaluated.map_err(|trouble| ModelError(format!("before the first increment: {trouble}")))?;
        solids.begin_transfer();
        let system = zone.system(model, equations, &coupled, &solids).map_err(|error| ModelError(error.to_string()))?;
        solids.set_active(&zone.active);
        Ok(Self {
            model,
            solids,
            contact,
            field,
            system,
            zone,
            memory: Memory::new(freedoms),
            leading: Leading::default(),
            company: Company::default(),
            observed: Observed::default(),
        })
    }

    /// Returns whether another thread has asked for the end of the run.
    pub(super) fn is_stopped(&self) -> bool {
        self.company.stop.as_ref().is_some_and(|stop| stop.load(Ordering::Relaxed))
    }

    /// Shares the work of elements and factors among threads.
    pub(super) fn set_threads(&mut self, threads: &Threads) {
        self.solids.set_threads(threads);
        self.system.set_threads(threads);
    }

    /// Finds equilibrium for a target from the committed state, in rounds of iterations. Multipliers are updated
    /// between rounds, until contact has settled and the far field is elastic.
    pub(super) fn attempt(&mut self, mut attempt: Attempt<'_>) -> Result<Converged, PointFailure> {
        self.contact.end_prediction();
        attempt.kept.zone = self.company.keeps_rounds.then(|| self.zone.clone());
        self.begin_field(&attempt);
        self.begin_parallel(&mut attempt, 0)?;
        if !self.memory.at_committed_state || self.company.parallel.is_some() {
            self.evaluate(&attempt)?;
        }
        self.memory.at_committed_state = false;
        self.begin_flips();
        for round in 1.. {
            self.factorise_for_all();
            let end = self.newton(&mut attempt)?;
            self.hand_on();
            self.keep_round(&mut attempt, end);
            let settles = match end {
                RoundEnd::Balanced => self.contact.settle(),
                RoundEnd::Near => self.contact.update_multipliers(),
            };
            if settles {
                self.memory.statistics.settlements += 1;
                self.field.iter_mut().for_each(|field| field.accept(false));
            } else if end == RoundEnd::Balanced && self.field_settles(&mut attempt)? {
                self.memory.last_iterations = hardest_round(&attempt.iterations);
                self.prepare_next(&attempt)?;
                if self.far_field_holds(&mut attempt)? {
                    break;
                }
                self.memory.statistics.expansions += 1;
            }
            self.begin_parallel(&mut attempt, round)?;
            self.evaluate(&attempt)?;
        }
        self.company.parallel = None;
        let Attempt { trial: mut end, iterations, kept: guide, .. } = attempt;
        end.mean_slip = self.contact.mean_slip();
        end.dissipation = self.solids.trial_dissipation();
        end.external.clone_from(&self.memory.external);
        end.reactions = self.memory.internal.iter().zip(&self.memory.external).map(|(i, e)| i - e).collect();
        let drag = self.memory.drag.largest();
        let drag = if drag == 0.0 { 0.0 } else { drag / self.tolerance(self.force_scale()) };
        Ok(Converged { end, iterations, drag, turns: self.memory.drag.turns(), guide })
    }

    /// Returns whether displacements and field are solved together.
    pub(super) fn is_full(&self) -> bool {
        self.field.as_ref().is_some_and(Field::is_full)
    }

    /// Predicts the field.
    fn begin_field(&mut self, attempt: &Attempt<'_>) {
        let Some(field) = &mut self.field else { return };
        let growth = match attempt.target {
            IncrementGoal::Led { by: Leader::Field, growth, .. } => Some(*growth),
            _ => None,
        };
        let goal = attempt.trial.drives.iter().zip(attempt.lacking()).map(|(drive, lacking)| drive + lacking);
        field.begin(&goal.collect::<Vec<f64>>(), &attempt.context, growth, &mut self.solids);
        self.memory.at_committed_state = false;
    }

    /// Corrects the field by the heat of the solids: whether they agree. If not, the solids have got another one, the last of the
    /// increment if it leaves the forces as they were.
    fn field_settles(&mut self, attempt: &mut Attempt<'_>) -> Result<bool, PointFailure> {
        loop {
            let Self { field: Some(field), solids, observed, memory, .. } = self else { return Ok(true) };
            // nothing flows in no time
            if field.is_accepted() || field.is_full() || attempt.context.time_increment <= 0.0 {
                return Ok(true);
            }
            memory.statistics.field_passes += 1;
            let correction = timed(&mut observed.times.solution, || field.correction(&attempt.trial.drives, solids));
            let mut correction = correction.map_err(|error| unsolvable(&error, FREE_FIELD))?;
            let Followed { share, force } = self.follow_field(attempt, &mut correction)?;
            let Self { field: Some(field), solids, .. } = self else { return Ok(true) };
            let (pass, part) = field.pass(correction, solids);
            if let IncrementGoal::Led { direction, .. } = attempt.target
                && share != 0.0
            {
                attempt.followed.iter_mut().zip(direction).for_each(|(drive, along)| *drive += part * share * along);
                attempt.follows = true;
            }
            match pass {
                Pass::Changed => return Ok(false),
                Pass::Near => {
                    let before = self.memory.internal.clone();
                    self.evaluate(attempt)?;
                    let change = largest_difference(&self.memory.internal, &before).max(force);
                    let limit = (FORCE_CHANGE * self.force_scale()).max(self.memory.rounding);
                    self.field.iter_mut().for_each(|field| field.accept(change <= limit));
                    return Ok(false);
                }
                Pass::Again => self.evaluate(attempt)?,
                Pass::Back => return self.evaluate(attempt).map(|()| true),
                Pass::GivenUp => {
                    let reason = "field and displacements do not settle".into();
                    return Err(trouble(Location::System, reason, USUAL_FRACTION));
                }
            }
        }
    }

    /// Expands the far field and calls its laws: whether it is in equilibrium with what they say. If not, the elements
    /// that are no longer elastic iterate from now on.
    fn far_field_holds(&mut self, attempt: &mut Attempt<'_>) -> Result<bool, PointFailure> {
        if !self.zone.condenses {
            return Ok(true);
        }
        let context = attempt.context();
        let trial = &mut attempt.trial;
        self.system.expand(&mut trial.displacements);
        self.system.add_far_forces(&trial.displacements, -1.0, &mut self.memory.internal);
        let far: Vec<bool> = self.zone.active.iter().map(|active| !active).collect();
        self.solids.set_active(&far);
        let Self { solids, memory, observed, .. } = self;
        let called = timed(&mut observed.times.solids, || {
            solids.evaluate_unstabilised(&trial.displacements, &context, Request::Stress, &mut memory.internal)
        });
        self.solids.set_active(&self.zone.active);
        called?;
        let equations = self.system.equations();
        let residual = equations.reduce(&self.memory.unbalanced());
        let limit = (self.model.controls.force_tolerance * self.force_scale()).max(self.memory.rounding);
        let unbalanced: Vec<bool> = residual.iter().map(|force| force.abs() > limit).collect();
        if !unbalanced.contains(&true) {
            return Ok(true);
        }
        let equations = self.system.equations();
        let at_fault = |freedom: &usize| equations.equations_of(*freedom).iter().any(|(e, _)| unbalanced[*e]);
        let freedoms: Vec<usize> = (0..equations.freedom_count()).filter(at_fault).collect();
        let mut zone = self.zone.clone();
        if !zone.take_in(&self.model.mesh, &freedoms) {
            let reason = "equilibrium is lost between the far field and the zone".into();
            return Err(trouble(Location::System, reason, CUT));
        }
        self.set_zone(zone).map_err(|error| unsolvable(&error, FREE_BODY))?;
        Ok(false)
    }

    /// Lets other elements iterate; those that are condensed have been elastic so far.
    fn set_zone(&mut self, zone: Zone) -> Result<(), SolverError> {
        let (equations, threads) = (self.system.equations().clone(), self.system.threads().clone());
        self.zone = zone;
        self.system =
            self.zone.system(self.model, equations, &coupled_freedoms(self.model, &self.contact), &self.solids)?;
        self.system.set_threads(&threads);
        self.solids.set_active(&self.zone.active);
        self.memory.factorised = false;
        Ok(())
    }

    /// Makes the last attempt the committed state.
    pub(super) fn commit(&mut self, start: &Committed, end: &Committed) {
        self.leading.breaking = None;
        self.commit_flips();
        // an attempt that diverges has forces of any size: only what is accepted counts
        self.memory.greatest_scale = self.memory.greatest_scale.max(self.force_scale());
        self.memory.last_move = largest_difference(&end.displacements, &start.displacements);
        self.solids.commit(&end.displacements);
        self.contact.commit();
        self.field.iter_mut().for_each(Field::commit);
        self.memory.drag.commit();
        // the next increment begins out of balance by what drag has held back
        self.memory.at_committed_state = self.memory.drag.largest() == 0.0;
    }

    /// Releases torn elements and their contact points after an accepted increment. Contact moves to the remaining
    /// surface, whose nodes belong to released elements and therefore iterate.
    pub(super) fn release(&mut self, elements: &[usize], displacements: &[f64]) {
        self.solids.release(elements);
        self.contact.release(self.model, displacements, |element| self.solids.is_spalled(element));
        self.memory.at_committed_state = false;
    }

    /// Discards the last attempt: elements and contact return to the committed state.
    pub(super) fn restore(&mut self) {
        self.memory.last_reduction = 1.0;
        self.solids.restore();
        self.contact.restore();
        self.memory.at_committed_state = false;
    }

    /// Returns the energies of the committed state, without the external work.
    pub(super) fn energies(&self) -> Energies {
        stored_and_spent(self.solids.energies(), self.contact.energies(), self.memory.drag.work)
    }

    /// Returns the energies at the last evaluation, without the external work.
    pub(super) fn trial_energies(&self) -> Energies {
        stored_and_spent(self.solids.trial_energies(), self.contact.trial_energies(), self.memory.drag.trial_work)
    }

    pub(super) fn counts(&self) -> Counts {
        let (solids, contact) = (self.solids.counts(), &self.contact);
        Counts {
            damaged: solids.damaged,
            yielding: solids.plastic,
            sticking: contact.count(PointStatus::Sticking),
            slipping: contact.count(PointStatus::Slipping),
            open: contact.count(PointStatus::Open),
            released: contact.count(PointStatus::Released),
        }
    }

    /// Returns what the residual is compared with: the largest of reactions, loads and contact forces, not less than a part
    /// of the largest of accepted increments.
    pub(super) fn force_scale(&self) -> f64 {
        let equations = self.system.equations();
        let held = |freedom: usize| equations.equations_of(freedom).is_empty();
        let reactions = self.memory.internal.iter().zip(&self.memory.external).enumerate();
        let reaction = reactions.filter(|(f, _)| held(*f)).map(|(_, (i, e))| (i - e).abs()).fold(0.0, f64::max);
        let scale = reaction.max(largest(&self.memory.external)).max(largest(&self.memory.contact_forces));
        scale.max(NEGLIGIBLE * self.memory.greatest_scale)
    }

    /// Evaluates forces, residual and tangents at the trial state.
    pub(super) fn evaluate(&mut self, attempt: &Attempt<'_>) -> Result<(), PointFailure> {
        let is_led = matches!(attempt.target, IncrementGoal::Led { .. });
        let request = if self.needs_no_tangents() && !is_led { Request::Stress } else { Request::StressAndTangent };
        let (trial, context) = (&attempt.trial, attempt.context());
        let Model { mesh, fields, steps, .. } = self.model;
        let Self { solids, contact, system, memory, observed, .. } = self;
        memory.statistics.evaluations += 1;
        memory.has_tangents = request.wants_tangent();
        memory.internal.fill(0.0);
        timed(&mut observed.times.solids, || {
            solids.evaluate(&trial.displacements, &context, request, &mut memory.internal)
        })?;
        memory.blocks.clear();
        memory.contact_forces.fill(0.0);
        contact.set_drives(&trial.drives);
        if fields.change() {
            let [start, end] = fields.over(steps, &context);
            contact.set_fields(&start, &end);
        }
        let Memory { contact_forces, blocks, .. } = memory;
        let evaluation = timed(&mut observed.times.contact, || {
            contact.evaluate(&trial.displacements, &context, request, contact_forces, blocks)
        })?;
        self.leading.changes = evaluation.changes;
        memory.internal.iter_mut().zip(&memory.contact_forces).for_each(|(sum, force)| *sum += force);
        let moved = |freedom: usize| trial.displacements[freedom] - attempt.start.displacements[freedom];
        let Memory { drag, internal, blocks, .. } = memory;
        drag.evaluate(attempt.resistance(), contact.freedoms(), moved, system.equations(), internal, blocks);
        memory.external.fill(0.0);
        let (external, blocks) = (&mut memory.external, Some(&mut memory.blocks));
        add_loads(self.model, solids, &trial.drives, &trial.displacements, external, blocks);
        system.add_far_forces(&trial.displacements, 1.0, &mut memory.internal);
        let unbalanced = memory.unbalanced();
        memory.residual = system.reduce(&unbalanced);
        if let Some(parallel) = &self.company.parallel {
            parallel.take_off(&mut memory.residual);
        }
        match unbalanced.iter().position(|force| !force.is_finite()) {
            None => Ok(()),
            Some(freedom) => {
                let node = freedom / 2;
                let place = Location::Node { node, position: mesh.nodes()[node] };
                Err(trouble(place, "the internal force is not a finite number".into(), CUT))
            }
        }
    }
}

/// Returns the contact of a model before anything has moved.
pub(super) fn contact_of(model: &Model, solids: &Solids) -> Result<Contact, ModelError> {
    let Model { mesh, contacts, skipping, fields, .. } = model;
    let mut contact = Contact::new(mesh, contacts, &solids.elastic_moduli(), skipping.contact_search, &fields.initial)?;
    if model.controls.spalling.is_some() {
        contact.tear(mesh)?;
    }
    Ok(contact)
}

/// The freedoms that blocks may couple, ascending: those of contact, and of pressures that follow the body, which have
/// tangents as well.
fn coupled_freedoms(model: &Model, contact: &Contact) -> Vec<usize> {
    let mut freedoms = contact.freedoms().to_vec();
    if model.has_large_displacements() {
        freedoms.extend(loaded_freedoms(model));
        freedoms.sort_unstable();
        freedoms.dedup();
    }
    freedoms
}

/// Adds the forces of a model's loads under these drives, and if `blocks` are given what the loads add to the stiffness.
fn add_loads(
    model: &Model,
    solids: &Solids,
    drives: &[f64],
    displacements: &[f64],
    forces: &mut [f64],
    mut blocks: Option<&mut Blocks>,
) {
    let thickness = |index: usize| {
        let element = model.mesh.elements()[index];
        model.nlgeom[element.part()].then(|| element.thickness() * solids.thickness_ratio(index))
    };
    let bearers = Bearers { thickness: &thickness, shares: present_shares(model, solids) };
    for load in &model.loads {
        let (mesh, factor) = (&model.mesh, drives[load.drive]);
        loads::external(mesh, &bearers, &load.kind, factor, displacements, forces, blocks.as_deref_mut());
    }
}

/// Returns what is left of the loads of released elements; `None` while there are none.
fn present_shares(model: &Model, solids: &Solids) -> Option<Shares> {
    let may_spall = model.controls.spalling.is_some() && !model.loads.is_empty();
    let is_any_released = may_spall && (0..model.mesh.elements().len()).any(|element| solids.is_spalled(element));
    is_any_released.then(|| Shares::new(&model.mesh, |element| solids.share(element)))
}

/// What to look for where a system is singular: of displacements, of a field, of both.
const FREE_BODY: &str = "is a body free to move?";
const FREE_FIELD: &str = "it is that of the field: has each body a fixed value of a steady field?";
const FREE_BODY_OR_FIELD: &str = "is a body free to move, or without a fixed value of a steady field?";

/// A system without a solution; `question`: what to look for where it is singular, exactly or within rounding.
fn unsolvable(error: &SolverError, question: &str) -> PointFailure {
    let reason = match error {
        SolverError::Singular { .. } | SolverError::Residual { .. } => format!("{error}: {question}"),
        _ => error.to_string(),
    };
    trouble(Location::System, reason, CUT)
}

fn trouble(place: Location, reason: String, fraction: f64) -> PointFailure {
    Setback { reason, fraction: Some(fraction) }.at(place)
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

fn stored_and_spent(solids: SolidEnergies, contact: contact::Energies, drag: f64) -> Energies {
    let opening = contact.opening + contact.released;
    Energies {
        external_work: 0.0,
        elastic: solids.stored,
        plastic: solids.plastic,
        damage: solids.damage,
        spalled: solids.spalled,
        unaccounted: solids.unaccounted,
        interface: contact.work + contact.leaning - opening,
        interface_stored: contact.plugin_stored + contact.normal_stored,
        opening,
        stabilisation: solids.viscous + solids.overstress + drag,
    }
}
