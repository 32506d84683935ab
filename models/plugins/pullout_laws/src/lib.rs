//! `libpullout_laws.so`: every law behind one `umat_`, for hosts that load one library per job.
//! CMNAME and CINAME choose the law; see [`umat_abi::export_library!`].

use models::{drucker_prager::DruckerPrager, j2_plasticity::J2Plasticity, linear_elastic::LinearElastic};

umat_abi::export_library!(
    umat: [LinearElastic, J2Plasticity, DruckerPrager],
    interface: [],
);
