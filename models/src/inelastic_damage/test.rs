use super::*;
use approx::assert_relative_eq;
use battery::energy::{check_frozen_damage, imbalance};
use battery::pages::{PARAMETERS, STATES};
use battery::peak::Uniaxial;
use battery::samples::inelastic_damage::*;
use battery::{PATH_COUNTS, Point, Promises, Random, STRESS_STATES, Sample, battery, reference};
use umat_abi::law::{advance_values, parameters_of};

/// The thesis's ill-posed form.
const GS_POWER_BELOW_1: [f64; 8] = [31800.0, 0.2, 2e18, 6.4, 6.45e-4, 3.5, 0.7, 1.0];

fn all_sets() -> impl Iterator<Item = ([f64; 8], f64)> {
    CLOSED.into_iter().chain(MARCHED)
}

#[test]
fn agrees_with_40_digits() {
    const TENSION: &[&str] = &["bi_t1_055", "bi_t1_1", "cyclic", "shear", "unitens"];
    const COMPRESSION: &[&str] = &["bi_c1_052", "bi_c1_1", "cyclic", "shear", "unicomp"];
    for (set, props, paths) in [
        ("s45t", &S45T, TENSION),
        ("s45c", &S45C, COMPRESSION),
        ("gs", &GS, TENSION),
        ("gs_a15", &GS_POWER, TENSION),
        ("gs_a07r", &GS_RATIONAL, TENSION),
    ] {
        for path in paths {
            let stress_state = if path.starts_with("bi") { StressState::PlaneStress } else { StressState::ThreeD };
            let file = format!("II_{set}_{path}.csv");
            let (error, rows) = reference::check::<InelasticDamage>(&file, stress_state, props, &[("D_t", 0)]);
            println!("{file}: {rows} rows, {error:.1e}");
            assert_eq!(rows, 200);
        }
    }
}

/// Properties that the law guarantees at parameters whose branch is closed or marched.
fn promises<'p>(sets: &'p [([f64; 8], f64); 6]) -> Promises<'p> {
    Promises {
        samples: Sample::all(sets),
        histories: 100,
        monotone: &["eta"],
        dissipative: true,
        steady: true,
        history: &["eta"],
        elastic_strain: |sample| if sample.props[4] > 0.0 { 1e-7 * sample.size } else { 0.0 },
        path_ends: &[[3.0, -0.4, 0.3, 1.2, 0.0, 0.0], [-3.0, 0.4, -0.3, -1.2, 0.0, 0.0]],
        random_paths: [10, 1],
        // the power form is no part of the promise, but keeps it up to 1000 increments
        path_counts: |sample, _| {
            if sample.props[6] == 1.0 || sample.props[7] == 0.0 { &PATH_COUNTS } else { &PATH_COUNTS[..3] }
        },
    }
}

battery!(closed: InelasticDamage, promises(&CLOSED), pages: ["inelastic_damage/doc.md": &[PARAMETERS, STATES]]);
battery!(marched: InelasticDamage, promises(&MARCHED));

/// Also for the ill-posed form: from random ends back, one step finds the D that a hundred find.
#[test]
fn one_step_ends_where_a_hundred_do() {
    let mut random = Random::new(77);
    for stress_state in STRESS_STATES {
        for (props, size) in all_sets().chain([(GS_POWER_BELOW_1, 1.2e-4)]) {
            for _ in 0..20 {
                let end = random.strain(stress_state, 6.0 * size);
                let eta_after = |steps: u32| {
                    let mut point = Point::<InelasticDamage>::virgin(&props, stress_state);
                    for step in 1..=steps {
                        point.advance(&end.map(|x| x * f64::from(step) / f64::from(steps)));
                    }
                    point.state[0]
                };
                let (one, hundred) = (eta_after(1), eta_after(100));
                assert!((one - hundred).abs() <= 1e-12 * (1.0 + one), "{props:?} {end:?}: {one} {hundred}");
            }
        }
    }
}

#[test]
fn work_is_stored_or_dissipated() {
    for stress_state in STRESS_STATES {
        for (props, size) in [(S45T, 0.09), (S45C, 0.12), (GS, 1.2e-4), (GS_RATIONAL, 1.2e-4)] {
            let coarse = imbalance::<InelasticDamage>(&props, stress_state, size, 20, 250).absolute;
            let fine = imbalance::<InelasticDamage>(&props, stress_state, size, 20, 1000).absolute;
            assert!(fine < 5e-5 && fine < coarse / 10.0, "{stress_state:?} {props:?}: {coarse:e}, {fine:e}");
        }
        // The power form with 1 < α < 2 jumps to a small finite D at the onset: energy goes, none comes.
        let coarse = imbalance::<InelasticDamage>(&GS_POWER, stress_state, 1.2e-4, 20, 250);
        let fine = imbalance::<InelasticDamage>(&GS_POWER, stress_state, 1.2e-4, 20, 1000);
        assert!(
            fine.absolute < 1e-4 && fine.created < 1e-6 && fine.created < coarse.created / 4.0,
            "{coarse:?} {fine:?}"
        );
        assert!(check_frozen_damage::<InelasticDamage>(&GS, stress_state, 5e-4, 50, (200, 1e-12)) > 5);
    }
}

