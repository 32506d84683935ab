//! States with a step that leads on: around the case's path, or committed points after random histories of several legs.

use super::Options;
use super::case_path::{CasePath, Increment};
use super::random::Random;
use super::report::{Ledger, Verdict};
use super::subject::{CheckedEntryPoint, Committed, NoAnswer, Subject, largest};
use std::fmt;
use umat_abi::host::CallFailure;

/// One state of the sample.
#[derive(Clone, Debug)]
pub(super) struct SampledState {
    /// Number: with the seed, its name.
    pub(super) number: usize,
    origin: Origin,
    pub(super) from: Committed,
    pub(super) step: Vec<f64>,
}

/// Origin of a state.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Origin {
    /// A random history.
    History,
    /// The neighbourhood of a step and increment of the case.
    Path([i32; 2]),
    /// A long step away from them.
    Excursion([i32; 2]),
    /// A step and increment of the case as it is.
    Increment([i32; 2]),
}

impl SampledState {
    /// Returns whether it is an increment of the case as it is.
    pub(super) fn is_on_the_path(&self) -> bool {
        matches!(self.origin, Origin::Increment(_))
    }
}

/// Up to so many increments of the case's path, evenly spread, the last one among them.
pub(super) fn along_the_path(subject: &Subject<'_>, most: usize) -> Vec<SampledState> {
    let Some(path) = &subject.path else { return Vec::new() };
    let stride = path.increments.len().div_ceil(most.max(1)).max(1);
    let increments = path.increments.iter().rev().step_by(stride);
    let of = |(number, increment): (usize, &Increment)| SampledState {
        number,
        origin: Origin::Increment(increment.from.counters),
        from: increment.from.clone(),
        step: increment.step.clone(),
    };
    increments.enumerate().map(of).collect()
}

impl fmt::Display for SampledState {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let number = self.number;
        match self.origin {
            Origin::History => write!(f, "state {number}"),
            Origin::Increment([step, increment]) => write!(f, "step {step}, increment {increment} of the case"),
            Origin::Path([step, increment]) => {
                write!(f, "state {number} (around step {step}, increment {increment} of the case)")
            }
            Origin::Excursion([step, increment]) => {
                write!(f, "state {number} (a long step from step {step}, increment {increment} of the case)")
            }
        }
    }
}

/// A random end point: sizes over two decades, so that elastic, peak and tail states all occur. Where only the case says how
/// far the law goes, no farther than the case.
pub(super) fn target(subject: &Subject<'_>, random: &mut Random) -> Vec<f64> {
    let has_path = subject.path.as_ref().is_some_and(|path| !path.increments.is_empty());
    let reach = if has_path && !subject.described() { 0.1 } else { 1.0 };
    let magnitude = reach * random.magnitude();
    let mut other_magnitude = || {
        let value = reach * random.magnitude();
        (value, random.signed())
    };
    (0..subject.entry.inputs())
        .map(|k| match subject.entry {
            CheckedEntryPoint::Umat(stress_state) => {
                let shear = if stress_state.components()[k] < 3 { 1.0 } else { 1.4 };
                magnitude * shear * subject.size[k] * other_magnitude().1
            }
            CheckedEntryPoint::Uinter(_) | CheckedEntryPoint::Fric(_) => {
                let (magnitude, sign) = other_magnitude();
                let pressure = subject.entry == CheckedEntryPoint::Fric(k);
                magnitude * subject.size[k] * if pressure { sign.abs() } else { sign }
            }
        })
        .collect()
}

/// The step from a point to a target.
pub(super) fn step_to(point: &Committed, target: &[f64]) -> Vec<f64> {
    target.iter().zip(&point.input).map(|(end, start)| end - start).collect()
}

/// States that are drawn however long it takes.
const FEWEST: usize = 4;

