use super::*;
use crate::tensor::{stress_norm_squared, trace, work};
use approx::assert_relative_eq;
use battery::pages::{PARAMETERS, STATES};
use battery::samples::j2_plasticity::*;
use battery::uniaxial::{BOTH_LATERAL, ONE_LATERAL, OUT_OF_PLANE, advance_free};
use battery::{PATH_COUNTS, Point, Promises, Random, STRESS_STATES, Sample, battery, check_no_second_flow};
use umat_abi::law::{advance_values, parameters_of};

const MU: f64 = E / (2.0 * (1.0 + NU));
const BULK: f64 = E / (3.0 * (1.0 - 2.0 * NU));

fn equivalent_stress(stress: &[f64; 6]) -> f64 {
    let mean = trace(stress) / 3.0;
    let deviator = std::array::from_fn(|i| stress[i] - if i < 3 { mean } else { 0.0 });
    (1.5 * stress_norm_squared(&deviator)).sqrt()
}

fn axial(strain: f64) -> [f64; 6] {
    [strain, 0.0, 0.0, 0.0, 0.0, 0.0]
}

battery!(
    promised: J2Plasticity,
    Promises {
        samples: SETS.map(|props| Sample::new(props, 3e-3)).to_vec(),
        histories: 200,
        monotone: &["peeq"],
        dissipative: true,
        steady: true,
        history: &["peeq"],
        elastic_strain: |_| 3e-4,
        path_ends: &[[8.0 / 3.0, -2.0 / 3.0, 1.0 / 3.0, 1.0, 0.0, 0.0]],
        random_paths: [0, 0],
        // one increment is enough where the return is radial
        path_counts: |_, stress_state| if stress_state == StressState::PlaneStress { &[] } else { &PATH_COUNTS },
    },
    pages: ["j2_plasticity/doc.md": &[PARAMETERS, STATES]]
);

#[test]
fn uniaxial_stress_follows_the_table() {
    for (stress_state, free) in [(StressState::ThreeD, BOTH_LATERAL), (StressState::PlaneStress, ONE_LATERAL)] {
        for props in [&PERFECT[..], &LINEAR, &JOINTS, &STEEP] {
            let elastic_strain =
                |p: &Point<'_, J2Plasticity>, s: f64| p.strain[0] - s / p.parameters.elasticity.youngs_modulus;
            let mut point = Point::<J2Plasticity>::virgin(props, stress_state);
            for step in 1..=60 {
                let response = advance_free(&mut point, &axial(2e-4 * f64::from(step)), &free);
                let stress = response.stress[0];
                let plastic = elastic_strain(&point, stress);
                if plastic > 1e-9 {
                    assert_relative_eq!(stress, point.parameters.hardening.yield_stress(plastic), max_relative = 1e-12);
                    assert_relative_eq!(point.state[0], plastic, max_relative = 1e-11);
                } else {
                    assert_relative_eq!(stress, props[0] * point.strain[0], max_relative = 1e-12);
                }
                assert_relative_eq!(
                    point.state[8],
                    point.parameters.hardening.work(0.0, point.state[0]),
                    max_relative = 1e-13
                );
                assert_relative_eq!(point.state[7], point.strain[1], max_relative = 1e-9);
            }
        }
    }
}

#[test]
fn uniaxial_strain_has_its_closed_form() {
    // q = 2μ|ε| − 3μ p = σ_0 + H p;  σ11 = k ε + (2/3) q
    for (props, hardening) in [(&PERFECT[..], 0.0), (&LINEAR, 2100.0)] {
        for sign in [1.0, -1.0] {
            let mut point = Point::<J2Plasticity>::virgin(props, StressState::ThreeD);
            let strain = 7e-3;
            let stress = point.advance(&axial(sign * strain)).stress;
            let peeq = (2.0 * MU * strain - 347.0) / (3.0 * MU + hardening);
            let expected = BULK * strain + 2.0 / 3.0 * (347.0 + hardening * peeq);
            assert_relative_eq!(stress[0], sign * expected, max_relative = 1e-14);
            assert_relative_eq!(point.state[0], peeq, max_relative = 1e-14);
        }
    }
}

