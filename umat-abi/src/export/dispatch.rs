//! Several laws behind one `umat_`: ABAQUS loads one per job, and tells materials apart by CMNAME.

use super::Refusal;
use crate::fric::FricArguments;
use crate::uinter::UinterArguments;
use crate::umat::UmatArguments;
use std::ffi::{CStr, c_char};

/// A law name and its entry point.
#[derive(Clone, Copy, Debug)]
pub struct NamedEntry<F> {
    /// The law's name, lower case.
    pub name: &'static CStr,
    /// What to call.
    pub function: F,
}

/// Fortran names have at most this many characters.
const NAME_LENGTH: usize = 80;

/// The entry whose name is the longest prefix of `name` (leading blanks skipped, case ignored).
///
/// The trailing CHARACTER length is not trusted (some hosts pass none): characters are read only as
/// long as they match.
///
/// # Safety
/// `name` is NULL or points to a string that is blank-padded, NUL-terminated, or longer than any of
/// the law names that it begins with.
unsafe fn law_named<F: Copy>(entries: &[NamedEntry<F>], name: *const c_char) -> Option<F> {
    if name.is_null() {
        return None;
    }
    // SAFETY: the caller's promise; a blank is followed by another character of the padded name.
    let character = |i: usize| unsafe { name.add(i).read() } as u8;
    let start = (0..NAME_LENGTH).find(|&i| character(i) != b' ')?;
    let matches = |law: &CStr| {
        law.to_bytes()
            .iter()
            .enumerate()
            .all(|(i, letter)| start + i < NAME_LENGTH && character(start + i).to_ascii_lowercase() == *letter)
    };
    entries
        .iter()
        .filter(|entry| matches(entry.name))
        .max_by_key(|entry| entry.name.count_bytes())
        .map(|entry| entry.function)
}

/// What messages call a library of several laws.
const LIBRARY: &CStr = c"pullout_laws";

/// Runs the law that CMNAME names.
///
/// # Safety
/// As for [`super::umat`]; CMNAME as Fortran passes it.
pub unsafe fn umat_by_name(entries: &[NamedEntry<unsafe fn(&UmatArguments)>], arguments: &UmatArguments) {
    // SAFETY: forwarded to the caller.
    unsafe {
        match law_named(entries, arguments.cmname) {
            Some(function) => function(arguments),
            None => {
                let &UmatArguments { ntens, stress, ddsdde, pnewdt, .. } = arguments;
                super::solid::refuse_umat(ntens, stress, ddsdde, pnewdt, LIBRARY, &Refusal::UnknownLaw);
            }
        }
    }
}

/// Runs the law that CINAME names.
///
/// # Safety
/// As for [`super::uinter`]; CINAME as Fortran passes it.
pub unsafe fn uinter_by_name(entries: &[NamedEntry<unsafe fn(&UinterArguments)>], arguments: &UinterArguments) {
    // SAFETY: forwarded to the caller.
    unsafe {
        match law_named(entries, arguments.ciname) {
            Some(function) => function(arguments),
            None => super::interface::refuse_uinter(arguments, LIBRARY, &Refusal::UnknownLaw),
        }
    }
}

/// Runs the law that CINAME names.
///
/// # Safety
/// As for [`super::fric`]; CINAME as Fortran passes it.
pub unsafe fn fric_by_name(entries: &[NamedEntry<unsafe fn(&FricArguments)>], arguments: &FricArguments) {
    // SAFETY: forwarded to the caller.
    unsafe {
        match law_named(entries, arguments.ciname) {
            Some(function) => function(arguments),
            None => super::interface::refuse_fric(arguments, LIBRARY, &Refusal::UnknownLaw),
        }
    }
}
