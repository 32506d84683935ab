//! The one reader of files that a user or a case names: at once, whole, up to a size that their use may need, and no
//! longer than something comes.
//!
//! A pipe (`<(generate)`, `/dev/stdin`, a FIFO) can be read once. Its content is kept for later readers of the path,
//! and handed on to the processes that this one starts for isolated plugins ([`streams`], [`supply`]).

use crate::signals;
use rustix::event::{PollFd, PollFlags, Timespec, poll};
use rustix::fs::{Mode, OFlags};
use rustix::io::Errno;
use sha2::{Digest, Sha256};
use std::collections::BTreeMap;
use std::fs::{File, FileType, Metadata};
use std::io::{self, Read};
use std::os::fd::{AsFd, OwnedFd};
use std::os::unix::fs::FileTypeExt;
use std::path::{Path, PathBuf};
use std::sync::{Mutex, PoisonError};
use std::time::{Duration, Instant};
use umat_abi::host::{self, Stamp};

#[cfg(test)]
mod test;

/// Longest time for which a pipe may keep silent.
const PATIENCE: Duration = Duration::from_secs(if cfg!(test) { 1 } else { 10 });
/// Time between two looks at signals.
const LOOK: Timespec = Timespec { tv_sec: 0, tv_nsec: 100_000_000 };

const MEGABYTE: u64 = 1_000_000;

/// Kind of a file, which decides how much of it is read.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Input {
    /// A case or a study.
    Case,
    /// A CSV file: a table that drives a step, a measured curve.
    Table,
    /// A mesh.
    Mesh,
    /// An ABAQUS job with one element, or a file that it includes.
    Job,
    /// Source text of a plugin.
    Source,
    /// A shared library.
    Library,
    /// A file that the program wrote into a result directory, other than checkpoints and histories.
    Result,
    /// A checkpoint.
    Checkpoint,
}

impl Input {
    /// Returns the limit in megabytes, and a description of the kind. A case holds numbers that people and scripts
    /// wrote, not data: tables and meshes have their own files. A table of the greatest size has some million rows, a
    /// mesh some ten million nodes.
    const fn most(self) -> (u64, &'static str) {
        match self {
            Self::Case => (32, "a case or study"),
            Self::Table => (64, "a table"),
            Self::Mesh => (2_000, "a mesh"),
            Self::Job => (256, "a job"),
            Self::Source => (64, "a source"),
            Self::Library => (1_000, "a library"),
            Self::Result => (256, "a result"),
            Self::Checkpoint => (16_000, "a checkpoint"),
        }
    }

    /// The most bytes.
    pub const fn limit(self) -> u64 {
        MEGABYTE * self.most().0
    }

    /// Returns whether it may come through a pipe. What the program wrote, what is compiled and what is loaded lies in a file.
    const fn may_stream(self) -> bool {
        matches!(self, Self::Case | Self::Table | Self::Mesh | Self::Job)
    }
}

/// Content of a pipe, or why there is none.
type Stream = Result<Vec<u8>, (io::ErrorKind, String)>;

/// Streams that were read, by their paths.
static STREAMS: Mutex<BTreeMap<PathBuf, Stream>> = Mutex::new(BTreeMap::new());

/// Reads a file.
///
/// # Errors
/// Without the file's name: it cannot be opened or read, is no file, is too large, nothing comes out of it, or a signal
/// asks for the end.
pub fn read(path: &Path, input: Input) -> io::Result<Vec<u8>> {
    let again = |stream: &Stream| stream.clone().map_err(|(kind, message)| io::Error::new(kind, message));
    // Locked while a pipe is read: another thread that asks for it waits.
    let mut streams = STREAMS.lock().unwrap_or_else(PoisonError::into_inner);
    if let Some(stream) = streams.get(path) {
        return again(stream);
    }
    let metadata = std::fs::metadata(path)?;
    check_type(metadata.file_type(), input)?;
    if metadata.is_file() {
        drop(streams);
        return bytes(path, &metadata, input);
    }
    let stream = bytes(path, &metadata, input).map_err(|error| (error.kind(), error.to_string()));
    again(streams.entry(path.to_owned()).or_insert(stream))
}

