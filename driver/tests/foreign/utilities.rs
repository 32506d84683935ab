//! The utility routines, called from Fortran. (Called directly, on random tensors: `tests/tests/utilities.rs`.)

use super::{built, point, run};
use crate::program::{Desk, copy_program_to};
use end_to_end_tests::plugin;
use serde_json::json;
use std::process::Command;

/// S and E of the source, 11, 22, 33, 12, 13, 23; E = S · 1e-4 with engineering shear.
const S: [f64; 6] = [60.0, -20.0, 10.0, 15.0, -25.0, 5.0];
const E: [f64; 6] = [6e-3, -2e-3, 1e-3, 3e-3, -5e-3, 1e-3];

#[test]
fn every_routine_answers_as_its_manual_says() {
    let desk = Desk::new();
    let Some(library) = built(&desk, "calls_utilities.f", &[]) else { return };
    let material = json!({ "plugin": library, "props": [30e3, 0.2], "nstatv": 45 });
    let steps = json!([{ "increments": 3, "target": { "e11": 1e-3 } }]);
    let run = run(&desk, "utilities", &point(material, "3d", steps));
    super::close(run.history.last("s11"), 30.0);
    let state = |number: usize| run.history.last(&format!("sdv{number}"));
    let states = |from: usize, count: usize| (from..from + count).map(state).collect::<Vec<_>>();
    let close = |found: f64, expected: f64| {
        assert!((found - expected).abs() <= 1e-13 * expected.abs().max(1e-3), "{found} instead of {expected}");
    };

    // SINV: tr/3 and √(3/2 S:S)
    close(state(1), (60.0 - 20.0 + 10.0) / 3.0);
    let mises = 0.5 * (80.0_f64.powi(2) + 30.0_f64.powi(2) + 50.0_f64.powi(2))
        + 3.0 * (15.0_f64.powi(2) + 25.0_f64.powi(2) + 5.0_f64.powi(2));
    close(state(2), mises.sqrt());

    // SPRINC: the invariants of the principal values are those of S
    let [a, b, c]: [f64; 3] = states(3, 3).try_into().expect("three values");
    let [s11, s22, s33, s12, s13, s23] = S;
    close(a + b + c, s11 + s22 + s33);
    close(a * b + b * c + c * a, s11 * s22 + s22 * s33 + s33 * s11 - s12 * s12 - s13 * s13 - s23 * s23);
    let determinant = s11 * (s22 * s33 - s23 * s23) - s12 * (s12 * s33 - s23 * s13) + s13 * (s12 * s23 - s22 * s13);
    close(a * b * c, determinant);

    // SPRIND of the strain, whose tensor is S · 1e-4: E·n = PS(K) n with n = AN(K,·), of length 1
    let matrix = [[E[0], E[3] / 2.0, E[4] / 2.0], [E[3] / 2.0, E[1], E[5] / 2.0], [E[4] / 2.0, E[5] / 2.0, E[2]]];
    for (k, value) in states(6, 3).into_iter().enumerate() {
        let n = states(9 + 3 * k, 3);
        close(n.iter().map(|x| x * x).sum::<f64>(), 1.0);
        for (row, cosine) in matrix.iter().zip(&n) {
            let image: f64 = row.iter().zip(&n).map(|(x, y)| x * y).sum();
            assert!((image - value * cosine).abs() < 1e-17, "{image} instead of {}", value * cosine);
        }
    }

    // ROTSIG by a quarter turn: 1 → 2, 2 → −1
    assert_eq!(states(18, 6), [s22, s11, s33, -s12, -s23, s13]);
    assert_eq!(states(24, 6), [E[1], E[0], E[2], -E[3], -E[5], E[4]]);

    // GETRANK, GETNUMCPUS; GETPARTINFO of element 1: no part, its own number, no error; GETVRM: nothing to ask for
    assert_eq!(states(30, 5), [0.0, 1.0, 1.0, 0.0, 1.0]);
    // MutexLock does not keep what it locks: the state counted each converged increment
    assert_eq!(state(37), 3.0);

    // GETJOBNAME, GETOUTDIR, STDB_ABQERR
    let folder = desk.path("");
    let folder = folder.to_str().expect("UTF-8").trim_end_matches('/');
    assert_eq!((state(35), state(36)), ("utilities".len() as f64, folder.len() as f64));
    let note = format!("***NOTE: JOB utilities IN {folder}");
    let issued = ["***WARNING: 1, 0.5, STEEL; -7, -2, FIBRE; 5%", "***ERROR: AN ERROR"];
    let log = run.log();
    for line in [note.as_str()].into_iter().chain(issued) {
        assert!(log.lines().any(|found| found == line), "no '{line}' in {log}");
        let is_shown = run.outcome.stderr.lines().any(|found| found == line);
        assert_eq!(is_shown, line != note, "'{line}' in {}", run.outcome.stderr);
    }
}

/// A law that warns in each call shows what it has to say a few times.
#[test]
fn messages_do_not_flood_the_terminal() {
    let desk = Desk::new();
    let Some(library) = built(&desk, "calls_utilities.f", &[]) else { return };
    let material = json!({ "plugin": library, "props": [30e3, 0.2], "nstatv": 45 });
    // it does so in the first increment of a step
    let steps = json!([{ "repeat": 100, "steps": [{ "increments": 1, "target": { "e11": 1e-3 } }] }]);
    let run = run(&desk, "many", &point(material, "3d", steps));
    let count =
        |text: &str| text.lines().filter(|line| line.starts_with("***WARNING") || line.starts_with("***ERROR")).count();
    assert!(count(&run.log()) >= 200, "{}", run.log());
    assert_eq!(count(&run.outcome.stderr), 10, "{}", run.outcome.stderr);
    assert!(run.outcome.stderr.contains("umat.log in the result directory has all"), "{}", run.outcome.stderr);
}

/// `<prefix>/bin/pullout` finds them in `<prefix>/lib/pullout`, and where Cargo built the program if they are not there.
#[test]
fn they_are_found_in_an_installation() {
    let desk = Desk::new();
    let Some(library) = built(&desk, "calls_utilities.f", &[]) else { return };
    let material = json!({ "plugin": library, "props": [30e3, 0.2], "nstatv": 45 });
    let steps = json!([{ "increments": 1, "target": { "e11": 1e-3 } }]);
    let case = desk.case("case.json", &point(material, "3d", steps));
    let utilities = plugin("pullout_utilities");
    let installed = desk.write("prefix/lib/pullout/place", "").with_file_name(utilities.file_name().expect("a name"));
    std::fs::copy(&utilities, &installed).expect("a copy");
    let program = desk.write("prefix/bin/place", "").with_file_name("pullout");
    copy_program_to(&program);
    let run = || {
        let mut command = Command::new(&program);
        command.env_remove("PULLOUT_PLUGIN_PATH").current_dir(desk.path(".")).args(["run", "--quiet"]).arg(&case);
        command.output().expect("the program starts")
    };
    let found = run();
    assert_eq!(found.status.code(), Some(0), "{}", String::from_utf8_lossy(&found.stderr));
    std::fs::remove_file(&installed).expect("it was there");
    let built = run();
    assert_eq!(built.status.code(), Some(0), "{}", String::from_utf8_lossy(&built.stderr));
}
