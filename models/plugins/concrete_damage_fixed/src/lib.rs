//! `libconcrete_damage_fixed.so`: `concrete_damage` with IMPL-EX integration and cracks of fixed direction as a UMAT.

umat_abi::export_umat!(models::concrete_damage::ConcreteDamageFixed, "concrete_damage_fixed");
