//! One call in a child process, with every array beside a page that cannot be touched: reading or writing outside an
//! array is seen when it happens, with the argument and the element.
//!
//! For `pullout plugin check`, and for a run that fails: one that succeeds must not pay for it. The child is a copy of this process (fork), makes the one
//! call, and ends; what it prints goes nowhere.

mod child;
mod fences;

use super::memory::Trespass;
pub(super) use child::ask;

/// Position of an array between its two forbidden pages.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Alignment {
    /// Ends where the page behind begins: element n + 1 is forbidden.
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
