use super::bracketed_newton;
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
