//! `kratos/libreverse_cyclic_damage.so`: `reverse_cyclic_damage` with shears in Kratos's order.

umat_abi::export_umat_for_kratos!(models::reverse_cyclic_damage::ReverseCyclicDamage, "reverse_cyclic_damage");
