use super::*;
use crate::history::History;

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
    let comparison =
        compare(&history(&[0.0, 1.0, 2.0], &[8.0, 12.0, 16.0]), &curve(&[(0.5, 11.0), (1.5, 11.0)], 1.0)).unwrap();
    assert_eq!(comparison.rms, Some(5f64.sqrt()));
    assert_eq!((comparison.points, comparison.outside), (2, 0));
    assert_eq!((comparison.x.as_str(), comparison.y.as_str()), ("e11", "s11"));
}

#[test]
fn decreasing_x_and_scale_minus_one() {
    let comparison = compare(&history(&[0.0, -1.0, -2.0], &[0.0, -10.0, -30.0]), &curve(&[(1.5, 21.0)], -1.0)).unwrap();
    assert_eq!(comparison.rms, Some(1.0));
}

#[test]
fn only_the_branch_before_the_first_reversal_counts() {
    // loading to 2, unloading to 1 along another line, reloading to 3
    let looped = history(&[0.0, 1.0, 2.0, 1.0, 2.0, 3.0], &[0.0, 10.0, 20.0, 5.0, 20.0, 25.0]);
    let comparison = compare(&looped, &curve(&[(1.0, 10.0), (1.5, 12.0), (2.5, 0.0), (-0.1, 0.0)], 1.0)).unwrap();
    assert_eq!(comparison.rms, Some((9f64 / 2.0).sqrt()));
    assert_eq!((comparison.points, comparison.outside), (2, 2));
}

/// Loading, unloading along another line, and reloading: each point of the file belongs to the branch that it stands on.
#[test]
fn a_cycle_is_compared_branch_by_branch() {
    let x = [0.0, 1.0, 2.0, 1.5, 1.0, 2.0, 3.0];
    let y = [0.0, 10.0, 20.0, 12.5, 5.0, 20.0, 25.0];
    let looped = history(&x, &y);
    let own: Vec<(f64, f64)> = x.iter().copied().zip(y).collect();
    let comparison = compare(&looped, &curve(&own, 1.0)).unwrap();
    assert_eq!((comparison.rms, comparison.points, comparison.outside), (Some(0.0), 7, 0));
    assert_eq!(comparison.warning, None);
    // scatter of the measured x is no turn, which is said
    let scattered = [(0.0, 0.0), (1.0, 10.0), (0.99, 9.9), (2.0, 20.0), (1.25, 8.75)];
    let comparison = compare(&looped, &curve(&scattered, 1.0)).unwrap();
    assert!(comparison.rms.unwrap() < 1e-12 && comparison.points == 5, "{comparison:?}");
    let warning = comparison.warning.unwrap();
    assert!(warning.contains("strain of the data goes back by more than 0.2 %"), "{warning}");
}

/// Loops of half a percent of the reach and more, which run and file have.
#[test]
fn small_loops_are_compared_branch_by_branch() {
    for back in [0.01, 0.03, 0.09] {
        let x = [0.0, 1.0, 1.0 - 0.5 * back, 1.0 - back, 1.0, 2.0];
        let y = [0.0, 10.0, 5.0, 1.0, 10.0, 20.0];
        let own: Vec<(f64, f64)> = x.iter().copied().zip(y).collect();
        let comparison = compare(&history(&x, &y), &curve(&own, 1.0)).unwrap();
        assert_eq!((comparison.rms, comparison.points, comparison.warning), (Some(0.0), 6, None), "{back}");
        // which a run that goes on does not have
        let comparison = compare(&history(&[0.0, 2.0], &[0.0, 20.0]), &curve(&own, 1.0)).unwrap();
        assert!(comparison.warning.unwrap().contains("counts as scatter"), "{back}");
    }
    // the file goes back less far than the run
    let deep = history(&[0.0, 1.0, 0.5, 1.0, 2.0], &[0.0, 10.0, 0.0, 10.0, 20.0]);
    let comparison = compare(&deep, &curve(&[(0.5, 5.0), (1.0, 10.0), (0.95, 9.0), (1.5, 15.0)], 1.0)).unwrap();
    assert_eq!((comparison.points, comparison.warning), (4, None));
    assert!(comparison.rms.unwrap() < 1e-12);
    // a snap-back of the run is no loop of the file's
    let snap = history(&[0.0, 1.0, 0.99, 0.98, 1.0, 2.0], &[0.0, 10.0, 9.0, 8.0, 8.0, 18.0]);
    let comparison = compare(&snap, &curve(&[(0.5, 5.0), (1.0, 10.0)], 1.0)).unwrap();
    assert_eq!((comparison.rms, comparison.points, comparison.warning), (Some(0.0), 2, None));
}

