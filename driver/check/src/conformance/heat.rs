//! Derivatives that couple a UMAT with a temperature, DDSDDT, DRPLDE and DRPLDT, against differences of STRESS and RPL; those of
//! UMATHT, DUDT, DUDG, DFDT and DFDG, against differences of U and FLUX.

use super::random::Random;
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

/// The derivatives of UMATHT by their names.
const OF_TRANSFER: [(&str, Measure); 4] = [
    ("DUDT", Measure::EnergyByTemperature),
    ("DUDG", Measure::EnergyByGradient),
    ("DFDT", Measure::FluxByTemperature),
    ("DFDG", Measure::FluxByGradient),
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
                Some(classify(&measure.reported(&answer), mismatch, Some(stress_state)))
            })
            .collect();
        let is_choice = kinds.iter().all(|kind| *kind == Kind::Zero);
        let with = if is_of_heat { with } else { "" };
        findings.report(subject, measure, with, (&(summary(&kinds) + with), is_choice), ledger);
    }
}

/// The rows of the derivatives of UMATHT, if the library has it; `props`: its parameters, without which it is not called.
pub(super) fn check_transfer(
    subject: &mut Subject<'_>,
    props: Option<&[f64]>,
    sample: &[SampledState],
    ledger: &mut Ledger<'_>,
) {
    /// Of the numbers for the gradients.
    const CHECK: u64 = 0x7E4B;
    let has_it = subject.plugin.library.routines().iter().any(|routine| routine.symbol == "umatht");
    if !has_it || !matches!(subject.entry, CheckedEntryPoint::Umat(_)) {
        return;
    }
    let Some(props) = props else {
        let detail = "its derivatives are compared with differences if --umatht-props gives it its PROPS";
        return ledger.row("UMATHT", Verdict::Info, "not called", detail);
    };
    let (along, count) = states(subject, sample, CALLS);
    let Some(mut subject_with) = subject.with_umatht(props) else { return };
    let mut random = Random::of_check(CHECK);
    let with_gradient = |state: &SampledState| {
        let mut state = state.clone();
        let size = Measure::EnergyByTemperature.sizes(subject, &state.from, &state.step)[0];
        state.from.setting.temperature_gradient = std::array::from_fn(|_| size * random.signed());
        state
    };
    let all: Vec<SampledState> = along.iter().chain(&sample[..count]).map(with_gradient).collect();
    let here = &mut subject_with;
    let answers: Vec<Answer> = all.iter().filter_map(|state| here.evaluate(&state.from, &state.step).ok()).collect();
    for (name, measure) in OF_TRANSFER {
        ledger.begin(name);
        if answers.is_empty() {
            ledger.add(Verdict::Fail, "none", "UMATHT fails, or returns NaN or infinity, in all states");
            continue;
        }
        let value = answers.iter().fold(0.0_f64, |most, answer| most.max(largest(&measure.value(answer.clone()))));
        let sizes = all.iter().flat_map(|state| measure.sizes(here, &state.from, &state.step));
        let least = ROUNDING_OF_DIFFERENCES * value / sizes.fold(f64::INFINITY, f64::min);
        let findings = Findings::of(here, all.iter(), measure, least);
        let kinds: Vec<Kind> = findings
            .wrong
            .iter()
            .filter_map(|(state, mismatch)| {
                let answer = here.evaluate(&state.from, &state.step).ok()?;
                Some(classify(&measure.reported(&answer), mismatch, None))
            })
            .collect();
        // iterations get there by and by without these two
        let may_be_left = matches!(measure, Measure::EnergyByGradient | Measure::FluxByTemperature);
        let is_zero = kinds.iter().all(|kind| *kind == Kind::Zero);
        let what = match (is_zero, may_be_left) {
            (true, true) => "left at 0: iterations for the temperature converge slowly without it".to_owned(),
            (true, false) => "left at 0".to_owned(),
            (false, _) => summary(&kinds),
        };
        findings.report(here, measure, "", (&what, is_zero && may_be_left), ledger);
    }
    for (array, times) in std::mem::take(&mut subject_with.overruns) {
        *subject.overruns.entry(array).or_default() += times;
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

/// Returns what a wrong derivative is. `stress_state`: that of its components, if these are strains.
fn classify(reported: &[f64], mismatch: &Mismatch, stress_state: Option<StressState>) -> Kind {
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
    let direct = |state: StressState| state.components().iter().take_while(|component| **component < 3).count();
    if let Some(direct) = stress_state.map(direct)
        && derivative.len() > direct
    {
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
