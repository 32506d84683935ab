//! An elastic fibre over a curved channel.

use super::{model, run_to_end};
use std::f64::consts::FRAC_PI_2;

/// The force that holds the fibre back, N.
const HELD_BACK: f64 = 10.0;

/// Load over holding force once the whole fibre slides.
fn ratio(friction: f64) -> f64 {
    let model = model("capstan", &[&format!("contact.law.props.mu={friction}")]);
    let mut ratio = f64::NAN;
    run_to_end(&model, |record, _| ratio = record.load / HELD_BACK);
    ratio
}

#[test]
fn friction_multiplies_the_force_by_the_exponential_of_the_angle() {
    for friction in [0.1, 0.3] {
        let (found, exact) = (ratio(friction), (friction * FRAC_PI_2).exp());
        // of this, 0.5 % at μ = 0.3 is the fibre's half height, at which it pulls
        println!("mu {friction}: {found:.4} for {exact:.4}, {:.2e}", found / exact - 1.0);
        approx::assert_relative_eq!(found, exact, max_relative = 1e-2);
    }
}

#[test]
fn nothing_is_lost_without_friction() {
    let found = ratio(0.0);
    println!("mu 0: {found:.5}");
    approx::assert_relative_eq!(found, 1.0, max_relative = 2e-2);
}
