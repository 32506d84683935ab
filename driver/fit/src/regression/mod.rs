//! Bond laws by regression of mean traction on mean slip (thesis, section 6.2): straight lines, or a straight line and
//! two powers. The joints are found by trying all of them.

mod piecewise;
mod powers;
mod sums;
#[cfg(test)]
mod test;

pub use piecewise::piecewise;
pub use powers::powers;

/// Every n-th point, so that there are at most so many.
pub(crate) fn thinned<T: Copy>(points: &[T], most: usize) -> Vec<T> {
    points.iter().step_by(points.len().div_ceil(most).max(1)).copied().collect()
}
