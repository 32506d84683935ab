//! The tables say what happened, and failures are failures.

use super::progress::Progress;
use super::specimens;
use super::variations::{Variation, bases};
use super::{Row, data, laws, promises};
use crate::runs::{self, Limit};

#[test]
fn few_states_break_no_promise_and_every_promise_is_looked_at() {
    let thrown = laws::measure(200, &Progress::quiet()).expect("no panic");
    let rows: Vec<Row> = thrown.iter().flat_map(laws::Thrown::rows).collect();
    assert_eq!(thrown.len(), 3 * battery::stability::forms().len());
    for row in &rows {
        assert_eq!(row.failed, 0, "{row:?}");
        assert!(row.tried >= row.excluded, "{row:?}");
    }
    let table = promises(&rows).csv();
    for promise in ["derivative", "turned", "finite", "never decrease", "refused", "half of stress", "same bits"] {
        let line = table.lines().find(|line| line.contains(promise)).unwrap_or_else(|| panic!("{promise}: {table}"));
        assert!(!line.contains(",0,0,0,"), "{line}");
    }
    assert_eq!(data(&rows).csv().lines().count(), 1 + rows.len());
}

#[test]
fn two_hundred_variations_and_more_that_all_differ() {
    let variations: Vec<_> = bases()
        .iter()
        .flat_map(|base| base.families.iter().map(move |family| (base.name, family)))
        .flat_map(|(base, family)| family.variations.iter().map(move |v| (base, v.set.clone())).collect::<Vec<_>>())
        .collect();
    assert!(variations.len() >= 200, "{}", variations.len());
    for (k, variation) in variations.iter().enumerate() {
        assert!(!variations[..k].contains(variation), "{variation:?}");
    }
}

/// A variation that is refused looks at nothing.
#[test]
fn variations_are_refused_for_a_known_reason_only() {
    let folder = tempfile::tempdir().expect("a folder");
    for (k, base) in bases().iter().enumerate() {
        let file = folder.path().join(format!("{k}.json"));
        std::fs::write(&file, base.case).expect("a case");
        for family in &base.families {
            for variation in &family.variations {
                let set = base.set.iter().map(|&set| set.to_owned()).chain(variation.set.clone());
                let read = runs::read(&file, &set.collect::<Vec<_>>(), &[]);
                let Variation { label, known_limit, .. } = variation;
                assert!(
                    read.is_ok() || known_limit.is_some(),
                    "{}, {} {label}: {:?}",
                    base.name,
                    family.name,
                    read.err()
                );
            }
        }
    }
}

#[test]
fn a_few_variations_are_reached_in_balance() {
    let runs = specimens::measure(44, specimens::LIMIT, &[], |_| Progress::quiet()).expect("runs");
    let rows = specimens::rows(&runs);
    assert!(rows.len() >= 5);
    for row in &rows {
        assert_eq!((row.excluded, row.failed), (0, 0), "{row:?}");
        assert!(row.worst.is_some_and(|worst| worst <= 1.0), "{row:?}");
    }
}

/// A run is neither lost nor failed, and is reported by name.
#[test]
fn a_run_over_the_limit_is_given_up_and_named() {
    let limit = Limit { increments: 1, ..Limit::NONE };
    let runs = specimens::measure(200, limit, &[], |_| Progress::quiet()).expect("runs");
    let rows = specimens::rows(&runs);
    assert!(!rows.is_empty());
    for row in &rows {
        assert_eq!((row.excluded, row.failed), (1, 0), "{row:?}");
        assert!(row.note.starts_with("over the limit after 2 increments and "), "{row:?}");
    }
    let exceptions = specimens::exceptions(&runs);
    assert_eq!(exceptions.len(), rows.len());
    assert!(exceptions[0].contains(&rows[0].note), "{exceptions:?}");
    let header = "specimen,varied,from,to,variations,reached,refused,stopped,out of balance,over the limit,known limit";
    assert!(specimens::summary(&runs).csv().starts_with(header));
}
