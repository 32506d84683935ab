#![doc = include_str!("doc.md")]

pub mod calibration;
mod crack_band;
mod criteria;
mod dissipation;
mod evolution;
mod fixed_crack;
mod implex;
mod inelastic;
mod phase_field;
mod plane_stress;
mod split;
mod stress_and_tangent;
mod uniaxial;

#[cfg(test)]
mod test;

use crate::damage_law::DamageLaw;
use crate::linear_elastic::{DISSIPATED_ENERGY, STRAIN_33, poisson_ratio, youngs_modulus};
use crate::tensor::Elasticity;
use evolution::{Evolution, History};
use stress_and_tangent::Point;
use umat_abi::law::{ConfigurationError, Failure, Increment, Law, LawInfo, Request, Response};
use umat_abi::metadata::{DerivedOutput, Parameter, StateVariable, flags};

pub use implex::{ConcreteDamageFixed, ConcreteDamageImplex};
pub use phase_field::{ConcretePhaseField, Parameters as PhaseFieldParameters};

umat_abi::parameters! {
    /// The parameters.
    pub struct Parameters {
        /// E, ν.
        pub elasticity: Elasticity = youngs_modulus(31800.0), poisson_ratio(0.18);
        /// A_t, B_t, Y_t0.
        pub tension: DamageLaw =
            Parameter::new(c"A_t", c"1/MPa", 5000.0, c"rate of tensile damage").above(0.0).typically(1e-4, 1e6),
            Parameter::new(c"B_t", c"-", 1.3, c"exponent of tensile damage").above(0.0),
            Parameter::new(c"Y_t0", c"MPa", 1.905_077e-4, c"threshold of tensile damage")
                .at_least(0.0)
                .typically(1e-7, 0.1);
        /// A_c, B_c, Y_c0.
        pub compression: DamageLaw =
            Parameter::new(c"A_c", c"1/MPa", 31.47479, c"rate of compressive damage").above(0.0).typically(1e-4, 1e6),
            Parameter::new(c"B_c", c"-", 1.05, c"exponent of compressive damage").above(0.0),
            Parameter::new(c"Y_c0", c"MPa", 3.0e-4, c"threshold of compressive damage")
                .at_least(0.0)
                .typically(1e-7, 1.0);
        /// β: how much of the hydrostatic stiffness compressive damage takes.
        pub beta: f64 =
            Parameter::new(c"beta", c"-", 0.17227, c"share of the hydrostatic stiffness lost by compressive damage")
                .within(0.0, 1.0);
        /// ζ_c: how much confinement delays compressive damage.
        pub zeta_c: f64 =
            Parameter::new(c"zeta_c", c"-", 0.0, c"delay of compressive damage by confinement").at_least(0.0);
        /// b_t: inelastic fraction of the growth of tensile strain.
        pub b_t: f64 = Parameter::new(c"b_t", c"-", 0.0, c"inelastic fraction of tensile strain growth (0: none)")
            .at_least(0.0)
            .below(1.0);
        /// b_c: the same in compression.
        pub b_c: f64 = Parameter::new(c"b_c", c"-", 0.0, c"inelastic fraction of compressive strain growth (0: none)")
            .at_least(0.0)
            .below(1.0);
        /// G_f, N/mm; 0: no crack band in tension.
        pub fracture_energy: f64 =
            Parameter::new(c"G_f", c"N/mm", 0.0, c"fracture energy in tension (0: no crack band)")
                .at_least(0.0)
                .typically(0.002, 20.0);
        /// G_c, N/mm; 0: no crack band in compression.
        pub crushing_energy: f64 =
            Parameter::new(c"G_c", c"N/mm", 0.0, c"fracture energy in compression (0: no crack band)")
                .at_least(0.0)
                .typically(0.1, 1000.0);
    }
}

/// The first states of both integrations.
const HISTORY: [StateVariable; 5] = [
    StateVariable::new(c"eta_t", c"-", c"tensile damage D_t/(1 - D_t)"),
    StateVariable::new(c"eta_c", c"-", c"compressive damage D_c/(1 - D_c)"),
    StateVariable::new(c"Y_t_max", c"MPa", c"largest tensile energy release rate above Y_t0 so far"),
    StateVariable::new(c"Y_c_max", c"MPa", c"largest compressive energy release rate above Y_c0 so far"),
    StateVariable::new(c"crack_band", c"-", c"0 off, 1 on"),
];