#[test]
fn shear_yields_at_yield_stress_over_root_three() {
    for stress_state in STRESS_STATES {
        let mut point = Point::<J2Plasticity>::virgin(&PERFECT, stress_state);
        let stress = point.advance(&[0.0, 0.0, 0.0, 2e-2, 0.0, 0.0]).stress;
        assert_relative_eq!(stress[3], 347.0 / 3.0_f64.sqrt(), max_relative = 1e-14);
        assert_relative_eq!(point.state[0], (2e-2 - stress[3] / MU) / 3.0_f64.sqrt(), max_relative = 1e-13);
    }
}

/// An increment met again does not flow, however large the volumetric strain whose rounding the deviator has.
#[test]
fn a_point_under_pressure_does_not_flow_twice() {
    check_no_second_flow::<J2Plasticity>(&LINEAR);
}

#[test]
fn equibiaxial_plane_stress_yields_at_the_yield_stress() {
    let mut point = Point::<J2Plasticity>::virgin(&LINEAR, StressState::PlaneStress);
    let strain = 6e-3;
    let response = point.advance(&[strain, strain, 0.0, 0.0, 0.0, 0.0]);
    // σ = c(2ε − p)/2, c = E/(1 − ν), and σ = σ_0 + H p
    let modulus = E / (1.0 - NU);
    let peeq = (modulus * strain - 347.0) / (0.5 * modulus + 2100.0);
    for stress in [response.stress[0], response.stress[1], 347.0 + 2100.0 * point.state[0]] {
        assert_relative_eq!(stress, 347.0 + 2100.0 * peeq, max_relative = 1e-14);
    }
    assert_relative_eq!(point.state[7], -2.0 * NU * response.stress[0] / E - peeq, max_relative = 1e-13);
}

#[test]
fn shearing_a_point_that_yields_axially_turns_the_stress_as_prandtl_and_reuss_say() {
    // perfect plasticity on the circle |s| = √(2/3) σ_y: sin ψ = tanh(√2 μ γ/|s|)
    let radius = (2.0_f64 / 3.0).sqrt() * 347.0;
    let shear = 2e-3;
    let error = |count: u32| {
        let mut point = Point::<J2Plasticity>::virgin(&PERFECT, StressState::ThreeD);
        let a = 347.0 / (3.0 * MU);
        point.advance(&[a, -0.5 * a, -0.5 * a, 0.0, 0.0, 0.0]);
        let mut stress = [0.0; 6];
        for step in 1..=count {
            let gamma = shear * f64::from(step) / f64::from(count);
            stress = point.advance(&[a, -0.5 * a, -0.5 * a, gamma, 0.0, 0.0]).stress;
        }
        let exact = radius * (2.0_f64.sqrt() * MU * shear / radius).tanh() / 2.0_f64.sqrt();
        (stress[3] - exact).abs() / exact
    };
    let (coarse, fine) = (error(200), error(400));
    assert!(fine < 1e-3, "{fine}");
    // backward Euler is of first order
    assert!((coarse / fine - 2.0).abs() < 0.05, "{coarse} {fine}");
}

#[test]
fn a_return_ends_on_the_yield_surface_and_all_stress_states_agree() {
    let mut random = Random::new(7);
    for props in SETS {
        for stress_state in STRESS_STATES {
            for _ in 0..1000 {
                let mut point = Point::<J2Plasticity>::virgin(props, stress_state);
                for _ in 0..3 {
                    let size = 3e-3 * 10_f64.powf(2.0 * random.unit() - 1.0);
                    let before = point.state[0];
                    let mut solid = Point::<J2Plasticity>::virgin(props, StressState::ThreeD);
                    solid.state.clone_from(&point.state);
                    solid.strain = point.strain;
                    solid.strain[2] = point.state[7];
                    let response = point.advance(&random.strain(stress_state, size));
                    let (q, limit) =
                        (equivalent_stress(&response.stress), point.parameters.hardening.yield_stress(point.state[0]));
                    if point.state[0] > before {
                        assert!((q - limit).abs() <= 1e-12 * limit, "{q} {limit}");
                    }
                    assert!(q <= limit * (1.0 + 1e-12));
                    for i in 0..6 {
                        for j in 0..6 {
                            let asymmetry = response.tangent[i][j] - response.tangent[j][i];
                            assert!(asymmetry.abs() <= 1e-14 * props[0] / (1.0 - 2.0 * props[1]));
                        }
                    }
                    if stress_state == StressState::PlaneStress && props[1] < 0.49 {
                        // the same through σ33(ε33) = 0 of the three-dimensional law
                        let other = advance_free(&mut solid, &point.strain, &OUT_OF_PLANE);
                        for i in 0..6 {
                            assert!((other.stress[i] - response.stress[i]).abs() <= 1e-10 * limit.max(q));
                        }
                        assert!((solid.state[0] - point.state[0]).abs() <= 1e-11 * point.state[0]);
                    }
                }
            }
        }
    }
}

