//! Coordinates, elastic corrections, reading of curves, uncertainty of a problem with a closed form.

use super::curve::LoadSlipCurve;
use super::geometry::{SlipAt, TestFibre};
use super::law::{BondSlipLaw, Piecewise, Powers};
use super::simulation::Weights;
use super::uncertainty::uncertainty;
use approx::assert_relative_eq;
use nalgebra::{DMatrix, DVector};
use std::f64::consts::PI;

const POWERS: BondSlipLaw =
    BondSlipLaw::Powers(Powers { elastic_stiffness: 400.0, rise: [3.44, 0.13865], fall: [1.0, -0.1772] });

fn lines() -> BondSlipLaw {
    BondSlipLaw::Piecewise(Piecewise { points: vec![[0.004, 1.6], [0.02, 2.0], [0.3, 1.2], [2.0, 0.7]] })
}

fn fibre() -> TestFibre {
    TestFibre { diameter: 0.406, embedded_length: 12.2, free_length: 3.0, youngs_modulus: 210e3 }
}

#[test]
fn coordinates_and_back_is_the_same_law() {
    for law in [POWERS, lines()] {
        let back = law.at(&law.coordinates());
        for (a, b) in law.quantities().iter().zip(back.quantities()) {
            assert_relative_eq!(a.value, b.value, max_relative = 1e-12);
        }
    }
}

#[test]
fn any_coordinates_make_a_law() {
    for law in [POWERS, lines()] {
        let coordinates = law.coordinates();
        for k in 0..coordinates.len() {
            for step in [-3.0, -0.5, 0.7, 4.0] {
                let mut moved = coordinates.clone();
                moved[k] += step;
                let moved = law.at(&moved);
                assert!(moved.tractions(&[0.0, 1e-3, 1.0], 0.0).is_ok(), "coordinate {k} {step:+}: {moved:?}");
            }
        }
    }
}

/// An elastic fibre in an elastic bond: P = EA β tanh(βL) u (docs/theory/verification.md).
#[test]
fn the_elastic_stiffness_is_that_of_a_fibre_that_stretches() {
    let fibre = fibre();
    let axial = fibre.axial_stiffness();
    for stiffness in [1.0, 400.0, 20e3] {
        let beta = (stiffness * PI * fibre.diameter / axial).sqrt();
        let flexibility = 1.0 / (axial * beta * (beta * fibre.embedded_length).tanh());
        let mean = flexibility - fibre.embedded_length / (3.0 * axial);
        let apparent = 1.0 / (PI * fibre.diameter * fibre.embedded_length * mean);
        // a long fibre in a stiff bond: what is left of the mean slip is below 0, and so says nothing
        if apparent > 0.0 {
            assert_relative_eq!(fibre.elastic_stiffness(apparent), stiffness, max_relative = 1e-6);
        }
    }
}

#[test]
fn uniform_traction_comes_back_from_the_exit_and_from_the_grip() {
    let fibre = fibre();
    let traction = 0.02;
    let slips: Vec<f64> = (1..=20).map(|k| 0.1 * f64::from(k)).collect();
    let load = |mean: f64| traction * PI * fibre.diameter * (fibre.embedded_length - mean);
    let at_exit = |mean: f64| mean + load(mean) * fibre.embedded_length / (3.0 * fibre.axial_stiffness());
    let at_grip = |mean: f64| at_exit(mean) + load(mean) * fibre.free_length / fibre.axial_stiffness();
    for (slip_at, slip_of) in [(SlipAt::Exit, &at_exit as &dyn Fn(f64) -> f64), (SlipAt::Grip, &at_grip)] {
        let curve = LoadSlipCurve {
            slips: slips.iter().map(|&mean| slip_of(mean)).collect(),
            loads: slips.iter().map(|&mean| load(mean)).collect(),
        };
        for (point, mean) in fibre.mean_bond(&curve, slip_at).iter().zip(&slips) {
            assert_relative_eq!(point.slip, *mean, max_relative = 1e-12);
            assert_relative_eq!(point.traction, traction, max_relative = 1e-12);
        }
    }
}

