//! `libreverse_cyclic_damage.so`: model III, separate damage in tension and compression, as a UMAT.

umat_abi::export_umat!(models::reverse_cyclic_damage::ReverseCyclicDamage, "reverse_cyclic_damage");
