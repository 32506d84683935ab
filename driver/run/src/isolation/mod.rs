//! A case in a process of its own, because its plugins may end the process that calls them.
//!
//! A UMAT that nobody here wrote may execute STOP, call `exit`, write through a wild pointer, divide by zero with traps
//! on, use the stack up, or never come back. What runs in the program's own process unasked is therefore only what was
//! built with it, known by its hash (`trust`); whatever else a library says of itself, it says it to a worker. The job is
//! isolated, not the call: a round trip per call would cost more than most laws, and COMMON blocks would be split between
//! processes.
//!
//! # Who does what
//!
//! ```text
//! supervisor   which cases need it? ── start worker ── watch ─────────────── message, replay, results ── exit code
//!                (need, trust)           (supervisor)     │ exit, signal, time     (ending, replay)
//!                                                         │
//! keeper                    wait for worker and supervisor ─── end what plugins started, end like the worker
//!                           (keeper)
//! worker                    do the work (passage): rows, fields, plots; before each call its arguments … done-mark
//!                           (worker)                       in shared memory (umat_abi::host::recorder)
//! ```
//!
//! The **supervisor** is the program that the user started. It does not even load a library that it does not trust,
//! whose initialisers would run at that moment. It starts itself again, by `exec` and not by `fork` alone. So nothing
//! of it is shared but the recorder's file, which has no name and so leaves no trace.
//!
//! The **worker** does its work as the program does without isolation, and on the same
//! terminal: rows, progress and messages are its own. Its done-mark carries the exit code. Its end without the mark is a
//! failure, with any exit code (Fortran's STOP gives 0). It dies with the supervisor.
//!
//! The **keeper** is the process that the supervisor starts; the worker is its copy, made before anything else is done. It
//! is there so that nothing outlives a run: copies and programs that plugins start end with the worker, however that one or
//! the supervisor ended.
//!
//! A run or a fit has one worker for all of it; `plugin check` has one for each group of checks, `plugin list` one for
//! each library.
//!
//! After a failed run a second worker reads the case again, without running it, and makes summary, plots and report of the
//! rows that are there, as for any other run that failed. If that fails as well (a library that cannot be loaded any
//! more), the supervisor writes a summary with what it knows.
//!
//! # What is watched
//!
//! - the worker's end: exit code or signal;
//! - signals: they are passed on, and what has not come back from a call a second later is ended;
//! - the time of one call, `call_time_limit_s`: the recorder's sequence numbers are the heartbeat. Time in which the
//!   supervisor was stopped itself does not count, nor in `plugin check` that in which the worker waited for a
//!   processor; what the host computes between calls takes as long as it takes;
//! - the standard output and the standard error, by the worker after each increment: if a plugin closes one, the next
//!   file that is opened takes its number, and what is printed goes there;
//! - copies of the worker that a plugin makes by `fork`: one that comes back from the call is ended there;
//! - the folder in which the program works, the mode of new files and the limits of open files, their size, memory and
//!   processes: restored after plugins changed them. If the system does not let a limit be restored, or the user was
//!   changed, the run ends.
//!
//! A library whose exit handlers end the worker after its done-mark takes nothing from the results, nor from the exit
//! code: it is reported.
//!
//! Not distinguished: a plugin that destroys the host's memory may end the worker later, outside a call; the message
//! then names the last call. A plugin that keeps its own memory (SAVE) may fail only after a history that a replay of
//! one call does not have.

mod child;
mod ending;
#[cfg(target_os = "linux")]
mod keeper;
#[cfg(not(target_os = "linux"))]
mod keeper {
    pub(super) fn work_below(_supervisor: u32) -> std::io::Result<()> {
        Err(std::io::ErrorKind::Unsupported.into())
    }
}
mod last_words;
mod need;
mod passage;
pub mod prints;
pub(crate) mod replay;
mod spoilt;
mod supervisor;
mod system;
#[cfg(test)]
mod test;
mod trust;
pub mod worker;

pub use child::Child;
pub use ending::Aftermath;
pub use last_words::ForwardedLines;
pub use need::{CALL_TIME_LIMIT, Need, locate, materials, named_file, need};
pub use passage::{Passage, Work, optional_path, path, paths, send};
pub use supervisor::{End, Watch, WorkerFailure, supervise};
pub use system::{die_with, identity, is_out_of_descriptors, out_of_reach, program, set_program, this_is_the_program};
pub use trust::{all_are_let_in, is_shipped, let_all_in, let_in, load, look_where_it_was_built};
pub use worker::Task;
