//! Checks whether a sample has left the range in which the law is linear: a check that has seen only that range has
//! seen nothing of a damage law.

use super::report::{Ledger, Verdict};
use super::sample::SampledState;
use super::subject::{CheckedEntryPoint, Committed, Subject, distance, largest};
use super::tolerances::{NONLINEAR, ROUNDING_OF_F};
use umat_abi::host::{Alignment, Alteration, CallOutcome, Probed};

/// Number of states in which nonlinearity and dependence on STATEV are tested.
const ASKED: usize = 4;
/// Values given to state variables: damage, plastic strains, equivalent stresses.
const VALUES: [f64; 7] = [1e-4, 1e-3, 1e-2, 0.5, 1.0, 10.0, 1e3];

/// Returns whether the stress that a step raises differs from the one that the same step raises at the start, made small there and
/// enlarged; `None` if a call gives no stress.
pub(super) fn is_nonlinear(subject: &mut Subject<'_>, from: &Committed, step: &[f64]) -> Option<bool> {
    const SMALL: f64 = 1e-3;
    let mut virgin = subject.virgin_during(from);
    let mut small: Vec<f64> = step.iter().map(|d| SMALL * d).collect();
    if let CheckedEntryPoint::Fric(n) = subject.entry {
        // friction sticks under a pressure: nothing sticks at the start, where there may be none
        virgin.input[n] = from.input[n] + step[n];
        small[n] = 0.0;
    }
    // the tangent may be anything
    let mut stress = |from: &Committed, step: &[f64]| {
        let answer = subject.call(from, step, 0.0, Alteration::None);
        let is_given = answer.outcome == CallOutcome::Done && answer.output.iter().all(|x| x.is_finite());
        is_given.then_some(answer.output)
    };
    let end = stress(from, step)?;
    let zero = vec![0.0; step.len()];
    let base = stress(&virgin, &zero)?;
    let probe = stress(&virgin, &small)?;
    let raised: Vec<f64> = end.iter().zip(&from.output).map(|(end, start)| end - start).collect();
    let elastic: Vec<f64> = (0..end.len()).map(|k| base[k] - virgin.output[k] + (probe[k] - base[k]) / SMALL).collect();
    // what rounding makes of F, seen through the small step
    let of_gradient = if subject.finite { ROUNDING_OF_F / SMALL } else { 0.0 };
    let stiffness = largest(&subject.output_size) / largest(&subject.size);
    // where the strain is free to follow temperature or time, both responses are small differences of these
    let sizes = [&end, &virgin.output, &base, &probe].map(|stress| largest(stress));
    let rounding = 1e-9 * largest(&sizes) + of_gradient * stiffness;
    Some(distance(&raised, &elastic) > NONLINEAR * largest(&elastic).max(largest(&raised)) + rounding)
}

/// Returns whether a step and its reversal leave a residual change of the stress or of a state variable that does not shrink in
/// increments half as long, as that of an explicit integration of elasticity does.
fn is_irreversible(subject: &mut Subject<'_>, from: &Committed, step: &[f64]) -> bool {
    const KEPT: f64 = 1e-3;
    const STAYS: f64 = 0.75;
    let Some(once) = kept(subject, from, step, 1).filter(|parts| parts.iter().any(|part| *part > KEPT)) else {
        return false;
    };
    let twice = kept(subject, from, step, 2).unwrap_or_default();
    once.iter().zip(twice).any(|(once, twice)| *once > KEPT && twice > STAYS * once)
}

/// Returns which parts of their changes along a step the stress and the state variables keep after the way back, each way in so many
/// increments, at the same temperature and field variables; `None` if a call gives no answer.
fn kept(subject: &mut Subject<'_>, from: &Committed, step: &[f64], increments: u32) -> Option<Vec<f64>> {
    const ROUNDING: f64 = 1e-9;
    let mut start = from.clone();
    start.setting.temperature[1] = 0.0;
    start.setting.fields[1].fill(0.0);
    let share = 1.0 / f64::from(increments);
    let mut point = start.clone();
    let mut lead = |sign: f64| {
        let increment: Vec<f64> = step.iter().map(|d| sign * share * d).collect();
        for _ in 0..increments {
            subject.share = share;
            let advanced = subject.advance(&mut point, &increment);
            subject.share = 1.0;
            advanced.ok()?;
        }
        Some(point.clone())
    };
    let (turn, end) = (lead(1.0)?, lead(-1.0)?);
    let part = |start: &[f64], turn: &[f64], end: &[f64]| {
        let change = distance(turn, start).max(ROUNDING * largest(start)).max(f64::MIN_POSITIVE);
        distance(end, start) / change
    };
    let histories = (0..subject.nstatv).filter(|&k| subject.is_history(k)).map(|k| k..k + 1);
    let of_states = histories.map(|k| part(&start.statev[k.clone()], &turn.statev[k.clone()], &end.statev[k]));
    Some(std::iter::once(part(&start.output, &turn.output, &end.output)).chain(of_states).collect())
}

