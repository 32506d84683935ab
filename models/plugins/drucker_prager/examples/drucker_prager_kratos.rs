//! `kratos/libdrucker_prager.so`: `drucker_prager` with shears in Kratos's order.

umat_abi::export_umat_for_kratos!(models::drucker_prager::DruckerPrager, "drucker_prager");
