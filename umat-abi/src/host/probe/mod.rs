//! One call in a child process, with every array beside a page that cannot be touched: reading or writing outside an
//! array is seen when it happens, with the argument and the element.
//!
//! For `pullout plugin check` alone: a run must not pay for it. The child is a copy of this process (fork), makes the one
//! call, and ends; what it prints goes nowhere.

mod child;
mod pages;

use super::call::UmatCall;
use crate::umat::UmatArguments;
use pages::Fenced;
use std::fmt;
use std::io;

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

impl UmatCall {
    /// Makes the call, as it is prepared, in a child process.
    ///
    /// # Errors
    /// The system gives no memory or no process.
    pub fn probe(&mut self, alignment: Alignment) -> io::Result<Probed> {
        let arguments = self.arguments(false);
        let (fenced, arguments) = fence(&arguments, self, alignment)?;
        let function = self.function();
        // SAFETY: every pointer is valid for the sizes that the counts tell.
        child::run(&fenced, || unsafe { arguments.call(function) })
    }
}

/// Copies of the arrays behind the arguments, each between forbidden pages, and the arguments that point to them.
fn fence(from: &UmatArguments, call: &UmatCall, alignment: Alignment) -> io::Result<(Vec<Fenced>, UmatArguments)> {
    let n = call.ntens();
    let mut to = *from;
    let mut fenced = Vec::new();
    // `count` values of the pointer's type.
    macro_rules! fence {
        ($($field:ident: $count:expr),+ $(,)?) => {$(
            // SAFETY: the argument points to as many values.
            let copy = unsafe { Fenced::copy_of(stringify!($field), from.$field, $count, alignment) }?;
            to.$field = copy.address().cast();
            fenced.push(copy);
        )+};
    }
    fence! {
        stress: n, statev: call.statev().len(), ddsdde: n * n, ddsddt: n, drplde: n, stran: n, dstran: n, time: 2,
        predef: call.predef.len(), dpred: call.dpred.len(), props: call.props().len(), coords: 3, drot: 9, dfgrd0: 9,
        dfgrd1: 9, jstep: 4, cmname: 80,
    }
    Ok((fenced, to))
}
