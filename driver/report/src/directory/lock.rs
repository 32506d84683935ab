//! One writer at a time.

use super::at;
use pullout_run::input::{self, Input};
use rustix::fs::{FlockOperation, OFlags, flock};
use rustix::io::Errno;
use std::fs::{self, File};
use std::io::{self, Write};
use std::os::unix::fs::{MetadataExt, OpenOptionsExt};
use std::path::{Path, PathBuf};
use std::time::Duration;

/// The lock's file in a directory.
const FILE: &str = ".pullout.lock";
/// Kind of the error that another process has the lock.
const TAKEN: io::ErrorKind = io::ErrorKind::ResourceBusy;

/// The right to write into a directory. The kernel takes it back when the process ends, however it ends: the lock file of a
/// killed process locks nothing.
#[derive(Debug)]
pub struct Lock {
    path: PathBuf,
    /// Holds the lock until it is closed.
    _file: File,
}

impl Lock {
    /// Takes the lock of a directory, and says what the user should know of it.
    ///
    /// # Errors
    /// Another process has it ([`TAKEN`]); the file cannot be written.
    pub(super) fn take(directory: &Path) -> io::Result<(Self, Option<String>)> {
        let path = directory.join(FILE);
        loop {
            let mut options = File::options();
            options.read(true).write(true).create(true).truncate(false);
            // the file is emptied: not one that a link leads to
            options.custom_flags((OFlags::NOFOLLOW | OFlags::NONBLOCK).bits().cast_signed());
            let mut file = options.open(&path).map_err(at(&path))?;
            let note = match flock(&file, FlockOperation::NonBlockingLockExclusive) {
                Ok(()) => None,
                Err(Errno::WOULDBLOCK) => return Err(taken(directory, &text(&path))),
                // NFS without its lock daemon, some file systems in user space
                Err(Errno::NOLCK | Errno::NOTSUP | Errno::NOSYS | Errno::INVAL) => {
                    let text = text(&path);
                    if is_alive(&text) {
                        return Err(taken(directory, &text));
                    }
                    Some(format!(
                        "{}: this file system has no locks: a run on another host could write here at the same time",
                        directory.display()
                    ))
                }
                Err(error) => return Err(at(&path)(error.into())),
            };
            // Its last holder may have removed the file after it was opened here: then nobody else will meet this lock.
            let identity = |file: io::Result<fs::Metadata>| file.ok().map(|file| (file.dev(), file.ino()));
            if identity(fs::metadata(&path)) != identity(file.metadata()) {
                continue;
            }
            let [pid, host] = this_process();
            file.set_len(0).and_then(|()| writeln!(file, "{pid} {host}")).map_err(at(&path))?;
            return Ok((Self { path, _file: file }, note));
        }
    }
}

/// Time between two looks at a lock that another process has.
const POLL: Duration = Duration::from_millis(200);

impl Lock {
    /// Takes the lock of a directory as soon as nobody else has it; `None` if `gives_up` says so meanwhile.
    ///
    /// # Errors
    /// The file cannot be written.
    pub fn wait(directory: &Path, gives_up: impl Fn() -> bool) -> io::Result<Option<Self>> {
        loop {
            match Self::take(directory) {
                Ok((lock, _)) => return Ok(Some(lock)),
                Err(error) if error.kind() != TAKEN => return Err(error),
                Err(_) if gives_up() => return Ok(None),
                Err(_) => std::thread::sleep(POLL),
            }
        }
    }
}

impl Drop for Lock {
    fn drop(&mut self) {
        // before it is released
        let _ = fs::remove_file(&self.path);
    }
}

fn text(path: &Path) -> String {
    input::text(path, Input::Result).unwrap_or_default()
}

fn this_process() -> [String; 2] {
    let host = rustix::system::uname().nodename().to_string_lossy().into_owned();
    [std::process::id().to_string(), host]
}

/// Process and host of a lock's file.
fn holder(text: &str) -> Option<(u32, &str)> {
    let (pid, host) = text.trim_end().split_once(' ')?;
    Some((pid.parse().ok()?, host))
}

/// Returns whether the file names a process of this host that lives.
fn is_alive(text: &str) -> bool {
    let [own, this_host] = this_process();
    holder(text).is_some_and(|(pid, host)| {
        let pid_of = |pid: u32| rustix::process::Pid::from_raw(i32::try_from(pid).ok()?);
        host == this_host
            && pid.to_string() != own
            && pid_of(pid).is_some_and(|pid| rustix::process::test_kill_process(pid) != Err(Errno::SRCH))
    })
}

fn taken(directory: &Path, text: &str) -> io::Error {
    let who = match holder(text) {
        Some((pid, host)) => format!("process {pid} on {host}"),
        None => "another process".into(),
    };
    let advice = "wait for its end, or choose another --out";
    io::Error::new(TAKEN, format!("{}: {who} is writing results there: {advice}", directory.display()))
}
