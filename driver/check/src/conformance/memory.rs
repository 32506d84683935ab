//! Writing where a plugin must not, and not writing where it must.

use super::report::{Ledger, Verdict};
use super::sample::SampledState;
use super::subject::Subject;
use umat_abi::host::{Alteration, FricAnswer, Plugin};

/// Values that no law computes.
const FILLINGS: [f64; 2] = [-1.234_567e77, 9.876_543e-66];
/// States tried.
const STATES: usize = 30;

/// Entries of the tangent (FRIC: and of DSLIP) that the plugin leaves as they were.
pub(super) fn unset_entries(subject: &mut Subject<'_>, sample: &[SampledState], ledger: &mut Ledger<'_>) {
    ledger.begin("tangent entries set");
    let columns = subject.entry.inputs();
    let mut unset = std::collections::BTreeSet::new();
    let mut is_slip_unset = false;
    for state in sample.iter().take(STATES) {
        let [first, second] = FILLINGS.map(|filling| subject.call(&state.from, &state.step, filling, Alteration::None));
        // with LM = 1 or 2 FRIC leaves the shear to the host
        if first.given != Ok(FricAnswer::Tractions) {
            continue;
        }
        for (k, (a, b)) in first.tangent.iter().zip(&second.tangent).enumerate() {
            if [*a, *b] == FILLINGS {
                unset.insert(format!("({},{})", k / columns + 1, k % columns + 1));
            }
        }
        is_slip_unset |= [first.slip_increment[0], second.slip_increment[0]] == FILLINGS;
    }
    // ABAQUS leaves it to the law whether it has an inelastic slip
    let is_optional = is_slip_unset && !subject.described();
    if is_slip_unset && !is_optional {
        unset.insert("DSLIP".into());
    }
    let detail = unset.iter().cloned().collect::<Vec<_>>().join(", ");
    match unset.len() {
        0 if is_optional => ledger.add(Verdict::Info, "", "DSLIP is never written: SLIP stays 0"),
        0 => ledger.add(Verdict::Pass, "", ""),
        n => ledger.add(Verdict::Fail, format!("{n} unset"), format!("never written: {detail}")),
    }
}

/// Input arguments that the plugin writes: a host that gives no copies of them, as this one does, goes on with what it wrote.
pub(super) fn inputs_untouched(subject: &Subject<'_>, sample: &[SampledState], ledger: &mut Ledger<'_>) {
    ledger.begin("inputs untouched");
    let plugin = Plugin { library: subject.plugin.library.clone().watched(), ..subject.plugin.clone() };
    let Ok(mut twin) = subject.twin_of(&plugin, &subject.props) else {
        return ledger.skip("no second call could be prepared");
    };
    for state in sample.iter().take(STATES) {
        twin.call(&state.from, &state.step, 0.0, Alteration::None);
        let written = plugin.library.written_inputs();
        if !written.is_empty() {
            let names: Vec<String> = written.iter().map(|(name, written)| written.named(name)).collect();
            return ledger.add(subject.blame(), "", format!("{state}: writes to {}", names.join(", ")));
        }
    }
    ledger.add(Verdict::Pass, "", "");
}

/// Reports writes past the ends of arrays in any call of any check.
pub(super) fn overruns(subject: &Subject<'_>, ledger: &mut Ledger<'_>) {
    if subject.overruns.is_empty() {
        return ledger.row("array bounds", Verdict::Pass, "", "");
    }
    let arrays: Vec<_> = subject.overruns.iter().map(|(array, calls)| format!("{array} in {calls} calls")).collect();
    let detail = format!("writes past the end of {}", arrays.join(", "));
    ledger.row("array bounds", Verdict::Fail, format!("{} arrays", arrays.len()), detail);
}
