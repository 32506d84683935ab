//! PROPS of laws with groups and choices: the metadata of `linear_elastic`, changed.

use super::super::props_from_json;
use serde_json::json;
use umat_abi::host::{Choice, Found, LawDescription, Parameter, ParameterGroup, search_paths};

fn parameter(name: &str, default_value: f64, lower: f64, upper: f64) -> Parameter {
    Parameter {
        name: name.into(),
        unit: "MPa".into(),
        doc: String::new(),
        role: String::new(),
        default_value,
        lower,
        upper,
        lower_open: false,
        upper_open: false,
        choices: Vec::new(),
        typical: None,
    }
}

/// E, beta_mode (min 0, max 1, blend 2), n_points, then points (slip, traction), at least one.
fn law(count_parameter: Option<usize>) -> LawDescription {
    let found = Found::by_name("linear_elastic", &search_paths(&[])).expect("the plugin");
    let mut law = pullout_run::isolation::load(&found.path).expect("a library").laws()[0].clone();
    let mut mode = parameter("beta_mode", 0.0, 0.0, 2.0);
    mode.choices = ["uni", "bi", "blend"]
        .iter()
        .zip([0.0, 1.0, 2.0])
        .map(|(name, value)| Choice { value, name: (*name).into() })
        .collect();
    law.parameters = vec![
        parameter("E", 100.0, 0.0, f64::INFINITY),
        mode,
        parameter("n_points", 0.0, 0.0, f64::INFINITY),
        parameter("slip", 0.0, 0.0, f64::INFINITY),
        parameter("traction", 0.0, f64::NEG_INFINITY, f64::INFINITY),
    ];
    law.group = Some(ParameterGroup { name: "points".into(), size: 2, minimum: 1, count_parameter, added: 0 });
    law
}

fn values(props: serde_json::Value) -> Vec<f64> {
    props_from_json(&law(Some(2)), &props).expect("valid parameters")
}

fn problems(props: serde_json::Value) -> String {
    let problems = props_from_json(&law(Some(2)), &props).expect_err("malformed parameters");
    problems.iter().map(ToString::to_string).collect::<Vec<_>>().join("\n")
}

#[test]
fn groups_are_counted() {
    let expected = [100.0, 2.0, 2.0, 0.1, 5.0, 0.2, -3.0];
    assert_eq!(values(json!({ "beta_mode": "blend", "points": [[0.1, 5], [0.2, -3]] })), expected);
    assert_eq!(values(json!({ "beta_mode": 2, "points": [{"slip": 0.1, "traction": 5}, [0.2, -3]] })), expected);
    assert_eq!(values(json!({ "beta_mode": "Blend", "n_points": 2, "points": [[0.1, 5], [0.2, -3]] })), expected);
    assert_eq!(values(json!([100, 2, 2, 0.1, 5, 0.2, -3])), expected);
    let uncounted = props_from_json(&law(None), &json!({ "points": [[0.1, 5]] }));
    assert_eq!(uncounted.expect("valid"), [100.0, 0.0, 0.0, 0.1, 5.0]);
}

#[test]
fn each_parameters_problem_says_where_and_what() {
    for (props, expected) in [
        (json!({}), "$.material.props.points: is missing: linear_elastic needs at least 1 of [slip, traction]"),
        (json!(null), "$.material.props.points: is missing"),
        (json!({ "points": [] }), "0 of [slip, traction] given, at least 1 needed"),
        (json!({ "points": 3 }), "$.material.props.points: expected a list [[slip, traction], …]"),
        (json!({ "points": [[1]] }), "$.material.props.points[0]: 1 values given, 2 needed: [slip, traction]"),
        (json!({ "points": [1] }), "$.material.props.points[0]: 1 values given, 2 needed"),
        (
            json!({ "points": [[1, 2], [-1, 2]] }),
            "$.material.props.points[1][0]: slip = -1 is not admissible: it must be >= 0 MPa",
        ),
        (
            json!({ "points": [{ "slp": 1 }] }),
            "$.material.props.points[0].slp: unknown key; nearest valid name: 'slip'",
        ),
        (json!({ "n_points": 3, "points": [[1, 2]] }), "$.material.props.n_points: is 3, but 'points' has 1 entries"),
        (
            json!({ "slip": 3, "points": [[1, 2]] }),
            "$.material.props.slip: 'slip' belongs to the repeating group 'points'",
        ),
        (
            json!({ "beta_mode": "blnd", "points": [[1, 2]] }),
            "'blnd' is not one of 0 = uni, 1 = bi, 2 = blend; nearest valid name: 'blend'",
        ),
        (
            json!({ "beta_mode": 1.5, "points": [[1, 2]] }),
            "$.material.props.beta_mode: beta_mode = 1.5 is not admissible: it must be one of",
        ),
        (json!({ "E": "stiff", "points": [[1, 2]] }), "$.material.props.E: expected a number, found the text 'stiff'"),
        (json!({ "E": [[1]], "points": [[1, 2]] }), "$.material.props.E: expected a number, found an array"),
        (json!([100, 0, 2, 0.1, 5]), "$.material.props[2]: n_points = 2, but 1 follow"),
        (json!([100, 0, 1, 0.1]), "$.material.props: 4 values given, linear_elastic takes 5"),
        (json!([100, 7, 1, 0.1, 5]), "$.material.props[1]: beta_mode = 7"),
        (json!([100, 0, 0]), "3 values given"),
        (json!("E"), "expected an object of numbers"),
    ] {
        let problems = problems(props.clone());
        assert!(problems.contains(expected), "{props}: {problems}");
    }
}

#[test]
fn cmname_chooses_the_law_with_the_longest_name_that_it_begins_with() {
    let named = |name: &str| {
        let mut law = law(None);
        law.name = name.into();
        law
    };
    let laws = [named("bond"), named("bond_slip"), named("damage")];
    let chosen = |cmname: &str| LawDescription::named(&laws, cmname).map(|law| law.name.clone());
    assert_eq!(chosen("BOND_SLIP_BAR_1").as_deref(), Some("bond_slip"));
    assert_eq!(chosen("Bond-2").as_deref(), Some("bond"));
    assert_eq!(chosen("my_damage"), None);
}
