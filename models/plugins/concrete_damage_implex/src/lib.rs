//! `libconcrete_damage_implex.so`: `concrete_damage` with IMPL-EX integration as a UMAT.

umat_abi::export_umat!(models::concrete_damage::ConcreteDamageImplex, "concrete_damage_implex");
