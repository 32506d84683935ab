//! Random states: committed points after histories of several legs, with a step that leads on.

use super::Options;
use super::random::Random;
use super::report::{Ledger, Verdict};
use super::subject::{Committed, Entry, Subject, Trouble};

/// One state of the sample.
#[derive(Clone, Debug)]
pub(super) struct State {
    /// Its number: with the seed, its name.
    pub(super) number: usize,
    pub(super) from: Committed,
    pub(super) step: Vec<f64>,
}

/// A random end point: sizes over two decades, so that elastic, peak and tail states all occur.
pub(super) fn target(subject: &Subject<'_>, random: &mut Random) -> Vec<f64> {
    let magnitude = random.magnitude();
    let mut other_magnitude = || {
        let value = random.magnitude();
        (value, random.signed())
    };
    (0..subject.entry.inputs())
        .map(|k| match subject.entry {
            Entry::Umat(stress_state) => {
                let shear = if stress_state.components()[k] < 3 { 1.0 } else { 1.4 };
                magnitude * shear * subject.size[k] * other_magnitude().1
            }
            Entry::Uinter(_) | Entry::Fric(_) => {
                let (magnitude, sign) = other_magnitude();
                let pressure = subject.entry == Entry::Fric(k);
                magnitude * subject.size[k] * if pressure { sign.abs() } else { sign }
            }
        })
        .collect()
}

/// The step from a point to a target.
pub(super) fn step_to(point: &Committed, target: &[f64]) -> Vec<f64> {
    target.iter().zip(&point.input).map(|(end, start)| end - start).collect()
}

/// Draws the sample; a plugin that gives no answer fails here, with the state named.
pub(super) fn draw(subject: &mut Subject<'_>, options: &Options, ledger: &mut Ledger<'_>) -> Vec<State> {
    let mut sample = Vec::with_capacity(options.states);
    let (mut cut_backs, mut failures) = (0, 0);
    let mut first_failure = String::new();
    for number in 0..options.states {
        let mut random = Random(options.seed.wrapping_add(number as u64).wrapping_mul(0xD134_2543_DE82_EF95));
        let mut point = subject.virgin();
        match state(subject, &mut random, &mut point, &mut cut_backs) {
            Ok(step) => sample.push(State { number, from: point, step }),
            Err((trouble, end)) => {
                failures += 1;
                if failures == 1 {
                    first_failure = format!(
                        "state {number}: {trouble}, from {:?} to {end:?}, STATEV {:?}",
                        point.input, point.statev
                    );
                }
            }
        }
    }
    let figure = format!("{}/{}", sample.len(), options.states);
    match failures {
        0 if cut_backs == 0 => ledger.add("answers", Verdict::Pass, figure, "random histories"),
        0 => ledger.add("answers", Verdict::Pass, figure, format!("random histories; {cut_backs} cut-backs asked for")),
        _ => ledger.add("answers", Verdict::Fail, figure, first_failure),
    }
    sample
}

/// Leads `point` along up to two legs of up to four increments; returns a further step that the plugin answers.
fn state(
    subject: &mut Subject<'_>,
    random: &mut Random,
    point: &mut Committed,
    cut_backs: &mut usize,
) -> Result<Vec<f64>, (Trouble, Vec<f64>)> {
    const MOST_HALVINGS: usize = 10;
    let legs = (3.0 * random.unit()) as usize;
    for _ in 0..legs {
        let end = target(subject, random);
        let increments = 1 + (4.0 * random.unit()) as usize;
        let step: Vec<f64> = step_to(point, &end).iter().map(|d| d / increments as f64).collect();
        for _ in 0..increments {
            *cut_backs += subject.advance(point, &step).map_err(|trouble| (trouble, end.clone()))?;
        }
    }
    let end = target(subject, random);
    let mut step = step_to(point, &end);
    for _ in 0..MOST_HALVINGS {
        match subject.evaluate(point, &step) {
            Ok(_) => return Ok(step),
            Err(Trouble::CutBack(_)) => step.iter_mut().for_each(|d| *d *= 0.5),
            Err(trouble) => return Err((trouble, end)),
        }
        *cut_backs += 1;
    }
    Err((Trouble::CutBack(0.5), end))
}
