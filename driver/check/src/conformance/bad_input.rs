//! NaN, infinity, wrong counts and wrong parameters: refused without touching what must stay.
//!
//! Input that makes no sense: arrays as they were and a cut-back request, or NaN and a cut-back request. Wrong
//! configuration: NaN and a cut-back request, because some hosts ignore PNEWDT and would go on with zeros.

use super::messages::Capture;
use super::metadata::parameter_of;
use super::report::{Ledger, Verdict};
use super::sample::SampledState;
use super::subject::{Answer, CheckedEntryPoint, Committed, Subject};
use umat_abi::host::{Alteration, CallOutcome, Library, same_bits};
use umat_abi::law::StressState;
use umat_abi::metadata::flags;

const BAD: [f64; 3] = [f64::NAN, f64::INFINITY, f64::NEG_INFINITY];
/// The tangent before a call: what stays untouched shows.
const FILLING: f64 = 4.25e44;
/// States tried.
const STATES: usize = 4;

/// The values as they were before the call.
fn untouched(from: &Committed, answer: &Answer) -> bool {
    same_bits(&from.output, &answer.output)
        && same_bits(&from.statev, &answer.statev)
        && same_bits(&from.energies, &answer.energies)
        && answer.tangent.iter().all(|x| *x == FILLING)
}

/// The first `count` stresses NaN, the states as they were.
fn not_a_number(from: &Committed, answer: &Answer, count: usize) -> bool {
    answer.output[..count].iter().all(|x| x.is_nan()) && same_bits(&from.statev[..answer.statev.len()], &answer.statev)
}

fn cut_back(answer: &Answer) -> bool {
    matches!(answer.outcome, CallOutcome::CutBack(_))
}

/// States later in their histories, with non-zero STATEV if there are any.
fn chosen(sample: &[SampledState]) -> impl Iterator<Item = &SampledState> {
    let eventful = sample.iter().filter(|state| state.from.statev.iter().any(|x| *x != 0.0));
    let quiet = sample.iter().filter(|state| state.from.statev.iter().all(|x| *x == 0.0));
    eventful.chain(quiet).take(STATES)
}

/// NaN and infinities in strains, increments and states, one at a time.
pub(super) fn not_finite(subject: &mut Subject<'_>, sample: &[SampledState], ledger: &mut Ledger<'_>) {
    ledger.begin("NaN and infinity");
    let described = subject.described();
    // Third-party code may loop for ever on infinity; NaN ends most loops.
    let values = if described { &BAD[..] } else { &BAD[..1] };
    let mut refusals = Refusals::new(&subject.plugin.library);
    for state in chosen(sample) {
        for &value in values {
            for (name, from, step) in spoiled(subject, state, value) {
                let answer = subject.call(&from, &step, FILLING, Alteration::None);
                let refused = untouched(&from, &answer) || not_a_number(&from, &answer, answer.output.len());
                refusals.note(&from, &answer, refused, || format!("{name} = {value}"));
            }
        }
    }
    let wrong = if described { Verdict::Fail } else { Verdict::Info };
    refusals.report(ledger, "outputs untouched", wrong);
}

/// Returns what a plugin did instead of refusing.
fn words(from: &Committed, answer: &Answer) -> String {
    let mut words = vec![match answer.outcome {
        CallOutcome::Done => "no cut-back asked for".to_owned(),
        CallOutcome::CutBack(fraction) => format!("cut-back to {fraction}"),
    }];
    if answer.output.iter().any(|x| !x.is_finite()) {
        words.push("stress not finite".into());
    }
    if !same_bits(&from.statev[..answer.statev.len()], &answer.statev) {
        words.push("STATEV changed".into());
    }
    words.join(", ")
}

/// The state with one input spoiled, for each input.
fn spoiled(subject: &Subject<'_>, state: &SampledState, value: f64) -> Vec<(String, Committed, Vec<f64>)> {
    let mut cases = Vec::new();
    for k in 0..state.step.len() {
        let mut step = state.step.clone();
        step[k] = value;
        cases.push((format!("increment of {}", subject.entry.input_name(k)), state.from.clone(), step));
        if matches!(subject.entry, CheckedEntryPoint::Umat(_)) {
            let mut from = state.from.clone();
            from.input[k] = value;
            cases.push((subject.entry.input_name(k), from, state.step.clone()));
        }
    }
    for k in 0..subject.nstatv {
        let mut from = state.from.clone();
        from.statev[k] = value;
        cases.push((subject.state_name(k), from, state.step.clone()));
    }
    cases
}

