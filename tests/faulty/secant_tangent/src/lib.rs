//! Planted error: the secant (1−D) K in place of the consistent tangent.

use faulty_law::{Damage, Fault, Parts, State};
use umat_abi::law::Response;

/// The secant.
pub struct Secant;

impl Fault for Secant {
    const NAME: &'static std::ffi::CStr = c"secant_tangent";

    fn plant(response: &mut Response, _state: &mut State, parts: &Parts) {
        response.tangent = parts.unloading;
    }
}

umat_abi::export_umat!(Damage<Secant>, "secant_tangent");
