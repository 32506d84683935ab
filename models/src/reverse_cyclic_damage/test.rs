use super::*;
use approx::assert_relative_eq;
use battery::energy::{check_frozen_damage, imbalance};
use battery::pages::{PARAMETERS, STATES};
use battery::peak::Uniaxial;
use battery::samples::reverse_cyclic_damage::*;
use battery::{PATH_COUNTS, Point, Promises, Random, STRESS_STATES, Sample, battery, reference, rotated};

#[test]
fn agrees_with_40_digits() {
    for (set, props, paths) in [
        ("III_s525", &S525, &["cyclic", "shear", "unitens"][..]),
        (
            "III_t51",
            &T51,
            &["bi_t1_055", "bi_t1_1", "cyclic", "psr_unitens", "shear", "unicomp", "unicomp_lat", "unitens"],
        ),
        ("IIIR_t51", &T51_REGULAR, &["bi_t1_055", "bi_t1_1", "cyclic", "shear", "unicomp", "unitens"]),
    ] {
        for path in paths {
            let stress_state = if path.starts_with("psr") { StressState::PlaneStress } else { StressState::ThreeD };
            let file = format!("{set}_{path}.csv");
            let (error, rows) =
                reference::check::<ReverseCyclicDamage>(&file, stress_state, props, &[("D_t", 0), ("D_c", 1)]);
            println!("{file}: {rows} rows, {error:.1e}");
            assert!(rows >= 127);
        }
    }
}

/// Properties that a variant guarantees.
fn promises(regular: bool) -> Promises<'static> {
    let is_regular = |sample: &Sample<'_>| sample.props[8] == 1.0;
    Promises {
        samples: Sample::all(&SETS).into_iter().filter(|sample| is_regular(sample) == regular).collect(),
        histories: 200,
        monotone: &["eta_t", "eta_c", "Y_t_max", "Y_c_max"],
        dissipative: true,
        steady: true,
        history: &["eta_t", "eta_c"],
        elastic_strain: |sample| if sample.props[4] > 0.0 { 1e-5 * sample.size } else { 0.0 },
        path_ends: &[[1.0, -4.0, 0.3, 1.2, 0.0, 0.0]],
        random_paths: [20, 2],
        path_counts: |_, _| &PATH_COUNTS,
    }
}

battery!(thesis: ReverseCyclicDamage, promises(false), pages: ["reverse_cyclic_damage/doc.md": &[PARAMETERS, STATES]]);
battery!(regular: ReverseCyclicDamage, promises(true));

#[test]
fn work_is_stored_or_dissipated() {
    for stress_state in STRESS_STATES {
        // the thesis variant's stress jumps cost an error of first order
        for (props, size, order) in [(T51, 4e-4, 1), (T51_REGULAR, 4e-4, 2), (S525, 0.1, 1)] {
            let coarse = imbalance::<ReverseCyclicDamage>(&props, stress_state, size, 20, 100).absolute;
            let fine = imbalance::<ReverseCyclicDamage>(&props, stress_state, size, 20, 1600).absolute;
            let (bound, drop) = if order == 2 { (1e-5, 100.0) } else { (1e-3, 8.0) };
            assert!(fine < bound && fine < coarse / drop, "{stress_state:?} {props:?}: {coarse:e}, {fine:e}");
        }
        let regular = check_frozen_damage::<ReverseCyclicDamage>(&T51_REGULAR, stress_state, 2e-3, 50, (200, 1e-4));
        let thesis = check_frozen_damage::<ReverseCyclicDamage>(&T51, stress_state, 2e-3, 50, (2000, 2e-3));
        assert!(regular > 20 && thesis > 20);
    }
}

#[test]
fn peaks_are_those_of_the_closed_form() {
    // docs/theory/peaks.md
    let uniaxial: &[usize] = &[1, 2];
    use StressState::{PlaneStress, ThreeD};
    for (props, stress_state, free, end, stress, strain) in [
        (T51, ThreeD, uniaxial, 2e-4, 3.4345, 1.092e-4),
        (T51, ThreeD, &[1], 2e-4, 3.5509, 1.092e-4),
        (T51, PlaneStress, &[1], 2e-4, 3.5225, 1.122e-4),
        // lateral strain 0
        (T51, PlaneStress, &[], -4e-3, -28.134, -1.621e-3),
        (T51_REGULAR, ThreeD, uniaxial, 4e-4, 3.6862, 1.176e-4),
    ] {
        let (peak, at) = Uniaxial::<ReverseCyclicDamage>::new(&props, stress_state, free).peak(end, 200);
        assert_relative_eq!(peak, stress, max_relative = 2e-5);
        assert_relative_eq!(at, strain, max_relative = 2e-3);
    }
}

