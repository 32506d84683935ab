//! What the operating system is asked for.

use rustix::event::{PollFd, PollFlags, Timespec};
use std::fs::File;
use std::io;
use std::path::PathBuf;

/// Whether there is what isolation needs.
pub const IS_SUPPORTED: bool = cfg!(target_os = "linux");

/// A file without a name, and the path by which a child opens it while this process lives.
#[cfg(target_os = "linux")]
pub fn shared_file() -> io::Result<(File, PathBuf)> {
    use std::os::fd::AsRawFd;
    let file = File::from(rustix::fs::memfd_create("pullout recorder", rustix::fs::MemfdFlags::CLOEXEC)?);
    let path = format!("/proc/{}/fd/{}", std::process::id(), file.as_raw_fd());
    Ok((file, path.into()))
}

#[cfg(not(target_os = "linux"))]
pub fn shared_file() -> io::Result<(File, PathBuf)> {
    Err(io::ErrorKind::Unsupported.into())
}

/// This program, also if its file was replaced meanwhile.
pub fn program() -> PathBuf {
    "/proc/self/exe".into()
}

/// Lets the kernel end this process with the thread that started it; says whether that one still lives.
#[cfg(target_os = "linux")]
pub fn die_with(parent: u32) -> io::Result<bool> {
    rustix::process::set_parent_process_death_signal(Some(rustix::process::Signal::KILL))?;
    let present = rustix::process::getppid().map(|pid| pid.as_raw_nonzero().get());
    Ok(present.and_then(|pid| u32::try_from(pid).ok()) == Some(parent))
}

#[cfg(not(target_os = "linux"))]
pub fn die_with(_parent: u32) -> io::Result<bool> {
    Err(io::ErrorKind::Unsupported.into())
}

/// Whether the standard output and the standard error are open: one system call.
pub fn standard_streams_are_open() -> bool {
    let mut streams = [rustix::stdio::stdout(), rustix::stdio::stderr()]
        .map(|stream| PollFd::from_borrowed_fd(stream, PollFlags::empty()));
    let found = rustix::event::poll(&mut streams, Some(&Timespec::default()));
    found.is_err() || streams.iter().all(|stream| !stream.revents().contains(PollFlags::NVAL))
}

/// Descriptors below are the first that a plugin gets, or closes in a row.
const REACH: i32 = 512;

/// The same file under a number that plugins do not meet by chance; where there is none, as it was.
pub fn out_of_reach(file: File) -> File {
    rustix::io::fcntl_dupfd_cloexec(&file, REACH).map_or(file, File::from)
}
