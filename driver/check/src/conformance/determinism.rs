//! Same input, same output: repeated, in another order, from several threads, with and without tangent.

use super::Options;
use super::random::SEED;
use super::report::{Ledger, Verdict};
use super::sample::SampledState;
use super::subject::{Answer, Subject, distance, largest};
use pullout_run::in_threads;
use umat_abi::host::{Alteration, ExternalDatabases};
use umat_abi::metadata::flags;

/// Threads that call at once.
const THREADS: usize = 4;
/// Times that each thread goes through the sample.
const ROUNDS: usize = 5;

fn answer(subject: &mut Subject<'_>, state: &SampledState) -> Answer {
    subject.call(&state.from, &state.step, 0.0, Alteration::None)
}

/// Returns how two answers that should be the same differ.
fn difference(a: &Answer, b: &Answer) -> String {
    let relative = |x: &[f64], y: &[f64]| distance(x, y) / largest(x).max(f64::MIN_POSITIVE);
    format!(
        "relative differences: stress {:.1e}, states {:.1e}, tangent {:.1e}, RPL and its derivatives {:.1e}",
        relative(&a.output, &b.output),
        relative(&a.statev, &b.statev),
        relative(&a.tangent, &b.tangent),
        relative(&a.heat_values(), &b.heat_values())
    )
}

/// Words that a call finds on its stack: zeros, and a number that computes.
const STACKS: [u64; 2] = [0, 1e-4_f64.to_bits()];

/// Why answers differ that do so by the words alone.
const UNSET: &str = "the result depends on what the stack held before: a variable is used before it is set";

/// Each call twice in a row, and on other stacks.
pub(super) fn repeatability(subject: &mut Subject<'_>, sample: &[SampledState], ledger: &mut Ledger<'_>) {
    ledger.begin("repeated call");
    for state in sample {
        let (first, second) = (answer(subject, state), answer(subject, state));
        let mut on = |word| subject.call(&state.from, &state.step, 0.0, Alteration::Stack(word));
        let [zeros, numbers] = STACKS.map(&mut on);
        let others = [&second, &zeros, &numbers];
        let Some(other) = others.into_iter().find(|other| !first.same(other)) else { continue };
        // the stack of a plain call is what other code left there: both calls may find different words, too
        let differs = difference(&first, other);
        let detail = match on(STACKS[0]).same(&zeros) && (first.same(&second) || !zeros.same(&numbers)) {
            true => format!("{state}: {UNSET}; {differs}"),
            false => format!("{state}: {differs}"),
        };
        return ledger.add(Verdict::Fail, "", detail);
    }
    ledger.add(Verdict::Pass, "bit for bit", "");
}

/// Calls the law for a small step from the virgin state: once before other calls can fill a memory, once after them.
pub(super) fn first_call(subject: &mut Subject<'_>, ledger: &mut Ledger<'_>) -> Answer {
    const SMALL: f64 = 1e-6;
    ledger.begin("order of calls");
    let (virgin, step) = (subject.virgin(), vec![SMALL; subject.entry.inputs()]);
    subject.call(&virgin, &step, 0.0, Alteration::None)
}

/// Every state again after all others, in reversed order, and one in between each pair; then the case, and the call whose
/// answer `first` is: a memory that is full since then changes no more between later calls.
pub(super) fn call_order(
    subject: &mut Subject<'_>,
    sample: &[SampledState],
    first: &Answer,
    options: &Options,
    databases: &mut ExternalDatabases,
    ledger: &mut Ledger<'_>,
) {
    ledger.begin("order of calls");
    let forward: Vec<Answer> = sample.iter().map(|state| answer(subject, state)).collect();
    for (state, before) in sample.iter().zip(&forward).rev() {
        let again = answer(subject, state);
        if !before.same(&again) {
            let detail = format!("{state} after others: {} (hidden memory)", difference(before, &again));
            return ledger.add(Verdict::Fail, "", detail);
        }
    }
    let mut words = "";
    if subject.path.is_some() && ExternalDatabases::is_in([&subject.plugin.library]) {
        // a table of the time, or averages that increments hand on, may be its business
        words = "the case was not run again: its UEXTERNALDB may change what the law reads";
    } else if let Some(detail) = run_again(subject, options, databases) {
        return ledger.add(Verdict::Fail, "", format!("hidden memory: {detail}"));
    }
    let again = first_call(subject, ledger);
    if !first.same(&again) {
        let detail = format!("hidden memory: the first call of all, after others: {}", difference(first, &again));
        return ledger.add(Verdict::Fail, "", detail);
    }
    ledger.add(Verdict::Pass, "bit for bit", words);
}

