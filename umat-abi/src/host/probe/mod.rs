//! One call in a child process, with every array beside a page that cannot be touched: reading or writing outside an
//! array is seen when it happens, with the argument and the element.
//!
//! For `pullout plugin check` alone: a run must not pay for it. The child is a copy of this process (fork), makes the one
//! call, and ends; what it prints goes nowhere.

mod child;
mod fences;
mod pages;

use std::fmt;

/// Where an array lies between its two forbidden pages.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Alignment {
    /// It ends where the page behind begins: element n + 1 is forbidden.
    End,
    /// It begins where the page before ends: element 0 is forbidden.
    Start,
}

/// An access outside an array.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Trespass {
    /// The argument's name.
    pub argument: &'static str,
    /// The element touched, as Fortran counts (from 1).
    pub element: i64,
    /// Elements that the array has.
    pub length: usize,
    /// Whether it was written; `None` where the processor does not tell.
    pub writes: Option<bool>,
}

impl fmt::Display for Trespass {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let verb = match self.writes {
            Some(true) => "writes",
            Some(false) => "reads",
            None => "touches",
        };
        write!(f, "{verb} {}({}), which has {} elements", self.argument, self.element, self.length)
    }
}

/// How the call ended.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Probed {
    /// It came back and touched nothing it must not.
    Clean,
    /// It touched something outside an array.
    Trespass(Trespass),
    /// It did not come back: a signal, an exit, a call that takes too long.
    Ended(String),
}
