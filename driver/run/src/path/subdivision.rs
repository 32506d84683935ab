//! Sub-incrementation: an increment that fails is taken in smaller pieces; the pieces grow again.

use super::{IncrementPosition, Observer, Recorder, RunFailure, Statistics, Stop};
use crate::program::{IterationLimits, PathStep, Program, Until};
use fe_core::stepping::{AttemptVerdict, Directive, LeadingQuantity, Tried};
use std::io;
use umat_abi::host::{CallFailure, compute_in_child};

/// An attempt that did not succeed.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum AttemptFailure {
    /// Try a smaller piece: this fraction of it.
    CutBack {
        /// 0 < fraction < 1.
        fraction: f64,
        /// Message if no piece is small enough.
        reason: String,
    },
    /// No smaller piece can help.
    Fatal(String),
}

impl From<CallFailure> for AttemptFailure {
    fn from(failure: CallFailure) -> Self {
        let reason = failure.to_string();
        match failure.fraction(0.5) {
            Some(fraction) => Self::CutBack { fraction, reason },
            None => Self::Fatal(reason),
        }
    }
}

/// A point that can go from one fraction of an increment to another.
pub(super) trait Divisible {
    /// Goal of its steps.
    type Goal;

    /// Begins a step, of this number from 1.
    ///
    /// # Errors
    /// The step cannot be taken from the present state.
    fn begin(&mut self, step: &PathStep<Self::Goal>, number: u32, program: &Program) -> Result<(), Stop>;

    /// Sets where increment `index` (from 0) of the step leads.
    fn aim(&mut self, step: &PathStep<Self::Goal>, number: u32, index: usize);

    /// Reports to the observer the point before the first increment, whose goal is set.
    ///
    /// # Errors
    /// The observer's.
    fn report_start(&mut self, observer: &mut dyn Observer) -> io::Result<()>;

    /// Finds what the first guess of a step's first increment needs.
    fn prepare_guess(&mut self, _number: u32, _statistics: &mut Statistics) {}

    /// Computes, from the committed state at fraction `from` of the increment, the state at `to`.
    /// Returns the number of iterations.
    fn attempt(&mut self, from: f64, to: f64, statistics: &mut Statistics) -> Result<u32, AttemptFailure>;

    /// Looks again at an increment that is given up after a fraction of it; returns what follows that fraction, if it
    /// shows.
    fn look_again(&mut self, from: f64, statistics: &mut Statistics) -> Option<String>;

    /// Repeats the last call of a successful attempt in a child process, with other numbers around the plugin's arrays; returns
    /// what it reads there, if its answer depends on it.
    fn look_outside(&mut self) -> Option<String>;

    /// Makes the state of the last attempt the committed one, after both were reported to the observer.
    fn commit(&mut self, observer: &mut dyn Observer);

    /// The history's columns from `time` to before `iterations`, at the committed state.
    fn fill(&self, values: &mut [f64]);

    /// A case that repeats the attempt from the committed state to a fraction of the present increment.
    fn replay(&self, program: &Program, to: f64) -> serde_json::Value;
}

/// Takes the steps of a program one by one.
pub(super) fn take_steps<P: Divisible>(
    point: &mut P,
    steps: &[PathStep<P::Goal>],
    program: &Program,
    recorder: &mut Recorder<'_>,
    statistics: &mut Statistics,
) -> Result<(), Stop> {
    for (step, number) in steps.iter().zip(1..) {
        point.begin(step, number, program)?;
        let count = step.pace.increments();
        let taken = program.about.recorded.as_ref().map_or(count, |recorded| recorded.of_step(number).len().min(count));
        for (index, increment) in (0..taken).zip(1..) {
            point.aim(step, number, index);
            if (number, index) == (1, 0) {
                point.report_start(recorder.observer)?;
            }
            if index == 0 {
                point.prepare_guess(number, statistics);
            }
            let position = IncrementPosition { step: number, increment, last: index + 1 == taken };
            match take_increment(point, program, position, step.until.as_ref(), recorder, statistics)? {
                Directive::GoOn => {}
                Directive::EndStep => break,
                Directive::EndRun => return Ok(()),
            }
        }
    }
    Ok(())
}

/// Takes one increment of a program and records it.
fn take_increment(
    point: &mut impl Divisible,
    program: &Program,
    position: IncrementPosition,
    step_until: Option<&Until>,
    recorder: &mut Recorder<'_>,
    statistics: &mut Statistics,
) -> Result<Directive, Stop> {
    let recorded = program.about.recorded.as_ref().and_then(|recorded| {
        recorded.of_step(position.step).get((position.increment as usize).checked_sub(1)?).map(Vec::as_slice)
    });
    let taken = match recorded {
        Some(attempts) => repeat(point, attempts, recorder.observer, statistics),
        None => {
            // each look costs a process: few of many steps
            let is_sampled = match position {
                IncrementPosition { step: 1, increment: 1, .. } => true,
                IncrementPosition { step, last, .. } => last && step.is_power_of_two(),
            };
            let looks_outside = is_sampled && recorder.observer.looks_outside_arrays();
            advance(point, program.controls, looks_outside, recorder, statistics)
        }
    };
    match taken {
        Ok(iterations) => {
            statistics.increments += 1;
            recorder.observer.tried(position.step, recorded.unwrap_or(&recorder.tried));
            Ok(recorder.increment(position, iterations, *statistics, step_until, |values| point.fill(values))?)
        }
        Err(GivenUp { reason, first }) => {
            let IncrementPosition { step, increment, .. } = position;
            recorder.reached(position, |values| point.fill(values));
            let message = format!("plugin '{}', step {step}, increment {increment}: {reason}", program.plugin.name);
            Err(Stop::Failed(RunFailure { step, increment, message, replay: point.replay(program, first) }))
        }
    }
}