/// Counts the nonlinear states, and judges whether the sample says anything of the law.
pub(super) fn check(subject: &mut Subject<'_>, sample: &[SampledState], ledger: &mut Ledger<'_>) {
    const MOST_INCREMENTS: usize = 200;
    const CALLS: usize = 4;
    const TIME: f64 = 1.0;
    ledger.begin("nonlinear states");
    // states in which the stress is nonlinear, a state variable moves, the way back does not undo the step
    let (mut nonlinear, mut moving, mut irreversible) = (0, 0, 0);
    let mut has_moved = vec![false; subject.nstatv];
    let has_histories = (0..subject.nstatv).any(|k| subject.is_history(k));
    for state in sample {
        nonlinear += usize::from(is_nonlinear(subject, &state.from, &state.step) == Some(true));
        if let Ok(answer) = subject.evaluate(&state.from, &state.step) {
            let moves = |k: &usize| subject.is_history(*k) && answer.statev[*k] != state.from.statev[*k];
            let moved: Vec<usize> = (0..subject.nstatv).filter(moves).collect();
            moving += usize::from(!moved.is_empty());
            moved.into_iter().for_each(|k| has_moved[k] = true);
        }
        irreversible += usize::from(has_histories && is_irreversible(subject, &state.from, &state.step));
    }
    // increments of the case's path that were looked at, and those that were nonlinear
    let (mut looked_at, mut nonlinear_of_path) = (0, 0);
    if let Some(path) = subject.path.clone() {
        let stride = path.increments.len().div_ceil(subject.affordable(MOST_INCREMENTS, CALLS, TIME)).max(1);
        for increment in path.increments.iter().step_by(stride) {
            looked_at += 1;
            nonlinear_of_path += usize::from(is_nonlinear(subject, &increment.from, &increment.step) == Some(true));
        }
    }
    let figure = format!("{nonlinear}/{}", sample.len());
    let mut words = format!("the stress is not the elastic one in {nonlinear} states");
    if has_histories {
        words += &format!(", a state variable moved in {moving}, {irreversible} are not undone by the way back");
    }
    if looked_at > 0 {
        words += &format!("; of the case's path {nonlinear_of_path} of {looked_at} increments are nonlinear");
    }
    // what moves and is undone by every way back, as stored strains are, was seen as it is
    let undone = |k: usize| irreversible == 0 && has_moved[k];
    let influential = |subject: &mut Subject<'_>| influential_state(subject, sample, undone);
    let why = if nonlinear > 0 {
        if irreversible > 0 || !has_histories {
            None
        } else {
            // a state variable that is output alone does not make the law irreversible
            influential(subject).map(|state| {
                format!(
                    "no state yielded: the stress depends on {state}, and every sampled step is undone by the way back"
                )
            })
        }
    } else if nonlinear_of_path > 0 {
        Some("the sample missed what the case does".to_owned())
    } else if let Some(state) = influential(subject) {
        Some(format!("the stress depends on {state}, and no sampled state shows how"))
    } else {
        nonlinear_beyond(subject, sample).map(|factor| format!("it is nonlinear at {factor} times what was sampled"))
    };
    let Some(why) = why else {
        let words = if nonlinear > 0 { words } else { format!("linear everywhere it was checked; {words}") };
        return ledger.add(Verdict::Pass, figure, words);
    };
    let advice = if subject.path.is_some() { "give a case that goes farther" } else { "give a case by --case" };
    ledger.add(Verdict::NotTested, figure, format!("not tested: {why}; {words}; {advice}"));
}

/// Returns how many times farther than the sample a first step finds the law nonlinear, or ended by what it cannot answer. Asked
/// in a process of its own first.
fn nonlinear_beyond(subject: &mut Subject<'_>, sample: &[SampledState]) -> Option<f64> {
    const FACTORS: [f64; 5] = [3.0, 10.0, 100.0, 1e3, 1e4];
    /// Midpoint increments of the deformation gradient end at 2.
    const LONGEST_FINITE_STEP: f64 = 1.0;
    let farthest = if subject.finite { LONGEST_FINITE_STEP / largest(&subject.size) } else { f64::INFINITY };
    for factor in FACTORS.into_iter().filter(|factor| *factor <= farthest) {
        for state in sample.iter().rev().take(ASKED) {
            // friction is a cone: it slides farther under the same pressure
            let slips = if let CheckedEntryPoint::Fric(n) = subject.entry { n } else { state.step.len() };
            let reach =
                state.step.iter().zip(&subject.size).take(slips).fold(0.0_f64, |m, (d, size)| m.max((d / size).abs()));
            let mut step = state.step.clone();
            step[..slips].iter_mut().for_each(|d| *d *= factor / reach);
            let virgin = subject.virgin_during(&state.from);
            let ends =
                !subject.described() && matches!(subject.probe(&virgin, &step, Alignment::End), Ok(Probed::Ended(_)));
            if ends || is_nonlinear(subject, &virgin, &step) == Some(true) {
                return Some(factor);
            }
        }
    }
    None
}

/// Returns a state variable on which the stress depends, other than the known ones. A separate process tries first: values that
/// the law never produces may end it.
fn influential_state(
    subject: &mut Subject<'_>,
    sample: &[SampledState],
    is_known: impl Fn(usize) -> bool,
) -> Option<String> {
    for state in sample.iter().rev().take(ASKED) {
        let expected = subject.call(&state.from, &state.step, 0.0, Alteration::None);
        let histories: Vec<usize> = (0..subject.nstatv).filter(|&k| subject.is_history(k) && !is_known(k)).collect();
        for k in histories {
            for value in VALUES.into_iter().chain([2.0 * state.from.statev[k], 100.0 * state.from.statev[k]]) {
                let mut from = state.from.clone();
                from.statev[k] = value;
                let comes_back = subject.described()
                    || !matches!(subject.probe(&from, &state.step, Alignment::End), Ok(Probed::Ended(_)));
                if !comes_back {
                    return Some(subject.state_name(k));
                }
                let answer = subject.call(&from, &state.step, 0.0, Alteration::None);
                let scale = largest(&expected.output).max(largest(&subject.output_size));
                let is_same = answer.outcome == expected.outcome
                    && answer.output.iter().all(|x| x.is_finite())
                    && distance(&answer.output, &expected.output) <= 1e-9 * scale;
                if !is_same {
                    return Some(subject.state_name(k));
                }
            }
        }
    }
    None
}
