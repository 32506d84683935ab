#![doc = include_str!("doc.md")]

use crate::damage_law::{DamageLaw, exponent_parameter, integrity, scale_parameter, threshold_parameter};
use crate::linear_elastic::{DISSIPATED_ENERGY, STRAIN_33, poisson_ratio, youngs_modulus};
use crate::tensor::{Elasticity, IsotropicSplit, add_dyad, isotropic_stiffness};
use umat_abi::law::{ConfigurationError, Failure, Increment, Law, LawInfo, Request, Response, StressState};
use umat_abi::metadata::{DerivedOutput, Parameter, StateVariable, flags};

#[cfg(any(test, feature = "stability"))]
pub(crate) mod samples;
#[cfg(test)]
mod test;

const PARAMETERS: [Parameter; 5] = [
    youngs_modulus(31800.0),
    poisson_ratio(0.18),
    scale_parameter(c"A", 5000.0),
    exponent_parameter(c"B", 1.3),
    threshold_parameter(c"Y_0", 2e-4),
];

const STATES: [StateVariable; 4] = [
    StateVariable::new(c"eta", c"-", c"D/(1 - D)"),
    StateVariable::new(c"Y_max", c"MPa", c"largest damage energy release rate so far"),
    STRAIN_33,
    DISSIPATED_ENERGY,
];

/// E, ν and the damage function.
#[derive(Clone, Copy, Debug)]
pub struct Parameters {
    elasticity: Elasticity,
    damage_law: DamageLaw,
}

/// The law.
pub struct PureDamage;

impl Law for PureDamage {
    const INFO: LawInfo = LawInfo {
        name: c"pure_damage",
        description: c"Model I: one isotropic damage variable, no inelastic strain",
        parameters: &PARAMETERS,
        repeating: None,
        states: &STATES,
        derived: &const { [DerivedOutput::damage(c"D", 0)] },
        flags: flags::SYMMETRIC_TANGENT
            | flags::THREAD_SAFE
            | flags::STRESS_ONLY
            | flags::PATH_EXACT
            | flags::ISOTROPIC,
    };

    const FINITE_OR_FAILS: bool = true;

    type Parameters<'p> = Parameters;

    #[inline(always)]
    fn parameters(props: &[f64]) -> Result<Parameters, ConfigurationError> {
        let damage_law = DamageLaw { a: props[2], b: props[3], threshold: props[4] };
        Ok(Parameters { elasticity: Elasticity::new(props[0], props[1]), damage_law })
    }

    #[inline(always)]
    fn update(
        parameters: &Parameters,
        increment: &Increment,
        state: &mut [f64],
        request: Request,
    ) -> Result<Response, Failure> {
        let Parameters { elasticity, damage_law } = parameters;
        let split = IsotropicSplit::new(increment.stress_state, &increment.strain);
        let twice_shear = 2.0 * elasticity.shear_modulus;
        let bulk = elasticity.bulk_modulus_in(split.dimension());
        let undamaged_stress = split.stress(twice_shear, bulk * split.trace);
        let release_rate = 0.5 * (twice_shear * split.deviator_norm_squared() + bulk * split.trace * split.trace);

        let (eta_before, largest_before) = (state[0], state[1]);
        let eta = eta_before.max(damage_law.eta(release_rate));
        let omega = integrity(eta);
        let mut tangent = if request.wants_tangent() {
            isotropic_stiffness(increment.stress_state, omega * twice_shear, omega * bulk)
        } else {
            [[0.0; 6]; 6]
        };
        if request.wants_tangent() && eta > eta_before {
            let rate = damage_law.damage_rate(release_rate, eta);
            add_dyad(&mut tangent, -rate, &undamaged_stress, &undamaged_stress);
        }
        state[0] = eta;
        state[1] = largest_before.max(release_rate);
        state[2] = if increment.stress_state == StressState::PlaneStress {
            elasticity.plane_stress_strain_33(&increment.strain)
        } else {
            increment.strain[2]
        };
        // dearer than all the rest: only where it can change (0: of a state that a host began with)
        if eta > eta_before || (state[3] == 0.0 && eta > 0.0) {
            // the closed form is monotone but for its last digit
            state[3] = state[3].max(damage_law.dissipation(eta));
        }
        let response = Response {
            stress: undamaged_stress.map(|s| omega * s),
            tangent,
            stored_energy: omega * release_rate,
            dissipated_energy: state[3],
        };
        response.finite_by_diagonal(state)
    }
}
