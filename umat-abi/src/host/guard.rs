//! Calls of libraries that describe nothing: what is not known of them is made sure of.

use super::discovery::real_path;
use crate::floating_point;
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError, Weak};

/// One thread at a time, and the floating-point modes as they were. By default of a library that is known to be thread-safe.
#[derive(Clone, Debug, Default)]
pub(super) struct Guard {
    /// `None`: the library is known to be thread-safe.
    turn: Option<Arc<Mutex<()>>>,
    /// Whether invalid operations, divisions by zero and overflow end the process with SIGFPE in a call.
    traps: bool,
    changed_modes: Arc<AtomicBool>,
    /// Inputs that calls wrote.
    written: Arc<Mutex<BTreeMap<&'static str, WrittenInput>>>,
}

/// First call that wrote an input.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct WrittenInput {
    /// Step, increment, element and point.
    pub place: [i32; 4],
    /// Neighbouring arrays that the call may have meant: the one before, past whose end it wrote, and the one after.
    pub neighbours: [Option<&'static str>; 2],
}

impl WrittenInput {
    /// Returns the name of its argument, with the arrays that the call may have missed.
    pub fn named(&self, argument: &str) -> String {
        match self.neighbours {
            [None, None] => argument.to_owned(),
            [Some(before), None] => format!("{argument} (or {before} past its end, where {argument} lies)"),
            [None, Some(after)] => format!("{argument} (or {after} in front of its beginning, where {argument} lies)"),
            [Some(before), Some(after)] => format!(
                "{argument} (or {before} past its end, or {after} in front of its beginning, where {argument} lies)"
            ),
        }
    }
}

/// The turn of each library file: handles of one file share its COMMON blocks.
static TURNS: Mutex<Vec<(PathBuf, Weak<Mutex<()>>)>> = Mutex::new(Vec::new());

/// The lock of a file.
fn turn_of(path: &Path) -> Arc<Mutex<()>> {
    let path = real_path(path);
    let mut turns = locked(&TURNS);
    turns.retain(|(_, turn)| turn.strong_count() > 0);
    if let Some(turn) = turns.iter().find(|(known, _)| *known == path).and_then(|(_, turn)| turn.upgrade()) {
        return turn;
    }
    let turn = Arc::new(Mutex::new(()));
    turns.push((path, Arc::downgrade(&turn)));
    turn
}

fn locked<T>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}

impl Guard {
    pub(super) fn new(path: &Path, traps: bool) -> Self {
        Self { turn: Some(turn_of(path)), traps, ..Self::default() }
    }

    /// A call wrote inputs.
    #[cold]
    pub(super) fn note_written(
        &self,
        arguments: impl IntoIterator<Item = (&'static str, [Option<&'static str>; 2])>,
        place: [i32; 4],
    ) {
        let mut written = locked(&self.written);
        for (argument, neighbours) in arguments {
            written.entry(argument).or_insert(WrittenInput { place, neighbours });
        }
    }

    /// The inputs that calls wrote.
    pub(super) fn written(&self) -> BTreeMap<&'static str, WrittenInput> {
        locked(&self.written).clone()
    }

    /// Returns this guard for calls that wrote nothing so far.
    pub(super) fn afresh(&self) -> Self {
        Self { written: Arc::default(), ..self.clone() }
    }

    /// Returns this guard without waiting for other threads.
    pub(super) fn of_thread_safe(&self) -> Self {
        Self { turn: None, ..self.clone() }
    }

    /// Returns whether calls do not wait for other threads.
    pub(super) fn is_of_thread_safe(&self) -> bool {
        self.turn.is_none()
    }

    /// Returns whether invalid operations, divisions by zero and overflow trap during a call.
    pub(super) fn traps(&self) -> bool {
        self.traps
    }

    /// Returns whether a call came back with other floating-point modes than it started with.
    pub(super) fn changed_modes(&self) -> bool {
        self.changed_modes.load(Ordering::Relaxed)
    }

    /// Runs a call.
    #[inline]
    pub(super) fn run<R>(&self, call: impl FnOnce() -> R) -> R {
        let _turn = self.turn.as_deref().map(locked);
        let control = floating_point::control();
        let before = if self.traps { floating_point::with_traps(control) } else { control };
        if self.traps {
            floating_point::set_control(before);
        }
        let result = call();
        let after = floating_point::control();
        let has_changed = floating_point::modes(after) != floating_point::modes(before);
        if has_changed {
            self.changed_modes.store(true, Ordering::Relaxed);
        }
        // to write the register takes longer than to read it
        if has_changed || self.traps {
            floating_point::set_control(control);
        }
        result
    }
}

/// Runs a call; `None`: the library's metadata vouch for it.
#[inline]
pub(super) fn run<R>(guard: Option<&Guard>, call: impl FnOnce() -> R) -> R {
    match guard {
        None => call(),
        Some(guard) => guard.run(call),
    }
}
