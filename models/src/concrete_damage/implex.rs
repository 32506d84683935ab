#![doc = include_str!("implex.md")]

use super::crack_band::Softening;
use super::criteria::Criteria;
use super::evolution::{Evolution, History};
use super::fixed_crack::{FixedCracks, FreeCracks};
use super::stress_and_tangent::{Degraded, Point, degraded_elasticity};
use super::{ConcreteDamage, HISTORY, Parameters, State as ImplicitState, begin};
use crate::linear_elastic::{DISSIPATED_ENERGY, STRAIN_33};
use crate::roots::bracketed_newton;
use crate::tensor::{Spectral, condense_plane_stress, work};
use umat_abi::law::{ConfigurationError, Failure, Increment, Law, LawInfo, Request, Response, StressState};
use umat_abi::metadata::{DerivedOutput, OVERSTRESS_WORK, Parameter, StateVariable, flags};
use umat_abi::table::{Field, Parameters as _, StateField, States, require};

/// The law.
pub struct ConcreteDamageImplex;

/// η of D = 1 − 10⁻⁶, beyond which nothing is extrapolated.
const LARGEST_EXTRAPOLATED_ETA: f64 = 999_999.0;
/// Rate at which τ falls where increments are shorter.
const FADING: f64 = 0.5;
/// R: of the virgin stiffness of a crack against its opening.
const RESISTANCE: f64 = 2e-5;
/// |ε33| of plane stress in units of the largest component of strain: at most 3, with ν ≤ ½ and the slip of closed cracks.
const LARGEST_STRAIN_33: f64 = 4.0;

