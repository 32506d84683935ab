//! The SSE control register (rounding, flush-to-zero): a foreign library must not change ours.
//! (A gfortran `-Ofast` library switches flush-to-zero on when it is loaded.)

/// Reads MXCSR.
#[cfg(target_arch = "x86_64")]
pub(super) fn control() -> u32 {
    let mut value = 0_u32;
    // SAFETY: STMXCSR stores 32 bits at the address.
    unsafe { std::arch::asm!("stmxcsr [{}]", in(reg) &raw mut value, options(nostack, preserves_flags)) };
    value
}

/// Writes MXCSR.
#[cfg(target_arch = "x86_64")]
pub(super) fn set_control(value: u32) {
    // SAFETY: the value came from `control`.
    unsafe { std::arch::asm!("ldmxcsr [{}]", in(reg) &raw const value, options(nostack, preserves_flags)) };
}

/// Elsewhere there is nothing to keep.
#[cfg(not(target_arch = "x86_64"))]
pub(super) fn control() -> u32 {
    0
}

/// Elsewhere there is nothing to keep.
#[cfg(not(target_arch = "x86_64"))]
pub(super) fn set_control(_value: u32) {}

/// The control bits, without the sticky exception flags.
pub(super) fn modes(control: u32) -> u32 {
    control & !0x3f
}
