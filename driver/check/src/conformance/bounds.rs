//! Places the arrays of a plain UMAT, UINTER or FRIC next to protected pages, so that wrong use of NSTATV, NPROPS, NTENS, NDIR
//! or NFDIR is caught when it happens.

use super::report::{Ledger, Verdict};
use super::sample::SampledState;
use super::subject::Subject;
use std::collections::BTreeSet;
use umat_abi::host::{Alignment, Probed};

/// States tried: each costs two processes.
const STATES: usize = 8;

/// Reads and writes outside the arrays.
pub(super) fn check(subject: &mut Subject<'_>, sample: &[SampledState], ledger: &mut Ledger<'_>) {
    ledger.begin("outside arrays");
    if subject.described() {
        return;
    }
    let mut findings = BTreeSet::new();
    let mut calls = 0;
    for state in sample.iter().rev().take(STATES) {
        for alignment in [Alignment::End, Alignment::Start] {
            match subject.probe(&state.from, &state.step, alignment) {
                Err(error) => return ledger.skip(&format!("no process could be started: {error}")),
                Ok(Probed::Clean) => {}
                Ok(Probed::Trespass(trespass)) => {
                    findings.insert(trespass.to_string());
                }
                Ok(Probed::Ended(how)) => {
                    findings.insert(format!("{state}: {how}"));
                }
            }
            calls += 1;
        }
    }
    let figure = format!("{calls} calls");
    if findings.is_empty() {
        return ledger.add(Verdict::Pass, figure, "");
    }
    ledger.add(Verdict::Fail, figure, findings.into_iter().collect::<Vec<_>>().join("; "));
}
