use super::*;
use crate::j2_plasticity::J2Plasticity;
use crate::tensor::{add_dyad, stress_norm_squared, trace, work};
use approx::assert_relative_eq;
use battery::pages::{PARAMETERS, STATES};
use battery::samples::drucker_prager::*;
use battery::uniaxial::{BOTH_LATERAL, ONE_LATERAL, advance_free};
use battery::{Point, Promises, Random, STRESS_STATES, Sample, battery, check_no_second_flow};
use umat_abi::law::{advance_values, parameters_of};

fn root_j2(stress: &[f64; 6]) -> f64 {
    let mean = trace(stress) / 3.0;
    let deviator = std::array::from_fn(|i| stress[i] - if i < 3 { mean } else { 0.0 });
    (0.5 * stress_norm_squared(&deviator)).sqrt()
}

fn axial(strain: f64) -> [f64; 6] {
    [strain, 0.0, 0.0, 0.0, 0.0, 0.0]
}

battery!(
    promised: DruckerPrager,
    Promises {
        samples: SETS.iter().map(|props| Sample::new(props, 3e-3)).collect(),
        histories: 200,
        monotone: &["peeq"],
        dissipative: true,
        steady: true,
        history: &["peeq"],
        elastic_strain: |_| 1e-4,
        // the return to a cone depends on the increments
        path_ends: &[],
        random_paths: [0, 0],
        path_counts: |_, _| &[],
    },
    pages: ["drucker_prager/doc.md": &[PARAMETERS, STATES]]
);

/// An increment met again does not flow without friction, where no term of the yield function grows with the pressure.
#[test]
fn a_point_under_pressure_does_not_flow_twice() {
    check_no_second_flow::<DruckerPrager>(&[E, NU, COHESION, 0.0, 0.0, 0.0]);
}

#[test]
fn uniaxial_strengths_are_those_of_the_cone() {
    // cone, tension, compression: doc.md's table, here from Mohr–Coulomb and ABAQUS formulas
    let (sin, cos) = ANGLE.to_radians().sin_cos();
    let tan = sin / cos;
    let plane = (9.0 + 12.0 * tan * tan).sqrt();
    let strengths = [
        (0.0, COHESION / (1.0 + tan / 3.0), COHESION / (1.0 - tan / 3.0), 34.22, 42.98),
        (1.0, 6.0 * COHESION * cos / (3.0 + sin), 2.0 * COHESION * cos / (1.0 - sin), 65.14, 106.44),
        (
            2.0,
            3.0 * COHESION / (plane / 3.0_f64.sqrt() + tan),
            3.0 * COHESION / (plane / 3.0_f64.sqrt() - tan),
            51.92,
            75.16,
        ),
    ];
    for (cone, tension, compression, printed_tension, printed_compression) in strengths {
        assert_relative_eq!(tension, printed_tension, epsilon = 0.006);
        assert_relative_eq!(compression, printed_compression, epsilon = 0.006);
        for dilation in [ANGLE, 6.0, 0.0] {
            for (stress_state, free) in [(StressState::ThreeD, BOTH_LATERAL), (StressState::PlaneStress, ONE_LATERAL)] {
                for (end, strength) in [(8e-3, tension), (-8e-3, -compression)] {
                    let props = props(dilation, cone);
                    let mut point = Point::<DruckerPrager>::virgin(&props, stress_state);
                    for step in 1..=10 {
                        let strain = end * f64::from(step) / 10.0;
                        let stress = advance_free(&mut point, &axial(strain), &free).stress[0];
                        let elastic = E * strain;
                        let expected = if elastic.abs() < strength.abs() { elastic } else { strength };
                        assert_relative_eq!(stress, expected, max_relative = 1e-11);
                    }
                }
            }
        }
    }
}

#[test]
fn plane_strain_cone_collapses_at_mohr_coulombs_strength_in_plane_strain() {
    let mut point = Point::<DruckerPrager>::virgin(&SETS[2], StressState::PlaneStrainOrAxisymmetric);
    let mut stress = 0.0;
    for step in 1..=400 {
        stress = advance_free(&mut point, &axial(-1e-3 * f64::from(step)), &ONE_LATERAL).stress[0];
    }
    let (sin, cos) = ANGLE.to_radians().sin_cos();
    assert_relative_eq!(stress, -2.0 * COHESION * cos / (1.0 - sin), max_relative = 1e-9);
}

