//! Pictures as PNG and as PDF, in builds with the feature `pictures`.

use std::io;

#[cfg(feature = "pictures")]
mod conversion;
#[cfg(feature = "pictures")]
pub(crate) use conversion::draw_upon;
#[cfg(feature = "pictures")]
pub use conversion::{pdf, png};

/// A picture in another format.
pub type Export = fn(&str) -> io::Result<Vec<u8>>;

/// Refuses what needs the feature `pictures` in a build without it.
///
/// # Errors
/// This build lacks the feature.
pub fn can_export() -> io::Result<()> {
    if cfg!(feature = "pictures") { Ok(()) } else { Err(missing()) }
}

/// The error of a build that lacks the feature.
pub(crate) fn missing() -> io::Error {
    crate::lacks("PNG, PDF and GIF need", "pictures")
}

/// Refuses to make a PNG.
///
/// # Errors
/// Always: this build lacks the feature `pictures`.
#[cfg(not(feature = "pictures"))]
pub fn png(_svg: &str) -> io::Result<Vec<u8>> {
    Err(missing())
}

/// Refuses to make a PDF.
///
/// # Errors
/// Always: this build lacks the feature `pictures`.
#[cfg(not(feature = "pictures"))]
pub fn pdf(_svg: &str) -> io::Result<Vec<u8>> {
    Err(missing())
}
