//! Curved bars in a rigid block.

use super::{model, run_to_end};
use end_to_end_tests::analytical::capstan::Capstan;
use std::f64::consts::{FRAC_PI_2, PI};

/// Embedded length along the axis, mm.
const LENGTH: f64 = 350.0;
/// Radius of a quarter of a circle of that length, mm.
const RADIUS: f64 = LENGTH / FRAC_PI_2;

/// T = τ π φ R (e^(μα) − 1)/μ.
#[test]
fn friction_adds_to_a_constant_bond_along_an_arc() {
    const DIAMETER: f64 = 8.0;
    const BOND: f64 = 1.0;
    // the hole's rounded edge has no bond
    const BONDED: f64 = LENGTH - 0.5;
    let mut largest = 0.0_f64;
    run_to_end(&model("bar-on-an-arc", &[]), |record, _| largest = largest.max(record.load));
    let (radius, angle) = (RADIUS, BONDED / RADIUS);
    let bar = Capstan { radius, line_radius: radius, angle, friction: 0.1, bond: BOND * PI * DIAMETER };
    let error = largest / bar.pull(0.0) - 1.0;
    println!("{largest:.1} N, {error:.2e} off");
    // friction acts on the inner wall, half of the diameter nearer to the centre: 1.8 % of what it adds
    assert!(error.abs() < 5e-3, "{error:.2e}");
}

/// P = M_p/R: the curvature of what leaves the arc goes from 1/R to 0.
#[test]
fn a_bar_that_leaves_its_arc_takes_its_plastic_moment_over_the_radius() {
    const DIAMETER: f64 = 32.0;
    const YIELD_STRESS: f64 = 455.0;
    let thickness = 0.25 * PI * DIAMETER;
    let expected = YIELD_STRESS * thickness * DIAMETER * DIAMETER / 4.0 / RADIUS;
    let (mut sum, mut length, mut last) = (0.0, 0.0, [0.0; 2]);
    run_to_end(&model("bar-leaves-its-arc", &[]), |record, _| {
        let [slip, load] = last;
        if slip > 0.5 * DIAMETER {
            sum += 0.5 * (load + record.load) * (record.slip - slip);
            length += record.slip - slip;
        }
        last = [record.slip, record.load];
    });
    let error = sum / length / expected - 1.0;
    println!("{error:.3} off on average");
    // what has left the arc keeps a little of its curvature
    assert!(length > 0.5 * DIAMETER && error.abs() < 0.08, "{error:.3}");
}
