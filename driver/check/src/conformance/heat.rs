//! Derivatives that couple a UMAT with a temperature, DDSDDT, DRPLDE and DRPLDT, against differences of STRESS and RPL.

use super::report::{Ledger, Verdict};
use super::sample::SampledState;
use super::subject::{Answer, CheckedEntryPoint, Subject, distance, largest};
use super::tangent::{Findings, Measure, Mismatch, states};
use super::tolerances::ROUNDING_OF_DIFFERENCES;
use std::fmt;
use umat_abi::law::StressState;

/// The derivatives by their names.
const DERIVATIVES: [(&str, Measure); 3] = [
    ("DDSDDT", Measure::StressByTemperature),
    ("DRPLDE", Measure::HeatByStrain),
    ("DRPLDT", Measure::HeatByTemperature),
];

/// Derivative that a wrong one is in truth.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Kind {
    /// Left at 0.
    Zero,
    /// Correct except for a factor on all entries.
    Scaled(f64),
    /// Correct except for a factor on the shear components.
    Shears(f64),
    Wrong,
}

impl fmt::Display for Kind {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Zero => f.write_str(
                "left at 0: staggered steps do not need it, steps that solve temperature and displacements together converge slowly \
                 without it",
            ),
            Self::Scaled(factor) if is_near(*factor, -1.0) => f.write_str("right except for its sign"),
            Self::Scaled(factor) if (factor - 1.0).abs() < 5e-3 => write!(f, "off by {:.1e} of itself", factor - 1.0),
            Self::Scaled(factor) => write!(f, "{factor:.3} of what it should be"),
            Self::Shears(factor) => write!(
                f,
                "right except for shears: {factor:.3} of what they should be; STRAN and DSTRAN have engineering shears, gamma = 2 \
                 epsilon"
            ),
            Self::Wrong => f.write_str("wrong"),
        }
    }
}

fn is_near(a: f64, b: f64) -> bool {
    (a - b).abs() < 1e-2
}

/// The rows of the derivatives of a UMAT that writes any of the four; the others get none.
pub(super) fn check(subject: &mut Subject<'_>, sample: &[SampledState], ledger: &mut Ledger<'_>) {
    let CheckedEntryPoint::Umat(stress_state) = subject.entry else { return };
    ledger.begin(DERIVATIVES[0].0);
    let (along, count) = states(subject, sample, CALLS);
    let all: Vec<&SampledState> = along.iter().chain(&sample[..count]).collect();
    let answers: Vec<Answer> = all.iter().filter_map(|state| subject.evaluate(&state.from, &state.step).ok()).collect();
    if answers.iter().all(|answer| answer.heat_values() == [0.0; 14]) {
        return;
    }
    let are_finite = |values: &[f64]| values.iter().all(|value| value.is_finite());
    let generates = subject.plugin.library.routines().iter().any(|routine| routine.symbol == "hetval");
    let with = if generates { "; RPL with FLUX(1) of HETVAL, DRPLDT with its FLUX(2)" } else { "" };
    let largest_heat = answers.iter().fold(0.0_f64, |most, answer| most.max(answer.heat.rpl.abs()));
    let largest_stress = answers.iter().fold(0.0_f64, |most, answer| most.max(largest(&answer.output)));
    for (name, measure) in DERIVATIVES {
        ledger.begin(name);
        let is_of_heat = measure != Measure::StressByTemperature;
        if is_of_heat && answers.iter().any(|answer| !answer.heat.rpl.is_finite()) {
            ledger.add(Verdict::Fail, "NaN", "RPL is NaN or infinite");
            continue;
        }
        if answers.iter().any(|answer| !are_finite(&measure.reported(answer))) {
            ledger.add(Verdict::Fail, "NaN", "it has entries that are NaN or infinite");
            continue;
        }
        let is_zero = |answer: &Answer| answer.heat.rpl == 0.0 && largest(&measure.reported(answer)) == 0.0;
        if is_of_heat && answers.iter().all(is_zero) {
            ledger.skip("RPL is 0 in all states");
            continue;
        }
        let value = if is_of_heat { largest_heat } else { largest_stress };
        let size =
            all.iter().flat_map(|state| measure.sizes(subject, &state.from, &state.step)).fold(f64::INFINITY, f64::min);
        let least = ROUNDING_OF_DIFFERENCES * value / size;
        let findings = Findings::of(subject, all.iter().copied(), measure, least);
        let kinds: Vec<Kind> = findings
            .wrong
            .iter()
            .filter_map(|(state, mismatch)| {
                let answer = subject.evaluate(&state.from, &state.step).ok()?;
                Some(classify(&measure.reported(&answer), mismatch, stress_state))
            })
            .collect();
        let is_choice = kinds.iter().all(|kind| *kind == Kind::Zero);
        let with = if is_of_heat { with } else { "" };
        findings.report(subject, measure, with, (&(summary(&kinds) + with), is_choice), ledger);
    }
}

/// Calls for one state: the strains' share is the largest.
const CALLS: usize = 120;

/// One word for all wrong states. Where a state has shears alone a factor on them is one on all.
fn summary(kinds: &[Kind]) -> String {
    let shears = kinds.iter().copied().find(|kind| matches!(kind, Kind::Shears(_)));
    let first = shears.or_else(|| kinds.first().copied()).unwrap_or(Kind::Wrong);
    let same = |kind: &Kind| match (first, *kind) {
        (Kind::Scaled(a), Kind::Scaled(b)) | (Kind::Shears(a), Kind::Shears(b) | Kind::Scaled(b)) => is_near(a, b),
        (a, b) => a == b,
    };
    if kinds.iter().all(same) { first } else { Kind::Wrong }.to_string()
}

/// Returns what a wrong derivative is.
fn classify(reported: &[f64], mismatch: &Mismatch, stress_state: StressState) -> Kind {
    /// Rounding of the differences, and of a law with a few digits.
    const SAME: f64 = 1e-5;
    if largest(reported) == 0.0 {
        return Kind::Zero;
    }
    let derivative = &mismatch.differences;
    let is = |values: &[f64]| distance(values, reported) <= SAME * largest(reported).max(largest(derivative));
    // the factor between two vectors that explains them best
    let factor = |from: &[f64], to: &[f64]| {
        let square: f64 = from.iter().map(|value| value * value).sum();
        if square > 0.0 { from.iter().zip(to).map(|(from, to)| from * to).sum::<f64>() / square } else { 1.0 }
    };
    let of_all = factor(derivative, reported);
    if is(&derivative.iter().map(|value| of_all * value).collect::<Vec<f64>>()) {
        return Kind::Scaled(of_all);
    }
    let direct = stress_state.components().iter().take_while(|component| **component < 3).count();
    if derivative.len() > direct {
        let of_shears = factor(&derivative[direct..], &reported[direct..]);
        let shears = derivative[direct..].iter().map(|value| of_shears * value);
        if is(&derivative[..direct].iter().copied().chain(shears).collect::<Vec<f64>>()) {
            return Kind::Shears(of_shears);
        }
    }
    Kind::Wrong
}

#[cfg(test)]
mod test;
