use super::*;
use crate::battery::{
    PATH_COUNTS, STRESS_STATES, Sample, check_invariants, check_path_exactness, check_random_paths, check_rotation,
    check_tangents, check_virgin,
};

const PROPS: [f64; 2] = [31800.0, 0.18];

#[test]
fn passes_the_battery() {
    let sample = Sample::new(&PROPS, 1e-3);
    for stress_state in STRESS_STATES {
        check_rotation::<LinearElastic>(&sample, stress_state, 200);
        check_invariants::<LinearElastic>(&sample, stress_state, 50, &[], true);
        check_virgin::<LinearElastic>(&sample, stress_state, 1.0, &[]);
        let strain = [1e-3, -2e-4, 0.0, 3e-4, 0.0, 0.0];
        check_path_exactness::<LinearElastic>(&sample, stress_state, &strain, &PATH_COUNTS);
        check_random_paths::<LinearElastic>(&sample, stress_state, 20, 2);
    }
}

#[test]
fn tangent_is_the_derivative_of_the_stress() {
    check_tangents::<LinearElastic>("", &[Sample::new(&PROPS, 1e-3)]);
}

#[test]
fn uniaxial_strain_gives_the_constrained_modulus() {
    let mut point = crate::battery::Point::<LinearElastic>::virgin(&PROPS, StressState::ThreeD);
    let stress = point.advance(&[1e-3, 0.0, 0.0, 0.0, 0.0, 0.0]).stress;
    let constrained = 31800.0 * (1.0 - 0.18) / ((1.0 + 0.18) * (1.0 - 0.36));
    approx::assert_relative_eq!(stress[0], constrained * 1e-3, max_relative = 1e-15);
}
