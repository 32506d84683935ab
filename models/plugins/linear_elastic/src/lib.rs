//! `liblinear_elastic.so`: isotropic linear elasticity as a UMAT.

umat_abi::export_umat!(models::linear_elastic::LinearElastic, "linear_elastic");
