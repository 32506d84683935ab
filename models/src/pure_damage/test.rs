use super::*;
use approx::assert_relative_eq;
use battery::energy::{check_frozen_damage, imbalance};
use battery::pages::{PARAMETERS, STATES};
use battery::peak::Uniaxial;
use battery::samples::pure_damage::*;
use battery::{PATH_COUNTS, Point, Promises, STRESS_STATES, Sample, battery, reference, tangent_error};
use umat_abi::law::{advance_values, parameters_of};

#[test]
fn agrees_with_40_digits() {
    for (set, props, paths) in [
        ("t51t", &T51T, &["bi_t1_055", "bi_t1_1", "cyclic", "shear", "unitens"][..]),
        ("t51c", &T51C, &["bi_c1_052", "bi_c1_1", "cyclic", "shear", "unicomp"]),
        ("s45t", &S45T, &["bi_t1_055", "bi_t1_1", "cyclic", "shear", "unitens"]),
    ] {
        for path in paths {
            let stress_state = if path.starts_with("bi") { StressState::PlaneStress } else { StressState::ThreeD };
            let file = format!("I_{set}_{path}.csv");
            let (error, rows) = reference::check::<PureDamage>(&file, stress_state, props, &[("D_t", 0)]);
            println!("{file}: {rows} rows, {error:.1e}");
            assert_eq!(rows, 200);
        }
    }
}

battery!(
    promised: PureDamage,
    Promises {
        samples: Sample::all(&SETS),
        histories: 200,
        monotone: &["eta", "Y_max"],
        dissipative: true,
        steady: true,
        history: &["eta"],
        elastic_strain: |sample| if sample.props[4] > 0.0 { 1e-5 * sample.size } else { 0.0 },
        path_ends: &[[3.0, -0.4, 0.3, 1.2, 0.0, 0.0]],
        random_paths: [20, 2],
        path_counts: |_, _| &PATH_COUNTS,
    },
    pages: ["pure_damage/doc.md": &[PARAMETERS, STATES]]
);

#[test]
fn work_is_stored_or_dissipated() {
    for stress_state in STRESS_STATES {
        for (props, size) in [(T51T, 1.2e-4), (T51C, 1.6e-3), (S45T, 0.1)] {
            let coarse = imbalance::<PureDamage>(&props, stress_state, size, 30, 250).absolute;
            let fine = imbalance::<PureDamage>(&props, stress_state, size, 30, 1000).absolute;
            assert!(fine < 2e-5 && fine < coarse / 10.0, "{stress_state:?} {props:?}: {coarse:e}, {fine:e}");
        }
        assert!(check_frozen_damage::<PureDamage>(&T51T, stress_state, 5e-4, 50, (200, 1e-12)) > 40);
    }
}

#[test]
fn peaks_are_those_of_the_closed_form() {
    // docs/theory/peaks.md
    for (props, end, stress, strain) in
        [(T51T, 4e-4, 3.5826, 1.143e-4), (T51C, -4e-3, -27.675, -1.648e-3), (S45T, 0.3, 2021.94, 0.1090)]
    {
        let (peak, at) = Uniaxial::<PureDamage>::new(&props, StressState::ThreeD, &[1, 2]).peak(end, 200);
        assert_relative_eq!(peak, stress, max_relative = 2e-5);
        assert_relative_eq!(at, strain, max_relative = 5e-4);
    }
}

#[test]
fn damage_tends_to_one_without_overflow() {
    for stress_state in STRESS_STATES {
        for (props, size) in SETS {
            for strain in [1e3 * size, 1e-12 * size, 1e-300, 5e-324, 0.0, 10.0] {
                let mut point = Point::<PureDamage>::virgin(&props, stress_state);
                let undamaged = parameters_of::<PureDamage>(&props).unwrap().elasticity.stiffness()[0][0] * strain;
                let response = point.advance(&[strain, 0.0, 0.0, 0.0, 0.0, 0.0]);
                // a third of the least subnormal number is 0: there a stress is known to its modulus times 5e-324
                let rounding = 1e-15 * undamaged + 1e-317;
                assert!(response.stress[0] >= 0.0 && response.stress[0] <= undamaged + rounding);
                assert!(response.tangent.iter().flatten().all(|x| x.is_finite()));
                if strain >= 1e3 * size && props[3] > 1.0 {
                    assert!(response.stress[0] < 1e-4 * undamaged, "{props:?}: {}", response.stress[0]);
                }
            }
        }
    }
}

#[test]
fn what_overflows_asks_for_a_cut_back() {
    let point = Point::<PureDamage>::virgin(&T51T, StressState::ThreeD);
    let increment = Increment {
        stress_state: StressState::ThreeD,
        strain: [1e200, 0.0, 0.0, 0.0, 0.0, 0.0],
        strain_increment: [1e200, 0.0, 0.0, 0.0, 0.0, 0.0],
        stress: [0.0; 6],
        characteristic_length: None,
        time_increment: 1.0,
        temperature: 0.0,
    };
    let result = advance_values::<PureDamage>(&point.parameters, &increment, &mut [0.0; 4], Request::StressAndTangent);
    assert!(matches!(result, Err(Failure::CutBack { .. })));
}

#[test]
fn the_threshold_itself_is_elastic() {
    // ε with W = Y₀ exactly representable: E = 2, ν = 0, ε = 1 → W = 1
    let props = [2.0, 0.0, 3.0, 0.5, 1.0];
    let mut point = Point::<PureDamage>::virgin(&props, StressState::ThreeD);
    let response = point.advance(&[1.0, 0.0, 0.0, 0.0, 0.0, 0.0]);
    assert_eq!((response.stress[0], response.tangent[0][0], point.state[0]), (2.0, 2.0, 0.0));
}

#[test]
fn reloading_below_the_largest_release_rate_is_elastic() {
    let mut point = Point::<PureDamage>::virgin(&T51T, StressState::ThreeD);
    point.advance(&[3e-4, 0.0, 0.0, 0.0, 0.0, 0.0]);
    let history = point.state.clone();
    point.advance(&[1e-5, 0.0, 0.0, 0.0, 0.0, 0.0]);
    let reloaded = [2.9e-4, 0.0, 0.0, 0.0, 0.0, 0.0];
    assert!(tangent_error(&point, &reloaded) < 1e-9);
    point.advance(&reloaded);
    assert_eq!(point.state[0], history[0]);
}
