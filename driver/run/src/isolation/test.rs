use super::need::{Need, need};
use super::supervisor::Clock;
use super::system::waiting_time;
use super::{replay, trust};
use end_to_end_tests::{plugin, shipped_laws};
use serde_json::{Value, json};
use std::path::{Path, PathBuf};
use std::time::Duration;
use umat_abi::host::UmatInputs;
use umat_abi::host::recorder::{CallRecord, RecordedArguments, UmatRecord};
use umat_abi::metadata::PLUGIN_SYMBOL;

/// Returns the need of a case with these materials: a point's, or a specimen's parts and contact. `foreign.so` is a
/// library that only mentions our metadata, `linear_elastic` a plugin of ours.
fn need_of(case: &Value) -> Option<Need> {
    let folder = tempfile::tempdir().expect("a folder");
    std::fs::write(folder.path().join("foreign.so"), PLUGIN_SYMBOL).expect("a file");
    let file = folder.path().join("case.json");
    let found = need(case, &file, &[end_to_end_tests::plugin_folder()]);
    found.map(|need| {
        let name = |path: PathBuf| path.file_stem().map(PathBuf::from).unwrap_or_default();
        Need { libraries: need.libraries.into_iter().map(|(path, limit)| (name(path), limit)).collect(), ..need }
    })
}

/// The kernel reports waiting when it is over: what was counted before is subtracted then, and a hanging call still
/// ends.
#[test]
fn time_of_a_worker_that_waits_for_a_processor_does_not_count() {
    let milliseconds = Duration::from_millis;
    let mut clock = Clock::default();
    assert_eq!(clock.count(milliseconds(20), milliseconds(0)), milliseconds(20));
    assert_eq!(clock.count(milliseconds(20), milliseconds(30)), milliseconds(0));
    assert_eq!(clock.count(milliseconds(20), milliseconds(30)), milliseconds(10));
    // this process was stopped; then both waited
    assert_eq!(clock.count(milliseconds(5000), milliseconds(30)), milliseconds(40));
    assert_eq!(clock.count(milliseconds(200), milliseconds(190)), milliseconds(40));
}

/// More processes than processors: each waits.
#[test]
fn a_busy_machine_is_seen() {
    if std::fs::read("/proc/self/schedstat").is_err() {
        return;
    }
    let count = 4 * std::thread::available_parallelism().expect("a number").get();
    let busy = || std::process::Command::new("sh").args(["-c", "while :; do :; done"]).spawn().expect("a shell");
    let mut children: Vec<_> = (0..count).map(|_| busy()).collect();
    std::thread::sleep(Duration::from_millis(500));
    let waited: Duration = children.iter().map(|child| waiting_time(child.id().into())).sum();
    for child in &mut children {
        child.kill().expect("it runs");
        child.wait().expect("its end");
    }
    assert!(waited > Duration::from_millis(100), "{waited:?}");
}

fn point(material: Value) -> Option<Need> {
    need_of(&json!({ "kind": "point", "material": material }))
}

#[test]
fn only_what_was_built_with_the_program_runs_in_it_unasked() {
    for law in shipped_laws().iter().map(String::as_str).chain(["pullout_laws"]) {
        assert!(trust::is_shipped(&plugin(law)), "{law}");
    }
    // with metadata, but of another build
    assert!(!trust::is_shipped(&plugin("sound_damage")));
    let folder = tempfile::tempdir().expect("a folder");
    let copy = folder.path().join("libcopy.so");
    std::fs::copy(plugin("linear_elastic"), &copy).expect("a copy");
    assert!(trust::is_shipped(&copy));
    let mut content = std::fs::read(&copy).expect("a file");
    *content.last_mut().expect("bytes") ^= 1;
    std::fs::write(&copy, content).expect("a file");
    assert!(!trust::is_shipped(&copy), "it is not the same any more");
    assert!(!trust::may_run_here(&copy));
    trust::let_in(&copy);
    assert!(trust::may_run_here(&copy) && !trust::may_run_here(&plugin("sound_damage")));
    let case = json!({ "material": { "plugin": copy, "symbol": "umat_" } });
    assert_eq!(need(&case, Path::new("case.json"), &[]), None);
}

