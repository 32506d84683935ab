//! Single precision (REAL*4) where double is meant.
//!
//! A response in double precision follows a change of the strain by 2e-8 of itself; where the strain is rounded to 24 bits, it
//! stands still and then jumps by 6e-8 or more. And a number that has passed through REAL*4 ends with 29 zeros. Jumps alone
//! prove nothing: an iteration in double precision that ends early makes them as large.

use super::report::{Ledger, Verdict};
use super::sample::SampledState;
use super::subject::{Subject, distance, largest};
use umat_abi::host::Alteration;

/// Relative changes of the strain: a third of the distance of neighbours in REAL*4, or less.
const STEP: f64 = 2e-8;
/// Strains tried around each state's: several such distances.
const NEIGHBOURS: usize = 12;
/// Second differences of a response in double precision are rounding and STEP²; in REAL*4 they are 6e-8 to 1.2e-7.
const NOISE: f64 = 5e-9;
/// Beyond this, jumps are no rounding to 24 bits, though a difference of large numbers lost two digits.
const MOST_NOISE: f64 = 1e-5;
/// Relative change of the strain, so small that hardly any lies at a jump, and so large that double precision sees it.
const SMALL_STEP: f64 = 1e-3 * STEP;
/// A kink or jump may lie at some states; single precision shows at most.
const SHARE: f64 = 0.5;
/// Bits of a double's mantissa that REAL*4 has not.
const LOST_BITS: u64 = (1 << 29) - 1;
/// The last bits of a REAL*4 mantissa: they are zero in numbers such as 0.5 or 31800.
const LAST_BITS: u64 = 0xff << 29;

/// The row "double precision" of a plain UMAT.
pub(super) fn check(subject: &mut Subject<'_>, sample: &[SampledState], ledger: &mut Ledger<'_>) {
    ledger.begin("double precision");
    if subject.described() {
        return;
    }
    let noises: Vec<(&SampledState, f64)> =
        sample.iter().filter_map(|state| noise(subject, state).map(|noise| (state, noise))).collect();
    let noisy: Vec<_> = noises.iter().filter(|(_, noise)| *noise > NOISE).collect();
    let worst = noises.iter().map(|(_, noise)| *noise).fold(0.0, f64::max);
    let jumps = format!("stresses jump by {worst:.0e} where the strain changes by {STEP:.0e}");
    let is_noisy = noisy.len() as f64 > SHARE * noises.len() as f64;
    let still = noisy.iter().filter(|(state, noise)| *noise < MOST_NOISE && stands_still(subject, state)).count();
    let is_stepped = is_noisy && still as f64 > SHARE * noisy.len() as f64;
    let arrays: Vec<String> =
        rounded(subject, sample).into_iter().map(|array| format!("{array} has 24 bits")).collect();
    let figure = format!("{worst:.1e}");
    if is_stepped || !arrays.is_empty() {
        let findings: Vec<String> = is_noisy.then_some(jumps).into_iter().chain(arrays).collect();
        return ledger.add(Verdict::Fail, figure, format!("single precision (REAL*4): {}", findings.join("; ")));
    }
    if is_noisy {
        let why = "an iteration that ends early, single precision somewhere, or memory of earlier calls";
        return ledger.add(Verdict::Warn, figure, format!("{jumps}: {why}"));
    }
    ledger.add(Verdict::Pass, figure, "");
}

/// The stress at the end of a state's step, and of the strain there enlarged by a share of itself.
fn beyond(subject: &mut Subject<'_>, state: &SampledState, share: f64) -> Option<Vec<f64>> {
    let step: Vec<f64> = state.step.iter().zip(&state.from.input).map(|(d, x)| d + share * (x + d)).collect();
    subject.evaluate(&state.from, &step).ok().map(|answer| answer.output)
}

/// Returns whether a small change of the strain leaves the stress as it is, to the bit.
fn stands_still(subject: &mut Subject<'_>, state: &SampledState) -> bool {
    let stress = beyond(subject, state, 0.0);
    stress.is_some() && stress == beyond(subject, state, SMALL_STEP)
}

/// The largest second difference of the stress at strains that differ by [`STEP`], relative to the stress.
fn noise(subject: &mut Subject<'_>, state: &SampledState) -> Option<f64> {
    let outputs: Vec<Vec<f64>> = (0..NEIGHBOURS).map_while(|k| beyond(subject, state, STEP * k as f64)).collect();
    let size = outputs.iter().map(|output| largest(output)).fold(0.0, f64::max).max(largest(&state.from.output));
    if outputs.len() < NEIGHBOURS || size == 0.0 {
        return None;
    }
    let second = |w: &[Vec<f64>]| {
        let middle: Vec<f64> = w[1].iter().map(|x| 2.0 * x).collect();
        let ends: Vec<f64> = w[0].iter().zip(&w[2]).map(|(a, b)| a + b).collect();
        distance(&ends, &middle)
    };
    Some(outputs.windows(3).map(second).fold(0.0, f64::max) / size)
}

/// Arrays most of whose entries have the precision of REAL*4.
fn rounded(subject: &mut Subject<'_>, sample: &[SampledState]) -> Vec<&'static str> {
    let mut counts = [("STRESS", 0, 0), ("DDSDDE", 0, 0), ("STATEV", 0, 0)];
    for state in sample {
        let answer = subject.call(&state.from, &state.step, 0.0, Alteration::None);
        for ((_, single, all), values) in counts.iter_mut().zip([&answer.output, &answer.tangent, &answer.statev]) {
            let written = values.iter().filter(|x| x.is_finite() && **x != 0.0);
            *all += written.clone().count();
            *single += written.filter(|x| x.to_bits() & LOST_BITS == 0 && x.to_bits() & LAST_BITS != 0).count();
        }
    }
    counts.into_iter().filter(|(_, single, all)| *single > 0 && 2 * single > *all).map(|(array, ..)| array).collect()
}
