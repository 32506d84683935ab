//! Splitting this process in two, before it has called any plugin.

use std::io;

/// Splits this process: the copy gets `None`, this one the number of the copy. In the copy only the calling thread goes on;
/// the terminal, which is not its own, neither stops it when it prints nor when a plugin reads.
///
/// To be called while no other thread of the process does anything but wait.
///
/// # Errors
/// The system makes no more processes.
#[cfg(target_os = "linux")]
pub fn split() -> io::Result<Option<i32>> {
    // SAFETY: the copy has the calling thread alone; the others only wait, and hold no locks that it may need.
    match unsafe { libc::fork() } {
        -1 => Err(io::Error::last_os_error()),
        0 => {
            for signal in [libc::SIGTTOU, libc::SIGTTIN] {
                // SAFETY: ignoring a signal runs no code.
                unsafe { libc::signal(signal, libc::SIG_IGN) };
            }
            Ok(None)
        }
        copy => Ok(Some(copy)),
    }
}

/// Splits this process: on this system it cannot.
///
/// # Errors
/// Always.
#[cfg(not(target_os = "linux"))]
pub fn split() -> io::Result<Option<i32>> {
    Err(io::ErrorKind::Unsupported.into())
}
