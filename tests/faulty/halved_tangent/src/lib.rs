//! Planted error: half the damage term in the tangent.

use faulty_law::{Damage, Fault, Parts, State};
use umat_abi::law::Response;

/// Half of −D′ σ̄ ⊗ σ̄.
pub struct Halved;

impl Fault for Halved {
    const NAME: &'static std::ffi::CStr = c"halved_tangent";

    fn plant(response: &mut Response, _state: &mut State, parts: &Parts) {
        for i in 0..6 {
            for j in 0..6 {
                response.tangent[i][j] = 0.5 * (response.tangent[i][j] + parts.unloading[i][j]);
            }
        }
    }
}

umat_abi::export_umat!(Damage<Halved>, "halved_tangent");
