//! `kratos/libinelastic_damage.so`: `inelastic_damage` with shears in Kratos's order.

umat_abi::export_umat_for_kratos!(models::inelastic_damage::InelasticDamage, "inelastic_damage");
