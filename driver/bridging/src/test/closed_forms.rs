//! Reference numbers of an independent program, which agree with the closed forms: L_f 30, d 0.5, τ 3, E 210 000,
//! V_f 0.01, f 0.5, η_E 0.

use super::*;
use approx::assert_relative_eq;
use std::f64::consts::PI;

const SIGMA_0: f64 = 1.352_448_021_489_041_8;
const FULLY_DEBONDED: f64 = 30.0 * 30.0 * 3.0 / (210_000.0 * 0.5);
/// Tolerance of the numbers, which have ten digits after the point.
const ROUNDING: f64 = 1e-10;

fn stress(composite: &Composite, opening: f64) -> f64 {
    composite.average(opening).stress
}

#[test]
fn debonding_is_c1() {
    let bond = Bond::Closed(friction(Debonding::Elastic, Sliding::Held));
    let composite = composite(fibre(), &bond, Sides::Two, &Orientation::Random3d);
    for (part, expected) in [(0.25, 1.0143360161), (0.5, 1.2364263236), (1.0, 1.3524480215)] {
        assert_relative_eq!(stress(&composite, part * FULLY_DEBONDED), expected, epsilon = ROUNDING);
        let closed = SIGMA_0 * (2.0 * f64::sqrt(part) - part);
        assert_relative_eq!(stress(&composite, part * FULLY_DEBONDED), closed, max_relative = 1e-12);
    }
}

#[test]
fn pull_out_is_c2() {
    let space = pulled_out(fibre(), &Orientation::Random3d);
    for (opening, expected) in [(0.1, 1.3344754900), (0.5, 1.2637875401), (2.5, 0.9392000149), (7.5, 0.3381120054)] {
        assert_relative_eq!(stress(&space, opening), expected, epsilon = ROUNDING);
        let closed = SIGMA_0 * (1.0 - opening / 15.0).powi(2);
        assert_relative_eq!(stress(&space, opening), closed, max_relative = 1e-12);
    }
    assert_relative_eq!(stress(&space, 0.0), SIGMA_0, max_relative = 1e-12);
    assert_eq!(stress(&space, 15.0), 0.0);
    assert_eq!(stress(&space, 20.0), 0.0);
    let energy = quadrature::integral(1, 0.0, 15.0, |opening| stress(&space, opening));
    assert_relative_eq!(energy, 6.7622401074, epsilon = ROUNDING);
    assert_relative_eq!(energy, SIGMA_0 * 30.0 / 6.0, max_relative = 1e-12);
    let plane = pulled_out(fibre(), &Orientation::Planar);
    assert_relative_eq!(stress(&plane, 0.0), 1.552_284_807_055_778_6, max_relative = 1e-12);
}

#[test]
fn planar_and_random_differ_by_the_closed_ratio() {
    let f: f64 = 0.5;
    let e = (0.5 * PI * f).exp();
    let ratio = 4.0 / PI * (e - f) * (4.0 + f * f) / ((1.0 + f * f) * 2.0 * (1.0 + e));
    let [plane, space] = [Orientation::Planar, Orientation::Random3d].map(|o| stress(&pulled_out(fibre(), &o), 1.0));
    assert_relative_eq!(plane / space, ratio, max_relative = 1e-12);
    assert_relative_eq!(ratio, 1.148, epsilon = 5e-4);
}

#[test]
fn slip_hardening_while_debonding_is_c3() {
    let bond = Closed { beta: 0.05, ..friction(Debonding::Hardening, Sliding::Held) };
    let composite = composite(fibre(), &Bond::Closed(bond), Sides::Two, &Orientation::Random3d);
    let k = (4.0_f64 * 0.05 * 3.0 / 210_000.0).sqrt() * 30.0 / (2.0 * 0.5);
    let debonded = 2.0 * 0.5 / 0.05 * 2.0 * (0.5 * k).sinh().powi(2);
    for (part, expected) in [(0.1, 0.7202028000), (0.5, 1.2366488552), (1.0, 1.3527378566)] {
        assert_relative_eq!(stress(&composite, part * debonded), expected, epsilon = ROUNDING);
        let y = 0.05 * part * debonded;
        let x = (1.0 + y).acosh();
        let closed = 2.0 * SIGMA_0 / k * ((1.0 - x / k) * x.sinh() + y / k);
        assert_relative_eq!(stress(&composite, part * debonded), closed, max_relative = 1e-9);
    }
}

#[test]
fn rupture_is_c4() {
    // by Simpson's rule over the angle, the integral over the length in closed form; agrees with the numbers of the
    // independent program to 5e-10
    let numbers = [
        (400.0, [0.501117018063, 0.449708808113, 0.274130368790]),
        (800.0, [1.223647968172, 1.139773416122, 0.834329608399]),
        (1100.0, [1.347471561178, 1.258982733825, 0.935081824891]),
    ];
    for (strength, expected) in numbers {
        let fibre = Fibre { strength: Some(strength), rupture_f: 0.3, ..fibre() };
        let composite = pulled_out(fibre, &Orientation::Random3d);
        for (opening, expected) in [0.0, 0.5, 2.5].into_iter().zip(expected) {
            let average = composite.average(opening);
            assert_relative_eq!(average.stress, expected, epsilon = 1e-11);
            assert!(average.error <= 1e-8 * average.stress, "{average:?}");
            assert!(average.ruptured > 0.0 && average.active + average.ruptured <= 1.0 + 1e-12);
        }
    }
}

