//! The entry points as a library exports them, linked into a program and called without a loader: what Miri can run.
//!
//! ```text
//! cargo +nightly miri test -p models --test linked --target aarch64-unknown-linux-gnu
//! ```
//!
//! On x86-64 the exports switch the floating-point environment in assembly, which Miri does not know. Without Miri the tests of the
//! plugins call the same functions through the loader, and nothing is compiled here.

#![cfg(any(miri, clippy))]

#[path = "../../tests/src/memory.rs"]
#[allow(dead_code, reason = "a part of it is needed here")]
mod memory;
#[path = "../../tests/src/sample.rs"]
#[allow(dead_code, reason = "a part of it is needed here")]
mod sample;

/// The library of all laws, linked.
#[path = "../plugins/pullout_laws/src/lib.rs"]
mod pullout_laws;

use memory::PointMemory;
use sample::{LAWS, Sample};
use std::ptr::null_mut;
use umat_abi::law::StressState;
use umat_abi::umat::UmatFunction;

unsafe extern "C" {
    /// The one that is exported above.
    fn umat_();
}

fn umat() -> UmatFunction {
    // SAFETY: it is defined with the arguments of UMAT.
    unsafe { std::mem::transmute(umat_ as *const ()) }
}

const STATES: [StressState; 3] =
    [StressState::ThreeD, StressState::PlaneStrainOrAxisymmetric, StressState::PlaneStress];

#[test]
fn every_law_along_a_short_path() {
    for law in LAWS {
        for stress_state in STATES {
            let mut point = PointMemory::new(law, stress_state);
            for factor in [0.4, 0.8, -0.3] {
                point.dstran = [factor * law.strain, 0.1 * law.strain, 0.0, -0.2 * law.strain, 0.0, 0.0];
                point.call(umat());

                assert!(point.stress().iter().all(|stress| stress.is_finite()), "{}", law.name);
                assert!(point.pnewdt >= 1.0, "{}", law.name);
            }
        }
    }
}

/// Pointers that are NULL and counts that are wrong: nothing is read or written through them.
#[test]
fn arguments_that_are_missing() {
    for law in LAWS {
        let mut point = PointMemory::new(law, StressState::ThreeD);
        point.dstran[0] = law.strain;
        let whole = point.arguments();
        for missing in 0..6 {
            let mut arguments = whole;
            match missing {
                0 => arguments.ddsdde = null_mut(),
                1 => (arguments.sse, arguments.spd, arguments.scd) = (null_mut(), null_mut(), null_mut()),
                2 => arguments.pnewdt = null_mut(),
                3 => arguments.props = std::ptr::null(),
                4 => arguments.cmname = std::ptr::null(),
                _ => arguments.statev = null_mut(),
            }
            // SAFETY: all others are as of a host.
            unsafe { arguments.call(umat()) };
        }
        for [ntens, nstatv, nprops] in [[5, 0, 0], [-1, -1, -1], [6, 1, 1], [0, 0, i32::MIN]] {
            let mut point = PointMemory::new(law, StressState::ThreeD);
            point.counts[0] = ntens;
            (point.nstatv, point.nprops) = (nstatv, nprops);
            point.call(umat());
        }
    }
}
