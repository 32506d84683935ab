//! `kratos/libj2_plasticity.so`: `j2_plasticity` with shears in Kratos's order.

umat_abi::export_umat_for_kratos!(models::j2_plasticity::J2Plasticity, "j2_plasticity");