#[test]
fn one_step_over_many_joints_is_the_root_that_bisection_finds() {
    let mut random = Random::new(11);
    for _ in 0..2000 {
        let mut props = vec![E, NU, 100.0 + 300.0 * random.unit(), 0.0];
        for _ in 0..12 {
            let (stress, peeq) = (props[props.len() - 2], props[props.len() - 1]);
            let step = 1e-3 * random.unit() + 1e-6;
            props.push((stress + step * 1e5 * random.signed()).max(20.0));
            props.push(peeq + step);
        }
        let point = Point::<J2Plasticity>::virgin(&props, StressState::ThreeD);
        let hardening = point.parameters.hardening;
        let trial = 4000.0 * random.unit() + 400.0;
        let start = 2e-3 * random.unit();
        if trial <= hardening.yield_stress(start) {
            continue;
        }
        let (mut lower, mut upper) = (0.0, trial / (3.0 * MU));
        for _ in 0..200 {
            let middle = 0.5 * (lower + upper);
            let positive = trial - 3.0 * MU * middle > hardening.yield_stress(start + middle);
            *(if positive { &mut lower } else { &mut upper }) = middle;
        }
        let (found, _) = hardening.radial_return(trial, start, 3.0 * MU);
        assert!((found - lower).abs() <= 1e-15 * 10.0_f64.max(trial / MU), "{found} {lower}");
    }
}

#[test]
fn work_is_stored_or_dissipated_to_second_order() {
    for stress_state in STRESS_STATES {
        for props in [&PERFECT[..], &LINEAR, &JOINTS, &SOFTENING] {
            let imbalance = |count: u32| {
                let mut random = Random::new(3);
                let mut point = Point::<J2Plasticity>::virgin(props, stress_state);
                let (mut external, mut stored) = (0.0, 0.0);
                for _ in 0..8 {
                    let (start, end) = (point.strain, random.strain(stress_state, 1e-2));
                    for step in 1..=count {
                        let fraction = f64::from(step) / f64::from(count);
                        let (old, old_strain) = (point.stress, point.strain);
                        let strain = std::array::from_fn(|i| start[i] + fraction * (end[i] - start[i]));
                        let response = point.advance(&strain);
                        let mean = std::array::from_fn(|i| 0.5 * (old[i] + response.stress[i]));
                        external += work(&mean, &std::array::from_fn(|i| strain[i] - old_strain[i]));
                        stored = response.stored_energy;
                    }
                }
                let dissipated = *point.state.last().unwrap();
                (external - stored - dissipated).abs() / external.max(dissipated)
            };
            let (coarse, fine) = (imbalance(500), imbalance(4000));
            assert!(fine < 1e-5 && fine < coarse / 10.0, "{stress_state:?} {props:?}: {coarse:e} {fine:e}");
        }
    }
}

