//! The compiled part of the package `pullout_fe`. The interface for users is written in Python; here is what must be
//! fast, and what only the engine knows.

mod analysis;
mod errors;
mod fit;
mod law;
mod points;
mod run;
mod sweep;

/// The module `pullout_fe._core`.
#[pyo3::pymodule]
mod _core {
    #[pymodule_export]
    use super::fit::least_squares;
    #[pymodule_export]
    use super::law::{Plugin, find, is_shipped, plugins, sha256};
    #[pymodule_export]
    use super::run::{
        Stop, Trail, check, document, dotted, examples, main, off_grid, on_grid, program, run, schema, set_program,
        unit,
    };

    #[pymodule_export]
    use super::sweep::collect;

    /// The package's version.
    #[pymodule_export]
    const VERSION: &str = env!("CARGO_PKG_VERSION");

    /// Stack, in bytes, of threads that call plugins.
    #[pymodule_export]
    const STACK: usize = pullout_run::PLUGIN_STACK;

    /// Number of places that a fit is searched from, unless others are asked for.
    #[pymodule_export]
    const STARTS: u32 = pullout_fit::CaseRequest::STARTS;

    /// File name of the library of the utility routines, by which an installation is known.
    #[pymodule_init]
    fn init(module: &pyo3::Bound<'_, pyo3::types::PyModule>) -> pyo3::PyResult<()> {
        use pyo3::types::PyModuleMethods;
        module.add("UTILITIES", umat_abi::host::library_file_name(umat_abi::host::UTILITIES))
    }
}
