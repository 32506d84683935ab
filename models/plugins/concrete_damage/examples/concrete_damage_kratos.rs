//! `kratos/libconcrete_damage.so`: `concrete_damage` with shears in Kratos's order.

umat_abi::export_umat_for_kratos!(models::concrete_damage::ConcreteDamage, "concrete_damage");
