#![doc = include_str!("doc.md")]

use crate::damage_law::{DamageLaw, exponent_parameter, integrity, scale_parameter, threshold_parameter};
use crate::linear_elastic::{DISSIPATED_ENERGY, STRAIN_33, poisson_ratio, youngs_modulus};
use crate::tensor::{Elasticity, IsotropicSplit, add_dyad, isotropic_stiffness};
use umat_abi::law::{Failure, Increment, Law, LawInfo, Request, Response, StressState};
use umat_abi::metadata::{DerivedOutput, StateVariable, flags};

#[cfg(test)]
mod test;

umat_abi::parameters! {
    /// The parameters.
    pub struct Parameters {
        /// E, ν.
        pub elasticity: Elasticity = youngs_modulus(31800.0), poisson_ratio(0.18);
        /// A, B, Y_0.
        pub damage_law: DamageLaw =
            scale_parameter(c"A", 5000.0), exponent_parameter(c"B", 1.3), threshold_parameter(c"Y_0", 2e-4);
    }
}

umat_abi::states! {
    /// The state variables.
    pub struct State {
        /// η.
        pub eta: f64 = StateVariable::new(c"eta", c"-", c"D/(1 - D)");
        /// The largest Y.
        pub release_rate: f64 = StateVariable::new(c"Y_max", c"MPa", c"largest damage energy release rate so far");
        /// ε33.
        pub strain_33: f64 = STRAIN_33;
        /// ∫ Y dD.
        pub dissipated_energy: f64 = DISSIPATED_ENERGY;
    }
}

/// The law.
pub struct PureDamage;

impl Law for PureDamage {
    const INFO: LawInfo = LawInfo {
        name: c"pure_damage",
        description: c"Model I: one isotropic damage variable, no inelastic strain",
        derived: &const { [DerivedOutput::damage(c"D", 0)] },
        flags: flags::SYMMETRIC_TANGENT
            | flags::THREAD_SAFE
            | flags::STRESS_ONLY
            | flags::PATH_EXACT
            | flags::ISOTROPIC,
        ..LawInfo::of::<Parameters, State>()
    };
    type Parameters<'p> = Parameters;
    type State = State;

    #[inline(always)]
    fn elastic(
        Parameters { elasticity, damage_law }: &Parameters,
        increment: &Increment,
        state: &mut State,
        request: Request,
    ) -> Option<Response> {
        let undamaged = Undamaged::new(elasticity, increment);
        // false for NaN too (0: of a damaged state that a host began with)
        let is_below = undamaged.release_rate <= damage_law.threshold;
        if !is_below || (state.dissipated_energy == 0.0 && state.eta > 0.0) {
            return None;
        }
        undamaged.record(elasticity, increment, state);
        Some(undamaged.response(increment.stress_state, state, request))
    }

    #[inline(always)]
    fn update(
        Parameters { elasticity, damage_law }: &Parameters,
        increment: &Increment,
        state: &mut State,
        request: Request,
    ) -> Result<Response, Failure> {
        let undamaged = Undamaged::new(elasticity, increment);
        let (before, grown) = (state.eta, damage_law.eta(undamaged.release_rate));
        state.eta = before.max(grown);
        // costs more than all the rest: computed only where it can change
        // the closed form is monotone up to its last digit
        if grown > before {
            let dissipation = damage_law.dissipation_on_curve(state.eta, undamaged.release_rate);
            state.dissipated_energy = state.dissipated_energy.max(dissipation);
        } else if state.dissipated_energy == 0.0 {
            state.dissipated_energy = damage_law.dissipation(state.eta);
        }
        undamaged.record(elasticity, increment, state);
        let mut response = undamaged.response(increment.stress_state, state, request);
        if request.wants_tangent() && grown > before {
            let rate = damage_law.damage_rate(undamaged.release_rate, state.eta);
            add_dyad(&mut response.tangent, -rate, &undamaged.stress, &undamaged.stress);
        }
        Ok(response)
    }
}

/// Response of the undamaged solid to the strain at the end of an increment.
struct Undamaged {
    twice_shear: f64,
    bulk: f64,
    /// s̄.
    stress: [f64; 6],
    /// Y.
    release_rate: f64,
}

impl Undamaged {
    #[inline(always)]
    fn new(elasticity: &Elasticity, increment: &Increment) -> Self {
        let split = IsotropicSplit::new(increment.stress_state, &increment.strain);
        let twice_shear = 2.0 * elasticity.shear_modulus;
        let bulk = elasticity.bulk_modulus_in(split.dimension());
        Self {
            twice_shear,
            bulk,
            stress: split.stress(twice_shear, bulk * split.trace),
            release_rate: 0.5 * (twice_shear * split.deviator_norm_squared() + bulk * split.trace * split.trace),
        }
    }

    /// Returns the response with the η of a state, and a tangent that knows nothing of growth.
    #[inline(always)]
    fn response(&self, stress_state: StressState, state: &State, request: Request) -> Response {
        let omega = integrity(state.eta);
        Response {
            stress: self.stress.map(|s| omega * s),
            tangent: if request.wants_tangent() {
                isotropic_stiffness(stress_state, omega * self.twice_shear, omega * self.bulk)
            } else {
                [[0.0; 6]; 6]
            },
            stored_energy: omega * self.release_rate,
            dissipated_energy: state.dissipated_energy,
        }
    }

    /// The states that do not depend on damage.
    #[inline(always)]
    fn record(&self, elasticity: &Elasticity, increment: &Increment, state: &mut State) {
        state.release_rate = state.release_rate.max(self.release_rate);
        state.strain_33 = elasticity.strain_33(increment);
    }
}
