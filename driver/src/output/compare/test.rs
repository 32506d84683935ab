use super::*;

fn history(x: &[f64], y: &[f64]) -> History {
    History::from_columns(vec![("e11".into(), x.to_vec()), ("s11".into(), y.to_vec())])
}

fn curve(points: &[(f64, f64)], scale: f64) -> Compare {
    Compare {
        file: "measured.csv".into(),
        points: points.to_vec(),
        file_x: "strain".into(),
        file_y: "stress".into(),
        x: 0,
        y: 1,
        scale_x: scale,
        scale_y: scale,
        label: "measured".into(),
    }
}

#[test]
fn linear_interpolation_between_rows() {
    // y = 10, 14 at x = 0.5, 1.5; the file says 11, 11: differences −1, 3
    let comparison = compare(&history(&[0.0, 1.0, 2.0], &[8.0, 12.0, 16.0]), &curve(&[(0.5, 11.0), (1.5, 11.0)], 1.0));
    assert_eq!(comparison.rms, Some(5f64.sqrt()));
    assert_eq!((comparison.points, comparison.outside), (2, 0));
    assert_eq!((comparison.x.as_str(), comparison.y.as_str()), ("e11", "s11"));
}

#[test]
fn decreasing_x_and_scale_minus_one() {
    let comparison = compare(&history(&[0.0, -1.0, -2.0], &[0.0, -10.0, -30.0]), &curve(&[(1.5, 21.0)], -1.0));
    assert_eq!(comparison.rms, Some(1.0));
}

#[test]
fn only_the_branch_before_the_first_reversal_counts() {
    // loading to 2, unloading to 1 along another line, reloading to 3
    let looped = history(&[0.0, 1.0, 2.0, 1.0, 2.0, 3.0], &[0.0, 10.0, 20.0, 5.0, 20.0, 25.0]);
    let comparison = compare(&looped, &curve(&[(1.0, 10.0), (1.5, 12.0), (2.5, 0.0), (-0.1, 0.0)], 1.0));
    assert_eq!(comparison.rms, Some((9f64 / 2.0).sqrt()));
    assert_eq!((comparison.points, comparison.outside), (2, 2));
}

#[test]
fn iteration_noise_and_standing_still_end_no_branch() {
    let noisy = history(&[0.0, -1e-15, 0.0, 1.0, 1.0 - 1e-13, 2.0], &[0.0, 0.0, 0.0, 10.0, 9.0, 19.0]);
    // relaxed from 10 to 9 at x = 1, then along the line from 9
    let comparison = compare(&noisy, &curve(&[(0.5, 5.0), (1.0, 10.0), (1.5, 14.0)], 1.0));
    assert!(comparison.rms.unwrap() < 1e-12, "{comparison:?}");
    assert_eq!(comparison.points, 3);
}

#[test]
fn ends_belong_to_the_branch_although_scaling_rounds() {
    let comparison = compare(&history(&[0.0, 0.3], &[0.0, 3.0]), &curve(&[(0.0, 0.0), (3.0, 30.0)], 0.1));
    // 3 · 0.1 is a little more than 0.3
    assert_eq!(comparison.points, 2);
    assert!(comparison.rms.unwrap() < 1e-12);
}

#[test]
fn nothing_to_compare_is_no_number() {
    for (x, y) in [(&[][..], &[][..]), (&[f64::NAN], &[1.0]), (&[0.0], &[f64::NAN]), (&[0.0, 0.1], &[0.0, 1.0])] {
        let comparison = compare(&history(x, y), &curve(&[(0.5, 1.0), (f64::NAN, 1.0)], 1.0));
        assert_eq!((comparison.rms, comparison.points, comparison.outside), (None, 0, 2));
    }
}
