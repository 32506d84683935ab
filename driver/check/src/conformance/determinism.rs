//! Same input, same output: repeated, in another order, from several threads, with and without tangent.

use super::random::SEED;
use super::report::{Ledger, Verdict};
use super::sample::State;
use super::subject::{Answer, Subject, distance, largest};
use pullout_run::PLUGIN_STACK;
use umat_abi::host::Alteration;
use umat_abi::metadata::flags;

/// Threads that call at once.
const THREADS: usize = 4;
/// Times that each thread goes through the sample.
const ROUNDS: usize = 5;

fn answer(subject: &mut Subject<'_>, state: &State) -> Answer {
    subject.call(&state.from, &state.step, 0.0, Alteration::None)
}

/// Returns how two answers that should be the same differ.
fn difference(a: &Answer, b: &Answer) -> String {
    let relative = |x: &[f64], y: &[f64]| distance(x, y) / largest(x).max(f64::MIN_POSITIVE);
    format!(
        "relative differences: stress {:.1e}, states {:.1e}, tangent {:.1e}",
        relative(&a.output, &b.output),
        relative(&a.statev, &b.statev),
        relative(&a.tangent, &b.tangent)
    )
}

/// Each call twice in a row.
pub(super) fn repeatability(subject: &mut Subject<'_>, sample: &[State], ledger: &mut Ledger<'_>) {
    ledger.begin("repeated call");
    for state in sample {
        let (first, second) = (answer(subject, state), answer(subject, state));
        if !first.same(&second) {
            let detail = format!("{state}: {}", difference(&first, &second));
            return ledger.add(Verdict::Fail, "", detail);
        }
    }
    ledger.add(Verdict::Pass, "bit for bit", "");
}

/// Every state again after all others, in reversed order, and one in between each pair.
pub(super) fn call_order(subject: &mut Subject<'_>, sample: &[State], ledger: &mut Ledger<'_>) {
    ledger.begin("order of calls");
    let forward: Vec<Answer> = sample.iter().map(|state| answer(subject, state)).collect();
    for (state, before) in sample.iter().zip(&forward).rev() {
        let again = answer(subject, state);
        if !before.same(&again) {
            let detail = format!("{state} after others: {} (hidden memory)", difference(before, &again));
            return ledger.add(Verdict::Fail, "", detail);
        }
    }
    ledger.add(Verdict::Pass, "bit for bit", "");
}

/// All threads at once on different states, against the answers of one.
pub(super) fn threads(subject: &mut Subject<'_>, sample: &[State], ledger: &mut Ledger<'_>) {
    ledger.begin("thread safety");
    if !subject.claims(flags::THREAD_SAFE) {
        return ledger.skip("not claimed");
    }
    let expected: Vec<Answer> = sample.iter().map(|state| answer(subject, state)).collect();
    let twins: Result<Vec<_>, _> = (0..THREADS).map(|_| subject.twin(&subject.props.clone(), subject.nstatv)).collect();
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
    let wrong: Vec<Option<usize>> = std::thread::scope(|scope| {
        let work = &work;
        let handles: Vec<_> = twins
            .into_iter()
            .enumerate()
            .filter_map(|(k, twin)| {
                std::thread::Builder::new().stack_size(PLUGIN_STACK).spawn_scoped(scope, move || work(twin, k)).ok()
            })
            .collect();
        handles.into_iter().map(|handle| handle.join().unwrap_or(Some(0))).collect()
    });
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
pub(super) fn stress_only(subject: &mut Subject<'_>, sample: &[State], ledger: &mut Ledger<'_>) {
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
