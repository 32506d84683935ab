//! `kratos/libbiaxial_damage.so`: `biaxial_damage` with shears in Kratos's order.

umat_abi::export_umat_for_kratos!(models::biaxial_damage::BiaxialDamage, "biaxial_damage");
