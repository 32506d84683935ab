//! The program as a process, and what is expected of each.

use nix::sys::resource::{Resource, UsageWho, getrlimit, getrusage, setrlimit};
use std::ffi::{OsStr, OsString};
use std::fs::{DirEntry, File};
use std::io::{Read, Seek};
use std::os::unix::process::{CommandExt, ExitStatusExt};
use std::path::{Path, PathBuf};
use std::process::{Child, Command, ExitStatus, Stdio};
use std::time::{Duration, Instant};
use wait_timeout::ChildExt;

/// The name by which the test program is `pullout`.
pub const NAME: &str = "pullout";
/// Files of results.
pub const HISTORY: &str = "history.csv";
pub const CHECKPOINT: &str = "checkpoint.bin";
/// A run that is longer is asked to end.
const PATIENCE: Duration = Duration::from_secs(20);
/// A run that does not end in this time after it was asked hangs.
const GRACE: Duration = Duration::from_secs(30);
/// The most memory of a process, bytes.
pub const MOST_MEMORY: u64 = 1 << 30;

/// The most processes of this user while plugins copy theirs: the machine goes on if they are not ended.
const MOST_PROCESSES: u64 = 8192;

/// Bounds the processes of this program and of all that it starts.
pub fn bound_processes() {
    let (_, hard) = getrlimit(Resource::RLIMIT_NPROC).expect("a limit");
    let most = hard.min(MOST_PROCESSES);
    setrlimit(Resource::RLIMIT_NPROC, most, most).expect("a lower limit");
}

/// The program, in a folder.
pub fn pullout<S: AsRef<OsStr>>(folder: &Path, arguments: impl IntoIterator<Item = S>) -> Command {
    let mut command = Command::new(std::env::current_exe().expect("the path of this program"));
    command.arg0(NAME).current_dir(folder).args(arguments);
    command.env_remove("PULLOUT_PLUGIN_PATH").stdin(Stdio::null());
    command
}

/// Output of a process, and its end.
#[derive(Debug)]
pub struct Outcome {
    pub status: ExitStatus,
    pub stdout: String,
    pub stderr: String,
    /// Whether the process was asked to end, for it took long.
    pub was_asked: bool,
}

/// Runs a process to its end.
pub fn outcome(mut command: Command) -> Result<Outcome, String> {
    let [mut stdout, mut stderr] = [(); 2].map(|()| tempfile::tempfile().expect("a temporary file"));
    let copy = |file: &File| file.try_clone().expect("a descriptor");
    let mut child = command.stdout(copy(&stdout)).stderr(copy(&stderr)).spawn().map_err(|error| error.to_string())?;
    let ended = child.wait_timeout(PATIENCE).map_err(|error| error.to_string())?;
    let was_asked = ended.is_none();
    let ended = match ended {
        Some(status) => Some(status),
        None => {
            terminate(&child);
            child.wait_timeout(GRACE).map_err(|error| error.to_string())?
        }
    };
    let Some(status) = ended else {
        let _ = child.kill();
        let _ = child.wait();
        return Err(format!("hangs, also {} s after SIGTERM: {command:?}", GRACE.as_secs()));
    };
    let text = |file: &mut File| {
        let mut bytes = Vec::new();
        file.rewind().and_then(|()| file.read_to_end(&mut bytes)).expect("a temporary file");
        String::from_utf8_lossy(&bytes).into_owned()
    };
    Ok(Outcome { status, stdout: text(&mut stdout), stderr: text(&mut stderr), was_asked })
}

fn terminate(child: &Child) {
    let pid = nix::unistd::Pid::from_raw(i32::try_from(child.id()).expect("a process id"));
    let _ = nix::sys::signal::kill(pid, nix::sys::signal::Signal::SIGTERM);
}

impl Outcome {
    /// Checks that it ended in an allowed way: with an exit code and, if something is wrong, a message that names one of these
    /// files.
    pub fn judge(&self, names: &[&str]) -> Result<i32, String> {
        let wrong = |what: &str| Err(format!("{what}; stderr:\n{}", shortened(&self.stderr)));
        let Some(code) = self.status.code() else {
            return wrong(&format!("ended by signal {}", self.status.signal().unwrap_or_default()));
        };
        if self.stderr.contains("panicked at") || self.stdout.contains("panicked at") {
            return wrong("panicked");
        }
        let may_be = matches!(code, 0..=3) || self.was_asked && code == 143;
        if !may_be {
            return wrong(&format!("exit {code}"));
        }
        if code != 0 && !names.iter().any(|name| self.stderr.contains(name)) {
            return wrong(&format!("exit {code}, and no message names {}", names.join(" or ")));
        }
        let is_plain = |c: char| !c.is_control() || c == '\n' || c == '\t';
        if !self.stderr.chars().chain(self.stdout.chars()).all(is_plain) {
            return wrong("control characters");
        }
        Ok(code)
    }
}

fn shortened(text: &str) -> String {
    text.chars().take(600).map(|c| if c.is_control() && c != '\n' { '?' } else { c }).collect()
}

/// The most memory that a child of this process took, bytes.
pub fn peak_of_children() -> u64 {
    let usage = getrusage(UsageWho::RUSAGE_CHILDREN).expect("it is always known");
    u64::try_from(usage.max_rss()).unwrap_or_default() << 10
}

/// Returns every file below a folder with its size and time, except those within `left_out`.
pub fn inventory(folder: &Path, left_out: &Path) -> Vec<(PathBuf, u64, std::time::SystemTime)> {
    let mut files = Vec::new();
    let mut folders = vec![folder.to_owned()];
    while let Some(folder) = folders.pop() {
        for entry in std::fs::read_dir(&folder).expect("a folder").flatten() {
            let path = entry.path();
            let metadata = std::fs::symlink_metadata(&path).expect("a file");
            match metadata.is_dir() {
                _ if path == left_out => {}
                true => folders.push(path),
                false => files.push((path, metadata.len(), metadata.modified().expect("a time"))),
            }
        }
    }
    files.sort();
    files
}

/// Copies a folder.
pub fn copy(from: &Path, to: &Path) {
    std::fs::create_dir_all(to).expect("a folder");
    for entry in std::fs::read_dir(from).expect("a folder").flatten() {
        let (from, to) = (entry.path(), to.join(entry.file_name()));
        if from.is_dir() { copy(&from, &to) } else { std::fs::copy(&from, &to).map(drop).expect("a file") }
    }
}

/// Environment variable that marks all processes of an attempt: child processes inherit it.
pub const MARK: &str = "HOSTILE_ATTEMPT";
/// Time in which everything that a plugin started must have ended.
const LEFT_FOR: Duration = Duration::from_secs(2);

/// The processes that are marked by a folder.
pub fn marked(folder: &Path) -> Vec<OsString> {
    let mark = format!("{MARK}={}", folder.display());
    let is_marked = |process: &DirEntry| {
        let variables = std::fs::read(process.path().join("environ")).unwrap_or_default();
        variables.split(|byte| *byte == 0).any(|variable| variable == mark.as_bytes())
    };
    let processes = std::fs::read_dir("/proc").expect("processes").flatten();
    processes.filter(is_marked).map(|process| process.file_name()).collect()
}

/// Looks for processes that outlive an attempt.
pub fn none_is_left(folder: &Path) -> Result<(), String> {
    let start = Instant::now();
    loop {
        let left = marked(folder);
        if left.is_empty() {
            return Ok(());
        }
        if start.elapsed() > LEFT_FOR {
            return Err(format!("{} processes live on: {left:?}", left.len()));
        }
        std::thread::sleep(Duration::from_millis(20));
    }
}
