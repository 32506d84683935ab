//! Text that a worker wrote to the standard error before it ended: passed on as it comes, and its last part kept.

use std::collections::BTreeSet;
use std::io::{self, Read, Write};
use std::path::Path;
use std::process::Child;
use std::sync::mpsc::{self, Receiver};
use std::sync::{Arc, Mutex, PoisonError};
use std::thread;
use std::time::Duration;

/// Length of the part that is kept, bytes.
const KEPT: usize = 16 << 10;
/// Time for which a pipe is read after its worker has ended: a child of the worker may hold it open.
const PATIENCE: Duration = Duration::from_millis(500);

/// Lines that workers wrote, of which each is passed on once.
#[derive(Clone, Debug, Default)]
pub struct ForwardedLines(Arc<Mutex<BTreeSet<Vec<u8>>>>);

impl ForwardedLines {
    /// Returns whether no worker wrote this line before.
    pub fn is_new(&self, line: &[u8]) -> bool {
        self.0.lock().unwrap_or_else(PoisonError::into_inner).insert(line.to_vec())
    }

    /// Passes on the whole lines of a text, and leaves the rest; `is_all`: there is none.
    fn pass_on(&self, text: &mut Vec<u8>, is_all: bool) {
        let end = if is_all { Some(text.len()) } else { text.iter().rposition(|byte| *byte == b'\n').map(|at| at + 1) };
        for line in text.drain(..end.unwrap_or(0)).collect::<Vec<u8>>().split_inclusive(|byte| *byte == b'\n') {
            if self.is_new(line) {
                let _ = io::stderr().write_all(line);
            }
        }
    }
}

/// Keeps what gfortran's runtime writes when it ends a process from being passed on: the message about the end says it in one
/// line, and most of the frames are this program's.
#[derive(Debug, Default)]
struct Backtraces {
    /// A line whose end is still to come.
    line: Vec<u8>,
    /// Whether the lines before belong to such a report.
    is_within: bool,
    held: Vec<u8>,
}

impl Backtraces {
    /// Beginnings of such a report, of which the last two also follow others.
    const BEGIN: [&[u8]; 4] =
        [b"At line ", b"Fortran runtime error: ", b"Error termination. Backtrace:", b"Could not print backtrace"];

    /// Takes some text; returns what is passed on of it.
    fn pass(&mut self, text: &[u8]) -> Vec<u8> {
        let mut out = Vec::with_capacity(text.len());
        for byte in text {
            self.line.push(*byte);
            if *byte == b'\n' {
                let line = std::mem::take(&mut self.line);
                self.is_within = Self::begins(&line) || (self.is_within && Self::goes_on(&line));
                if self.is_within { self.held.extend(line) } else { out.extend(line) }
            }
        }
        // what has no end yet, as of a progress bar, waits only where it may become one
        let may_be = |mark: &&[u8]| mark.starts_with(&self.line) || self.line.starts_with(mark);
        if !self.is_within && !Self::BEGIN.iter().any(may_be) {
            out.append(&mut self.line);
        }
        out
    }

    fn begins(line: &[u8]) -> bool {
        Self::BEGIN.iter().any(|mark| line.starts_with(mark))
    }

    /// `#3  0x7f02 in umat_`, below it `at u.f:40`, blank lines.
    fn goes_on(line: &[u8]) -> bool {
        let is_frame = line.strip_prefix(b"#").is_some_and(|rest| rest.first().is_some_and(u8::is_ascii_digit));
        is_frame || line.starts_with(b"\tat ") || line.trim_ascii().is_empty()
    }

    /// All that was kept, and what came last.
    fn rest(&mut self) -> Vec<u8> {
        let mut rest = std::mem::take(&mut self.held);
        rest.append(&mut self.line);
        rest
    }
}

/// The standard error of a worker.
pub(super) struct LastWords {
    kept: Arc<Mutex<Vec<u8>>>,
    /// What was not passed on.
    backtraces: Arc<Mutex<Backtraces>>,
    /// Disconnected when all is passed on.
    end: Receiver<()>,
}

impl LastWords {
    /// Begins to listen to a worker whose standard error is a pipe; `forwarded`: lines of other workers, not passed on
    /// again.
    pub(super) fn of(child: &mut Child, forwarded: Option<&ForwardedLines>) -> Self {
        let kept = Arc::<Mutex<Vec<u8>>>::default();
        let backtraces = Arc::<Mutex<Backtraces>>::default();
        let (sender, end) = mpsc::channel();
        if let Some(mut pipe) = child.stderr.take() {
            let (kept, backtraces) = (Arc::clone(&kept), Arc::clone(&backtraces));
            let forwarded = forwarded.cloned();
            thread::spawn(move || {
                let _until_the_end = sender;
                let mut chunk = [0; 4096];
                let mut waiting = Vec::new();
                while let Ok(length @ 1..) = pipe.read(&mut chunk) {
                    let passed = backtraces.lock().unwrap_or_else(PoisonError::into_inner).pass(&chunk[..length]);
                    match &forwarded {
                        None => _ = io::stderr().write_all(&passed),
                        Some(forwarded) => {
                            waiting.extend(passed);
                            forwarded.pass_on(&mut waiting, false);
                        }
                    }
                    let mut kept = kept.lock().unwrap_or_else(PoisonError::into_inner);
                    kept.extend(&chunk[..length]);
                    let superfluous = kept.len().saturating_sub(KEPT);
                    kept.drain(..superfluous);
                }
                if let Some(forwarded) = forwarded {
                    forwarded.pass_on(&mut waiting, true);
                }
            });
        }
        Self { kept, backtraces, end }
    }

