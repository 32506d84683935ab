//! Whether a sample has left the range in which the law is linear: a check that has seen only that range has seen nothing of
//! a damage law.

use super::report::{Ledger, Verdict};
use super::sample::State;
use super::subject::{Committed, Entry, Subject, distance, largest};
use super::tolerances::NONLINEAR;
use umat_abi::host::{Alignment, Alteration, CallOutcome, Probed};

const CHECK: &str = "nonlinear states";
/// States in which the stress is asked whether it depends on STATEV.
const ASKED: usize = 4;
/// Values given to state variables: damage, plastic strains, equivalent stresses.
const VALUES: [f64; 7] = [1e-4, 1e-3, 1e-2, 0.5, 1.0, 10.0, 1e3];

/// Whether the stress that a step raises differs from the one that the same step raises at the start, made small there and
/// enlarged; `None` if a call gives no stress.
pub(super) fn is_nonlinear(subject: &mut Subject<'_>, from: &Committed, step: &[f64]) -> Option<bool> {
    const SMALL: f64 = 1e-3;
    let mut virgin = subject.virgin_during(from);
    let mut small: Vec<f64> = step.iter().map(|d| SMALL * d).collect();
    if let Entry::Fric(n) = subject.entry {
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
    let rounding = 1e-9 * largest(&end).max(largest(&virgin.output));
    Some(distance(&raised, &elastic) > NONLINEAR * largest(&elastic).max(largest(&raised)) + rounding)
}

/// What was seen of a law's nonlinearity.
#[derive(Clone, Copy, Debug, Default)]
struct Seen {
    stress: usize,
    states: usize,
    /// Increments of the case's path that were looked at, and those that were nonlinear.
    path: [usize; 2],
}

/// Counts the nonlinear states, and judges whether the sample says anything of the law.
pub(super) fn check(subject: &mut Subject<'_>, sample: &[State], ledger: &mut Ledger<'_>) {
    const LOOKED_AT: usize = 200;
    ledger.begin(CHECK);
    let mut seen = Seen::default();
    for state in sample {
        seen.stress += usize::from(is_nonlinear(subject, &state.from, &state.step) == Some(true));
        let moved = subject.evaluate(&state.from, &state.step).is_ok_and(|answer| {
            (0..subject.nstatv).any(|k| subject.is_history(k) && answer.statev[k] != state.from.statev[k])
        });
        seen.states += usize::from(moved);
    }
    if let Some(path) = subject.path.clone() {
        let stride = path.increments.len().div_ceil(LOOKED_AT).max(1);
        for increment in path.increments.iter().step_by(stride) {
            seen.path[0] += 1;
            seen.path[1] += usize::from(is_nonlinear(subject, &increment.from, &increment.step) == Some(true));
        }
    }
    let figure = format!("{}/{}", seen.stress, sample.len());
    let mut words = format!("the stress is not the elastic one in {} states", seen.stress);
    if (0..subject.nstatv).any(|k| subject.is_history(k)) {
        words += &format!(", a state variable moved in {}", seen.states);
    }
    if seen.path[0] > 0 {
        words += &format!("; of the case's path {} of {} increments are nonlinear", seen.path[1], seen.path[0]);
    }
    if seen.stress > 0 {
        return ledger.add(CHECK, Verdict::Pass, figure, words);
    }
    let why = if seen.path[1] > 0 {
        "the sample missed what the case does".to_owned()
    } else if let Some(state) = influential_state(subject, sample) {
        format!("the stress depends on {state}, and no sampled state shows how")
    } else if let Some(factor) = nonlinear_beyond(subject, sample) {
        format!("it is nonlinear at {factor} times what was sampled")
    } else {
        return ledger.add(CHECK, Verdict::Pass, figure, format!("linear everywhere it was looked at; {words}"));
    };
    let advice = if subject.path.is_some() { "give a case that goes farther" } else { "give a case by --case" };
    ledger.add(CHECK, Verdict::NotTested, figure, format!("not tested: {why}; {words}; {advice}"));
}

/// How many times farther than the sample a first step finds the law nonlinear, or ended by what it cannot answer. Asked
/// in a process of its own first. At finite strain the rotation alone is nonlinear.
fn nonlinear_beyond(subject: &mut Subject<'_>, sample: &[State]) -> Option<f64> {
    const FACTORS: [f64; 5] = [3.0, 10.0, 100.0, 1e3, 1e4];
    if subject.finite {
        return None;
    }
    for factor in FACTORS {
        for state in sample.iter().rev().take(ASKED) {
            // friction is a cone: it slides farther under the same pressure
            let slips = if let Entry::Fric(n) = subject.entry { n } else { state.step.len() };
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

/// A state variable on which the stress depends. Asked in a process of its own first: values that the law never gives may
/// end it.
fn influential_state(subject: &mut Subject<'_>, sample: &[State]) -> Option<String> {
    for state in sample.iter().rev().take(ASKED) {
        let expected = subject.call(&state.from, &state.step, 0.0, Alteration::None);
        let histories: Vec<usize> = (0..subject.nstatv).filter(|&k| subject.is_history(k)).collect();
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
