//! Random states thrown at the laws themselves.

use super::Row;
use super::progress::Progress;
use crate::BenchError;
use crate::table::Table;
use battery::stability::{Form, Ledger, forms};
use std::panic::{AssertUnwindSafe, catch_unwind};
use umat_abi::law::StressState;

/// Name of this part in the table.
pub(super) const PART: &str = "law";

const STRESS_STATES: [(StressState, &str); 3] = [
    (StressState::ThreeD, "3-D"),
    (StressState::PlaneStrainOrAxisymmetric, "plane strain"),
    (StressState::PlaneStress, "plane stress"),
];

/// Results for a form of a law in a stress state.
pub(super) struct Thrown {
    form: Form,
    stress_state: &'static str,
    ledger: Ledger,
}

/// All laws, so many states each, on all processors.
pub(super) fn measure(states: u64, progress: &Progress) -> Result<Vec<Thrown>, BenchError> {
    let threads = std::thread::available_parallelism().map_or(1, std::num::NonZero::get);
    let mut thrown = Vec::new();
    for form in forms() {
        for (stress_state, name) in STRESS_STATES {
            let what = format!("{}, {name}", subject(&form));
            let done = |states| progress.advance(states, &what);
            let ledger = catch_unwind(AssertUnwindSafe(|| form.throw(stress_state, states, threads, &done)))
                .map_err(|_| BenchError::Failed(format!("{} {} panicked, {name}", form.law, form.label)))?;
            thrown.push(Thrown { form, stress_state: name, ledger });
        }
    }
    Ok(thrown)
}

/// States of all forms together.
pub(super) fn total(states: u64) -> u64 {
    states.saturating_mul((forms().len() * STRESS_STATES.len()) as u64)
}

fn subject(form: &Form) -> String {
    format!("{} {}", form.law, form.label).trim_end().to_owned()
}

impl Thrown {
    /// One line for each promise.
    pub fn rows(&self) -> Vec<Row> {
        let row = |(promise, check): (&'static str, battery::stability::Check)| Row {
            part: PART,
            subject: subject(&self.form),
            situation: self.stress_state.into(),
            case: promise.into(),
            tried: check.tried,
            excluded: check.excluded,
            failed: check.failed,
            worst: check.worst,
            note: check.first.unwrap_or_default(),
        };
        self.ledger.checks().into_iter().map(row).collect()
    }
}

/// One line for each form and stress state.
pub(super) fn summary(thrown: &[Thrown]) -> Table {
    let mut table = Table::new([
        "law",
        "stress state",
        "states",
        "cut back",
        "sets refused",
        "tangents on kinks, right on one side",
        "checks",
        "failed",
    ]);
    for one in thrown {
        let ledger = &one.ledger;
        table.push([
            subject(&one.form).into(),
            one.stress_state.into(),
            ledger.states.into(),
            ledger.cut_back().into(),
            ledger.sets_refused.into(),
            ledger.one_sided.into(),
            ledger.checks().iter().map(|(_, check)| check.tried).sum::<u64>().into(),
            ledger.failures().into(),
        ]);
    }
    table
}
