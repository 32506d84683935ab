//! The child process, and its report on its end.

use super::super::fence::{Fenced, listen};
use super::Probed;
use std::io::{self, Read};
use std::os::fd::AsRawFd;
use std::ptr;
use std::sync::atomic::{AtomicI32, Ordering};

/// A call that takes longer does not come back, s.
const TIME_LIMIT: u32 = 10;
/// Bytes that the child writes: an address and what happened there, or the number that it computes.
const MESSAGE: usize = 9;
/// The last byte if the processor does not report whether the address was written; otherwise 0 or 1.
const TOUCHED: u8 = 2;
/// The last byte of a call that came back.
const RETURNED: u8 = 3;
/// Stack of the handler.
const HANDLER_STACK: usize = 1 << 16;

/// Pipe to which the child's handler writes.
static CHANNEL: AtomicI32 = AtomicI32::new(-1);

/// Runs a call in a child process.
pub(super) fn run(fenced: &[Fenced], call: impl FnOnce()) -> io::Result<Probed> {
    let (message, status) = within(|| {
        call();
        (0, RETURNED)
    })?;
    Ok(judge(fenced, &message, status))
}

/// Answers a question in a child process; `None` if the child does not come back.
///
/// # Errors
/// The system gives no process.
pub fn ask(question: impl FnOnce() -> bool) -> io::Result<Option<bool>> {
    Ok(compute(|| u64::from(question()))?.map(|answer| answer == u64::from(true)))
}

/// Computes a number in a child process, which leaves no trace in this one; `None` if the child does not come back.
///
/// # Errors
/// The system gives no process.
pub fn compute(work: impl FnOnce() -> u64) -> io::Result<Option<u64>> {
    let (message, _) = within(|| (work(), RETURNED))?;
    let (number, what) = message.split_at_checked(MESSAGE - 1).unwrap_or_default();
    Ok(number.try_into().ok().filter(|_| what == [RETURNED]).map(u64::from_ne_bytes))
}

/// Runs work in a child process that sends a number and its last byte; returns the child's message and status.
fn within(work: impl FnOnce() -> (u64, u8)) -> io::Result<(Vec<u8>, i32)> {
    let (mut reader, writer) = io::pipe()?;
    // SAFETY: the child makes the call and ends; it returns to no code of this process.
    match unsafe { libc::fork() } {
        -1 => Err(io::Error::last_os_error()),
        0 => {
            CHANNEL.store(writer.as_raw_fd(), Ordering::SeqCst);
            prepare();
            let (number, what) = work();
            report(number, what);
            // SAFETY: ends the child without the exit handlers that it shares with its parent.
            unsafe { libc::_exit(0) }
        }
        child => {
            drop(writer);
            let mut message = Vec::new();
            reader.read_to_end(&mut message)?;
            let mut status = 0;
            // SAFETY: waits for the child that was made above.
            unsafe { libc::waitpid(child, &raw mut status, 0) };
            Ok((message, status))
        }
    }
}

/// Prepares the child: a handler for forbidden accesses on a stack of its own, a time limit, no output.
fn prepare() {
    // SAFETY: plain system calls with memory that lives as long as the child.
    unsafe {
        let stack = libc::stack_t { ss_sp: libc::malloc(HANDLER_STACK), ss_flags: 0, ss_size: HANDLER_STACK };
        libc::sigaltstack(&raw const stack, ptr::null_mut());
        libc::signal(libc::SIGALRM, libc::SIG_DFL);
        libc::alarm(TIME_LIMIT);
        let nowhere = libc::open(c"/dev/null".as_ptr(), libc::O_WRONLY);
        libc::dup2(nowhere, libc::STDOUT_FILENO);
        libc::dup2(nowhere, libc::STDERR_FILENO);
    }
    // without a handler the signal is reported by its number
    let _ = listen(|address, writes| {
        report(address as u64, writes.map_or(TOUCHED, u8::from));
        // SAFETY: ends the child.
        unsafe { libc::_exit(1) }
    });
}

/// Writes the message. Only what a signal handler may call.
fn report(number: u64, what: u8) {
    let mut message = [what; MESSAGE];
    message[..MESSAGE - 1].copy_from_slice(&number.to_ne_bytes());
    // SAFETY: writes bytes of this frame.
    unsafe { libc::write(CHANNEL.load(Ordering::SeqCst), message.as_ptr().cast(), MESSAGE) };
}

/// Returns the result that the child's message and status give.
fn judge(fenced: &[Fenced], message: &[u8], status: i32) -> Probed {
    let received = message.first_chunk::<8>().zip(message.get(8)).map(|(address, what)| (*address, *what));
    match received {
        Some((_, RETURNED)) => Probed::Clean,
        Some((address, what)) => {
            let address = usize::try_from(u64::from_ne_bytes(address)).unwrap_or(0);
            let writes = (what != TOUCHED).then_some(what == u8::from(true));
            let found = fenced.iter().find_map(|array| array.extent().trespass(address, writes));
            match found {
                Some(trespass) => Probed::Trespass(trespass),
                None => Probed::Ended("it touches memory that is not its own (a segmentation fault)".into()),
            }
        }
        None if libc::WIFSIGNALED(status) && libc::WTERMSIG(status) == libc::SIGALRM => {
            Probed::Ended(format!("it takes longer than {TIME_LIMIT} s"))
        }
        None if libc::WIFSIGNALED(status) => Probed::Ended(format!("signal {}", libc::WTERMSIG(status))),
        None => Probed::Ended(format!("it ends the process (exit code {})", libc::WEXITSTATUS(status))),
    }
}
