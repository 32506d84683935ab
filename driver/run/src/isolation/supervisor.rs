//! Starts a worker and watches it.

use super::ending::{Cause, EndReport, after_the_end};
use super::last_words::{ForwardedLines, LastWords};
use super::passage::Passage;
use super::prints::{self, Echo};
use super::spoilt::Spoilt;
use super::worker::Note;
use super::{Need, child, replay, system};
use crate::path::Statistics;
use crate::signals::{self, Companion};
use rustix::process::{Pid, Signal, kill_process};
use serde_json::Value;
use std::cell::Cell;
use std::io::{self, Write};
use std::os::unix::process::{CommandExt, ExitStatusExt};
use std::path::Path;
use std::process::{Child, ExitStatus, Stdio};
use std::time::{Duration, Instant};
use umat_abi::host::recorder::{Beat, Recording};

/// Time between two looks at the heartbeat.
pub(super) const POLL: Duration = Duration::from_millis(20);
/// Time in which a call must come back once a signal has asked for the end.
const GRACE: Duration = Duration::from_secs(1);
/// Time in which a keeper must have ended what plugins started.
const PATIENCE: Duration = Duration::from_secs(3);

/// Lets gfortran's runtime write each record at once: what a plugin printed is there if it then ends the process.
const UNBUFFERED: &str = "GFORTRAN_UNBUFFERED_ALL";

/// Wishes of a supervisor.
#[derive(Clone, Copy, Debug, Default)]
pub struct Watch<'a> {
    /// The result directory, if what the plugins print there is shown as they do.
    pub echo: Option<&'a Path>,
    /// Longest time of all that it does. Where there is one, time in which it waits for a processor counts neither here nor for
    /// a call: verdicts do not depend on how busy the machine is.
    pub time_limit: Option<Duration>,
    /// Receives the processor time charged to the worker.
    pub spent: Option<&'a Cell<Duration>>,
    /// Lines that other workers wrote, which are not printed again.
    pub reported: Option<&'a ForwardedLines>,
}

/// End of a worker.
#[derive(Debug)]
pub enum End {
    /// All is done, with this exit code.
    Done(u8),
    /// A signal or an exit ended it.
    Failed(Box<WorkerFailure>),
}

/// A worker that was ended.
#[derive(Clone, Debug, PartialEq)]
pub struct WorkerFailure {
    /// Cause and place of its end.
    pub report: EndReport,
    /// A case that repeats the call, without its title ([`crate::replay::entitle`]).
    pub replay: Option<Value>,
    /// Whether the history in the result directory is this run's.
    pub has_rows: bool,
    /// Cost of the finished increments.
    pub statistics: Statistics,
    /// Calls of the check that a plugin did not survive.
    pub calls_of_check: u64,
    /// Whether the only thing that went wrong is that [`Watch::time_limit`] has passed.
    pub is_out_of_time: bool,
}

/// Runs a worker to its end, which does the work of `passage`.
///
/// # Errors
/// The worker cannot be started or watched.
pub fn supervise(passage: &mut Passage, wishes: &Watch<'_>, need: &Need) -> io::Result<End> {
    let (file, path) = system::shared_file()?;
    let recording = Recording::create(&file)?;
    let mut command = child::command(passage.hand_over(Some(&path))?)?;
    if std::env::var_os(UNBUFFERED).is_none() {
        command.env(UNBUFFERED, "y");
    }
    // a runtime error shows the routine as well
    command.env("GFORTRAN_ERROR_BACKTRACE", "y");
    // signals of the terminal are passed on
    command.stdout(prints::for_child()).stderr(Stdio::piped()).process_group(0);
    let mut child = system::spawn(command)?;
    let last_words = LastWords::of(&mut child, wishes.reported);
    let mut echo = wishes.echo.map(Echo::of);
    // before the run has begun, the files are an earlier one's
    let mut show = || match &mut echo {
        Some(echo) if recording.note(Note::Running as usize) == 1 => echo.show(),
        _ => {}
    };
    let ended = watch(&mut child, &recording, need, wishes, &mut show);
    show();
    if ended.is_err() {
        // nothing watches it any more
        let _ = end(&mut child, &recording);
    }
    let heard = last_words.heard();
    let ended = ended?;
    let is_out_of_time = matches!(ended, Watched::OutOfTime(_));
    let cause = match ended {
        Watched::Ended(status) => cause_of(status, &recording),
        Watched::Killed(limit) | Watched::OutOfTime(limit) => Cause::TimeLimit(limit),
        Watched::Interrupted => Cause::Interrupted(GRACE.as_secs_f64()),
    };
    if let Some(code) = recording.done() {
        if let Some(words) = after_the_end(cause, code, &recording, need) {
            let _ = writeln!(io::stderr(), "{words}");
        }
        last_words.pass_on_all();
        return Ok(End::Done(code));
    }
    let report = EndReport::new(cause, &recording, need, &heard);
    if !report.is_explained {
        last_words.pass_on_all();
    }
    let note = |note: Note| recording.note(note as usize);
    Ok(End::Failed(Box::new(WorkerFailure {
        replay: report.call.as_ref().and_then(|call| replay::of(call, need)),
        report,
        has_rows: note(Note::Running) == 1,
        calls_of_check: note(Note::Calls),
        is_out_of_time,
        statistics: Statistics {
            increments: note(Note::Increments),
            iterations: note(Note::Iterations),
            plugin_calls: recording.calls(),
            cutbacks: note(Note::Cutbacks),
        },
    })))
}

