#![doc = include_str!("doc.md")]

use crate::tensor::Elasticity;
use umat_abi::law::{Failure, Increment, Law, LawInfo, Request, Response, StressState};
use umat_abi::metadata::{Parameter, StateVariable, flags};

#[cfg(test)]
mod test;

/// Young's modulus, the first parameter of every law of a solid. Its usual range is from polymers to diamond, so that
/// most values in GPa or kPa are outside.
pub(crate) const fn youngs_modulus(default_value: f64) -> Parameter {
    Parameter::new(c"E", c"MPa", default_value, c"Young's modulus").above(0.0).typically(500.0, 1.2e6)
}

/// Poisson's ratio, the second.
pub(crate) const fn poisson_ratio(default_value: f64) -> Parameter {
    Parameter::new(c"nu", c"-", default_value, c"Poisson's ratio").above(-1.0).below(0.5)
}

/// Total strain 33, the last but one state of every law of a solid.
pub(crate) const STRAIN_33: StateVariable =
    StateVariable::new(c"strain_33", c"-", c"total strain 33, also where the mode leaves it free");

/// Dissipated energy, the last one.
pub(crate) const DISSIPATED_ENERGY: StateVariable =
    StateVariable::new(c"dissipated_energy", c"N*mm/mm^3", c"energy dissipated since the virgin state");

umat_abi::parameters! {
    /// The parameters.
    pub struct Parameters {
        /// E, ν.
        pub elasticity: Elasticity = youngs_modulus(31800.0), poisson_ratio(0.18);
    }
}

umat_abi::states! {
    /// The state variables.
    pub struct State {
        /// ε33.
        pub strain_33: f64 = STRAIN_33;
        /// Stays 0.
        pub dissipated_energy: f64 = DISSIPATED_ENERGY;
    }
}

/// The law.
pub struct LinearElastic;

impl Law for LinearElastic {
    const INFO: LawInfo = LawInfo {
        name: c"linear_elastic",
        description: c"Isotropic linear elasticity",
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
    fn update(
        Parameters { elasticity }: &Parameters,
        increment: &Increment,
        state: &mut State,
        request: Request,
    ) -> Result<Response, Failure> {
        let plane_stress = increment.stress_state == StressState::PlaneStress;
        let mut strain = increment.strain;
        if plane_stress {
            strain[2] = elasticity.plane_stress_strain_33(&strain);
        }
        let mut stress = elasticity.stress(&strain);
        if plane_stress {
            stress[2] = 0.0;
        }
        *state = State { strain_33: strain[2], dissipated_energy: 0.0 };
        Ok(Response {
            stress,
            tangent: elasticity.tangent(plane_stress, request),
            stored_energy: elasticity.stored_energy(&strain),
            dissipated_energy: 0.0,
        })
    }
}