/// Collects what was accepted although it is wrong.
struct Refusals {
    tried: usize,
    accepted: Vec<String>,
    said: Capture,
}

impl Refusals {
    fn new(library: &Library) -> Self {
        Self { tried: 0, accepted: Vec::new(), said: Capture::start(library) }
    }

    /// Notes an answer; `refused`: whether its arrays are those of a refusal, if it asks for a cut-back as well.
    fn note(&mut self, from: &Committed, answer: &Answer, refused: bool, what: impl FnOnce() -> String) {
        self.tried += 1;
        if !(cut_back(answer) && refused) {
            self.accepted.push(format!("{}: {}", what(), words(from, answer)));
        }
    }

    /// Adds the row: a pass with these words if all were refused, else `wrong` with the first that was not.
    fn report(self, ledger: &mut Ledger<'_>, all: &str, wrong: Verdict) {
        let figure = format!("{}/{} refused", self.tried - self.accepted.len(), self.tried);
        match self.accepted.first() {
            None => ledger.add(Verdict::Pass, figure, self.said.appended_to(all)),
            Some(first) => ledger.add(wrong, figure, self.said.appended_to(first)),
        }
    }
}

/// Each parameter NaN, infinite, outside its bounds, none of its choices.
pub(super) fn properties(subject: &mut Subject<'_>, sample: &[SampledState], ledger: &mut Ledger<'_>) {
    ledger.begin("wrong PROPS");
    let (Some(law), Some(state)) = (&subject.plugin.law, sample.first()) else {
        return ledger.skip("no metadata: bounds are unknown");
    };
    let mut refusals = Refusals::new(&subject.plugin.library);
    for k in 0..subject.props.len() {
        let parameter = &law.parameters[parameter_of(law, k)];
        let outside = [parameter.lower - 1.0 - parameter.lower.abs(), parameter.upper + 1.0 + parameter.upper.abs()];
        for value in BAD.into_iter().chain(outside.into_iter().filter(|x| x.is_finite() && !parameter.admits(*x))) {
            let mut props = subject.props.clone();
            props[k] = value;
            let Ok(mut twin) = subject.twin(&props) else { continue };
            let answer = twin.call(&state.from, &state.step, FILLING, Alteration::None);
            let refused = not_a_number(&state.from, &answer, answer.output.len());
            refusals.note(&state.from, &answer, refused, || format!("{} = {value}", parameter.name));
        }
    }
    refusals.report(ledger, "", Verdict::Fail);
}

/// Wrong NTENS, NSTATV, NPROPS, and stress states that the law does not support.
pub(super) fn counts(subject: &mut Subject<'_>, sample: &[SampledState], ledger: &mut Ledger<'_>) {
    ledger.begin("wrong counts");
    let (Some(law), Some(state)) = (&subject.plugin.law, sample.first()) else {
        return ledger.skip("no metadata: what the plugin checks is unknown");
    };
    let mut alterations = Vec::new();
    let count = |n: usize| i32::try_from(n).unwrap_or(i32::MAX);
    if subject.nstatv > 0 {
        alterations.extend([Alteration::StateCount(count(subject.nstatv) - 1), Alteration::StateCount(-1)]);
    }
    let properties = count(subject.props.len());
    if law.group.is_none() {
        alterations.extend([properties + 1, properties - 1, 0, -1].map(Alteration::PropertyCount));
    } else {
        alterations.extend([0, -1].map(Alteration::PropertyCount));
    }
    match subject.entry {
        CheckedEntryPoint::Umat(present) => {
            let wrong = [[5, 3, 2], [2, 1, 1], [1, 1, 0], [0, 0, 0], [-1, -1, -1]];
            alterations.extend(wrong.map(Alteration::Components));
            let other = [StressState::PlaneStrainOrAxisymmetric, StressState::PlaneStress];
            let unsupported = other.into_iter().filter(|s| s.bits() & law.stress_states == 0);
            let fitting = unsupported.filter(|s| s.components().len() < present.components().len());
            alterations.extend(fitting.map(|s| Alteration::Components(<[i32; 3]>::from(s.counts()))));
        }
        CheckedEntryPoint::Uinter(_) | CheckedEntryPoint::Fric(_) => {
            alterations.extend([[0, 0, 0], [-1, 0, 0]].map(Alteration::Components));
        }
    }
    let mut refusals = Refusals::new(&subject.plugin.library);
    for alteration in alterations {
        let answer = subject.call(&state.from, &state.step, FILLING, alteration);
        let components = match alteration {
            Alteration::Components([n, ..]) => usize::try_from(n).unwrap_or(0).min(answer.output.len()),
            _ => answer.output.len(),
        };
        let refused = not_a_number(&state.from, &answer, components);
        refusals.note(&state.from, &answer, refused, || format!("{alteration:?}"));
    }
    refusals.report(ledger, "", Verdict::Fail);
}

