//! Parts that the end-to-end tests share: the plugins' places, sample laws, the memory of one material point as a host
//! owns it, random strain paths, damaged files, and the compilers of other languages.

pub mod analytical;
mod clock;
pub mod fuzz;
mod memory;
mod path;
mod sample;
mod toolchain;

pub use battery::{Random, rotated, rotated_in_plane, worst};
pub use clock::CpuClock;
pub use memory::PointMemory;
pub use path::{difference, strain_path};
pub use sample::{LAWS, Sample, sample};
pub use toolchain::{Tool, find, has_library, named_by, notice, run};

use std::path::{Path, PathBuf};

/// Returns the names of the laws that are shipped, each of which has a package of its own.
///
/// # Panics
/// If their folder cannot be read.
pub fn shipped_laws() -> Vec<String> {
    let packages = std::fs::read_dir(workspace("models/plugins")).expect("the packages of the plugins").flatten();
    let mut laws: Vec<String> = packages.map(|package| package.file_name().to_string_lossy().into_owned()).collect();
    laws.retain(|name| name != "pullout_laws");
    laws.sort();
    laws
}

/// The folder into which Cargo builds the plugins: that of the test program itself.
///
/// # Panics
/// If the test program has no path.
pub fn plugin_folder() -> PathBuf {
    let program = std::env::current_exe().expect("the path of this program");
    program.parent().expect("a program lies in a folder").to_path_buf()
}

/// The shared library of a plugin.
pub fn plugin(name: &str) -> PathBuf {
    plugin_folder().join(umat_abi::host::library_file_name(name))
}

/// Opens a library that Cargo or the test itself built.
///
/// # Panics
/// If it cannot be loaded.
pub fn open(path: &Path) -> umat_abi::host::Library {
    // SAFETY: what tests load are plugins of this workspace and of compilers that the tests call.
    unsafe { umat_abi::host::Library::open(path) }.unwrap_or_else(|error| panic!("{error}"))
}

/// A file of this crate or of its neighbours, relative to the workspace.
///
/// # Panics
/// If the crate is no longer a folder of the workspace.
pub fn workspace(file: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).parent().expect("tests/ lies in the workspace").join(file)
}
