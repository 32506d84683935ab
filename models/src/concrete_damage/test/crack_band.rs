//! The crack band dissipates G over the length of an element, whatever its size.

use super::*;
use approx::assert_relative_eq;
use umat_abi::law::{advance_values, parameters_of};

/// ∫ σ dε of a uniaxial path to nearly no stress: Simpson's rule in ln ε, with the rest of the tail from its
/// power law σ ~ ε^(1−2B).
fn uniaxial_energy(props: &[f64; 14], length: Option<f64>, onset: f64, b: f64) -> f64 {
    let mut path = StressRatio::virgin(props, 0.0);
    path.point.characteristic_length = length;
    let elastic = path.advance(onset);
    let mut energy = 0.5 * elastic * onset;
    let (decades, count) = (6.0, 1600);
    let step = decades * std::f64::consts::LN_10 / f64::from(count);
    let mut integrand = vec![elastic * onset];
    for i in 1..=count {
        let strain = onset * (step * f64::from(i)).exp();
        integrand.push(path.advance(strain) * strain);
    }
    for v in integrand.chunks(2).zip(integrand[1..].chunks(2)).zip(integrand[2..].chunks(2)) {
        energy += (v.0.0[0] + 4.0 * v.0.1[0] + v.1[0]) * step / 3.0;
    }
    energy + integrand[integrand.len() - 1] / (2.0 * b - 2.0)
}

#[test]
fn energy_over_the_length_is_the_fracture_energy() {
    let onset = (2.0 * 1.905_077e-4 / 31800.0_f64).sqrt();
    for b_t in [0.0, 0.3] {
        let props = with(defaults(), &[("G_f", 0.1), ("b_t", b_t)]);
        for length in [8.0, 20.0, 50.0, 80.0] {
            let energy = uniaxial_energy(&props, Some(length), onset, 1.3);
            assert_relative_eq!(length * energy, 0.1, max_relative = 1e-6);
        }
    }
}

#[test]
fn energy_over_the_length_is_the_crushing_energy() {
    let nu = 0.18;
    for b_c in [0.0, 0.3] {
        let props = with(defaults(), &[("G_c", 20.0), ("B_c", 1.5), ("b_c", b_c)]);
        let modulus = 31800.0 * (2.0 * (1.0 + nu) + props[8] * (1.0 - 2.0 * nu)) / 3.0;
        let onset = -(2.0 * 3e-4 / modulus).sqrt();
        for length in [5.0, 20.0, 50.0] {
            let energy = uniaxial_energy(&props, Some(length), onset, 1.5);
            assert_relative_eq!(length * energy, 20.0, max_relative = 1e-6);
        }
    }
}

/// The closed forms: without a band the path dissipates g (E/E*) (1 − κ).
#[test]
fn closed_form_of_the_total_work_is_the_integral() {
    let parameters = parameters_of::<ConcreteDamage>(&defaults()).expect("defaults");
    let [tension, _] = parameters.softening(None);
    let energy = uniaxial_energy(&defaults(), None, (2.0 * 1.905_077e-4 / 31800.0_f64).sqrt(), 1.3);
    let closed = (1.0 - tension.curve.recovery) * tension.curve.total_dissipation();
    assert_relative_eq!(energy, closed, max_relative = 1e-6);
}

