//! Calls of a careless host: NULL for arguments that a plugin may not need, and wrong counts (docs/reference/abi.md).
//!
//! For tests of plugins. The memory stays the host's own, whatever the plugin does within the counts it receives.

use super::call::{CallOutcome, UmatCall};
use super::interface_call::{FricCall, UinterCall};
use super::memory::{CANARIES, Overrun};
use crate::fric::FricArguments;
use crate::uinter::UinterArguments;
use crate::umat::UmatArguments;
use std::hint::black_box;

/// Fault that is put into a call on purpose.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Alteration<'a> {
    /// No alteration.
    None,
    /// Passes NULL for this argument; a name of the call's `OPTIONAL_ARGUMENTS` or its tangent's (any other changes nothing).
    Null(&'a str),
    /// NTENS, NDI, NSHR (NDIR or NFDIR in the first place). Never more components than the call has.
    Components([i32; 3]),
    /// NSTATV; at most the true length.
    StateCount(i32),
    /// NPROPS; a few more than there are is possible, they are NaN.
    PropertyCount(i32),
    /// Fills the stack that the plugin is about to use with this word: variables that it reads before it sets them have that value.
    Stack(u64),
}

impl Alteration<'_> {
    /// Returns the counts to pass for a call with these numbers of components, states and properties. None is greater
    /// than the memory that it describes.
    fn counts(self, [components, states, properties]: [usize; 3]) -> [i32; 3] {
        let at_most = |count: i32, length: usize| count.min(i32::try_from(length).unwrap_or(i32::MAX));
        match self {
            Self::None | Self::Null(_) | Self::Stack(_) => [0; 3],
            Self::Components([count, direct, shear]) => [at_most(count, components), direct, shear],
            Self::StateCount(count) => [at_most(count, states); 3],
            Self::PropertyCount(count) => [at_most(count, properties + CANARIES); 3],
        }
    }
}

/// Leaves a word all over the stack below its caller.
#[inline(never)]
fn fill_stack(word: u64) {
    // deeper than the frames of a law reach, shallow enough for any thread
    const WORDS: usize = 16 << 10;
    black_box([word; WORDS].as_mut_slice());
}

/// Makes altered calls: the tangent, what a call has besides the filling and the alteration, the counts of components, and what may
/// be NULL.
macro_rules! altered {
    ($call:ident, $arguments:ident, $tangent:ident, ($($own:expr)?), [$($count:ident)+], $($name:ident)+) => {
        impl $call {
            /// Arguments that a plugin with metadata does not need (docs/reference/abi.md).
            pub const OPTIONAL_ARGUMENTS: &'static [&'static str] = &[$(stringify!($name)),+];
            /// The tangent's name: NULL means "stress only" to plugins that declare it.
            pub const TANGENT_ARGUMENT: &'static str = stringify!($tangent);

            /// Makes a call with one thing wrong; the tangents are set to `filling` before.
            ///
            /// # Errors
            /// [`Overrun`] if the plugin wrote past an array.
            pub fn call_altered(&mut self, filling: f64, alteration: Alteration<'_>) -> Result<CallOutcome, Overrun> {
                let counts = alteration.counts([self.stress().len(), self.statev().len(), self.props().len()]);
                let alter = |arguments: &mut $arguments| match alteration {
                    Alteration::None => {}
                    Alteration::Null(name) => match name {
                        $(stringify!($name) => arguments.$name = std::ptr::null_mut(),)+
                        stringify!($tangent) => arguments.$tangent = std::ptr::null_mut(),
                        _ => {}
                    },
                    Alteration::Components(_) => {
                        let mut counts = counts.iter();
                        $(arguments.$count = counts.next().map_or(std::ptr::null(), std::ptr::from_ref);)+
                    }
                    Alteration::StateCount(_) => arguments.nstatv = &raw const counts[0],
                    Alteration::PropertyCount(_) => arguments.nprops = &raw const counts[0],
                    Alteration::Stack(word) => fill_stack(word),
                };
                // SAFETY: pointers became NULL or point to live counts that are not greater than the memory they describe.
                unsafe { self.call_with($($own,)? filling, alter) }
            }
        }
    };
}

altered!(UmatCall, UmatArguments, ddsdde, (false), [ntens ndi nshr], rpl ddsddt drplde drpldt temp dtemp predef dpred coords
    drot pnewdt celent dfgrd0 dfgrd1 layer kspt cmname);
altered!(UinterCall, UinterArguments, ddsddr, (), [ndir], dviscous dstructural flux ddfddt ddsddt ddfddr pnewdt temp dtemp
    predef dpred freqr ciname slname msname coords alocaldir drot area chrlngth node npred mcrd kit linper lprint);
altered!(FricCall, FricArguments, ddtddg, (), [nfdir], ddtddt pnewdt taulm dpress ddpddh ciname slname msname npt node npatch
    coords rcoord drot temp predef mcrd npred chrlngth);
