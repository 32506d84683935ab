//! `kratos/libconcrete_damage_implex.so`: `concrete_damage_implex` with shears in Kratos's order.

umat_abi::export_umat_for_kratos!(models::concrete_damage::ConcreteDamageImplex, "concrete_damage_implex");
