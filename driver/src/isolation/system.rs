//! What the operating system is asked for.

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

/// Whether the standard output is open: one system call, and the cheapest.
pub fn standard_output_is_open() -> bool {
    rustix::io::fcntl_getfd(rustix::stdio::stdout()).is_ok()
}
