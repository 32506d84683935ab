//! `libdrucker_prager.so`: Drucker–Prager plasticity as a UMAT.

umat_abi::export_umat!(models::drucker_prager::DruckerPrager, "drucker_prager");
