use super::*;
use approx::assert_relative_eq;

/// A handful of rotations, each good to one or two units in the last place.
const ROUNDING: f64 = 2e-15;

const STRAINS: [[f64; 6]; 6] = [
    [1e-3, -2e-3, 0.5e-3, 0.7e-3, -1.1e-3, 0.3e-3],
    [1.0, 1.0, 1.0, 0.0, 0.0, 0.0],
    [1.0, 1.0, 0.0, 1e-16, 0.0, 1e-9],
    [0.0; 6],
    [0.0, 0.0, 0.0, 1e-200, 0.0, 0.0],
    [2e-4, 2e-4, -3e-4, 1e-12, 1e-8, 0.0],
];

#[test]
fn principal_directions_are_orthonormal_and_rebuild_the_tensor() {
    for strain in STRAINS {
        let spectral = Spectral::of_strain(&strain);
        let scale = strain.iter().fold(0.0_f64, |m, x| m.max(x.abs()));
        for (rebuilt, given) in spectral.strain(&spectral.values).iter().zip(strain) {
            assert!((rebuilt - given).abs() <= ROUNDING * scale, "{rebuilt} {given}");
        }
        for i in 0..3 {
            for j in 0..3 {
                let dot: f64 = (0..3).map(|k| spectral.directions[i][k] * spectral.directions[j][k]).sum();
                assert_relative_eq!(dot, f64::from(u8::from(i == j)), epsilon = ROUNDING);
            }
        }
        assert!(spectral.values[0] >= spectral.values[1] && spectral.values[1] >= spectral.values[2]);
    }
}

#[test]
fn tangent_of_the_linear_function_is_the_elastic_stiffness() {
    let elasticity = Elasticity::new(31800.0, 0.18);
    let mut principal = [[elasticity.lambda; 3]; 3];
    for i in 0..3 {
        principal[i][i] += 2.0 * elasticity.shear_modulus;
    }
    for strain in STRAINS {
        let tangent = Spectral::of_strain(&strain).tangent(&principal, &[2.0 * elasticity.shear_modulus; 3]);
        for (row, expected) in tangent.iter().zip(elasticity.stiffness()) {
            for (value, expected) in row.iter().zip(expected) {
                assert_relative_eq!(*value, expected, epsilon = 1e-15 * 31800.0 * 8.0);
            }
        }
    }
}

#[test]
fn plane_stress_stiffness_is_the_condensed_one() {
    let elasticity = Elasticity::new(31800.0, 0.18);
    let condensed = condense_plane_stress(&elasticity.stiffness());
    for (row, expected) in condensed.iter().zip(elasticity.plane_stress_stiffness()) {
        for (value, expected) in row.iter().zip(expected) {
            assert_relative_eq!(*value, expected, max_relative = 1e-14);
        }
    }
    let mut strain = [1e-4, -3e-5, 0.0, 2e-5, 0.0, 0.0];
    strain[2] = elasticity.plane_stress_strain_33(&strain);
    assert!(elasticity.stress(&strain)[2].abs() < 1e-15 * 31800.0 * 1e-4);
}

#[test]
fn isotropic_split_is_the_elastic_law_of_space_and_plane() {
    use umat_abi::law::StressState;
    let elasticity = Elasticity::new(31800.0, 0.18);
    let twice_shear = 2.0 * elasticity.shear_modulus;
    let plane = [1e-4, -3e-5, 0.0, 2e-5, 0.0, 0.0];
    for (stress_state, strain, expected_stiffness) in [
        (StressState::ThreeD, STRAINS[0], elasticity.stiffness()),
        (StressState::PlaneStress, plane, elasticity.plane_stress_stiffness()),
    ] {
        let split = IsotropicSplit::new(stress_state, &strain);
        let bulk = elasticity.bulk_modulus_in(split.dimension());
        let stress = split.stress(twice_shear, bulk * split.trace);
        let stiffness = isotropic_stiffness(stress_state, twice_shear, bulk);
        for i in 0..6 {
            let expected: f64 = (0..6).map(|j| expected_stiffness[i][j] * strain[j]).sum();
            assert_relative_eq!(stress[i], expected, epsilon = 1e-14, max_relative = 1e-14);
            for j in 0..6 {
                assert_relative_eq!(stiffness[i][j], expected_stiffness[i][j], epsilon = 1e-11);
            }
        }
        let energy = 0.5 * (twice_shear * split.deviator_norm_squared() + bulk * split.trace * split.trace);
        assert_relative_eq!(energy, 0.5 * work(&stress, &strain), max_relative = 1e-14);
    }
}
