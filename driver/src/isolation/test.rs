use super::need::{Need, need};
use super::replay;
use serde_json::{Value, json};
use std::path::PathBuf;
use umat_abi::host::recorder::{Arguments, CallRecord, UmatRecord};

/// What a case with these materials needs: a point's, or a specimen's parts and contact. `foreign.so` is a library
/// without metadata, `linear_elastic` a plugin of ours.
fn need_of(case: &Value) -> Option<Need> {
    let folder = tempfile::tempdir().expect("a folder");
    std::fs::write(folder.path().join("foreign.so"), "no metadata in here").expect("a file");
    let file = folder.path().join("case.json");
    std::fs::write(&file, case.to_string()).expect("a file");
    let found = need(&file, &[], &[end_to_end_tests::plugin_folder()]);
    found.map(|need| {
        let name = |path: PathBuf| path.file_stem().map(PathBuf::from).unwrap_or_default();
        Need { libraries: need.libraries.into_iter().map(|(path, terms)| (name(path), terms)).collect(), ..need }
    })
}

fn point(material: Value) -> Option<Need> {
    need_of(&json!({ "kind": "point", "material": material }))
}

#[test]
fn libraries_without_metadata_are_isolated_by_default() {
    let terms = |need: Option<Need>, name: &str| need.map(|need| need.libraries[&PathBuf::from(name)]);
    let foreign = terms(point(json!({ "plugin": "./foreign.so" })), "foreign").expect("isolated");
    assert_eq!((foreign.time_limit, foreign.asked_for), (60.0, false));
    assert_eq!(point(json!({ "plugin": "./foreign.so", "isolate": false })), None);
    assert_eq!(point(json!({ "plugin": "linear_elastic" })), None);
    assert_eq!(point(json!({ "plugin": "linear_elastic", "call_time_limit_s": 5 })), None);
    let own = json!({ "plugin": "linear_elastic", "isolate": true, "call_time_limit_s": 5 });
    let own = terms(point(own), "liblinear_elastic").expect("isolated");
    assert_eq!((own.time_limit, own.asked_for), (5.0, true));
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
    let call = |state: f64| CallRecord {
        name: "foreign".into(),
        library: "/somewhere/libforeign.so".into(),
        symbol: None,
        cmname: "FOREIGN".into(),
        wants_tangent: true,
        arguments: Arguments::Umat(UmatRecord {
            stran: vec![0.0, 1e-3, 0.0, 0.0],
            statev: vec![1.0, state],
            ..UmatRecord::default()
        }),
    };
    let replay = replay::of(&call(2.0), "title", &Need::default()).expect("a case");
    assert_eq!((&replay["mode"], &replay["initial"]["statev"]), (&json!("plane_strain"), &json!([1.0, 2.0])));
    assert_eq!((&replay["material"]["nstatv"], replay["material"].get("isolate")), (&json!(2), None));
    for state in [f64::NAN, f64::INFINITY] {
        assert_eq!(replay::of(&call(state), "title", &Need::default()), None);
    }
}
