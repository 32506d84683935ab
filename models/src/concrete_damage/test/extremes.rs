//! Extreme inputs: repeated principal strains, full damage, unusual parameters, numbers that are not finite.

use super::*;
use umat_abi::law::{advance_values, parameters_of};

/// Two or three principal strains equal, or apart by ever less: stress continuous, tangent right.
#[test]
fn repeated_principal_strains_are_ordinary() {
    let bases = [
        [1e-4, 1e-4, -2e-4],
        [2e-4, -1e-4, -1e-4],
        [1e-4, 1e-4, 1e-4],
        [-1e-3, -1e-3, 5e-4],
        [-1e-3, -1e-3, -1e-3],
        [1e-3, 0.0, 0.0],
        [0.0, 0.0, -2e-3],
    ];
    for (props, length) in variants() {
        for base in bases {
            let mut reference: Option<[f64; 6]> = None;
            for split in [0.0, 1e-18, 1e-16, 1e-13, 1e-10] {
                let mut point = Point::<ConcreteDamage>::virgin(&props, StressState::ThreeD);
                point.characteristic_length = length;
                point.advance(&[3e-4, -1e-3, 0.0, 0.0, 0.0, 0.0]);
                let strain = [base[0] + split, base[1], base[2] - split, split, 0.3 * split, -split];
                let (response, _) = point.trial(&strain);
                assert!(response.tangent.iter().flatten().all(|x| x.is_finite()));
                let expected = *reference.get_or_insert(response.stress);
                for i in 0..6 {
                    assert!((response.stress[i] - expected[i]).abs() <= 1e-5, "{base:?} {split:e}");
                }
            }
        }
    }
}

/// Unloaded from damage, so that nothing grows, the tangent at repeated strains is the difference quotient.
#[test]
fn tangent_is_right_at_repeated_strains() {
    let props = defaults();
    for base in [[5e-5, 5e-5, -2e-4], [8e-5, -1e-4, -1e-4], [-2e-4, -2e-4, -2e-4], [-3e-4, -3e-4, 5e-5]] {
        let mut point = Point::<ConcreteDamage>::virgin(&props, StressState::ThreeD);
        point.advance(&[3e-4, -1.2e-3, 0.0, 0.0, 0.0, 0.0]);
        let strain = [base[0], base[1], base[2], 0.0, 0.0, 0.0];
        assert!(battery::tangent_error(&point, &strain) < 1e-8, "{base:?}");
    }
}

/// Cracks in the plane whose 1 − D_t is 3e-12 to 1e-102: σ33 = 0 where the third direction opens too, and the row that is
/// condensed is of that order as a whole. First a state that `pullout-bench stability` found.
#[test]
fn tangent_is_right_in_plane_stress_however_far_a_crack_opens() {
    let plastic = variants()[1].0;
    let mut point = Point::<ConcreteDamage>::virgin(&plastic, StressState::PlaneStress);
    point.strain = [0.4737325320116396, 0.38829897142842096, 0.0, -0.18277335674371506, 0.0, 0.0];
    point.state[0] = 2466841926.139529;
    point.state[2] = 3355.4758187819184;
    point.state[5..9].copy_from_slice(&[0.14209605335580308, 0.1164702603967923, 0.0, -0.0548228607863718]);
    point.state[11] = -5.830709788942858e-11;
    let strain = [-0.6047770494304883, -3.7242527461778048, 0.0, -7.91097488712112, 0.0, 0.0];
    let error = battery::tangent_error(&point, &strain);
    assert!(error < 1e-8, "{error:e}");
    for b_c in [0.0, 0.2] {
        let props = with(plastic, &[("b_c", b_c), ("B_t", 6.0)]);
        for size in [1e-2, 1.0, 1e2, 1e4] {
            let point = Point::<ConcreteDamage>::virgin(&props, StressState::PlaneStress);
            let strain = [-0.6, -3.7, 0.0, -7.9, 0.0, 0.0].map(|e| size * e);
            let eta_t = point.trial(&strain).1[0];
            assert!(eta_t > 1e28, "{eta_t:e}");
            let error = battery::tangent_error(&point, &strain);
            assert!(error < 1e-6, "b_c = {b_c}, {size:e}: {error:e}");
        }
    }
}

/// A thousand times the peak strain, and from nothing to there in one step.
#[test]
fn full_damage_leaves_the_right_sign_and_no_overflow() {
    for (props, length) in variants() {
        for sign in [1.0, -1.0] {
            for size in [0.1, 1.0, 10.0, 1e6, 1e30] {
                let mut point = Point::<ConcreteDamage>::virgin(&props, StressState::ThreeD);
                point.characteristic_length = length;
                let response = point.advance(&[sign * size, 0.0, 0.0, 0.0, 0.0, 0.0]);
                assert!(response.stress.iter().chain(response.tangent.iter().flatten()).all(|x| x.is_finite()));
                assert!(sign * response.stress[0] >= 0.0 && response.dissipated_energy > 0.0);
                let damage = crate::damage_law::damage(point.state[if sign > 0.0 { 0 } else { 1 }]);
                assert!((0.9..=1.0).contains(&damage));
            }
        }
    }
}

#[test]
fn bad_numbers_are_sent_back() {
    let parameters = parameters_of::<ConcreteDamage>(&defaults()).expect("defaults");
    for stress_state in STRESS_STATES {
        for bad in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY, 1e300] {
            for component in stress_state.components() {
                let mut strain = [1e-4, -1e-5, 0.0, 1e-5, 0.0, 0.0];
                strain[*component] = bad;
                let increment = Increment {
                    stress_state,
                    strain,
                    strain_increment: strain,
                    stress: [0.0; 6],
                    characteristic_length: None,
                    time_increment: 1.0,
                    temperature: 0.0,
                };
                let outcome =
                    advance_values::<ConcreteDamage>(&parameters, &increment, &mut [0.0; 13], Request::Stress);
                assert!(matches!(outcome, Err(Failure::CutBack { .. })), "{bad} {stress_state:?}: {outcome:?}");
            }
        }
    }
}

#[test]
fn a_modulus_too_great_for_its_stiffness_is_sent_back() {
    let mut props = defaults();
    props[0] = f64::MAX;
    let parameters = parameters_of::<ConcreteDamage>(&props).expect("within its bounds");
    for stress_state in STRESS_STATES {
        let increment = Increment::at_rest(stress_state);
        let outcome =
            advance_values::<ConcreteDamage>(&parameters, &increment, &mut [0.0; 13], Request::StressAndTangent);
        match outcome {
            Ok(response) => assert!(response.tangent.as_flattened().iter().all(|x| x.is_finite()), "{stress_state:?}"),
            Err(failure) => assert!(matches!(failure, Failure::CutBack { .. }), "{failure:?}"),
        }
    }
}
