//! Entry points that leave their arguments as they are, in a library without a description.

/// UMAT under its usual name.
#[unsafe(no_mangle)]
pub extern "C" fn umat_() {}

/// UINTER under another name.
#[unsafe(no_mangle)]
pub extern "C" fn my_uinter_() {}
