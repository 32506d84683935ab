//! `kratos/liblinear_elastic.so`: `linear_elastic` with shears in Kratos's order.

umat_abi::export_umat_for_kratos!(models::linear_elastic::LinearElastic, "linear_elastic");
