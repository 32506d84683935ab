//! Where the time of a run goes.

use std::time::{Duration, Instant};

/// Time by the clock since the analysis was made or resumed. What a run takes beyond their sum goes to vectors,
/// judgements and output.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Times {
    /// Laws, forces and stiffnesses of the elements.
    pub solids: Duration,
    /// Feet, laws, forces and blocks of contact.
    pub contact: Duration,
    /// The system's matrix from stiffnesses and blocks.
    pub assembly: Duration,
    /// Factors.
    pub factorisation: Duration,
    /// Solutions with them.
    pub solution: Duration,
}

/// Does some work and adds the time that it takes.
pub(super) fn timed<T>(sum: &mut Duration, work: impl FnOnce() -> T) -> T {
    let start = Instant::now();
    let result = work();
    *sum += start.elapsed();
    result
}
