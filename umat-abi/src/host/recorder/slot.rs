//! The worker's side: a call object's slot, and what is written into it.

use super::map::{LONGEST_PATH, WORD, word};
use super::{Recorder, installed, returned};
use crate::host::Library;
use std::path::Path;
use std::sync::atomic::Ordering;

/// Words in which a slot begins: its size and its sequence.
pub(super) const SEQUENCE: usize = WORD;
/// Offset of its texts.
pub(super) const TEXTS: usize = 2 * WORD;
/// Words of room for arguments in a first slot; a call that needs more takes another slot.
const FIRST_ROOM: usize = 256;

/// A call object's place in the recorder.
#[derive(Debug)]
pub(in crate::host) struct Slot {
    recorder: &'static Recorder,
    /// Name, path, symbol and CMNAME, each after its length.
    texts: Vec<u8>,
    offsets: Option<Offsets>,
    sequence: u64,
    /// Whether calls are those of a routine other than the entry points.
    is_routine: bool,
}

/// Offsets of a slot, of its arguments, and of its end.
#[derive(Clone, Copy, Debug)]
struct Offsets {
    slot: usize,
    arguments: usize,
    end: usize,
}

impl Slot {
    /// Makes a slot for calls of a library, if this process records its calls.
    pub(in crate::host) fn new(library: &Library, symbol: Option<&str>, cmname: &str) -> Option<Self> {
        let recorder = installed()?;
        let path = std::path::absolute(library.path()).unwrap_or_else(|_| library.path().to_owned());
        Some(Self::of(recorder, &library.name_of_law(cmname), &path, symbol, cmname))
    }

    /// Makes a slot for calls of a routine other than the entry points.
    pub(in crate::host) fn of_routine(library: &Library) -> Option<Self> {
        Self::new(library, None, "").map(|slot| Self { is_routine: true, ..slot })
    }

    pub(super) fn of(recorder: &'static Recorder, name: &str, path: &Path, symbol: Option<&str>, cmname: &str) -> Self {
        let mut texts = Vec::new();
        let path = path.as_os_str().as_encoded_bytes();
        for text in [name.as_bytes(), path, symbol.unwrap_or_default().as_bytes(), cmname.as_bytes()] {
            texts.extend((text.len() as u64).to_ne_bytes());
            texts.extend(text);
        }
        Self { recorder, texts, offsets: None, sequence: 0, is_routine: false }
    }

    /// The plugin gets the control, with the arguments that `write` writes.
    pub(in crate::host) fn enter(&mut self, write: impl Fn(&mut Writer)) {
        loop {
            let Some(offsets) = self.offsets.or_else(|| self.take(FIRST_ROOM)) else { return };
            let (next, room) = self.recorder.map.doubles(offsets.arguments, offsets.end);
            let mut writer = Writer { next, room, wanted: 0 };
            write(&mut writer);
            if writer.wanted <= room {
                break;
            }
            // An object whose arguments grew (PREDEF may) abandons its slot, outside a call.
            if self.take(2 * writer.wanted).is_none() {
                return;
            }
        }
        self.sequence |= 1;
        self.beat();
        if let Some(offsets) = self.offsets.filter(|_| !self.is_routine) {
            self.recorder.map.word(word::LAST).store(offsets.slot as u64, Ordering::Relaxed);
        }
    }

    /// The plugin gave the control back.
    #[inline]
    pub(in crate::host) fn leave(&mut self) {
        returned();
        self.sequence += self.sequence & 1;
        self.beat();
    }

    #[inline]
    fn beat(&self) {
        if let Some(offsets) = self.offsets {
            // Release: the arguments are written before. The plugin, of which a compiler knows nothing, is called after.
            self.recorder.map.word(offsets.slot + SEQUENCE).store(self.sequence, Ordering::Release);
        }
    }

    /// Takes a new slot with room for so many words. `None`: the file is full; calls are then not recorded.
    fn take(&mut self, room: usize) -> Option<Offsets> {
        let map = &self.recorder.map;
        let before = TEXTS + self.texts.len().next_multiple_of(WORD);
        let size = before + room * WORD;
        let end = map.word(word::END);
        let slot = end.fetch_update(Ordering::AcqRel, Ordering::Acquire, |end| {
            Some(end + size as u64).filter(|end| *end <= map.capacity() as u64)
        });
        let slot = usize::try_from(slot.ok()?).ok()?;
        map.write(slot + TEXTS, &self.texts);
        // The old slot keeps the calls that it counted.
        self.sequence = 0;
        map.word(slot).store(size as u64, Ordering::Release);
        self.offsets = Some(Offsets { slot, arguments: slot + before, end: slot + size });
        self.offsets
    }
}

/// Writes arguments, each after its length.
#[derive(Debug)]
pub(in crate::host) struct Writer {
    next: *mut f64,
    /// Words that are left.
    room: usize,
    /// Words that all arguments need.
    wanted: usize,
}

/// Returns what `write` writes.
pub(super) fn written(write: impl Fn(&mut Writer)) -> Vec<u8> {
    let mut counter = Writer { next: std::ptr::null_mut(), room: 0, wanted: 0 };
    write(&mut counter);
    let mut words = vec![0.0_f64; counter.wanted];
    write(&mut Writer { next: words.as_mut_ptr(), room: words.len(), wanted: 0 });
    words.iter().flat_map(|word| word.to_ne_bytes()).collect()
}

impl Writer {
    /// One argument.
    #[inline]
    pub(in crate::host) fn put(&mut self, values: &[f64]) {
        let words = 1 + values.len();
        self.wanted += words;
        if words <= self.room {
            // SAFETY: as many words are left in this slot, which nobody refers to.
            unsafe {
                self.next.write(values.len() as f64);
                std::ptr::copy_nonoverlapping(values.as_ptr(), self.next.add(1), values.len());
                self.next = self.next.add(words);
            }
            self.room -= words;
        } else {
            self.room = 0;
        }
    }

    /// One argument of integers.
    #[inline]
    pub(in crate::host) fn put_integers<const N: usize>(&mut self, values: [i32; N]) {
        self.put(&values.map(f64::from));
    }
}

/// Runs `body`, which loads a library: its initialisers may end the process as well as a call.
pub(in crate::host) fn loading<R>(path: &Path, body: impl FnOnce() -> R) -> R {
    let Some(recorder) = installed() else { return body() };
    let map = &recorder.map;
    let bytes = path.as_os_str().as_encoded_bytes();
    let bytes = &bytes[..bytes.len().min(LONGEST_PATH)];
    map.write(word::PATH, &(bytes.len() as u64).to_ne_bytes());
    map.write(word::PATH + WORD, bytes);
    map.word(word::LOADING).fetch_add(1, Ordering::SeqCst);
    let result = body();
    returned();
    map.word(word::LOADING).fetch_add(1, Ordering::SeqCst);
    result
}
