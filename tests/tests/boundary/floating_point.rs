//! Floating-point modes that a host may have set: flush-to-zero, traps.
#![cfg(target_arch = "x86_64")]

use crate::{Loaded, for_each_law, stderr_of_child};
use end_to_end_tests::{PointMemory, strain_path};
use umat_abi::law::StressState;

/// MXCSR: flush results to zero, take denormal inputs as zero.
const FLUSH_TO_ZERO: u32 = 1 << 15 | 1 << 6;
/// MXCSR: masks of the exceptions invalid, division by zero, overflow.
const TRAPS: u32 = 1 << 7 | 1 << 9 | 1 << 10;

/// Runs with MXCSR changed, and sets it back.
fn with_control<T>(change: impl Fn(u32) -> u32, body: impl FnOnce() -> T) -> T {
    let mut before = 0_u32;
    // SAFETY: STMXCSR stores 32 bits at the address.
    unsafe { std::arch::asm!("stmxcsr [{}]", in(reg) &raw mut before, options(nostack)) };
    // A raised flag of the past must not trap as soon as it is unmasked.
    let changed = change(before) & !0x3f;
    // SAFETY: only mode bits that the processor defines were changed.
    unsafe { std::arch::asm!("ldmxcsr [{}]", in(reg) &raw const changed, options(nostack)) };
    let result = body();
    // SAFETY: as it was before.
    unsafe { std::arch::asm!("ldmxcsr [{}]", in(reg) &raw const before, options(nostack)) };
    result
}

fn history(loaded: &Loaded, stress_state: StressState, size: f64) -> Vec<f64> {
    let mut point = PointMemory::new(loaded.law, stress_state);
    let mut values = Vec::new();
    for increment in strain_path(5, point.ntens(), size, 40) {
        point.advance(loaded.umat, &increment);
        values.extend_from_slice(point.stress());
        values.extend_from_slice(point.tangent());
    }
    values
}

#[test]
fn flush_to_zero_changes_no_result() {
    for_each_law(|loaded, stress_state| {
        let expected = history(loaded, stress_state, loaded.law.strain);
        let found = with_control(|c| c | FLUSH_TO_ZERO, || history(loaded, stress_state, loaded.law.strain));
        let apart = end_to_end_tests::difference(&found, &expected);
        assert!(apart <= 1e-15, "{}: {apart:e}", loaded.law.name);
        // Strains whose squares are denormal or vanish.
        for size in [1e-155, 1e-162, 1e-300, 1e-310] {
            let tiny = with_control(|c| c | FLUSH_TO_ZERO, || history(loaded, stress_state, size));
            assert!(tiny.iter().all(|x| x.is_finite()), "{} at {size:e}", loaded.law.name);
        }
    });
}

#[test]
fn laws_raise_no_trapped_exception() {
    stderr_of_child("floating_point::child_runs_with_traps");
}

/// The check above can fail: a trapped operation does end the process.
#[test]
fn a_trap_ends_a_process() {
    let program = std::env::current_exe().expect("the path of this program");
    let test = "floating_point::child_divides_by_zero_with_traps";
    let output = std::process::Command::new(program).args(["--exact", test, "--ignored"]).output().expect("it runs");
    assert_eq!(std::os::unix::process::ExitStatusExt::signal(&output.status), Some(8), "SIGFPE");
}

#[test]
#[ignore = "runs as a process of its own, which it ends: a_trap_ends_a_process"]
fn child_divides_by_zero_with_traps() {
    with_control(|c| c & !TRAPS, || std::hint::black_box(1.0 / std::hint::black_box(0.0_f64)));
}

#[test]
#[ignore = "runs as a process of its own, which a trap would end: laws_raise_no_trapped_exception"]
fn child_runs_with_traps() {
    for_each_law(|loaded, stress_state| {
        let expected = history(loaded, stress_state, loaded.law.strain);
        let found = with_control(|c| c & !TRAPS, || history(loaded, stress_state, loaded.law.strain));
        assert_eq!(found, expected);
        // A virgin point that is not strained at all: no 0/0.
        let resting = with_control(|c| c & !TRAPS, || history(loaded, stress_state, 0.0));
        assert!(resting.iter().all(|x| x.is_finite()));
        // NaN and infinity are recognised without an operation that traps.
        let (point, _) = loaded.loaded_point(stress_state);
        for value in [f64::NAN, f64::INFINITY] {
            let mut spoilt = point.clone();
            spoilt.dstran[0] = value;
            with_control(|c| c & !TRAPS, || spoilt.call(loaded.umat));
            assert_eq!(spoilt.pnewdt, 0.5);
            let mut spoilt = point.clone();
            spoilt.statev[0] = value;
            with_control(|c| c & !TRAPS, || spoilt.call(loaded.umat));
            assert_eq!(spoilt.pnewdt, 0.5);
        }
    });
}