/// Checks CELENT 0, NaN, negative and NULL. All must give the same answer, by a law that does not need CELENT here, or a refusal.
/// The law must not divide by it.
pub(super) fn characteristic_length(
    subject: &mut Subject<'_>,
    sample: &[SampledState],
    is_given: bool,
    ledger: &mut Ledger<'_>,
) {
    ledger.begin("CELENT unusable");
    if !matches!(subject.entry, CheckedEntryPoint::Umat(_)) {
        return;
    }
    if !subject.claims(flags::USES_CELENT) {
        return undeclared_length(subject, sample, is_given, ledger);
    }
    let said = Capture::start(&subject.plugin.library);
    let length = subject.length;
    for state in sample.iter().take(30) {
        let expected = subject.call(&state.from, &state.step, 0.0, Alteration::Null("celent"));
        let finite = expected.output.iter().chain(&expected.tangent).all(|x| x.is_finite());
        let refused = cut_back(&expected) && not_a_number(&state.from, &expected, expected.output.len());
        if !finite && !refused {
            let detail = format!("NULL in {state}: {}", words(&state.from, &expected));
            return ledger.add(Verdict::Fail, "", detail);
        }
        for value in [0.0, -1.0, f64::NAN, f64::INFINITY] {
            subject.length = value;
            let answer = subject.call(&state.from, &state.step, 0.0, Alteration::None);
            subject.length = length;
            if !answer.same(&expected) {
                let detail = format!("CELENT {value} in {state} differs from NULL");
                return ledger.add(Verdict::Fail, "", detail);
            }
        }
    }
    ledger.add(Verdict::Pass, "", said.appended_to("0, NaN, negative, infinite and NULL alike"));
}

/// Asks a law whose metadata say nothing of CELENT whether it uses it. `is_given`: whether the case has a length.
fn undeclared_length(subject: &mut Subject<'_>, sample: &[SampledState], is_given: bool, ledger: &mut Ledger<'_>) {
    const STATES: usize = 30;
    let length = subject.length;
    for state in sample.iter().rev().take(STATES) {
        let [with, twice] = [length, 2.0 * length].map(|length| {
            subject.length = length;
            subject.call(&state.from, &state.step, 0.0, Alteration::None)
        });
        subject.length = length;
        // what differs from call to call says nothing
        if with.same(&twice) || !with.same(&subject.call(&state.from, &state.step, 0.0, Alteration::None)) {
            continue;
        }
        let (k, (with, twice)) = match with.output.iter().zip(&twice.output).enumerate().find(|(_, (a, b))| a != b) {
            Some(differs) => differs,
            None => return ledger.add(Verdict::Info, "", format!("its states or DDSDDE depend on CELENT, in {state}")),
        };
        let name = subject.entry.output_name(k);
        let what = format!("{name} is {with:e} with CELENT {length}, {twice:e} with {}, in {state}", 2.0 * length);
        return match (subject.described(), is_given) {
            (true, _) => {
                ledger.add(Verdict::Fail, "", format!("depends on CELENT, which its metadata do not claim: {what}"))
            }
            (false, true) => ledger.add(Verdict::Info, "used", what),
            (false, false) => {
                let detail = format!("{what}; the case gives no characteristic_length, so that 1 was passed");
                ledger.add(Verdict::Warn, "used", detail);
            }
        };
    }
    ledger.skip("not used");
}