/// Hashes a file on disk (SHA-256): once, as long as it stays the same.
///
/// # Errors
/// As of [`read`].
pub fn hash(path: &Path, input: Input) -> io::Result<[u8; 32]> {
    static KNOWN: Mutex<BTreeMap<PathBuf, (Stamp, [u8; 32])>> = Mutex::new(BTreeMap::new());
    let stamp = host::stamp(path)?;
    let known = || KNOWN.lock().unwrap_or_else(PoisonError::into_inner);
    if let Some((_, hash)) = known().get(path).filter(|(of, _)| *of == stamp) {
        return Ok(*hash);
    }
    let hash = Sha256::digest(read(path, input)?).into();
    known().insert(path.to_owned(), (stamp, hash));
    Ok(hash)
}

/// The SHA-256 of a text, in hexadecimal digits.
pub fn fingerprint(text: &str) -> String {
    hexadecimal(Sha256::new().chain_update(text))
}

/// Opens a file on disk, to be read piece by piece.
///
/// # Errors
/// The file cannot be opened, or is no file on disk.
pub fn open(path: &Path) -> io::Result<File> {
    check_type(std::fs::metadata(path)?.file_type(), Input::Result)?;
    open_without_waiting(path).map(File::from)
}

/// SHA-256 of the first bytes of a file of results.
///
/// # Errors
/// The file cannot be read.
pub fn digest(path: &Path, bytes: u64) -> io::Result<Sha256> {
    let mut digest = Sha256::new();
    in_pieces(path, bytes, |piece| digest.update(piece))?;
    Ok(digest)
}

/// Reads the first bytes of a file of results piece by piece.
///
/// # Errors
/// The file cannot be read.
pub fn in_pieces(path: &Path, bytes: u64, mut take: impl FnMut(&[u8])) -> io::Result<()> {
    let (mut file, mut piece) = (open(path)?.take(bytes), vec![0; 1 << 16]);
    loop {
        match file.read(&mut piece)? {
            0 => return Ok(()),
            length => take(&piece[..length]),
        }
    }
}

/// A digest as text.
pub fn hexadecimal(digest: Sha256) -> String {
    digits(digest.finalize())
}

/// Bytes in hexadecimal digits.
pub fn digits(bytes: impl AsRef<[u8]>) -> String {
    bytes.as_ref().iter().map(|byte| format!("{byte:02x}")).collect()
}

/// Reads a file of UTF-8 text; a byte order mark is left out.
///
/// # Errors
/// As of [`read`]; it holds something else.
pub fn text(path: &Path, input: Input) -> io::Result<String> {
    let content = read(path, input)?;
    let content = without_mark(&content)?;
    let text = std::str::from_utf8(content).map_err(|error| {
        let line = 1 + memchr::memchr_iter(b'\n', &content[..error.valid_up_to()]).count();
        refusal(format!("line {line} is not UTF-8: save it as text in UTF-8"))
    })?;
    Ok(text.to_owned())
}

/// Text without its byte order mark.
///
/// # Errors
/// The content is encoded in UTF-16, or is no text.
pub fn without_mark(content: &[u8]) -> io::Result<&[u8]> {
    if content.starts_with(b"\xff\xfe") || content.starts_with(b"\xfe\xff") {
        return Err(refusal("it is in UTF-16: save it as text in UTF-8"));
    }
    let content = content.strip_prefix(b"\xef\xbb\xbf").unwrap_or(content);
    if let Some(position) = memchr::memchr(0, content) {
        let line = 1 + memchr::memchr_iter(b'\n', &content[..position]).count();
        return Err(refusal(format!("line {line} has a NUL byte: it is no text in UTF-8")));
    }
    Ok(content)
}

/// Returns whether a path leads to something that can be read once only.
pub fn is_stream(path: &Path) -> bool {
    std::fs::metadata(path).is_ok_and(|metadata| !metadata.is_file() && !metadata.is_dir())
}

