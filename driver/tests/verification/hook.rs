//! A wire that is drawn through a bent channel.

use super::{model, run_to_end};

/// P = M_p ∫|dκ|: two corners of radius ρ, at both ends of which the curvature changes by 1/ρ.
#[test]
fn a_hook_takes_its_plastic_moment_for_each_change_of_curvature() {
    const DIAMETER: f64 = 0.5;
    const YIELD_STRESS: f64 = 200.0;
    const RADIUS: f64 = 2.5;
    // of the area of the round wire
    let thickness = 0.25 * std::f64::consts::PI * DIAMETER;
    let plastic_moment = YIELD_STRESS * thickness * DIAMETER * DIAMETER / 4.0;
    let expected = 4.0 * plastic_moment / RADIUS;
    let (mut sum, mut length, mut worst, mut last) = (0.0, 0.0, 0.0_f64, [f64::NAN; 2]);
    run_to_end(&model("hook", &[]), |record, _| {
        let [slip, load] = last;
        if slip > 0.05 {
            sum += 0.5 * (load + record.load) * (record.slip - slip);
            length += record.slip - slip;
            worst = worst.max((record.load / expected - 1.0).abs());
        }
        last = [record.slip, record.load];
    });
    let mean = sum / length / expected - 1.0;
    println!("on average {mean:.3} off, {worst:.3} at most");
    assert!(length > 0.3 && mean.abs() < 0.02, "{mean:.3}");
    assert!(worst < 0.05, "{worst:.3}");
}

/// With friction the first of its contact opens in the first increment, and what the trapezoid of that misses is the same part of
/// the work in one of any size.
#[test]
fn a_first_increment_in_which_contact_opens_stands() {
    let overrides = ["contact.law.props.mu=0.2", "steps.0.slip=0.002", "steps.0.increments.initial=0.01"];
    let mut increments = 0;
    run_to_end(&model("hook", &overrides), |_, _| increments += 1);
    assert!(increments > 1);
}
