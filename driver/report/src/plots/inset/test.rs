use super::*;

/// A fibre's load: up to 10 at 0.02, three quarters of it at 0.03, a long tail to 2.
fn load(slip: f64) -> f64 {
    if slip < 0.02 { 500.0 * slip } else { 10.0 * (-(slip - 0.02) / 0.03).exp() + 0.5 * (2.0 - slip) }
}

fn curve(load: impl Fn(f64) -> f64, count: u32) -> Vec<(f64, f64)> {
    (0..=count).map(|k| f64::from(k) * 2.0 / f64::from(count)).map(|slip| (slip, load(slip))).collect()
}

#[test]
fn a_narrow_peak_is_found_with_what_is_around_it() {
    let (start, end) = spike(&curve(load, 2000), 0.06).expect("a spike");
    // above three quarters of its height from 0.015 to 0.030
    assert!((-0.02..0.0).contains(&start) && (0.06..0.09).contains(&end), "{start} … {end}");
}

#[test]
fn what_stays_is_wide_or_has_few_points_is_no_spike() {
    let damage = |slip: f64| (slip / 0.01).min(1.0);
    let hill = |slip: f64| slip * (2.0 - slip);
    let single = |slip: f64| if (slip - 1.0).abs() < 1e-9 { 1.0 } else { 0.0 };
    for (name, points) in [("stays", curve(damage, 2000)), ("wide", curve(hill, 2000)), ("few", curve(single, 2000))] {
        assert_eq!(spike(&points, 0.06), None, "{name}");
    }
    assert_eq!(spike(&[], 0.06), None);
    assert_eq!(spike(&curve(|_| 0.0, 20), 0.06), None);
}

#[test]
fn pieces_are_cut_at_the_ends_of_the_window_also_where_a_curve_turns_back() {
    let there_and_back = [(0.0, 0.0), (4.0, 4.0), (4.0, 6.0), (0.0, 10.0)];
    assert_eq!(clipped(&there_and_back, &(1.0..=2.0)), [vec![(1.0, 1.0), (2.0, 2.0)], vec![(2.0, 8.0), (1.0, 9.0)]]);
    assert_eq!(clipped(&there_and_back, &(5.0..=6.0)), Vec::<Vec<(f64, f64)>>::new());
    let gap = [(0.0, 0.0), (f64::NAN, 1.0), (1.0, 1.0), (2.0, 2.0)];
    assert_eq!(clipped(&gap, &(0.0..=9.0)), [vec![(1.0, 1.0), (2.0, 2.0)]]);
}
