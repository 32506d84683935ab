#![doc = include_str!("implex.md")]

use super::evolution::{Evolution, History};
use super::stress_and_tangent::{Degraded, Point};
use super::{ConcreteDamage, HISTORY, Parameters, State as ImplicitState, begin};
use crate::linear_elastic::{DISSIPATED_ENERGY, STRAIN_33};
use crate::tensor::work;
use umat_abi::law::{ConfigurationError, Failure, Increment, Law, LawInfo, Request, Response, StressState};
use umat_abi::metadata::{DerivedOutput, OVERSTRESS_WORK, StateVariable, flags};

/// The law.
pub struct ConcreteDamageImplex;

/// η of D = 1 − 10⁻⁶, beyond which nothing is extrapolated.
const LARGEST_EXTRAPOLATED_ETA: f64 = 999_999.0;
/// Rate at which τ falls where increments are shorter.
const FADING: f64 = 0.5;
/// R: of the virgin stiffness of a crack against its opening.
const RESISTANCE: f64 = 2e-5;

umat_abi::states! {
    /// The state variables.
    pub struct State {
        /// η_t.
        pub eta_t: f64 = HISTORY[0];
        /// η_c.
        pub eta_c: f64 = HISTORY[1];
        /// The largest Y_t.
        pub y_t_max: f64 = HISTORY[2];
        /// The largest Y_c.
        pub y_c_max: f64 = HISTORY[3];
        /// 1 where the characteristic length was found good.
        pub crack_band: f64 = HISTORY[4];
        /// Rate of η_t and η_c, 1/s.
        pub rate: [f64; 2] =
            StateVariable::new(c"eta_t_rate", c"1/s", c"rate of eta_t in the last increment"),
            StateVariable::new(c"eta_c_rate", c"1/s", c"rate of eta_c in the last increment");
        /// η̃_t and η̃_c.
        pub applied: [f64; 2] =
            StateVariable::new(c"eta_t_applied", c"-", c"eta_t that the stress was computed with"),
            StateVariable::new(c"eta_c_applied", c"-", c"eta_c that the stress was computed with");
        /// τ.
        pub lag_time: f64 = StateVariable::new(c"lag_time", c"s", c"time in which the applied damage follows");
        /// Ψ at η̃.
        pub stored_energy: f64 =
            StateVariable::new(c"stored_energy", c"N*mm/mm^3", c"energy stored at the applied damage");
        /// Σ |Δσ : Δε|.
        pub overstress_work: f64 = StateVariable::new(
            OVERSTRESS_WORK, c"N*mm/mm^3", c"work of the stress beyond that of the implicit law, its amount",
        );
        /// ε33.
        pub strain_33: f64 = STRAIN_33;
        /// Work that is not stored.
        pub dissipated_energy: f64 = DISSIPATED_ENERGY;
    }
}

impl State {
    /// The states of the implicit law; it has no inelastic strain here.
    #[inline(always)]
    fn implicit(&self) -> ImplicitState {
        let &Self { eta_t, eta_c, y_t_max, y_c_max, crack_band, strain_33, dissipated_energy, .. } = self;
        let inelastic_strain = [0.0; 6];
        ImplicitState { eta_t, eta_c, y_t_max, y_c_max, crack_band, inelastic_strain, strain_33, dissipated_energy }
    }

    /// Takes them over, with the energy stored.
    #[inline(always)]
    fn follow(&mut self, implicit: &ImplicitState, stored_energy: f64) {
        let &ImplicitState { eta_t, eta_c, y_t_max, y_c_max, crack_band, strain_33, dissipated_energy, .. } = implicit;
        let (rate, applied, lag_time, overstress_work) = (self.rate, self.applied, self.lag_time, self.overstress_work);
        *self = Self {
            eta_t,
            eta_c,
            y_t_max,
            y_c_max,
            crack_band,
            rate,
            applied,
            lag_time,
            stored_energy,
            overstress_work,
            strain_33,
            dissipated_energy,
        };
    }
}

impl Law for ConcreteDamageImplex {
    const INFO: LawInfo = LawInfo {
        name: c"concrete_damage_implex",
        description: c"Concrete: concrete_damage (IV-H) with IMPL-EX integration: damage is extrapolated",
        derived: &const { [DerivedOutput::damage(c"D_t", 0), DerivedOutput::damage(c"D_c", 1)] },
        flags: flags::SYMMETRIC_TANGENT
            | flags::THREAD_SAFE
            | flags::USES_CELENT
            | flags::STRESS_ONLY
            | flags::ISOTROPIC,
        ..LawInfo::of::<Parameters, State>()
    };
    type Parameters<'p> = Parameters;
    type State = State;

