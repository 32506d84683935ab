#![doc = include_str!("implex.md")]

use super::degraded::Degraded;
use super::evolution::Evolution;
use super::{
    CRACK_BAND, ConcreteDamage, DISSIPATED_ENERGY_STATE, HISTORY_STATES, History, PARAMETERS, Parameters,
    STATES as IMPLICIT_STATES, STRAIN_33_STATE, begin, crack_band, overflow, solve_point, trial_strain,
};
use crate::linear_elastic::{DISSIPATED_ENERGY, STRAIN_33};
use crate::tensor::work;
use umat_abi::law::{ConfigurationError, Failure, Increment, Law, LawInfo, Request, Response};
use umat_abi::metadata::{DerivedOutput, OVERSTRESS_WORK, StateVariable, flags};

/// The law.
pub struct ConcreteDamageImplex;

/// η of D = 1 − 10⁻⁶, beyond which nothing is extrapolated.
const LARGEST_EXTRAPOLATED_ETA: f64 = 999_999.0;

const STATES: [StateVariable; 11] = [
    HISTORY_STATES[0],
    HISTORY_STATES[1],
    HISTORY_STATES[2],
    HISTORY_STATES[3],
    HISTORY_STATES[4],
    StateVariable::new(c"eta_t_rate", c"1/s", c"rate of eta_t in the last increment"),
    StateVariable::new(c"eta_c_rate", c"1/s", c"rate of eta_c in the last increment"),
    StateVariable::new(c"stored_energy", c"N*mm/mm^3", c"energy stored at the extrapolated damage"),
    StateVariable::new(
        OVERSTRESS_WORK,
        c"N*mm/mm^3",
        c"work of the stress beyond that of the implicit law, its amount",
    ),
    STRAIN_33,
    DISSIPATED_ENERGY,
];

const RATE: [usize; 2] = [5, 6];
const STORED_ENERGY: usize = 7;
const OVERSTRESS: usize = 8;
/// Where STRAIN_33 and DISSIPATED_ENERGY stand here, and in the implicit law.
const LAST: [(usize, usize); 2] = [(9, STRAIN_33_STATE), (10, DISSIPATED_ENERGY_STATE)];

/// The states of the implicit law; it has no inelastic strain here.
#[inline(always)]
fn implicit_states(state: &[f64]) -> [f64; IMPLICIT_STATES.len()] {
    let mut states = [0.0; IMPLICIT_STATES.len()];
    let common = ..HISTORY_STATES.len();
    states[common].copy_from_slice(&state[common]);
    LAST.iter().for_each(|&(here, there)| states[there] = state[here]);
    states
}

/// Writes them down, with the energy stored.
#[inline(always)]
fn put_implicit_states(implicit: &[f64; IMPLICIT_STATES.len()], stored_energy: f64, state: &mut [f64]) {
    let common = ..HISTORY_STATES.len();
    state[common].copy_from_slice(&implicit[common]);
    LAST.iter().for_each(|&(here, there)| state[here] = implicit[there]);
    state[STORED_ENERGY] = stored_energy;
}

impl Law for ConcreteDamageImplex {
    const INFO: LawInfo = LawInfo {
        name: c"concrete_damage_implex",
        description: c"Concrete: concrete_damage (IV-H) with IMPL-EX integration: damage is extrapolated",
        parameters: &PARAMETERS,
        repeating: None,
        states: &STATES,
        derived: &const { [DerivedOutput::damage(c"D_t", 0), DerivedOutput::damage(c"D_c", 1)] },
        flags: flags::SYMMETRIC_TANGENT
            | flags::THREAD_SAFE
            | flags::USES_CELENT
            | flags::STRESS_ONLY
            | flags::ISOTROPIC,
    };

    const FINITE_OR_FAILS: bool = true;
    const USES_TIME_INCREMENT: bool = true;

    type Parameters<'p> = Parameters;

