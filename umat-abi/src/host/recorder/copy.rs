//! Copies of this process, which a plugin makes by `fork`: known by a page that the kernel clears in them.

use std::io;
use std::ptr;
use std::sync::atomic::{AtomicPtr, AtomicU64, Ordering};

const PAGE: usize = 4096;
const ORIGINAL: u64 = 1;
const WORDS: &[u8] = b"a copy of the process that a plugin made (fork) came back from its call and was ended there\n";

/// A word in that page.
static MARK: AtomicPtr<AtomicU64> = AtomicPtr::new(ptr::null_mut());

/// Makes this process the original.
pub(super) fn mark() -> io::Result<()> {
    let protection = libc::PROT_READ | libc::PROT_WRITE;
    // SAFETY: a new mapping touches nobody's memory.
    let page = unsafe { libc::mmap(ptr::null_mut(), PAGE, protection, libc::MAP_PRIVATE | libc::MAP_ANONYMOUS, -1, 0) };
    // SAFETY: the mapping that was made above.
    if page == libc::MAP_FAILED || unsafe { libc::madvise(page, PAGE, libc::MADV_WIPEONFORK) } != 0 {
        return Err(io::Error::last_os_error());
    }
    let word: *mut AtomicU64 = page.cast();
    // SAFETY: a page begins with room for a word.
    unsafe { (*word).store(ORIGINAL, Ordering::Relaxed) };
    MARK.store(word, Ordering::Release);
    Ok(())
}

/// Ends this process if it is a copy.
#[inline]
pub(super) fn end_if_one() {
    // SAFETY: the page is never unmapped.
    if let Some(mark) = unsafe { MARK.load(Ordering::Relaxed).as_ref() }
        && mark.load(Ordering::Relaxed) != ORIGINAL
    {
        end();
    }
}

#[cold]
fn end() -> ! {
    // SAFETY: writes bytes of the program, and ends the copy without the exit handlers that it shares with the original.
    unsafe {
        libc::write(libc::STDERR_FILENO, WORDS.as_ptr().cast(), WORDS.len());
        libc::_exit(1)
    }
}
