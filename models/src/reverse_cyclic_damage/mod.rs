#![doc = include_str!("doc.md")]

use crate::damage_law::{DamageLaw, exponent_parameter, integrity, scale_parameter, threshold_parameter};
use crate::linear_elastic::{DISSIPATED_ENERGY, STRAIN_33, poisson_ratio, youngs_modulus};
use crate::tensor::{Elasticity, Spectral};
use umat_abi::law::{ConfigurationError, Failure, Increment, Law, LawInfo, Request, Response, StressState};
use umat_abi::metadata::{Choice, DerivedOutput, Parameter, StateVariable, flags};

mod principal;

use principal::{Damage, SignSplit, Variant};

#[cfg(any(test, feature = "stability"))]
pub(crate) mod samples;
#[cfg(test)]
mod test;

const PARAMETERS: [Parameter; 9] = [
    youngs_modulus(31800.0),
    poisson_ratio(0.18),
    scale_parameter(c"A_t", 5000.0),
    exponent_parameter(c"B_t", 1.3),
    threshold_parameter(c"Y_t0", 2e-4),
    scale_parameter(c"A_c", 21.0),
    exponent_parameter(c"B_c", 1.05),
    threshold_parameter(c"Y_c0", 4e-4),
    Parameter::new(c"variant", c"-", 0.0, c"how the volumetric energy is split")
        .one_of(&const { [Choice::new(0.0, c"thesis"), Choice::new(1.0, c"regular")] }),
];

const STATES: [StateVariable; 6] = [
    StateVariable::new(c"eta_t", c"-", c"D_t/(1 - D_t)"),
    StateVariable::new(c"eta_c", c"-", c"D_c/(1 - D_c)"),
    StateVariable::new(c"Y_t_max", c"MPa", c"largest tensile damage energy release rate so far"),
    StateVariable::new(c"Y_c_max", c"MPa", c"largest compressive damage energy release rate so far"),
    STRAIN_33,
    DISSIPATED_ENERGY,
];

/// E, ν, the two damage functions, the variant.
#[derive(Clone, Copy, Debug)]
pub struct Parameters {
    elasticity: Elasticity,
    tension: DamageLaw,
    compression: DamageLaw,
    variant: Variant,
}

/// The law.
pub struct ReverseCyclicDamage;

impl Law for ReverseCyclicDamage {
    const INFO: LawInfo = LawInfo {
        name: c"reverse_cyclic_damage",
        description: c"Model III: separate tensile and compressive damage by the signs of the principal strains",
        parameters: &PARAMETERS,
        repeating: None,
        states: &STATES,
        derived: &const { [DerivedOutput::damage(c"D_t", 0), DerivedOutput::damage(c"D_c", 1)] },
        flags: flags::SYMMETRIC_TANGENT
            | flags::THREAD_SAFE
            | flags::STRESS_ONLY
            | flags::PATH_EXACT
            | flags::ISOTROPIC,
    };

    const FINITE_OR_FAILS: bool = true;

    type Parameters<'p> = Parameters;

    fn parameters(props: &[f64]) -> Result<Parameters, ConfigurationError> {
        Ok(Parameters {
            elasticity: Elasticity::new(props[0], props[1]),
            tension: DamageLaw { a: props[2], b: props[3], threshold: props[4] },
            compression: DamageLaw { a: props[5], b: props[6], threshold: props[7] },
            variant: if props[8] == 0.0 { Variant::Thesis } else { Variant::Regular },
        })
    }

    fn update(
        parameters: &Parameters,
        increment: &Increment,
        state: &mut [f64],
        request: Request,
    ) -> Result<Response, Failure> {
        let Parameters { elasticity, tension, compression, variant } = parameters;
        increment.check_strain()?;
        let (spectral, split) = if increment.stress_state == StressState::PlaneStress {
            let in_plane = [increment.strain[0], increment.strain[1], 0.0, increment.strain[3], 0.0, 0.0];
            let spectral = Spectral::of_strain(&in_plane);
            (spectral, SignSplit::in_plane(*variant, elasticity, &spectral))
        } else {
            let spectral = Spectral::of_strain(&increment.strain);
            (spectral, SignSplit::in_space(*variant, elasticity, &spectral))
        };
        let tensile = Damage::grown(tension, split.tensile_release_rate(), state[0]);
        let compressive = Damage::grown(compression, split.compressive_release_rate(), state[1]);
        let tangent = if request.wants_tangent() {
            let shear = split.shear_moduli(&tensile, &compressive);
            spectral.tangent(&split.principal_tangent(&tensile, &compressive), &shear)
        } else {
            [[0.0; 6]; 6]
        };
        let grows = tensile.eta > state[0] || compressive.eta > state[1];
        state[0] = tensile.eta;
        state[1] = compressive.eta;
        state[2] = state[2].max(split.tensile_release_rate());
        state[3] = state[3].max(split.compressive_release_rate());
        state[4] = match increment.stress_state {
            StressState::PlaneStress => elasticity.plane_stress_strain_33(&increment.strain),
            _ => increment.strain[2],
        };
        // dearer than all the rest: only where they can change (0: of a state that a host began with)
        if grows || state[5] == 0.0 {
            // the closed forms are monotone but for their last digit
            state[5] = state[5].max(tension.dissipation(tensile.eta) + compression.dissipation(compressive.eta));
        }
        let response = Response {
            stress: spectral.stress(&split.principal_stresses(integrity(tensile.eta), integrity(compressive.eta))),
            tangent,
            stored_energy: split.stored_energy(integrity(tensile.eta), integrity(compressive.eta)),
            dissipated_energy: state[5],
        };
        response.finite(state)
    }
}
