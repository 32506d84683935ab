//! Planted error: DDSDDE(1,2) is never written.

use faulty_law::{Damage, Fault};
use umat_abi::umat::UmatArguments;

/// The error is in the entry point.
pub struct Unset;

impl Fault for Unset {
    const NAME: &'static std::ffi::CStr = c"unset_entry";
}

unsafe fn body(arguments: &UmatArguments) {
    // SAFETY: forwarded to the caller; DDSDDE(1,2) is number NTENS of the NTENS² entries, NTENS ≥ 3.
    unsafe {
        let supported = matches!(*arguments.ntens, 3 | 4 | 6) && !arguments.ddsdde.is_null();
        let entry = supported.then(|| arguments.ddsdde.add(*arguments.ntens as usize));
        let before = entry.map(|entry| entry.read());
        umat_abi::export::umat::<Damage<Unset>>(arguments);
        if let (Some(entry), Some(before)) = (entry, before) {
            entry.write(before);
        }
    }
}

umat_abi::umat_symbol!("umat_", umat_fortran, body);
umat_abi::plugin_symbol!("pullout_plugin_v1", umat_abi::law_plugin!((umat Damage<Unset>)));
