//! Symbols of a shared library, made from a pure law.
//!
//! The boundary stands what real hosts do (docs/reference/abi.md): NULL for what the law does not need, PNEWDT and
//! DDSDDE full of garbage, missing CHARACTER lengths, wrong counts, NaN. It validates, embeds the
//! components, rotates tensor states by DROT, runs the law on a copy of STATEV, and only then writes.
//! Configuration errors fill STRESS and DDSDDE with NaN (hosts that ignore PNEWDT would go on with
//! zeros); numerical failures leave everything as it was and ask for a cut-back, or, without PNEWDT, make
//! STRESS NaN. No allocation, lock or I/O on the way; no panic leaves.

mod batch;
mod dispatch;
mod interface;
mod kratos;
mod macros;
mod solid;
mod validate;

pub use crate::fric::FricArguments;
pub use crate::uinter::UinterArguments;
pub use crate::umat::UmatArguments;
pub use batch::batch;
pub use dispatch::{NamedEntry, by_name};
pub use interface::{fric, uinter};
pub use kratos::umat_kratos;
pub use solid::umat;
pub use validate::{validate_interface, validate_solid};

use crate::floating_point::in_default_environment;
use crate::law::{CUT_BACK, ConfigurationError, Failure, LawInfo};
use crate::table::{States, all_finite};
use std::ffi::{CStr, c_char};
use std::fmt;
use std::io::Write;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::atomic::{AtomicBool, Ordering};

/// The first error of the process has been printed: a host that goes on calling must not drown in
/// messages. The only global.
static REPORTED: AtomicBool = AtomicBool::new(false);

/// Reason why the boundary refuses a call.
#[derive(Clone, Copy, Debug)]
enum Refusal {
    /// NTENS, NDI, NSHR (NDIR, NFDIR) are not what the law supports.
    Components { first: i32, second: i32, third: i32 },
    /// NSTATV is too small.
    States { given: i32, expected: usize },
    /// A pointer that the law needs is NULL.
    Null { argument: &'static str },
    /// PROPS or CELENT.
    Law(ConfigurationError),
    /// CMNAME names no law of this library.
    UnknownLaw,
    /// The increment failed.
    CutBack { fraction: f64, reason: &'static str },
    /// The law panicked: a bug, reported as such.
    Panic,
}

impl From<ConfigurationError> for Refusal {
    fn from(error: ConfigurationError) -> Self {
        Self::Law(error)
    }
}

impl From<Failure> for Refusal {
    fn from(failure: Failure) -> Self {
        match failure {
            Failure::Configuration(error) => Self::Law(error),
            Failure::CutBack { fraction, reason } => Self::CutBack { fraction, reason },
        }
    }
}

impl fmt::Display for Refusal {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match *self {
            Self::Components { first, second, third } => {
                write!(
                    f,
                    "component counts {first}, {second}, {third} are not supported (NTENS/NDI/NSHR 6/3/3, 4/3/1, 3/2/1; NDIR 1-3; NFDIR 1-2)"
                )
            }
            Self::States { given, expected } => {
                write!(f, "NSTATV = {given}, but the law needs at least {expected}")
            }
            Self::Null { argument } => write!(f, "{argument} is NULL"),
            Self::Law(error) => error.fmt(f),
            Self::UnknownLaw => f.write_str("the material name (CMNAME, CINAME) begins with no law of this library"),
            Self::CutBack { reason, .. } => f.write_str(reason),
            Self::Panic => f.write_str("internal error (panic caught); please report it"),
        }
    }
}

/// Runs the body of an entry point with panics caught, in the default floating-point environment.
#[inline]
fn guarded(body: impl FnOnce() -> Result<(), Refusal>) -> Result<(), Refusal> {
    in_default_environment(|| {
        // the refusal apart from the closure's value, which is copied: one bit if all is well
        let mut refusal = Refusal::Panic;
        let done = catch_unwind(AssertUnwindSafe(|| match body() {
            Ok(()) => true,
            Err(why) => {
                refusal = why;
                false
            }
        }));
        if let Ok(true) = done { Ok(()) } else { Err(refusal) }
    })
}

/// Prints the first refusal of the process that a user has to act on.
fn report(name: &CStr, refusal: &Refusal) {
    if !matches!(refusal, Refusal::CutBack { .. }) && !REPORTED.swap(true, Ordering::Relaxed) {
        // A closed stderr is no reason to fail.
        let _ = writeln!(std::io::stderr(), "pullout: {}: {refusal}", name.to_string_lossy());
    }
}

/// The arguments of an entry point, as far as the boundary treats all alike.
#[doc(hidden)]
pub trait EntryArguments {
    /// CMNAME or CINAME.
    fn name(&self) -> *const c_char;
    /// Returns where a refusal goes.
    ///
    /// # Safety
    /// The number of components is NULL or valid.
    unsafe fn answer(&self) -> Answer;
}

/// Channel through which a host learns of a refusal.
#[doc(hidden)]
#[derive(Debug)]
pub struct Answer {
    /// NTENS, NDIR or NFDIR, if given.
    components: Option<i32>,
    /// The largest that is one.
    most_components: i32,
    /// STRESS or TAU.
    stress: *mut f64,
    /// DDSDDE, DDSDDR or DDTDDG.
    tangent: *mut f64,
    pnewdt: *mut f64,
}

/// Reports to the host that nothing was computed.
///
/// After a numerical failure the stresses keep their values and a cut-back is requested. If PNEWDT is NULL, no cut-back
/// can be requested and the host would take the old stress for the new one, so the stress becomes NaN.
///
/// # Safety
/// Every pointer is NULL or valid for as many values as the number of components requires.
#[cold]
unsafe fn refuse(name: &CStr, refusal: &Refusal, host: &Answer) {
    report(name, refusal);
    let (fraction, is_numerical) = match *refusal {
        Refusal::CutBack { fraction, .. } => (fraction, true),
        _ => (CUT_BACK, false),
    };
    // SAFETY: the caller's promise.
    unsafe {
        if let Some(n) = host.components.filter(|n| (1..=host.most_components).contains(n)) {
            if !is_numerical || host.pnewdt.is_null() {
                fill_nan(host.stress, n as usize);
            }
            if !is_numerical {
                fill_nan(host.tangent, (n * n) as usize);
            }
        }
        store(host.pnewdt, fraction);
    }
}

/// Returns whether a law's name in an export macro is that of its table.
pub const fn is_named(info: &LawInfo, name: &str) -> bool {
    let (own, given) = (info.name.to_bytes(), name.as_bytes());
    let mut same = own.len() == given.len();
    let mut k = 0;
    while same && k < own.len() {
        same = own[k] == given[k];
        k += 1;
    }
    same
}

/// Silences the panic messages of a plugin: the panic is caught and reported once by the boundary.
/// Runs when the library is loaded (see [`crate::export_umat`]).
pub extern "C" fn install_silent_panic_hook() {
    std::panic::set_hook(Box::new(|_| {}));
}

/// Reads `*pointer` if it is not NULL.
///
/// # Safety
/// A non-NULL pointer is valid for reads.
#[inline(always)]
unsafe fn optional<T: Copy>(pointer: *const T) -> Option<T> {
    // SAFETY: checked for NULL by `as_ref`; validity is the caller's promise.
    unsafe { pointer.as_ref() }.copied()
}

/// A slice of `length` values, or the refusal that names the argument.
///
/// # Safety
/// A non-NULL pointer is valid for `length` reads.
#[inline(always)]
unsafe fn slice<'a>(pointer: *const f64, length: usize, argument: &'static str) -> Result<&'a [f64], Refusal> {
    if length == 0 {
        return Ok(&[]);
    }
    if pointer.is_null() {
        return Err(Refusal::Null { argument });
    }
    // SAFETY: not NULL; validity is the caller's promise.
    Ok(unsafe { std::slice::from_raw_parts(pointer, length) })
}

