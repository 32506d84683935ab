//! `libinelastic_damage.so`: model II, damage with inelastic strain, as a UMAT.

umat_abi::export_umat!(models::inelastic_damage::InelasticDamage, "inelastic_damage");