#[test]
fn extremes_stay_finite_and_admissible() {
    let mut random = Random::new(5);
    for stress_state in STRESS_STATES {
        for props in SETS {
            for exponent in -16..=1 {
                for _ in 0..50 {
                    let mut point = Point::<J2Plasticity>::virgin(props, stress_state);
                    let strain = random.strain(stress_state, 10_f64.powi(exponent));
                    let response = point.advance(&strain);
                    let numbers = response.stress.iter().chain(response.tangent.iter().flatten()).chain(&point.state);
                    assert!(numbers.into_iter().all(|x| x.is_finite()));
                    let limit = point.parameters.hardening.yield_stress(point.state[0]);
                    assert!(equivalent_stress(&response.stress) <= limit * (1.0 + 1e-9));
                }
            }
            let point = Point::<J2Plasticity>::virgin(props, stress_state);
            assert_eq!(point.trial(&[0.0; 6]).0.stress, [0.0; 6]);
            let mut state = [0.0; 9];
            let increment = Increment {
                stress_state,
                strain: [f64::NAN; 6],
                strain_increment: [0.0; 6],
                stress: [0.0; 6],
                characteristic_length: None,
                time_increment: 1.0,
                temperature: 0.0,
            };
            assert!(
                advance_values::<J2Plasticity>(&point.parameters, &increment, &mut state, Request::Stress).is_err()
            );
            let increment = Increment { strain: [1e300, -1e300, 0.0, 1e300, 0.0, 0.0], ..increment };
            assert!(
                advance_values::<J2Plasticity>(&point.parameters, &increment, &mut state, Request::Stress).is_err()
            );
        }
    }
}

#[test]
fn tables_that_make_no_sense_are_refused() {
    let rejected = |props: &[f64]| parameters_of::<J2Plasticity>(props).is_err();
    assert!(!rejected(&PERFECT));
    assert!(rejected(&[E, NU]));
    assert!(rejected(&[E, NU, 347.0]));
    assert!(rejected(&[E, NU, 0.0, 0.0]));
    assert!(rejected(&[E, NU, 347.0, 1e-3]));
    assert!(rejected(&[E, NU, 347.0, 0.0, 400.0, 0.0]));
    assert!(rejected(&[E, NU, 347.0, 0.0, 400.0, 2e-3, 410.0, 1e-3]));
    assert!(rejected(&[E, NU, 347.0, 0.0, 400.0, f64::NAN]));
    // H = −200 000 lies below −E/(2(1 − ν)) = −150 000, H = −145 000 above
    assert!(rejected(&[E, NU, 347.0, 0.0, 147.0, 1e-3]));
    assert!(!rejected(&[E, NU, 347.0, 0.0, 202.0, 1e-3]));
}

#[test]
fn random_tables_and_histories_end_on_the_yield_surface() {
    let mut random = Random::new(99);
    for _ in 0..4000 {
        let poisson_ratio = [0.4999999, 0.49, 0.3, 0.0, -0.9][(random.unit() * 5.0) as usize];
        let mut props = vec![E, poisson_ratio, 10_f64.powf(2.0 + 4.0 * random.signed()), 0.0];
        for _ in 0..(random.unit() * 6.0) as usize {
            let (stress, peeq) = (props[props.len() - 2], props[props.len() - 1]);
            let step = 10_f64.powf(-4.0 + 2.0 * random.signed());
            let softest = -0.9999 * 0.5 * E / (1.0 - poisson_ratio);
            let slope = if random.unit() < 0.5 { softest * random.unit() } else { 10_f64.powf(7.0 * random.unit()) };
            // a table that would soften to nothing stops at half its stress
            let step = if stress + slope * step > 0.0 { step } else { -0.5 * stress / slope };
            props.extend([stress + slope * step, peeq + step]);
        }
        for stress_state in STRESS_STATES {
            let mut point = Point::<J2Plasticity>::virgin(&props, stress_state);
            for _ in 0..3 {
                let before = point.state.clone();
                let size = 10_f64.powf(-3.0 + 3.0 * random.signed());
                let strain = random.strain(stress_state, size);
                let response = point.advance(&strain);
                let limit = point.parameters.hardening.yield_stress(point.state[0]);
                let largest = response.stress.iter().fold(limit, |m, x| m.max(x.abs()));
                let value = equivalent_stress(&response.stress) - limit;
                let plastic = point.state[0] > before[0];
                let error = if plastic { value.abs() } else { value };
                assert!(error <= 1e-12 * largest, "{error:e} {stress_state:?} {props:?} {strain:?} {before:?}");
                assert!(point.state[8] >= before[8] && point.state[0] >= before[0]);
                assert!(response.tangent.iter().flatten().chain(&point.state).all(|x| x.is_finite()));
            }
        }
    }
}
