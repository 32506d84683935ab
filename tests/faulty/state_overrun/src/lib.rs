//! Planted error: STATEV(NSTATV+1) is written, as a Fortran UMAT does whose author counted wrong.

use faulty_law::{Damage, Fault};
use umat_abi::umat::UmatArguments;

/// The error is in the entry point.
pub struct Overrun;

impl Fault for Overrun {
    const NAME: &'static std::ffi::CStr = c"state_overrun";
}

unsafe fn body(arguments: &UmatArguments) {
    // SAFETY: forwarded to the caller; the write past STATEV is the planted error, into the host's canaries.
    unsafe {
        umat_abi::export::umat::<Damage<Overrun>>(arguments);
        const STATES: i32 = 3;
        if *arguments.nstatv == STATES {
            arguments.statev.add(STATES as usize).write(1.0);
        }
    }
}

umat_abi::umat_symbol!("umat_", umat_fortran, body);
umat_abi::plugin_symbol!("pullout_plugin_v1", umat_abi::law_plugin!((umat Damage<Overrun>)));