/// docs/theory/crack-band.md: 109 mm for B_t = 1.1 and 247 mm for B_t = 1.5, in the one-dimensional reading (ν = 0).
#[test]
fn too_long_an_element_is_refused_with_the_limit() {
    let limit = |props: &[f64; 14]| {
        let parameters = parameters_of::<ConcreteDamage>(props).expect("consistent");
        match ConcreteDamage::check_characteristic_length(&parameters, Some(1e5)) {
            Err(ConfigurationError::CharacteristicLengthTooLarge { parameter, limit, .. }) => {
                assert_eq!(parameter, "G_f");
                assert!(ConcreteDamage::check_characteristic_length(&parameters, Some(0.999 * limit)).is_ok());
                assert!(ConcreteDamage::check_characteristic_length(&parameters, Some(1.001 * limit)).is_err());
                limit
            }
            other => panic!("{other:?}"),
        }
    };
    let spec = with(defaults(), &[("nu", 0.0), ("A_t", 7000.0), ("B_t", 1.1), ("Y_t0", 1.926098e-4), ("G_f", 0.1)]);
    assert_eq!(limit(&spec).round(), 109.0);
    let spec = with(spec, &[("A_t", 2866.14), ("B_t", 1.5), ("Y_t0", 1.56218e-4)]);
    assert_eq!(limit(&spec).round(), 247.0);
    println!("default, G_f 0.1 N/mm: {} mm", limit(&with(defaults(), &[("G_f", 0.1)])));
    // and by the first update of a point, which has no set-up phase
    let increment = Increment {
        stress_state: StressState::ThreeD,
        strain: [0.0; 6],
        strain_increment: [0.0; 6],
        stress: [0.0; 6],
        characteristic_length: Some(1e5),
        time_increment: 1.0,
        temperature: 0.0,
    };
    let parameters = parameters_of::<ConcreteDamage>(&spec).expect("consistent");
    let failure = advance_values::<ConcreteDamage>(&parameters, &increment, &mut [0.0; 13], Request::Stress);
    assert!(matches!(
        failure,
        Err(Failure::Configuration(ConfigurationError::CharacteristicLengthTooLarge { parameter: "G_f", .. }))
    ));
}

/// A host that changes CELENT in mid-run gets an error as soon as it matters.
#[test]
fn a_length_that_grows_too_large_is_refused() {
    let props = with(defaults(), &[("G_f", 0.1)]);
    let mut point = Point::<ConcreteDamage>::virgin(&props, StressState::ThreeD);
    point.characteristic_length = Some(20.0);
    point.advance(&[1e-5, 0.0, 0.0, 0.0, 0.0, 0.0]);
    let increment = Increment {
        stress_state: StressState::ThreeD,
        strain: [4e-4, 0.0, 0.0, 0.0, 0.0, 0.0],
        strain_increment: [3.9e-4, 0.0, 0.0, 0.0, 0.0, 0.0],
        stress: point.stress,
        characteristic_length: Some(1e5),
        time_increment: 1.0,
        temperature: 0.0,
    };
    let failure = advance_values::<ConcreteDamage>(&point.parameters, &increment, &mut point.state, Request::Stress);
    assert!(matches!(
        failure,
        Err(Failure::Configuration(ConfigurationError::CharacteristicLengthTooLarge { parameter: "G_f", .. }))
    ));
}

/// A softening point refuses the same lengths as a first call, up to the same limit, which follows from a bound on the
/// slope.
#[test]
fn a_softening_point_refuses_every_length_above_the_limit() {
    type Case = (&'static [(&'static str, f64)], &'static str, [f64; 2]);
    let cases: [Case; 4] = [
        (&[("G_f", 0.1)], "G_f", [1e-5, 4e-4]),
        (&[("G_f", 0.1), ("nu", 0.0), ("B_t", 1.5), ("b_t", 0.3)], "G_f", [1e-5, 1e-3]),
        (&[("G_c", 20.0), ("B_c", 1.5)], "G_c", [-1e-5, -8e-3]),
        (&[("G_c", 20.0), ("B_c", 1.3), ("beta", 0.9)], "G_c", [-1e-5, -8e-3]),
    ];
    for (changes, parameter, [first, last]) in cases {
        let props = with(defaults(), changes);
        let parameters = parameters_of::<ConcreteDamage>(&props).expect("consistent");
        let Err(ConfigurationError::CharacteristicLengthTooLarge { limit, .. }) =
            ConcreteDamage::check_characteristic_length(&parameters, Some(1e9))
        else {
            panic!("a limit")
        };
        for (softening, point) in parameters.softening(Some(limit)).iter().map(|softening| {
            let peak = super::super::crack_band::peak(&softening.curve);
            (softening, peak)
        }) {
            let steepest = (0..2000).map(|k| softening.curve.point(point.eta.ln() + 0.01 * f64::from(k)).slope);
            assert!(steepest.fold(0.0, f64::min) > softening.curve.slope_bound(&point), "{changes:?}");
        }
        for (length, accepted) in [(0.2, true), (0.999, true), (1.001, false), (1.5, false), (100.0, false)] {
            let mut point = Point::<ConcreteDamage>::virgin(&props, StressState::ThreeD);
            point.characteristic_length = Some(0.5 * limit);
            point.advance(&[first, 0.0, 0.0, 0.0, 0.0, 0.0]);
            let increment = Increment {
                stress_state: StressState::ThreeD,
                strain: [last, 0.0, 0.0, 0.0, 0.0, 0.0],
                strain_increment: [last - first, 0.0, 0.0, 0.0, 0.0, 0.0],
                stress: point.stress,
                characteristic_length: Some(length * limit),
                time_increment: 1.0,
                temperature: 0.0,
            };
            match advance_values::<ConcreteDamage>(&point.parameters, &increment, &mut point.state, Request::Stress) {
                Ok(_) => assert!(accepted, "{changes:?}: {length}"),
                Err(Failure::Configuration(ConfigurationError::CharacteristicLengthTooLarge {
                    parameter: named,
                    ..
                })) => assert!(!accepted && named == parameter, "{changes:?}: {length}, {named}"),
                Err(other) => panic!("{changes:?}, {length}: {other:?}"),
            }
        }
    }
}

