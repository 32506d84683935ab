//! The SSE control register (rounding, flush-to-zero, traps), from both sides of the ABI: a foreign library must not
//! change the host's, and the host's must not change what a law computes.

/// Rounding to nearest, no flush-to-zero, every exception masked: what compilers assume. On other processors the control is always 0.
const DEFAULT: u32 = if cfg!(target_arch = "x86_64") { 0x1f80 } else { 0 };

/// The control with traps for invalid operations, divisions by zero and overflow, and no exception pending.
#[cfg(feature = "host")]
pub(crate) fn with_traps(control: u32) -> u32 {
    const MASKS: u32 = 1 << 7 | 1 << 9 | 1 << 10;
    modes(control) & !MASKS
}

/// Reads MXCSR.
#[cfg(target_arch = "x86_64")]
#[inline]
pub(crate) fn control() -> u32 {
    let mut value = 0_u32;
    // SAFETY: STMXCSR stores 32 bits at the address.
    unsafe { std::arch::asm!("stmxcsr [{}]", in(reg) &raw mut value, options(nostack, preserves_flags)) };
    value
}

/// Writes MXCSR.
#[cfg(target_arch = "x86_64")]
#[inline]
pub(crate) fn set_control(value: u32) {
    // SAFETY: LDMXCSR reads 32 bits; the value came from `control` or is the default.
    unsafe { std::arch::asm!("ldmxcsr [{}]", in(reg) &raw const value, options(nostack, preserves_flags)) };
}

/// Does nothing: on other processors there is nothing to keep.
#[cfg(not(target_arch = "x86_64"))]
pub(crate) fn control() -> u32 {
    0
}

/// Does nothing: on other processors there is nothing to keep.
#[cfg(not(target_arch = "x86_64"))]
pub(crate) fn set_control(_value: u32) {}

/// The control bits, without the sticky exception flags.
pub(crate) fn modes(control: u32) -> u32 {
    control & !0x3f
}

/// Runs `body` in the default floating-point environment: a host may have set traps (a masked division by zero is
/// harmless in a law, a trapped one kills the process) or flush-to-zero. On other processors the environment is taken as it is.
#[inline]
pub fn in_default_environment<R>(body: impl FnOnce() -> R) -> R {
    let hosts = control();
    if modes(hosts) == DEFAULT {
        return body();
    }
    set_control(DEFAULT);
    let result = body();
    set_control(hosts);
    result
}
