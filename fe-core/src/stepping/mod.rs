#![doc = include_str!("doc.md")]

mod checkpoint;
mod constants;
mod control;
mod energy;
mod error;
mod findings;
mod limit;
pub mod line_search;
mod newton;
mod record;
mod recorded;
mod size;
mod snapshot;
mod spalling;
#[cfg(test)]
mod test;
mod times;
mod trail;
mod wire;
mod zone;

pub use checkpoint::Checkpoint;
pub use constants::{ENERGY_BUDGET, STABILISATION_BUDGET};
pub use energy::Energies;
pub use error::RunError;
pub use newton::{Flips, Iteration};
pub use record::{Counts, Directive, FibreRecord, IncrementObserver, Record, WireRecord};
pub use recorded::{AttemptVerdict, LeadingQuantity, Recorded, Tried};
pub use snapshot::Snapshot;
pub use times::Times;
pub use trail::{Along, Trail};

use crate::assembly::solids::PartAccount;
use crate::assembly::{Equations, Location, PointFailure, Setback, Solids};
use crate::model::{IncrementContext, Model, ModelError, Step};
use crate::threads::Threads;
use checkpoint::Position;
use control::{Advance, Judgement, LoadHistory, StepRun};
use newton::{Attempt, Committed, Converged, Equilibrium, IncrementGoal};
use serde::{Deserialize, Serialize};
use std::sync::Arc;
use std::sync::atomic::AtomicBool;
use trail::Lead;
use umat_abi::host::{Clock, ExternalDatabases};

/// Counts of the work that a run took.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct AnalysisStatistics {
    /// Increments accepted.
    pub increments: u64,
    /// Newton iterations of all attempts.
    pub iterations: u64,
    /// Attempts given up.
    pub cutbacks: u64,
    /// Rounds of multiplier updates and openings.
    pub settlements: u64,
    /// Times that elements left the condensed far field.
    pub expansions: u64,
    /// Increments in which contact went through drag.
    pub dragged: u64,
    /// Corrections of the scalar field.
    pub field_passes: u64,
    /// Evaluations of all forces.
    pub evaluations: u64,
    /// Factorisations of the matrix with other elements.
    pub factorisations: u64,
    /// Factorisations of the matrix of which contact alone had changed.
    pub block_factorisations: u64,
    /// Solutions with a factor.
    pub solutions: u64,
}

/// Present state of a run, besides its points.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
struct Present {
    committed: Committed,
    energies: Energies,
    /// Energies stored by equilibrium at zero drives, which do not count.
    datum: Energies,
    /// Accounts of the solids' laws at that equilibrium.
    datum_accounts: Vec<PartAccount>,
    total_time: f64,
    load: LoadHistory,
    greatest_work: f64,
    spalled: spalling::Spalled,
    stretches: wire::Stretches,
}

/// A model that is being computed.
pub struct Analysis<'m> {
    model: &'m Model,
    databases: ExternalDatabases,
    equilibrium: Equilibrium<'m>,
    present: Present,
    /// Increments between checkpoints.
    checkpoint_every: Option<u64>,
    /// Increments that were done at the last one.
    last_checkpoint: u64,
    /// Position from which a resumed run goes on.
    resumed: Option<Position>,
    /// Attempts at the present increment.
    tried: Vec<Tried>,
    /// Increments that are repeated.
    repeats: Option<Recorded>,
    /// The states of the run, if they are kept.
    trail: Option<Trail>,
    /// The states of another run, along which this one is led.
    along: Option<Arc<Trail>>,
}

impl<'m> Analysis<'m> {
    /// Checks a model and prepares its computation.
    ///
    /// # Errors
    ///
    /// Everything that would keep it from being computed: laws, constraints, contact.
    pub fn new(model: &'m Model) -> Result<Self, ModelError> {
        error::check(model)?;
        let databases = ExternalDatabases::begin(model.libraries());
        let equations = Equations::new(model)?;
        let freedoms = equations.freedom_count();
        let committed = Committed {
            displacements: vec![0.0; freedoms],
            drives: match &model.initial_drives[..] {
                [] => vec![0.0; model.drives.len()],
                initial => initial.to_vec(),
            },
            reactions: vec![0.0; freedoms],
            external: vec![0.0; freedoms],
            ..Committed::default()
        };
        let present = Present { committed, ..Present::default() };
        Ok(Self::at(model, databases, Equilibrium::new(model, equations)?, present))
    }

    /// An analysis at a state, with which it begins.
    fn at(model: &'m Model, databases: ExternalDatabases, equilibrium: Equilibrium<'m>, present: Present) -> Self {
        Self {
            model,
            databases,
            equilibrium,
            present,
            checkpoint_every: None,
            last_checkpoint: 0,
            resumed: None,
            tried: Vec::new(),
            repeats: None,
            trail: None,
            along: None,
        }
    }