/// The folder that paths in a file are relative to: its own, but the working directory if the path names a descriptor
/// (`/dev/stdin`, `/dev/fd/63`).
pub fn folder_of(path: &Path) -> &Path {
    if path.starts_with("/dev") || path.starts_with("/proc") {
        return Path::new("");
    }
    path.parent().unwrap_or(Path::new(""))
}

/// Returns what came out of pipes so far.
pub fn streams() -> Vec<(PathBuf, Vec<u8>)> {
    let streams = STREAMS.lock().unwrap_or_else(PoisonError::into_inner);
    streams.iter().filter_map(|(path, stream)| Some((path.clone(), stream.clone().ok()?))).collect()
}

/// Says what another process read from a pipe.
pub fn supply(path: &Path, content: Vec<u8>) {
    STREAMS.lock().unwrap_or_else(PoisonError::into_inner).insert(path.to_owned(), Ok(content));
}

fn check_type(file_type: FileType, input: Input) -> io::Result<()> {
    if file_type.is_dir() {
        return Err(refusal("it is a folder, not a file"));
    }
    if file_type.is_socket() {
        return Err(refusal("it is a socket, not a file"));
    }
    if file_type.is_block_device() {
        return Err(refusal("it is a device, not a file"));
    }
    if !file_type.is_file() && !input.may_stream() {
        return Err(refusal("it is a pipe or a device, not a file"));
    }
    Ok(())
}

/// Returns what is in a file or comes out of a pipe.
fn bytes(path: &Path, metadata: &Metadata, input: Input) -> io::Result<Vec<u8>> {
    let too_large = || {
        let (megabytes, words) = input.most();
        refusal(format!("it has more than {megabytes} MB, the most that {words} may have"))
    };
    if metadata.len() > input.limit() {
        return Err(too_large());
    }
    let file = open_without_waiting(path)?;
    let mut content = Vec::new();
    let expected = usize::try_from(metadata.len()).unwrap_or(usize::MAX).saturating_add(1);
    content.try_reserve_exact(expected).map_err(|_| io::Error::from(io::ErrorKind::OutOfMemory))?;
    let mut block = vec![0; 1 << 16];
    loop {
        if !metadata.is_file() {
            wait(&file)?;
        }
        match rustix::io::read(&file, &mut block) {
            Ok(0) => return Ok(content),
            Ok(length) if (content.len() + length) as u64 > input.limit() => return Err(too_large()),
            Ok(length) => content.extend_from_slice(&block[..length]),
            Err(Errno::INTR | Errno::AGAIN) => {}
            Err(error) => return Err(error.into()),
        }
    }
}

/// A FIFO without a writer would not be opened before one comes.
fn open_without_waiting(path: &Path) -> io::Result<OwnedFd> {
    let flags = OFlags::RDONLY | OFlags::NONBLOCK | OFlags::NOCTTY | OFlags::CLOEXEC;
    Ok(rustix::fs::open(path, flags, Mode::empty())?)
}

/// Waits until there is something to read, or the end.
fn wait(file: &OwnedFd) -> io::Result<()> {
    let start = Instant::now();
    while start.elapsed() < PATIENCE {
        if let Some(signal) = signals::received() {
            return Err(io::Error::new(io::ErrorKind::Interrupted, format!("interrupted by {}", signal.words())));
        }
        match poll(&mut [PollFd::new(&file.as_fd(), PollFlags::IN)], Some(&LOOK)) {
            Ok(0) | Err(Errno::INTR) => {}
            Ok(_) => return Ok(()),
            Err(error) => return Err(error.into()),
        }
    }
    let message = format!("nothing came out of it for {} s: it is a pipe or a device", PATIENCE.as_secs());
    Err(io::Error::new(io::ErrorKind::TimedOut, message))
}

fn refusal(message: impl Into<String>) -> io::Error {
    io::Error::new(io::ErrorKind::InvalidData, message.into())
}
