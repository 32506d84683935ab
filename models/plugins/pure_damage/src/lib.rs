//! `libpure_damage.so`: model I, isotropic damage, as a UMAT.

umat_abi::export_umat!(models::pure_damage::PureDamage, "pure_damage");
