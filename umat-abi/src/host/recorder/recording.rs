//! The supervisor's side: preparing the file, watching, and reading what was noted.
//!
//! A plugin that writes wild may have written into the file as well: nothing that is read is trusted.

use super::super::memory::Trespass;
use super::NOTES;
use super::arguments::RecordedArguments;
use super::map::{CAPACITY, HEADER, LEAST_CAPACITY, LONGEST_PATH, MAGIC, Map, WORD, word};
use super::slot::{SEQUENCE, TEXTS};
use std::borrow::Cow;
use std::fs::File;
use std::io;
use std::path::PathBuf;
use std::sync::atomic::Ordering;

/// The supervisor's side of a recorder.
#[derive(Debug)]
pub struct Recording {
    map: Map,
}

/// A call, or the loading of a library, that has not come back.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Beat {
    /// The slot; `None` for loading.
    slot: Option<usize>,
    /// Another call has another number.
    sequence: u64,
}

/// A call as it was noted.
#[derive(Clone, Debug, PartialEq)]
pub struct CallRecord {
    /// The law's name, or that of the library.
    pub name: String,
    /// The library's file.
    pub library: PathBuf,
    /// The symbol of the entry point, if it has not one of the usual names.
    pub symbol: Option<String>,
    /// CMNAME or CINAME.
    pub cmname: String,
    /// Whether DDSDDE was wanted.
    pub wants_tangent: bool,
    /// The arguments.
    pub arguments: RecordedArguments,
}

impl Recording {
    /// Prepares an empty file for a worker's [`super::install`]: as large as the system lets it be.
    ///
    /// # Errors
    /// The file cannot grow or be mapped.
    pub fn create(file: &File) -> io::Result<Self> {
        let mut room = CAPACITY;
        while let Err(error) = file.set_len(room as u64) {
            if error.kind() != io::ErrorKind::FileTooLarge || room == LEAST_CAPACITY {
                return Err(error);
            }
            room /= 2;
        }
        let map = Map::open(file)?;
        map.word(word::END).store(HEADER as u64, Ordering::Release);
        map.word(word::MAGIC).store(MAGIC, Ordering::Release);
        Ok(Self { map })
    }

    /// The exit code, if all was done.
    pub fn done(&self) -> Option<u8> {
        let done = self.map.word(word::DONE).load(Ordering::Acquire);
        done.checked_sub(1).and_then(|code| u8::try_from(code).ok())
    }

    /// Returns a number that the worker noted; 0 before it did, and for an index of [`NOTES`] or more.
    pub fn note(&self, index: usize) -> u64 {
        if index < NOTES { self.map.word(word::NOTES + WORD * index).load(Ordering::Acquire) } else { 0 }
    }

    /// Returns what the call that ended the process touched outside its arrays.
    pub fn trespass(&self) -> Option<Trespass> {
        let number = |k: usize| self.map.word(word::TRESPASS + WORD * k).load(Ordering::Acquire);
        let length = usize::try_from(number(0).checked_sub(1)?).ok()?.min(word::LONGEST_ARGUMENT);
        Some(Trespass {
            argument: Cow::Owned(text(&self.map.read(word::ARGUMENT, length)?)),
            element: number(1).cast_signed(),
            length: usize::try_from(number(2)).ok()?,
            writes: number(3).checked_sub(1).map(|writes| writes == 1),
        })
    }

    /// Calls of entry points that were begun.
    pub fn calls(&self) -> u64 {
        let is_routine = |slot| self.record(slot).is_some_and(|call| call.arguments.is_routine());
        self.slots().filter(|(slot, _)| !is_routine(*slot)).map(|(_, sequence)| sequence.div_ceil(2)).sum()
    }

    /// Returns what has not come back as yet.
    pub fn pending(&self) -> impl Iterator<Item = Beat> {
        let loading = Beat { slot: None, sequence: self.map.word(word::LOADING).load(Ordering::Acquire) };
        let calls = self.slots().map(|(slot, sequence)| Beat { slot: Some(slot), sequence });
        std::iter::once(loading).chain(calls).filter(|beat| beat.sequence % 2 == 1)
    }

    /// The library that is being loaded.
    pub fn loading(&self) -> Option<PathBuf> {
        let sequence = self.map.word(word::LOADING).load(Ordering::Acquire);
        let length = usize::try_from(self.map.word(word::PATH).load(Ordering::Acquire)).ok()?;
        let wanted = sequence % 2 == 1 && length <= LONGEST_PATH;
        let path = wanted.then(|| self.map.read(word::PATH + WORD, length)).flatten()?;
        Some(text(&path).into())
    }

