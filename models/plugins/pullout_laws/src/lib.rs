//! `libpullout_laws.so`: one `umat_`, `uinter_` and `fric_` for all laws, for hosts that load one library per job.
//! CMNAME or CINAME selects the law; see [`umat_abi::export_library!`].

models::laws!(umat_abi::export_library);