#[test]
fn hydrostatic_tension_ends_at_the_apex() {
    for dilation in [ANGLE, 0.0] {
        for cone in [0.0, 1.0, 2.0] {
            let props = props(dilation, cone);
            let mut point = Point::<DruckerPrager>::virgin(&props, StressState::ThreeD);
            let (strain, apex) = (1e-2, COHESION / ANGLE.to_radians().tan());
            let response = point.advance(&[strain, strain, strain, 0.0, 0.0, 0.0]);
            for i in 0..3 {
                assert_relative_eq!(response.stress[i], apex, max_relative = 1e-14);
            }
            assert_eq!(response.stress[3..], [0.0; 3]);
            assert_eq!(response.tangent, [[0.0; 6]; 6]);
            let volume = 3.0 * strain - apex * 3.0 * (1.0 - 2.0 * NU) / E;
            assert_relative_eq!(response.dissipated_energy, apex * volume, max_relative = 1e-13);
            if dilation == 0.0 {
                // shear at the apex finds no resistance
                let sheared = point.advance(&[strain, strain, strain, 1e-2, 0.0, 0.0]).stress;
                assert!(sheared[3].abs() < 1e-12 && (sheared[0] - apex).abs() < 1e-11);
            }
            // closing the volume finds the elastic one
            let bulk = E / (3.0 * (1.0 - 2.0 * NU));
            let shear = point.strain[3];
            let closed = point.advance(&[strain - 1e-3, strain - 1e-3, strain - 1e-3, shear, 0.0, 0.0]).stress;
            assert_relative_eq!(closed[0], apex - 3e-3 * bulk, max_relative = 1e-11);
        }
    }
}

#[test]
fn a_return_ends_on_the_cone() {
    let mut random = Random::new(7);
    let mut regimes = [0; 3];
    for props in &SETS {
        for stress_state in STRESS_STATES {
            for _ in 0..1000 {
                let mut point = Point::<DruckerPrager>::virgin(props, stress_state);
                for _ in 0..3 {
                    let size = 3e-3 * 10_f64.powf(2.0 * random.unit() - 1.0);
                    let before = point.state.clone();
                    let old_strain = point.strain;
                    let response = point.advance(&random.strain(stress_state, size));
                    let cone = point.parameters.cone;
                    let strength = cone.shear_strength;
                    let mean = trace(&response.stress) / 3.0;
                    let value = cone.yield_function(mean, root_j2(&response.stress));
                    // the terms of F are as large as the mean stress makes them
                    let tolerance = 1e-12 * strength.max(mean.abs());
                    if point.state[0] > before[0] {
                        assert!(value.abs() <= tolerance, "{value:e} {strength} {mean}");
                        regimes[if root_j2(&response.stress) > 0.0 { 1 } else { 2 }] += 1;
                    } else {
                        regimes[0] += 1;
                    }
                    assert!(value <= tolerance);
                    if stress_state == StressState::PlaneStress {
                        // ε33 given to the three-dimensional law: σ33 is 0
                        let mut solid = Point::<DruckerPrager>::virgin(props, StressState::ThreeD);
                        solid.state.clone_from(&before);
                        solid.strain = old_strain;
                        solid.strain[2] = before[7];
                        let mut strain = point.strain;
                        strain[2] = point.state[7];
                        let stress = solid.advance(&strain).stress;
                        let bulk = point.parameters.elasticity.bulk_modulus;
                        let rounding = 1e-15 * bulk * strain.iter().fold(0.0_f64, |m, x| m.max(x.abs()));
                        for i in 0..6 {
                            assert!((stress[i] - response.stress[i]).abs() <= 1e-12 * strength + 4.0 * rounding);
                        }
                    }
                }
            }
        }
    }
    println!("elastic, cone, apex: {regimes:?}");
    assert!(regimes.iter().all(|&count| count > 1000));
}