    /// Shares the work among threads: elements whose laws may be called by several, and factors of large systems. Results
    /// have the same bits for any number.
    pub fn set_threads(&mut self, threads: Threads) {
        self.equilibrium.set_threads(&threads);
    }

    /// Ends the run, as if an observer had said so, when another thread sets the flag: before the next iteration. The
    /// increment that is under way is given up.
    pub fn stop_at(&mut self, flag: Arc<AtomicBool>) {
        self.equilibrium.company.stop = Some(flag);
    }

    /// Returns whether the flag of [`Self::stop_at`] is set.
    pub fn is_stopped(&self) -> bool {
        self.equilibrium.is_stopped()
    }

    /// Checks a model without calling its laws: what it consists of, and its constraints.
    ///
    /// # Errors
    ///
    /// The errors that [`Self::new`] would return before it calls a law.
    pub fn check(model: &Model) -> Result<(), ModelError> {
        error::check(model)?;
        Equations::new(model)?;
        Ok(())
    }

    /// Calls the laws of a model that [`Self::check`] has passed, as [`Self::new`] does. For UEXTERNALDB an analysis
    /// begins and ends here, as laws may need what it reads.
    ///
    /// # Errors
    ///
    /// The errors that [`Self::new`] would return, except those that only the pattern of the equations or the virgin
    /// state of all points can show.
    pub fn check_laws(model: &Model) -> Result<(), ModelError> {
        let _databases = ExternalDatabases::begin(model.libraries());
        newton::contact_of(model, &Solids::new(model)?)?;
        Ok(())
    }

    /// Runs all steps; the observer sees the initial state and every accepted increment. A run that was resumed goes on
    /// with the increment after its checkpoint.
    ///
    /// # Errors
    ///
    /// An increment could not be completed, or the observer could not write. What was observed stays valid.
    pub fn run(&mut self, observer: &mut dyn IncrementObserver) -> Result<(), RunError> {
        let mut resumed = self.resumed.take();
        if resumed.is_none() {
            match self.find_datum() {
                Err(_) if self.is_stopped() => return Ok(()),
                found => found?,
            }
            let initial = self.record(0, 0, 0, Vec::new());
            if observer.increment(&initial, &self.snapshot())? == Directive::EndRun {
                return Ok(());
            }
        }
        if let Some(Recorded { steps }) = self.repeats.take() {
            for ((increments, step), number) in steps.iter().zip(&self.model.steps).zip(1..) {
                if self.repeat_step(step, number, increments, observer)? == Directive::EndRun {
                    break;
                }
            }
            return Ok(());
        }
        let first = resumed.as_ref().map_or(1, |position| position.step);
        for (step, number) in self.model.steps.iter().zip(1..).skip_while(|(_, number)| *number < first) {
            let begin = || self.beginning(step, number);
            let position = resumed.take().unwrap_or_else(begin);
            if self.step(position, observer)? == Directive::EndRun {
                break;
            }
        }
        Ok(())
    }

    /// The part of the work that stabilisation and the overstress of laws that extrapolate have taken so far.
    pub fn stabilisation_share(&self) -> f64 {
        let Present { energies, greatest_work, .. } = &self.present;
        if energies.stabilisation == 0.0 { 0.0 } else { energies.stabilisation.abs() / greatest_work }
    }

    /// Refuses the end of a step that what helps over instabilities has governed.
    fn check_stabilisation(&self, step: u32, increment: u32, progress: f64) -> Result<(), RunError> {
        let share = self.stabilisation_share();
        let limit = self.model.controls.max_stabilisation_share.unwrap_or(f64::INFINITY);
        if share <= limit {
            return Ok(());
        }
        let reason = format!(
            "stabilisation took {:.3} % of the work, more than the {:.3} % of max_stabilisation_share",
            100.0 * share,
            100.0 * limit
        );
        let trouble = Setback { reason, fraction: None }.at(Location::System);
        Err(RunError::Failed { step, increment, progress, trouble })
    }

    /// The start of a step.
    fn beginning(&self, step: &Step, number: u32) -> Position {
        let run = StepRun::new(step, &self.present.committed.drives, self.model);
        Position { step: number, run, increment: 0, step_time: 0.0 }
    }

    /// Returns what it has cost so far.
    pub fn statistics(&self) -> AnalysisStatistics {
        self.equilibrium.memory.statistics
    }

    /// Counts, from now on, what takes another branch in each iteration.
    pub fn watch_flips(&mut self) {
        self.equilibrium.watch_flips();
    }

