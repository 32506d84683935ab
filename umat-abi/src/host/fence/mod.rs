//! Memory between protected pages, and the handler that finds out which of them was touched.

mod fault;
mod watch;

pub(super) use fault::listen;
pub(super) use watch::{Watched, watch};

use super::memory::Trespass;
use super::probe::Alignment;
use std::borrow::Cow;
use std::io;
use std::ptr;

/// Protected on either side: an index that is wrong by less is caught.
const FENCE: usize = 1 << 16;
/// The least that is protected at once.
const PAGE: usize = 1 << 12;

/// Consequence of an access outside an array.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Outside {
    /// Access ends the process.
    Forbidden,
    /// Writing ends the process. Memory past the end of the array holds this pattern at first.
    Readable(u64),
}

/// Address range of an array.
#[derive(Clone, Copy, Debug)]
pub(super) struct Extent {
    argument: &'static str,
    mapping: usize,
    mapped: usize,
    /// Start of the array.
    start: usize,
    length: usize,
    /// Size of an element, bytes.
    size: usize,
}

impl Extent {
    /// Returns what an access to an address is, if that lies within this mapping.
    pub(super) fn trespass(&self, address: usize, writes: Option<bool>) -> Option<Trespass> {
        let element = self.element_at(address)?;
        let argument = Cow::Borrowed(self.argument);
        Some(Trespass { argument, element, length: self.length, writes })
    }

    /// The element (from 1) at an address within this mapping.
    fn element_at(&self, address: usize) -> Option<i64> {
        if !(self.mapping..self.mapping + self.mapped).contains(&address) {
            return None;
        }
        let signed = |n: usize| i64::try_from(n).unwrap_or(i64::MAX);
        Some((signed(address) - signed(self.start)).div_euclid(signed(self.size)) + 1)
    }
}

/// An array between two fences.
#[derive(Debug)]
pub(super) struct Fenced {
    extent: Extent,
    address: usize,
}

impl Fenced {
    /// Zeros.
    pub(super) fn new(
        argument: &'static str,
        [length, size]: [usize; 2],
        alignment: Alignment,
        outside: Outside,
    ) -> io::Result<Self> {
        let bytes = length * size;
        let data = bytes.next_multiple_of(FENCE);
        let mapped = data + 2 * FENCE;
        let protection = libc::PROT_READ | libc::PROT_WRITE;
        // SAFETY: a new mapping touches nobody's memory.
        let mapping =
            unsafe { libc::mmap(ptr::null_mut(), mapped, protection, libc::MAP_PRIVATE | libc::MAP_ANONYMOUS, -1, 0) };
        if mapping == libc::MAP_FAILED {
            return Err(io::Error::last_os_error());
        }
        let offset = match alignment {
            Alignment::Start => FENCE,
            Alignment::End => FENCE + data - bytes,
        };
        let extent =
            Extent { argument, mapping: mapping as usize, mapped, start: mapping as usize + offset, length, size };
        let this = Self { extent, address: extent.start };
        let (mapping, protection) = (mapping.cast::<u8>(), outside.protection());
        // SAFETY: the fences are multiples of a page within the mapping, and hold nothing.
        let fenced = unsafe {
            let after = mapping.add(FENCE + data);
            if let Outside::Readable(pattern) = outside {
                std::slice::from_raw_parts_mut(after.cast::<u64>(), PAGE / size_of::<u64>()).fill(pattern);
            }
            libc::mprotect(mapping.cast(), FENCE, protection) == 0
                && libc::mprotect(after.cast(), FENCE, protection) == 0
        };
        if fenced { Ok(this) } else { Err(io::Error::last_os_error()) }
    }

    /// Fills the memory after the array with a pattern. `is_open`: it may be written from then on.
    pub(super) fn fill_after(&self, pattern: u64, is_open: bool) {
        let Extent { mapping, mapped, .. } = self.extent;
        let after: *mut u64 = ptr::with_exposed_provenance_mut(mapping + mapped - FENCE);
        // SAFETY: the fence after the array, which nobody else writes.
        unsafe {
            if libc::mprotect(after.cast(), FENCE, libc::PROT_READ | libc::PROT_WRITE) == 0 {
                std::slice::from_raw_parts_mut(after, PAGE / size_of::<u64>()).fill(pattern);
                if !is_open {
                    libc::mprotect(after.cast(), FENCE, libc::PROT_READ);
                }
            }
        }
    }

    /// A copy of an array.
    ///
    /// # Safety
    /// `values` points to `length` values.
    pub(super) unsafe fn copy_of<T>(
        argument: &'static str,
        values: *const T,
        length: usize,
        alignment: Alignment,
    ) -> io::Result<Self> {
        let this = Self::new(argument, [length, size_of::<T>()], alignment, Outside::Forbidden)?;
        // SAFETY: there is room for as many bytes.
        unsafe { ptr::copy_nonoverlapping(values.cast::<u8>(), this.address(), length * size_of::<T>()) };
        Ok(this)
    }

    pub(super) fn address(&self) -> *mut u8 {
        ptr::with_exposed_provenance_mut(self.address)
    }

    pub(super) fn extent(&self) -> &Extent {
        &self.extent
    }

    /// Leaves out the first element: what lies in front of an array is number 0.
    pub(super) fn count_from_second(&mut self) {
        self.extent.start += self.extent.size;
        self.extent.length -= 1;
    }

    /// Counts the characters at the end.
    pub(super) fn count_characters(&mut self, characters: usize) {
        let end = self.extent.start + self.extent.length * self.extent.size;
        self.extent = Extent { start: end - characters, length: characters, size: 1, ..self.extent };
    }
}

impl Outside {
    fn protection(self) -> i32 {
        match self {
            Self::Forbidden => libc::PROT_NONE,
            Self::Readable(_) => libc::PROT_READ,
        }
    }
}

impl Drop for Fenced {
    fn drop(&mut self) {
        let mapping = ptr::with_exposed_provenance_mut(self.extent.mapping);
        // SAFETY: its own mapping, to which nothing points any more.
        unsafe { libc::munmap(mapping, self.extent.mapped) };
    }
}
