//! The peak memory of the process.

/// Resets the peak of the memory. If the kernel does not record it, [`peak`] is meaningless.
pub fn forget_peak() {
    // writing to the file resets the peak; if the kernel refuses, the peak remains that of all runs
    let _ = std::fs::write("/proc/self/clear_refs", "5");
}

/// Returns the largest resident memory since [`forget_peak`], MB.
pub fn peak() -> Option<f64> {
    let text = std::fs::read_to_string("/proc/self/status").ok()?;
    let line = text.lines().find_map(|line| line.strip_prefix("VmHWM:"))?;
    let kilobytes: f64 = line.trim().strip_suffix("kB")?.trim().parse().ok()?;
    Some(1e-3 * kilobytes)
}
