//! p = k_n ⟨penetration⟩ and τ = (1 − D) k_t s with Y = ½ k_t s².

use crate::Evolution;
use std::marker::PhantomData;
use umat_abi::law::{
    Failure, InterfaceIncrement, InterfaceLaw, InterfaceResponse, LawInfo, Request, TangentialIncrement,
    TangentialResponse,
};
use umat_abi::metadata::{Parameter, StateVariable, flags};

/// Share of the tangent's damage term that is returned.
pub trait Share {
    /// 1 is right.
    const SHARE: f64;
    /// The law's name.
    const NAME: &'static std::ffi::CStr;
}

/// All of it.
#[derive(Debug)]
pub struct Whole;
impl Share for Whole {
    const SHARE: f64 = 1.0;
    const NAME: &'static std::ffi::CStr = c"sound_interface";
}

/// Half of the term: an error.
#[derive(Debug)]
pub struct Half;
impl Share for Half {
    const SHARE: f64 = 0.5;
    const NAME: &'static std::ffi::CStr = c"halved_interface_tangent";
}

/// The law, with an error in the tangent.
#[derive(Debug)]
pub struct InterfaceDamage<S>(PhantomData<S>);

umat_abi::parameters! {
    /// The parameters.
    pub struct Parameters {
        /// k_n.
        normal: f64 = Parameter::new(c"k_n", c"MPa/mm", 1e4, c"normal stiffness").above(0.0);
        /// k_t.
        shear: f64 = Parameter::new(c"k_t", c"MPa/mm", 500.0, c"shear stiffness").above(0.0);
        /// Y_0, Y_f.
        evolution: Evolution =
            Parameter::new(c"Y_0", c"N/mm", 1e-3, c"threshold").at_least(0.0),
            Parameter::new(c"Y_f", c"N/mm", 1e-2, c"decay").above(0.0);
    }
}

umat_abi::states! {
    /// The state variables.
    pub struct State {
        r: f64 = StateVariable::new(c"r", c"N/mm", c"largest energy release rate so far");
        slip: [f64; 2] =
            StateVariable::new(c"slip_1", c"mm", c"slip in direction 1"),
            StateVariable::new(c"slip_2", c"mm", c"slip in direction 2");
    }
}

/// Shear tractions and their tangent; `state` goes to the end.
fn shear<S: Share>(parameters: &Parameters, increment: [f64; 2], state: &mut State) -> TangentialResponse {
    let slip = [state.slip[0] + increment[0], state.slip[1] + increment[1]];
    let rate = 0.5 * parameters.shear * (slip[0] * slip[0] + slip[1] * slip[1]);
    let r = rate.max(state.r);
    let integrity = parameters.evolution.integrity(r);
    let slope = if rate > state.r { parameters.evolution.slope(r) } else { 0.0 };
    let mut response = TangentialResponse {
        stored_energy: integrity * rate,
        dissipated_energy: parameters.evolution.dissipated(r),
        ..TangentialResponse::default()
    };
    for i in 0..2 {
        response.traction[i] = integrity * parameters.shear * slip[i];
        response.slip_tangent[i][i] = integrity * parameters.shear;
        for j in 0..2 {
            response.slip_tangent[i][j] -= S::SHARE * slope * parameters.shear.powi(2) * slip[i] * slip[j];
        }
    }
    *state = State { r, slip };
    response
}

impl<S: Share> InterfaceLaw for InterfaceDamage<S> {
    const INFO: LawInfo = LawInfo {
        name: S::NAME,
        description: c"Contact with a penalty and a bond with damage",
        flags: flags::SYMMETRIC_TANGENT | flags::THREAD_SAFE | flags::STRESS_ONLY | flags::ISOTROPIC,
        ..LawInfo::of::<Parameters, State>()
    };

    type Parameters<'p> = Parameters;
    type State = State;

    fn update(
        parameters: &Parameters,
        increment: &InterfaceIncrement,
        state: &mut State,
        _request: Request,
    ) -> Result<InterfaceResponse, Failure> {
        let tangential = shear::<S>(parameters, [increment.increment[1], increment.increment[2]], state);
        let penetration = increment.relative_displacement[0].max(0.0);
        let mut response = InterfaceResponse {
            stored_energy: tangential.stored_energy + 0.5 * parameters.normal * penetration * penetration,
            dissipated_energy: tangential.dissipated_energy,
            ..InterfaceResponse::default()
        };
        response.traction = [parameters.normal * penetration, tangential.traction[0], tangential.traction[1]];
        response.tangent[0][0] = if penetration > 0.0 { parameters.normal } else { 0.0 };
        for i in 0..2 {
            response.tangent[i + 1][1..].copy_from_slice(&tangential.slip_tangent[i]);
        }
        Ok(response)
    }

    fn update_tangential(
        parameters: &Parameters,
        increment: &TangentialIncrement,
        state: &mut State,
        _request: Request,
    ) -> Result<TangentialResponse, Failure> {
        Ok(shear::<S>(parameters, increment.slip_increment, state))
    }
}
