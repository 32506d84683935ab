//! The shipped laws and the shipped cases.

use super::super::plugin::NORMAL_PENALTY;
use super::super::{Case, read};
use super::{Bench, point_case, schema_accepts};
use pullout_run::program::{PointKind, Program};
use serde_json::{Value, json};
use std::path::{Path, PathBuf};
use umat_abi::host::{Found, search_paths};

fn bond(props: Value) -> Value {
    json!({
        "kind": "interface",
        "material": { "plugin": "bond_slip", "props": props },
        "steps": [ { "increments": 4, "target": { "slip": 0.1, "p": 2 } } ]
    })
}

fn accepted(case: &Value) -> Program {
    Bench::new().read_point(case, &[]).unwrap_or_else(|errors| panic!("{errors}"))
}

fn refused(case: &Value) -> (u8, String) {
    let errors = Bench::new().read(case, &[]).expect_err("malformed");
    (errors.exit_code(), errors.to_string())
}

/// The value of a named parameter of the first occurrence.
fn value(program: &Program, name: &str) -> f64 {
    let law = program.plugin.law.as_ref().expect("metadata");
    program.plugin.props[law.parameters.iter().position(|p| p.name == name).expect("the parameter")]
}

#[test]
fn arguments_of_the_other_entry_point_are_reported() {
    let mut case = bond(json!({ "normal_law": "hard", "normal_stiffness": 4e4 }));
    case["arguments"] = json!({ "lm": 1, "dpress": 0.1, "slip": [0, 0], "flags": [1, 1], "area": 2 });
    let warnings = accepted(&case).about.warnings;
    let places: Vec<&str> = warnings.iter().filter_map(|warning| warning.split(": has no effect").next()).collect();
    assert_eq!(places, ["$.arguments.lm", "$.arguments.slip", "$.arguments.dpress"]);
}

#[test]
fn a_normal_penalty_of_zero_is_filled_and_said() {
    let program = accepted(&bond(json!({ "law": "B", "normal_law": "hard" })));
    assert_eq!((value(&program, "law"), value(&program, "normal_law")), (1.0, 0.0));
    assert_eq!((value(&program, "normal_stiffness"), value(&program, "k_f")), (NORMAL_PENALTY, 0.0));
    assert!(program.about.warnings.iter().any(|w| w.contains("normal_stiffness = 0")), "{:?}", program.about.warnings);
    let program = accepted(&bond(json!({ "normal_law": "hard", "normal_stiffness": 4e4 })));
    assert_eq!(value(&program, "normal_stiffness"), 4e4);
    assert!(program.about.warnings.is_empty(), "{:?}", program.about.warnings);
}

#[test]
fn a_tangential_penalty_is_filled_only_where_the_law_refuses_its_zero() {
    let program = accepted(&bond(json!({ "law": "none", "k_e": 0, "normal_stiffness": 1 })));
    assert!(value(&program, "k_f") > 0.0);
    assert!(program.about.warnings.iter().any(|w| w.contains("k_f = 0")), "{:?}", program.about.warnings);
}

#[test]
fn fric_leaves_the_normal_penalty_alone() {
    let mut case = bond(json!({}));
    case["material"]["entry"] = json!("fric");
    let program = accepted(&case);
    assert_eq!(value(&program, "normal_stiffness"), 0.0);
    assert!(program.about.warnings.is_empty());
}

#[test]
fn points_of_a_bond_law_are_counted() {
    let program = accepted(&bond(json!({ "form": "piecewise", "k_u": 0, "points": [[0.01, 5], [0.1, 2], [0.3, 1]] })));
    assert_eq!(value(&program, "n_points"), 3.0);
    assert!(program.plugin.props.ends_with(&[0.01, 5.0, 0.1, 2.0, 0.3, 1.0]));
}

