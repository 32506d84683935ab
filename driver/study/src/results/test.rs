use super::*;

#[test]
fn work_is_that_of_a_triangle_and_ends_between_lines() {
    // y = 2x to x = 3
    let curve = [(0.0, 0.0), (1.0, 2.0), (3.0, 6.0)];
    for (end, expected) in [(1.0, 1.0), (2.0, 4.0), (3.0, 9.0), (3.0 * (1.0 + 1e-12), 9.0)] {
        let found = work(&curve, Some(end)).expect("reached");
        assert!((found - expected).abs() < 1e-10, "{end}: {found}");
    }
    assert_eq!(work(&curve, Some(3.1)), None);
    assert_eq!(work(&[], Some(1.0)), None);
}

#[test]
fn work_counts_what_a_snap_back_gives_back_and_signs() {
    let back = [(0.0, 0.0), (1.0, 1.0), (0.5, 0.5), (2.0, 0.5)];
    let expected = 0.5 - 0.5 * 0.75 + 1.5 * 0.5;
    assert!((work(&back, Some(2.0)).expect("reached") - expected).abs() < 1e-14);
    let compression = [(0.0, 0.0), (-1.0, -2.0), (-2.0, -2.0)];
    assert!((work(&compression, Some(-1.5)).expect("reached") - 2.0).abs() < 1e-14);
    // a strain of the other sign is another one
    assert_eq!(work(&compression, Some(1.5)), None);
}

/// A cycle of a rigid body in dry friction dissipates 4 τ times its amplitude.
#[test]
fn work_of_a_cycle_is_that_of_the_whole_path() {
    let cycle = [(0.0, 2.0), (1.0, 2.0), (1.0, -2.0), (-1.0, -2.0), (-1.0, 2.0), (0.0, 2.0)];
    assert_eq!(work(&cycle, None), Some(8.0));
    assert_eq!(work(&cycle, Some(0.5)), Some(1.0));
    // to 1, and back through 0
    assert_eq!(work(&cycle, Some(-0.5)), Some(5.0));
    assert_eq!(work(&cycle, Some(-1.5)), None);
}

#[test]
fn works_are_compared_at_one_x_or_over_whole_paths() {
    let line = |ends: &[f64]| ends.iter().map(|x| (*x, 1.0)).collect::<Vec<_>>();
    let common = |curves: &[&[f64]]| common_end(&curves.iter().map(|ends| line(ends)).collect::<Vec<_>>());
    assert_eq!(common(&[&[0.0, 2.0], &[0.0, 3.0]]), Some(2.0));
    assert_eq!(common(&[&[0.0, -2.0], &[0.0, -3.0]]), Some(-2.0));
    // all the same end, another side, a path that turns back
    assert_eq!(common(&[&[0.0, 2.0], &[0.0, 2.0 + 1e-12]]), None);
    assert_eq!(common(&[&[0.0, 2.0], &[0.0, -3.0]]), None);
    assert_eq!(common(&[&[0.0, 2.0, 1.0], &[0.0, 3.0]]), None);
    assert_eq!(common(&[&[0.0, 2.0, -2.0, 2.0], &[0.0, 3.0]]), None);
    assert_eq!(common(&[]), None);
}

#[test]
fn a_line_is_found_where_x_passes_a_value_with_its_sign() {
    let history = History::from_columns(vec![
        ("e".into(), vec![0.0, 1.0, -1.0, 2.0]),
        ("s".into(), vec![0.0, 10.0, -10.0, 20.0]),
    ]);
    let curve = Columns { x: "e".into(), y: "s".into() };
    let result = RunResult::of(history, None, &curve);
    let line = |x: f64| result.line("s", Where::X(x), &curve);
    assert_eq!([line(0.5), line(-0.5), line(1.5), line(-1.5), line(0.0)], [Some(1), Some(2), Some(3), None, Some(0)]);
    assert_eq!(result.reach, Some(2.0));
}
