#![doc = include_str!("doc.md")]

use crate::tensor::Elasticity;
use umat_abi::law::{
    Block, BlockResponse, ConfigurationError, Failure, Increment, LANES, Lane, Law, LawInfo, Request, Response,
    StressState,
};
use umat_abi::metadata::{Parameter, StateVariable, flags};

#[cfg(test)]
mod test;

/// Young's modulus, the first parameter of every law of a solid; usual are those from polymers to diamond: most in GPa or kPa
/// are others.
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

    #[inline(always)]
    fn parameters(props: &[f64]) -> Result<Elasticity, ConfigurationError> {
        Ok(Elasticity::new(props[0], props[1]))
    }

    #[inline(always)]
    fn update(
        elasticity: &Elasticity,
        increment: &Increment,
        state: &mut [f64],
        request: Request,
    ) -> Result<Response, Failure> {
        let plane_stress = increment.stress_state == StressState::PlaneStress;
        let Elastic { strain_33, stress, energy } = Elastic::new(elasticity, plane_stress, increment.strain);
        let tangent = elasticity.tangent(plane_stress, request);
        let response = Response { stress, tangent, stored_energy: energy, dissipated_energy: 0.0 };
        let response = response.finite_by_diagonal(&[strain_33])?;
        state[..2].copy_from_slice(&[strain_33, 0.0]);
        Ok(response)
    }

    #[inline(always)]
    fn elastic(
        elasticity: &Elasticity,
        increment: &Increment,
        state: &mut [f64],
        request: Request,
    ) -> Option<Response> {
        Self::update(elasticity, increment, state, request).ok()
    }

    const FINITE_OR_FAILS: bool = true;
    const UPDATES_BLOCKS: bool = true;

    #[inline(always)]
    fn update_block(elasticity: &Elasticity, block: &Block, state: &mut [Lane]) -> Option<BlockResponse> {
        let mut response = BlockResponse { stress: [[0.0; LANES]; 6], stored_energy: [0.0; LANES] };
        let mut strain_33 = [0.0; LANES];
        let plane_stress = block.stress_state == StressState::PlaneStress;
        for lane in 0..LANES {
            let elastic = Elastic::new(elasticity, plane_stress, std::array::from_fn(|i| block.strain[i][lane]));
            for i in 0..6 {
                response.stress[i][lane] = elastic.stress[i];
            }
            response.stored_energy[lane] = elastic.energy;
            strain_33[lane] = elastic.strain_33;
        }
        state[..2].copy_from_slice(&[strain_33, [0.0; LANES]]);
        Some(response)
    }
}

/// The elastic solid at a strain.
struct Elastic {
    strain_33: f64,
    stress: [f64; 6],
    energy: f64,
}

impl Elastic {
    #[inline(always)]
    fn new(elasticity: &Elasticity, plane_stress: bool, mut strain: [f64; 6]) -> Self {
        if plane_stress {
            strain[2] = elasticity.plane_stress_strain_33(&strain);
        }
        let mut stress = elasticity.stress(&strain);
        if plane_stress {
            stress[2] = 0.0;
        }
        Self { strain_33: strain[2], stress, energy: elasticity.stored_energy(&strain) }
    }
}
