//! Invariants of any history, and of the virgin solid.

use super::rotation::rotation_error;
use super::{Point, Promises, Random, Sample};
use models::linear_elastic::LinearElastic;
use models::tensor::Elasticity;
use umat_abi::law::{Law, Request, StressState};
use umat_abi::table::States;

/// Holds the response to turned strains against the turned response, of many histories.
pub fn check_rotation<L: Law>(sample: &Sample<'_>, stress_state: StressState, count: usize) {
    let mut random = Random::new(0x0707);
    for _ in 0..count {
        let (error, strain) = rotation_error::<L>(sample, stress_state, &mut random);
        assert!(error <= 1.0, "{}: {error} of what is allowed at {strain:?}", L::INFO.name.to_string_lossy());
    }
}

/// On random histories: named states never decrease, nor does dissipation, zero increments change nothing (as the law
/// promises); a call repeated gives the same bits.
pub fn check_invariants<L: Law>(sample: &Sample<'_>, stress_state: StressState, promises: &Promises<'_>) {
    let mut random = Random::new(0xD155);
    let modulus = Elasticity::new(sample.props[0], sample.props[1]).stiffness()[0][0];
    let index =
        |name: &str| L::INFO.states.iter().position(|s| s.name() == name).unwrap_or_else(|| panic!("no state {name}"));
    let monotone: Vec<usize> = promises.monotone.iter().map(|name| index(name)).collect();
    for _ in 0..promises.histories {
        let mut point = sample.point::<L>(stress_state);
        let mut largest_strain = 0.0_f64;
        for _ in 0..6 {
            let scale = sample.size * 10_f64.powf(3.0 * random.unit() - 1.5);
            let strain = random.strain(stress_state, scale);
            let before = point.state.clone();
            let (first, first_state) = point.trial(&strain);
            let (again, again_state) = point.trial(&strain);
            assert_eq!(first.stress, again.stress);
            assert_eq!(first_state, again_state);
            check_early_way_out(&point, &strain, &mut random);
            let response = point.advance(&strain);
            assert!(response.stress.iter().chain(response.tangent.iter().flatten()).all(|x| x.is_finite()));
            for &k in &monotone {
                assert!(point.state[k] >= before[k], "{} decreased", L::INFO.states[k].name());
            }
            if promises.dissipative {
                let last = point.state.len() - 1;
                assert!(point.state[last] >= before[last], "dissipation decreased at {strain:?} from {before:?}");
                assert_eq!(response.dissipated_energy, point.state[last]);
            }
            if !promises.steady {
                continue;
            }
            let (still, still_state) = point.trial(&strain);
            let largest = response.stress.iter().fold(0.0_f64, |m, x| m.max(x.abs()));
            // elastic strains are what is left of strains and inelastic ones
            largest_strain = strain.iter().fold(largest_strain, |m, x| m.max(x.abs()));
            let summed = modulus * largest_strain;
            for i in 0..6 {
                let error = (still.stress[i] - response.stress[i]).abs();
                assert!(error <= 1e-13 * largest + 4.0 * f64::EPSILON * summed, "{error:e} at {strain:?}");
            }
            for &k in &monotone {
                assert!((still_state[k] - point.state[k]).abs() <= 1e-13 * point.state[k].abs());
            }
        }
    }
}

/// Checks that hosts get the response of [`Law::elastic`], and that it leaves the state untouched where it gives none:
/// at NaN and infinity too, which nothing has excluded before.
fn check_early_way_out<L: Law>(point: &Point<'_, L>, strain: &[f64; 6], random: &mut Random) {
    let early = |strain: &[f64; 6]| {
        let mut state = L::State::read(&point.state);
        let request = Request::StressAndTangent;
        let response = L::elastic(&point.parameters, &point.increment(strain), &mut state, request);
        let mut values = point.state.clone();
        state.write(&mut values);
        (response, values)
    };
    match early(strain) {
        (Some(response), state) => {
            let (expected, expected_state) = point.trial(strain);
            assert_eq!(
                (response.stress, response.tangent, response.stored_energy, state),
                (expected.stress, expected.tangent, expected.stored_energy, expected_state)
            );
            assert_eq!(response.dissipated_energy, expected.dissipated_energy);
        }
        (None, state) => assert_eq!(state, point.state),
    }
    let components = point.stress_state.components();
    for poison in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY, f64::MAX] {
        let mut strain = *strain;
        strain[components[(random.unit() * components.len() as f64) as usize]] = poison;
        let (response, state) = early(&strain);
        assert!(response.is_none() && state == point.state, "{response:?} at {strain:?}");
    }
}

/// All-zero STATEV is virgin: zero strain gives zero stress, zero states and the elastic tangent, bit for bit; a
/// strain below every threshold gives the elastic stress to a few units of the last digit and no damage.
pub fn check_virgin<L: Law>(sample: &Sample<'_>, stress_state: StressState, elastic_size: f64, history: &[&str]) {
    let elastic = Point::<LinearElastic>::virgin(&sample.props[..2], stress_state);
    let point = sample.point::<L>(stress_state);
    let (response, state) = point.trial(&[0.0; 6]);
    assert_eq!(response.stress, [0.0; 6]);
    assert!(state.iter().zip(L::INFO.states).all(|(x, variable)| *x == 0.0 || variable.name() == "crack_band"));
    let stiffness = elastic.trial(&[0.0; 6]).0.tangent;
    // of space: the linear law itself condenses plane stress out of it
    let modulus = Elasticity::new(sample.props[0], sample.props[1]).stiffness()[0][0];
    // ulps of the products that a stress or a tangent is the sum of
    let close = |a: &[f64], b: &[f64], scale: f64, ulps: f64| {
        a.iter().zip(b).all(|(x, y)| (x - y).abs() <= ulps * f64::EPSILON * scale)
    };
    assert!(close(response.tangent.as_flattened(), stiffness.as_flattened(), modulus, 4.0), "{:?}", response.tangent);
    let mut random = Random::new(0xE1A5);
    for _ in 0..100 {
        let scale = elastic_size * random.unit();
        let strain = random.strain(stress_state, scale);
        let ((response, state), (expected, _)) = (point.trial(&strain), elastic.trial(&strain));
        let (stress, linear) = (response.stress, expected.stress);
        let products = modulus * strain.iter().map(|x| x.abs()).sum::<f64>();
        assert!(close(&stress, &linear, products, 4.0), "{stress:?} {linear:?} at {strain:?}");
        let tangent = response.tangent;
        assert!(close(tangent.as_flattened(), stiffness.as_flattened(), modulus, 16.0), "{tangent:?} {stiffness:?}");
        for (value, variable) in state.iter().zip(L::INFO.states) {
            assert!(*value == 0.0 || !history.contains(&variable.name()), "{} = {value}", variable.name());
        }
    }
}

/// Meets strains again that are plastic under large volumetric strains, whose rounding the deviator has: no state may move.
pub fn check_no_second_flow<L: Law>(props: &[f64]) {
    let mut random = Random::new(11);
    for _ in 0..1000 {
        let mut point = Point::<L>::virgin(props, StressState::ThreeD);
        let mean = random.between(-0.3, 0.3);
        let mut strain = random.strain(StressState::ThreeD, 3e-3);
        strain[..3].iter_mut().for_each(|component| *component += mean);
        point.advance(&strain);
        let state = point.state.clone();
        point.advance(&strain);
        assert_eq!(point.state, state, "{strain:?}");
    }
}
