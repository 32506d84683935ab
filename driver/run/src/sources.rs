//! Sources where a library is expected: who can build one says so, and gets them to build.

use std::path::{Path, PathBuf};
use std::sync::OnceLock;
use umat_abi::host;

/// Makes a library of a source, or returns a message why it cannot.
pub type Builder = fn(&Path) -> Result<PathBuf, String>;

static BUILDER: OnceLock<Builder> = OnceLock::new();

/// Has sources built from now on.
pub fn build_by(builder: Builder) {
    let _ = BUILDER.set(builder);
}

/// Returns the library of a file that is there: itself, or what is built of a source.
///
/// # Errors
/// A message if a source is not built.
pub fn library_of(file: PathBuf) -> Result<PathBuf, String> {
    if !host::is_source(&file) {
        return Ok(file);
    }
    match BUILDER.get() {
        Some(build) => build(&file),
        None => {
            let file = file.display();
            Err(format!("{file} is a source: `pullout plugin build {file}` makes a library of it"))
        }
    }
}
