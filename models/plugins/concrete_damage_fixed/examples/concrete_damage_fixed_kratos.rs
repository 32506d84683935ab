//! `kratos/libconcrete_damage_fixed.so`: `concrete_damage_fixed` with shears in Kratos's order.

umat_abi::export_umat_for_kratos!(models::concrete_damage::ConcreteDamageFixed, "concrete_damage_fixed");
