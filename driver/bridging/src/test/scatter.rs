use super::*;
use approx::assert_relative_eq;

fn mean_and_deviation(values: &[f64]) -> (f64, f64) {
    let mean = values.iter().sum::<f64>() / values.len() as f64;
    let variance = values.iter().map(|value| (value - mean).powi(2)).sum::<f64>() / (values.len() - 1) as f64;
    (mean, variance.sqrt())
}

fn openings(end: f64, count: usize) -> Vec<f64> {
    (0..count).map(|k| end * (k as f64 / (count - 1) as f64).powi(2)).collect()
}

#[test]
fn scatter_of_the_first_load_is_that_of_a_compound_poisson_sum() {
    // CV² = (4/3) g(2f)/g(f)²/N̄
    let fibre = Fibre { diameter: 0.75, ..fibre() };
    let bond = Bond::Closed(friction(Debonding::Rigid, Sliding::Shortening));
    for (f, seed) in [(0.0, 3), (0.5, 4)] {
        let single = BridgingFibre::new(fibre, &bond, Inclination::Exp { f }, Sides::One, 0.0).expect("a fibre");
        let composite = Composite::new(single, 0.005, &Orientation::Random3d, matrix(), 0.0).expect("a composite");
        let number = composite.fibres_per_area() * 150.0 * 125.0;
        assert_relative_eq!(number, 106.1, epsilon = 0.05);
        let g = |f: f64| 2.0 * (1.0 + (0.5 * std::f64::consts::PI * f).exp()) / (4.0 + f * f);
        let expected = (4.0 / 3.0 * g(2.0 * f) / (g(f) * g(f)) / number).sqrt();
        let settings = Scatter { beams: 4000, bond_cv: 0.0, strength_cv: 0.0, strips: 1, seed };
        let beams = scatter(&composite, &NotchedBeam::default(), &openings(15.0, 10), &[], &settings, &|| false)
            .expect("sense")
            .expect("beams");
        let loads: Vec<f64> = beams.bridging.iter().map(|beam| beam[0]).collect();
        let (mean, deviation) = mean_and_deviation(&loads);
        let of_mean = deviation / (4000.0_f64).sqrt();
        assert!((mean - composite.average(0.0).stress).abs() < 3.0 * of_mean);
        // the standard error of a deviation
        let of_deviation = expected / (2.0 * 4000.0_f64).sqrt();
        println!("f {f}: CV {:.4}, expected {expected:.4} ± {of_deviation:.4}", deviation / mean);
        assert!((deviation / mean - expected).abs() < 3.0 * of_deviation);
        let counts: Vec<f64> = beams.fibres.iter().map(|&count| count as f64).collect();
        let (mean, deviation) = mean_and_deviation(&counts);
        assert!((mean - number).abs() < 3.0 * deviation / (4000.0_f64).sqrt());
    }
}

#[test]
fn means_are_those_of_the_quadrature_at_all_openings() {
    let fibre = Fibre { strength: Some(800.0), rupture_f: 0.3, ..fibre() };
    let composite = pulled_out(fibre, &Orientation::Random3d);
    let settings = Scatter { beams: 1000, bond_cv: 0.0, strength_cv: 0.0, strips: 5, seed: 11 };
    let openings = openings(15.0, 40);
    let beams = scatter(&composite, &NotchedBeam::default(), &openings, &[], &settings, &|| false)
        .expect("sense")
        .expect("beams");
    for k in [0, 5, 15, 25] {
        let (mean, deviation) = mean_and_deviation(&beams.bridging.iter().map(|beam| beam[k]).collect::<Vec<_>>());
        let expected = composite.average(openings[k]).stress;
        assert!((mean - expected).abs() < 3.0 * deviation / 1000.0_f64.sqrt(), "{mean} {expected} at {}", openings[k]);
    }
}

#[test]
fn any_number_of_threads_makes_the_same_beams() {
    let composite = pulled_out(fibre(), &Orientation::Planar);
    let settings = Scatter { beams: 20, strength_cv: 0.1, ..Scatter::default() };
    let with = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("threads");
        pool.install(|| {
            scatter(&composite, &NotchedBeam::default(), &openings(4.0, 30), &[0.5, 2.5], &settings, &|| false)
                .expect("sense")
                .expect("beams")
        })
    };
    assert_eq!(with(1), with(3));
    let other = scatter(
        &composite,
        &NotchedBeam::default(),
        &openings(4.0, 30),
        &[0.5, 2.5],
        &Scatter { seed: 2, ..settings },
        &|| false,
    );
    assert_ne!(with(1), other.expect("sense").expect("beams"));
}

#[test]
fn strengths_of_beams_lie_about_that_of_the_mean_law() {
    let composite = pulled_out(fibre(), &Orientation::Random3d);
    let settings = Scatter { beams: 300, ..Scatter::default() };
    let beams = scatter(&composite, &NotchedBeam::default(), &openings(4.0, 60), &[], &settings, &|| false)
        .expect("sense")
        .expect("beams");
    let law = composite.law_to(4.0, 200);
    let section = [SectionLaw::new(&matrix(), &law, 62.5)];
    let mean = LayeredBeam::new(NotchedBeam::default(), &section, &matrix()).residual();
    for j in 0..4 {
        let values: Vec<f64> = beams.residual.iter().map(|residual| residual.residual[j]).collect();
        let (average, deviation) = mean_and_deviation(&values);
        assert_relative_eq!(average, mean.residual[j], max_relative = 0.02);
        assert!(quantile(&values, 0.05) < average - deviation && quantile(&values, 0.5) > average - deviation);
    }
}

#[test]
fn quantiles_lie_between_order_statistics() {
    assert_eq!(quantile(&[3.0, 1.0, 2.0], 0.5), 2.0);
    assert_eq!(quantile(&[1.0, 2.0], 0.25), 1.25);
    assert!(quantile(&[], 0.5).is_nan());
}

#[test]
fn beams_are_not_made_any_more_once_that_is_wanted() {
    use std::sync::atomic::{AtomicUsize, Ordering};
    let composite = pulled_out(fibre(), &Orientation::Random3d);
    let settings = Scatter { beams: 100_000, ..Scatter::default() };
    let asked = AtomicUsize::new(0);
    let is_stopped = || asked.fetch_add(1, Ordering::Relaxed) >= 3;
    let beams = scatter(&composite, &NotchedBeam::default(), &openings(4.0, 10), &[], &settings, &is_stopped);
    assert!(beams.expect("sense").is_none());
    assert!(asked.load(Ordering::Relaxed) < 1000, "{asked:?}");
}