#[test]
fn what_was_built_with_the_program_stays_loaded_until_its_file_is_another() {
    let laws = |file: &Path| trust::load(file).expect("a library").laws().as_ptr();
    let own = plugin("linear_elastic");
    let first = trust::load(&own).expect("a library");
    assert_eq!(laws(&own), first.laws().as_ptr());
    // of another build: each time what stands in the file
    let other = plugin("sound_damage");
    let first = trust::load(&other).expect("a library");
    assert_ne!(laws(&other), first.laws().as_ptr());
    let folder = tempfile::tempdir().expect("a folder");
    let file = folder.path().join("liblaw.so");
    let replaced_by = |law: &str| {
        std::fs::copy(plugin(law), folder.path().join("new")).expect("a copy");
        std::fs::rename(folder.path().join("new"), &file).expect("in its place");
        trust::load(&file)
    };
    for law in ["linear_elastic", "j2_plasticity", "sound_damage", "linear_elastic"] {
        assert_eq!(replaced_by(law).expect("a library").laws()[0].name, law);
    }
    // the loader goes by names: it would give the law that is in use for the new one
    let in_use = replaced_by("sound_damage").expect("a library");
    let refusal = replaced_by("linear_elastic").expect_err("the other one is in use").to_string();
    assert!(refusal.contains("was changed since this process loaded it"), "{refusal}");
    drop(in_use);
    assert_eq!(trust::load(&file).expect("a library").laws()[0].name, "linear_elastic");
}

#[test]
fn other_libraries_are_isolated() {
    let foreign = |need: Option<Need>| need.expect("isolated");
    let need = foreign(point(json!({ "plugin": "./foreign.so" })));
    assert_eq!((need.libraries[Path::new("foreign")], need.is_against_a_wish), (60.0, false));
    assert!(foreign(point(json!({ "plugin": "./foreign.so", "isolate": false }))).is_against_a_wish);
    for sound in [json!({}), json!({ "isolate": false }), json!({ "call_time_limit_s": 5 })] {
        let mut material = sound;
        material["plugin"] = json!("linear_elastic");
        assert_eq!(point(material.clone()), None);
        material["symbol"] = json!("linear_elastic_umat_");
        assert!(point(material.clone()).is_some(), "a symbol of the case's choice");
        material["symbol"] = json!(null);
        material["isolate"] = json!(true);
        assert!(!foreign(point(material)).is_against_a_wish);
    }
    let own = json!({ "plugin": "linear_elastic", "isolate": true, "call_time_limit_s": 5 });
    assert_eq!(foreign(point(own)).libraries[Path::new("liblinear_elastic")], 5.0);
}

#[test]
fn one_law_of_a_specimen_isolates_all() {
    let own = json!({ "plugin": "linear_elastic", "call_time_limit_s": 10 });
    let foreign = |limit: f64| json!({ "plugin": "./foreign.so", "call_time_limit_s": limit });
    let case = |fibre: &Value, matrix: &Value, contact: Value| {
        let parts = json!({ "fibre": { "material": fibre }, "matrix": { "material": matrix } });
        need_of(&json!({ "kind": "pullout", "parts": parts, "contact": contact }))
    };
    assert_eq!(case(&own, &own, json!({ "law": own })), None);
    let need = case(&own, &foreign(2.0), json!({ "law": own })).expect("isolated");
    assert!(need.specimen);
    assert_eq!((need.libraries.len(), need.longest_time()), (2, 10.0));
    assert!(case(&own, &own, json!({ "law": foreign(2.0) })).is_some());
    // of two limits for one library the longer one
    let need = case(&own, &own, json!([{ "law": foreign(20.0) }, { "law": foreign(30.0) }])).expect("isolated");
    assert_eq!(need.longest_time(), 30.0);
    // a worker without libraries, as of a sweep of fibres across a crack, has no calls to wait for: it was ended 0 s after its results
    assert_eq!(Need::default().longest_time(), f64::INFINITY);
}

#[test]
fn what_cannot_be_read_is_not_isolated() {
    for case in [json!([]), json!({}), json!({ "material": 3 }), json!({ "material": { "plugin": 3 } })] {
        assert_eq!(need_of(&case), None, "{case}");
    }
    assert_eq!(point(json!({ "plugin": "./nowhere.so" })), None);
    assert_eq!(point(json!({ "plugin": "nowhere" })), None);
}

#[test]
fn a_replay_has_numbers_only() {
    let mut inputs = UmatInputs::default();
    inputs.stran[1] = 1e-3;
    let call = |state: f64| CallRecord {
        name: "foreign".into(),
        library: "/somewhere/libforeign.so".into(),
        symbol: None,
        cmname: "FOREIGN".into(),
        wants_tangent: true,
        arguments: RecordedArguments::Umat(UmatRecord {
            stress: vec![0.0; 4],
            inputs,
            statev: vec![1.0, state],
            ..UmatRecord::default()
        }),
    };
    let replay = replay::of(&call(2.0), &Need::default()).expect("a case");
    assert_eq!((&replay["mode"], &replay["initial"]["statev"]), (&json!("plane_strain"), &json!([1.0, 2.0])));
    assert_eq!((&replay["material"]["nstatv"], replay["material"].get("isolate")), (&json!(2), None));
    for state in [f64::NAN, f64::INFINITY] {
        assert_eq!(replay::of(&call(state), &Need::default()), None);
    }
}