/// Runs the case again while the calls of another point go along the same path backwards. Returns the first difference.
fn run_again(subject: &mut Subject<'_>, options: &Options, databases: &mut ExternalDatabases) -> Option<String> {
    let path = subject.path.clone().filter(|path| !path.increments.is_empty())?;
    let mut others = path.increments.iter().rev().cycle();
    let mut between = || {
        if let Some(other) = others.next() {
            subject.call(&other.from, &other.step, 0.0, Alteration::None);
        }
    };
    let again = path.again(options.program.as_deref()?, options, databases, &mut between);
    let difference = path.pairs(&again).find_map(|(before, after)| {
        let mut values = before.answer.iter().zip(&after.answer).enumerate();
        let (k, (before_it, after_it)) = values.find(|(_, (a, b))| a.to_bits() != b.to_bits())?;
        let (outputs, [step, increment]) = (subject.entry.outputs(), before.from.counters);
        let name = match k {
            k if k < outputs => subject.entry.output_name(k),
            k if k < outputs + before.from.statev.len() => subject.state_name(k - outputs),
            _ => "an energy".to_owned(),
        };
        let gave = format!("gave {name} = {before_it:e} in its run and {after_it:e} afterwards");
        Some(format!("step {step}, increment {increment} of the case {gave}, with calls of another point in between"))
    });
    let is_shorter = again.is_failed && again.taken < path.taken;
    difference.or_else(|| {
        is_shorter.then(|| format!("the case fails after {} of its {} increments afterwards", again.taken, path.taken))
    })
}

/// All threads at once on different states, against the answers of one.
pub(super) fn threads(subject: &mut Subject<'_>, sample: &[SampledState], ledger: &mut Ledger<'_>) {
    ledger.begin("thread safety");
    if !subject.claims(flags::THREAD_SAFE) {
        return ledger.skip("not claimed");
    }
    let expected: Vec<Answer> = sample.iter().map(|state| answer(subject, state)).collect();
    let twins: Result<Vec<_>, _> = (0..THREADS).map(|_| subject.twin(&subject.props)).collect();
    let Ok(twins) = twins else { return ledger.skip("no second call could be prepared") };
    let work = |mut twin: Subject<'_>, thread: usize| {
        let first = thread * sample.len() / THREADS;
        for k in (0..ROUNDS * sample.len()).map(|k| (first + k) % sample.len()) {
            if !answer(&mut twin, &sample[k]).same(&expected[k]) {
                return Some(sample[k].number);
            }
        }
        None
    };
    let work = &work;
    let ended = in_threads(twins.into_iter().enumerate().map(|(k, twin)| move || work(twin, k)));
    let wrong: Vec<Option<usize>> = ended.into_iter().flatten().map(|ended| ended.unwrap_or(Some(0))).collect();
    let calls = format!("{} calls", wrong.len() * ROUNDS * sample.len());
    match wrong.iter().flatten().next() {
        None if wrong.len() > 1 => ledger.add(Verdict::Pass, calls, format!("{} threads", wrong.len())),
        None => ledger.skip("the system gives no threads"),
        Some(number) => {
            let detail = format!("state {number} (seed {SEED}) differs from the single thread's answer");
            ledger.add(Verdict::Fail, calls, detail);
        }
    }
}

/// The tangent's pointer NULL gives the same stress and states.
pub(super) fn stress_only(subject: &mut Subject<'_>, sample: &[SampledState], ledger: &mut Ledger<'_>) {
    ledger.begin("stress only");
    if !subject.claims(flags::STRESS_ONLY) {
        return ledger.skip("not claimed");
    }
    let tangent = subject.argument_names().1;
    for state in sample {
        let full = answer(subject, state);
        let stress = subject.call(&state.from, &state.step, 0.0, Alteration::Null(tangent));
        if !full.same_response(&stress) || full.outcome != stress.outcome {
            let detail = format!("{state}: {}", difference(&full, &stress));
            return ledger.add(Verdict::Fail, "", detail);
        }
    }
    ledger.add(Verdict::Pass, "bit for bit", "");
}
