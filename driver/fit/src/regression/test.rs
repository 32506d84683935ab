//! Regressions of points that lie on a law give that law.

use super::{piecewise, powers};
use crate::geometry::BondPoint;
use crate::law::{BondSlipLaw, Piecewise, Powers};
use approx::assert_relative_eq;

fn points(law: &BondSlipLaw, slips: &[f64]) -> Vec<BondPoint> {
    let tractions = law.tractions(slips, 0.0).expect("a law");
    slips.iter().zip(tractions).map(|(&slip, traction)| BondPoint { slip, traction }).collect()
}

/// From 1/500 of the end to the end, each the same factor further.
fn geometric(end: f64, count: usize) -> Vec<f64> {
    (0..count).map(|k| end * 500.0_f64.powf(k as f64 / (count - 1) as f64 - 1.0)).collect()
}

#[test]
fn powers_come_back_to_rounding() {
    for (elastic_stiffness, rise, fall) in [
        (400.0, [3.44, 0.13865], [1.0, -0.1772]),
        (950.0, [1.5921, 0.0832], [0.87, -0.2678]),
        (60.0, [4.0, 0.4], [1.5, -0.6]),
    ] {
        let law = Powers { elastic_stiffness, rise, fall };
        let end = 20.0 * (fall[0] / rise[0]).powf(1.0 / (rise[1] - fall[1]));
        for count in [60, 333, 1000] {
            let mut slips = geometric(end, count);
            // some of the straight line, whatever its length
            let critical = (rise[0] / elastic_stiffness).powf(1.0 / (1.0 - rise[1]));
            slips.extend((1..10).map(|k| critical * f64::from(k) / 10.0));
            slips.sort_by(f64::total_cmp);
            let found = powers(&points(&BondSlipLaw::Powers(law), &slips)).expect("a law");
            assert_relative_eq!(found.elastic_stiffness, elastic_stiffness, max_relative = 1e-10);
            for k in 0..2 {
                assert_relative_eq!(found.rise[k], rise[k], max_relative = 1e-9);
                assert_relative_eq!(found.fall[k], fall[k], max_relative = 1e-9);
            }
        }
    }
}

#[test]
fn straight_lines_come_back_to_rounding() {
    let law = Piecewise { points: vec![[0.004, 1.6], [0.02, 2.0], [0.3, 1.2], [2.0, 0.7]] };
    for count in [80, 300, 700] {
        // some of the first line, which ends where the others' points begin, at a joint or not
        let slips: Vec<f64> = (1..8).map(|k| 5e-4 * f64::from(k)).chain(geometric(2.0, count)).collect();
        let found = piecewise(&points(&BondSlipLaw::Piecewise(law.clone()), &slips), 4).expect("a law");
        for (found, true_point) in found.points.iter().zip(&law.points) {
            assert_relative_eq!(found[0], true_point[0], max_relative = 1e-8);
            assert_relative_eq!(found[1], true_point[1], max_relative = 1e-8);
        }
    }
}

#[test]
fn a_curve_that_only_falls_has_no_powers() {
    let falls: Vec<BondPoint> =
        geometric(1.0, 50).into_iter().map(|slip| BondPoint { slip, traction: 1.0 / (1.0 + slip) }).collect();
    assert_eq!(powers(&falls), None);
}

#[test]
fn too_few_points_have_no_straight_lines() {
    let few: Vec<BondPoint> = geometric(1.0, 6).into_iter().map(|slip| BondPoint { slip, traction: slip }).collect();
    assert_eq!(piecewise(&few, 4), None);
}