/// Without a length the law would be another one: it refuses to go on, in every increment.
#[test]
fn a_fracture_energy_asks_for_a_length_in_every_increment() {
    for (energy, strains) in [("G_f", [1e-5, 3e-4]), ("G_c", [-1e-5, -3e-3])] {
        let props = with(defaults(), &[(energy, 20.0)]);
        for before in 0..3 {
            let mut point = Point::<ConcreteDamage>::virgin(&props, StressState::ThreeD);
            point.characteristic_length = Some(5.0);
            for strain in &strains[..before] {
                point.advance(&[*strain, 0.0, 0.0, 0.0, 0.0, 0.0]);
            }
            let mut increment = Increment::at_rest(StressState::ThreeD);
            increment.strain[0] = strains[0];
            let missing = ConfigurationError::CharacteristicLengthMissing { parameter: energy };
            let outcome =
                advance_values::<ConcreteDamage>(&point.parameters, &increment, &mut point.state, Request::Stress);
            assert_eq!(outcome.err(), Some(Failure::Configuration(missing)), "{energy}, {before}");
        }
    }
}

#[test]
fn the_state_says_whether_the_band_works() {
    let props = with(defaults(), &[("G_f", 0.1)]);
    for (props, expected) in [(defaults(), 0.0), (props, 1.0)] {
        let mut point = Point::<ConcreteDamage>::virgin(&props, StressState::ThreeD);
        point.characteristic_length = Some(20.0);
        for strain in [1e-5, 4e-4] {
            point.advance(&[strain, 0.0, 0.0, 0.0, 0.0, 0.0]);
            assert_eq!(point.state[CRACK_BAND], expected);
        }
    }
    for change in [("B_t", 1.0), ("B_t", 0.9)] {
        assert!(matches!(
            parameters_of::<ConcreteDamage>(&with(props, &[change])),
            Err(ConfigurationError::Inconsistent { .. })
        ));
    }
    assert!(parameters_of::<ConcreteDamage>(&with(defaults(), &[("G_c", 20.0), ("B_c", 0.94)])).is_err());
}

/// With the length at which the curve itself has the fracture energy the band changes nothing; peaks never
/// change.
#[test]
fn stretch_leaves_the_curve_up_to_the_peak() {
    for length in [5.0, 30.0, 80.0] {
        let props = with(defaults(), &[("G_f", 0.1), ("G_c", 25.0)]);
        for (end, peak) in [(2e-4, 3.5), (-3e-3, 27.6)] {
            let mut path = StressRatio::virgin(&props, 0.0);
            path.point.characteristic_length = Some(length);
            assert!((path.peak(end, 2000) - peak).abs() < 5e-3);
        }
    }
}
