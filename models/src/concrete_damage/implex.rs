#![doc = include_str!("implex.md")]

use super::degraded::Degraded;
use super::evolution::Evolution;
use super::{
    CRACK_BAND, ConcreteDamage, DISSIPATED_ENERGY_STATE, HISTORY_STATES, History, PARAMETERS, Parameters,
    STATES as IMPLICIT_STATES, STRAIN_33_STATE, begin, crack_band, overflow, solve_point, trial_strain,
};
use crate::linear_elastic::{DISSIPATED_ENERGY, STRAIN_33};
use crate::tensor::work;
use umat_abi::law::{ConfigurationError, Failure, Increment, Law, LawInfo, Request, Response, StressState};
use umat_abi::metadata::{DerivedOutput, OVERSTRESS_WORK, StateVariable, flags};

/// The law.
pub struct ConcreteDamageImplex;

/// η of D = 1 − 10⁻⁶, beyond which nothing is extrapolated.
const LARGEST_EXTRAPOLATED_ETA: f64 = 999_999.0;
/// How fast τ falls where increments are shorter.
const FADING: f64 = 0.5;
/// R: of the virgin stiffness of a crack against its opening.
const RESISTANCE: f64 = 2e-5;

const STATES: [StateVariable; 14] = [
    HISTORY_STATES[0],
    HISTORY_STATES[1],
    HISTORY_STATES[2],
    HISTORY_STATES[3],
    HISTORY_STATES[4],
    StateVariable::new(c"eta_t_rate", c"1/s", c"rate of eta_t in the last increment"),
    StateVariable::new(c"eta_c_rate", c"1/s", c"rate of eta_c in the last increment"),
    StateVariable::new(c"eta_t_applied", c"-", c"eta_t that the stress was computed with"),
    StateVariable::new(c"eta_c_applied", c"-", c"eta_c that the stress was computed with"),
    StateVariable::new(c"lag_time", c"s", c"time in which the applied damage follows"),
    StateVariable::new(c"stored_energy", c"N*mm/mm^3", c"energy stored at the applied damage"),
    StateVariable::new(
        OVERSTRESS_WORK,
        c"N*mm/mm^3",
        c"work of the stress beyond that of the implicit law, its amount",
    ),
    STRAIN_33,
    DISSIPATED_ENERGY,
];

const RATE: [usize; 2] = [5, 6];
const APPLIED: [usize; 2] = [7, 8];
const LAG_TIME: usize = 9;
const STORED_ENERGY: usize = 10;
const OVERSTRESS: usize = 11;
/// Where STRAIN_33 and DISSIPATED_ENERGY stand here, and in the implicit law.
const LAST: [(usize, usize); 2] = [(12, STRAIN_33_STATE), (13, DISSIPATED_ENERGY_STATE)];

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
        let lag_time = increment.time_increment.max(state[LAG_TIME] - FADING * increment.time_increment);
        let share = increment.time_increment / lag_time;
        let reached = [history.tension.eta, history.compression.eta];
        let extrapolated: [f64; 2] = std::array::from_fn(|i| {
            let eta = extrapolated(reached[i], state[RATE[i]], increment.time_increment);
            if share < 1.0 { approached(state[APPLIED[i]], eta, share) } else { eta }
        });
        let softening = parameters.softening(increment.characteristic_length);
        let evolve =
            |strain: &[f64; 3]| Evolution::at_given_damage(parameters, &softening, &history, extrapolated, strain);
        let trial = trial_strain(increment, &implicit);
        let point = solve_point(parameters, evolve, &history, increment, &implicit, trial)?;
        let resistance = resistance(parameters, increment.stress_state, extrapolated[0], share);
        let resisting = resistance.map(|row| work(&row, &increment.strain_increment));
        let stress: [f64; 6] = {
            let stress = point.stress(parameters);
            std::array::from_fn(|i| stress[i] + resisting[i])
        };
        let energy = point.evolution.solid.energy();
        let mean = std::array::from_fn(|i| 0.5 * (increment.stress[i] + stress[i]));
        let dissipation = work(&mean, &increment.strain_increment) - (energy - state[STORED_ENERGY]);
        if !point.is_finite(energy, dissipation, &stress) {
            return Err(overflow(parameters, increment));
        }
        let tangent = if request.wants_tangent() {
            let tangent = point.tangent(parameters);
            std::array::from_fn(|i| std::array::from_fn(|j| tangent[i][j] + resistance[i][j]))
        } else {
            [[0.0; 6]; 6]
        };
        let History { tension, compression } = point.evolution.history;
        let end = Degraded::new(parameters, tension.eta, compression.eta, &point.axes.values);
        let overstress: [f64; 6] = {
            let implicit = point.axes.stress(&end.stress);
            std::array::from_fn(|i| stress[i] - implicit[i])
        };
        point.commit(&mut implicit, dissipation);
        implicit[CRACK_BAND] = crack_band(parameters);
        put_implicit_states(&implicit, energy, state);
        for (i, end) in [tension.eta, compression.eta].into_iter().enumerate() {
            state[RATE[i]] = (end - reached[i]) / increment.time_increment;
            state[APPLIED[i]] = extrapolated[i];
        }
        state[LAG_TIME] = lag_time;
        state[OVERSTRESS] += work(&overstress, &increment.strain_increment).abs();
        let dissipated_energy = implicit[DISSIPATED_ENERGY_STATE];
        Response { stress, tangent, stored_energy: energy, dissipated_energy }.finite(state)
    }
}

/// η_n + (Δt/Δt_n)(η_n − η_{n−1}), which the rate of the last increment tells.
#[inline(always)]
fn extrapolated(eta_reached: f64, rate: f64, time_increment: f64) -> f64 {
    (eta_reached + rate * time_increment).min(eta_reached.max(LARGEST_EXTRAPOLATED_ETA))
}

/// The η whose integrity 1/(1 + η) is a share of the way from one to another.
#[inline(always)]
fn approached(from: f64, to: f64, share: f64) -> f64 {
    let [from, to] = [from, to].map(|eta| 1.0 / (1.0 + eta));
    (1.0 / (from + share * (to - from)) - 1.0).max(0.0)
}

/// What resists the strain increment: R D̃_t τ/Δt C.
#[inline(always)]
fn resistance(parameters: &Parameters, stress_state: StressState, eta_t: f64, share: f64) -> [[f64; 6]; 6] {
    let is_plane_stress = stress_state == StressState::PlaneStress;
    let stiffness = parameters.elasticity.tangent(is_plane_stress, Request::StressAndTangent);
    let factor = RESISTANCE / share * eta_t / (1.0 + eta_t);
    stiffness.map(|row| row.map(|c| factor * c))
}
