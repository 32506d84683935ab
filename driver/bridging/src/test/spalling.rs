use super::*;
use approx::assert_relative_eq;

fn with(inclination: Inclination, debonding: Debonding) -> BridgingFibre {
    let bond = Bond::Closed(friction(debonding, Sliding::Shortening));
    BridgingFibre::new(fibre(), &bond, inclination, Sides::One, 0.0).expect("a fibre")
}

#[test]
fn a_matrix_that_does_not_spall_snubs() {
    let strong = with(Inclination::Spalling { k: 0.5, k_sp: 1e9, ft: 3.0 }, Debonding::Rigid);
    let snubbing = with(Inclination::Exp { f: 0.5 }, Debonding::Rigid);
    for (opening, angle) in [(0.2, 0.3), (1.0, 0.8), (5.0, 1.4)] {
        let (a, b) = (strong.at(opening, 12.0, angle), snubbing.at(opening, 12.0, angle));
        assert_relative_eq!(a.load, b.load, max_relative = 1e-5);
        assert!(a.spalled < 1e-4);
    }
}

#[test]
fn the_spalled_length_holds_its_own_equation() {
    let (k, k_sp, ft, angle, opening, embedded) = (0.3, 20.0, 3.0, 1.0_f64, 0.4, 12.0);
    let response = with(Inclination::Spalling { k, k_sp, ft }, Debonding::Elastic).at(opening, embedded, angle);
    let s = response.spalled;
    let free = (2.0 * s * angle.sin()).atan2(opening + 2.0 * s * angle.cos());
    let normal = response.load * free.cos();
    let expected = normal * (0.5 * angle).sin() / (k_sp * ft * 0.5 * (0.5 * angle).cos().powi(2));
    assert_relative_eq!(s, expected, max_relative = 1e-9);
    let base = with(Inclination::Exp { f: 0.0 }, Debonding::Elastic).at(opening, embedded - s, 0.0).load;
    assert_relative_eq!(response.load, base * (k * (angle - free)).exp(), max_relative = 1e-9);
}

#[test]
fn spalls_do_not_heal() {
    let fibre = with(Inclination::Spalling { k: 0.3, k_sp: 20.0, ft: 3.0 }, Debonding::Elastic);
    for angle in [0.4, 0.9, 1.3] {
        let spalled: Vec<f64> = (1..60).map(|k| fibre.at(0.2 * f64::from(k), 12.0, angle).spalled).collect();
        assert!(spalled.windows(2).all(|pair| pair[1] >= pair[0] * (1.0 - 1e-6)), "{spalled:?}");
    }
}

#[test]
fn a_wire_round_a_corner_takes_twice_its_moment_over_the_radius() {
    let hinge = with(Inclination::Hinge { f: 0.1, yield_stress: 347.0, radius: 0.609 }, Debonding::Rigid);
    let plain = with(Inclination::Exp { f: 0.1 }, Debonding::Rigid);
    let more = |opening: f64, angle: f64| hinge.at(opening, 12.0, angle).load - plain.at(opening, 12.0, angle).load;
    let full = 2.0 * 347.0 * 0.125 / 6.0 / 0.609;
    assert_relative_eq!(more(2.0, 0.7), full, max_relative = 1e-9);
    assert_relative_eq!(more(0.1, 0.7), full * 0.1 / (0.609 * 0.7), max_relative = 1e-9);
    assert_eq!(more(2.0, 0.0), 0.0);
    assert_eq!(more(12.5, 0.7), 0.0);
}

#[test]
fn averages_with_spalling_converge() {
    let fibre = with(Inclination::Spalling { k: 0.5, k_sp: 20.0, ft: 3.0 }, Debonding::Elastic);
    let composite = Composite::new(fibre, 0.01, &Orientation::Random3d, matrix(), 0.0).expect("a composite");
    for opening in [0.01, 0.3, 3.0] {
        let average = composite.average(opening);
        println!("{average:?}");
        assert!(average.error < 1e-3 * average.stress && average.spalled_mean > 0.0);
    }
}
