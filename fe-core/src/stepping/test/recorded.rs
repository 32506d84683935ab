//! Runs that repeat the increments of others.

use super::{Keeper, snap_back};
use crate::model::Model;
use crate::stepping::{Analysis, Record, Recorded, RunError, Tried, Verdict, Way};

pub(super) fn recorded(records: &[Record]) -> Recorded {
    let mut recorded = Recorded::default();
    for record in records.iter().filter(|record| record.step > 0) {
        recorded.push(record.step, record.tried.clone());
    }
    assert_eq!(recorded.mistake(), None);
    recorded
}

pub(super) fn repeat(model: &Model, recorded: &Recorded) -> Result<Vec<Record>, RunError> {
    let mut analysis = Analysis::new(model).unwrap();
    analysis.repeat(recorded.clone());
    let mut keeper = Keeper::default();
    analysis.run(&mut keeper).map(|()| keeper.0)
}

/// An element that fails snaps back, and dissipation leads; refused attempts and all.
#[test]
fn a_repeated_run_has_the_same_bits_through_a_snap_back() {
    let model = snap_back::bar();
    let (base, _) = super::run(&model);
    let recorded = recorded(&base);
    let all = || recorded.steps.iter().flatten().flatten();
    assert!(all().any(|tried| matches!(tried.to, Way::Dissipation(_))));
    assert!(all().any(|tried| tried.verdict == Verdict::Refused));
    let again = repeat(&model, &recorded).unwrap();
    assert_eq!(format!("{again:?}"), format!("{base:?}"));
}

#[test]
fn an_increment_that_does_not_converge_is_not_replaced_by_others() {
    let model = snap_back::bar();
    let (base, _) = super::run(&model);
    let mut recorded = recorded(&base);
    // from the elastic branch to the end at once
    let last = recorded.steps[0].len() - 1;
    recorded.steps[0].drain(1..last);
    let jump = Tried { to: Way::Dissipation(1e3), time: 0.1, verdict: Verdict::Stands, imbalanced: None };
    recorded.steps[0][1] = vec![jump];
    let message = repeat(&model, &recorded).unwrap_err().to_string();
    assert!(message.contains("increment 2") && message.contains("repeated as it is"), "{message}");
}
