//! Where the time of a run goes.

use std::time::{Duration, Instant};

/// Time by the clock since the analysis was made or resumed. What a run takes beyond their sum goes to vectors,
/// judgements and output.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Times {
    /// Time for the elements' laws, forces and stiffnesses.
    pub solids: Duration,
    /// Time for the contact points' feet, laws, forces and stiffness blocks.
    pub contact: Duration,
    /// Time for assembling the system's matrix from stiffnesses and blocks.
    pub assembly: Duration,
    /// Time for factorising the matrix.
    pub factorisation: Duration,
    /// Time for solving with the factors.
    pub solution: Duration,
}

/// Does some work and adds the time it took to the given sum.
pub(super) fn timed<T>(sum: &mut Duration, work: impl FnOnce() -> T) -> T {
    let start = Instant::now();
    let result = work();
    *sum += start.elapsed();
    result
}
