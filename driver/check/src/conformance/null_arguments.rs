//! NULL for every argument that a plugin may not need: hosts pass it.

use super::messages::Capture;
use super::report::{Ledger, Verdict};
use super::sample::SampledState;
use super::subject::Subject;
use umat_abi::host::Alteration;
use umat_abi::metadata::flags;

/// States tried.
const STATES: usize = 5;

/// The answer is the same bit for bit.
pub(super) fn check(subject: &mut Subject<'_>, sample: &[SampledState], ledger: &mut Ledger<'_>) {
    ledger.begin("NULL arguments");
    if !subject.described() {
        return ledger.skip("no metadata: the plugin may read any argument");
    }
    let said = Capture::start(&subject.plugin.library);
    let several_laws = subject.plugin.library.laws().len() > 1;
    let mut errors = Vec::new();
    let names = subject.argument_names().0;
    for &name in names {
        // A library of several laws finds out by its name which one is meant.
        if several_laws && (name == "cmname" || name == "ciname") {
            continue;
        }
        // a law that uses it has a check of its own, "CELENT unusable"
        if name == "celent" && subject.claims(flags::USES_CELENT) {
            continue;
        }
        for state in sample.iter().take(STATES) {
            let expected = subject.call(&state.from, &state.step, 0.0, Alteration::None);
            let mut found = subject.call(&state.from, &state.step, 0.0, Alteration::Null(name));
            // there is no heat where its argument is not
            found.heat = expected.heat;
            if !found.same(&expected) {
                errors.push(format!("{} = NULL changes the answer", name.to_uppercase()));
                break;
            }
        }
    }
    let verdict = if errors.is_empty() { Verdict::Pass } else { Verdict::Fail };
    ledger.add(verdict, format!("{} arguments", names.len()), said.appended_to(errors.join("; ")));
}