#[test]
fn broken_fibres_do_not_come_back() {
    let fibre = Fibre { strength: Some(400.0), ..fibre() };
    for debonding in [Debonding::Rigid, Debonding::Elastic] {
        let bond = Bond::Closed(Closed { beta: 0.02, ..friction(debonding, Sliding::Shortening) });
        for sides in [Sides::One, Sides::Two] {
            let composite = composite(fibre, &bond, sides, &Orientation::Random3d);
            let ruptured = [1e-3, 1e-2, 0.1, 1.0, 5.0, 14.0].map(|opening| composite.average(opening).ruptured);
            assert!(ruptured.windows(2).all(|pair| pair[1] >= pair[0] - 1e-9), "{ruptured:?}");
            assert!(ruptured[5] > 0.1);
        }
    }
}

#[test]
fn slip_hardening_after_debonding_has_c2_as_its_limit() {
    let at = |beta: f64| {
        let bond = Closed { beta, ..friction(Debonding::Rigid, Sliding::Shortening) };
        stress(&composite(fibre(), &Bond::Closed(bond), Sides::One, &Orientation::Random3d), 2.0)
    };
    let plain = SIGMA_0 * (1.0 - 2.0 / 15.0_f64).powi(2);
    assert_relative_eq!(at(0.0), plain, max_relative = 1e-12);
    // P = πτ(L − u)(d + βu): the same factor for all fibres
    assert_relative_eq!(at(0.05), plain * (1.0 + 0.05 * 2.0 / 0.5), max_relative = 1e-12);
}

#[test]
fn two_sides_share_the_opening_of_one() {
    let bond = Bond::Closed(friction(Debonding::Elastic, Sliding::Shortening));
    let of = |sides| BridgingFibre::new(fibre(), &bond, Inclination::Exp { f: 0.5 }, sides, 0.0).expect("a fibre");
    let (one, two) = (of(Sides::One), of(Sides::Two));
    for part in [0.1, 0.5, 0.99] {
        let slip = part * 2.0 * 3.0 * 15.0 * 15.0 / (210_000.0 * 0.5);
        let (of_one, of_two) = (one.at(slip, 15.0, 0.3).load, two.at(2.0 * slip, 15.0, 0.3).load);
        assert_relative_eq!(of_one, of_two, max_relative = 1e-12);
    }
}

#[test]
fn a_rigid_long_side_makes_two_sides_one() {
    let bond = Bond::Closed(Closed { beta: 0.03, ..friction(Debonding::Rigid, Sliding::Shortening) });
    let [one, two] = [Sides::One, Sides::Two].map(|sides| composite(fibre(), &bond, sides, &Orientation::Random3d));
    for opening in [0.0, 0.2, 3.0, 9.0] {
        assert_relative_eq!(stress(&one, opening), stress(&two, opening), max_relative = 1e-12);
    }
}

#[test]
fn both_sides_carry_the_same_load_at_any_opening() {
    let law = Closed { beta: 0.03, debonding_energy: 0.002, ..friction(Debonding::Elastic, Sliding::Shortening) };
    let side = law.side(&fibre(), 210_000.0);
    for opening in [1e-3, 0.01, 0.03, 0.5, 4.0] {
        let bridged = bond::two_sided(&side, opening, 7.0, 23.0);
        // the long side in simple loading
        if bridged.load == bridged.greatest {
            use crate::bond::Side as _;
            let long = opening - bridged.slip;
            assert_relative_eq!(side.loads(long, 23.0).0, bridged.load, max_relative = 1e-9);
        }
        assert!(bridged.slip <= opening && bridged.load > 0.0);
    }
}

/// Yang, Wang, Yang, Li 2008: PVA-ECC M45, one-way 6.2 MPa at 93 µm, two-way 6.3 MPa at 130 µm.
fn m45(sides: Sides) -> (f64, f64) {
    let fibre = Fibre { diameter: 0.039, length: 12.0, modulus: 22_000.0, strength: Some(1060.0), rupture_f: 0.33 };
    let bond = Closed {
        tau: 1.31,
        beta: 0.58,
        debonding_energy: 1.08e-3,
        debonding: Debonding::Elastic,
        sliding: Sliding::Shortening,
        hook: None,
    };
    let ratio = 22_000.0 * 0.02 / (20_000.0 * 0.98);
    let fibre = BridgingFibre::new(fibre, &Bond::Closed(bond), Inclination::Exp { f: 0.2 }, sides, ratio);
    let fibre = fibre.expect("a fibre");
    let composite = Composite::new(fibre, 0.02, &Orientation::Planar, matrix(), 0.0).expect("a composite");
    let openings: Vec<f64> = (1..=300).map(|k| 1e-3 * f64::from(k)).collect();
    averages(&composite, &openings)
        .iter()
        .map(|average| (average.opening, average.stress))
        .fold((0.0, 0.0), |peak, point| if point.1 > peak.1 { point } else { peak })
}

#[test]
fn polymer_fibres_of_a_published_composite() {
    let (one, two) = (m45(Sides::One), m45(Sides::Two));
    println!("one-way {:.3} MPa at {:.0} µm, two-way {:.3} MPa at {:.0} µm", one.1, 1e3 * one.0, two.1, 1e3 * two.0);
    assert_relative_eq!(one.1, 6.2, max_relative = 0.05);
    assert_relative_eq!(two.0, 0.130, max_relative = 0.10);
}
