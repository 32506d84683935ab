//! The process that calls the plugins.

use super::prints::restore_mode_of_files;
use super::spoilt::{self, Spoilt};
use super::{keeper, passage, system};
use crate::path::Statistics;
use console::Term;
use std::fs::File;
use std::io::{self, IsTerminal, Write};
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::{Path, PathBuf};
use std::sync::OnceLock;
use std::sync::atomic::{AtomicU64, Ordering};
use umat_abi::host::print_by_lines;
use umat_abi::host::recorder::{self, Recorder};

/// Name of the hidden command.
pub const COMMAND: &str = "worker";

/// The command line of a process that works for another one. Only the program itself writes it.
#[derive(Clone, Debug, clap::Args)]
pub struct Task {
    /// File with the work.
    passage: PathBuf,
}

/// Numbers that a worker leaves for its supervisor.
#[derive(Clone, Copy, Debug)]
pub(super) enum Note {
    /// 1: the result directory is this run's, its history has begun.
    Running,
    Increments,
    Iterations,
    Cutbacks,
    /// What a plugin spoilt: a number of [`Spoilt`].
    Spoilt,
    /// Calls of the present check of a plugin.
    Calls,
    /// The number of the process.
    Process,
}

/// The exit code of a Rust program that panicked.
const PANICKED: i32 = 101;
/// Increments between two looks after the plugins.
const LOOK_EVERY: u64 = 64;

/// Calls of the present check.
static CALLS: AtomicU64 = AtomicU64::new(0);

/// A check of a plugin begins.
pub fn begin_calls() {
    CALLS.store(0, Ordering::Relaxed);
}

/// A check calls a plugin once more, or a case takes an increment.
pub fn note_call() {
    if let Some(recorder) = recorder::installed() {
        recorder.note(Note::Calls as usize, 1 + CALLS.fetch_add(1, Ordering::Relaxed));
    }
}

/// Returns whether this process is a worker: what it does needs no other one.
pub fn is_this_process() -> bool {
    recorder::installed().is_some()
}

/// The terminal of the supervisor's standard error, to which this one is a pipe: for what moves, such as a bar.
static TERMINAL: OnceLock<Term> = OnceLock::new();

/// Terminal to which progress is shown, if there is one.
pub fn terminal() -> Option<Term> {
    if io::stderr().is_terminal() { Some(Term::stderr()) } else { TERMINAL.get().cloned() }
}

/// The supervisor's standard error, if that is a terminal.
fn terminal_of(supervisor: u32) -> Option<Term> {
    let file = File::options().write(true).open(format!("/proc/{supervisor}/fd/2")).ok()?;
    file.is_terminal().then(|| Term::read_write_pair(io::stdin(), file))
}

/// Does the work by a function of its name and text, whose result is the exit code. A watched worker does it below a keeper, and
/// ends this process; the exit code goes into the done-mark.
///
/// # Errors
/// The work cannot be taken over.
pub fn work(task: &Task, work: impl FnOnce(&str, &str) -> u8) -> io::Result<u8> {
    let (head, text) = passage::taken(&task.passage)?;
    let Some(recorder) = &head.recorder else {
        // where it cannot be asked for, this process outlives the other one
        let _ = system::die_with(head.starter);
        return Ok(work(&head.name, &text));
    };
    keeper::work_below(head.starter)?;
    // the thread that waits for this one and ends the process is the keeper's
    let done = catch_unwind(AssertUnwindSafe(|| {
        let recorder = open(recorder).map_err(|error| format!("{}: {error}", recorder.display()))?;
        Ok::<_, String>(work_below(recorder, head.starter, || work(&head.name, &text)))
    }));
    std::process::exit(match done {
        Ok(Ok(code)) => code.into(),
        Ok(Err(message)) => {
            let _ = writeln!(io::stderr(), "{message}");
            1
        }
        Err(_) => PANICKED,
    })
}

/// Does the work of a watched worker.
fn work_below(recorder: &Recorder, supervisor: u32, work: impl FnOnce() -> u8) -> u8 {
    recorder.note(Note::Process as usize, std::process::id().into());
    spoilt::keep();
    print_by_lines();
    recorder.fence_arrays(true);
    if let Some(terminal) = terminal_of(supervisor) {
        let _ = TERMINAL.set(terminal);
    }
    let code = work();
    if code != 0 {
        // why, nobody has heard, or it was the plugin
        end_if_spoilt();
    }
    recorder.done(code);
    code
}

fn open(path: &Path) -> io::Result<&'static Recorder> {
    recorder::install(&File::options().read(true).write(true).open(path)?)
}

/// The history of a run has begun.
pub fn note_start() {
    if let Some(recorder) = recorder::installed() {
        recorder.note(Note::Running as usize, 1);
        end_if_a_stream_is_closed();
    }
}

/// Lets calls come back that wrote past an array: a check of a plugin goes on after such an error.
pub fn let_calls_come_back() {
    if let Some(recorder) = recorder::installed() {
        recorder.fence_arrays(false);
    }
}

/// An increment is done.
pub fn note_increment(so_far: &Statistics) {
    let Some(recorder) = recorder::installed() else { return };
    recorder.note(Note::Increments as usize, so_far.increments);
    recorder.note(Note::Iterations as usize, so_far.iterations);
    recorder.note(Note::Cutbacks as usize, so_far.cutbacks);
    // system calls, which cost as much as the increment of a point
    if so_far.increments < LOOK_EVERY || so_far.increments.is_multiple_of(LOOK_EVERY) {
        look_after_plugins();
    }
}

/// Undoes what plugins did to this process, before a file is opened and now and then. One that closed a standard stream ends
/// the worker here: the next file to be opened would take its number, and what is printed would go into it. So does one that
/// took the right to write results.
pub fn look_after_plugins() {
    if is_this_process() {
        restore_mode_of_files();
        end_if_a_stream_is_closed();
        end_for(Spoilt::undone());
    }
}

/// Ends this worker if a plugin did to the process what makes the program itself fail: to be asked before a failure is
/// reported that looks like one of files.
pub fn end_if_spoilt() {
    if is_this_process() {
        end_if_a_stream_is_closed();
        end_for(Spoilt::present());
    }
}

fn end_if_a_stream_is_closed() {
    if !system::standard_streams_are_open() {
        end_for_closed_output();
    }
}

/// Ends this worker because a plugin closed a stream that it writes to; does nothing in other processes.
pub fn end_for_closed_output() {
    end_for(Some(Spoilt::ClosedOutput));
}

fn end_for(spoilt: Option<Spoilt>) {
    if let Some((recorder, spoilt)) = recorder::installed().zip(spoilt) {
        recorder.note(Note::Spoilt as usize, spoilt as u64);
        std::process::exit(1);
    }
}
