//! How much of a correction is taken: for specimens, and for points along paths.

/// Tries `tries` parts of a correction, the first one and each half of that before it, until one is accepted; `accepts`
/// evaluates a part. Returns it; `None`: none was accepted.
pub fn halved<E>(first: f64, tries: u32, mut accepts: impl FnMut(f64) -> Result<bool, E>) -> Result<Option<f64>, E> {
    let mut part = first;
    for _ in 0..tries {
        if accepts(part)? {
            return Ok(Some(part));
        }
        part *= 0.5;
    }
    Ok(None)
}
