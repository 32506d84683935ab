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
    let beam = LayeredBeam::new(NotchedBeam::default(), &section, matrix);
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
        let fit =
            full_inverse(&NotchedBeam::default(), &matrix(), &MeasuredBeam::Curve(rows), Shape::Smooth).expect("a fit");
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
        // what the data determine and what they do not
        assert_eq!(fit.fitted.estimates.len(), 2 + OPENINGS.len());
        assert!(fit.fitted.estimates[2 + 5].is_identifiable(), "{:?}", fit.fitted.estimates[7]);
    }
}

#[test]
fn the_rigid_hinge_is_near() {
    let linear = &laws()[1].1;
    let fast =
        fast_inverse(&NotchedBeam::default(), &MeasuredBeam::Curve(test_of(linear, &matrix(), 0.0, 0))).expect("a law");
    // 1.13 for 1.17, derived from the same equation
    assert_relative_eq!(fast.at(1.0 * 125.0 / 150.0), 1.13, max_relative = 5e-3);
}

fn of_strengths(matrix: &Matrix, beams: Vec<Residual>, shape: Shape) -> BridgingFit {
    full_inverse(&NotchedBeam::default(), matrix, &MeasuredBeam::Strengths(beams), shape).expect("a fit")
}

#[test]
fn strengths_alone_determine_four_stresses_if_the_matrix_is_known() {
    let softening = Matrix { softening: Softening::Exponential, fracture_energy: 0.04, ..matrix() };
    let rises = softening.added_to(&Polyline::new([(0.0, 0.5), (1.0, 1.5), (2.0, 1.3), (5.0, 0.5)]), 1.0);
    let [constant, linear, pulled_out, _] = laws();
    let laws =
        [(constant, matrix()), (linear, matrix()), (pulled_out, matrix()), (("drop and rise", rises), softening)];
    for ((name, law), matrix) in laws {
        let section = [SectionLaw::new(&matrix, &law, 62.5)];
        let residual = LayeredBeam::new(NotchedBeam::default(), &section, &matrix).residual();
        let fit = of_strengths(&matrix, vec![residual], Shape::Smooth);
        println!("{name}: weight {}, f_t {:.4}, {:?}", fit.weight, fit.matrix.ft, fit.fitted.parameters);
        for opening in [0.4, 1.25, 2.1, 2.9] {
            let error = fit.law.at(opening) / law.at(opening) - 1.0;
            println!("{name} at {opening}: {error:.4}");
            assert!(error.abs() <= 0.10, "{name} at {opening}: {error}");
        }
    }
}

/// The hinge model by layers of its own: f_R1–4 of σ(w), the matrix elastic in compression.
fn by_layers(modulus: f64, ft: f64, law: &dyn Fn(f64) -> f64) -> [f64; 4] {
    const LAYERS: usize = 600;
    let (height, notch, hinge) = (125.0, 25.0, 62.5);
    let halved = |f: &dyn Fn(f64) -> f64, mut low: f64, mut high: f64| {
        for _ in 0..60 {
            let middle = 0.5 * (low + high);
            if f(middle) < 0.0 { low = middle } else { high = middle }
        }
        0.5 * (low + high)
    };
    let stress = |u: f64| {
        if u <= ft * hinge / modulus {
            return modulus * u / hinge;
        }
        law(halved(&|w| w + hinge * law(w) / modulus - u, 0.0, u))
    };
    RESIDUAL_CMOD.map(|cmod| {
        let sums = |rotation: f64| {
            let mouth = cmod - notch * rotation;
            let axis = height - (mouth + hinge * law(mouth) / modulus) / rotation;
            let layer = |k: usize| {
                let y = height * (k as f64 + 0.5) / LAYERS as f64;
                let stress = stress(rotation * (y - axis));
                (stress, stress * y)
            };
            let add = |sum: (f64, f64), one: (f64, f64)| (sum.0 + one.0, sum.1 + one.1);
            (0..LAYERS).map(layer).fold((0.0, 0.0), add)
        };
        // the more it turns the higher the axis, and the more is pressed
        let rotation = halved(&|rotation| -sums(rotation).0, 0.5 * cmod / 150.0, 1.5 * cmod / 150.0);
        6.0 * sums(rotation).1 / LAYERS as f64 / height
    })
}

