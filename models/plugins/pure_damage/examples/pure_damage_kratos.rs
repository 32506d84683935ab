//! `kratos/libpure_damage.so`: `pure_damage` with shears in Kratos's order.

umat_abi::export_umat_for_kratos!(models::pure_damage::PureDamage, "pure_damage");