/// Draws the sample; a plugin that gives no answer fails here, with the state named.
pub(super) fn draw(subject: &mut Subject<'_>, options: &Options, ledger: &mut Ledger<'_>) -> Vec<SampledState> {
    let mut sample = Vec::with_capacity(options.states);
    let (mut cut_backs, mut failures, mut far) = (0, 0, 0);
    let mut first_failure = String::new();
    let path = subject.path.clone().filter(|path| !path.increments.is_empty());
    ledger.begin("answers");
    let (start, calls) = (super::processor_time(), subject.calls);
    let elapsed = || super::processor_time() - start;
    let mut left_out = 0;
    for number in (0..options.states).filter(|number| !options.skipped.contains(number)) {
        if sample.len() >= FEWEST && elapsed() > options.share_of_time() {
            left_out += 1;
            continue;
        }
        let mut random = Random::of_state(number);
        let (origin, mut point, ways) = origin(subject, path.as_deref(), number, &mut random);
        ledger.draw(number, matches!(origin, Origin::Excursion(_)));
        match state(subject, &mut random, origin, ways, &mut point, &mut cut_backs) {
            Ok(step) => sample.push(SampledState { number, origin, from: point, step }),
            // what the case never does may be beyond the law
            Err(_) if matches!(origin, Origin::Excursion(_)) => far += 1,
            Err((trouble, end)) => {
                failures += 1;
                if failures == 1 {
                    let state = SampledState { number, origin, from: point, step: Vec::new() };
                    first_failure = format!(
                        "{state}: {trouble}, from {:?} to {end:?}, STATEV {:?}",
                        state.from.input, state.from.statev
                    );
                }
            }
        }
    }
    subject.call_time = elapsed().as_secs_f64() / (subject.calls - calls).max(1) as f64;
    // the rest of the time is for the checks, which call the plugin so many times for each state
    const CALLS: usize = 40;
    const PART: f64 = 0.5;
    let most =
        options.seconds.map_or(usize::MAX, |time| subject.affordable(usize::MAX, CALLS, PART * time)).max(FEWEST);
    left_out += sample.len().saturating_sub(most);
    sample.truncate(most);
    let figure = format!("{}/{}", sample.len(), options.states);
    let mut words = String::from(if path.is_some() { "around the case's path" } else { "random histories" });
    if cut_backs > 0 {
        words += &format!("; {cut_backs} cut-backs asked for");
    }
    if left_out > 0 {
        words += &format!("; {left_out} states left out: a call takes {:.0e} s", subject.call_time);
    }
    if far > 0 {
        words += &format!("; {far} long steps away from the path refused");
    }
    match failures {
        0 if sample.is_empty() => ledger.add(Verdict::Fail, figure, words),
        0 => ledger.add(Verdict::Pass, figure, words),
        _ => ledger.add(Verdict::Fail, figure, first_failure),
    }
    sample
}

/// Draws a few states without a call: of a law that answers none.
pub(super) fn unanswered(subject: &Subject<'_>) -> Vec<SampledState> {
    let path = subject.path.clone().filter(|path| !path.increments.is_empty());
    (0..FEWEST)
        .map(|number| {
            let mut random = Random::of_state(number);
            let (origin, from, increment) = origin(subject, path.as_deref(), number, &mut random);
            let end = match increment {
                Some(increment) => end_of(&from, &like(subject, increment, &mut random)),
                None => target(subject, &mut random),
            };
            let step = admissible(subject, &from, step_to(&from, &end));
            SampledState { number, origin, from, step }
        })
        .collect()
}

