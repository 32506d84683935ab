//! Communication of two processes of this program: the work of the one that is started, and its messages, a line of
//! JSON each. The lines are in a file without a name. So nobody waits for a reader, and messages remain when a plugin
//! ends the process that wrote them.

use super::{system, trust, worker};
use crate::input;
use serde::de::DeserializeOwned;
use serde::{Deserialize, Serialize};
use std::ffi::OsString;
use std::fs::File;
use std::io::{self, Write};
use std::os::unix::fs::FileExt;
use std::path::{Path, PathBuf};
use std::sync::{Mutex, OnceLock};

/// Work that a process of its own does for this one.
pub trait Work: Serialize {
    /// Name by which the other process knows it.
    const NAME: &'static str;
    /// Whether the messages of a watched process are for the one that starts it. Else they go on to who started that one, if
    /// another process did.
    const IS_HEARD_BY_STARTER: bool = false;
}

/// First line: what all kinds of work have in common.
#[derive(Debug, Serialize, Deserialize)]
pub(super) struct Head {
    /// Name of the work.
    pub name: String,
    /// The process that starts the other one.
    pub starter: u32,
    /// The recorder's file, if calls are watched.
    pub recorder: Option<PathBuf>,
    /// Streams that the starter read from a pipe: the pipe's path, and a file with its content.
    pub streams: Vec<(OsString, PathBuf)>,
    /// Where messages go.
    to: PathBuf,
    /// Whether all libraries may run in any process.
    lets_all_in: bool,
}

/// Work that is handed over, and the messages of the process that does it.
#[derive(Debug)]
pub struct Passage {
    name: &'static str,
    work: String,
    is_heard_by_starter: bool,
    file: File,
    path: PathBuf,
    /// Bytes that were read or are no messages.
    read: u64,
    /// Content of streams, as long as the other process may open it.
    streams: Vec<File>,
}

/// File to which this process writes its messages, if another one has started it.
static MESSAGES: OnceLock<(PathBuf, Mutex<File>)> = OnceLock::new();

impl Passage {
    /// Takes work to hand over.
    ///
    /// # Errors
    /// No file can be made.
    pub fn new<W: Work>(work: &W) -> io::Result<Self> {
        let (file, path) = system::shared_file()?;
        let work = serde_json::to_string(work)?;
        Ok(Self {
            name: W::NAME,
            work,
            is_heard_by_starter: W::IS_HEARD_BY_STARTER,
            file,
            path,
            read: 0,
            streams: Vec::new(),
        })
    }

    /// Writes the work down.
    pub(super) fn hand_over(&mut self, recorder: Option<&Path>) -> io::Result<&Path> {
        let to = MESSAGES
            .get()
            .filter(|_| recorder.is_some() && !self.is_heard_by_starter)
            .map_or(&self.path, |(above, _)| above);
        let mut head = Head {
            name: self.name.to_owned(),
            starter: std::process::id(),
            recorder: recorder.map(Path::to_owned),
            streams: Vec::new(),
            to: to.clone(),
            lets_all_in: trust::all_are_let_in(),
        };
        for (stream, content) in input::streams() {
            let (mut file, path) = system::shared_file()?;
            file.write_all(&content)?;
            head.streams.push((stream.into(), path));
            self.streams.push(file);
        }
        let text = format!("{}\n{}\n", serde_json::to_string(&head)?, self.work);
        self.file.write_all(text.as_bytes())?;
        self.read = text.len() as u64;
        Ok(&self.path)
    }

    /// Returns the messages that are new; those of another kind are left out.
    pub fn heard<M: DeserializeOwned>(&mut self) -> Vec<M> {
        let length = self.file.metadata().map_or(0, |metadata| metadata.len());
        let mut text = vec![0; usize::try_from(length.saturating_sub(self.read)).unwrap_or(0)];
        let read = self.file.read_exact_at(&mut text, self.read);
        let Some(end) = read.ok().and_then(|()| text.iter().rposition(|byte| *byte == b'\n')) else {
            return Vec::new();
        };
        self.read += end as u64 + 1;
        text[..end].split(|byte| *byte == b'\n').filter_map(|line| serde_json::from_slice(line).ok()).collect()
    }
}