#[test]
fn balanced_weights_count_both_branches_the_same() {
    let curve = LoadSlipCurve { slips: vec![0.1, 0.2, 0.3, 0.4, 0.5, 0.6], loads: vec![1.0, 5.0, 4.0, 3.0, 2.0, 1.0] };
    let weights = Weights::Balanced.of(&curve);
    assert_relative_eq!(weights[..2].iter().sum::<f64>(), 3.0);
    assert_relative_eq!(weights[2..].iter().sum::<f64>(), 3.0);
    assert_eq!(Weights::Equal.of(&curve), [1.0; 6]);
}

/// A law of which only one coordinate, ln τ_p, changes the rows, all by the same: the mean of m measurements.
#[test]
fn the_standard_error_of_a_mean() {
    let rows = 50;
    let mut jacobian = DMatrix::zeros(rows, 5);
    jacobian.column_mut(0).fill(1.0);
    let residuals = DVector::from_fn(rows, |k, _| if k % 2 == 0 { 0.02 } else { -0.02 });
    let found = uncertainty(&POWERS, &residuals, &jacobian, &vec![1.0; rows]);
    let names: Vec<String> = POWERS.quantities().into_iter().map(|quantity| quantity.name).collect();
    let estimate = |name: &str| found.estimates[names.iter().position(|other| other == name).expect(name)];
    let peak = estimate("tau_peak");
    let variance = rows as f64 * 4e-4 / (rows - 5) as f64;
    assert_relative_eq!(peak.relative(), (variance / rows as f64).sqrt(), max_relative = 1e-6);
    // nothing determines where the peak is
    let place = estimate("g_peak");
    assert!(place.standard_error.is_infinite() && !place.is_identifiable());
}

#[test]
fn curves_are_read_by_name_by_habit_or_by_place() {
    let folder = tempfile::tempdir().expect("a folder");
    let file = folder.path().join("curve.csv");
    let rows: String =
        (0..20).map(|k| format!("{k},{},{},9\n", 0.1 * f64::from(k), f64::from(10 - (k - 10_i32).abs()))).collect();
    let read = |header: &str, slip: Option<&str>, load: Option<&str>| {
        std::fs::write(&file, format!("# a test\n{header}\n{rows}")).expect("a file");
        LoadSlipCurve::read(&file, slip, load)
    };
    let habit = read("n,slip,load,x", None, None).expect("a curve");
    assert_eq!((habit.slips[3], habit.loads[3]), (0.1 * 3.0, 3.0));
    assert_eq!(read("n,w,P,x", Some("w"), Some("P")).expect("a curve"), habit);
    assert_eq!(read("n,w,P,x", None, Some("P")).expect("a curve").slips[3], 3.0);
    for (problem, header, slip, load) in [
        ("line 1: no column is called 'Q'", "n,w,P,x", Some("w"), Some("Q")),
        ("would both be the column 'w'", "n,w,P,x", Some("w"), Some("w")),
        ("line 14: the slip falls back", "n,w,P,x", Some("P"), Some("n")),
        ("the load still rises", "n,w,P,x", None, None),
    ] {
        let problems = read(header, slip, load).expect_err(problem);
        assert!(problems.concat().contains(problem), "{problems:?}");
    }
}

/// Data in kN and metres, and fits that miss the data, are reported.
#[test]
fn other_units_and_poor_fits_are_doubted() {
    let data = [("traction", 0.003, "MPa", [0.05, 100.0]), ("slip", 2.0, "mm", [0.05, 100.0])];
    let doubts = super::doubt::doubts(&data, [("powers", 0.02), ("piecewise", 0.62)]);
    let [units, poor] = &doubts[..] else { panic!("{doubts:?}") };
    assert!(units.starts_with("traction = 0.003 MPa is outside") && units.ends_with("N, mm, MPa?"), "{units}");
    assert!(poor.starts_with("piecewise: the fit misses the data by 62 %"), "{poor}");
    assert_eq!(super::doubt::doubts(&data[1..], [("", 0.2)]), Vec::<String>::new());
}
