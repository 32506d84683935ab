#![doc = include_str!("doc.md")]

mod cone;
mod plane_stress;
mod return_map;

pub use cone::{Cone, Match};

use crate::j2_plasticity::{State, check_trial_strain};
use crate::linear_elastic::{poisson_ratio, youngs_modulus};
use crate::tensor::{Elasticity, strain_norm_squared};
use return_map::{Regime, Returned, invariants};
use umat_abi::law::{Failure, Increment, Law, LawInfo, Request, Response, StressState};
use umat_abi::metadata::{Parameter, flags};

#[cfg(test)]
mod test;

/// The law.
pub struct DruckerPrager;

umat_abi::parameters! {
    /// The parameters.
    pub struct Parameters {
        /// E, ν; soils are softer than other solids.
        pub elasticity: Elasticity = youngs_modulus(23_700.0).typically(0.5, 1.2e6), poisson_ratio(0.15);
        /// α, k, ᾱ.
        pub cone: Cone =
            Parameter::new(c"cohesion", c"MPa", 38.1, c"cohesion; cone abaqus: d, the intercept in the p-t plane")
                .above(0.0)
                .typically(1e-4, 1e3),
            Parameter::new(c"friction_angle_deg", c"deg", 18.8, c"friction angle; cone abaqus: beta")
                .at_least(0.0)
                .below(90.0),
            Parameter::new(c"dilation_angle_deg", c"deg", 18.8, c"dilation angle, at most the friction angle")
                .at_least(0.0)
                .below(90.0),
            Parameter::new(c"cone", c"-", 0.0, c"meaning of cohesion and angles").one_of(Match::CHOICES);
    }
}

impl Law for DruckerPrager {
    const INFO: LawInfo = LawInfo {
        name: c"drucker_prager",
        description: c"Perfectly plastic Drucker-Prager cone, associated or not",
        flags: flags::THREAD_SAFE | flags::STRESS_ONLY | flags::ISOTROPIC,
        ..LawInfo::of::<Parameters, State>()
    };

    type Parameters<'p> = Parameters;
    type State = State;

    #[inline(always)]
    fn update(
        parameters: &Parameters,
        increment: &Increment,
        state: &mut State,
        request: Request,
    ) -> Result<Response, Failure> {
        let Parameters { elasticity, cone } = parameters;
        let plane_stress = increment.stress_state == StressState::PlaneStress;
        let start = elastic_strain_at_start(state, increment);
        let trial = state.elastic_strain(&increment.strain);
        check_trial_strain(&trial)?;
        let returned = if plane_stress {
            let returned = plane_stress::plane_stress_return(parameters, &trial)?;
            state.strain_33 = state.plastic_strain[2] + returned.trial_strain_33();
            returned
        } else {
            state.strain_33 = increment.strain[2];
            Returned::new(elasticity, cone, &trial)
        };
        state.dissipated_energy += dissipation(parameters, &start, &returned);
        let plastic_increment = returned.plastic_increment();
        state.peeq += (2.0 / 3.0 * strain_norm_squared(&plastic_increment)).sqrt();
        for i in 0..6 {
            state.plastic_strain[i] += plastic_increment[i];
        }
        let mut stress = returned.stress();
        if plane_stress {
            stress[2] = 0.0;
        }
        let tangent = match (request.wants_tangent(), plane_stress) {
            (false, _) => [[0.0; 6]; 6],
            (true, false) => returned.tangent(),
            (true, true) => plane_stress::condensed_tangent(&returned, elasticity.youngs_modulus),
        };
        let (stored_energy, dissipated_energy) = (returned.stored_energy(), state.dissipated_energy);
        Ok(Response { stress, tangent, stored_energy, dissipated_energy })
    }
}

/// εᵉ at the start of the increment; in plane stress with the stored ε33.
fn elastic_strain_at_start(state: &State, increment: &Increment) -> [f64; 6] {
    let mut strain = std::array::from_fn(|i| increment.strain[i] - increment.strain_increment[i]);
    if increment.stress_state == StressState::PlaneStress {
        strain[2] = state.strain_33;
    }
    state.elastic_strain(&strain)
}

/// ∫ σ : dεᵖ over the increment. On the cone σ : ∂Ψ/∂σ = k − (α − ᾱ) I₁, with I₁ in the middle
/// between first yielding and the end; at the apex all that counts is the volume.
fn dissipation(parameters: &Parameters, start: &[f64; 6], returned: &Returned) -> f64 {
    let Parameters { elasticity, cone } = parameters;
    match returned.regime {
        Regime::Elastic => 0.0,
        Regime::Apex => {
            returned.mean_stress * (returned.trial_mean_stress - returned.mean_stress).max(0.0)
                / elasticity.bulk_modulus
        }
        Regime::Cone => {
            let (mean, root_j2) = invariants(elasticity, start);
            let before = cone.yield_function(mean, root_j2).min(0.0);
            let after = returned.multiplier * returned.consistency_modulus();
            let first = mean + before / (before - after) * (returned.trial_mean_stress - mean);
            let middle = 1.5 * (first + returned.mean_stress);
            returned.multiplier * (cone.shear_strength - (cone.friction - cone.dilation) * middle).max(0.0)
        }
    }
}