/// Lists of before `c_N`, which stands between the number of points and these.
#[test]
fn a_list_without_what_the_law_got_later_is_completed() {
    let before = json!([
        1, 1, 0, 1e4, 2, 0.32, 0.05, 950, 1.5921, 0.0832, 0.87, -0.2678, 0, 850, 0.1, 0, 2, 1e-3, 0.95, 0.02, 1.2
    ]);
    let program = accepted(&bond(before.clone()));
    assert_eq!(value(&program, "c_N"), 0.0);
    assert!(program.plugin.props.len() == 22 && program.plugin.props.ends_with(&[2.0, 0.0, 1e-3, 0.95, 0.02, 1.2]));
    let mut whole = before.as_array().expect("a list").clone();
    whole.insert(17, json!(3));
    let program = accepted(&bond(Value::Array(whole)));
    assert_eq!((value(&program, "c_N"), program.plugin.props.len()), (3.0, 22));
}

#[test]
fn the_laws_own_objection_stands_at_its_parameters() {
    let (code, text) = refused(&bond(json!({ "form": "piecewise", "points": [[0.1, 5], [0.05, 2]] })));
    assert!(code == 2 && text.contains("$.material.props: bond_slip: "), "{text}");
    let (code, text) = refused(&bond(json!({ "law": "C" })));
    assert!(code == 2 && text.contains("$.material.props.law: 'C' is not one of 0 = A, 1 = B, 2 = none"), "{text}");
}

#[test]
fn a_bond_law_is_no_law_of_a_solid() {
    let mut case = point_case();
    case["material"] = json!({ "plugin": "bond_slip" });
    let (code, text) = refused(&case);
    let expected = "$.material.plugin: bond_slip has no UMAT: it is a law of a contact point; use kind \"interface\"";
    assert!(code == 2 && text.contains(expected), "{text}");
}

#[test]
fn hardening_is_a_list_of_points() {
    let mut case = point_case();
    case["material"] = json!({ "plugin": "j2_plasticity", "props": { "hardening": [[200, 0], [300, 0.1]] } });
    let program = accepted(&case);
    assert!(program.plugin.props.ends_with(&[200.0, 0.0, 300.0, 0.1]));
    case["material"]["props"] = json!({});
    let (code, text) = refused(&case);
    assert!(
        code == 2 && text.contains("$.material.props.hardening: is missing: j2_plasticity needs at least 1"),
        "{text}"
    );
}

fn case_files(folder: &Path) -> Vec<PathBuf> {
    let mut files = Vec::new();
    for entry in std::fs::read_dir(folder).into_iter().flatten().flatten() {
        let path = entry.path();
        if path.is_dir() {
            files.extend(case_files(&path));
        } else if path.extension().is_some_and(|suffix| suffix == "json") {
            files.push(path);
        }
    }
    files
}

/// The plugins that a case names, wherever it does.
fn plugins(document: &Value) -> Vec<&str> {
    match document {
        Value::Object(members) => {
            let own = members.get("plugin").and_then(Value::as_str);
            own.into_iter().chain(members.values().flat_map(plugins)).collect()
        }
        Value::Array(elements) => elements.iter().flat_map(plugins).collect(),
        _ => Vec::new(),
    }
}

#[test]
fn the_shipped_cases_are_read() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../cases");
    let paths = search_paths(&[]);
    let mut complaints = String::new();
    for file in case_files(&folder) {
        let text = std::fs::read_to_string(&file).expect("a case file");
        let document: Value = serde_json::from_str(&text).expect("JSON");
        if plugins(&document).iter().any(|plugin| Found::by_name(plugin, &paths).is_none()) {
            continue;
        }
        assert!(schema_accepts(&document), "{}", file.display());
        if super::super::is_study(&file) {
            continue;
        }
        match read(&file, &[], &[]) {
            Ok(case) => {
                let steps = match &case {
                    Case::Path(program) => match &program.kind {
                        PointKind::Point(point) => point.steps.len(),
                        PointKind::Interface(interface) => interface.steps.len(),
                    },
                    Case::Pullout(program) => program.model.steps.len(),
                    Case::Bridging(program) => program.openings.len(),
                };
                assert!(steps > 0 && !case.columns().is_empty());
                let unusual = case.about().warnings.iter().any(|warning| warning.contains("usual range"));
                // numbers without units; a block that is meant to be rigid
                assert_eq!(
                    unusual,
                    file.ends_with("cook-membrane.json") || file.ends_with("bar-on-an-arc.json"),
                    "{}: {:?}",
                    file.display(),
                    case.about().warnings
                );
            }
            Err(errors) => complaints.push_str(&format!("{errors}\n")),
        }
    }
    assert!(complaints.is_empty(), "{complaints}");
}

