//! `pullout_umat_batch_v1`: UMAT for many points (docs/reference/abi.md).

#[cfg(doc)]
use crate::metadata::batch_results;
use crate::umat::entry_point;

entry_point! {
    ($) batch
    /// `pullout_umat_batch_v1`: UMAT for `n` points with the same parameters, to the same bits as `n` calls of `umat_` with
    /// DROT = 1. Arrays hold `n` values of the first component, then `n` of the second, and so on: `strain` (at the start),
    /// `dstrain` and `stress` for `ntens` components, `statev` for `nstatv`, `ddsdde` for `ntens`·`ntens` (column by column; NULL:
    /// stress only). `celent` has `n` values or is NULL; `status` has `n`: [`batch_results`]. No allocation; any thread.
    ///
    /// In libraries of one law; where several are linked, or the library of all laws, `<law>_umat_batch_v1` is the name.
    type UmatBatch, batch_symbol;
    /// The arguments of a batch; arrays of `n` values for each component, one component after the other.
    struct BatchArguments {
        /// number of points.
        n: usize,
        /// number of components.
        ntens: i32,
        /// number of direct components.
        ndi: i32,
        /// `(nprops)` parameters.
        props: *const f64,
        /// number of parameters.
        nprops: i32,
        /// `(n,ntens)` total strain at the start.
        strain: *const f64,
        /// `(n,ntens)` strain increment.
        dstrain: *const f64,
        /// `(n,ntens)` stress at the start, and at the end.
        stress: *mut f64,
        /// `(n,nstatv)` state variables.
        statev: *mut f64,
        /// number of state variables.
        nstatv: i32,
        /// `(n,ntens,ntens)` out: tangent, column by column; or NULL.
        ddsdde: *mut f64,
        /// `(n)` characteristic length; or NULL.
        celent: *const f64,
        /// `(n)` out: 0 done, 1 a smaller increment is wanted, 2 refused.
        status: *mut i32,
    }
}
