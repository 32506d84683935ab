//! Output that plugins print: kept in files of the result directory, or thrown away, and kept apart from this program's
//! own.
//!
//! While a [`Prints`] lives, plugins may be called; afterwards the program works again in the folder where it worked
//! before. The standard output is a file, and this program writes to a duplicate of the former one. Fortran's unit 7
//! goes to a file next to it if its runtime allows this to be set.

use super::system::out_of_reach;
use super::worker;
use rustix::fs::{Mode, OFlags};
use rustix::io::fcntl_dupfd_cloexec;
use rustix::process::umask;
use rustix::stdio::{dup2_stdout, stdout};
use std::borrow::Cow;
use std::fs::{self, File};
use std::io::{self, Read, Seek, SeekFrom, Write};
use std::os::fd::OwnedFd;
use std::path::{Path, PathBuf};
use std::process::Stdio;
use std::sync::{Mutex, MutexGuard, OnceLock, PoisonError};
use umat_abi::host::{flush_prints, write_messages_to};

/// Unit 6 and the standard output; unit 7.
pub const FILES: [&str; 2] = ["umat.log", "umat.msg"];
const NOWHERE: &str = "/dev/null";
/// Descriptors up to here have a meaning for everybody.
const AFTER_STANDARD_STREAMS: i32 = 3;

/// The standard output as this program was given it, while plugins have another.
static OURS: Mutex<Option<OwnedFd>> = Mutex::new(None);

fn ours() -> MutexGuard<'static, Option<OwnedFd>> {
    OURS.lock().unwrap_or_else(PoisonError::into_inner)
}

/// Prints to the standard output that this program was given; a reader that went away (`| head`) is no error.
pub fn say(text: &str) {
    let text = plain(text);
    let copy = ours().as_ref().map(OwnedFd::try_clone);
    let said = match copy {
        Some(ours) => ours.and_then(|ours| File::from(ours).write_all(text.as_bytes())),
        None => io::stdout().write_all(text.as_bytes()),
    };
    if said.is_err_and(|error| error.kind() != io::ErrorKind::BrokenPipe) {
        worker::end_for_closed_output();
    }
}

/// Properties of a process that plugins may change: the folder in which it works, and the mode of new files.
#[derive(Debug)]
struct Surroundings {
    folder: Option<OwnedFd>,
}

/// The mode of new files as this program was given it.
static MODE_OF_FILES: OnceLock<Mode> = OnceLock::new();

/// Gives new files the mode that this program was given.
pub(super) fn restore_mode_of_files() {
    if let Some(mode) = MODE_OF_FILES.get() {
        umask(*mode);
    }
}

impl Surroundings {
    /// Keeps the surroundings as they are.
    fn keep() -> Self {
        MODE_OF_FILES.get_or_init(|| {
            // the system returns it only when it is set
            let mode = umask(Mode::empty());
            umask(mode);
            mode
        });
        let folder = rustix::fs::open(".", OFlags::PATH | OFlags::DIRECTORY | OFlags::CLOEXEC, Mode::empty());
        Self { folder: folder.ok().map(|folder| out_of_reach(folder.into()).into()) }
    }
}

impl Drop for Surroundings {
    fn drop(&mut self) {
        restore_mode_of_files();
        if let Some(folder) = &self.folder {
            let _ = rustix::process::fchdir(folder);
        }
    }
}

/// The standard output that a child of this program gets.
pub(super) fn for_child() -> Stdio {
    ours().as_ref().and_then(|ours| ours.try_clone().ok()).map_or_else(Stdio::inherit, Stdio::from)
}

/// Leads what plugins print elsewhere while it lives. One at a time, and by the thread that runs the command: the standard
/// output is the whole process's.
#[derive(Debug)]
#[must_use = "prints go where they went when it is dropped"]
pub struct Prints {
    /// Folder in which they are kept; `None`: nowhere.
    folder: Option<PathBuf>,
    /// Whether the text that was kept is shown in the end.
    echo: bool,
    _surroundings: Surroundings,
}

impl Prints {
    /// Throws them away.
    pub fn discard() -> Self {
        // without it the prints are seen, no more
        let _ = lead_to(Path::new(NOWHERE), Path::new(NOWHERE));
        Self { folder: None, echo: false, _surroundings: Surroundings::keep() }
    }

    /// Appends them to the [`FILES`] of a folder.
    ///
    /// # Errors
    /// A file cannot be made.
    pub fn keep(folder: &Path, echo: bool) -> io::Result<Self> {
        let folder = std::path::absolute(folder)?;
        let [log, messages] = FILES.map(|name| folder.join(name));
        lead_to(&log, &messages)?;
        Ok(Self { folder: Some(folder), echo, _surroundings: Surroundings::keep() })
    }
}

impl Drop for Prints {
    fn drop(&mut self) {
        flush_prints();
        if let Some(ours) = ours().take() {
            let _ = dup2_stdout(&ours);
        }
        let Some(folder) = &self.folder else { return };
        write_messages_to(Path::new(NOWHERE));
        if self.echo {
            Echo::of(folder).show();
        }
        remove_empty(folder);
    }
}

fn lead_to(log: &Path, messages: &Path) -> io::Result<()> {
    let file = File::options().create(true).append(true).open(log).map_err(|error| named(log, &error))?;
    // what was printed before belongs where it was printed to
    flush_prints();
    io::stdout().flush()?;
    let mut ours = ours();
    if ours.is_none() {
        let copy = fcntl_dupfd_cloexec(stdout(), AFTER_STANDARD_STREAMS)?;
        *ours = Some(out_of_reach(copy.into()).into());
    }
    dup2_stdout(&file)?;
    write_messages_to(messages);
    Ok(())
}

fn named(path: &Path, error: &io::Error) -> io::Error {
    io::Error::new(error.kind(), format!("{}: {error}", path.display()))
}

/// Text for a terminal: control characters, on which it might act, are written as JSON has them; line breaks and tabs stay.
pub fn plain(text: &str) -> Cow<'_, str> {
    let acts = |c: char| c.is_control() && !"\n\t".contains(c);
    if !text.contains(acts) {
        return text.into();
    }
    let shown = |c: char| if acts(c) { format!("\\u{:04x}", u32::from(c)) } else { c.into() };
    text.chars().map(shown).collect::<String>().into()
}

/// Removes the files of a folder into which nothing was printed.
pub fn remove_empty(folder: &Path) {
    for file in FILES.map(|name| folder.join(name)) {
        if fs::metadata(&file).is_ok_and(|metadata| metadata.len() == 0) {
            let _ = fs::remove_file(&file);
        }
    }
}

/// Shows what is printed into the files of a folder.
#[derive(Debug)]
pub struct Echo {
    files: [PathBuf; FILES.len()],
    shown: [u64; FILES.len()],
}

impl Echo {
    /// Makes an echo of a run into this folder.
    pub fn of(folder: &Path) -> Self {
        Self { files: FILES.map(|name| folder.join(name)), shown: [0; FILES.len()] }
    }

    /// Shows what is new.
    pub fn show(&mut self) {
        for (file, shown) in self.files.iter().zip(&mut self.shown) {
            let mut text = Vec::new();
            let read = |text: &mut Vec<u8>| {
                let mut file = File::open(file)?;
                file.seek(SeekFrom::Start(*shown))?;
                file.read_to_end(text)
            };
            if read(&mut text).is_ok() {
                *shown += text.len() as u64;
                let _ = io::stdout().write_all(&text);
            }
        }
        let _ = io::stdout().flush();
    }
}