    /// The call that has not come back; of several the one that was begun last.
    pub fn unfinished_call(&self) -> Option<CallRecord> {
        let last = self.last_slot();
        let pending: Vec<usize> = self.pending().filter_map(|beat| beat.slot).collect();
        let slot = pending.iter().copied().find(|slot| Some(*slot) == last).or(pending.first().copied());
        slot.and_then(|slot| self.record(slot))
    }

    /// The call that a beat belongs to.
    pub fn call(&self, beat: Beat) -> Option<CallRecord> {
        beat.slot.and_then(|slot| self.record(slot))
    }

    /// The last call of an entry point, whether it came back or not.
    pub fn last_call(&self) -> Option<CallRecord> {
        self.last_slot().and_then(|slot| self.record(slot))
    }

    fn last_slot(&self) -> Option<usize> {
        let last = usize::try_from(self.map.word(word::LAST).load(Ordering::Acquire)).ok()?;
        self.slots().map(|(slot, _)| slot).find(|slot| *slot == last)
    }

    /// Offsets and sequences of all slots.
    fn slots(&self) -> impl Iterator<Item = (usize, u64)> {
        let end = usize::try_from(self.map.word(word::END).load(Ordering::Acquire)).unwrap_or(usize::MAX);
        let end = end.min(self.map.capacity());
        let mut next = HEADER;
        std::iter::from_fn(move || {
            let slot = next;
            let size = (slot + TEXTS <= end).then(|| self.map.word(slot).load(Ordering::Acquire))?;
            let size = usize::try_from(size).ok().filter(|size| *size >= TEXTS && size.is_multiple_of(WORD))?;
            next = slot.checked_add(size).filter(|next| *next <= end)?;
            Some((slot, self.map.word(slot + SEQUENCE).load(Ordering::Acquire)))
        })
    }

    fn record(&self, slot: usize) -> Option<CallRecord> {
        let size = usize::try_from(self.map.word(slot).load(Ordering::Acquire)).ok()?;
        let bytes = self.map.read(slot, size)?;
        let mut reader = Reader { bytes: bytes.get(TEXTS..)? };
        let [name, path, symbol, cmname] = [reader.text()?, reader.text()?, reader.text()?, reader.text()?];
        let consumed = bytes.len() - reader.bytes.len();
        reader.bytes = bytes.get(consumed.next_multiple_of(WORD)..)?;
        let head = reader.take()?;
        let [entry, wants_tangent] = head.try_into().ok()?;
        Some(CallRecord {
            name: text(name),
            library: text(path).into(),
            symbol: (!symbol.is_empty()).then(|| text(symbol)),
            cmname: text(cmname),
            wants_tangent: wants_tangent != 0.0,
            arguments: RecordedArguments::read(entry, &mut reader)?,
        })
    }
}

/// Case files, where these texts go, are UTF-8.
fn text(bytes: &[u8]) -> String {
    String::from_utf8_lossy(bytes).into_owned()
}

/// Reads what [`super::slot::Writer`] wrote.
#[derive(Debug)]
pub(super) struct Reader<'a> {
    bytes: &'a [u8],
}

impl<'a> Reader<'a> {
    pub(super) fn new(bytes: &'a [u8]) -> Self {
        Self { bytes }
    }

    fn word(&mut self) -> Option<[u8; WORD]> {
        let (word, rest) = self.bytes.split_first_chunk()?;
        self.bytes = rest;
        Some(*word)
    }

    fn text(&mut self) -> Option<&'a [u8]> {
        let length = usize::try_from(u64::from_ne_bytes(self.word()?)).ok()?;
        let (text, rest) = self.bytes.split_at_checked(length)?;
        self.bytes = rest;
        Some(text)
    }

    /// The next argument, of so many integers.
    pub(super) fn integers<const N: usize>(&mut self) -> Option<[i32; N]> {
        let values: [f64; N] = self.take()?.try_into().ok()?;
        Some(values.map(|value| value as i32))
    }

    /// The next argument.
    pub(super) fn take(&mut self) -> Option<Vec<f64>> {
        let length = f64::from_ne_bytes(self.word()?);
        let there = self.bytes.len() / WORD;
        // lengths beyond what is there, negative ones and NaN are a plugin's
        let length = (length >= 0.0 && length <= there as f64).then_some(length as usize)?;
        (0..length).map(|_| self.word().map(f64::from_ne_bytes)).collect()
    }
}
