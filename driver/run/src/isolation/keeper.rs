//! The process between supervisor and worker: whatever plugins start ends with the worker, and the worker with its
//! supervisor.
//!
//! The worker leads a process group, which is ended whole. What has left the group (`setsid`, a daemon) falls to the keeper
//! when its parent ends, and is ended one by one. The keeper calls no plugin, so that none can spoil it, and it lives on
//! where the supervisor was killed.

use super::system::die_with;
use nix::sys::{ptrace, signal};
use rustix::io::Errno;
use rustix::process::{
    Pid, Resource, Rlimit, Signal, WaitOptions, WaitStatus, getpid, getppid, kill_process, kill_process_group, setpgid,
    setrlimit, wait,
};
use signal_hook::consts::SIGCHLD;
use signal_hook::low_level::{emulate_default_handler, pipe, raise};
use std::io::{self, PipeReader, Read, Write};
use std::time::{Duration, Instant};

/// Time between two looks for the supervisor.
const POLL: Duration = Duration::from_millis(100);
/// Time in which everything that plugins started must have ended: what the system cannot end is left.
const PATIENCE: Duration = Duration::from_secs(1);
/// Time between two looks for what is left.
const BETWEEN_SWEEPS: Duration = Duration::from_millis(1);
/// `__WALL`: threads that trace themselves are children of another kind.
const ALL_KINDS: WaitOptions = WaitOptions::from_bits_retain(0x4000_0000);

/// Comes back in the process that is to be the worker, tied to its keeper. The keeper ends as the worker does.
///
/// # Errors
/// The system does not let it.
pub(super) fn work_below(supervisor: u32) -> io::Result<()> {
    rustix::process::set_child_subreaper(Some(getpid()))?;
    let keeper = getpid();
    match umat_abi::host::split()? {
        None => {
            setpgid(None, None)?;
            let keeper = keeper.as_raw_nonzero().get().unsigned_abs();
            if die_with(keeper)? { Ok(()) } else { Err(io::Error::other("the process that started this one is gone")) }
        }
        Some(worker) => {
            let ended = Pid::from_raw(worker).ok_or(Errno::SRCH.into()).and_then(|worker| keep(worker, supervisor));
            match ended {
                Ok(status) => end_like(status),
                Err(error) => {
                    let _ = writeln!(io::stderr(), "{error}");
                    std::process::exit(1)
                }
            }
        }
    }
}

/// Waits for the end of the worker, or of its supervisor, and ends what is left.
fn keep(worker: Pid, supervisor: u32) -> io::Result<WaitStatus> {
    // both know the group before either goes on
    let _ = setpgid(Some(worker), Some(worker));
    let (mut ended, notifier) = io::pipe()?;
    rustix::io::ioctl_fionbio(&ended, true)?;
    pipe::register(SIGCHLD, notifier)?;
    let has_supervisor = || getppid().is_some_and(|parent| parent.as_raw_nonzero().get().unsigned_abs() == supervisor);
    let mut status = None;
    while status.is_none() && has_supervisor() {
        status = reap(worker);
        if status.is_none() {
            sleep_until_notified(&mut ended, POLL);
        }
    }
    let _ = kill_process_group(worker, Signal::KILL);
    let start = Instant::now();
    while start.elapsed() < PATIENCE {
        status = status.or(reap(worker));
        match children().as_deref() {
            Some([]) if status.is_some() => break,
            Some(children) => children.iter().for_each(|child| _ = kill_process(*child, Signal::KILL)),
            // without a list of them the group is all that can be ended
            None if status.is_some() => break,
            None => {}
        }
        std::thread::sleep(BETWEEN_SWEEPS);
    }
    status.ok_or_else(|| io::Error::other("the process that calls plugins does not end"))
}

/// Reaps children that have ended; returns the status of the worker, if it is among them.
fn reap(worker: Pid) -> Option<WaitStatus> {
    loop {
        match wait(ALL_KINDS | WaitOptions::NOHANG) {
            Ok(Some((traced, status))) if status.stopped() => let_go(traced, status),
            Ok(Some((child, status))) if child == worker => return Some(status),
            Ok(Some(_)) | Err(Errno::INTR) => {}
            Ok(None) | Err(_) => return None,
        }
    }
}

/// Lets a thread go on that has asked to be traced, which nobody does here: with the signal at which it stopped.
fn let_go(traced: Pid, status: WaitStatus) {
    let thread = nix::unistd::Pid::from_raw(traced.as_raw_nonzero().get());
    let signal = status.stopping_signal().and_then(|signal| signal::Signal::try_from(signal).ok());
    let _ = ptrace::detach(thread, signal.filter(|signal| *signal != signal::Signal::SIGTRAP));
}

fn sleep_until_notified(ended: &mut PipeReader, time: Duration) {
    use rustix::event::{PollFd, PollFlags, Timespec, poll};
    let time = Timespec::try_from(time).ok();
    // a signal is no less a reason to look
    let _ = poll(&mut [PollFd::new(&*ended, PollFlags::IN)], time.as_ref());
    let mut bytes = [0; 64];
    while matches!(ended.read(&mut bytes), Ok(1..)) {}
}

/// Returns the children of this process, among them those whose parents have ended; `None` if the kernel does not list
/// them.
fn children() -> Option<Vec<Pid>> {
    let mut children = Vec::new();
    for thread in std::fs::read_dir("/proc/self/task").ok()?.flatten() {
        let text = std::fs::read_to_string(thread.path().join("children")).ok()?;
        children.extend(text.split_whitespace().filter_map(|pid| Pid::from_raw(pid.parse().ok()?)));
    }
    Some(children)
}

/// Ends this process in the way in which another one has ended.
fn end_like(status: WaitStatus) -> ! {
    if let Some(signal) = status.terminating_signal() {
        // the memory of this process explains nothing
        let _ = setrlimit(Resource::Core, Rlimit { current: Some(0), maximum: Some(0) });
        let _ = emulate_default_handler(signal);
        // one without a name
        let _ = raise(signal);
    }
    std::process::exit(status.exit_status().unwrap_or(1))
}
