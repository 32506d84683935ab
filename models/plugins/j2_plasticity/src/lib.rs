//! `libj2_plasticity.so`: von Mises plasticity with a hardening table as a UMAT.

umat_abi::export_umat!(models::j2_plasticity::J2Plasticity, "j2_plasticity");