    #[inline(always)]
    fn check(parameters: &Parameters) -> Result<(), ConfigurationError> {
        ConcreteDamage::check(parameters)?;
        if parameters.has_inelastic_strain() {
            let rule = "IMPL-EX knows no inelastic strain: b_t and b_c must be 0";
            return Err(ConfigurationError::Inconsistent { rule, value: parameters.b_t.max(parameters.b_c) });
        }
        Ok(())
    }

    fn check_characteristic_length(parameters: &Parameters, length: Option<f64>) -> Result<(), ConfigurationError> {
        parameters.check_characteristic_length(length)
    }

    #[inline(always)]
    fn elastic(
        parameters: &Parameters,
        increment: &Increment,
        state: &mut State,
        request: Request,
    ) -> Option<Response> {
        let mut implicit = state.implicit();
        let response = ConcreteDamage::elastic(parameters, increment, &mut implicit, request)?;
        state.follow(&implicit, response.stored_energy);
        Some(response)
    }

    #[inline(never)]
    fn update(
        parameters: &Parameters,
        increment: &Increment,
        state: &mut State,
        request: Request,
    ) -> Result<Response, Failure> {
        let mut implicit = state.implicit();
        if let Some(response) = begin(parameters, increment, &mut implicit, request)? {
            state.follow(&implicit, response.stored_energy);
            return Ok(response);
        }
        let history = History::of(&implicit);
        let lag_time = increment.time_increment.max(state.lag_time - FADING * increment.time_increment);
        let share = increment.time_increment / lag_time;
        let reached = [history.tension.eta, history.compression.eta];
        let applied: [f64; 2] = std::array::from_fn(|i| {
            let eta = extrapolated(reached[i], state.rate[i], increment.time_increment);
            if share < 1.0 { approached(state.applied[i], eta, share) } else { eta }
        });
        let softening = parameters.softening(increment.characteristic_length);
        let evolve = |strain: &[f64; 3]| Evolution::at_given_damage(parameters, &softening, &history, applied, strain);
        let point = Point::solve(parameters, evolve, &history, increment, &implicit)?;
        let resistance = resistance(parameters, increment.stress_state, applied[0], share);
        let resisting = resistance.map(|row| work(&row, &increment.strain_increment));
        let stress: [f64; 6] = {
            let stress = point.stress(parameters);
            std::array::from_fn(|i| stress[i] + resisting[i])
        };
        let stored_energy = point.evolution.solid.energy();
        let mean = std::array::from_fn(|i| 0.5 * (increment.stress[i] + stress[i]));
        let dissipation = work(&mean, &increment.strain_increment) - (stored_energy - state.stored_energy);
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
        point.commit(parameters, increment, &mut implicit, dissipation)?;
        state.follow(&implicit, stored_energy);
        let end = [tension.eta, compression.eta];
        state.rate = std::array::from_fn(|i| (end[i] - reached[i]) / increment.time_increment);
        state.applied = applied;
        state.lag_time = lag_time;
        state.overstress_work += work(&overstress, &increment.strain_increment).abs();
        Ok(Response { stress, tangent, stored_energy, dissipated_energy: state.dissipated_energy })
    }
}

/// Returns η_n + (Δt/Δt_n)(η_n − η_{n−1}) from the rate of the last increment, at most [`LARGEST_EXTRAPOLATED_ETA`].
#[inline(always)]
fn extrapolated(eta_reached: f64, rate: f64, time_increment: f64) -> f64 {
    (eta_reached + rate * time_increment).min(eta_reached.max(LARGEST_EXTRAPOLATED_ETA))
}

/// Returns the η whose integrity 1/(1 + η) lies at a share of the way from that of `from` to that of `to`.
#[inline(always)]
fn approached(from: f64, to: f64, share: f64) -> f64 {
    let [from, to] = [from, to].map(|eta| 1.0 / (1.0 + eta));
    (1.0 / (from + share * (to - from)) - 1.0).max(0.0)
}

/// Returns the stiffness that resists the strain increment: R D̃_t τ/Δt C.
#[inline(always)]
fn resistance(parameters: &Parameters, stress_state: StressState, eta_t: f64, share: f64) -> [[f64; 6]; 6] {
    let is_plane_stress = stress_state == StressState::PlaneStress;
    let stiffness = parameters.elasticity.tangent(is_plane_stress, Request::StressAndTangent);
    let factor = RESISTANCE / share * eta_t / (1.0 + eta_t);
    stiffness.map(|row| row.map(|c| factor * c))
}
