//! Driving a point along a path: [`crate::program`] gives the goals, [`run`] reaches them and reports each increment to
//! an [`Observer`].

mod finite;
mod interface;
mod newton;
mod point;
mod replay;
mod subdivision;
#[cfg(test)]
mod test;

pub use crate::columns::ContactPointState;
use crate::columns::LEADING;
use crate::program::{About, PointKind, Program, Until};
use fe_core::stepping::{Directive, Snapshot, Tried};
pub use interface::directions_of_calls;
pub use point::{Committed as MaterialPoint, components_of_calls};
use serde::{Deserialize, Serialize};
use std::io;
use std::sync::Arc;
use std::sync::atomic::AtomicBool;
use umat_abi::host::{ExternalDatabases, FricCall, UinterCall, UmatCall};

/// One finished increment (or the initial state), as a line of `history.csv`.
#[derive(Clone, Copy, Debug)]
pub struct Row<'a> {
    /// Step, from 1; 0 for the initial state.
    pub step: u32,
    /// Increment within the step, from 1; 0 for the initial state.
    pub increment: u32,
    /// The columns between `increment` and `iterations`, in the order of [`Program::columns`].
    pub values: &'a [f64],
    /// Newton iterations (1 for an increment controlled by strain alone).
    pub iterations: u32,
}

impl Row<'_> {
    /// Returns whether it passes a bound.
    fn passes(&self, until: &Until) -> bool {
        let value = match until.column {
            0 => f64::from(self.step),
            1 => f64::from(self.increment),
            column => self.values.get(column - LEADING.len()).copied().unwrap_or(f64::from(self.iterations)),
        };
        let value = if until.absolute { value.abs() } else { value };
        until.greater_than.is_some_and(|bound| value > bound) || until.less_than.is_some_and(|bound| value < bound)
    }

    /// Returns how a run goes on after the increment. `repeats`: it repeats another run, so that no bound ends it;
    /// `is_ended_by_observer`: its observer asks for the end.
    pub(crate) fn directive(
        &self,
        until: Option<&Until>,
        step_until: Option<&Until>,
        repeats: bool,
        is_ended_by_observer: bool,
    ) -> Directive {
        let is_passed = |until: Option<&Until>| !repeats && until.is_some_and(|until| self.passes(until));
        if is_ended_by_observer || is_passed(until) {
            Directive::EndRun
        } else if is_passed(step_until) {
            Directive::EndStep
        } else {
            Directive::GoOn
        }
    }
}