/// Outcome of watching a worker.
enum Watched {
    /// Ended by itself.
    Ended(ExitStatus),
    /// Was ended because one call took longer than this, s.
    Killed(f64),
    /// Was ended because all of it took longer than this, s.
    OutOfTime(f64),
    /// Was ended because a call did not come back in [`GRACE`] after a signal.
    Interrupted,
}

/// The process that calls the plugins, once it has said which it is.
fn worker(recording: &Recording) -> Option<Pid> {
    Pid::from_raw(i32::try_from(recording.note(Note::Process as usize)).ok()?)
}

/// Ends a worker, and with it its keeper and all that plugins started.
fn end(child: &mut Child, recording: &Recording) -> io::Result<()> {
    if let Some(worker) = worker(recording) {
        let _ = kill_process(worker, Signal::KILL);
        if system::wait_for(child, PATIENCE)?.is_some() {
            return Ok(());
        }
    }
    child.kill()?;
    child.wait().map(drop)
}

fn watch(
    child: &mut Child,
    recording: &Recording,
    need: &Need,
    wishes: &Watch<'_>,
    look: &mut dyn FnMut(),
) -> io::Result<Watched> {
    let mut heartbeat = Heartbeat::default();
    let (mut clock, mut last) = (Clock::default(), Instant::now());
    // Ctrl-Z before the worker is known is kept until it is: it would stop this process alone
    let _keeper = Companion::new(Pid::from_child(child));
    let mut companion = None;
    let mut passed_on = None;
    loop {
        if let Some(status) = system::wait_for(child, POLL)? {
            return Ok(Watched::Ended(status));
        }
        look();
        if let Some(worker) = worker(recording) {
            companion.get_or_insert_with(|| Companion::new(worker)).pause_if_asked();
            if let Some(interrupt) = signals::received().filter(|_| passed_on.is_none()) {
                passed_on = Some(Instant::now());
                interrupt.send(worker);
            }
        }
        let waited =
            wishes.time_limit.map_or(Duration::ZERO, |_| system::waiting_time(recording.note(Note::Process as usize)));
        let passed = clock.count(last.elapsed(), waited);
        last = Instant::now();
        if let Some(spent) = wishes.spent {
            spent.set(clock.counted);
        }
        let overdue = heartbeat.overdue(recording, need, passed);
        let watched = if let Some(limit) = overdue {
            Watched::Killed(limit)
        } else if passed_on.is_some_and(|since| since.elapsed() > GRACE) && heartbeat.longest() > GRACE {
            Watched::Interrupted
        } else if let Some(limit) = wishes.time_limit.filter(|limit| clock.counted > *limit) {
            Watched::OutOfTime(limit.as_secs_f64())
        } else {
            continue;
        };
        end(child, recording)?;
        return Ok(watched);
    }
}

/// Counts the time in which a worker had a processor, or wanted none.
#[derive(Default)]
pub(super) struct Clock {
    counted: Duration,
    /// Time that the worker waited for a processor so far, and the part of it that is still to be subtracted: the
    /// kernel reports it when the waiting is over.
    waited: Duration,
    owed: Duration,
}

impl Clock {
    /// Returns what counts of the time since the last look; `waited`: for a processor, in all.
    pub(super) fn count(&mut self, passed: Duration, waited: Duration) -> Duration {
        self.owed += waited.saturating_sub(self.waited);
        self.waited = self.waited.max(waited);
        // Where this process was stopped (Ctrl-Z), so was the worker.
        let counted = passed.saturating_sub(self.owed).min(2 * POLL);
        self.owed = self.owed.saturating_sub(passed);
        self.counted += counted;
        counted
    }
}

/// Measures how long each pending call has been pending.
#[derive(Default)]
struct Heartbeat {
    pending: Vec<(Beat, Duration)>,
    /// Time since the done-mark: exit handlers of a library are a call as well.
    leaving: Duration,
}

impl Heartbeat {
    /// How long what has lasted longest has been pending.
    fn longest(&self) -> Duration {
        self.pending.iter().map(|(_, time)| *time).max().unwrap_or_default()
    }

    /// The limit that is passed, s; `passed`: since the last look.
    fn overdue(&mut self, recording: &Recording, need: &Need, passed: Duration) -> Option<f64> {
        if recording.done().is_some() {
            self.leaving += passed;
            let is_overdue = |limit: &f64| self.leaving.as_secs_f64() > *limit || signals::received().is_some();
            return Some(need.longest_time()).filter(is_overdue);
        }
        let before = |beat: Beat| self.pending.iter().find(|(other, _)| *other == beat).map(|(_, time)| *time + passed);
        let pending: Vec<_> = recording.pending().map(|beat| (beat, before(beat).unwrap_or_default())).collect();
        self.pending = pending;
        self.pending.iter().find_map(|(beat, time)| {
            // what a call is of is read only when it lasts
            let least = need.libraries.values().copied().fold(f64::INFINITY, f64::min);
            if time.as_secs_f64() <= least {
                return None;
            }
            let limit = match recording.call(*beat) {
                Some(call) => need.time_limit(&call.library),
                None => need.longest_time(),
            };
            (time.as_secs_f64() > limit).then_some(limit)
        })
    }
}

fn cause_of(status: ExitStatus, recording: &Recording) -> Cause {
    match (Spoilt::of_number(recording.note(Note::Spoilt as usize)), status.signal()) {
        (Some(spoilt), _) => Cause::Spoilt(spoilt),
        (None, Some(signal)) => Cause::Signal(signal),
        (None, None) => Cause::Exit(status.code().unwrap_or_default()),
    }
}
