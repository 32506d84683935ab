//! What is thrown at the law: repeated strains, full damage, strange parameters, bad numbers.

use super::*;

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
    let parameters = ConcreteDamage::parameters(&defaults()).expect("defaults");
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
                };
                let outcome = ConcreteDamage::update(&parameters, &increment, &mut [0.0; 13], Request::Stress);
                assert!(matches!(outcome, Err(Failure::CutBack { .. })), "{bad} {stress_state:?}: {outcome:?}");
            }
        }
    }
}