#[test]
fn a_slip_of_units_is_reported_with_the_usual_range() {
    let warnings = |plugin: &str, props: Value| {
        let mut case = point_case();
        case["material"] = json!({ "plugin": plugin, "props": props });
        accepted(&case).about.warnings
    };
    // GPa; thresholds of 3.5 MPa in kPa; J/m²
    let in_gpa = warnings("linear_elastic", json!({ "E": 31.8 }));
    let expected = "material.props.E = 31.8 MPa is outside the usual range, 500 to 1.2·10⁶ MPa";
    assert!(in_gpa.len() == 1 && in_gpa[0].starts_with(expected), "{in_gpa:?}");
    let listed = warnings("linear_elastic", json!([31.8, 0.18]));
    assert_eq!(listed, in_gpa);
    // a millionth per K, and microstrain
    let mut expands = point_case();
    expands["material"]["expansion"] = json!({ "alpha": [12, 12, 12], "initial_temperature": 0 });
    expands["material"]["shrinkage"] = json!({ "times": [0, 1], "strain": [0, -300] });
    let free = accepted(&expands).about.warnings;
    for words in
        ["material.expansion = 12 1/K is outside the usual range", "material.shrinkage.strain = −300 is outside"]
    {
        assert_eq!(free.iter().filter(|warning| warning.starts_with(words)).count(), 1, "{free:?}");
    }
    let threshold = warnings("concrete_damage", json!({ "Y_t0": 192.6 }));
    assert!(threshold.len() == 1 && threshold[0].starts_with("material.props.Y_t0 = 192.6 MPa"), "{threshold:?}");
    assert!(
        warnings("concrete_damage", json!({})).is_empty()
            && warnings("concrete_damage", json!({ "E": 31_800 })).is_empty()
    );
    assert!(warnings("drucker_prager", json!({ "E": 31.8 })).is_empty(), "a soft soil");
    // Pa; 1/GPa
    let damage = warnings("pure_damage", json!({ "A": 5e6, "Y_0": 3500 }));
    assert!(damage.len() == 2 && damage[0].starts_with("material.props.A = 5·10⁶ 1/MPa is outside"), "{damage:?}");
    let bond = accepted(&bond(json!({ "law": "none", "p_0": 2e6, "k_e": 0.001, "delta_N": 0 }))).about.warnings;
    let unusual: Vec<&String> = bond.iter().filter(|warning| warning.contains("usual range")).collect();
    assert!(unusual.len() == 2 && unusual[0].starts_with("material.props.p_0 = 2·10⁶ MPa is outside"), "{bond:?}");
}

#[test]
fn what_a_case_leaves_to_defaults_is_listed() {
    let left = |plugin: &str, props: Value| {
        let mut case = point_case();
        case["material"] = json!({ "plugin": plugin, "props": props });
        accepted(&case).about.defaults
    };
    assert_eq!(left("linear_elastic", json!({ "E": 1000 })), ["material.props: nu = 0.18"]);
    assert_eq!(left("linear_elastic", json!(null)), ["material.props: E = 31800, nu = 0.18"]);
    assert!(left("linear_elastic", json!([1000, 0.2])).is_empty());
    assert!(left("linear_elastic", json!({ "E": 1000, "nu": 0.2 })).is_empty());
    let bond = accepted(&bond(json!({ "law": "B", "points": [] }))).about.defaults;
    assert!(bond[0].contains("form = powers, normal_law = soft") && !bond[0].contains("n_points"), "{bond:?}");
}
