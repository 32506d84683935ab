mod behaviour;
mod configuration;

use super::*;
use battery::interface::{
    ContactPoint, Sizes, SlidingPoint, check_contact_invariants, check_contact_tangent, check_energy_balance,
    check_sliding_tangent,
};
use battery::pages::{PARAMETERS, STATES};
use battery::reference::Table;
use std::f64::consts::PI;
use umat_abi::law::check_properties;

/// Places in PROPS.
const LAW: usize = 0;
const FORM: usize = 1;
const NORMAL_LAW: usize = 2;
const NORMAL_STIFFNESS: usize = 3;
const P_0: usize = 4;
const DELTA_N: usize = 5;
const G_0: usize = 6;
const K_E: usize = 7;
const B_1: usize = 9;
const A_2: usize = 10;
const TAU_RES: usize = 12;
const K_U: usize = 13;
const MU: usize = 14;
const K_F: usize = 15;
const POINT_COUNT: usize = 16;
const C_N: usize = 17;

/// The defaults (chapter 8) with some parameters set.
fn props(set: &[(usize, f64)]) -> Vec<f64> {
    let mut props: Vec<f64> = BondSlip::INFO.parameters[..17].iter().map(|p| p.default_value).collect();
    for &(index, value) in set {
        props[index] = value;
    }
    props
}

/// Law B in mixed mode: hard contact of 1e4 MPa/mm, and PROPS that reach to c_N.
fn mixed(weight: f64, set: &[(usize, f64)]) -> Vec<f64> {
    let mixed = [(LAW, 1.0), (NORMAL_LAW, 0.0), (NORMAL_STIFFNESS, 1e4)];
    [&props(&[&mixed, set].concat())[..], &[weight]].concat()
}

/// The defaults with some parameters set and the piecewise form through these points.
fn piecewise(set: &[(usize, f64)], points: &[[f64; 2]]) -> Vec<f64> {
    let mut props = props(set);
    props[FORM] = 1.0;
    props[POINT_COUNT] = points.len() as f64;
    props.extend(points.iter().flatten());
    props
}

/// An elastic start of slope 950, a plateau, a fall to the residual.
const POINTS: [[f64; 2]; 5] = [[1e-3, 0.95], [0.02, 1.2], [0.1, 1.4], [0.4, 0.8], [2.0, 0.3]];

/// Every law, form and normal law.
fn variants() -> Vec<Vec<f64>> {
    let mut all = Vec::new();
    for law in [0.0, 1.0, 2.0] {
        for normal in [&[(NORMAL_LAW, 1.0)][..], &[(NORMAL_LAW, 0.0), (NORMAL_STIFFNESS, 1e4), (DELTA_N, 0.01)]] {
            let mut set = normal.to_vec();
            set.push((LAW, law));
            all.push(props(&set));
            if law < 2.0 {
                all.push(piecewise(&set, &POINTS));
            }
            if law == 0.0 {
                // unloading along the secant over most slips, residual friction above τ(g_crit)
                set.extend([(K_U, 5.0), (TAU_RES, 1.2)]);
                all.push(props(&set));
                // inelastic from the first slip on
                all.push(piecewise(&set, &[[0.02, 1.0], [0.1, 1.4], [0.4, 1.3], [2.0, 0.3]]));
            }
        }
    }
    for weight in [1.0, 5.0] {
        all.push(mixed(weight, &[]));
        let mut points = mixed(weight, &[(TAU_RES, 0.2), (FORM, 1.0), (POINT_COUNT, POINTS.len() as f64)]);
        points.extend(POINTS.iter().flatten());
        all.push(points);
    }
    all
}

fn sizes(props: &[f64]) -> Sizes {
    let soft = props[NORMAL_LAW] == 1.0;
    Sizes { normal: if soft { 0.05 } else { 2e-3 }, slip: 0.2, pressure: 20.0 }
}

#[test]
fn its_page_has_the_tables_that_hosts_see() {
    let page = concat!(env!("CARGO_MANIFEST_DIR"), "/src/bond_slip/doc.md");
    battery::pages::check(page, &BondSlip::INFO, &[PARAMETERS, STATES]);
}

#[test]
fn uinter_tangent_agrees_with_differences() {
    for props in variants() {
        for directions in [2, 3] {
            let checked = check_contact_tangent::<BondSlip>(&props, directions, sizes(&props), 1500);
            println!("{:?} NDIR {directions}: {checked:?}", &props[..3]);
            assert!(checked.kinks * 20 <= checked.tried, "{checked:?}");
        }
    }
}

#[test]
fn fric_tangent_agrees_with_differences() {
    for props in variants() {
        for directions in [1, 2] {
            let checked = check_sliding_tangent::<BondSlip>(&props, directions, sizes(&props), 1500);
            println!("{:?} NFDIR {directions}: {checked:?}", &props[..3]);
            assert!(checked.kinks * 20 <= checked.tried, "{checked:?}");
        }
    }
}

#[test]
fn dissipates_repeats_and_keeps_its_history() {
    for props in variants() {
        for directions in [1, 2, 3] {
            let monotone = ["kappa", "d", "open", "opening"];
            check_contact_invariants::<BondSlip>(&props, directions, sizes(&props), 300, &monotone);
        }
    }
}