/// 40 kg/m³ of 60/0.75 in C30/37: a case's strengths without noise, and what σ(w) they are of.
#[test]
fn strengths_of_a_case_lead_back_to_its_law() {
    let matrix =
        Matrix { modulus: 32e3, ft: 2.9, softening: Softening::Hordijk, fracture_energy: 0.14, fc: Some(38.0) };
    let tested = Residual { limit: 5.532964, residual: [3.606907, 3.308538, 3.188161, 3.073685] };
    let fit = of_strengths(&matrix, vec![tested], Shape::Smooth);
    println!("case: weight {}, f_t {:.4}, {:?}", fit.weight, fit.matrix.ft, fit.fitted.parameters);
    for (opening, right) in [(0.4, 1.170), (1.25, 1.104), (2.1, 1.040), (2.9, 0.981)] {
        println!("{opening}: {:.4}", fit.law.at(opening) / right - 1.0);
        assert_relative_eq!(fit.law.at(opening), right, max_relative = 0.03);
    }
    assert!(fit.fitted.reached && fit.fitted.rms < 5e-3, "{}", fit.fitted.rms);
}

#[test]
fn equal_strengths_are_an_even_law() {
    let matrix =
        Matrix { modulus: 35e3, ft: 3.5, softening: Softening::Hordijk, fracture_energy: 0.146, fc: Some(48.0) };
    let tested = Residual { limit: 5.0, residual: [3.0; 4] };
    for shape in [Shape::Smooth, Shape::Bilinear] {
        let fit = of_strengths(&matrix, vec![tested], shape);
        println!("equal {shape:?}: weight {}, {:?} {}", fit.weight, fit.fitted.parameters, fit.fitted.rms);
        // f_R/3, except for a zone of compression
        for opening in [0.4, 1.25, 2.1, 2.9] {
            println!("{opening}: {:.4}", fit.law.at(opening));
            assert_relative_eq!(fit.law.at(opening), 1.0, max_relative = 0.035);
        }
    }
}

/// Strengths by layers of their own, without noise and with 5 % of it.
#[test]
fn laws_come_back_from_strengths_by_layers() {
    let softening = Matrix { softening: Softening::Exponential, fracture_energy: 0.06, ..matrix() };
    let taken_over = |w: f64, fibres: f64| {
        let part = (-w * 3.0 / 0.06_f64).exp();
        3.0 * part + (1.0 - part) * fibres
    };
    type Law<'f> = (&'f str, &'f dyn Fn(f64) -> f64);
    let laws: [Law<'_>; 4] = [
        ("even", &|_| 1.1),
        ("falls", &|w| 1.5 * (-w / 2.5_f64).exp()),
        ("rises and falls", &|w| 1.6 * (0.4 + w) * (-0.9 * w).exp() + 0.2),
        ("straight", &|w| 2.0 - 0.5 * w),
    ];
    for (name, fibres) in laws {
        let law = |w: f64| taken_over(w, fibres(w));
        let residual = by_layers(softening.modulus, softening.ft, &law);
        let fit = of_strengths(&softening, vec![Residual { limit: 4.5, residual }], Shape::Smooth);
        println!("{name}: weight {} {:?}", fit.weight, fit.fitted.parameters);
        for opening in [0.4, 1.25, 2.1, 2.9] {
            let error = fit.law.at(opening) / law(opening) - 1.0;
            println!("{name} at {opening}: {error:.4}");
            assert!(error.abs() <= 0.03, "{name} at {opening}: {error}");
        }
        // of the law's greatest stress once the matrix is spent
        let greatest = [0.4, 0.7, 1.25, 2.1, 2.9].map(law).into_iter().fold(0.0, f64::max);
        let mut random = rand_pcg::Pcg64::new(5, 0);
        let (mut worst, mut squares, count) = (0.0_f64, 0.0, 8);
        for _ in 0..count {
            let noisy = residual.map(|strength| {
                let deviate: f64 = StandardNormal.sample(&mut random);
                strength * (1.0 + 0.05 * deviate)
            });
            let fit = of_strengths(&softening, vec![Residual { limit: 4.5, residual: noisy }], Shape::Smooth);
            let sigma = &fit.fitted.parameters[2..];
            let peak = (0..sigma.len()).max_by(|&i, &j| sigma[i].total_cmp(&sigma[j])).expect("stresses");
            assert!(sigma.iter().all(|stress| *stress >= -1e-9), "{sigma:?}");
            assert!(sigma[..=peak].is_sorted_by(|a, b| *a <= b + 1e-9), "{sigma:?}");
            assert!(sigma[peak..].is_sorted_by(|a, b| b - 1e-9 <= *a), "{sigma:?}");
            for opening in [0.4, 1.25, 2.1, 2.9] {
                let error = (fit.law.at(opening) - law(opening)) / greatest;
                squares += error * error;
                worst = worst.max(error.abs());
            }
        }
        let rms = (squares / f64::from(4 * count)).sqrt();
        println!("{name}, noise: RMS {rms:.4}, worst {worst:.4}");
        assert!(rms <= 0.12, "{name}: {rms}");
    }
}

