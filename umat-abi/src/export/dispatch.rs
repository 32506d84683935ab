//! Several laws in one `umat_`: ABAQUS loads one library per job and selects the material by CMNAME.

use super::{EntryArguments, Refusal, refuse};
use std::ffi::{CStr, c_char};

/// A law name and what runs it.
#[derive(Clone, Copy, Debug)]
pub struct NamedEntry<A> {
    /// The law's name, lower case.
    pub name: &'static CStr,
    /// Entry point of the law.
    pub function: unsafe fn(&A),
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
unsafe fn law_named<A>(entries: &[NamedEntry<A>], name: *const c_char) -> Option<unsafe fn(&A)> {
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
    let named = entries.iter().filter(|entry| matches(entry.name));
    named.max_by_key(|entry| entry.name.count_bytes()).map(|entry| entry.function)
}

/// Name of a library of several laws in messages.
const LIBRARY: &CStr = c"pullout_laws";

/// Runs the law that CMNAME or CINAME names.
///
/// # Safety
/// As for [`super::umat`], [`super::uinter`] or [`super::fric`]; the name as Fortran passes it.
pub unsafe fn by_name<A: EntryArguments>(entries: &[NamedEntry<A>], arguments: &A) {
    // SAFETY: forwarded to the caller.
    unsafe {
        match law_named(entries, arguments.name()) {
            Some(function) => function(arguments),
            None => refuse(LIBRARY, &Refusal::UnknownLaw, &arguments.answer()),
        }
    }
}