/// The regular variant's sides split at about −5e-4 (the lateral strain jumps); the peak comes after.
#[test]
fn free_sided_compression_of_the_regular_variant_peaks_after_splitting() {
    let mut bar = Uniaxial::<ReverseCyclicDamage>::new(&T51_REGULAR, StressState::ThreeD, &[1, 2]);
    bar.ratio = -0.49;
    let (peak, at) = bar.peak_between(-1.2e-3, -2.4e-3);
    assert_relative_eq!(peak, -25.533, max_relative = 2e-5);
    assert_relative_eq!(at, -1.784e-3, max_relative = 1e-3);
}

/// Uniaxial compression with free sides of the thesis variant ends where the lateral strain, not the
/// axial one, must be prescribed: for each, σ_lateral = 0 is linear in the axial strain.
#[test]
fn free_sided_compression_ends_at_the_lateral_instability() {
    let point = Point::<ReverseCyclicDamage>::virgin(&T51, StressState::ThreeD);
    let at = |lateral: f64| {
        let lateral_stress = |axial: f64| point.trial(&[axial, lateral, lateral, 0.0, 0.0, 0.0]).0.stress[1];
        let (a, b) = (-1e-4, -1e-3);
        let axial = a - lateral_stress(a) * (b - a) / (lateral_stress(b) - lateral_stress(a));
        (axial, point.trial(&[axial, lateral, lateral, 0.0, 0.0, 0.0]).0.stress[0])
    };
    let (axial, stress) =
        (1..40_000).map(|i| at(f64::from(i) * 2.5e-9)).min_by(|a, b| a.1.total_cmp(&b.1)).expect("candidates");
    assert_relative_eq!(axial, -3.845e-4, max_relative = 2e-4);
    assert_relative_eq!(stress, -11.723, max_relative = 5e-5);
}

#[test]
fn one_dimensional_reading_of_compression_is_the_thesis_claim() {
    // all lateral coupling off: ν = 0 and the uniaxial energy
    let props = [31800.0, 0.0, 5000.0, 1.3, 2e-4, 21.0, 1.05, 4e-4, 0.0];
    let (peak, at) = Uniaxial::<ReverseCyclicDamage>::new(&props, StressState::ThreeD, &[]).peak(-4e-3, 100);
    assert_relative_eq!(peak, -27.675, max_relative = 2e-5);
    assert_relative_eq!(at, -1.648e-3, max_relative = 1e-3);
}

/// Damages in tension and compression, then probes strains whose principal values nearly coincide.
#[test]
fn repeated_principal_strains_are_regular() {
    let mut random = Random::new(3);
    for props in [T51, T51_REGULAR] {
        let mut point = Point::<ReverseCyclicDamage>::virgin(&props, StressState::ThreeD);
        point.advance(&[4e-4, -2e-3, 1e-4, 0.0, 0.0, 0.0]);
        for base in [1e-4, -1e-3, 6e-4, -4e-3] {
            for other in [base, 5e-5, -3e-4] {
                let exact = point.trial(&[base, base, other, 0.0, 0.0, 0.0]).0;
                for split in [f64::EPSILON, 1e-16, 1e-14, 1e-12, 1e-10, 1e-8, 1e-6, 1e-4] {
                    let rotation = random.rotation();
                    let strain = [base * (1.0 + split), base, other, 0.0, 0.0, 0.0];
                    let turned = point.trial(&rotated(&strain, &rotation, 2.0)).0;
                    let straight = point.trial(&strain).0;
                    let stress = rotated(&straight.stress, &rotation, 1.0);
                    let scale = 31800.0 * base.abs();
                    for i in 0..6 {
                        assert!((turned.stress[i] - stress[i]).abs() <= 1e-14 * 31800.0 * base.abs().max(other.abs()));
                        assert!((straight.stress[i] - exact.stress[i]).abs() <= (3.0 * split + 1e-15) * scale);
                        for j in 0..6 {
                            // C is continuous there; its own slope with the strain is of order C/ε
                            let (value, limit) = (straight.tangent[i][j], exact.tangent[i][j]);
                            assert!((value - limit).abs() <= (30.0 * split + 1e-14) * 31800.0, "{value} {limit}");
                        }
                    }
                    // (σ_1 − σ_2)/(ε_1 − ε_2) is the in-plane shear modulus, twice
                    if split >= 1e-8 {
                        let quotient = (straight.stress[0] - straight.stress[1]) / (strain[0] - strain[1]);
                        assert_relative_eq!(2.0 * straight.tangent[3][3], quotient, max_relative = 1e-6);
                    }
                }
            }
        }
    }
}

