//! Memory between pages that cannot be touched.

use super::Alignment;
use std::io;
use std::ptr;

/// Forbidden on either side: an index that is wrong by less is caught.
const FENCE: usize = 1 << 16;

/// A copy of an array between two fences.
#[derive(Debug)]
pub(super) struct Fenced {
    pub(super) argument: &'static str,
    mapping: *mut u8,
    mapped: usize,
    /// Of the array.
    start: usize,
    pub(super) length: usize,
    /// Of an element, bytes.
    size: usize,
}

impl Fenced {
    /// # Safety
    /// `values` points to `length` values.
    pub(super) unsafe fn copy_of<T>(
        argument: &'static str,
        values: *const T,
        length: usize,
        alignment: Alignment,
    ) -> io::Result<Self> {
        let bytes = length * size_of::<T>();
        let data = bytes.next_multiple_of(FENCE);
        let mapped = data + 2 * FENCE;
        let protection = libc::PROT_READ | libc::PROT_WRITE;
        // SAFETY: a new mapping touches nobody's memory.
        let mapping =
            unsafe { libc::mmap(ptr::null_mut(), mapped, protection, libc::MAP_PRIVATE | libc::MAP_ANONYMOUS, -1, 0) };
        if mapping == libc::MAP_FAILED {
            return Err(io::Error::last_os_error());
        }
        let mapping = mapping.cast::<u8>();
        let offset = match alignment {
            Alignment::Start => FENCE,
            Alignment::End => FENCE + data - bytes,
        };
        let this = Self { argument, mapping, mapped, start: mapping as usize + offset, length, size: size_of::<T>() };
        // SAFETY: the array lies within the mapping; the fences are multiples of a page and hold nothing.
        let fenced = unsafe {
            ptr::copy_nonoverlapping(values.cast::<u8>(), mapping.add(offset), bytes);
            libc::mprotect(mapping.cast(), FENCE, libc::PROT_NONE) == 0
                && libc::mprotect(mapping.add(FENCE + data).cast(), FENCE, libc::PROT_NONE) == 0
        };
        if fenced { Ok(this) } else { Err(io::Error::last_os_error()) }
    }

    pub(super) fn address(&self) -> *mut u8 {
        ptr::with_exposed_provenance_mut(self.start)
    }

    /// The element (from 1) at an address within this mapping.
    pub(super) fn element_at(&self, address: usize) -> Option<i64> {
        let base = self.mapping as usize;
        if !(base..base + self.mapped).contains(&address) {
            return None;
        }
        let signed = |n: usize| i64::try_from(n).unwrap_or(i64::MAX);
        Some((signed(address) - signed(self.start)).div_euclid(signed(self.size)) + 1)
    }
}

impl Drop for Fenced {
    fn drop(&mut self) {
        // SAFETY: its own mapping, to which nothing points any more.
        unsafe { libc::munmap(self.mapping.cast(), self.mapped) };
    }
}
