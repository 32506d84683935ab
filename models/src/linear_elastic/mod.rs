#![doc = include_str!("doc.md")]

use crate::tensor::{Elasticity, work};
use umat_abi::law::{ConfigurationError, Failure, Increment, Law, LawInfo, Request, Response, StressState};
use umat_abi::metadata::{Parameter, StateVariable, flags};

#[cfg(test)]
mod test;

/// Young's modulus, the first parameter of every law of a solid.
pub(crate) const fn youngs_modulus(default_value: f64) -> Parameter {
    Parameter::new(c"E", c"MPa", default_value, c"Young's modulus").above(0.0)
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

/// The law.
pub struct LinearElastic;

const STATES: [StateVariable; 2] = [STRAIN_33, DISSIPATED_ENERGY];

impl Law for LinearElastic {
    const INFO: LawInfo = LawInfo {
        name: c"linear_elastic",
        description: c"Isotropic linear elasticity",
        parameters: &const { [youngs_modulus(31800.0), poisson_ratio(0.18)] },
        repeating: None,
        states: &STATES,
        derived: &[],
        flags: flags::SYMMETRIC_TANGENT
            | flags::THREAD_SAFE
            | flags::STRESS_ONLY
            | flags::PATH_EXACT
            | flags::ISOTROPIC,
    };

    type Parameters<'p> = Elasticity;

    #[inline]
    fn parameters(props: &[f64]) -> Result<Elasticity, ConfigurationError> {
        Ok(Elasticity::new(props[0], props[1]))
    }

    #[inline]
    fn update(
        elasticity: &Elasticity,
        increment: &Increment,
        state: &mut [f64],
        request: Request,
    ) -> Result<Response, Failure> {
        let mut strain = increment.strain;
        let plane_stress = increment.stress_state == StressState::PlaneStress;
        if plane_stress {
            strain[2] = elasticity.plane_stress_strain_33(&strain);
        }
        let mut stress = elasticity.stress(&strain);
        if plane_stress {
            stress[2] = 0.0;
        }
        let tangent = match (request.wants_tangent(), plane_stress) {
            (false, _) => [[0.0; 6]; 6],
            (true, false) => elasticity.stiffness(),
            (true, true) => elasticity.plane_stress_stiffness(),
        };
        state[0] = strain[2];
        state[1] = 0.0;
        Ok(Response { stress, tangent, stored_energy: 0.5 * work(&stress, &strain), dissipated_energy: 0.0 })
    }
}
