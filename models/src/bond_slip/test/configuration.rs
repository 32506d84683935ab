//! PROPS and increments that are refused.

use super::*;
use umat_abi::law::{ConfigurationError, InterfaceIncrement, TangentialIncrement};
use umat_abi::law::{advance_contact, advance_sliding, read_parameters};

/// The rule that PROPS break, if any.
fn broken_rule(props: &[f64]) -> Option<&'static str> {
    check_properties(&BondSlip::INFO, props).expect("within the table's bounds");
    match read_parameters::<BondSlipParameters<'_>>(&BondSlip::INFO, props) {
        Err(ConfigurationError::Inconsistent { rule, .. } | ConfigurationError::Exceeds { rule, .. }) => Some(rule),
        Err(error) => panic!("{error}"),
        Ok(_) => None,
    }
}

fn refuses(props: &[f64], word: &str) {
    let rule = broken_rule(props).unwrap_or_else(|| panic!("accepted: {props:?}"));
    assert!(rule.contains(word), "{rule}");
}

/// The slope and k_e, not the traction of the point.
#[test]
fn a_first_segment_that_is_too_steep_is_reported_with_its_slope() {
    let refused = Envelope::piecewise(400.0, &[[0.005, 3.0], [20.0, 2.0]], 0.0).expect_err("600 MPa/mm");
    assert_eq!(refused.to_string(), "the first segment must not be steeper than k_e, in MPa/mm (600 > 400)");
    let refused = Envelope::piecewise(400.0, &[[0.01, 2.0], [0.02, 5.0]], 0.0).expect_err("it grows");
    assert!(refused.to_string().ends_with("(250 > 200)"), "{refused}");
}

#[test]
fn defaults_are_consistent() {
    assert_eq!(broken_rule(&props(&[])), None);
    for props in variants() {
        assert_eq!(broken_rule(&props), None);
    }
}

#[test]
fn refuses_what_gives_no_envelope() {
    refuses(&props(&[(K_E, 0.0)]), "k_e");
    refuses(&props(&[(B_1, 1.0)]), "b_1");
    refuses(&props(&[(B_1 + 2, 0.1)]), "b_2");
    refuses(&props(&[(A_2, 0.0)]), "a_2");
    refuses(&props(&[(A_2 - 2, 0.0)]), "a_1");
    refuses(&props(&[(A_2, 1e-6)]), "g_crit < g_peak");
    refuses(&props(&[(TAU_RES, 1.4)]), "tau_res");
    refuses(&props(&[(LAW, 1.0), (TAU_RES, 1.0)]), "tau_res");
    refuses(&props(&[(G_0, 0.0)]), "g_0");
    for set in [(LAW, 0.0), (NORMAL_LAW, 1.0)] {
        refuses(&mixed(1.0, &[set]), "mixed mode");
    }
    // law none ignores it
    assert_eq!(broken_rule(&mixed(1.0, &[(LAW, 2.0)])), None);
    refuses(&props(&[(LAW, 2.0), (K_E, 0.0)]), "k_f");
    assert_eq!(broken_rule(&props(&[(LAW, 2.0), (K_E, 0.0), (K_F, 1e4)])), None);
}

#[test]
fn refuses_points_that_give_no_envelope() {
    refuses(&piecewise(&[], &[]), "one point");
    refuses(&piecewise(&[], &[[0.0, 0.0]]), "one point");
    refuses(&piecewise(&[], &[[1e-3, 0.0]]), "traction");
    refuses(&piecewise(&[], &[[1e-3, 1.0]]), "steeper");
    refuses(&piecewise(&[], &[[1e-3, 0.9], [1e-3, 1.0]]), "increase");
    refuses(&piecewise(&[(TAU_RES, 0.0)], &[[1e-3, 0.1], [2e-3, 0.5]]), "secant");
    // a hump after a valley: damage would have to heal
    refuses(&piecewise(&[(LAW, 1.0)], &[[1e-3, 0.95], [2e-3, 0.55], [3e-3, 0.8]]), "damage");
    assert_eq!(broken_rule(&piecewise(&[(TAU_RES, 0.0)], &[[1e-3, 0.5]])), None);
    assert_eq!(broken_rule(&piecewise(&[], &[[0.0, 0.5]])), None);
    let wrong_count = [&props(&[(FORM, 1.0), (POINT_COUNT, 2.0)])[..], &[1e-3, 0.5]].concat();
    let error = check_properties(&BondSlip::INFO, &wrong_count);
    assert!(matches!(error, Err(ConfigurationError::ParameterCount { given: 19, expected: 22 })));
}

#[test]
fn the_hard_law_needs_its_stiffness_only_where_it_is_used() {
    let props = props(&[(NORMAL_LAW, 0.0)]);
    let parameters =
        read_parameters::<BondSlipParameters<'_>>(&BondSlip::INFO, &props).expect("a host may fill the 0 later");
    let mut state = State::default();
    let contact = InterfaceIncrement {
        directions: 2,
        relative_displacement: [0.0, 1e-4, 0.0],
        increment: [0.0, 1e-4, 0.0],
        traction: [0.0; 3],
    };
    let refused = advance_contact::<BondSlip>(&parameters, &contact, &mut state, Request::StressAndTangent);
    assert!(matches!(refused, Err(Failure::Configuration(ConfigurationError::Inconsistent { .. }))));
    let sliding = TangentialIncrement { directions: 1, slip_increment: [1e-4, 0.0], pressure: 0.0 };
    let response = advance_sliding::<BondSlip>(&parameters, &sliding, &mut state, Request::StressAndTangent);
    approx::assert_relative_eq!(response.expect("FRIC").traction[0], 0.095, max_relative = 1e-14);
}

#[test]
fn asks_for_a_cut_back_when_input_is_no_number() {
    for props in variants() {
        let parameters = read_parameters::<BondSlipParameters<'_>>(&BondSlip::INFO, &props).expect("consistent");
        for place in 0..3 {
            let mut displacement = [1e-3; 3];
            displacement[place] = f64::NAN;
            let contact = InterfaceIncrement {
                directions: 3,
                relative_displacement: displacement,
                increment: [0.0; 3],
                traction: [0.0; 3],
            };
            let response = advance_contact::<BondSlip>(&parameters, &contact, &mut State::default(), Request::Stress);
            assert!(matches!(response, Err(Failure::CutBack { .. })));
            let [pressure, slip_increment @ ..] = displacement;
            let sliding = TangentialIncrement { directions: 2, slip_increment, pressure };
            let response = advance_sliding::<BondSlip>(&parameters, &sliding, &mut State::default(), Request::Stress);
            assert!(matches!(response, Err(Failure::CutBack { .. })));
        }
    }
}