#[test]
fn bond_and_snubbing_come_back_where_fibres_break() {
    let start = Closed { tau: 2.0, ..friction(Debonding::Rigid, Sliding::Shortening) };
    let fit = |fibre: Fibre| {
        let made = pulled_out(fibre, &Orientation::Random3d);
        let target: Vec<[f64; 2]> =
            [0.05, 0.5, 1.0, 2.0, 4.0, 8.0].map(|opening| [opening, made.average(opening).stress]).into();
        let composite = |sought: &[f64]| {
            let bond = Bond::Closed(Closed { tau: sought[0], ..start.clone() });
            let fibre = BridgingFibre::new(fibre, &bond, Inclination::Exp { f: sought[1] }, Sides::One, 0.0)?;
            Composite::new(fibre, 0.01, &Orientation::Random3d, matrix(), 0.0)
        };
        let sought = SoughtBond { composite: &composite, start: &[start.tau, 0.3] };
        bond_from_bridging(&sought, &target).expect("a fit")
    };
    let breaking = fit(Fibre { strength: Some(500.0), rupture_f: 0.3, ..fibre() });
    assert_relative_eq!(breaking.estimates[0].value, 3.0, max_relative = 1e-4);
    assert_relative_eq!(breaking.estimates[1].value, 0.5, max_relative = 1e-3);
    // without rupture only g(f) τ can be determined
    let whole = fit(fibre());
    let g = |f: f64| 2.0 * (1.0 + (0.5 * std::f64::consts::PI * f).exp()) / (4.0 + f * f);
    assert_eq!(whole.estimates.len(), 1, "f is not sought where nothing determines it");
    assert_relative_eq!(whole.estimates[0].value * g(0.3), 3.0 * g(0.5), max_relative = 1e-6);
    assert!(whole.estimates[0].is_identifiable());
}

#[test]
fn tests_that_are_none_are_refused() {
    let refused = |test: MeasuredBeam| fast_inverse(&NotchedBeam::default(), &test).expect_err("no test").to_string();
    assert!(refused(MeasuredBeam::Curve(vec![[0.1, 1.0]; 3])).contains("rise"));
    assert!(refused(MeasuredBeam::Curve(vec![[0.1, 1.0], [0.2, 1.0]])).contains("12 points"));
    assert!(refused(MeasuredBeam::Strengths(vec![Residual::default()])).contains("above 0"));
}
