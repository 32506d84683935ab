use super::*;
use approx::assert_relative_eq;
use rand_distr::{Distribution, StandardNormal};

const CHECKED: [f64; 7] = [0.1, 0.2, 0.5, 1.0, 1.5, 2.0, 2.5];

fn laws() -> [(&'static str, Polyline); 4] {
    let pulled_out = pulled_out(fibre(), &Orientation::Random3d).law_to(15.0, 300);
    [
        ("constant", Polyline::new([(0.0, 1.0), (5.0, 1.0)])),
        ("linear", Polyline::new([(0.0, 1.5), (3.75, 0.0), (5.0, 0.0)])),
        ("C2", pulled_out),
        ("drop and rise", Polyline::new([(0.0, 3.0), (0.02, 1.2), (0.1, 0.9), (1.0, 1.5), (2.0, 1.3), (5.0, 0.5)])),
    ]
}

fn test_of(law: &Polyline, matrix: &Matrix, noise: f64, seed: u64) -> Vec<[f64; 2]> {
    let section = [SectionLaw::new(matrix, law, 62.5)];
    let beam = Beam::new(NotchedBeam::default(), &section, matrix);
    let mut random = rand_pcg::Pcg64::new(u128::from(seed), 0);
    (0..400)
        .map(|k| 0.015 + 3.6 * (f64::from(k) / 399.0).powf(1.7))
        .map(|cmod| {
            let deviate: f64 = StandardNormal.sample(&mut random);
            [cmod, beam.at(cmod).force * (1.0 + noise * deviate)]
        })
        .collect()
}

#[test]
fn laws_come_back_from_noisy_beams() {
    for (name, law) in laws() {
        let rows = test_of(&law, &matrix(), 0.02, 7);
        let fit = full_inverse(&NotchedBeam::default(), &matrix(), &Measured::Curve(rows)).expect("a fit");
        let error = |opening: f64| fit.law.at(opening) / law.at(opening) - 1.0;
        let worst = CHECKED.map(error).into_iter().fold(0.0, |a: f64, b| a.max(b.abs()));
        println!(
            "{name}: worst {worst:.4}, at 0.03 {:.4}, weight {}, RMS {:.4}",
            error(0.03),
            fit.weight,
            fit.fitted.rms
        );
        assert!(worst <= 0.05, "{name}: {:?}", CHECKED.map(error));
        assert!(error(0.03).abs() <= 0.10, "{name}: {}", error(0.03));
        // the computed curve against the one without noise
        let (exact, computed) = (test_of(&law, &matrix(), 0.0, 0), test_of(&fit.law, &fit.matrix, 0.0, 0));
        let greatest = exact.iter().map(|row| row[1]).fold(0.0, f64::max);
        let square: f64 = exact.iter().zip(&computed).map(|(a, b)| ((a[1] - b[1]) / greatest).powi(2)).sum();
        assert!((square / exact.len() as f64).sqrt() <= 0.01);
        // what is told and what is not
        assert_eq!(fit.fitted.estimates.len(), 2 + OPENINGS.len());
        assert!(fit.fitted.estimates[2 + 5].is_identifiable(), "{:?}", fit.fitted.estimates[7]);
    }
}

#[test]
fn the_rigid_hinge_is_near() {
    let linear = &laws()[1].1;
    let fast =
        fast_inverse(&NotchedBeam::default(), &Measured::Curve(test_of(linear, &matrix(), 0.0, 0))).expect("a law");
    // 1.13 for 1.17, derived from the same equation
    assert_relative_eq!(fast.at(1.0 * 125.0 / 150.0), 1.13, max_relative = 5e-3);
}

#[test]
fn strengths_alone_tell_four_stresses_if_the_matrix_is_known() {
    let softening = Matrix { softening: Softening::Exponential, fracture_energy: 0.04, ..matrix() };
    let rises = softening.added_to(&Polyline::new([(0.0, 0.5), (1.0, 1.5), (2.0, 1.3), (5.0, 0.5)]), 1.0);
    let [constant, linear, pulled_out, _] = laws();
    let laws =
        [(constant, matrix()), (linear, matrix()), (pulled_out, matrix()), (("drop and rise", rises), softening)];
    for ((name, law), matrix) in laws {
        let section = [SectionLaw::new(&matrix, &law, 62.5)];
        let residual = Beam::new(NotchedBeam::default(), &section, &matrix).residual();
        let fit = full_inverse(&NotchedBeam::default(), &matrix, &Measured::Strengths(residual)).expect("a fit");
        for opening in [0.4, 1.25, 2.1, 2.9] {
            let error = fit.law.at(opening) / law.at(opening) - 1.0;
            println!("{name} at {opening}: {error:.4}");
            assert!(error.abs() <= 0.10, "{name} at {opening}: {error}");
        }
    }
}

#[test]
fn bond_and_snubbing_come_back_where_fibres_break() {
    let start = Closed { tau: 2.0, ..friction(Debonding::Rigid, Sliding::Shortening) };
    let fit = |fibre: Fibre| {
        let made = pulled_out(fibre, &Orientation::Random3d);
        let target: Vec<[f64; 2]> =
            [0.05, 0.5, 1.0, 2.0, 4.0, 8.0].map(|opening| [opening, made.average(opening).stress]).into();
        bond_from_bridging(&fibre, 0.01, &Orientation::Random3d, Sides::One, (&start, 0.3), &target).expect("a fit")
    };
    let breaking = fit(Fibre { strength: Some(500.0), rupture_f: 0.3, ..fibre() });
    assert_relative_eq!(breaking.estimates[0].value, 3.0, max_relative = 1e-4);
    assert_relative_eq!(breaking.estimates[1].value, 0.5, max_relative = 1e-3);
    // without rupture only g(f) τ is told
    let whole = fit(fibre());
    let g = |f: f64| 2.0 * (1.0 + (0.5 * std::f64::consts::PI * f).exp()) / (4.0 + f * f);
    assert_eq!(whole.estimates.len(), 1, "f is not sought where nothing tells it");
    assert_relative_eq!(whole.estimates[0].value * g(0.3), 3.0 * g(0.5), max_relative = 1e-6);
    assert!(whole.estimates[0].is_identifiable());
}

#[test]
fn tests_that_are_none_are_refused() {
    let refused = |test: Measured| fast_inverse(&NotchedBeam::default(), &test).expect_err("no test").to_string();
    assert!(refused(Measured::Curve(vec![[0.1, 1.0]; 3])).contains("rise"));
    assert!(refused(Measured::Curve(vec![[0.1, 1.0], [0.2, 1.0]])).contains("12 points"));
    assert!(refused(Measured::Strengths(Residual::default())).contains("above 0"));
}
