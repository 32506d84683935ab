use super::*;
use crate::bond::Side;
use approx::assert_relative_eq;
use std::f64::consts::PI;

fn constant() -> ShearLag {
    ShearLag { law: BondLaw { points: vec![[0.0, 3.0], [1.0, 3.0]] } }
}

/// s = s_t + 2τ(L − s_t)²/(E d), P = π d τ (L − s_t).
fn constant_friction(slip: f64, embedded: f64, modulus: f64) -> f64 {
    let c = 2.0 * 3.0 / (modulus * 0.5);
    if slip <= c * embedded * embedded {
        return PI * 0.5 * 3.0 * (slip / c).sqrt();
    }
    let left = embedded - slip;
    PI * 0.5 * 3.0 * 2.0 * left / (1.0 + (1.0 - 4.0 * c * left).sqrt())
}

#[test]
fn constant_friction_is_its_closed_form() {
    for modulus in [210.0, 2.1e5, 2.1e9, 2.1e13] {
        let side = constant().side(&fibre(), modulus);
        for embedded in [0.5, 4.0, 15.0] {
            for slip in [1e-6, 1e-3, 0.01, 0.3, 0.49] {
                let expected = constant_friction(slip, embedded, modulus);
                assert_relative_eq!(side.loads(slip, embedded).0, expected, max_relative = 2e-7);
            }
            assert_eq!(side.loads(embedded, embedded).0, 0.0);
        }
    }
}

#[test]
fn laws_of_straight_lines_meet_hyperbolic_and_circular_functions() {
    // τ = k s: s = s_t cosh(λx), P = EA s_t λ sinh(λx)
    let law = ShearLag { law: BondLaw { points: vec![[0.0, 0.0], [1.0, 400.0]] } };
    let side = law.side(&fibre(), 210_000.0);
    let lambda = (4.0 * 400.0 / (210_000.0 * 0.5_f64)).sqrt();
    let (tail, embedded) = (1e-4, 12.0);
    let length: f64 = embedded - tail;
    let slip = tail * (lambda * length).cosh();
    let load = 210_000.0 * fibre().area() * tail * lambda * (lambda * length).sinh();
    assert_relative_eq!(side.loads(slip, embedded).0, load, max_relative = 1e-10);
    // τ = 4 − 2s: y = 2 − s falls as a cosine
    let law = ShearLag { law: BondLaw { points: vec![[0.0, 4.0], [2.0, 0.0]] } };
    let side = law.side(&fibre(), 210_000.0);
    let omega = (4.0 * 2.0 / (210_000.0 * 0.5_f64)).sqrt();
    let length: f64 = embedded - tail;
    let slip = 2.0 - (2.0 - tail) * (omega * length).cos();
    let load = 210_000.0 * fibre().area() * (2.0 - tail) * omega * (omega * length).sin();
    assert_relative_eq!(side.loads(slip, embedded).0, load, max_relative = 1e-9);
}

#[test]
fn stiff_fibres_are_pulled_out_as_c2() {
    let stiff = Fibre { modulus: 2.1e13, ..fibre() };
    let composite = composite(stiff, &Bond::ShearLag(constant()), Sides::One, &Orientation::Random3d);
    for opening in [0.1, 0.5, 2.5, 7.5] {
        let closed = 1.352_448_021_489_041_8 * (1.0 - opening / 15.0_f64).powi(2);
        assert_relative_eq!(composite.average(opening).stress, closed, max_relative = 1e-6);
    }
}

#[test]
fn debonding_is_c1_where_the_fibre_does_not_become_shorter() {
    let stiff = Fibre { modulus: 2.1e9, ..fibre() };
    let composite = composite(stiff, &Bond::ShearLag(constant()), Sides::Two, &Orientation::Random3d);
    let debonded = 30.0 * 30.0 * 3.0 / (2.1e9 * 0.5);
    for part in [0.1_f64, 0.25, 0.5, 1.0] {
        let closed = 1.352_448_021_489_041_8 * (2.0 * part.sqrt() - part);
        assert_relative_eq!(composite.average(part * debonded).stress, closed, max_relative = 1e-6);
    }
}

#[test]
fn one_side_of_constant_friction_averages_as_its_closed_form() {
    let composite = composite(fibre(), &Bond::ShearLag(constant()), Sides::One, &Orientation::Planar);
    for opening in [1e-3, 5e-3, 0.02, 1.0] {
        // ∫ over the length by panels that end at the debonded one
        let debonded = (opening * 210_000.0 * 0.5 / 6.0_f64).sqrt().min(15.0);
        let load = |length| constant_friction(opening, length, 210_000.0);
        let integral = quadrature::integral(3, opening, debonded, load) + quadrature::integral(3, debonded, 15.0, load);
        let snubbed = composite.directions.converged(|angle| angle.cos() * (0.5 * angle).exp());
        let expected = 0.01 / fibre().area() * integral / 15.0 * snubbed;
        assert_relative_eq!(composite.average(opening).stress, expected, max_relative = 1e-6);
    }
}

