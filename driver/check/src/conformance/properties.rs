//! Constants that a law keeps from its first call: wrong as soon as a second material has other PROPS.

use super::report::{Ledger, Verdict};
use super::subject::{Committed, Subject};
use pullout_run::program::{PointKind, Program};
use std::time::{Duration, Instant};
use umat_abi::host::{Alteration, compute_in_child};

/// Factor on one of PROPS at a time.
const FACTOR: f64 = 0.9;
/// Most of PROPS that are varied, and the time after which no more are: each costs a few processes.
const MOST: usize = 24;
const TIME: Duration = Duration::from_secs(1);
/// Sizes of the steps from the start.
const SIZES: [f64; 3] = [1e-6, 1e-4, 1e-2];

/// What the calls showed.
pub(super) enum Finding {
    /// No number of PROPS changes an answer, or no process could be started.
    NothingSeen,
    /// As many were varied.
    Independent(usize),
    /// The answer with one of PROPS changed depends on calls before the change.
    Kept {
        /// Number of the property, from 1, its first value and its second.
        property: (usize, f64, f64),
        /// Name of an output, its value in a process that knows the second value alone, and after calls with the first; `None`:
        /// states or DDSDDE alone differ.
        answer: Option<(String, f64, f64)>,
    },
}

/// Calls a law that this process has not called yet, in child processes: with one of PROPS changed, and the same after a call with
/// PROPS as they are.
pub(super) fn find(subject: &Subject<'_>, program: Option<&Program>) -> Finding {
    let mut start = Committed::zero(subject.entry, subject.nstatv);
    if let Some(PointKind::Point(point)) = program.map(|program| &program.kind)
        && let Some(states) = point.initial.statev.as_ref().filter(|states| states.len() == start.statev.len())
    {
        start.statev.clone_from(states);
    }
    // the output number `k`, or all outputs in one number
    let answer = |calls: &[&[f64]], output: Option<usize>| {
        let work = || {
            let mut last = 0;
            for props in calls {
                let Ok(mut twin) = subject.twin(props) else { return 0 };
                twin.leave_record();
                last = digest(&mut twin, &start, output);
            }
            last
        };
        compute_in_child(work).ok().flatten()
    };
    let (first, begin) = (&subject.props, Instant::now());
    let Some(plain) = answer(&[first], None) else { return Finding::NothingSeen };
    let mut seen = 0;
    for k in (0..first.len()).filter(|&k| first[k] != 0.0).take(MOST) {
        if begin.elapsed() > TIME {
            break;
        }
        let mut second = first.clone();
        second[k] *= FACTOR;
        let Some(alone) = answer(&[&second], None).filter(|answer| *answer != plain) else { continue };
        let Some(after) = answer(&[first, &second], None) else { continue };
        seen += 1;
        // a random answer is no answer that was kept
        if after == alone || answer(&[&second], None) != Some(alone) || answer(&[first, &second], None) != Some(after) {
            continue;
        }
        let outputs = subject.entry.outputs();
        let values = (0..outputs * SIZES.len()).find_map(|output| {
            let [alone, after] = [&[&*second][..], &[first, &second]].map(|calls| answer(calls, Some(output)));
            alone.zip(after).filter(|(alone, after)| alone != after).map(|both| (output, both))
        });
        let answer = values.map(|(output, (alone, after))| {
            (subject.entry.output_name(output % outputs), f64::from_bits(alone), f64::from_bits(after))
        });
        return Finding::Kept { property: (k + 1, first[k], second[k]), answer };
    }
    if seen == 0 { Finding::NothingSeen } else { Finding::Independent(seen) }
}

/// Steps from the start in all directions; returns the bits of an output (of the step `k / outputs`), or of all results together.
fn digest(subject: &mut Subject<'_>, start: &Committed, output: Option<usize>) -> u64 {
    let inputs = subject.entry.inputs();
    let mut all: u64 = 0;
    for (k, size) in SIZES.into_iter().enumerate() {
        let step: Vec<f64> = (0..inputs).map(|i| size * (1.0 - 0.3 * i as f64)).collect();
        let answer = subject.call(start, &step, 0.0, Alteration::None);
        let count = answer.output.len();
        if let Some(value) = output.and_then(|output| answer.output.get(output.checked_sub(k * count)?)) {
            return value.to_bits();
        }
        for value in answer.output.iter().chain(&answer.statev).chain(&answer.tangent) {
            // FNV-1a over words
            all = (all ^ value.to_bits()).wrapping_mul(0x0100_0000_01b3);
        }
    }
    all
}

/// Adds the row.
pub(super) fn report(finding: &Finding, ledger: &mut Ledger<'_>) {
    ledger.begin("other PROPS");
    match finding {
        Finding::NothingSeen => ledger.skip("none of PROPS changes an answer at the start"),
        Finding::Independent(count) => ledger.add(Verdict::Pass, format!("{count} varied"), ""),
        Finding::Kept { property: (number, first, second), answer } => {
            let how = match answer {
                Some((output, alone, after)) => format!("{output} is {alone:e} in a process of its own and {after:e}"),
                None => "its states or DDSDDE are others in a process of its own than".to_owned(),
            };
            let detail = format!(
                "hidden memory: with PROPS({number}) = {second} {how} after a call with PROPS({number}) = {first}: two materials in \
                 one model disturb each other"
            );
            ledger.add(Verdict::Fail, "", detail);
        }
    }
}
