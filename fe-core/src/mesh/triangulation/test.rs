use super::*;

fn area(points: &[[f64; 2]], corners: &[usize]) -> f64 {
    let twice = (0..corners.len()).map(|k| {
        let ([a_x, a_y], [b_x, b_y]) = (points[corners[k]], points[corners[(k + 1) % corners.len()]]);
        a_x * b_y - b_x * a_y
    });
    0.5 * twice.sum::<f64>()
}

fn least_angle(points: &[[f64; 2]], corners: [usize; 3]) -> f64 {
    let angle = |k: usize| {
        let [a, b, c] = [0, 1, 2].map(|step| points[corners[(k + step) % 3]]);
        let ([p_x, p_y], [q_x, q_y]) = ([b[0] - a[0], b[1] - a[1]], [c[0] - a[0], c[1] - a[1]]);
        (p_x * q_y - p_y * q_x).atan2(p_x * q_x + p_y * q_y).to_degrees()
    };
    (0..3).map(angle).fold(f64::INFINITY, f64::min)
}

#[test]
fn a_graded_outline_is_filled_with_good_triangles_and_keeps_its_points() {
    // an L, its inner corner finely divided
    let corners: [[f64; 2]; 6] = [[0.0, 0.0], [10.0, 0.0], [10.0, 4.0], [4.0, 4.0], [4.0, 9.0], [0.0, 9.0]];
    let mut outline = Vec::new();
    for k in 0..6 {
        let (a, b) = (corners[k], corners[(k + 1) % 6]);
        let n = if k == 2 || k == 3 { 12 } else { 8 };
        outline.extend((0..n).map(|i| {
            let t = f64::from(i) / f64::from(n);
            [a[0] + t * (b[0] - a[0]), a[1] + t * (b[1] - a[1])]
        }));
    }
    let made = triangulate(&outline, 2.0).unwrap();
    assert_eq!(made.points[..outline.len()], outline[..]);
    let whole: f64 = made.triangles.iter().map(|corners| area(&made.points, corners)).sum();
    assert!((whole - 60.0).abs() < 1e-12, "{whole}");
    for &triangle in &made.triangles {
        assert!(area(&made.points, &triangle) > 0.0 && area(&made.points, &triangle) <= 2.0);
        assert!(least_angle(&made.points, triangle) > 20.0, "{triangle:?}");
    }
    // every edge of the outline is an edge of one triangle
    for k in 0..outline.len() {
        let next = (k + 1) % outline.len();
        let has = |t: &&[usize; 3]| (0..3).any(|i| t[i] == k && t[(i + 1) % 3] == next);
        assert_eq!(made.triangles.iter().filter(has).count(), 1, "{k}");
    }
    assert_eq!(made, triangulate(&outline, 2.0).unwrap(), "the same every time");
}

#[test]
fn outlines_that_meet_themselves_are_reported() {
    let message = |outline: &[[f64; 2]]| triangulate(outline, 1.0).unwrap_err().to_string();
    let crossing = [[0.0, 0.0], [1.0, 1.0], [1.0, 0.0], [0.0, 1.0]];
    assert_eq!(message(&crossing), "the outline meets itself near (1, 0)");
    let touching = [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 0.0], [-1.0, 1.0]];
    assert_eq!(message(&touching), "the outline meets itself near (0, 0)");
    let lost = [[0.0, 0.0], [f64::NAN, 0.0], [1.0, 1.0]];
    assert_eq!(message(&lost), "point 2 of the outline is (NaN, 0)");
}