#[test]
fn work_is_stored_plus_dissipated() {
    for props in variants() {
        for directions in [2, 3] {
            let size = Sizes { slip: 0.02, ..sizes(&props) };
            let worst = check_energy_balance::<BondSlip>(&props, directions, size, 6, 4000, 1e-5);
            println!("{:?} NDIR {directions}: defect {worst:?}", &props[..3]);
        }
    }
}

/// Runs a reference file; returns the worst error of the traction over its largest value.
fn worst_reference_error(file: &str, law: f64, k_u: f64) -> f64 {
    let props = props(&[(LAW, law), (NORMAL_LAW, 0.0), (NORMAL_STIFFNESS, 1e4), (K_U, k_u), (K_F, 950.0), (P_0, 1e3)]);
    let table = Table::read(file);
    let [g, p, t, kappa] = ["g", "p", "t_total", "kappa"].map(|name| table.column(name));
    let largest = table.rows.iter().fold(0.0_f64, |m, row| m.max(row[t].abs()));
    let mut contact = ContactPoint::<BondSlip>::virgin(&props, 2);
    let mut sliding = SlidingPoint::<BondSlip>::virgin(&props, 1);
    let (mut worst, mut slip) = (0.0_f64, 0.0);
    for row in &table.rows {
        let traction = contact.advance(&[row[p] / 1e4, row[g], 0.0]).traction[1];
        worst = worst.max((traction - row[t]).abs() / largest);
        assert_eq!(contact.state("kappa"), row[kappa]);
        let sliding_traction = sliding.advance([row[g] - slip, 0.0], row[p]).traction[0];
        slip = sliding.state[0];
        // the sum of the increments rounds: k_e times a few units in the last place of the slip
        assert!((sliding_traction - row[t]).abs() <= 1e-13 * largest + 4.0 * 950.0 * f64::EPSILON * row[g].abs());
    }
    worst
}

#[test]
fn follows_the_forty_digit_references() {
    for (file, law, k_u) in [
        ("interface_A_monotonic_p0.csv", 0.0, 850.0),
        ("interface_A_cyclic_p0.csv", 0.0, 850.0),
        ("interface_B_monotonic_p0.csv", 1.0, 850.0),
        ("interface_B_cyclic_p10.csv", 1.0, 850.0),
    ] {
        let worst = worst_reference_error(file, law, k_u);
        println!("{file}: {worst:e}");
        assert!(worst <= 1e-13, "{file}: {worst:e}");
    }
}

/// `tests/reference/interface_constants.json`, rounded to doubles.
#[test]
fn joints_are_the_closed_forms() {
    let envelope = Envelope::powers(950.0, [1.5921, 0.0832], [0.87, -0.2678], 0.5).expect("chapter 8");
    let close = |value: f64, expected: f64| approx::assert_relative_eq!(value, expected, max_relative = 4e-15);
    close(envelope.critical_slip, 0.0009383090765017662);
    close(envelope.peak_slip, 0.17876236745123705);
    close(envelope.strength(envelope.critical_slip).traction, 0.8913936226766779);
    close(envelope.strength(envelope.peak_slip).traction, 1.3796207372299827);
    let residual_from = 7.911196138723711;
    assert!(envelope.strength(residual_from * (1.0 - 1e-12)).slope < 0.0);
    assert_eq!(envelope.strength(residual_from * (1.0 + 1e-12)), Strength { traction: 0.5, slope: 0.0 });
    // where the secant falls to 850: until there unloading follows it
    let secant_ends = 0.0010593373081630626;
    assert!(envelope.unloading_stiffness(secant_ends * (1.0 - 1e-12), 850.0).0 > 850.0);
    assert_eq!(envelope.unloading_stiffness(secant_ends * (1.0 + 1e-12), 850.0), (850.0, 0.0));
}

#[test]
fn soft_contact_follows_the_reference() {
    let props = props(&[]);
    let table = Table::read("soft_contact.csv");
    let [gap, expected] = ["gN", "tN_corrected_p0_2_g0_0.05"].map(|name| table.column(name));
    let largest = table.rows.iter().fold(0.0_f64, |m, row| m.max(row[expected].abs()));
    for row in &table.rows {
        let point = ContactPoint::<BondSlip>::virgin(&props, 1);
        let pressure = point.trial(&[-row[gap], 0.0, 0.0]).0.traction[0];
        // also small pressures to their own size: p loses what 1 - gap/g_0 loses
        let tolerance = (1e-13 * largest).min(1e-12 * row[expected].abs() + 1e-15);
        assert!((pressure + row[expected]).abs() <= tolerance, "{pressure} at {}", row[gap]);
    }
}

#[test]
fn extremes_stay_finite_and_dissipate() {
    let monotone = ["kappa", "d", "dissipated_energy"];
    for exponent in [-16, -12, -8, -6, -4, -3, -2, -1, 0, 1, 2, 3] {
        for (law, mu, p_0) in [(0.0, 0.0, 1e-3), (0.0, 2.0, 1e3), (1.0, 2.0, 1e-3), (1.0, 0.1, 1e3), (2.0, 2.0, 1.0)] {
            for normal_law in [0.0, 1.0] {
                let set = [(LAW, law), (MU, mu), (P_0, p_0), (NORMAL_LAW, normal_law), (NORMAL_STIFFNESS, 1e4)];
                let props = props(&[&set[..], &[(DELTA_N, 1e-3)]].concat());
                let size = Sizes { slip: 10_f64.powi(exponent), ..sizes(&props) };
                check_contact_invariants::<BondSlip>(&props, 3, size, 10, &monotone);
            }
        }
    }
}
