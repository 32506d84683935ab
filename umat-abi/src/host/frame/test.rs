use super::*;

fn near(a: &[f64], b: &[f64]) -> bool {
    a.len() == b.len() && a.iter().zip(b).all(|(a, b)| (a - b).abs() <= 1e-14 * b.abs().max(1.0))
}

/// Rotation by 0.7 about (1, 2, 2)/3 (Rodrigues).
fn axes() -> Matrix {
    let n = [1.0 / 3.0, 2.0 / 3.0, 2.0 / 3.0];
    let (sine, cosine) = 0.7_f64.sin_cos();
    let cross = [[0.0, -n[2], n[1]], [n[2], 0.0, -n[0]], [-n[1], n[0], 0.0]];
    std::array::from_fn(|i| {
        std::array::from_fn(|j| f64::from(i == j) * cosine + sine * cross[i][j] + (1.0 - cosine) * n[i] * n[j])
    })
}

#[test]
fn components_turn_as_tensors_do() {
    let axes = axes();
    let tensor = [[1.0, 0.4, -0.3], [0.4, -2.0, 0.7], [-0.3, 0.7, 0.5]];
    let there = product(&product(&axes, &tensor), &transpose(&axes));
    let of = |tensor: &Matrix, shear: f64| AXES.map(|[i, j]| tensor[i][j] * if i == j { 1.0 } else { shear });
    assert!(near(&turned(&stress_turn(&axes), &of(&tensor, 1.0)), &of(&there, 1.0)));
    assert!(near(&turned(&strain_turn(&axes), &of(&tensor, 2.0)), &of(&there, 2.0)));
    // the transpose of the strain's turn is the way back of the stress
    assert!(near(&turned_back(&strain_turn(&axes), &of(&there, 1.0)), &of(&tensor, 1.0)));
}

#[test]
fn the_rotation_of_a_gradient_is_that_of_its_polar_decomposition() {
    let rotation = axes();
    let stretch = [[30.0, 0.4, 0.0], [0.4, 1.0, 0.2], [0.0, 0.2, 0.01 + 0.2 * 0.2]];
    let found = rotation_of(&product(&rotation, &stretch));
    assert!(near(found.as_flattened(), rotation.as_flattened()), "{found:?}");
}

#[test]
fn values_go_linearly_from_place_to_place() {
    let course = Course::new(vec![1.0, 3.0], vec![[0.0; 3], [2.0, 4.0, 6.0]]).expect("a course");
    assert_eq!([0.0, 1.0, 2.0, 3.0, 9.0].map(|place| course.at(place)[1]), [0.0, 0.0, 2.0, 4.0, 4.0]);
    let slopes = [0.0, 1.0, 2.0, 3.0, 9.0].map(|place| course.with_slope(place)[1][1]);
    assert_eq!(slopes, [0.0, 2.0, 2.0, 0.0, 0.0]);
    assert_eq!(Course::new(vec![1.0, 1.0], vec![[0.0; 3]; 2]), None);
    assert_eq!(Course::new(vec![], vec![]), None);
}
