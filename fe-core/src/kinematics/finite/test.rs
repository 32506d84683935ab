use super::*;
use approx::assert_abs_diff_eq;

const START: Gradient = [1.2, 0.3, -0.1, 0.9, 1.1];
const END: Gradient = [0.9, -0.4, 0.5, 1.3, 0.8];

fn turned(angle: f64, f: &Gradient) -> Gradient {
    let (sine, cosine) = angle.sin_cos();
    product(&[cosine, -sine, sine, cosine, 1.0], f)
}

fn assert_same(found: &[f64], expected: &[f64], epsilon: f64) {
    assert_eq!(found.len(), expected.len());
    for (found, expected) in found.iter().zip(expected) {
        assert_abs_diff_eq!(found, expected, epsilon = epsilon);
    }
}

#[test]
fn a_rigid_rotation_is_no_strain_and_its_own_angle() {
    for angle in [1e-9, 0.1, 1.0, 2.5, -3.0] {
        let increment = FiniteIncrement::new(&START, &turned(angle, &START)).unwrap();
        assert_same(&increment.strain_increment(), &[0.0; 4], 1e-13);
        let (cosine, sine) = increment.rotation();
        assert_same(&[cosine, sine], &[angle.cos(), angle.sin()], 1e-13);
    }
}

#[test]
fn stretches_along_fixed_axes_give_midpoint_logarithms() {
    let increment = FiniteIncrement::new(&IDENTITY, &[1.5, 0.0, 0.0, 0.8, 1.2]).unwrap();
    // 2 (λ − 1)/(λ + 1), third order close to ln λ.
    assert_same(&increment.strain_increment(), &[2.0 * 0.5 / 2.5, -2.0 * 0.2 / 1.8, 2.0 * 0.2 / 2.2, 0.0], 1e-15);
    assert_abs_diff_eq!(increment.volume_ratio, 1.5 * 0.8 * 1.2, epsilon = 1e-15);
    assert_eq!(increment.rotation(), (1.0, 0.0));
}

/// Increments in a frame that turns: Δε and stress turn along.
#[test]
fn increments_are_objective() {
    let increment = FiniteIncrement::new(&START, &END).unwrap();
    let elsewhere = FiniteIncrement::new(&turned(0.7, &START), &turned(0.7, &END)).unwrap();
    let rotation = (0.7_f64.cos(), 0.7_f64.sin());
    let expected = rotated(&increment.strain_increment(), rotation, 2.0);
    assert_same(&elsewhere.strain_increment(), &expected, 1e-14);
    assert_abs_diff_eq!(elsewhere.spin(), increment.spin(), epsilon = 1e-14);
}

#[test]
fn rotation_of_components_is_that_of_the_tensor() {
    let (cosine, sine) = (0.6, 0.8);
    // A uniaxial state along 1 turned by φ: cc, ss, cs.
    assert_same(&rotated(&[1.0, 0.0, 5.0, 0.0], (cosine, sine), 1.0), &[0.36, 0.64, 5.0, 0.48], 1e-15);
    assert_same(&rotated(&[1.0, 0.0, 5.0, 0.0], (cosine, sine), 2.0), &[0.36, 0.64, 5.0, 0.96], 1e-15);
    // Pure shear.
    let shear = 2.0 * cosine * sine;
    let expected = [-shear, shear, 0.0, cosine * cosine - sine * sine];
    assert_same(&rotated(&[0.0, 0.0, 0.0, 1.0], (cosine, sine), 1.0), &expected, 1e-15);
}

/// P : δF = J σ : (δF F⁻¹) for all δF.
#[test]
fn nominal_stress_is_conjugate_to_the_deformation_gradient() {
    let increment = FiniteIncrement::new(&START, &END).unwrap();
    let stress = [3.0, -1.0, 2.0, 0.7];
    let nominal = increment.nominal_stress(&stress);
    for k in 0..GRADIENT_COMPONENTS {
        let mut rate = [0.0; GRADIENT_COMPONENTS];
        rate[k] = 1.0;
        let strain = small_strain(product(&rate, &increment.end_inverse));
        let power: f64 = stress.iter().zip(strain).map(|(stress, strain)| stress * strain).sum();
        assert_abs_diff_eq!(nominal[k], increment.volume_ratio * power, epsilon = 1e-14);
    }
}

#[test]
fn volume_derivative_agrees_with_differences() {
    let increment = FiniteIncrement::new(&START, &END).unwrap();
    for k in 0..GRADIENT_COMPONENTS {
        let at = |shift: f64| {
            let mut end = END;
            end[k] += shift;
            FiniteIncrement::new(&START, &end).unwrap().volume_ratio
        };
        let difference = (at(1e-3) - at(-1e-3)) / 2e-3;
        assert_abs_diff_eq!(increment.volume_derivative()[k], difference, epsilon = 1e-12);
    }
}

#[test]
fn a_point_turned_inside_out_is_refused() {
    let ratio = |end: Gradient| FiniteIncrement::new(&IDENTITY, &end).unwrap_err().ratio;
    assert_eq!(ratio([-1.0, 0.0, 0.0, 1.0, 1.0]), 0.0, "flat half-way");
    assert!(ratio([-0.5, 0.0, 0.0, 1.0, 1.0]) < 0.0, "upright half-way, not at the end");
    assert!(ratio([-0.5, 0.0, 0.0, 1.0, -0.5]) < 0.0, "two negative factors");
    assert!(FiniteIncrement::new(&IDENTITY, &[f64::NAN, 0.0, 0.0, 1.0, 1.0]).is_err());
}

#[test]
fn deformation_gradients_are_passed_column_by_column() {
    assert_eq!(columns([1.0, 2.0, 3.0, 4.0, 5.0]), [[1.0, 3.0, 0.0], [2.0, 4.0, 0.0], [0.0, 0.0, 5.0]]);
}

/// Isotropic elasticity with the stress and the strain of the start, as a UMAT under NLGEOM computes it.
fn elastic(moduli: &Moduli, stress: &Components, increment: &FiniteIncrement) -> Components {
    let start = rotated(stress, increment.rotation(), 1.0);
    let strain = increment.strain_increment();
    std::array::from_fn(|row| start[row] + (0..4).map(|k| moduli[row][k] * strain[k]).sum::<f64>())
}

/// A hypoelastic step from a stressed state: rotation, strain and volume all change with F.
#[test]
fn nominal_tangent_is_the_derivative_of_the_incremental_map() {
    let (lame, shear) = (2.0, 1.3);
    let mut moduli = [[0.0; 4]; 4];
    for row in 0..3 {
        for column in 0..3 {
            moduli[row][column] = lame + if row == column { 2.0 * shear } else { 0.0 };
        }
    }
    moduli[3][3] = shear;
    let before = [0.9, -0.4, 0.2, 0.5];
    let nominal = |end: &Gradient| {
        let increment = FiniteIncrement::new(&START, end).unwrap();
        increment.nominal_stress(&elastic(&moduli, &before, &increment))
    };
    let increment = FiniteIncrement::new(&START, &END).unwrap();
    let tangent = nominal_tangent(&increment, &elastic(&moduli, &before, &increment), &moduli);
    let step = 1e-5;
    for l in 0..GRADIENT_COMPONENTS {
        let at = |shift: f64| {
            let mut end = END;
            end[l] += shift;
            nominal(&end)
        };
        let (plus, minus) = (at(step), at(-step));
        for k in 0..GRADIENT_COMPONENTS {
            assert_abs_diff_eq!(tangent[k][l], (plus[k] - minus[k]) / (2.0 * step), epsilon = 1e-8);
        }
    }
}