/// The bond law of the cases of chapter 7.
fn law_a() -> ShearLag {
    let critical = (3.44_f64 / 400.0).powf(1.0 / (1.0 - 0.13865));
    let peak = (1.0_f64 / 3.44).powf(1.0 / (0.13865 + 0.1772));
    let traction = |slip: f64| {
        if slip <= critical {
            400.0 * slip
        } else if slip <= peak {
            3.44 * slip.powf(0.13865)
        } else {
            slip.powf(-0.1772)
        }
    };
    ShearLag { law: BondLaw::sampled(traction, &[critical, peak], 20.0) }
}

#[test]
fn a_perpendicular_fibre_is_that_of_the_finite_elements() {
    // 30.64 N in the plane model without friction, whose matrix deforms a little
    let fibre = Fibre { diameter: 0.406, length: 24.4, ..fibre() };
    let side = law_a().side(&fibre, 210_000.0);
    let slip = side.turning_slip(12.2);
    println!("peak {:.3} N at {:.4} mm", side.loads(slip, 12.2).0, slip);
    assert_relative_eq!(side.loads(slip, 12.2).0, 30.64, max_relative = 5e-3);
}

#[test]
fn the_peak_is_the_greatest_load_and_is_found_again() {
    let side = law_a().side(&fibre(), 210_000.0);
    for embedded in [0.3, 2.0, 9.1, 15.0] {
        let turning = side.turning_slip(embedded);
        let (_, greatest) = side.loads(embedded, embedded);
        for k in 1..200 {
            let slip = embedded * f64::from(k) / 200.0;
            assert!(side.loads(slip, embedded).0 <= greatest * (1.0 + 1e-7));
        }
        let load = 0.7 * greatest;
        let slip = side.loading_slip(load, embedded);
        assert!(slip < turning);
        assert_relative_eq!(side.loads(slip, embedded).0, load, max_relative = 1e-9);
    }
}

#[test]
fn snap_back_is_passed_to_the_lowest_load() {
    // a bond that is lost at once over a long soft fibre
    let law = ShearLag { law: BondLaw { points: vec![[0.0, 5.0], [0.01, 5.0], [0.02, 0.5], [1.0, 0.5]] } };
    let soft = Fibre { modulus: 2000.0, ..fibre() };
    let side = law.side(&soft, 2000.0);
    let loads: Vec<f64> = (1..400).map(|k| side.loads(0.01 * f64::from(k), 15.0).0).collect();
    assert!(loads.iter().all(|load| load.is_finite() && *load > 0.0));
    // friction of what is left, at most
    assert!(loads[398] <= PI * 0.5 * 0.5 * 15.0);
}

#[test]
fn both_sides_carry_the_same_load() {
    for law in [law_a(), constant(), ShearLag { law: BondLaw { points: vec![[0.0, 1.0], [0.1, 4.0], [3.0, 1.0]] } }] {
        let side = law.side(&fibre(), 210_000.0);
        for (opening, short) in [(1e-3, 4.0), (0.01, 4.0), (0.01, 14.9), (0.03, 9.0), (0.5, 9.0), (3.0, 5.0)] {
            let long = 30.0 - short;
            let bridged = bond::two_sided(&side, opening, short, long);
            assert_relative_eq!(side.loads(bridged.slip, short).0, bridged.load, max_relative = 1e-9);
            if bridged.load == bridged.greatest {
                assert_relative_eq!(side.loads(opening - bridged.slip, long).0, bridged.load, max_relative = 1e-6);
            } else {
                let loaded = side.loading_slip(bridged.greatest, long);
                let back = side.loading_slip(0.5 * (bridged.greatest - bridged.load), long);
                assert_relative_eq!(bridged.slip + loaded - 2.0 * back, opening, max_relative = 1e-9);
            }
        }
    }
}

#[test]
fn a_bond_that_ends_carries_nothing_beyond() {
    let law = ShearLag { law: BondLaw { points: vec![[0.0, 3.0], [0.5, 0.0], [1.0, 0.0]] } };
    let side = law.side(&fibre(), 210_000.0);
    let loads: Vec<f64> = (1..300).map(|k| side.loads(0.01 * f64::from(k), 15.0).0).collect();
    assert!(loads.iter().all(|load| *load >= 0.0 && load.is_finite()));
    assert!(loads[10] > 1.0 && loads[120] < 1e-3, "{} {}", loads[10], loads[120]);
}