#[test]
fn peaks_are_those_of_the_closed_form() {
    // docs/theory/peaks.md
    let uniaxial: &[usize] = &[1, 2];
    for (props, free, end, stress, strain) in [
        (S45T, uniaxial, 0.3, 1255.71, 0.0901),
        (S45C, uniaxial, -0.4, -481.94, -0.1158),
        (GS, uniaxial, 4e-4, 3.7988, 1.195e-4),
        (GS, &[1], 4e-4, 3.4909, 1.054e-4),
    ] {
        let (peak, at) = Uniaxial::<InelasticDamage>::new(&props, StressState::ThreeD, free).peak(end, 200);
        assert_relative_eq!(peak, stress, max_relative = 2e-5);
        assert_relative_eq!(at, strain, max_relative = 1e-3);
    }
}

#[test]
fn without_inelastic_strain_it_is_model_i() {
    use crate::pure_damage::PureDamage;
    let props = [31800.0, 0.18, 5000.0, 1.3, 2e-4, 0.0, 1.0, 0.0];
    let mut random = Random::new(7);
    for stress_state in STRESS_STATES {
        let mut this = Point::<InelasticDamage>::virgin(&props, stress_state);
        let mut other = Point::<PureDamage>::virgin(&props[..5], stress_state);
        for _ in 0..100 {
            let strain = random.strain(stress_state, 4e-4);
            let (a, b) = (this.advance(&strain), other.advance(&strain));
            for i in 0..6 {
                assert_relative_eq!(a.stress[i], b.stress[i], epsilon = 1e-14, max_relative = 1e-12);
                for j in 0..6 {
                    assert_relative_eq!(a.tangent[i][j], b.tangent[i][j], epsilon = 1e-12 * 31800.0);
                }
            }
            assert_relative_eq!(a.stored_energy, b.stored_energy, max_relative = 1e-12);
        }
    }
}

#[test]
fn both_forms_of_lambda_meet_the_closed_branch_at_one() {
    let strain = [3e-4, 1e-4, -1e-5, 1e-4, 0.0, 0.0];
    for form in [0.0, 1.0] {
        for stress_state in STRESS_STATES {
            let near = [31800.0, 0.2, 2e18, 6.4, 6.45e-4, 3.5, 1.0 + 1e-9, form];
            let closed = Point::<InelasticDamage>::virgin(&GS, stress_state).advance(&strain);
            let marched = Point::<InelasticDamage>::virgin(&near, stress_state).advance(&strain);
            for i in 0..6 {
                assert_relative_eq!(closed.stress[i], marched.stress[i], epsilon = 1e-7);
                for j in 0..6 {
                    assert_relative_eq!(closed.tangent[i][j], marched.tangent[i][j], epsilon = 1e-6 * 31800.0);
                }
            }
        }
    }
}

#[test]
fn uniaxial_tension_softens_to_nothing() {
    for props in [S45T, GS, GS_POWER, GS_RATIONAL] {
        let mut bar = Uniaxial::<InelasticDamage>::new(&props, StressState::ThreeD, &[1, 2]);
        let (peak, at) = bar.peak(if props[5] == 1000.0 { 0.3 } else { 4e-4 }, 200);
        let mut far = 0.0;
        for step in 1..=300 {
            far = bar.stress(at * 10_f64.powf(f64::from(step) / 100.0));
            assert!(far >= 0.0);
        }
        assert!(far < 1e-2 * peak, "{far} of {peak}");
    }
}

#[test]
fn an_indefinite_energy_is_refused() {
    let mut props = GS_RATIONAL;
    props[6] = 0.3;
    let parameters = parameters_of::<InelasticDamage>(&props).expect("definite in plane stress");
    let increment = |stress_state| Increment {
        stress_state,
        strain: [1e-4, 0.0, 0.0, 0.0, 0.0, 0.0],
        strain_increment: [1e-4, 0.0, 0.0, 0.0, 0.0, 0.0],
        stress: [0.0; 6],
        characteristic_length: None,
        time_increment: 1.0,
        temperature: 0.0,
    };
    let run = |stress_state| {
        advance_values::<InelasticDamage>(
            &parameters,
            &increment(stress_state),
            &mut [0.0; 3],
            Request::StressAndTangent,
        )
    };
    assert!(run(StressState::PlaneStress).is_ok());
    assert!(matches!(run(StressState::ThreeD), Err(Failure::Configuration(_))));
    props[6] = 0.2;
    assert!(parameters_of::<InelasticDamage>(&props).is_err());
}
