//! Ctrl-C and SIGTERM: a run ends with its present increment, keeps its results, and says so. SIGXFSZ becomes an error
//! of the write that reached the limit.

use rustix::process::{Pid, Signal, kill_process, kill_process_group};
use signal_hook::consts::{SIGINT, SIGTERM, SIGTSTP, SIGXFSZ};
use signal_hook::flag;
use signal_hook::low_level::emulate_default_handler;
use std::collections::BTreeSet;
use std::io;
use std::process::Child;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
use std::sync::{Arc, LazyLock, Mutex, MutexGuard, PoisonError};

/// The number of the last signal; 0: none.
static RECEIVED: LazyLock<Arc<AtomicUsize>> = LazyLock::new(Arc::default);

/// A signal that asks for the end.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Interrupt {
    /// Ctrl-C.
    Terminal,
    /// SIGTERM.
    Termination,
}

impl Interrupt {
    /// 128 and the signal's number, as shells have it.
    pub fn exit_code(self) -> u8 {
        match self {
            Self::Terminal => 130,
            Self::Termination => 143,
        }
    }

    /// Returns the name.
    pub fn words(self) -> &'static str {
        match self {
            Self::Terminal => "SIGINT (Ctrl-C)",
            Self::Termination => "SIGTERM",
        }
    }

    /// Sends it to a child. The child may have received it already; a second one does no harm.
    pub fn pass_on_to(self, child: &Child) {
        if let Some(pid) = i32::try_from(child.id()).ok().and_then(Pid::from_raw) {
            self.send(pid);
        }
    }

    /// Sends it to a process.
    pub(crate) fn send(self, process: Pid) {
        let signal = if self == Self::Terminal { Signal::INT } else { Signal::TERM };
        // one that has ended needs none
        let _ = kill_process(process, signal);
    }
}

/// Whether Ctrl-Z was pressed while there are companions.
static PAUSED: LazyLock<Arc<AtomicBool>> = LazyLock::new(Arc::default);
/// Whether there are none: Ctrl-Z does what it usually does.
static IS_ALONE: LazyLock<Arc<AtomicBool>> = LazyLock::new(|| Arc::new(AtomicBool::new(true)));
static COMPANIONS: Mutex<BTreeSet<i32>> = Mutex::new(BTreeSet::new());

fn companions() -> MutexGuard<'static, BTreeSet<i32>> {
    COMPANIONS.lock().unwrap_or_else(PoisonError::into_inner)
}

/// A process group that the terminal does not know: it stops at Ctrl-Z with this process, and goes on with it.
pub(crate) struct Companion(Pid);

impl Companion {
    pub fn new(group: Pid) -> Self {
        let mut companions = companions();
        if companions.is_empty() {
            PAUSED.store(false, Ordering::Relaxed);
        }
        companions.insert(group.as_raw_nonzero().get());
        IS_ALONE.store(false, Ordering::Relaxed);
        Self(group)
    }

    /// Stops this process and all companions if Ctrl-Z was pressed, until it is continued.
    pub fn pause_if_asked(&self) {
        if PAUSED.swap(false, Ordering::Relaxed) {
            let companions = companions();
            let tell = |signal| {
                for group in companions.iter().filter_map(|group| Pid::from_raw(*group)) {
                    let _ = kill_process_group(group, signal);
                }
            };
            tell(Signal::STOP);
            let _ = emulate_default_handler(SIGTSTP);
            tell(Signal::CONT);
        }
    }
}

impl Drop for Companion {
    fn drop(&mut self) {
        let mut companions = companions();
        companions.remove(&self.0.as_raw_nonzero().get());
        IS_ALONE.store(companions.is_empty(), Ordering::Relaxed);
    }
}

/// The signal that came, if one did.
pub fn received() -> Option<Interrupt> {
    match RECEIVED.load(Ordering::Relaxed) {
        0 => None,
        number if number == SIGINT as usize => Some(Interrupt::Terminal),
        _ => Some(Interrupt::Termination),
    }
}

/// Notes signals from here on instead of obeying them; `second_ends`: the second one ends the process at once
///
/// # Errors
/// The system does not let it.
pub fn listen(second_ends: bool) -> io::Result<()> {
    write_beyond_limits_fails()?;
    let again = Arc::new(AtomicBool::new(false));
    for (signal, interrupt) in [(SIGINT, Interrupt::Terminal), (SIGTERM, Interrupt::Termination)] {
        // a shell that starts a process in the background lets it ignore Ctrl-C
        if is_ignored(signal) {
            continue;
        }
        if second_ends {
            flag::register_conditional_shutdown(signal, i32::from(interrupt.exit_code()), Arc::clone(&again))?;
            flag::register(signal, Arc::clone(&again))?;
        }
        flag::register_usize(signal, Arc::clone(&RECEIVED), signal as usize)?;
    }
    if !is_ignored(SIGTSTP) {
        flag::register_conditional_default(SIGTSTP, Arc::clone(&IS_ALONE))?;
        flag::register(SIGTSTP, Arc::clone(&PAUSED))?;
    }
    Ok(())
}

/// A file that becomes larger than `ulimit -f` allows is an error of its write and does not end the process.
///
/// # Errors
/// The system does not let it.
pub fn write_beyond_limits_fails() -> io::Result<()> {
    flag::register(SIGXFSZ, Arc::default()).map(|_| ())
}

/// Returns whether this process was started with a signal ignored.
fn is_ignored(signal: i32) -> bool {
    let status = std::fs::read_to_string("/proc/self/status").unwrap_or_default();
    let mask = status.lines().find_map(|line| u64::from_str_radix(line.strip_prefix("SigIgn:")?.trim(), 16).ok());
    mask.is_some_and(|mask| mask >> (signal - 1) & 1 == 1)
}