/// A piece that succeeds is followed by one this much longer.
const GROWTH: f64 = 2.0;
/// A plugin may ask for a tiny fraction for ever: no single cut is smaller than this.
const SMALLEST_CUT: f64 = 0.05;
/// PNEWDT close to 1 must still shorten the piece.
const LARGEST_CUT: f64 = 0.75;

/// An increment that no piece was small enough for.
struct GivenUp {
    reason: String,
    /// End of the first attempt from the committed state, as a fraction of the increment.
    first: f64,
}

/// Takes a whole increment. Returns the iterations of all successful pieces; on failure what is
/// committed is the state after the last successful piece. `looks_outside`: the end is looked at by [`Divisible::look_outside`].
fn advance(
    point: &mut impl Divisible,
    controls: IterationLimits,
    looks_outside: bool,
    recorder: &mut Recorder<'_>,
    statistics: &mut Statistics,
) -> Result<u32, GivenUp> {
    recorder.tried.clear();
    let mut done = 0.0;
    let mut piece = 1.0;
    let mut first = None;
    let mut cutbacks = 0;
    let mut iterations = 0;
    let smallest = 0.5_f64.powi(i32::try_from(controls.max_cutbacks).unwrap_or(i32::MAX));
    loop {
        let to = if done + piece >= 1.0 - 0.5 * smallest { 1.0 } else { done + piece };
        let first_to = *first.get_or_insert(to);
        let given_up = |reason| GivenUp { reason, first: first_to };
        let attempt = point.attempt(done, to, statistics);
        let verdict = if attempt.is_ok() { AttemptVerdict::Stands } else { AttemptVerdict::Refused };
        recorder.tried.push(Tried { to: LeadingQuantity::Drives(to), time: 0.0, verdict, imbalanced: None });
        match attempt {
            Ok(count) => {
                if looks_outside
                    && to == 1.0
                    && let Some(reason) = point.look_outside()
                {
                    return Err(given_up(reason));
                }
                point.commit(recorder.observer);
                iterations += count;
                if to == 1.0 {
                    return Ok(iterations);
                }
                piece = (to - done) * GROWTH;
                done = to;
                cutbacks = 0;
                first = None;
            }
            Err(AttemptFailure::Fatal(message)) => return Err(given_up(message)),
            Err(AttemptFailure::CutBack { fraction, reason }) => {
                statistics.cutbacks += 1;
                cutbacks += 1;
                piece = (to - done) * fraction.clamp(SMALLEST_CUT, LARGEST_CUT);
                if cutbacks > controls.max_cutbacks || piece < smallest {
                    let given_up =
                        |reason| given_up(format!("{reason} (given up after {cutbacks} cut-backs in a row)"));
                    return Err(given_up(point.look_again(done, statistics).unwrap_or(reason)));
                }
            }
        }
    }
}

/// Takes the pieces of an increment that another run took, with the attempts that it refused.
fn repeat(
    point: &mut impl Divisible,
    attempts: &[Tried],
    observer: &mut dyn Observer,
    statistics: &mut Statistics,
) -> Result<u32, GivenUp> {
    let mut done = 0.0;
    let mut iterations = 0;
    for tried in attempts {
        let to = if let LeadingQuantity::Drives(to) = tried.to { to } else { 1.0 };
        match point.attempt(done, to, statistics) {
            Ok(count) if tried.verdict == AttemptVerdict::Stands => {
                point.commit(observer);
                iterations += count;
                done = to;
            }
            Err(AttemptFailure::Fatal(reason) | AttemptFailure::CutBack { reason, .. })
                if tried.verdict == AttemptVerdict::Stands =>
            {
                let reason = format!("{reason} (the increment is a recorded one, which is repeated as it is)");
                return Err(GivenUp { reason, first: to });
            }
            _ => statistics.cutbacks += 1,
        }
    }
    Ok(iterations)
}

/// What trial calls in a child process show of a call.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Dependence {
    /// Whether the answer depends on what lies outside the plugin's arrays.
    pub(super) on_surroundings: bool,
    /// Whether it depends on the characteristic length.
    pub(super) on_length: bool,
}

impl Dependence {
    /// Makes trial calls in a child process, so that no memory, file or count of the plugin's notices; none is shown where no
    /// process can be had. `ask` returns what a trial shows: on the surroundings, on the length.
    pub(super) fn find(ask: impl FnOnce() -> [bool; 2]) -> Self {
        let found = compute_in_child(|| {
            let [on_surroundings, on_length] = ask().map(u64::from);
            on_surroundings | on_length << 1
        });
        let found = found.ok().flatten().unwrap_or_default();
        Self { on_surroundings: found & 1 != 0, on_length: found & 2 != 0 }
    }
}

/// Returns what to say of a law whose answer depends on a length that the case does not give.
pub(super) fn depends_on_length(argument: &str) -> String {
    format!("its answer depends on {argument}, and the case gives no characteristic_length: 1 mm was passed")
}
