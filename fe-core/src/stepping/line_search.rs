//! How much of a correction is taken: for specimens, and for points along paths.

/// The first part of a specimen's correction that is tried where the whole one was not good.
pub(crate) const FIRST_OF_SPECIMENS: f64 = 0.5;
/// Number of parts of a specimen's correction that are tried.
pub(crate) const TRIES_OF_SPECIMENS: u32 = 4;
/// Parts of a point's correction that are tried, the whole one included.
pub const TRIES_OF_POINTS: u32 = 6;
/// A point's correction is taken if its residual falls by this fraction of the part that is taken.
const SUFFICIENT_DECREASE: f64 = 1e-3;

/// Returns whether the residual of a point falls enough when this part of a correction is taken.
pub fn descends(before: f64, after: f64, part: f64) -> bool {
    after <= (1.0 - SUFFICIENT_DECREASE * part) * before
}

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
