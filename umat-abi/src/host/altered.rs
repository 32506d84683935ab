//! Calls that a careless host makes: NULL for arguments that a plugin may not need, and wrong counts
//! (docs/reference/abi.md). For tests of plugins; the memory stays the host's own, whatever the plugin does within
//! the counts it is told.

use super::call::{CallOutcome, UmatCall};
use super::interface_call::{FricCall, UinterCall};
use super::memory::{CANARIES, Overrun};
use crate::fric::FricArguments;
use crate::uinter::UinterArguments;
use crate::umat::UmatArguments;

/// Fault that is put into a call on purpose.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Alteration<'a> {
    /// Nothing.
    None,
    /// Passes NULL for this argument; a name of the call's `OPTIONAL_ARGUMENTS` or its tangent's (any other changes nothing).
    Null(&'a str),
    /// NTENS, NDI, NSHR (NDIR or NFDIR in the first place). Never more components than the call has.
    Components([i32; 3]),
    /// NSTATV; at most the true length.
    StateCount(i32),
    /// NPROPS; a few more than there are is possible, they are NaN.
    PropertyCount(i32),
}

/// The list of names and the function that makes one NULL, from one list.
macro_rules! nullable {
    ($call:ident, $arguments:ident, $tangent:ident, $($name:ident)+) => {
        impl $call {
            /// Arguments that a plugin with metadata does not need (docs/reference/abi.md).
            pub const OPTIONAL_ARGUMENTS: &'static [&'static str] = &[$(stringify!($name)),+];
            /// The tangent's name: NULL means "stress only" to plugins that declare it.
            pub const TANGENT_ARGUMENT: &'static str = stringify!($tangent);

            fn without(arguments: &mut $arguments, name: &str) {
                match name {
                    $(stringify!($name) => arguments.$name = std::ptr::null_mut(),)+
                    stringify!($tangent) => arguments.$tangent = std::ptr::null_mut(),
                    _ => {}
                }
            }
        }
    };
}

nullable!(UmatCall, UmatArguments, ddsdde, rpl ddsddt drplde drpldt temp dtemp predef dpred coords drot pnewdt celent
    dfgrd0 dfgrd1 layer kspt cmname);
nullable!(UinterCall, UinterArguments, ddsddr, dviscous dstructural flux ddfddt ddsddt ddfddr pnewdt temp dtemp predef
    dpred freqr ciname slname msname coords alocaldir drot area chrlngth node npred mcrd kit linper lprint);
nullable!(FricCall, FricArguments, ddtddg, ddtddt pnewdt taulm dpress ddpddh ciname slname msname npt node npatch coords
    rcoord drot temp predef mcrd npred chrlngth);

/// A count as large as the memory allows.
fn at_most(count: i32, length: usize) -> i32 {
    count.min(i32::try_from(length).unwrap_or(i32::MAX))
}

impl UmatCall {
    /// A call with DDSDDE filled as by [`Self::call_with_tangent_filled`] and one thing wrong.
    ///
    /// # Errors
    /// [`Overrun`] if the plugin wrote behind an array.
    pub fn call_altered(&mut self, filling: f64, alteration: Alteration<'_>) -> Result<CallOutcome, Overrun> {
        let (ntens, states, properties) = (self.ntens(), self.statev().len(), self.props().len());
        let mut counts = [0; 3];
        let counts_address = counts.as_mut_ptr();
        // SAFETY: pointers become NULL or point to counts that are alive and not greater than the memory behind.
        let alter = |a: &mut UmatArguments| match alteration {
            Alteration::None => {}
            Alteration::Null(name) => Self::without(a, name),
            Alteration::Components([n, ndi, nshr]) => {
                // SAFETY: three values.
                unsafe {
                    counts_address.write(at_most(n, ntens));
                    counts_address.add(1).write(ndi);
                    counts_address.add(2).write(nshr);
                    (a.ntens, a.ndi, a.nshr) = (counts_address, counts_address.add(1), counts_address.add(2));
                }
            }
            Alteration::StateCount(n) => a.nstatv = store(counts_address, at_most(n, states)),
            Alteration::PropertyCount(n) => a.nprops = store(counts_address, at_most(n, properties + CANARIES)),
        };
        // SAFETY: as said at `alter`.
        unsafe { self.call_with(false, filling, alter) }
    }
}

/// Writes a count and hands its address on.
fn store(address: *mut i32, value: i32) -> *const i32 {
    // SAFETY: `address` is the first of three counts on the caller's stack.
    unsafe { address.write(value) };
    address
}

/// The same for both interface calls, whose count of components differs in name only.
macro_rules! interface_altered {
    ($call:ident, $arguments:ident, $directions:ident) => {
        impl $call {
            /// A call with the tangents set to `filling` before, and one thing wrong.
            ///
            /// # Errors
            /// [`Overrun`] if the plugin wrote behind an array.
            pub fn call_altered(&mut self, filling: f64, alteration: Alteration<'_>) -> Result<CallOutcome, Overrun> {
                let (directions, states, properties) = (self.traction().len(), self.statev().len(), self.props().len());
                let mut counts = [0; 3];
                let address = counts.as_mut_ptr();
                let alter = |a: &mut $arguments| match alteration {
                    Alteration::None => {}
                    Alteration::Null(name) => Self::without(a, name),
                    Alteration::Components([n, ..]) => a.$directions = store(address, at_most(n, directions)),
                    Alteration::StateCount(n) => a.nstatv = store(address, at_most(n, states)),
                    Alteration::PropertyCount(n) => a.nprops = store(address, at_most(n, properties + CANARIES)),
                };
                // SAFETY: pointers became NULL or point to counts that are alive and not greater than the memory
                // behind them.
                unsafe { self.call_with(filling, alter) }
            }
        }
    };
}

interface_altered!(UinterCall, UinterArguments, ndir);
interface_altered!(FricCall, FricArguments, nfdir);
