//! Arguments of the last call of a plugin, in memory that outlives the process.
//!
//! A plugin may end the process that calls it: Fortran's STOP, a segmentation fault, an endless loop. So the process
//! that calls plugins, the *worker*, maps a file that its parent, the *supervisor*, maps as well ([`install`],
//! [`Recording`]), and every call of [`super::UmatCall`], [`super::UinterCall`] and [`super::FricCall`] made
//! afterwards notes its arguments there before it is made, and so do UEXTERNALDB and SDVINI. The kernel owns the pages: whatever ends the worker, the
//! supervisor reads what was noted last.
//!
//! # The file
//!
//! A header of 64-bit words, then slots one after the other. Each call object takes a slot at its first call, so that
//! threads never share one:
//!
//! ```text
//! header   done | end of slots | last slot | loading | notes … | trespass | path being loaded
//! slot     size | sequence | name, path, symbol, CMNAME | entry point, tangent wanted, arguments …
//! ```
//!
//! `sequence` is odd while the plugin has control and grows by one at each start and end of a call. From it the
//! supervisor sees which call did not return. It is also the heartbeat, as a lasting call has an odd sequence that does
//! not change, and counts the calls. `done` is written once, at the true end: if a worker is gone without it, something
//! else ended it.
//!
//! Arguments are stored as doubles, which hold 32-bit integers exactly; each follows its length. The cost of a call is
//! that of copying them (`cargo bench -p end-to-end-tests --bench recorder_cost`). Without [`install`] a call costs one
//! comparison more.

mod arguments;
#[cfg(target_os = "linux")]
mod copy;
mod map;
mod recording;
mod slot;
#[cfg(test)]
mod test;

pub use arguments::{FricRecord, RecordedArguments, UinterRecord, UmatRecord};
pub use recording::{Beat, CallRecord, Recording};
pub(super) use slot::{Slot, loading};

use super::memory::Trespass;
use map::{Map, WORD, word};
use std::fs::File;
use std::io;
use std::sync::OnceLock;
use std::sync::atomic::{AtomicBool, Ordering};

/// Words of the header that the program may use as it likes.
pub const NOTES: usize = 8;

/// The recorder of this process, if it is a worker.
static RECORDER: OnceLock<Recorder> = OnceLock::new();

/// The worker's side of the file.
#[derive(Debug)]
pub struct Recorder {
    map: Map,
    fences_arrays: AtomicBool,
}

/// Records all calls of this process from now on, in a file that a [`Recording`] has prepared. Call objects that were
/// made before are not recorded.
///
/// # Errors
/// The file cannot be mapped, is not prepared, or there is a recorder already.
pub fn install(file: &File) -> io::Result<&'static Recorder> {
    let map = Map::open(file)?;
    if map.word(word::MAGIC).load(Ordering::Acquire) != map::MAGIC {
        return Err(io::Error::other("not the file of a recorder"));
    }
    #[cfg(target_os = "linux")]
    copy::mark()?;
    RECORDER
        .set(Recorder { map, fences_arrays: AtomicBool::new(false) })
        .map_err(|_| io::Error::other("this process has a recorder"))?;
    installed().ok_or_else(|| io::Error::other("no recorder"))
}

/// The plugin has given the control back. A copy of the process that it made ends here: rows are written by one process.
#[inline]
fn returned() {
    #[cfg(target_os = "linux")]
    copy::end_if_one();
}

/// The recorder of this process, if it is a worker.
pub fn installed() -> Option<&'static Recorder> {
    RECORDER.get()
}

/// Returns whether arrays of calls end at pages that cannot be written.
pub(super) fn fences_arrays() -> bool {
    installed().is_some_and(|recorder| recorder.fences_arrays.load(Ordering::Relaxed))
}

impl Recorder {
    /// Sets whether, from now on, a write past the end of an array of a run ends this process at once;
    /// [`Recording::trespass`] then returns the array. Otherwise canaries show it after the call.
    pub fn fence_arrays(&self, fences: bool) {
        self.fences_arrays.store(fences, Ordering::Relaxed);
    }

    /// Notes that the work is done, with the exit code.
    pub fn done(&self, code: u8) {
        self.map.word(word::DONE).store(1 + u64::from(code), Ordering::Release);
    }

    /// Notes the access of a call outside its arrays. Does only what a signal handler may.
    pub(super) fn note_trespass(&self, trespass: &Trespass) {
        let name = trespass.argument.as_bytes();
        let name = &name[..name.len().min(word::LONGEST_ARGUMENT)];
        self.map.write(word::ARGUMENT, name);
        let access = trespass.writes.map_or(0, |writes| 1 + u64::from(writes));
        let numbers = [1 + name.len() as u64, trespass.element.cast_unsigned(), trespass.length as u64, access];
        for (k, number) in numbers.into_iter().enumerate().rev() {
            self.map.word(word::TRESPASS + WORD * k).store(number, Ordering::Release);
        }
    }

    /// Leaves a number for the supervisor; `index` < [`NOTES`], others are ignored.
    pub fn note(&self, index: usize, value: u64) {
        if index < NOTES {
            self.map.word(word::NOTES + 8 * index).store(value, Ordering::Release);
        }
    }
}