    #[inline(always)]
    fn parameters(props: &[f64]) -> Result<Parameters, ConfigurationError> {
        let parameters = ConcreteDamage::parameters(props)?;
        if parameters.has_inelastic_strain() {
            let rule = "IMPL-EX knows no inelastic strain: b_t and b_c must be 0";
            return Err(ConfigurationError::Inconsistent { rule, value: parameters.b_t.max(parameters.b_c) });
        }
        Ok(parameters)
    }

    fn needs_characteristic_length(parameters: &Parameters) -> bool {
        ConcreteDamage::needs_characteristic_length(parameters)
    }

    fn check_characteristic_length(parameters: &Parameters, length: f64) -> Result<(), ConfigurationError> {
        ConcreteDamage::check_characteristic_length(parameters, length)
    }

    #[inline(always)]
    fn elastic(
        parameters: &Parameters,
        increment: &Increment,
        state: &mut [f64],
        request: Request,
    ) -> Option<Response> {
        let mut implicit = implicit_states(state);
        let response = ConcreteDamage::elastic(parameters, increment, &mut implicit, request)?;
        put_implicit_states(&implicit, response.stored_energy, state);
        Some(response)
    }

    #[inline]
    fn update(
        parameters: &Parameters,
        increment: &Increment,
        state: &mut [f64],
        request: Request,
    ) -> Result<Response, Failure> {
        if let Some(response) = Self::elastic(parameters, increment, state, request) {
            return Ok(response);
        }
        let mut implicit = implicit_states(state);
        if let Some(response) = begin(parameters, increment, &mut implicit, request)? {
            put_implicit_states(&implicit, response.stored_energy, state);
            return Ok(response);
        }
        let history = History::of(&implicit);
        let extrapolated = [
            extrapolated(history.tension.eta, state[RATE[0]], increment.time_increment),
            extrapolated(history.compression.eta, state[RATE[1]], increment.time_increment),
        ];
        let softening = parameters.softening(increment.characteristic_length);
        let evolve =
            |strain: &[f64; 3]| Evolution::at_given_damage(parameters, &softening, &history, extrapolated, strain);
        let trial = trial_strain(increment, &implicit);
        let point = solve_point(parameters, evolve, &history, increment, &implicit, trial)?;
        let stress = point.stress(parameters);
        let energy = point.evolution.solid.energy();
        let mean = std::array::from_fn(|i| 0.5 * (increment.stress[i] + stress[i]));
        let dissipation = work(&mean, &increment.strain_increment) - (energy - state[STORED_ENERGY]);
        if !point.is_finite(energy, dissipation, &stress) {
            return Err(overflow(parameters, increment));
        }
        let tangent = if request.wants_tangent() { point.tangent(parameters) } else { [[0.0; 6]; 6] };
        let History { tension, compression } = point.evolution.history;
        let end = Degraded::new(parameters, tension.eta, compression.eta, &point.axes.values);
        let overstress: [f64; 6] = {
            let implicit = point.axes.stress(&end.stress);
            std::array::from_fn(|i| stress[i] - implicit[i])
        };
        point.commit(&mut implicit, dissipation);
        implicit[CRACK_BAND] = crack_band(parameters);
        put_implicit_states(&implicit, energy, state);
        state[RATE[0]] = (tension.eta - history.tension.eta) / increment.time_increment;
        state[RATE[1]] = (compression.eta - history.compression.eta) / increment.time_increment;
        state[OVERSTRESS] += work(&overstress, &increment.strain_increment).abs();
        let dissipated_energy = implicit[DISSIPATED_ENERGY_STATE];
        Response { stress, tangent, stored_energy: energy, dissipated_energy }.finite(state)
    }
}

/// η̃ = η_n + (Δt/Δt_n)(η_n − η_{n−1}), which the rate of the last increment tells.
#[inline(always)]
fn extrapolated(eta_reached: f64, rate: f64, time_increment: f64) -> f64 {
    (eta_reached + rate * time_increment).min(eta_reached.max(LARGEST_EXTRAPOLATED_ETA))
}
