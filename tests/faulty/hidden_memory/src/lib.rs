//! Planted error: a static counter of the calls changes the stress.

use faulty_law::{Damage, Fault, Parts, State};
use std::sync::atomic::{AtomicU64, Ordering};
use umat_abi::law::Response;

static CALLS: AtomicU64 = AtomicU64::new(0);

/// Planted error: σ11 grows by a factor of 1 + 1e-12 with each call.
pub struct Memory;

impl Fault for Memory {
    const NAME: &'static std::ffi::CStr = c"hidden_memory";

    fn plant(response: &mut Response, _state: &mut State, _parts: &Parts) {
        let calls = CALLS.fetch_add(1, Ordering::Relaxed) as f64;
        response.stress[0] *= 1.0 + 1e-12 * calls;
    }
}

umat_abi::export_umat!(Damage<Memory>, "hidden_memory");