/// Receives each accepted increment, and what else happens on a path.
pub trait Observer {
    /// A row to be written: the initial state, every n-th increment, the last of each step.
    ///
    /// # Errors
    /// Whatever prevented it from being written; the run stops.
    fn row(&mut self, row: Row<'_>) -> io::Result<()>;

    /// Receives each finished increment with the statistics so far, whether or not its row is written.
    fn increment_done(&mut self, row: Row<'_>, so_far: Statistics);

    /// Receives the attempts that led to a finished increment.
    fn tried(&mut self, _step: u32, _attempts: &[Tried]) {}

    /// The first increment is about to be tried. `_start`: the point before it, with the call's times, temperatures and
    /// fields.
    ///
    /// # Errors
    /// Whatever must keep the plugin from being called; the run stops.
    fn begins(&mut self, _start: Accepted<'_>) -> io::Result<()> {
        Ok(())
    }

    /// A plugin has answered an increment, or a piece of one that was cut back, and the point is about to go there.
    fn accepted(&mut self, _increment: Accepted<'_>) {}

    /// A specimen has reached a state with this slip and load; `is_last`: it is the last of the run, reported before or
    /// not.
    fn state_reached(&mut self, _slip: f64, _load: f64, _snapshot: &Snapshot<'_>, _is_last: bool) {}

    /// A run that fails has reached this state in the increment that it fails at, after the last whole one.
    fn reached(&mut self, _row: Row<'_>) {}

    /// Returns whether the run ends where a law's answer depends on what it reads outside its arrays.
    fn looks_outside_arrays(&self) -> bool {
        true
    }

    /// Returns whether the run shall end with the present increment.
    fn ends_here(&self) -> bool {
        false
    }

    /// A flag that another thread sets to end the run without waiting for the end of a long increment.
    fn stop(&self) -> Option<Arc<AtomicBool>> {
        None
    }

    /// Receives a warning: what the user should know although nothing is wrong.
    fn warn(&mut self, _message: String) {}

    /// Returns the state from which another process resumes the run.
    fn state(&self) -> Vec<u8> {
        Vec::new()
    }
}

/// An increment that a plugin has answered: the point before it, and the last call with its arguments and its answer.
#[derive(Clone, Copy, Debug)]
pub enum Accepted<'a> {
    /// A material point.
    Umat(&'a MaterialPoint, &'a UmatCall),
    /// A contact point.
    Uinter(&'a ContactPointState, &'a UinterCall),
    /// A contact point under a prescribed pressure.
    Fric(&'a ContactPointState, &'a FricCall),
}

/// Cost of a run.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct Statistics {
    /// Increments finished (sub-increments not counted).
    pub increments: u64,
    /// Newton iterations, all attempts together.
    pub iterations: u64,
    /// Calls of the plugin.
    pub plugin_calls: u64,
    /// Attempts given up for a smaller increment.
    pub cutbacks: u64,
}

/// Reason why a run ended early.
#[derive(Debug)]
pub enum Stop {
    /// The point could not be advanced.
    Failed(RunFailure),
    /// A result could not be written.
    Write(io::Error),
}

/// A point that could not be advanced.
#[derive(Clone, Debug, PartialEq)]
pub struct RunFailure {
    /// Step, from 1.
    pub step: u32,
    /// Increment, from 1.
    pub increment: u32,
    /// Message: what happened and what to do.
    pub message: String,
    /// A case that repeats the failed increment from the state before it.
    pub replay: serde_json::Value,
}

/// Kind of failure of a run.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum FailureKind {
    /// No equilibrium, or a plugin that gives up.
    Failed,
    /// A plugin ended the process that called it.
    Crashed,
    /// A call took longer than it may.
    Timeout,
}

/// Kind and place of a run's failure.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct FailedAt {
    /// Kind.
    pub kind: FailureKind,
    /// Step, from 1.
    pub step: u32,
    /// Increment, from 1; 0: before the first.
    pub increment: u32,
}

impl Stop {
    /// A program that could not be run at all.
    pub(crate) fn unusable(message: String) -> Self {
        Self::Failed(RunFailure { step: 1, increment: 1, message, replay: serde_json::Value::Null })
    }
}

impl RunFailure {
    /// Returns where it is.
    pub fn place(&self) -> FailedAt {
        FailedAt { kind: FailureKind::Failed, step: self.step, increment: self.increment }
    }
}

impl From<io::Error> for Stop {
    fn from(error: io::Error) -> Self {
        Self::Write(error)
    }
}

/// Runs a program to its end, to an `until`, or to a failure. Rows that were observed stay valid.
///
/// # Errors
/// [`Stop`]; the statistics show how far it came.
pub fn run(program: &Program, observer: &mut dyn Observer) -> (Statistics, Result<(), Stop>) {
    let mut databases = ExternalDatabases::begin([&program.plugin.library]);
    run_within(program, &mut databases, observer)
}

/// Runs as [`run`] does, within an analysis that goes on afterwards.
pub fn run_within(
    program: &Program,
    databases: &mut ExternalDatabases,
    observer: &mut dyn Observer,
) -> (Statistics, Result<(), Stop>) {
    let mut statistics = Statistics::default();
    let result = match &program.kind {
        PointKind::Point(point) => point::run(program, point, databases, observer, &mut statistics),
        PointKind::Interface(interface) => interface::run(program, interface, databases, observer, &mut statistics),
    };
    (statistics, result)
}

/// Number of increments that a program makes at most.
pub fn increments(program: &Program) -> u64 {
    increments_of_steps(&program.kind).iter().sum()
}

/// Number of increments that each step makes at most.
pub fn increments_of_steps(kind: &PointKind) -> Vec<u64> {
    match kind {
        PointKind::Point(point) => point.steps.iter().map(|step| step.pace.increments() as u64).collect(),
        PointKind::Interface(interface) => interface.steps.iter().map(|step| step.pace.increments() as u64).collect(),
    }
}

/// Writer of the rows; decides when a step or the run ends early.
struct Recorder<'a> {
    observer: &'a mut dyn Observer,
    about: &'a About,
    values: Vec<f64>,
    /// Attempts of the present increment.
    tried: Vec<Tried>,
}

impl<'a> Recorder<'a> {
    fn new(program: &'a Program, observer: &'a mut dyn Observer) -> Self {
        // step, increment and iterations are no values
        let length = program.columns().len() - LEADING.len() - 1;
        Self { observer, about: &program.about, values: vec![0.0; length], tried: Vec::new() }
    }

    fn initial(&mut self, fill: impl FnOnce(&mut [f64])) -> io::Result<()> {
        fill(&mut self.values);
        self.observer.row(Row { step: 0, increment: 0, values: &self.values, iterations: 0 })
    }

    /// Reports the state in which an increment is given up.
    fn reached(&mut self, IncrementPosition { step, increment, .. }: IncrementPosition, fill: impl FnOnce(&mut [f64])) {
        fill(&mut self.values);
        self.observer.reached(Row { step, increment, values: &self.values, iterations: 0 });
    }

    /// Writes the row if it is due or the last of the step or run.
    fn increment(
        &mut self,
        position: IncrementPosition,
        iterations: u32,
        so_far: Statistics,
        step_until: Option<&Until>,
        fill: impl FnOnce(&mut [f64]),
    ) -> io::Result<Directive> {
        fill(&mut self.values);
        let IncrementPosition { step, increment, last } = position;
        let row = Row { step, increment, values: &self.values, iterations };
        let next = row.directive(
            self.about.until.as_ref(),
            step_until,
            self.about.recorded.is_some(),
            self.observer.ends_here(),
        );
        if next != Directive::GoOn || last || (increment as usize).is_multiple_of(self.about.every.max(1)) {
            self.observer.row(row)?;
        }
        self.observer.increment_done(row, so_far);
        Ok(next)
    }
}

/// Position of an increment in the program.
#[derive(Clone, Copy, Debug)]
struct IncrementPosition {
    step: u32,
    increment: u32,
    /// Whether it is the step's last one.
    last: bool,
}
