//! Planted error: half the damage term in the shear tangent.

use faulty_law::{Half, InterfaceDamage};

umat_abi::export_interface!(InterfaceDamage<Half>, "halved_interface_tangent");