#[test]
fn without_friction_it_is_von_mises() {
    let mut random = Random::new(13);
    for (cone, yield_stress) in [(0.0, COHESION), (1.0, 2.0 * COHESION), (2.0, 3.0_f64.sqrt() * COHESION)] {
        let cone_props = [E, NU, COHESION, 0.0, 0.0, cone];
        let mises_props = [E, NU, yield_stress, 0.0];
        for stress_state in STRESS_STATES {
            for _ in 0..500 {
                let mut point = Point::<DruckerPrager>::virgin(&cone_props, stress_state);
                let mut mises = Point::<J2Plasticity>::virgin(&mises_props, stress_state);
                for _ in 0..3 {
                    let strain = random.strain(stress_state, 1e-2);
                    let (ours, theirs) = (point.advance(&strain), mises.advance(&strain));
                    for i in 0..6 {
                        assert!(
                            (ours.stress[i] - theirs.stress[i]).abs()
                                <= 1e-12 * yield_stress.max(theirs.stress[i].abs())
                        );
                        for j in 0..6 {
                            assert!((ours.tangent[i][j] - theirs.tangent[i][j]).abs() <= 1e-11 * E);
                        }
                    }
                    for k in 0..9 {
                        assert_relative_eq!(point.state[k], mises.state[k], max_relative = 1e-11, epsilon = 1e-14);
                    }
                    assert_relative_eq!(ours.stored_energy, theirs.stored_energy, max_relative = 1e-11);
                }
            }
        }
    }
}

#[test]
fn at_first_yielding_the_tangent_is_equation_5_25() {
    let mut random = Random::new(17);
    for props in &SETS {
        let mut found = 0;
        while found < 100 {
            let mut strain = random.strain(StressState::ThreeD, 1e-2);
            let Parameters { elasticity, cone } = Point::<DruckerPrager>::virgin(props, StressState::ThreeD).parameters;
            let (mean, j) = invariants(&elasticity, &strain);
            // scaled to lie on the cone, just outside
            let scale = cone.shear_strength / (3.0 * cone.friction * mean + j);
            if scale <= 0.0 {
                continue;
            }
            found += 1;
            strain = strain.map(|x| x * scale * (1.0 + 1e-12));
            let stress = elasticity.stress(&strain);
            let (tr, j) = (trace(&stress) / 3.0, root_j2(&stress));
            let gradient = |slope: f64| -> [f64; 6] {
                std::array::from_fn(|i| {
                    let (volumetric, deviator) =
                        if i < 3 { (3.0 * elasticity.bulk_modulus * slope, stress[i] - tr) } else { (0.0, stress[i]) };
                    volumetric + elasticity.shear_modulus / j * deviator
                })
            };
            let mut expected = elasticity.stiffness();
            let modulus = 9.0 * elasticity.bulk_modulus * cone.friction * cone.dilation + elasticity.shear_modulus;
            add_dyad(&mut expected, -1.0 / modulus, &gradient(cone.dilation), &gradient(cone.friction));
            let returned = Returned::new(&elasticity, &cone, &strain);
            assert_eq!(returned.regime, Regime::Cone);
            let tangent = returned.tangent();
            let largest = elasticity.bulk_modulus + 2.0 * elasticity.shear_modulus;
            for i in 0..6 {
                for j in 0..6 {
                    assert!((tangent[i][j] - expected[i][j]).abs() <= 1e-11 * largest);
                    if cone.friction == cone.dilation {
                        assert!((tangent[i][j] - tangent[j][i]).abs() <= 1e-14 * largest);
                    }
                }
            }
            assert!((tangent[2][2] - returned.modulus_33()).abs() <= 1e-14 * largest);
        }
    }
}