umat_abi::states! {
    /// The state variables.
    pub struct State {
        /// η and the largest Y of both branches.
        history: History = HISTORY[0], HISTORY[1], HISTORY[2], HISTORY[3];
        /// 1 where the characteristic length was found good.
        pub crack_band: f64 = HISTORY[4];
        /// ε_p.
        pub inelastic_strain: [f64; 6] =
            StateVariable::new(c"inelastic_strain_11", c"-", c"inelastic strain").strain_component(1),
            StateVariable::new(c"inelastic_strain_22", c"-", c"inelastic strain").strain_component(2),
            StateVariable::new(c"inelastic_strain_33", c"-", c"inelastic strain").strain_component(3),
            StateVariable::new(c"inelastic_strain_12", c"-", c"inelastic strain, engineering shear").strain_component(4),
            StateVariable::new(c"inelastic_strain_13", c"-", c"inelastic strain, engineering shear").strain_component(5),
            StateVariable::new(c"inelastic_strain_23", c"-", c"inelastic strain, engineering shear").strain_component(6);
        /// ε33.
        pub strain_33: f64 = STRAIN_33;
        /// Energy dissipated by damage and inelastic strain.
        pub dissipated_energy: f64 = DISSIPATED_ENERGY;
    }
}

impl State {
    /// ε − ε_p.
    #[inline(always)]
    fn trial_strain(&self, strain: &[f64; 6]) -> [f64; 6] {
        std::array::from_fn(|i| strain[i] - self.inelastic_strain[i])
    }
}

/// The law.
pub struct ConcreteDamage;

impl Law for ConcreteDamage {
    const INFO: LawInfo = LawInfo {
        name: c"concrete_damage",
        description: c"Concrete: tensile and compressive damage with crack closure (IV-H), inelastic strain (IV-HP)",
        derived: &const { [DerivedOutput::damage(c"D_t", 0), DerivedOutput::damage(c"D_c", 1)] },
        // no PATH_EXACT: IV-HP (b_t, b_c > 0) is not, and a flag speaks for all parameters
        flags: flags::THREAD_SAFE | flags::USES_CELENT | flags::STRESS_ONLY | flags::ISOTROPIC,
        ..LawInfo::of::<Parameters, State>()
    };
    type Parameters<'p> = Parameters;
    type State = State;

    #[inline(always)]
    fn check(parameters: &Parameters) -> Result<(), ConfigurationError> {
        parameters.check_exponents()
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
        if length_is_unchecked(parameters, increment, state) || !state.history.is_undamaged() {
            return None;
        }
        stress_and_tangent::elastic_response(parameters, increment, state, request)
    }

    // of its own: the elastic one stays short
    #[inline(never)]
    fn update(
        parameters: &Parameters,
        increment: &Increment,
        state: &mut State,
        request: Request,
    ) -> Result<Response, Failure> {
        if let Some(response) = begin(parameters, increment, state, request)? {
            return Ok(response);
        }
        let history = state.history;
        let softening = parameters.softening(increment.characteristic_length);
        let evolve = |strain: &[f64; 3]| Evolution::new(parameters, &softening, &history, strain);
        let point = Point::solve(parameters, evolve, &history, increment, state)?;
        let stress = point.stress(parameters);
        let tangent = if request.wants_tangent() { point.tangent(parameters) } else { [[0.0; 6]; 6] };
        let dissipation = point.dissipation(parameters, &softening, &history, increment, state, &stress);
        point.commit(parameters, increment, state, dissipation)?;
        let (stored_energy, dissipated_energy) = (point.evolution.solid.energy(), state.dissipated_energy);
        Ok(Response { stress, tangent, stored_energy, dissipated_energy })
    }
}

/// A UMAT has no set-up phase: the first call of a point is where the length is checked. None at all is seen in any.
#[inline(always)]
fn length_is_unchecked(parameters: &Parameters, increment: &Increment, state: &State) -> bool {
    parameters.wants_crack_band() && (increment.characteristic_length.is_none() || state.crack_band != 1.0)
}

/// Checks the length at the first call of a point; the response if it turns out to be elastic.
#[inline(always)]
fn begin(
    parameters: &Parameters,
    increment: &Increment,
    state: &mut State,
    request: Request,
) -> Result<Option<Response>, Failure> {
    if !length_is_unchecked(parameters, increment, state) {
        return Ok(None);
    }
    parameters.check_characteristic_length(increment.characteristic_length)?;
    state.crack_band = 1.0;
    Ok(ConcreteDamage::elastic(parameters, increment, state, request))
}
