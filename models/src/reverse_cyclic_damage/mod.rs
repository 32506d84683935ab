#![doc = include_str!("doc.md")]

use crate::damage_law::{DamageLaw, exponent_parameter, integrity, scale_parameter, threshold_parameter};
use crate::linear_elastic::{DISSIPATED_ENERGY, STRAIN_33, poisson_ratio, youngs_modulus};
use crate::tensor::{Elasticity, Spectral};
use umat_abi::law::{Failure, Increment, Law, LawInfo, Request, Response, StressState};
use umat_abi::metadata::{DerivedOutput, Parameter, StateVariable, flags};

mod principal;

use principal::{Damage, SignSplit};

pub use principal::Variant;

#[cfg(test)]
mod test;

umat_abi::parameters! {
    /// The parameters.
    pub struct Parameters {
        /// E, ν.
        pub elasticity: Elasticity = youngs_modulus(31800.0), poisson_ratio(0.18);
        /// A_t, B_t, Y_t0.
        pub tension: DamageLaw =
            scale_parameter(c"A_t", 5000.0), exponent_parameter(c"B_t", 1.3), threshold_parameter(c"Y_t0", 2e-4);
        /// A_c, B_c, Y_c0.
        pub compression: DamageLaw =
            scale_parameter(c"A_c", 21.0), exponent_parameter(c"B_c", 1.05), threshold_parameter(c"Y_c0", 4e-4);
        /// Split of the volumetric energy.
        pub variant: Variant =
            Parameter::new(c"variant", c"-", 0.0, c"split of the volumetric energy").one_of(Variant::CHOICES);
    }
}

umat_abi::states! {
    /// The state variables.
    pub struct State {
        /// η_t.
        pub eta_t: f64 = StateVariable::new(c"eta_t", c"-", c"D_t/(1 - D_t)");
        /// η_c.
        pub eta_c: f64 = StateVariable::new(c"eta_c", c"-", c"D_c/(1 - D_c)");
        /// The largest Y_t.
        pub tensile_release_rate: f64 =
            StateVariable::new(c"Y_t_max", c"MPa", c"largest tensile damage energy release rate so far");
        /// The largest Y_c.
        pub compressive_release_rate: f64 =
            StateVariable::new(c"Y_c_max", c"MPa", c"largest compressive damage energy release rate so far");
        /// ε33.
        pub strain_33: f64 = STRAIN_33;
        /// ∫ Y_t dD_t + ∫ Y_c dD_c.
        pub dissipated_energy: f64 = DISSIPATED_ENERGY;
    }
}

/// The law.
pub struct ReverseCyclicDamage;

impl Law for ReverseCyclicDamage {
    const INFO: LawInfo = LawInfo {
        name: c"reverse_cyclic_damage",
        description: c"Model III: separate tensile and compressive damage by the signs of the principal strains",
        derived: &const { [DerivedOutput::damage(c"D_t", 0), DerivedOutput::damage(c"D_c", 1)] },
        flags: flags::SYMMETRIC_TANGENT
            | flags::THREAD_SAFE
            | flags::STRESS_ONLY
            | flags::PATH_EXACT
            | flags::ISOTROPIC,
        ..LawInfo::of::<Parameters, State>()
    };

    type Parameters<'p> = Parameters;
    type State = State;

    fn update(
        Parameters { elasticity, tension, compression, variant }: &Parameters,
        increment: &Increment,
        state: &mut State,
        request: Request,
    ) -> Result<Response, Failure> {
        let (spectral, split) = if increment.stress_state == StressState::PlaneStress {
            let in_plane = [increment.strain[0], increment.strain[1], 0.0, increment.strain[3], 0.0, 0.0];
            let spectral = Spectral::of_strain(&in_plane);
            (spectral, SignSplit::in_plane(*variant, elasticity, &spectral))
        } else {
            let spectral = Spectral::of_strain(&increment.strain);
            (spectral, SignSplit::in_space(*variant, elasticity, &spectral))
        };
        let tensile = Damage::grown(tension, split.tensile_release_rate(), state.eta_t);
        let compressive = Damage::grown(compression, split.compressive_release_rate(), state.eta_c);
        let tangent = if request.wants_tangent() {
            let shear = split.shear_moduli(&tensile, &compressive);
            spectral.tangent(&split.principal_tangent(&tensile, &compressive), &shear)
        } else {
            [[0.0; 6]; 6]
        };
        let grows = tensile.eta > state.eta_t || compressive.eta > state.eta_c;
        (state.eta_t, state.eta_c) = (tensile.eta, compressive.eta);
        state.tensile_release_rate = state.tensile_release_rate.max(split.tensile_release_rate());
        state.compressive_release_rate = state.compressive_release_rate.max(split.compressive_release_rate());
        state.strain_33 = elasticity.strain_33(increment);
        // dearer than all the rest: only where they can change (0: of a state that a host began with)
        if grows || state.dissipated_energy == 0.0 {
            // the closed forms are monotone up to their last digit
            let dissipation = tension.dissipation(tensile.eta) + compression.dissipation(compressive.eta);
            state.dissipated_energy = state.dissipated_energy.max(dissipation);
        }
        Ok(Response {
            stress: spectral.stress(&split.principal_stresses(integrity(tensile.eta), integrity(compressive.eta))),
            tangent,
            stored_energy: split.stored_energy(integrity(tensile.eta), integrity(compressive.eta)),
            dissipated_energy: state.dissipated_energy,
        })
    }
}