/// Returns where state `number` comes from, the point to begin with, and the increment of the case whose like are made there.
fn origin<'p>(
    subject: &Subject<'_>,
    path: Option<&'p CasePath>,
    number: usize,
    random: &mut Random,
) -> (Origin, Committed, Option<&'p Increment>) {
    /// Spreads successive numbers evenly.
    const GOLDEN: f64 = 0.618_033_988_749_894_9;
    // who has metadata promises to answer any history
    let kind = number % 5;
    let (near, far) = if subject.described() { (kind < 2, false) } else { (kind < 4, kind == 4) };
    let Some(path) = path.filter(|_| near || far) else { return (Origin::History, subject.virgin(), None) };
    let along = (GOLDEN * number as f64 + 0.01 * random.unit()).fract();
    let increment = &path.increments[(along * path.increments.len() as f64) as usize];
    let place = increment.from.counters;
    let origin = if near { Origin::Path(place) } else { Origin::Excursion(place) };
    (origin, increment.from.clone(), Some(increment))
}

/// An increment like one of the case's, in another direction and of another size.
fn like(subject: &Subject<'_>, increment: &Increment, random: &mut Random) -> Vec<f64> {
    const DEVIATION: f64 = 0.5;
    /// A step that the case does not make at all, relative to what the inputs reach.
    const LEAST: f64 = 1e-3;
    let factor = random.magnitude().powf(0.7) * if random.unit() < 0.2 { -1.0 } else { 1.0 };
    let solid = matches!(subject.entry, CheckedEntryPoint::Umat(_));
    let all = largest(&increment.step);
    let step = &increment.step;
    (0..step.len())
        .map(|k| {
            let size = if solid { all } else { step[k].abs() }.max(LEAST * subject.size[k]);
            factor * (step[k] + DEVIATION * size * random.signed())
        })
        .collect()
}

/// Leads `point` along up to two legs of up to four increments; returns a further step that the plugin answers.
fn state(
    subject: &mut Subject<'_>,
    random: &mut Random,
    origin: Origin,
    increment: Option<&Increment>,
    point: &mut Committed,
    cut_backs: &mut usize,
) -> Result<Vec<f64>, (NoAnswer, Vec<f64>)> {
    const MOST_HALVINGS: usize = 10;
    let legs = if matches!(origin, Origin::Excursion(_)) { 0 } else { (3.0 * random.unit()) as usize };
    for _ in 0..legs {
        let (end, increments) = match increment {
            Some(increment) => (end_of(point, &like(subject, increment, random)), 1),
            None => (target(subject, random), 1 + (4.0 * random.unit()) as usize),
        };
        let step: Vec<f64> =
            admissible(subject, point, step_to(point, &end)).iter().map(|d| d / increments as f64).collect();
        for _ in 0..increments {
            *cut_backs += subject.advance(point, &step).map_err(|trouble| (trouble, end.clone()))?;
        }
    }
    let end = match increment {
        Some(increment) if matches!(origin, Origin::Path(_)) => end_of(point, &like(subject, increment, random)),
        Some(_) => {
            let size = random.unit();
            let step: Vec<f64> = subject.size.iter().map(|typical| size * typical * random.signed()).collect();
            end_of(point, &step)
        }
        None => target(subject, random),
    };
    let mut step = admissible(subject, point, step_to(point, &end));
    for _ in 0..MOST_HALVINGS {
        match subject.evaluate(point, &step) {
            Ok(_) => return Ok(step),
            Err(NoAnswer::Call(CallFailure::CutBack(_))) => step.iter_mut().for_each(|d| *d *= 0.5),
            Err(trouble) => return Err((trouble, end)),
        }
        *cut_backs += 1;
    }
    Err((NoAnswer::Call(CallFailure::CutBack(0.5)), end))
}

/// The input at the end of a step.
pub(super) fn end_of(point: &Committed, step: &[f64]) -> Vec<f64> {
    point.input.iter().zip(step).map(|(start, d)| start + d).collect()
}

/// A pressure stays one: hosts ask for friction where the surfaces touch.
fn admissible(subject: &Subject<'_>, point: &Committed, mut step: Vec<f64>) -> Vec<f64> {
    const LEAST: f64 = 1e-3;
    if let CheckedEntryPoint::Fric(n) = subject.entry {
        step[n] = (point.input[n] + step[n]).abs().max(LEAST * subject.size[n]) - point.input[n];
    }
    step
}