#[test]
fn at_zero_the_thesis_variant_takes_the_mean() {
    let point = {
        let mut point = Point::<ReverseCyclicDamage>::virgin(&T51, StressState::ThreeD);
        point.advance(&[4e-4, -2e-3, 0.0, 0.0, 0.0, 0.0]);
        point
    };
    let third = |e: f64| point.trial(&[3e-4, -1e-3, e, 0.0, 0.0, 0.0]).0.stress[2];
    let (above, below) = (third(1e-18), third(-1e-18));
    assert!(above < below, "σ falls where ε becomes positive: {below} to {above}");
    assert_relative_eq!(third(0.0), 0.5 * (above + below), max_relative = 1e-12);
    // the regular variant does not jump
    let mut point = Point::<ReverseCyclicDamage>::virgin(&T51_REGULAR, StressState::ThreeD);
    point.advance(&[4e-4, -2e-3, 0.0, 0.0, 0.0, 0.0]);
    let third = |e: f64| point.trial(&[3e-4, -1e-3, e, 0.0, 0.0, 0.0]).0.stress[2];
    assert_relative_eq!(third(1e-18), third(-1e-18), max_relative = 1e-12);
}

#[test]
fn plane_strain_is_space_with_zero_strain_33() {
    for props in [T51, T51_REGULAR] {
        let mut plane = Point::<ReverseCyclicDamage>::virgin(&props, StressState::PlaneStrainOrAxisymmetric);
        let mut space = Point::<ReverseCyclicDamage>::virgin(&props, StressState::ThreeD);
        for strain in [[2e-4, -1e-3, 0.0, 3e-4, 0.0, 0.0], [-4e-4, 1e-4, 0.0, -1e-4, 0.0, 0.0]] {
            let (a, b) = (plane.advance(&strain), space.advance(&strain));
            assert_eq!(a.stress, b.stress);
            assert_eq!(a.tangent, b.tangent);
        }
    }
}

#[test]
fn frozen_tangent_of_the_regular_variant_is_positive() {
    let mut random = Random::new(5);
    for _ in 0..2000 {
        let mut point = Point::<ReverseCyclicDamage>::virgin(&T51_REGULAR, StressState::ThreeD);
        point.advance(&random.strain(StressState::ThreeD, 4e-3));
        let strain = random.strain(StressState::ThreeD, 1e-3);
        let (response, state) = point.trial(&strain);
        if state[..4] != point.state[..4] {
            continue;
        }
        assert!(response.stored_energy >= 0.0);
        for _ in 0..20 {
            let direction = random.strain(StressState::ThreeD, 1.0);
            let curvature: f64 =
                (0..6).map(|i| (0..6).map(|j| direction[i] * response.tangent[i][j] * direction[j]).sum::<f64>()).sum();
            assert!(curvature >= 0.0);
        }
    }
}

#[test]
fn far_beyond_the_peak_nothing_is_carried() {
    for props in [T51, T51_REGULAR] {
        let mut point = Point::<ReverseCyclicDamage>::virgin(&props, StressState::ThreeD);
        let stress = point.advance(&[1.1e-1, 0.0, 0.0, 0.0, 0.0, 0.0]).stress;
        assert!(stress[0] > 0.0 && stress[0] < 1e-2);
        let mut point = Point::<ReverseCyclicDamage>::virgin(&props, StressState::ThreeD);
        let stress = point.advance(&[-1.7, 0.0, 0.0, 0.0, 0.0, 0.0]).stress;
        assert!(stress[0] < 0.0 && stress[0] > -0.5);
    }
}
