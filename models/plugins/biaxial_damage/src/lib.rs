//! `libbiaxial_damage.so`: model IV as in the thesis as a UMAT.

umat_abi::export_umat!(models::biaxial_damage::BiaxialDamage, "biaxial_damage");
