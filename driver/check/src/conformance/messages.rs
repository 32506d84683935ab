//! Messages of a plugin about input that makes no sense: it is right to give them, but they are not for the user's
//! terminal.

use rustix::stdio::dup2_stderr;
use std::fs::File;
use std::io::{Read, Seek};
use std::os::fd::OwnedFd;
use umat_abi::host::Library;

/// The standard error of this process, kept from the terminal until it is dropped.
#[derive(Debug)]
pub(super) struct Capture {
    /// File for the messages, and the original standard error; `None` where that cannot be arranged.
    streams: Option<(File, OwnedFd)>,
}

impl Capture {
    /// Starts to listen, except to a library built with `--debug`: it reports a trap while the process ends, to the process
    /// that started it.
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

    /// Returns `detail` with the plugin's first message and the number of further lines.
    pub(super) fn appended_to(mut self, detail: impl Into<String>) -> String {
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
