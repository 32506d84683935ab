//! The mapped file: words that both processes read and write, and bytes.

use memmap2::{MmapOptions, MmapRaw};
use std::fs::File;
use std::io;
use std::sync::atomic::AtomicU64;

/// Size of a recorder's file. The file is sparse: only pages that were written take memory.
pub(super) const CAPACITY: usize = 1 << 28;
/// The least room, where the system limits the size of files: some slots.
pub(super) const LEAST_CAPACITY: usize = 1 << 17;
/// The first word of a prepared file: "pullout", version 1.
pub(super) const MAGIC: u64 = 0x0170_756c_6c6f_7574;
/// Bytes of a word.
pub(super) const WORD: usize = 8;
/// Offset of the slots.
pub(super) const HEADER: usize = 8192;
/// Longest path that is noted, in bytes.
pub(super) const LONGEST_PATH: usize = HEADER - word::PATH - WORD;

/// Offsets in the header.
pub(super) mod word {
    pub(in super::super) const MAGIC: usize = 0;
    /// 0, or 1 + exit code.
    pub(in super::super) const DONE: usize = 8;
    /// Offset of the end of the last slot.
    pub(in super::super) const END: usize = 16;
    /// Offset of the slot that was entered last; 0: none.
    pub(in super::super) const LAST: usize = 24;
    /// A sequence, odd while a library is loaded.
    pub(in super::super) const LOADING: usize = 32;
    pub(in super::super) const NOTES: usize = 64;
    /// Access of a call outside its arrays: 1 + length of the argument's name, element, length of the array, access.
    pub(in super::super) const TRESPASS: usize = NOTES + 8 * super::super::NOTES;
    /// The argument's name.
    pub(in super::super) const ARGUMENT: usize = TRESPASS + 4 * super::WORD;
    pub(in super::super) const LONGEST_ARGUMENT: usize = 2 * super::WORD;
    /// The library's path: its length, its bytes.
    pub(in super::super) const PATH: usize = ARGUMENT + LONGEST_ARGUMENT;
}

/// A file of up to [`CAPACITY`] bytes, shared with another process.
#[derive(Debug)]
pub(super) struct Map {
    raw: MmapRaw,
}

impl Map {
    /// Maps a file.
    pub(super) fn open(file: &File) -> io::Result<Self> {
        let length = usize::try_from(file.metadata()?.len()).unwrap_or(usize::MAX);
        if !(LEAST_CAPACITY..=CAPACITY).contains(&length) {
            return Err(io::Error::other("the file of a recorder has another size"));
        }
        Ok(Self { raw: MmapOptions::new().len(length).map_raw(file)? })
    }

    /// Bytes of the file.
    pub(super) fn capacity(&self) -> usize {
        self.raw.len()
    }

    /// The word at an offset.
    ///
    /// # Panics
    /// If there is none.
    pub(super) fn word(&self, offset: usize) -> &AtomicU64 {
        assert!(offset.is_multiple_of(WORD) && offset < self.capacity(), "no word at {offset}");
        // SAFETY: within the mapping, which begins on a page; all access to this word is atomic.
        unsafe { AtomicU64::from_ptr(self.raw.as_mut_ptr().add(offset).cast()) }
    }

    /// Copies bytes to an offset, and returns whether there was room.
    pub(super) fn write(&self, offset: usize, bytes: &[u8]) -> bool {
        let fits = offset.checked_add(bytes.len()).is_some_and(|end| end <= self.capacity());
        if fits {
            // SAFETY: within the mapping. Rust never refers to these bytes, and only the owner of a slot (or of the
            // path, which one thread writes at a time) writes there.
            unsafe { std::ptr::copy(bytes.as_ptr(), self.raw.as_mut_ptr().add(offset), bytes.len()) };
        }
        fits
    }

    /// Bytes at an offset; `None` if they are not in the file. While the worker writes there they are any bytes.
    pub(super) fn read(&self, offset: usize, length: usize) -> Option<Vec<u8>> {
        offset.checked_add(length).filter(|end| *end <= self.capacity())?;
        let mut bytes = vec![0; length];
        // SAFETY: within the mapping; any bytes are valid.
        unsafe { std::ptr::copy(self.raw.as_ptr().add(offset), bytes.as_mut_ptr(), length) };
        Some(bytes)
    }

    /// Returns where doubles may be written: the address of a word, and how many words follow before `end`.
    pub(super) fn doubles(&self, offset: usize, end: usize) -> (*mut f64, usize) {
        assert!(offset.is_multiple_of(WORD) && offset <= end && end <= self.capacity(), "no room at {offset}");
        // SAFETY: within the mapping or one past its end.
        (unsafe { self.raw.as_mut_ptr().add(offset).cast() }, (end - offset) / WORD)
    }
}
