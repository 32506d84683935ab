//! `--threads`: a run leaves the same files with any number.

use crate::program::{Desk, cases, files, timeless};
use std::path::Path;

/// Checks that several threads give the same results as one.
fn same_with_any_number(case: &Path, overrides: &[&str]) {
    let desk = Desk::new();
    let case = case.to_string_lossy();
    let run = |threads: &str| {
        let folder = desk.path(threads);
        let out = folder.to_string_lossy().into_owned();
        let settings = overrides.iter().flat_map(|entry| ["--set", entry]);
        let arguments = ["run", &case, "--quiet", "--checkpoint-every", "5", "--threads", threads, "--out", &out];
        desk.pullout(arguments.into_iter().chain(settings)).expect(0);
        (files(&folder), timeless(&folder))
    };
    let (files, summary) = run("1");
    assert!(files.contains_key("history.csv"));
    for threads in ["2", "3"] {
        let (found, found_summary) = run(threads);
        assert_eq!(files.keys().collect::<Vec<_>>(), found.keys().collect::<Vec<_>>());
        for (name, content) in &files {
            assert!(content == &found[name], "{threads} threads: {name} differs");
        }
        assert_eq!(found_summary, summary, "{threads} threads");
    }
}

fn bent_fibre(slip: &str) {
    let case = cases().join("chapter-7").join("inclined-fibre.json");
    same_with_any_number(&case, &["mesh.specimen.mesh_size=2", slip, "output.vtu=9"]);
}

#[test]
fn a_bent_fibre() {
    bent_fibre("steps.0.slip=0.005");
}

#[test]
#[ignore = "long: a_bent_fibre goes a quarter of the way"]
fn a_bent_fibre_that_tears_its_exit() {
    bent_fibre("steps.0.slip=0.02");
}

#[test]
fn a_plate_whose_matrix_is_cut_in_two() {
    same_with_any_number(
        &cases().join("benchmark").join("plate-with-hole.json"),
        &["mesh.specimen.cells=2000", "steps.0.increments=3"],
    );
}

#[test]
fn no_threads_are_bad_input() {
    let desk = Desk::new();
    let case = cases().join("benchmark").join("plate-with-hole.json");
    let outcome = desk.pullout(["run", &case.to_string_lossy(), "--threads", "0"]).expect(2);
    assert!(outcome.stderr.contains("--threads"), "{}", outcome.stderr);
}
