//! Fortran CHARACTER arguments.

/// The text without the blanks (and NULs, of C callers) at its end.
///
/// # Safety
/// `text` points to `length` bytes.
pub(crate) unsafe fn trimmed(text: *const u8, length: usize) -> String {
    // SAFETY: said above.
    let bytes = unsafe { std::slice::from_raw_parts(text, length) };
    let end = bytes.iter().position(|&byte| byte == 0).unwrap_or(length);
    String::from_utf8_lossy(&bytes[..end]).trim_end().to_owned()
}

/// Fills a CHARACTER variable, blank-padded or cut off.
///
/// # Safety
/// `variable` points to `length` writable bytes.
pub(crate) unsafe fn assign(variable: *mut u8, length: usize, text: &str) {
    // SAFETY: said above.
    let bytes = unsafe { std::slice::from_raw_parts_mut(variable, length) };
    bytes.fill(b' ');
    for (target, source) in bytes.iter_mut().zip(text.bytes()) {
        *target = source;
    }
}
