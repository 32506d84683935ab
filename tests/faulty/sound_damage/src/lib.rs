//! The damage law without an error: every check passes.

use faulty_law::{Damage, Fault};

/// None.
pub struct Sound;

impl Fault for Sound {
    const NAME: &'static std::ffi::CStr = c"sound_damage";
}

umat_abi::export_umat!(Damage<Sound>, "sound_damage");