umat_abi::states! {
    /// The state variables.
    pub struct State {
        /// η and the largest Y of both branches.
        history: History = HISTORY[0], HISTORY[1], HISTORY[2], HISTORY[3];
        /// 1 where the characteristic length was found good.
        pub crack_band: f64 = HISTORY[4];
        /// Rate of η_t and η_c, 1/s.
        pub rate: [f64; 2] =
            StateVariable::new(c"eta_t_rate", c"1/s", c"rate of eta_t in the last increment"),
            StateVariable::new(c"eta_c_rate", c"1/s", c"rate of eta_c in the last increment");
        /// η̃_t and η̃_c.
        pub applied: [f64; 2] =
            StateVariable::new(c"eta_t_applied", c"-", c"eta_t used for the stress"),
            StateVariable::new(c"eta_c_applied", c"-", c"eta_c used for the stress");
        /// τ.
        pub lag_time: f64 = StateVariable::new(c"lag_time", c"s", c"time constant with which the applied damage follows");
        /// Ψ at η̃.
        pub stored_energy: f64 =
            StateVariable::new(c"stored_energy", c"N*mm/mm^3", c"energy stored at the applied damage");
        /// Σ |Δσ : Δε|.
        pub overstress_work: f64 = StateVariable::new(
            OVERSTRESS_WORK, c"N*mm/mm^3", c"work of the overstress (beyond the implicit law), absolute value",
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
        let &Self { history, crack_band, strain_33, dissipated_energy, .. } = self;
        ImplicitState { history, crack_band, inelastic_strain: [0.0; 6], strain_33, dissipated_energy }
    }

    /// Takes them over, with the energy stored.
    #[inline(always)]
    fn follow(&mut self, implicit: &ImplicitState, stored_energy: f64) {
        let &ImplicitState { history, crack_band, strain_33, dissipated_energy, .. } = implicit;
        *self = Self { history, crack_band, stored_energy, strain_33, dissipated_energy, ..*self };
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
        let rule = "IMPL-EX has no inelastic strain: b_t and b_c must be 0";
        require(!parameters.has_inelastic_strain(), rule, parameters.b_t.max(parameters.b_c))
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
        state.advance(parameters, increment, None, request)
    }
}

/// Rows of [`State`].
const ROWS: &[StateVariable] = State::TABLE;

impl StateField<14> for State {
    fn of(values: [f64; 14]) -> Self {
        Self::read(&values)
    }

    fn values(&self) -> [f64; 14] {
        let mut values = [0.0; 14];
        self.write(&mut values);
        values
    }
}

umat_abi::states! {
    /// The state variables of a law with cracks of fixed direction.
    pub struct FixedState {
        /// n_1 ⊗ n_1 + ½ n_2 ⊗ n_2.
        pub crack: [f64; 6] =
            StateVariable::new(c"crack_11", c"-", c"axes of cracks: n1 x n1 + n2 x n2/2").strain_component(1),
            StateVariable::new(c"crack_22", c"-", c"axes of cracks: n1 x n1 + n2 x n2/2").strain_component(2),
            StateVariable::new(c"crack_33", c"-", c"axes of cracks: n1 x n1 + n2 x n2/2").strain_component(3),
            StateVariable::new(c"crack_12", c"-", c"axes of cracks: n1 x n1 + n2 x n2/2, twice").strain_component(4),
            StateVariable::new(c"crack_13", c"-", c"axes of cracks: n1 x n1 + n2 x n2/2, twice").strain_component(5),
            StateVariable::new(c"crack_23", c"-", c"axes of cracks: n1 x n1 + n2 x n2/2, twice").strain_component(6);
        /// Those of cracks that turn.
        pub turning: State =
            ROWS[0], ROWS[1], ROWS[2], ROWS[3], ROWS[4], ROWS[5], ROWS[6], ROWS[7], ROWS[8], ROWS[9], ROWS[10], ROWS[11], ROWS[12],
            ROWS[13];
    }
}

/// Rows of [`Parameters`].
const CONCRETE: &[Parameter] = Parameters::TABLE;

impl Field<14> for Parameters {
    #[inline(always)]
    fn read(values: [f64; 14]) -> Result<Self, ConfigurationError> {
        umat_abi::table::Parameters::read(&values)
    }
}

umat_abi::parameters! {
    /// The parameters of a law with cracks of fixed direction.
    pub struct FixedParameters {
        /// Those of the concrete.
        pub concrete: Parameters =
            CONCRETE[0], CONCRETE[1], CONCRETE[2], CONCRETE[3], CONCRETE[4], CONCRETE[5], CONCRETE[6], CONCRETE[7], CONCRETE[8],
            CONCRETE[9], CONCRETE[10], CONCRETE[11], CONCRETE[12], CONCRETE[13];
        /// 1/α: the friction of closed cracks.
        pub crack_friction: f64 =
            Parameter::new(c"crack_friction", c"-", 1.0, c"friction of closed cracks; open ones slide freely by opening/friction")
                .within(0.1, 1.0);
    }
}

/// The law with cracks of fixed direction.
pub struct ConcreteDamageFixed;

impl Law for ConcreteDamageFixed {
    const INFO: LawInfo = LawInfo {
        name: c"concrete_damage_fixed",
        description: c"Concrete: concrete_damage_implex with fixed crack directions",
        derived: &const { [DerivedOutput::damage(c"D_t", 6), DerivedOutput::damage(c"D_c", 7)] },
        flags: ConcreteDamageImplex::INFO.flags,
        ..LawInfo::of::<FixedParameters, FixedState>()
    };
    type Parameters<'p> = FixedParameters;
    type State = FixedState;

    #[inline(always)]
    fn check(parameters: &FixedParameters) -> Result<(), ConfigurationError> {
        ConcreteDamageImplex::check(&parameters.concrete)
    }

    fn check_characteristic_length(
        parameters: &FixedParameters,
        length: Option<f64>,
    ) -> Result<(), ConfigurationError> {
        parameters.concrete.check_characteristic_length(length)
    }

    #[inline(always)]
    fn elastic(
        parameters: &FixedParameters,
        increment: &Increment,
        state: &mut FixedState,
        request: Request,
    ) -> Option<Response> {
        ConcreteDamageImplex::elastic(&parameters.concrete, increment, &mut state.turning, request)
    }

    #[inline(never)]
    fn update(
        parameters: &FixedParameters,
        increment: &Increment,
        state: &mut FixedState,
        request: Request,
    ) -> Result<Response, Failure> {
        let FixedParameters { concrete, crack_friction } = parameters;
        state.turning.advance(concrete, increment, Some((&mut state.crack, *crack_friction)), request)
    }
}

impl State {
    /// Advances to the end of an increment; a `crack` keeps its direction, and has a friction.
    #[inline(always)]
    fn advance(
        &mut self,
        parameters: &Parameters,
        increment: &Increment,
        crack: Option<(&mut [f64; 6], f64)>,
        request: Request,
    ) -> Result<Response, Failure> {
        let state = self;
        let mut implicit = state.implicit();
        if let Some(response) = begin(parameters, increment, &mut implicit, request)? {
            state.follow(&implicit, response.stored_energy);
            return Ok(response);
        }
        let lag_time = increment.time_increment.max(state.lag_time - FADING * increment.time_increment);
        let share = increment.time_increment / lag_time;
        let reached = state.history.etas();
        let applied: [f64; 2] = std::array::from_fn(|i| {
            let eta = extrapolated(reached[i], state.rate[i], increment.time_increment);
            if share < 1.0 { approached(state.applied[i], eta, share) } else { eta }
        });
        let softening = parameters.softening(increment.characteristic_length);
        let end = match &crack {
            Some((crack, friction)) if **crack != [0.0; 6] => {
                let cracks = (Spectral::of_strain(crack), *friction);
                End::with_fixed_cracks(parameters, &softening, increment, &implicit, applied, cracks, request)
            }
            _ => End::with_turning_crack(parameters, &softening, increment, &implicit, applied, request)?,
        };
        let resistance = resistance(parameters, increment.stress_state, applied[0], share);
        let resisting = resistance.map(|row| work(&row, &increment.strain_increment));
        let stress: [f64; 6] = std::array::from_fn(|i| end.stress[i] + resisting[i]);
        let mean = std::array::from_fn(|i| 0.5 * (increment.stress[i] + stress[i]));
        let dissipation = work(&mean, &increment.strain_increment) - (end.stored_energy - state.stored_energy);
        let tangent = if request.wants_tangent() {
            std::array::from_fn(|i| std::array::from_fn(|j| end.tangent[i][j] + resistance[i][j]))
        } else {
            [[0.0; 6]; 6]
        };
        let overstress: [f64; 6] = std::array::from_fn(|i| stress[i] - end.implicit_stress[i]);
        implicit.commit(parameters, increment, &end.history, end.strain_33, dissipation)?;
        state.follow(&implicit, end.stored_energy);
        if let Some((crack, _)) = crack
            && *crack == [0.0; 6]
            && state.history.tension.eta > 0.0
        {
            *crack = end.axes.strain(&[1.0, 0.5, 0.0]);
        }
        let grown = state.history.etas();
        state.rate = std::array::from_fn(|i| (grown[i] - reached[i]) / increment.time_increment);
        state.applied = applied;
        state.lag_time = lag_time;
        state.overstress_work += work(&overstress, &increment.strain_increment).abs();
        Ok(Response { stress, tangent, stored_energy: end.stored_energy, dissipated_energy: state.dissipated_energy })
    }
}

/// The end of an increment at the applied damage.
struct End {
    stress: [f64; 6],
    tangent: [[f64; 6]; 6],
    stored_energy: f64,
    /// Damage that the strain calls for, and the stress with it.
    history: History,
    implicit_stress: [f64; 6],
    strain_33: f64,
    /// Directions of the cracks.
    axes: Spectral,
}

impl End {
    fn with_turning_crack(
        parameters: &Parameters,
        softening: &[Softening; 2],
        increment: &Increment,
        state: &ImplicitState,
        applied: [f64; 2],
        request: Request,
    ) -> Result<Self, Failure> {
        let history = state.history;
        let evolve = |strain: &[f64; 3]| Evolution::at_given_damage(parameters, softening, &history, applied, strain);
        let point = Point::solve(parameters, evolve, &history, increment, state)?;
        let history = point.evolution.history;
        let implicit = Degraded::new(parameters, history.tension.eta, history.compression.eta, &point.axes.values);
        Ok(Self {
            stress: point.stress(parameters),
            tangent: if request.wants_tangent() { point.tangent(parameters) } else { [[0.0; 6]; 6] },
            stored_energy: point.evolution.solid.energy(),
            history,
            implicit_stress: point.axes.stress(&implicit.stress),
            strain_33: point.trial[2],
            axes: point.axes,
        })
    }

    fn with_fixed_cracks(
        parameters: &Parameters,
        softening: &[Softening; 2],
        increment: &Increment,
        state: &ImplicitState,
        [eta_t, eta_c]: [f64; 2],
        (axes, friction): (Spectral, f64),
        request: Request,
    ) -> Self {
        let is_plane_stress = increment.stress_state == StressState::PlaneStress;
        let elasticity = degraded_elasticity(parameters, eta_c);
        let mut strain = increment.strain;
        if is_plane_stress {
            strain[2] = state.strain_33;
            let size = strain.iter().fold(0.0_f64, |size, e| size.max(e.abs()));
            let largest = LARGEST_STRAIN_33 * size;
            strain[2] = bracketed_newton([-largest, largest], state.strain_33, f64::EPSILON * size, |strain_33| {
                let mut strain = strain;
                strain[2] = strain_33;
                let solid = FixedCracks::new(&elasticity, friction, eta_t, &axes, &strain);
                (solid.stress[2], solid.stiffness()[2][2])
            });
        }
        let solid = FixedCracks::new(&elasticity, friction, eta_t, &axes, &strain);
        let mut stress = solid.stress;
        let tangent = match (request.wants_tangent(), is_plane_stress) {
            (false, _) => [[0.0; 6]; 6],
            (true, false) => solid.stiffness(),
            (true, true) => condense_plane_stress(&solid.stiffness()),
        };
        if is_plane_stress {
            stress[2] = 0.0;
        }
        let criteria = Criteria::new(parameters, &Spectral::of_strain(&strain).values);
        let compressed =
            FreeCracks::new(&parameters.elasticity, friction, &axes, &strain).degradable_energy(parameters);
        let mut history = state.history;
        history.tension.advance(&softening[0], criteria.tension, 0.0);
        history.compression.advance(&softening[1], criteria.confined(parameters, compressed), 0.0);
        let end = degraded_elasticity(parameters, history.compression.eta);
        let implicit_stress = FixedCracks::new(&end, friction, history.tension.eta, &axes, &strain).stress;
        let (stored_energy, strain_33) = (solid.energy(), strain[2]);
        Self { stress, tangent, stored_energy, history, implicit_stress, strain_33, axes }
    }
}

/// Returns η_n + (Δt/Δt_n)(η_n − η_{n−1}) from the rate of the last increment, at most [`LARGEST_EXTRAPOLATED_ETA`].
#[inline(always)]
fn extrapolated(eta_reached: f64, rate: f64, time_increment: f64) -> f64 {
    (eta_reached + rate * time_increment).min(eta_reached.max(LARGEST_EXTRAPOLATED_ETA))
}

/// Returns the η whose integrity 1/(1 + η) is interpolated at a share between those of `from` and `to`.
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
