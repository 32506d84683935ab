//! Random admissible parameters, strains of 17 decades: a finite answer, monotone dissipation.

use super::{Random, STRESS_STATES};
use umat_abi::law::{Failure, Increment, Law, Request, check_properties};

/// E over six decades, ν from −0.9 to 0.4999.
pub fn random_elasticity(random: &mut Random) -> [f64; 2] {
    let poisson_ratio = if random.unit() < 0.2 { 0.4999 } else { -0.9 + 1.39 * random.unit() };
    [10_f64.powf(6.0 * random.unit()), poisson_ratio]
}

/// A from 1e-4 to 1e20, B from 0.1 to 30, Y₀ from 1e-6 to 1 or 0.
pub fn random_damage_law(random: &mut Random) -> [f64; 3] {
    let threshold = if random.unit() < 0.3 { 0.0 } else { 10_f64.powf(-6.0 * random.unit()) };
    [10_f64.powf(24.0 * random.unit() - 4.0), 10_f64.powf(2.5 * random.unit() - 1.0), threshold]
}

/// Four strains of 1e-16 to 10 from each of `count` parameter sets; the boundary's own checks must
/// accept the sets. Returns how many updates were answered and how many sets the law refused as
/// inconsistent; a cut-back, a number that is not finite or a falling dissipation fails.
pub fn check_extremes<L: Law>(count: usize, props: impl Fn(&mut Random) -> Vec<f64>) -> (usize, usize) {
    let mut random = Random(0xE87);
    let (mut answered, mut refused) = (0, 0);
    for number in 0..count {
        let props = props(&mut random);
        check_properties(&L::INFO, &props).expect("parameters within their bounds");
        let stress_state = STRESS_STATES[number % 3];
        let Ok(parameters) = L::parameters(&props) else {
            refused += 1;
            continue;
        };
        let mut state = vec![0.0; L::INFO.states.len()];
        for _ in 0..4 {
            let size = 10_f64.powf(17.0 * random.unit() - 16.0);
            let strain = random.strain(stress_state, size);
            let increment = Increment {
                stress_state,
                strain,
                strain_increment: strain,
                stress: [0.0; 6],
                characteristic_length: None,
            };
            let dissipated = state[state.len() - 1];
            let response = match L::update(&parameters, &increment, &mut state, Request::StressAndTangent) {
                Ok(response) => response,
                Err(Failure::Configuration(_)) => {
                    refused += 1;
                    break;
                }
                Err(failure) => panic!("{failure:?} with {props:?} at {strain:?}"),
            };
            let numbers = response.stress.iter().chain(response.tangent.iter().flatten()).chain(&state);
            assert!(numbers.chain([&response.stored_energy]).all(|x| x.is_finite()), "{props:?} at {strain:?}");
            assert!(response.dissipated_energy >= dissipated, "{props:?} at {strain:?}");
            answered += 1;
        }
    }
    (answered, refused)
}
