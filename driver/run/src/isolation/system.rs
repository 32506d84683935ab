//! Requests to the operating system.

use crate::input::{self, Input};
use rustix::event::{PollFd, PollFlags, Timespec};
use rustix::io::Errno;
use std::fs::{DirEntry, File};
use std::io;
use std::path::{Path, PathBuf};
use std::process::{Child, Command, ExitStatus};
use std::sync::mpsc::{self, Sender};
use std::sync::{Mutex, OnceLock, PoisonError};
use std::time::{Duration, Instant};
use umat_abi::host;

/// Time between two looks at a child if the system does not report its end.
const MOMENT: Duration = Duration::from_millis(1);

/// Whether this system has the means that isolation needs.
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

/// Files of the program `pullout`, see [`set_program`]: the one that is started, and the one that computes.
static PROGRAM: OnceLock<[PathBuf; 2]> = OnceLock::new();

/// Says once which file is the program `pullout`, which is started for what needs a process of its own. It may be this
/// process's; what is installed with it is found. `engine` is the file with its machine code: the same one, or the library
/// that a script loads.
pub fn set_program(file: &Path, engine: &Path) {
    let _ = PROGRAM.set([file.to_owned(), engine.to_owned()]);
    host::search_from_program(file);
}

/// Says that this process is the program, also if its file was replaced meanwhile; unless a file was named before.
pub fn this_is_the_program() {
    let _ = PROGRAM.set(["/proc/self/exe"; 2].map(PathBuf::from));
}

fn files() -> io::Result<&'static [PathBuf; 2]> {
    let unknown = || io::Error::new(io::ErrorKind::NotFound, "the location of the program `pullout` is not known");
    PROGRAM.get().ok_or_else(unknown)
}

/// The program.
///
/// # Errors
/// The program's file has not been set.
pub fn program() -> io::Result<&'static Path> {
    files().map(|[program, _]| program.as_path())
}

/// Returns what results depend on besides the case: SHA-256 of the file that computes.
///
/// # Errors
/// As of [`program`]; it cannot be read.
pub fn identity() -> io::Result<[u8; 32]> {
    let [_, engine] = files()?;
    input::hash(engine, Input::Mesh)
}

/// Starts a child from a thread that lives as long as this process: what the child may ask for with [`die_with`] comes at
/// the end of the thread that started it.
pub fn spawn(command: Command) -> io::Result<Child> {
    type Order = (Command, Sender<io::Result<Child>>);
    /// The process that the thread belongs to (a copy of it by `fork` has no such thread), and the way to it.
    static STARTER: Mutex<Option<(u32, Sender<Order>)>> = Mutex::new(None);
    let (answer, answered) = mpsc::channel();
    {
        let mut starter = STARTER.lock().unwrap_or_else(PoisonError::into_inner);
        let present = std::process::id();
        let orders = match &*starter {
            Some((process, orders)) if *process == present => orders,
            _ => {
                let (orders, ordered) = mpsc::channel::<Order>();
                std::thread::Builder::new().name("pullout starter".into()).spawn(move || {
                    for (mut command, answer) in ordered {
                        let _ = answer.send(command.spawn());
                    }
                })?;
                &starter.insert((present, orders)).1
            }
        };
        orders.send((command, answer)).map_err(io::Error::other)?;
    }
    answered.recv().map_err(io::Error::other)?
}

/// Returns whether an error says that this process, or the system, has no descriptors left.
pub fn is_out_of_descriptors(error: &io::Error) -> bool {
    [Errno::MFILE, Errno::NFILE].contains(&Errno::from_io_error(error).unwrap_or(Errno::INVAL))
}

/// Waits for the end of a child, for so long at most.
///
/// # Errors
/// The child cannot be waited for.
pub fn wait_for(child: &mut Child, time: Duration) -> io::Result<Option<ExitStatus>> {
    let start = Instant::now();
    loop {
        if let Some(status) = child.try_wait()? {
            return Ok(Some(status));
        }
        let left = time.saturating_sub(start.elapsed());
        if left.is_zero() {
            return Ok(None);
        }
        wait_a_while(child.id(), left);
    }
}

/// Waits for the end of a process, or for a moment if the system does not report it.
#[cfg(target_os = "linux")]
fn wait_a_while(process: u32, time: Duration) {
    use rustix::process::{Pid, PidfdFlags, pidfd_open};
    let process = i32::try_from(process).ok().and_then(Pid::from_raw);
    match process.and_then(|process| pidfd_open(process, PidfdFlags::empty()).ok()) {
        Some(ended) => {
            let time = Timespec::try_from(time).ok();
            let _ = rustix::event::poll(&mut [PollFd::new(&ended, PollFlags::IN)], time.as_ref());
        }
        None => std::thread::sleep(time.min(MOMENT)),
    }
}

#[cfg(not(target_os = "linux"))]
fn wait_a_while(_process: u32, time: Duration) {
    std::thread::sleep(time.min(MOMENT));
}

/// Returns how long the thread of a process that waited most for a processor has done so; zero if the kernel does not
/// report it.
pub fn waiting_time(process: u64) -> Duration {
    let of_thread = |thread: DirEntry| {
        let times = std::fs::read_to_string(thread.path().join("schedstat")).ok()?;
        times.split_whitespace().nth(1)?.parse::<u64>().ok()
    };
    let threads = std::fs::read_dir(format!("/proc/{process}/task")).into_iter().flatten().flatten();
    Duration::from_nanos(threads.filter_map(of_thread).max().unwrap_or(0))
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

/// Returns whether the standard output and the standard error are open: one system call.
pub fn standard_streams_are_open() -> bool {
    let mut streams = [rustix::stdio::stdout(), rustix::stdio::stderr()]
        .map(|stream| PollFd::from_borrowed_fd(stream, PollFlags::empty()));
    let found = rustix::event::poll(&mut streams, Some(&Timespec::default()));
    found.is_err() || streams.iter().all(|stream| !stream.revents().contains(PollFlags::NVAL))
}

/// Descriptors below are the first that a plugin gets, or closes in a row.
const REACH: i32 = 512;

/// Returns the same file under a number that plugins do not meet by chance; if there is none, the file as it was.
pub fn out_of_reach(file: File) -> File {
    rustix::io::fcntl_dupfd_cloexec(&file, REACH).map_or(file, File::from)
}
