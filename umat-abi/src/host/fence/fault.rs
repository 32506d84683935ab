//! The handler of forbidden accesses.

use std::io;
use std::mem::MaybeUninit;
use std::ptr;
use std::sync::OnceLock;
use std::sync::atomic::{AtomicPtr, Ordering};

/// Receives an address that was touched, and whether it was written; `None`: the processor does not report this. Does
/// only what a signal handler may.
pub(in crate::host) type Sink = fn(address: usize, writes: Option<bool>);

const SIGNALS: [i32; 2] = [libc::SIGSEGV, libc::SIGBUS];

static SINK: AtomicPtr<()> = AtomicPtr::new(ptr::null_mut());
/// The handlers that there were before.
static FORMER: OnceLock<[libc::sigaction; 2]> = OnceLock::new();

/// Installs handlers that pass forbidden accesses to `sink` from now on, and then to the former handlers.
///
/// # Errors
/// The system does not let it.
pub(in crate::host) fn listen(sink: Sink) -> io::Result<()> {
    SINK.store(sink as *mut (), Ordering::SeqCst);
    let mut former = [MaybeUninit::<libc::sigaction>::zeroed(); 2];
    for (signal, former) in SIGNALS.into_iter().zip(&mut former) {
        // SAFETY: a plain system call, which fills the last argument.
        if unsafe { libc::sigaction(signal, ptr::null(), former.as_mut_ptr()) } != 0 {
            return Err(io::Error::last_os_error());
        }
    }
    // before the first fault can come to the new handler
    // SAFETY: filled above, and zeros are valid.
    let _ = FORMER.set(former.map(|action| unsafe { action.assume_init() }));
    for signal in SIGNALS {
        // SAFETY: plain system calls; the handler is one of three arguments, and does what a handler may.
        unsafe {
            let mut action: libc::sigaction = std::mem::zeroed();
            action.sa_sigaction = handler as *const () as usize;
            action.sa_flags = libc::SA_SIGINFO | libc::SA_ONSTACK;
            if libc::sigaction(signal, &raw const action, ptr::null_mut()) != 0 {
                return Err(io::Error::last_os_error());
            }
        }
    }
    Ok(())
}

extern "C" fn handler(signal: i32, info: *const libc::siginfo_t, context: *const libc::c_void) {
    let sink = SINK.load(Ordering::SeqCst);
    // SAFETY: the kernel passes both; what `listen` stored is a function.
    unsafe {
        // a signal that was sent, not caused, has no address
        let is_sent = (*info).si_code <= 0;
        if !is_sent && !sink.is_null() {
            std::mem::transmute::<*mut (), Sink>(sink)((*info).si_addr() as usize, writes(context));
        }
        for (number, former) in SIGNALS.into_iter().zip(FORMER.get().into_iter().flatten()) {
            libc::sigaction(number, former, ptr::null_mut());
        }
        // the access is repeated on return
        if is_sent {
            libc::signal(signal, libc::SIG_DFL);
            libc::raise(signal);
        }
    }
}

/// Returns whether the access was a write; `None`: the processor does not report this.
#[cfg(all(target_arch = "x86_64", target_os = "linux"))]
unsafe fn writes(context: *const libc::c_void) -> Option<bool> {
    /// Bit of the page fault's error code.
    const WRITE: i64 = 2;
    // SAFETY: the third argument of a handler is the context.
    let error = unsafe { (*context.cast::<libc::ucontext_t>()).uc_mcontext.gregs[libc::REG_ERR as usize] };
    Some(error & WRITE != 0)
}

#[cfg(not(all(target_arch = "x86_64", target_os = "linux")))]
unsafe fn writes(_context: *const libc::c_void) -> Option<bool> {
    None
}