/// Writes `value` if the pointer is not NULL.
///
/// # Safety
/// A non-NULL pointer is valid for a write.
#[inline(always)]
unsafe fn store(pointer: *mut f64, value: f64) {
    if !pointer.is_null() {
        // SAFETY: not NULL; validity is the caller's promise.
        unsafe { pointer.write(value) }
    }
}

/// Fills `count` values with NaN if the pointer is not NULL.
///
/// # Safety
/// A non-NULL pointer is valid for `count` writes.
unsafe fn fill_nan(pointer: *mut f64, count: usize) {
    if !pointer.is_null() {
        // SAFETY: not NULL; validity is the caller's promise.
        unsafe { std::slice::from_raw_parts_mut(pointer, count) }.fill(f64::NAN);
    }
}

/// A count argument that must not be negative.
///
/// # Safety
/// A non-NULL pointer is valid for reads.
#[inline(always)]
unsafe fn count(pointer: *const i32, argument: &'static str) -> Result<usize, Refusal> {
    // SAFETY: forwarded to the caller.
    let value = unsafe { optional(pointer) }.ok_or(Refusal::Null { argument })?;
    usize::try_from(value).map_err(|_| Refusal::Null { argument })
}

/// Checks NSTATV and reads the law's states out of STATEV.
///
/// # Safety
/// STATEV is valid for NSTATV reads.
#[inline(always)]
unsafe fn states<S: States>(statev: *const f64, nstatv: *const i32) -> Result<S, Refusal> {
    let expected = S::TABLE.len();
    // SAFETY: forwarded to the caller.
    let given = unsafe { optional(nstatv) }.ok_or(Refusal::Null { argument: "NSTATV" })?;
    if usize::try_from(given).map_or(true, |given| given < expected) {
        return Err(Refusal::States { given, expected });
    }
    // SAFETY: NSTATV ≥ the number read.
    let values = unsafe { slice(statev, expected, "STATEV") }?;
    finite(values, "NaN or infinity in STATEV")?;
    Ok(S::read(values))
}

/// Refuses NaN and infinity.
#[inline(always)]
fn finite(values: &[f64], reason: &'static str) -> Result<(), Refusal> {
    if all_finite(values) { Ok(()) } else { Err(Refusal::CutBack { fraction: CUT_BACK, reason }) }
}