#[test]
fn work_is_stored_or_dissipated_to_second_order() {
    for stress_state in STRESS_STATES {
        for props in &SETS {
            let imbalance = |count: u32| {
                let mut random = Random::new(3);
                let mut point = Point::<DruckerPrager>::virgin(props, stress_state);
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
            let (coarse, fine) = (imbalance(250), imbalance(2000));
            println!("{stress_state:?} {props:?}: {coarse:e} {fine:e}");
            assert!(fine < 2e-5 && fine < coarse / 10.0, "{stress_state:?} {props:?}: {coarse:e} {fine:e}");
        }
    }
}

#[test]
fn extremes_stay_finite_and_admissible() {
    let mut random = Random::new(5);
    let steep = [
        [E, 0.499, 5.0, 40.0, 40.0, 2.0],
        [E, NU, 1.0, 85.0, 85.0, 0.0],
        [E, NU, 1.0, 60.0, 60.0, 1.0],
        [E, 0.4, 1.0, 50.0, 0.0, 1.0],
    ];
    for stress_state in STRESS_STATES {
        for props in SETS.iter().chain(&steep) {
            let virgin = Point::<DruckerPrager>::virgin(props, stress_state);
            assert_eq!(virgin.trial(&[0.0; 6]).0.stress, [0.0; 6]);
            for exponent in -16..=1 {
                for _ in 0..50 {
                    let mut point = Point::<DruckerPrager>::virgin(props, stress_state);
                    let response = point.advance(&random.strain(stress_state, 10_f64.powi(exponent)));
                    let numbers = response.stress.iter().chain(response.tangent.iter().flatten()).chain(&point.state);
                    assert!(numbers.into_iter().all(|x| x.is_finite()));
                    let cone = point.parameters.cone;
                    let mean = trace(&response.stress) / 3.0;
                    let value = cone.yield_function(mean, root_j2(&response.stress));
                    let rounding =
                        10_f64.powi(exponent) * point.parameters.elasticity.bulk_modulus * (1.0 + cone.friction);
                    assert!(value <= 1e-12 * cone.shear_strength + 1e-14 * rounding, "{value} {props:?}");
                }
            }
            let mut state = [0.0; 9];
            for strain in [[f64::NAN; 6], [1e300, -1e300, 0.0, 1e300, 0.0, 0.0]] {
                let increment = Increment {
                    stress_state,
                    strain,
                    strain_increment: [0.0; 6],
                    stress: [0.0; 6],
                    characteristic_length: None,
                    time_increment: 1.0,
                    temperature: 0.0,
                };
                assert!(
                    advance_values::<DruckerPrager>(&virgin.parameters, &increment, &mut state, Request::Stress)
                        .is_err()
                );
            }
        }
    }
}

#[test]
fn parameters_that_make_no_sense_are_refused() {
    let rejected = |props: &[f64]| parameters_of::<DruckerPrager>(props).is_err();
    assert!(!rejected(&props(ANGLE, 0.0)));
    assert!(rejected(&props(ANGLE + 1e-9, 0.0)));
    assert!(rejected(&props(-1.0, 0.0)));
    assert!(rejected(&props(ANGLE, 3.0)));
    assert!(rejected(&[E, NU, 0.0, ANGLE, 0.0, 0.0]));
    assert!(rejected(&[E, NU, COHESION, 90.0, 0.0, 0.0]));
    assert!(rejected(&[E, NU, COHESION, ANGLE, ANGLE]));
}

#[test]
fn random_parameters_and_histories_are_admissible() {
    let mut random = Random::new(99);
    for _ in 0..4000 {
        let pick = |random: &mut Random, values: &[f64]| values[(random.unit() * values.len() as f64) as usize];
        let friction = pick(&mut random, &[0.0, 1e-9, 1e-3, 10.0, 35.0, 50.0, 60.0]);
        let dilation = friction * pick(&mut random, &[0.0, 1e-6, 0.5, 1.0]);
        let poisson_ratio = pick(&mut random, &[0.499, 0.3, 0.0, -0.9]);
        let cone = pick(&mut random, &[0.0, 1.0, 2.0]);
        let props = [E, poisson_ratio, 10_f64.powf(1.0 + 1.5 * random.signed()), friction, dilation, cone];
        for stress_state in STRESS_STATES {
            let mut point = Point::<DruckerPrager>::virgin(&props, stress_state);
            for _ in 0..3 {
                let size = 10_f64.powf(-3.0 + 2.0 * random.signed());
                let mut strain = random.strain(stress_state, size);
                if random.unit() < 0.2 {
                    // equibiaxial or hydrostatic: no deviator in the plane or at all
                    strain = axial(strain[0]);
                    strain[1] = strain[0];
                    strain[2] = if stress_state == StressState::PlaneStress { 0.0 } else { strain[0] };
                }
                let before = point.state.clone();
                let response = point.advance(&strain);
                let Parameters { elasticity, cone } = point.parameters;
                let (mean, j) = (trace(&response.stress) / 3.0, root_j2(&response.stress));
                let terms = cone.shear_strength + 3.0 * cone.friction * mean.abs() + j;
                // the elastic strain is the difference to a plastic one that may be much larger
                let largest = strain.iter().chain(&point.state[1..7]).fold(0.0_f64, |m, x| m.max(x.abs()));
                let rounding = 1e-14 * (1.0 + cone.friction) * (elasticity.bulk_modulus + E) * largest;
                let value = cone.yield_function(mean, j);
                assert!(value <= 1e-12 * terms + rounding, "{value:e} of {terms} {props:?} {strain:?} {before:?}");
                assert!(point.state[0] >= before[0] && point.state[8] >= before[8]);
                assert!(response.tangent.iter().flatten().chain(&point.state).all(|x| x.is_finite()));
            }
        }
    }
}