/// Reads the work that another process has written: its name, and the work as JSON. From here on messages go to that
/// process.
pub(super) fn taken(path: &Path) -> io::Result<(Head, String)> {
    let text = std::fs::read_to_string(path)?;
    let mut lines = text.lines();
    let mut line = || lines.next().ok_or(io::ErrorKind::UnexpectedEof);
    let (head, work): (Head, _) = (serde_json::from_str(line()?)?, line()?.to_owned());
    if head.lets_all_in {
        trust::let_all_in();
    }
    for (stream, content) in &head.streams {
        input::supply(stream.as_ref(), std::fs::read(content)?);
    }
    let file = system::out_of_reach(File::options().append(true).open(&head.to)?);
    let _ = MESSAGES.set((head.to.clone(), Mutex::new(file)));
    Ok((head, work))
}

/// Sends a message to the process that started this one, if this one is a worker. A worker that cannot send ends.
pub fn send(message: &impl Serialize) {
    let Some((_, file)) = MESSAGES.get() else { return };
    let line = serde_json::to_string(message).map_err(io::Error::from);
    let written = line.and_then(|line| match file.lock() {
        Ok(mut file) => file.write_all((line + "\n").as_bytes()),
        Err(_) => Ok(()),
    });
    if written.is_err() {
        worker::end_for_closed_output();
    }
}

/// A path as JSON, whatever its bytes.
pub mod path {
    use serde::{Deserialize, Deserializer, Serialize, Serializer};
    use std::ffi::OsString;
    use std::path::{Path, PathBuf};

    /// Writes it.
    ///
    /// # Errors
    /// As of the serializer.
    pub fn serialize<S: Serializer>(path: &Path, serializer: S) -> Result<S::Ok, S::Error> {
        path.as_os_str().serialize(serializer)
    }

    /// Reads it.
    ///
    /// # Errors
    /// As of the deserializer.
    pub fn deserialize<'de, D: Deserializer<'de>>(deserializer: D) -> Result<PathBuf, D::Error> {
        OsString::deserialize(deserializer).map(PathBuf::from)
    }
}

/// Paths as JSON, whatever their bytes.
pub mod paths {
    use serde::{Deserialize, Deserializer, Serializer};
    use std::ffi::OsString;
    use std::path::PathBuf;

    /// Writes them.
    ///
    /// # Errors
    /// As of the serializer.
    pub fn serialize<S: Serializer>(paths: &[PathBuf], serializer: S) -> Result<S::Ok, S::Error> {
        serializer.collect_seq(paths.iter().map(|path| path.as_os_str()))
    }

    /// Reads them.
    ///
    /// # Errors
    /// As of the deserializer.
    pub fn deserialize<'de, D: Deserializer<'de>>(deserializer: D) -> Result<Vec<PathBuf>, D::Error> {
        Vec::<OsString>::deserialize(deserializer).map(|paths| paths.into_iter().map(PathBuf::from).collect())
    }
}

/// A path that may not be given, as JSON, whatever its bytes.
pub mod optional_path {
    use serde::{Deserialize, Deserializer, Serialize, Serializer};
    use std::ffi::OsString;
    use std::path::PathBuf;

    /// Writes it.
    ///
    /// # Errors
    /// As of the serializer.
    pub fn serialize<S: Serializer>(path: &Option<PathBuf>, serializer: S) -> Result<S::Ok, S::Error> {
        path.as_ref().map(|path| path.as_os_str()).serialize(serializer)
    }

    /// Reads it.
    ///
    /// # Errors
    /// As of the deserializer.
    pub fn deserialize<'de, D: Deserializer<'de>>(deserializer: D) -> Result<Option<PathBuf>, D::Error> {
        Ok(Option::<OsString>::deserialize(deserializer)?.map(PathBuf::from))
    }
}
