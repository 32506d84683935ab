//! `libconcrete_damage.so`: the production damage law as a UMAT.

umat_abi::export_umat!(models::concrete_damage::ConcreteDamage, "concrete_damage");