    /// Returns where the time went so far.
    pub fn times(&self) -> Times {
        self.equilibrium.observed.times
    }

    /// The present state.
    pub fn snapshot(&self) -> Snapshot<'_> {
        let Equilibrium { solids, contact, field, system, .. } = &self.equilibrium;
        let Present { committed, total_time: time, .. } = &self.present;
        Snapshot {
            model: self.model,
            solids,
            contact,
            field: field.as_ref(),
            equations: system.equations(),
            committed,
            time: *time,
        }
    }

    /// Finds the equilibrium at the initial drives: contact that repels at gap 0 finds its position.
    fn find_datum(&mut self) -> Result<(), RunError> {
        let target = IncrementGoal::Drives(self.present.committed.drives.clone());
        let context = IncrementContext { step: 1, increment: 1, iteration: 1, ..IncrementContext::default() };
        // to UEXTERNALDB this is the beginning of the first increment
        let first = self.model.steps.first().map(|step| self.beginning(step, 1).run.time_increment(0.0));
        let clock_of_first = Clock { time_increment: first.unwrap_or_default(), ..clock(&context, 0.0) };
        self.databases.increment_starts(clock_of_first);
        let lead = self.along.as_ref().map(|trail| Lead { at: [0, 0], before: None, guide: &trail.datum });
        let mut converged = self
            .equilibrium
            .attempt(Attempt::new(&self.present.committed, &target, context, lead))
            .map_err(|trouble| RunError::Failed { step: 1, increment: 0, progress: 0.0, trouble })?;
        if let Some(trail) = &mut self.trail {
            trail.datum = std::mem::take(&mut converged.guide);
        }
        self.commit(converged, 0.0);
        self.present.datum = self.equilibrium.energies();
        self.present.datum_accounts = self.equilibrium.solids.accounts();
        self.present.energies = Energies::default();
        self.present.greatest_work = 0.0;
        self.equilibrium.memory.statistics.increments = 0;
        Ok(())
    }

    /// One step from a position to its end.
    fn step(&mut self, position: Position, observer: &mut dyn IncrementObserver) -> Result<Directive, RunError> {
        let Position { step: number, mut run, mut increment, mut step_time } = position;
        let mut cutbacks = 0;
        while !run.is_done() {
            if cutbacks == 0 && self.is_checkpoint_due() {
                let checkpoint = self.checkpoint(Position { step: number, run: run.clone(), increment, step_time });
                observer.checkpoint(&checkpoint)?;
            }
            let target = run.target();
            let context = IncrementContext {
                step: number,
                increment: increment + 1,
                iteration: 1,
                step_time,
                total_time: self.present.total_time,
                time_increment: run.time_increment(step_time),
            };
            let mut attempt = self.attempt(&target, context);
            if let Ok(converged) = &attempt
                && self.equilibrium.solids.has_unproven_energies()
            {
                let findings = self.findings(converged);
                let looks = run.smaller_looks(&findings);
                if !looks.is_empty() {
                    self.believed_findings(findings, converged, Some(run.attempted));
                    self.record_look(&run, context.time_increment);
                    self.look_closer(looks, context);
                    attempt = self.attempt(&target, context);
                }
            }
            let to = self.way(&run);
            let mut imbalanced = None;
            let judged = attempt.map_err(|trouble| Judgement { trouble, has_failed: true }).and_then(|converged| {
                let findings = self.findings(&converged);
                imbalanced = run.refuses_energies(&findings);
                let findings = self.believed_findings(findings, &converged, imbalanced);
                run.judge(&converged, self.present.load, findings).map(|()| (converged, findings))
            });
            let verdict = if judged.is_ok() { AttemptVerdict::Stands } else { AttemptVerdict::Refused };
            self.tried.push(Tried { to, time: context.time_increment, verdict, imbalanced });
            match judged {
                Ok((converged, findings)) => {
                    increment += 1;
                    run.accept(&self.present.committed, &converged, findings, self.present.load);
                    step_time += context.time_increment;
                    let directive = self.stands(converged, context, cutbacks, observer)?;
                    cutbacks = 0;
                    if directive != Directive::GoOn {
                        self.check_stabilisation(number, increment, run.progress)?;
                        return Ok(directive);
                    }
                }
                Err(Judgement { trouble, has_failed }) => {
                    self.equilibrium.restore();
                    if self.is_stopped() {
                        return Ok(Directive::EndRun);
                    }
                    self.equilibrium.memory.statistics.cutbacks += 1;
                    cutbacks += 1;
                    let too_many = cutbacks as usize > self.model.controls.max_cutbacks;
                    if too_many || run.reject(&trouble, has_failed) == Advance::Failed {
                        let progress = run.progress;
                        let trouble =
                            limit::at_limit_point(self.model, &self.present.committed, &run).unwrap_or(trouble);
                        return Err(RunError::Failed { step: number, increment: increment + 1, progress, trouble });
                    }
                }
            }
        }
        self.check_stabilisation(number, increment, run.progress)?;
        Ok(Directive::GoOn)
    }

    /// Makes a converged increment the present state, and reports it to the observer.
    fn stands(
        &mut self,
        mut converged: Converged,
        context: IncrementContext,
        cutbacks: u32,
        observer: &mut dyn IncrementObserver,
    ) -> Result<Directive, RunError> {
        let iterations = converged.iterations.clone();
        if let (Some(trail), Some(tried)) = (&mut self.trail, self.tried.last()) {
            trail.push(context.step, *tried, std::mem::take(&mut converged.guide));
        }
        let passed = context.time_increment;
        self.commit(converged, passed);
        self.equilibrium.solids.energies_stand();
        self.databases.increment_ends(clock(&context, passed));
        let tried = std::mem::take(&mut self.tried);
        let record = Record { tried, ..self.record(context.step, context.increment, cutbacks, iterations) };
        Ok(observer.increment(&record, &self.snapshot())?)
    }

    /// One attempt at an increment from the present state.
    fn attempt(&mut self, target: &IncrementGoal, context: IncrementContext) -> Result<Converged, PointFailure> {
        self.databases.increment_starts(clock(&context, 0.0));
        let lead = self.along.as_ref().and_then(|trail| trail.lead(context.step, context.increment));
        self.equilibrium.attempt(Attempt::new(&self.present.committed, target, context, lead))
    }

    /// Attempts smaller increments, until one shows that a law's report of energies contradicts the work whatever their
    /// size; then back to the present state.
    fn look_closer(&mut self, looks: Vec<StepRun>, context: IncrementContext) {
        for mut look in looks {
            self.equilibrium.restore();
            let target = look.target();
            let context = IncrementContext { time_increment: look.time_increment(context.step_time), ..context };
            let attempt = self.attempt(&target, context);
            self.record_look(&look, context.time_increment);
            let Ok(converged) = attempt else { break };
            self.believed_findings(self.findings(&converged), &converged, Some(look.attempted));
        }
        self.equilibrium.restore();
    }

    /// Returns what users should know of the laws, after a run: what was found out of them, and how far they are believed.
    pub fn remarks(&self) -> Vec<String> {
        let mut remarks = self.equilibrium.solids.remarks();
        remarks.extend(self.equilibrium.contact.remarks());
        remarks
    }

    /// The load and the lateral load, N.
    fn measured_load(&self, snapshot: &Snapshot<'_>) -> [f64; 2] {
        let [x, y] = self.model.measured.direction;
        let supports = &self.model.measured.supports;
        let reactions = |along| supports.iter().map(move |&support| snapshot.reaction_of(support, along));
        // a sum of nothing would be −0
        [[x, y], [-y, x]].map(|along| reactions(along).fold(0.0, |sum, reaction| sum + reaction))
    }

    /// Makes a converged increment the present state.
    fn commit(&mut self, converged: Converged, time: f64) {
        let is_through_drag = converged.drag > 0.0;
        let end = converged.end;
        let work = self.work_to(&end);
        self.equilibrium.commit(&self.present.committed, &end);
        self.present.committed = end;
        self.present.stretches.advance(self.model, &self.present.committed.displacements);
        self.present.total_time += time;
        let external_work = self.present.energies.external_work + work;
        self.book_energies(external_work);
        self.present.greatest_work = self.present.greatest_work.max(external_work.abs());
        let load = self.measured_load(&self.snapshot())[0].abs();
        self.present.load.peaked |= load < self.present.load.greatest;
        self.present.load.greatest = self.present.load.greatest.max(load);
        self.present.load.last = load;
        self.present.load.noise = self.equilibrium.memory.rounding;
        let statistics = &mut self.equilibrium.memory.statistics;
        statistics.increments += 1;
        statistics.dragged += u64::from(is_through_drag);
        self.spall();
    }

    /// Books the energies of the committed state, to which supports and loads did this work, N mm.
    fn book_energies(&mut self, external_work: f64) {
        self.present.energies = Energies { external_work, ..self.equilibrium.energies().since(&self.present.datum) };
    }
}

/// Returns the clock that UEXTERNALDB receives for an increment, `passed` after its start.
fn clock(context: &IncrementContext, passed: f64) -> Clock {
    let as_i32 = |n: u32| i32::try_from(n).unwrap_or(i32::MAX);
    Clock {
        time: [context.step_time + passed, context.total_time + passed],
        time_increment: context.time_increment,
        step: as_i32(context.step),
        increment: as_i32(context.increment),
    }
}
