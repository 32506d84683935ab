//! Planted error: a panic beyond D = 0.5.

use faulty_law::{Damage, Fault, Parts, State};
use umat_abi::law::Response;

/// Planted error: a panic, for example by an index out of range.
pub struct Panicking;

impl Fault for Panicking {
    const NAME: &'static std::ffi::CStr = c"panicking";

    fn plant(_response: &mut Response, _state: &mut State, parts: &Parts) {
        assert!(parts.damage < 0.5, "planted");
    }
}

umat_abi::export_umat!(Damage<Panicking>, "panicking");
