//! `pullout plugin check` passes sound plugins and finds each error planted in `tests/faulty/`.

use pullout_check::conformance::{CheckRow, Options, Report, Verdict, check};
use std::path::PathBuf;
use umat_abi::host::{Found, Plugin, search_paths};

/// The plugin of that name, built into target/*/deps/ as a dev-dependency.
fn plugin(name: &str) -> Plugin {
    let paths: Vec<PathBuf> = search_paths(&[]);
    let found = Found::by_name(name, &paths).unwrap_or_else(|| panic!("{name} is not in {paths:?}"));
    let library = end_to_end_tests::open(&found.path);
    Plugin { cmname: name.into(), ..Plugin::with_defaults(&library, library.laws().first().expect("metadata")) }
}

fn report(name: &str) -> Report {
    let report = check(&plugin(name), &Options::default());
    println!("{name}\n{report}");
    report
}

/// The checks that failed, without repetition.
fn failed(report: &Report) -> Vec<&str> {
    let mut checks: Vec<_> = report.failures().map(|row| &*row.check).collect();
    checks.sort_unstable();
    checks.dedup();
    checks
}

fn row<'r>(report: &'r Report, check: &str, stress_state: &str) -> &'r CheckRow {
    report
        .rows
        .iter()
        .find(|row| row.check == check && row.stress_state.starts_with(stress_state))
        .unwrap_or_else(|| panic!("no row {check}"))
}

#[test]
fn sound_plugins_pass_everything() {
    for name in ["linear_elastic", "sound_damage", "sound_interface"] {
        let report = report(name);
        assert!(report.passed(), "{name}:\n{report}");
        assert!(report.rows.iter().all(|row| row.verdict != Verdict::Warn), "{name}:\n{report}");
        assert!(report.rows.iter().filter(|row| row.verdict == Verdict::Pass).count() > 40, "{name}:\n{report}");
    }
}

/// Without one it refuses, and that is what the checks ask for.
#[test]
fn a_law_that_needs_a_length_passes() {
    let plugin = plugin("concrete_damage");
    let law = plugin.law.as_ref().expect("metadata");
    let mut props: Vec<f64> = law.parameters.iter().map(|parameter| parameter.default_value).collect();
    props[12] = 0.1;
    let report = check(&plugin, &Options { props: Some(props), states: 60, ..Options::default() });
    assert!(report.passed(), "{report}");
    assert_eq!(row(&report, "CELENT unusable", "3D").verdict, Verdict::Pass);
}

#[test]
fn a_secant_is_called_so() {
    let report = report("secant_tangent");
    assert_eq!(failed(&report), ["consistent tangent"]);
    for stress_state in ["3D", "plane strain", "plane stress"] {
        let row = row(&report, "consistent tangent", stress_state);
        assert!(row.detail.starts_with("secant-like"), "{}", row.detail);
    }
}

#[test]
fn half_a_damage_term_is_measured() {
    let report = report("halved_tangent");
    assert_eq!(failed(&report), ["consistent tangent"]);
    let row = row(&report, "consistent tangent", "3D");
    assert!(row.detail.contains("is 0.500 of what it should be"), "{}", row.detail);
}

#[test]
fn a_hidden_counter_is_found() {
    let report = report("hidden_memory");
    let failed = failed(&report);
    for check in ["repeated call", "order of calls", "thread safety"] {
        assert!(failed.contains(&check), "{check}: {failed:?}");
    }
    assert!(!failed.contains(&"consistent tangent"), "{failed:?}");
}

#[test]
fn a_write_behind_statev_is_named() {
    let report = report("state_overrun");
    assert_eq!(failed(&report), ["array bounds"]);
    assert!(row(&report, "array bounds", "3D").detail.contains("STATEV"));
}

#[test]
fn an_unset_tangent_entry_is_named() {
    let report = report("unset_entry");
    let failed = failed(&report);
    assert!(failed.contains(&"tangent entries set"), "{failed:?}");
    assert_eq!(row(&report, "tangent entries set", "3D").detail, "never written: (1,2)");
}

#[test]
fn a_panic_is_reported_with_its_state() {
    let report = report("panicking");
    assert!(failed(&report).contains(&"answers"));
    let row = row(&report, "answers", "3D");
    assert!(row.detail.contains("state ") && row.detail.contains("panic"), "{}", row.detail);
}

#[test]
fn an_interface_tangent_is_checked() {
    let report = report("halved_interface_tangent");
    assert_eq!(failed(&report), ["consistent tangent"]);
    for stress_state in ["UINTER, NDIR 2", "UINTER, NDIR 3", "FRIC, NFDIR 1", "FRIC, NFDIR 2"] {
        assert_eq!(row(&report, "consistent tangent", stress_state).verdict, Verdict::Fail);
    }
}

#[test]
fn a_plain_umat_is_warned_of_not_failed() {
    let mut plain = plugin("secant_tangent");
    plain.law = None;
    plain.props = vec![31800.0, 0.18, 2e-4, 1e-3, 0.0];
    let report = check(&plain, &Options::default());
    println!("{report}");
    assert!(report.passed(), "{report}");
    assert_eq!(row(&report, "consistent tangent", "3D").verdict, Verdict::Warn);
}

/// Each error of `tests/faulty/selected_fault` by its number, and the check that must fail.
#[test]
fn every_check_can_fail() {
    const FAULTS: [(f64, &str); 19] = [
        (1.0, "isotropy"),
        (2.0, "energy balance"),
        (3.0, "zero increment"),
        (10.0, "increment size"),
        (4.0, "symmetric tangent"),
        (5.0, "strain_33"),
        (5.0, "thickness"),
        (6.0, "stress only"),
        (7.0, "virgin state"),
        (8.0, "consistent tangent"),
        (9.0, "agrees with 3D"),
        (20.0, "NaN and infinity"),
        (21.0, "wrong PROPS"),
        (22.0, "wrong counts"),
        (23.0, "NULL arguments"),
        (24.0, "inputs untouched"),
        (27.0, "inputs untouched"),
        (25.0, "DROT"),
        (28.0, "order of calls"),
    ];
    let plugin = plugin("selected_fault");
    let checked = |fault: f64| {
        let props = Some(vec![31800.0, 0.18, 2e-4, 1e-3, fault]);
        check(&plugin, &Options { props, states: 60, ..Options::default() })
    };
    assert!(checked(0.0).passed(), "{}", checked(0.0));
    let checked = &checked;
    // by far the longest of these tests
    std::thread::scope(|scope| {
        for half in FAULTS.chunks(FAULTS.len().div_ceil(2)) {
            scope.spawn(move || {
                for &(fault, expected) in half {
                    let report = checked(fault);
                    assert!(failed(&report).contains(&expected), "fault {fault} does not fail '{expected}':\n{report}");
                }
            });
        }
    });
    assert!(failed(&checked(26.0)).contains(&"CELENT unusable"), "{}", checked(26.0));
    assert!(row(&checked(8.0), "consistent tangent", "3D").detail.starts_with("elastic"), "{}", checked(8.0));
}
