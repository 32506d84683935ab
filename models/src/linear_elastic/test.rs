use super::*;
use crate::battery::{STRESS_STATES, check_invariants, check_path_exactness, check_rotation, check_tangent};

const PROPS: [f64; 2] = [31800.0, 0.18];

#[test]
fn passes_the_battery() {
    for stress_state in STRESS_STATES {
        assert_eq!(check_tangent::<LinearElastic>(&PROPS, stress_state, 1e-3, 200).1, 0);
        check_rotation::<LinearElastic>(&PROPS, stress_state, 1e-3, 200);
        check_invariants::<LinearElastic>(&PROPS, stress_state, 1e-3, 50, &[], true);
        check_path_exactness::<LinearElastic>(
            &PROPS,
            stress_state,
            &[1e-3, -2e-4, 0.0, 3e-4, 0.0, 0.0],
            &[1, 10, 1000],
        );
    }
}

#[test]
fn uniaxial_strain_gives_the_constrained_modulus() {
    let mut point = crate::battery::Point::<LinearElastic>::virgin(&PROPS, StressState::ThreeD);
    let stress = point.advance(&[1e-3, 0.0, 0.0, 0.0, 0.0, 0.0]).stress;
    let constrained = 31800.0 * (1.0 - 0.18) / ((1.0 + 0.18) * (1.0 - 0.36));
    approx::assert_relative_eq!(stress[0], constrained * 1e-3, max_relative = 1e-15);
}
