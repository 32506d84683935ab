//! Calls of a UINTER or FRIC that knows contact in space only: in a plane its second slip is 0, and its shear is dropped.

use super::super::call::CallOutcome;
use super::super::interface_call::{FricCall, UinterCall};
use super::super::memory::Overrun;
use super::super::probe::{Alignment, Probed};
use super::super::{LoadError, Plugin, Trespass};
use std::mem::swap;

/// Penetration and slips of the calls that find out, mm.
const DISPLACEMENT: f64 = 1e-6;
/// Pressure under which FRIC is asked, MPa.
const PRESSURE: f64 = 1.0;

/// A call with one direction more that is made instead, and why.
#[derive(Debug)]
pub(in super::super) struct Wide<C> {
    call: C,
    reason: String,
}

impl<C> Wide<C> {
    /// The call that is made.
    pub(super) fn call_mut(&mut self) -> &mut C {
        &mut self.call
    }
}

/// Makes calls of a contact law wide where they must be: the count of directions, what a plane has and space has, and how a call is
/// made ready for the question.
macro_rules! wide {
    ($call:ident, $count:literal, [$plane:literal, $space:literal], $probe:ident, $of:ident, |$asked:ident| $ask:block) => {
        impl $call {
            /// Returns why calls in a plane are made with two slip directions, if they are.
            pub fn why_wide(&self) -> Option<&str> {
                self.wide.as_ref().map(|wide| &*wide.reason)
            }

            /// The call with two slip directions that this one goes through, with the arguments of its last call.
            pub fn wide(&self) -> Option<&Self> {
                self.wide.as_ref().map(|wide| &wide.call)
            }

            /// Repeats the last call, as it was prepared, in child processes; returns where it accesses memory outside
            /// an array, if it does.
            pub fn trespass_again(&mut self) -> Option<Trespass> {
                let Some(mut wide) = self.wide.take() else { return self.trespass() };
                self.hand_over(&mut wide.call);
                let found = wide.call.trespass();
                self.wide = Some(wide);
                found
            }

            /// Calls the plugin with one direction more.
            #[cold]
            pub(in super::super) fn call_wide(&mut self) -> Result<CallOutcome, Overrun> {
                let Some(mut wide) = self.wide.take() else { return self.call() };
                self.hand_over(&mut wide.call);
                swap(&mut self.fields, &mut wide.call.fields);
                let outcome = wide.call.call();
                swap(&mut self.fields, &mut wide.call.fields);
                self.take_over(&wide.call);
                self.wide = Some(wide);
                outcome
            }

            /// Copies what both calls have in common to one with a direction more.
            fn hand_over(&mut self, wide: &mut Self) {
                let directions = self.stress().len();
                wide.take_inputs(self);
                wide.stress_mut().fill(0.0);
                wide.stress_mut()[..directions].copy_from_slice(self.stress());
                wide.statev_mut().copy_from_slice(self.statev());
            }

            /// Takes over the results that a plane has.
            fn take_over(&mut self, wide: &Self) {
                let directions = self.stress().len();
                self.stress_mut().copy_from_slice(&wide.stress()[..directions]);
                self.statev_mut().copy_from_slice(wide.statev());
                for column in 0..directions {
                    for row in 0..directions {
                        self.tangent.as_mut_slice()[column * directions + row] = wide.tangent(row, column);
                    }
                }
                self.take_outputs(wide);
            }

            /// Returns where a call leaves an array, asked in child processes.
            fn leaves_an_array(&mut self) -> Option<String> {
                let $asked = self;
                $ask
                [Alignment::End, Alignment::Start].into_iter().find_map(|alignment| match $asked.probe(alignment) {
                    Ok(Probed::Trespass(trespass)) => Some(trespass.to_string()),
                    _ => None,
                })
            }
        }

        impl Plugin {
            /// Makes a call in a plane go through one with two slip directions if the law, of which nothing is known, leaves its
            /// arrays with one and not with two. What may write wild is tried in a child process. From then on the arrays are
            /// fenced.
            ///
            /// # Errors
            /// The library has no such entry point.
            pub fn $probe(&self, call: &mut $call) -> Result<(), LoadError> {
                if self.law.is_none() && call.stress().len() == $plane {
                    let ask = || self.$of($plane);
                    let reason = ask()?.leaves_an_array();
                    if let Some(reason) = reason
                        && self.$of($space)?.leaves_an_array().is_none()
                    {
                        let reason = format!("with {} = {} it {reason}", $count, $plane);
                        let mut wide = self.$of($space)?;
                        wide.fence();
                        call.wide = Some(Box::new(Wide { call: wide, reason }));
                    }
                }
                call.fence();
                Ok(())
            }
        }
    };
}

wide!(UinterCall, "NDIR", [2, 3], probe_uinter, uinter, |call| {
    let slips = call.stress().len();
    call.rdisp[..slips].fill(DISPLACEMENT);
    call.drdisp = call.rdisp;
});
wide!(FricCall, "NFDIR", [1, 2], probe_fric, fric, |call| {
    let slips = call.stress().len();
    call.dgam[..slips].fill(DISPLACEMENT);
    call.pressure = [PRESSURE; 2];
    call.lm = 0;
});
