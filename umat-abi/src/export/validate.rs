//! The validate function of the metadata: the same checks as a call, with the message for the caller.

use super::guarded;
use crate::law::{ConfigurationError, InterfaceLaw, Law, parameters_of, read_parameters};
use crate::metadata::validation;
use std::ffi::c_char;
use std::io::Write;

/// The validate function of a [`Law`].
///
/// # Safety
/// `props` is valid for `nprops` reads, `message` for `capacity` writes (or NULL).
pub unsafe extern "C" fn validate_solid<L: Law>(
    props: *const f64,
    nprops: i32,
    characteristic_length: f64,
    message: *mut c_char,
    capacity: usize,
) -> i32 {
    let check = |props: &[f64]| {
        let length = Some(characteristic_length).filter(|length| length.is_finite() && *length > 0.0);
        match L::check_characteristic_length(&parameters_of::<L>(props)?, length) {
            Ok(()) => Ok(validation::OK),
            Err(ConfigurationError::CharacteristicLengthMissing { .. }) => Ok(validation::NEEDS_LENGTH),
            Err(error) => Err(error),
        }
    };
    // SAFETY: forwarded to the caller.
    unsafe { answer(props, nprops, message, capacity, check) }
}

/// The validate function of an [`InterfaceLaw`].
///
/// # Safety
/// As for [`validate_solid`].
pub unsafe extern "C" fn validate_interface<L: InterfaceLaw>(
    props: *const f64,
    nprops: i32,
    _characteristic_length: f64,
    message: *mut c_char,
    capacity: usize,
) -> i32 {
    let check = |props: &[f64]| {
        read_parameters::<L::Parameters<'_>>(&L::INFO, props)?;
        Ok(validation::OK)
    };
    // SAFETY: forwarded to the caller.
    unsafe { answer(props, nprops, message, capacity, check) }
}

unsafe fn answer(
    props: *const f64,
    nprops: i32,
    message: *mut c_char,
    capacity: usize,
    check: impl FnOnce(&[f64]) -> Result<i32, ConfigurationError>,
) -> i32 {
    let mut status = validation::INVALID;
    let mut text = [0_u8; 512];
    let mut room = &mut text[..];
    let outcome = guarded(|| {
        let Ok(count) = usize::try_from(nprops) else {
            let _ = write!(room, "NPROPS is negative");
            return Ok(());
        };
        // SAFETY: the caller's promise.
        match unsafe { super::slice(props, count, "PROPS") }.map(check) {
            Ok(Ok(validation::NEEDS_LENGTH)) => {
                status = validation::NEEDS_LENGTH;
                let _ = write!(room, "these parameters need a characteristic length (CELENT) > 0");
            }
            Ok(Ok(_)) => status = validation::OK,
            Ok(Err(error)) => {
                let _ = write!(room, "{error}");
            }
            Err(refusal) => {
                let _ = write!(room, "{refusal}");
            }
        }
        Ok(())
    });
    if let Err(refusal) = outcome {
        status = validation::INVALID;
        let _ = write!(room, "{refusal}");
    }
    let free = room.len();
    if !message.is_null() && capacity > 0 {
        let written = &text[..text.len() - free];
        // a character that did not fit is left out
        let whole = std::str::from_utf8(written).map_or_else(|error| error.valid_up_to(), str::len);
        let length = whole.min(text.len() - 1).min(capacity - 1);
        // SAFETY: `message` is valid for `capacity` > length writes.
        unsafe {
            std::ptr::copy_nonoverlapping(text.as_ptr().cast(), message, length);
            message.add(length).write(0);
        }
    }
    status
}
