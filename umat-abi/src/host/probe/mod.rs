//! One call in a child process, with every array next to a page that cannot be touched. An access outside an array is
//! caught when it happens, with the argument and the element.
//!
//! For `pullout plugin check`, and for a run that fails: one that succeeds must not pay for it. The child is a copy of
//! this process (fork), makes the one call, and ends; its output is discarded.

mod child;
mod fences;

use super::memory::Trespass;
pub(super) use child::ask;
pub use child::compute;

/// Position of an array between its two forbidden pages.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Alignment {
    /// Ends where the next page begins: element n + 1 is forbidden.
    End,
    /// Begins where the page before ends: element 0 is forbidden.
    Start,
}

/// End of the call.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Probed {
    /// Came back and touched nothing it must not.
    Clean,
    /// Touched memory outside an array.
    Trespass(Trespass),
    /// Did not come back: a signal, an exit, a call that takes too long.
    Ended(String),
}
