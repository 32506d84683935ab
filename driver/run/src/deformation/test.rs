use super::*;

fn random_strain(random: &mut fastrand::Rng, size: f64) -> [f64; 6] {
    std::array::from_fn(|_| size * (2.0 * random.f64() - 1.0))
}

/// A rotation of any angle about any axis (Rodrigues).
fn random_rotation(random: &mut fastrand::Rng) -> Matrix3<f64> {
    let axis = nalgebra::Vector3::from_fn(|_, _| 2.0 * random.f64() - 1.0);
    *nalgebra::Rotation3::from_axis_angle(&nalgebra::Unit::new_normalize(axis), 7.0 * random.f64()).matrix()
}

fn largest(matrix: &Matrix3<f64>) -> f64 {
    matrix.iter().fold(0.0, |worst, entry| worst.max(entry.abs()))
}

/// exp by squaring a Taylor series: another road to it.
fn series(strain: &Matrix3<f64>) -> Matrix3<f64> {
    let small = strain / 8.0;
    let (mut sum, mut term) = (Matrix3::identity(), Matrix3::identity());
    for k in 1..40 {
        term = term * small / f64::from(k);
        sum += term;
    }
    (0..3).fold(sum, |power, _| power * power)
}

#[test]
fn exponential_is_the_series_and_exactly_symmetric() {
    let mut random = fastrand::Rng::with_seed(1);
    for size in [1e-9, 1e-3, 0.3, 2.0] {
        for _ in 0..50 {
            let strain = random_strain(&mut random, size);
            let stretch = exponential(&strain);
            assert_eq!(stretch, stretch.transpose());
            let expected = series(&symmetric(&strain, 2.0));
            assert!(largest(&(stretch - expected)) < 2e-14 * largest(&expected), "{strain:?}");
        }
    }
    // equal principal values, and none
    assert_eq!(exponential(&[0.0; 6]), Matrix3::identity());
    let uniform = exponential(&[0.5, 0.5, 0.5, 0.0, 0.0, 0.0]);
    assert!(largest(&(uniform - Matrix3::identity() * 0.5_f64.exp())) < 1e-15);
}

#[test]
fn derivative_of_the_exponential_is_that_of_differences() {
    let mut random = fastrand::Rng::with_seed(3);
    let distinct = random_strain(&mut random, 0.8);
    for strain in [distinct, [0.4, 0.4, -0.3, 0.0, 0.0, 0.0], [0.0; 6], [0.2, 0.2 + 1e-13, 0.1, 0.0, 0.3, 0.0]] {
        let derivative = exponential_derivative(&strain);
        for j in 0..6 {
            let at = |step: f64| {
                let mut shifted = strain;
                shifted[j] += step;
                components(&exponential(&shifted), 1.0)
            };
            let (above, below) = (at(1e-5), at(-1e-5));
            for i in 0..6 {
                assert!((derivative[i][j] - (above[i] - below[i]) / 2e-5).abs() < 1e-9, "{strain:?} {i} {j}");
            }
        }
    }
}

#[test]
fn logarithm_undoes_the_exponential_and_does_not_see_a_rotation() {
    let mut random = fastrand::Rng::with_seed(2);
    for size in [1e-9, 1e-3, 0.3, 1.5] {
        for _ in 0..50 {
            let strain = random_strain(&mut random, size);
            let stretch = exponential(&strain);
            let rotation = random_rotation(&mut random);
            for (gradient, expected) in [(stretch, Matrix3::identity()), (rotation * stretch, rotation)] {
                let polar = Polar::new(&gradient);
                assert!(largest(&(polar.rotation - expected)) < 1e-13);
                let found = polar.logarithmic_strain();
                for i in 0..6 {
                    // compressed to 1/10 and less, Green's strain has lost digits of U
                    assert!((found[i] - strain[i]).abs() < 1e-15 + 3e-14 * size.exp().powi(2), "{found:?} {strain:?}");
                }
                let elongation = components(&(stretch - Matrix3::identity()), 2.0);
                for (found, expected) in polar.nominal_strain().iter().zip(elongation) {
                    assert!((found - expected).abs() < 1e-14 * size.exp().powi(2));
                }
            }
        }
    }
}

/// Half a turn is symmetric, too.
#[test]
fn half_a_turn_is_a_rotation() {
    let turn = Matrix3::from_diagonal(&nalgebra::Vector3::new(-1.2, -0.9, 1.0));
    let polar = Polar::new(&turn);
    assert!(largest(&(polar.rotation - Matrix3::from_diagonal(&nalgebra::Vector3::new(-1.0, -1.0, 1.0)))) < 1e-15);
    let strain = polar.logarithmic_strain();
    assert!((strain[0] - 1.2_f64.ln()).abs() < 1e-15 && (strain[1] - 0.9_f64.ln()).abs() < 1e-15);
}

/// The midpoint rule: sym(ΔF F_m⁻¹) of a stretch is 2 tanh(Δε/2) = Δε − Δε³/12 …
#[test]
fn midpoint_increment_of_a_stretch() {
    let start = exponential(&[0.1, -0.2, 0.3, 0.0, 0.0, 0.0]);
    let end = exponential(&[0.3, -0.1, 0.2, 0.0, 0.0, 0.0]);
    let motion = incremental_motion(&start, &end).expect("positive volumes");
    assert_eq!(motion.rotation, Matrix3::identity());
    for (found, change) in motion.strain_increment.iter().zip([0.2_f64, 0.1, -0.1, 0.0, 0.0, 0.0]) {
        assert!((found - 2.0 * (0.5 * change).tanh()).abs() < 1e-15);
    }
}
