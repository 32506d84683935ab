//! σ = (1 − D) K : ε with Y = ½ ε : K : ε.

use crate::Evolution;
use models::tensor::{Elasticity, add_dyad, work};
use std::ffi::CStr;
use std::marker::PhantomData;
use umat_abi::law::{Failure, Increment, Law, LawInfo, Request, Response, StressState};
use umat_abi::metadata::{Parameter, StateVariable, flags};

/// Quantities that an error may need.
#[derive(Clone, Copy, Debug)]
pub struct Parts {
    /// (1 − D) K.
    pub unloading: [[f64; 6]; 6],
    /// K.
    pub elastic: [[f64; 6]; 6],
    /// D.
    pub damage: f64,
    /// DSTRAN.
    pub strain_increment: [f64; 6],
    /// The parameter `fault`.
    pub fault: f64,
    /// Request of the host.
    pub request: Request,
    /// Stress state: the components that exist.
    pub stress_state: StressState,
}

/// An error to plant.
pub trait Fault {
    /// The law's name.
    const NAME: &'static CStr;
    /// Flags claimed in addition to those of the law.
    const FLAGS: u32 = 0;
    /// Spoils the response and the new state.
    fn plant(_response: &mut Response, _state: &mut State, _parts: &Parts) {}
}

/// The law, with an error.
#[derive(Debug)]
pub struct Damage<F>(PhantomData<F>);

umat_abi::parameters! {
    /// The parameters.
    pub struct Parameters {
        /// E, ν.
        elasticity: Elasticity =
            Parameter::new(c"E", c"MPa", 31800.0, c"Young's modulus").above(0.0),
            Parameter::new(c"nu", c"-", 0.18, c"Poisson's ratio").above(-1.0).below(0.5);
        /// Y_0, Y_f.
        evolution: Evolution =
            Parameter::new(c"Y_0", c"N*mm/mm^3", 2e-4, c"threshold").at_least(0.0),
            Parameter::new(c"Y_f", c"N*mm/mm^3", 1e-3, c"decay").above(0.0);
        /// Number of the error.
        fault: f64 =
            Parameter::new(c"fault", c"-", 0.0, c"which error, for a plugin with several").within(0.0, 99.0);
    }
}

umat_abi::states! {
    /// The state variables.
    pub struct State {
        /// r.
        pub r: f64 = StateVariable::new(c"r", c"N*mm/mm^3", c"largest energy release rate so far");
        /// ε33.
        pub strain_33: f64 = StateVariable::new(c"strain_33", c"-", c"total strain 33");
        /// ∫ Y dD.
        pub dissipated_energy: f64 =
            StateVariable::new(c"dissipated_energy", c"N*mm/mm^3", c"energy dissipated since the virgin state");
    }
}

impl<F: Fault> Law for Damage<F> {
    const INFO: LawInfo = LawInfo {
        name: F::NAME,
        description: c"Isotropic damage with an exponential decay",
        flags: flags::SYMMETRIC_TANGENT
            | flags::THREAD_SAFE
            | flags::STRESS_ONLY
            | flags::PATH_EXACT
            | flags::ISOTROPIC
            | F::FLAGS,
        ..LawInfo::of::<Parameters, State>()
    };

    type Parameters<'p> = Parameters;
    type State = State;

    fn update(
        Parameters { elasticity, evolution, fault }: &Parameters,
        increment: &Increment,
        state: &mut State,
        request: Request,
    ) -> Result<Response, Failure> {
        let mut strain = increment.strain;
        let plane_stress = increment.stress_state == StressState::PlaneStress;
        if plane_stress {
            strain[2] = elasticity.plane_stress_strain_33(&strain);
        }
        let mut effective = elasticity.stress(&strain);
        if plane_stress {
            effective[2] = 0.0;
        }
        let rate = 0.5 * work(&effective, &strain);
        let r = rate.max(state.r);
        let integrity = evolution.integrity(r);
        let stiffness = if plane_stress { elasticity.plane_stress_stiffness() } else { elasticity.stiffness() };
        let unloading = stiffness.map(|row| row.map(|entry| integrity * entry));
        let mut tangent = unloading;
        if rate > state.r {
            add_dyad(&mut tangent, -evolution.slope(r), &effective, &effective);
        }
        *state = State { r, strain_33: strain[2], dissipated_energy: evolution.dissipated(r) };
        let mut response = Response {
            stress: effective.map(|s| integrity * s),
            tangent,
            stored_energy: integrity * rate,
            dissipated_energy: state.dissipated_energy,
        };
        let (damage, stress_state) = (1.0 - integrity, increment.stress_state);
        let strain_increment = increment.strain_increment;
        let parts =
            Parts { unloading, elastic: stiffness, damage, strain_increment, fault: *fault, request, stress_state };
        F::plant(&mut response, state, &parts);
        Ok(response)
    }
}
