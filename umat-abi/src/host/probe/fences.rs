//! Fences around the arrays of each entry point.

use super::super::call::UmatCall;
use super::super::fence::Fenced;
use super::super::interface_call::{FricCall, UinterCall};
use super::super::memory::NAME_LENGTH;
use super::{Alignment, Probed, Trespass, child};
use std::io;

/// Implements `probe` for a call: which arguments are arrays, and how many values each has.
macro_rules! probed {
    ($call:ident, |$this:ident| $arguments:expr, { $($field:ident: $count:expr),+ $(,)? }) => {
        impl $call {
            /// Makes the call, as it is prepared, in a child process.
            ///
            /// # Errors
            /// The system gives no memory or no process.
            pub fn probe(&mut self, alignment: Alignment) -> io::Result<Probed> {
                let $this = self;
                let from = $arguments;
                let mut to = from;
                let mut fenced = Vec::new();
                $(
                    // SAFETY: the argument points to as many values.
                    let copy = unsafe { Fenced::copy_of(stringify!($field), from.$field, $count, alignment) }?;
                    to.$field = copy.address().cast();
                    fenced.push(copy);
                )+
                let function = $this.function;
                // SAFETY: every pointer is valid for the sizes that the counts give.
                let probed = child::run(&fenced, || unsafe { to.call(function) })?;
                Ok(match probed {
                    Probed::Trespass(trespass) => {
                        Probed::Trespass(Trespass { argument: trespass.argument.to_uppercase().into(), ..trespass })
                    }
                    other => other,
                })
            }

            /// Makes the call, as it is prepared, in child processes; returns where it accesses memory outside an
            /// array, if it does.
            pub fn trespass(&mut self) -> Option<Trespass> {
                [Alignment::End, Alignment::Start].into_iter().find_map(|alignment| match self.probe(alignment) {
                    Ok(Probed::Trespass(trespass)) => Some(trespass),
                    _ => None,
                })
            }
        }
    };
}

/// Slave and master: TEMP.
const SURFACES: usize = 2;

probed!(UmatCall, |call| call.arguments(false), {
    stress: call.ntens(), statev: call.statev().len(), ddsdde: call.ntens().pow(2), ddsddt: call.ntens(),
    drplde: call.ntens(), stran: call.ntens(), dstran: call.ntens(), time: 2, predef: call.predef.len(),
    dpred: call.dpred.len(), props: call.props().len(), coords: 3, drot: 9, dfgrd0: 9, dfgrd1: 9, jstep: 4, cmname: NAME_LENGTH,
});

probed!(UinterCall, |call| call.arguments(), {
    stress: call.stress().len(), ddsddr: call.stress().len().pow(2), dviscous: call.stress().len().pow(2),
    dstructural: call.stress().len().pow(2), flux: 2, ddfddt: 4, ddsddt: 2 * call.stress().len(),
    ddfddr: 2 * call.stress().len(), statev: call.statev().len(), rdisp: call.stress().len(),
    drdisp: call.stress().len(), temp: SURFACES, dtemp: SURFACES, predef: call.fields.predef()[0].len(),
    dpred: call.fields.predef()[1].len(), time: 2,
    ciname: NAME_LENGTH, slname: NAME_LENGTH, msname: NAME_LENGTH, props: call.props().len(), coords: 3, alocaldir: 9, drot: 4,
});

probed!(FricCall, |call| call.arguments(), {
    tau: call.stress().len(), ddtddg: call.stress().len().pow(2), ddtddp: call.stress().len(),
    dslip: call.stress().len(), ddtddt: 2 * call.stress().len(), statev: call.statev().len(),
    dgam: call.stress().len(), taulm: call.stress().len(), slip: call.stress().len(), time: 2, ciname: NAME_LENGTH,
    slname: NAME_LENGTH, msname: NAME_LENGTH, coords: 3, rcoord: 3, drot: 4, temp: SURFACES,
    predef: call.fields.predef()[0].len(),
    props: call.props().len(),
});
