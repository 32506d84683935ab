//! `libbond_slip.so`: bond, snubbing and contact as UINTER, the tangential part as FRIC.

umat_abi::export_interface!(models::bond_slip::BondSlip, "bond_slip");
