//! Fences whose violation is noted in the recorder of this process.

use super::super::recorder;
use super::fault::listen;
use super::{Extent, Fenced};
use std::ptr;
use std::sync::OnceLock;
use std::sync::atomic::{AtomicBool, AtomicPtr, AtomicUsize, Ordering};

/// Arrays that are watched at the same time: each takes some of the mappings that a process may have, and some of memory.
const MOST: usize = 2048;

/// One array in the list that the handler goes through. It is never taken out of it.
#[derive(Debug)]
struct WatchedArray {
    extent: Extent,
    is_alive: AtomicBool,
    next: *const WatchedArray,
}

/// The list's newest entry.
static NEWEST: AtomicPtr<WatchedArray> = AtomicPtr::new(ptr::null_mut());
static COUNT: AtomicUsize = AtomicUsize::new(0);

/// A fenced array of which the handler knows.
#[derive(Debug)]
pub(in crate::host) struct Watched {
    fenced: Fenced,
    entry: &'static WatchedArray,
}

// SAFETY: the list's entries do not change, except for atomic fields, and live for ever.
unsafe impl Sync for WatchedArray {}
// SAFETY: as above.
unsafe impl Send for WatchedArray {}

/// Watches the fences of an array, so that accesses to them are noted; `None`: too many are watched, or no handler can be
/// installed.
pub(in crate::host) fn watch(make: impl FnOnce() -> Option<Fenced>) -> Option<Watched> {
    static LISTENS: OnceLock<bool> = OnceLock::new();
    if COUNT.load(Ordering::Relaxed) >= MOST || !*LISTENS.get_or_init(|| listen(note).is_ok()) {
        return None;
    }
    let fenced = make()?;
    COUNT.fetch_add(1, Ordering::Relaxed);
    let entry = WatchedArray { extent: *fenced.extent(), is_alive: AtomicBool::new(true), next: ptr::null() };
    let entry: *mut WatchedArray = Box::into_raw(Box::new(entry));
    let mut newest = NEWEST.load(Ordering::Acquire);
    loop {
        // SAFETY: nobody else knows it yet.
        unsafe { (*entry).next = newest };
        match NEWEST.compare_exchange_weak(newest, entry, Ordering::AcqRel, Ordering::Acquire) {
            // SAFETY: it is never freed, and from now on only read.
            Ok(_) => return Some(Watched { fenced, entry: unsafe { &*entry } }),
            Err(other) => newest = other,
        }
    }
}

impl Watched {
    pub(in crate::host) fn address(&self) -> *mut u8 {
        self.fenced.address()
    }

    pub(in crate::host) fn fill_after(&self, pattern: u64, is_open: bool) {
        self.fenced.fill_after(pattern, is_open);
    }
}

impl Drop for Watched {
    fn drop(&mut self) {
        self.entry.is_alive.store(false, Ordering::Release);
        COUNT.fetch_sub(1, Ordering::Relaxed);
    }
}

/// Runs in the signal handler.
fn note(address: usize, writes: Option<bool>) {
    let mut next: *const WatchedArray = NEWEST.load(Ordering::Acquire);
    // SAFETY: entries of the list live for ever.
    while let Some(entry) = unsafe { next.as_ref() } {
        if entry.is_alive.load(Ordering::Acquire)
            && let Some(trespass) = entry.extent.trespass(address, writes)
        {
            if let Some(recorder) = recorder::installed() {
                recorder.note_trespass(&trespass);
            }
            return;
        }
        next = entry.next;
    }
}
