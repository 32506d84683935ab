use super::*;

#[test]
fn work_is_that_of_a_triangle_and_ends_between_lines() {
    // y = 2x to x = 3
    let curve = [(0.0, 0.0), (1.0, 2.0), (3.0, 6.0)];
    for (end, expected) in [(1.0, 1.0), (2.0, 4.0), (3.0, 9.0), (3.0 * (1.0 + 1e-12), 9.0)] {
        let found = work(&curve, end).expect("reached");
        assert!((found - expected).abs() < 1e-10, "{end}: {found}");
    }
    assert_eq!(work(&curve, 3.1), None);
    assert_eq!(work(&[], 1.0), None);
}

#[test]
fn work_counts_what_a_snap_back_gives_back_and_signs() {
    let back = [(0.0, 0.0), (1.0, 1.0), (0.5, 0.5), (2.0, 0.5)];
    let expected = 0.5 - 0.5 * 0.75 + 1.5 * 0.5;
    assert!((work(&back, 2.0).expect("reached") - expected).abs() < 1e-14);
    let compression = [(0.0, 0.0), (-1.0, -2.0), (-2.0, -2.0)];
    assert!((work(&compression, 1.5).expect("reached") - 2.0).abs() < 1e-14);
}
