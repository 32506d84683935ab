use super::{Root, bracketed, bracketed_newton};
use std::cell::Cell;

#[test]
fn finds_the_root_of_a_smooth_function_in_a_few_steps() {
    let calls = Cell::new(0);
    let root = bracketed_newton([0.0, 2.0], 1.0, 0.0, |x| {
        calls.set(calls.get() + 1);
        (x * x - 2.0, 2.0 * x)
    });
    approx::assert_relative_eq!(root, 2.0_f64.sqrt(), max_relative = 4e-16);
    assert!(calls.get() <= 8, "{} evaluations", calls.get());
}

#[test]
fn survives_kinks_flat_parts_and_slopes_that_lie() {
    // flat on both sides, steep between
    let flat = |x: f64| {
        let inner = (x - 0.3) * 1e3;
        (inner.clamp(-1.0, 1.0), if inner.abs() < 1.0 { 1e3 } else { 0.0 })
    };
    approx::assert_relative_eq!(bracketed_newton([-5.0, 7.0], 6.0, 0.0, flat), 0.3, max_relative = 1e-15);
    // Newton cycles on sign(x)·sqrt|x|
    let cycling = |x: f64| (x.signum() * x.abs().sqrt(), 0.5 / x.abs().sqrt());
    assert!(bracketed_newton([-1.0, 2.0], 0.7, 1e-30, cycling).abs() < 1e-29);
    // a wrong slope costs steps only
    let wrong = |x: f64| (x.powi(3) - 8.0, -1.0);
    approx::assert_relative_eq!(bracketed_newton([0.0, 100.0], 50.0, 0.0, wrong), 2.0, max_relative = 1e-15);
}

#[test]
fn encloses_the_root_from_zero_over_decades_and_at_an_end() {
    let square = |x: f64| x * x - 2.0;
    let found = bracketed(square, (2.0, 2.0), (0.0, -2.0), f64::EPSILON);
    approx::assert_relative_eq!(found.x, 2.0_f64.sqrt(), max_relative = 4e-16);
    assert!((found.x - found.other).abs() <= 4e-16 && found.residual == square(found.x), "{found:?}");
    let calls = Cell::new(0);
    let log = |x: f64| {
        calls.set(calls.get() + 1);
        x.ln() + 400.0
    };
    let found = bracketed(log, (1.0, 400.0), (1e-300, log(1e-300)), f64::EPSILON);
    approx::assert_relative_eq!(found.x, (-400.0_f64).exp(), max_relative = 1e-13);
    assert!(calls.get() < 40, "{} evaluations", calls.get());
    for ends in [[(0.0, 0.0), (1.0, 1.0)], [(1.0, 1.0), (0.0, 0.0)]] {
        assert_eq!(bracketed(|x| x, ends[0], ends[1], f64::EPSILON), Root::exact(0.0, 0.0));
    }
}
