//! The interface law without an error: every check passes.

use faulty_law::{InterfaceDamage, Whole};

umat_abi::export_interface!(InterfaceDamage<Whole>, "sound_interface");