#[test]
fn points_behind_a_turn_that_the_run_does_not_take_are_left_out_with_a_warning() {
    let straight = history(&[0.0, 1.0, 2.0], &[0.0, 10.0, 20.0]);
    let comparison = compare(&straight, &curve(&[(0.0, 0.0), (2.0, 20.0), (1.0, 5.0), (0.5, 0.0)], 1.0)).unwrap();
    assert_eq!((comparison.rms, comparison.points, comparison.outside), (Some(0.0), 2, 2));
    let warning = comparison.warning.unwrap();
    assert!(
        warning.contains("strain reverses at 2 (point 2)") && warning.contains("from 3 on are left out"),
        "{warning}"
    );
}

#[test]
fn iteration_noise_and_standing_still_end_no_branch() {
    let noisy = history(&[0.0, -1e-15, 0.0, 1.0, 1.0 - 1e-13, 2.0], &[0.0, 0.0, 0.0, 10.0, 9.0, 19.0]);
    // relaxed from 10 to 9 at x = 1, then along the line from 9
    let comparison = compare(&noisy, &curve(&[(0.5, 5.0), (1.0, 10.0), (1.5, 14.0)], 1.0)).unwrap();
    assert!(comparison.rms.unwrap() < 1e-12, "{comparison:?}");
    assert_eq!(comparison.points, 3);
}

#[test]
fn ends_belong_to_the_branch_although_scaling_rounds() {
    let comparison = compare(&history(&[0.0, 0.3], &[0.0, 3.0]), &curve(&[(0.0, 0.0), (3.0, 30.0)], 0.1)).unwrap();
    // 3 · 0.1 is a little more than 0.3
    assert_eq!(comparison.points, 2);
    assert!(comparison.rms.unwrap() < 1e-12);
}

#[test]
fn nothing_to_compare_is_no_number() {
    for (x, y) in [(&[][..], &[][..]), (&[f64::NAN], &[1.0]), (&[0.0], &[f64::NAN]), (&[0.0, 0.1], &[0.0, 1.0])] {
        let comparison = compare(&history(x, y), &curve(&[(0.5, 1.0), (f64::NAN, 1.0)], 1.0)).unwrap();
        assert_eq!((comparison.rms, comparison.points, comparison.outside), (None, 0, 2));
    }
}

proptest::proptest! {
    /// The rows that a comparison keeps of a branch give what all its rows give.
    #[test]
    fn rows_that_are_kept_give_what_all_give(
        x in proptest::collection::vec(-3_i8..8, 0..40),
        wanted in proptest::collection::vec(-4.0..9.0_f64, 1..6),
        sign in proptest::bool::ANY,
    ) {
        let sign = if sign { 1.0 } else { -1.0 };
        let mut walk = 0.0;
        let x: Vec<f64> = x.into_iter().map(|step| { walk += sign * 0.5 * f64::from(step.max(-1)); walk }).collect();
        let y: Vec<f64> = (0..x.len()).map(|k| (k * k) as f64).collect();
        let pairs = |each: &mut dyn FnMut(f64, f64) -> ControlFlow<()>| {
            let _ = x.iter().zip(&y).try_for_each(|(&x, &y)| each(x, y));
            Ok(())
        };
        let mut wanted: Vec<f64> = wanted.into_iter().map(|x| sign * x).collect();
        wanted.extend(&x);
        wanted.extend(x.iter().map(|x| x + 1e-10));
        let (all, some) = (Branch::first(&x, &y), Branch::around(&pairs, wanted.clone()).unwrap());
        for x in wanted {
            proptest::prop_assert_eq!(all.at(x), some.at(x), "{}", x);
        }
    }
}

/// A curve on its own x is itself, to the bit, also after reversals; what it does not reach is named.
#[test]
fn a_curve_on_its_own_grid_is_itself() {
    let x = [0.0, 0.1, 0.3, 0.25, 0.2, 0.3, 0.7];
    let y = [0.0, 0.1, 0.7, 0.3, 0.1, 0.9, 1.3];
    let OnGrid { values, .. } = OnGrid::of([&x, &y], &x);
    assert_eq!(values, y.map(Ok));
    let OnGrid { values, .. } = OnGrid::of([&x[..3], &y[..3]], &[-0.1, 0.2, 0.4]);
    let [before, Ok(between), behind] = values[..] else { panic!("{values:?}") };
    assert!((between - 0.4).abs() < 1e-15);
    assert_eq!(before, Err(Off::Before { start: 0.0, at_turn: false }));
    assert_eq!(behind, Err(Off::Behind { end: 0.3, at_turn: false }));
    let OnGrid { values, .. } = OnGrid::of([&x[..3], &y[..3]], &[0.1, 0.3, 0.1]);
    assert_eq!(values[2], Err(Off::Turned { x: 0.3, point: 2 }));
}