    /// Returns what was kept, once all is passed on.
    pub(super) fn heard(&self) -> String {
        let _ = self.end.recv_timeout(PATIENCE);
        String::from_utf8_lossy(&self.kept.lock().unwrap_or_else(PoisonError::into_inner)).into_owned()
    }

    /// Passes on the reports of runtime errors as well, where no message says what they say.
    pub(super) fn pass_on_all(&self) {
        let _ = io::stderr().write_all(&self.backtraces.lock().unwrap_or_else(PoisonError::into_inner).rest());
    }
}

/// Returns what the last words say of the end: the runtime's error, the line of the source, what was written over. If
/// the worker ended by `exit`, that is the error reported before.
pub(super) fn explanation(words: &str, is_exit: bool) -> Option<String> {
    let found = runtime_error(words).or_else(|| line_of_signal(words)).or_else(|| destroyed_heap(words));
    let found = found.or_else(|| line_of_stop(words));
    found.or_else(|| own_error(words).filter(|_| is_exit))
}

/// gfortran: `At line 12 of file u.f`, `Fortran runtime error: Index …`, and the routine of its backtrace.
fn runtime_error(words: &str) -> Option<String> {
    const MARK: &str = "Fortran runtime error: ";
    let (before, after) = words.rsplit_once(MARK)?;
    let error = after.lines().next()?.trim();
    let place = before.lines().rev().find_map(|line| line.strip_prefix("At line "));
    let place = place.and_then(|place| place.split_once(" of file "));
    let place = place.map(|(line, file)| (line.trim(), file.split(" (unit").next().unwrap_or(file).trim()));
    let Some((line, file)) = place else { return Some(format!("{MARK}{error}")) };
    let file = file_name(file);
    let frames = frames(after);
    let here = frames.iter().position(|(_, place)| place.starts_with(&format!("{file}:")));
    let Some(here) = here else { return Some(format!("{file}:{line}: {MARK}{error}")) };
    let (routine, callers) = (&frames[here].0, &frames[here + 1..]);
    Some(format!("{routine}, {file}:{line}{}: {MARK}{error}", called_from(callers)))
}

/// Routines of Fortran's with their places, innermost first: "#1  0x7f… in umat_" and below it "at /folder/u.f:12". Those of this
/// program are none.
fn frames(backtrace: &str) -> Vec<(String, String)> {
    let lines = backtrace.lines().map(str::trim);
    let pairs = lines.clone().zip(lines.skip(1));
    let placed = pairs.filter_map(|(frame, below)| Some((frame.split_once(" in ")?.1, below.strip_prefix("at ")?)));
    let is_foreign = |(_, place): &(&str, &str)| !place.rsplit_once(':').is_some_and(|(file, _)| file.ends_with(".rs"));
    placed.take_while(is_foreign).map(|(routine, place)| (plain(routine).to_owned(), file_name(place))).collect()
}

/// The way to a place.
fn called_from(callers: &[(String, String)]) -> String {
    callers.iter().map(|(routine, place)| format!(", called from {routine}, {place}")).collect()
}

/// ERROR STOP, whose backtrace shows the place.
fn line_of_stop(words: &str) -> Option<String> {
    let (before, after) = words.rsplit_once("Error termination. Backtrace:")?;
    let frames = frames(after);
    let [(routine, place), callers @ ..] = &*frames else { return None };
    let stop = before.lines().rev().find(|line| line.starts_with("ERROR STOP")).unwrap_or("ERROR STOP");
    Some(format!("{routine}, {place}{}: {}", called_from(callers), stop.trim()))
}

/// The handler of a library made with --debug: `***SIGNAL: SIGFPE`, and below it `umat_ at u.f:12`.
fn line_of_signal(words: &str) -> Option<String> {
    let (_, after) = words.rsplit_once("***SIGNAL: ")?;
    let (routine, place) = after.lines().find_map(|line| line.split_once(" at "))?;
    let place = place.split(" (discriminator").next().unwrap_or(place).trim();
    let heap = destroyed_heap(words).map_or_else(String::new, |heap| format!("; {heap}"));
    Some(format!("{}, {}{heap}", plain(routine.trim()), file_name(place)))
}

/// The C library, where it finds that its own numbers between the arrays were written over.
fn destroyed_heap(words: &str) -> Option<String> {
    const OVERWRITTEN: [&str; 9] = [
        "corrupted",
        "corruption",
        "free(): invalid",
        "munmap_chunk(): invalid",
        "malloc(): ",
        "realloc(): ",
        "malloc_consolidate(): ",
        "invalid next size",
        "stack smashing detected",
    ];
    let is_of_it = |line: &&str| OVERWRITTEN.iter().any(|mark| line.contains(mark));
    let line = words.lines().rev().find(is_of_it)?.trim().trim_matches('*').trim();
    Some(format!(
        "memory next to an array was overwritten (\"{line}\"): this call or an earlier one wrote past the end of an array; for Fortran, a library made by `plugin build --debug` names the array"
    ))
}

/// A message of the utility routines: XIT, STDB_ABQERR, a routine that is not offered.
fn own_error(words: &str) -> Option<String> {
    let line = words.lines().rev().find_map(|line| line.strip_prefix("***ERROR: "))?;
    Some(line.trim().to_owned())
}

/// Returns the name of a Fortran routine without the compiler's suffix.
fn plain(routine: &str) -> &str {
    routine.strip_suffix('_').unwrap_or(routine)
}

fn file_name(place: &str) -> String {
    Path::new(place).file_name().map_or_else(|| place.to_owned(), |name| name.to_string_lossy().into_owned())
}

#[cfg(test)]
mod test;
