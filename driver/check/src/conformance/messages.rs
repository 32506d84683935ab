//! What a plugin says about input that makes no sense: that it says something is right, and not for the user's terminal.

use rustix::stdio::dup2_stderr;
use std::fs::File;
use std::io::{Read, Seek};
use std::os::fd::OwnedFd;
use umat_abi::host::Library;

/// The standard error of this process, kept from the terminal until it is dropped.
#[derive(Debug)]
pub(super) struct Capture {
    /// Where messages go, and the standard error as it was; `None` where that cannot be arranged.
    streams: Option<(File, OwnedFd)>,
}

impl Capture {
    /// Starts to listen, but not to a library that is made to be debugged: what it says of a trap is said while the process ends, to whoever
    /// started it.
    pub(super) fn start(library: &Library) -> Self {
        if library.traps() {
            return Self { streams: None };
        }
        let streams = tempfile::tempfile().ok().and_then(|file| {
            let before = rustix::io::fcntl_dupfd_cloexec(rustix::stdio::stderr(), 3).ok()?;
            dup2_stderr(&file).ok()?;
            Some((file, before))
        });
        Self { streams }
    }

    /// `detail`, and how many messages there were, with the first.
    pub(super) fn told(mut self, detail: impl Into<String>) -> String {
        let mut text = String::new();
        if let Some((file, _)) = &mut self.streams {
            let _ = file.rewind();
            let _ = file.read_to_string(&mut text);
        }
        let mut words = detail.into();
        if let Some(first) = text.lines().next() {
            let separator = if words.is_empty() { "" } else { "; " };
            words += &format!("{separator}the plugin says '{first}'");
            match text.lines().count() {
                1 => {}
                lines => words += &format!(" and {} lines more", lines - 1),
            }
        }
        words
    }
}

impl Drop for Capture {
    fn drop(&mut self) {
        if let Some((_, before)) = &self.streams {
            let _ = dup2_stderr(before);
        }
    }
}
