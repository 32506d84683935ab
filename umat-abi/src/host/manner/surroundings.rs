//! Trial calls with numbers around the arrays of a plugin in place of NaN, with which every comparison is false: what a law reads
//! outside its arrays and only compares shows in no result.

use super::super::call::UmatCall;
use super::super::interface_call::{FricCall, UinterCall};
use super::super::memory::{CANARY, same_bits};
use crate::law::Request;
use std::ops::DerefMut;

/// Patterns of the trial calls, at the end that of all other calls.
const PATTERNS: [u64; 3] = [0, 1e3_f64.to_bits(), CANARY];

/// Returns whether the answers of trial calls differ in any bit.
fn differ<const N: usize>(answers: [&Option<Vec<f64>>; N]) -> bool {
    answers.windows(2).any(|pair| match pair {
        [Some(a), Some(b)] => !same_bits(a, b),
        [a, b] => a.is_some() != b.is_some(),
        _ => false,
    })
}

/// Implements the trial calls: the characteristic length, how a call is made, and the call that is made in its place, if one is.
macro_rules! surrounded {
    ($call:ident, $length:ident, |$this:ident| $make:expr, |$outer:ident| $inner:expr) => {
        impl $call {
            /// Makes the present call anew, each time as `prepare` makes it ready, with other numbers around the plugin's arrays;
            /// returns whether stress, states, energies or PNEWDT follow these. They are at the end those of a plain call.
            pub fn depends_on_surroundings(&mut self, mut prepare: impl FnMut(&mut Self)) -> bool {
                let answers = PATTERNS.map(|pattern| {
                    self.surround_all(pattern);
                    prepare(self);
                    self.trial()
                });
                differ(answers.each_ref())
            }

            /// Makes the present call anew, each time as `prepare` makes it ready, with this characteristic length, twice as much, and
            /// this; returns whether stress, states, energies or PNEWDT follow it. They are at the end those of a plain call.
            pub fn depends_on_length(&mut self, mut prepare: impl FnMut(&mut Self)) -> bool {
                let length = self.$length;
                let [before, twice, after] = [length, 2.0 * length, length].map(|length| {
                    self.$length = length;
                    prepare(self);
                    self.trial()
                });
                // what differs from call to call says nothing
                differ([&before, &twice]) && !differ([&before, &after])
            }

            /// Makes a call; returns what a run goes on with, `None` if it wrote outside its arrays.
            fn trial(&mut self) -> Option<Vec<f64>> {
                let $this = &mut *self;
                $make.is_ok().then(|| [self.stress(), self.statev(), &self.energies, &[self.pnewdt]].concat())
            }

            /// Makes the calls of a child process, which are no business of those who watch its parent.
            pub fn leave_record(&mut self) {
                DerefMut::deref_mut(self).leave_record();
                let $outer = self;
                if let Some(inner) = $inner {
                    inner.leave_record();
                }
            }

            fn surround_all(&mut self, pattern: u64) {
                self.surround(pattern);
                let $outer = self;
                if let Some(inner) = $inner {
                    inner.surround(pattern);
                }
            }
        }
    };
}

surrounded!(UmatCall, celent, |call| call.call(Request::Stress), |call| call
    .detour
    .as_mut()
    .and_then(|detour| detour.solid.as_mut()));
surrounded!(UinterCall, chrlngth, |call| call.call(), |call| call.wide.as_mut().map(|wide| wide.call_mut()));
surrounded!(FricCall, chrlngth, |call| call.call(), |call| call.wide.as_mut().map(|wide| wide.call_mut()));
