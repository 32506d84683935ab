//! The greatest memory that the process has held.

/// Forgets what was held before. Where the kernel has no such books, [`peak`] tells nothing.
pub fn forget_peak() {
    // the file is written for what that does; a kernel that refuses keeps the greatest of all runs
    let _ = std::fs::write("/proc/self/clear_refs", "5");
}

/// The greatest resident memory since [`forget_peak`], MB.
pub fn peak() -> Option<f64> {
    let text = std::fs::read_to_string("/proc/self/status").ok()?;
    let line = text.lines().find_map(|line| line.strip_prefix("VmHWM:"))?;
    let kilobytes: f64 = line.trim().strip_suffix("kB")?.trim().parse().ok()?;
    Some(1e-3 * kilobytes)
}
