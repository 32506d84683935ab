use super::*;

fn names<R>(table: &[HistoryColumn<R>]) -> Vec<&'static str> {
    table.iter().map(|column| column.name).collect()
}

#[test]
fn names_are_unique_and_begin_with_the_time() {
    for mut names in [names(POINT), names(CONTACT), names(SPECIMEN)] {
        assert_eq!(names[0], "time");
        let count = names.len();
        names.sort_unstable();
        names.dedup();
        assert_eq!(names.len(), count);
    }
}

/// A study finds a column of a case of kind bridging by its name alone.
#[test]
fn names_of_bridging_and_beam_are_unique() {
    let mut all: Vec<&str> = names(BRIDGING).into_iter().chain(names(BEAM)).collect();
    let count = all.len();
    all.sort_unstable();
    all.dedup();
    assert_eq!(all.len(), count);
}
