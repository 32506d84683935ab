//! Messages about causes of a worker's end, and their places.

use super::last_words::explanation;
use super::spoilt::Spoilt;
use super::{Need, trust};
use crate::path::{FailedAt, FailureKind, Statistics};
use crate::signals;
use rustix::process::Signal;
use serde::{Deserialize, Serialize};
use std::path::PathBuf;
use umat_abi::host::recorder::{CallRecord, RecordedArguments, Recording};
use umat_abi::host::{WRITTEN_FOR_SIX, library_name};

/// Cause of a worker's end.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Cause {
    /// `exit`, or STOP, with a code.
    Exit(i32),
    /// A signal.
    Signal(i32),
    /// The supervisor: a call took longer than this, s.
    TimeLimit(f64),
    /// The supervisor: a signal asked for the end, and a call did not come back in this time, s.
    Interrupted(f64),
    /// Itself: a plugin had changed the process.
    Spoilt(Spoilt),
}

/// Findings about a worker's end.
#[derive(Clone, Debug, PartialEq)]
pub struct EndReport {
    /// Message with plugin, step and increment.
    pub message: String,
    /// What happened, without the place.
    pub cause: String,
    /// Whether a library could not even be loaded.
    pub at_loading: bool,
    /// The call that did not come back, or else the last one.
    pub call: Option<CallRecord>,
    /// Whether the supervisor ended it, because a call took too long.
    pub is_timeout: bool,
    /// Whether the message has what the worker's last words say of its end.
    pub is_explained: bool,
}

/// What the results of an ended run hold in addition to the rows; one process sends it to another.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct Aftermath {
    /// Reason why the run did not reach its end.
    pub message: Option<String>,
    /// Whether a signal or another thread asked for the end.
    pub is_interrupted: bool,
    /// Kind and place of the failure.
    pub failed_at: Option<FailedAt>,
    /// Cost of the run.
    pub statistics: Statistics,
    /// Seconds from start to end.
    pub wall_time_s: f64,
}

impl EndReport {
    /// Reads what the worker left.
    pub(super) fn new(cause: Cause, recording: &Recording, need: &Need, last_words: &str) -> Self {
        let is_timeout = matches!(cause, Cause::TimeLimit(_));
        if let Some(library) = recording.loading() {
            let message = format!("{}: cannot be loaded: {}", library.display(), cause.at_loading());
            return Self {
                cause: message.clone(),
                message,
                at_loading: true,
                call: None,
                is_timeout,
                is_explained: false,
            };
        }
        let unfinished = recording.unfinished_call();
        let trespass = recording.trespass().filter(|_| matches!(cause, Cause::Signal(_)));
        let happened = match (unfinished.is_some(), cause) {
            (_, Cause::Spoilt(_)) | (true, _) => cause.within_a_call(),
            (false, _) => format!("after this call, outside any other, {}", cause.outside_a_call()),
        };
        let call = unfinished.or_else(|| recording.last_call());
        let explanation = match cause {
            Cause::Exit(_) | Cause::Signal(_) => explanation(last_words, matches!(cause, Cause::Exit(_))),
            Cause::TimeLimit(_) | Cause::Interrupted(_) | Cause::Spoilt(_) => None,
        };
        if let (Cause::Spoilt(_), Some(last)) = (cause, &call) {
            // found after the increment: any library that was not built with the program may have done it
            let suspects: Vec<_> = need.libraries.keys().filter(|library| !trust::is_shipped(library)).collect();
            if !suspects.contains(&&last.library) || suspects.len() > 1 {
                let [step, increment] = last.arguments.place();
                let names = suspects.iter().map(|library| format!("'{}'", library_name(library))).collect::<Vec<_>>();
                let which = if names.len() == 1 { "plugin" } else { "one of the plugins" };
                let message = format!("{which} {}, step {step}, increment {increment}: {happened}", names.join(", "));
                return Self {
                    message,
                    cause: happened,
                    at_loading: false,
                    call: None,
                    is_timeout,
                    is_explained: false,
                };
            }
        }
        let is_explained = explanation.is_some();
        // more state variables are needed then, not other components
        let lacks_states = trespass.as_ref().is_some_and(|trespass| trespass.argument == "STATEV");
        let happened = match trespass {
            Some(trespass) => format!("it {trespass}; the process was ended there"),
            None => explanation.map_or_else(|| happened.clone(), |words| format!("{happened}: {words}")),
        };
        let happened = match (&call, cause) {
            (Some(call), Cause::Signal(signal)) if leaves_own_arrays(call, signal) && !lacks_states => {
                format!("{happened}; {WRITTEN_FOR_SIX}")
            }
            _ => happened,
        };
        let message = match &call {
            Some(call) => format!("{}: {happened}", place(call, need)),
            None => format!("before any call of a plugin {}", cause.outside_a_call()),
        };
        Self { message, cause: happened, at_loading: false, call, is_timeout, is_explained }
    }

    /// Returns how and where it ended the run.
    pub fn failed_at(&self) -> FailedAt {
        let kind = if self.is_timeout { FailureKind::Timeout } else { FailureKind::Crashed };
        let [step, increment] = self.call.as_ref().map(|call| call.arguments.place()).unwrap_or_default();
        FailedAt { kind, step, increment }
    }

    /// Library whose call is reported.
    pub fn library(&self) -> Option<&PathBuf> {
        self.call.as_ref().map(|call| &call.library)
    }
}

/// Returns whether a signal is one that such a law may end by.
fn leaves_own_arrays(call: &CallRecord, signal: i32) -> bool {
    let plane = matches!(&call.arguments, RecordedArguments::Umat(umat) if matches!(umat.stress.len(), 3 | 4));
    let signals = [Signal::ABORT, Signal::SEGV, Signal::BUS];
    plane && !trust::is_shipped(&call.library) && signals.iter().any(|known| known.as_raw() == signal)
}

/// Plugin, routine if it is not an entry point, step, increment, and in a specimen the point.
fn place(call: &CallRecord, need: &Need) -> String {
    let [step, increment] = call.arguments.place();
    let plugin = format!("plugin '{}'", call.name);
    let material_point = |[element, point]: [i32; 2]| format!(", element {element}, integration point {point}");
    let heat = |routine: &str, [step, increment, point @ ..]: [i32; 4]| {
        format!("{plugin}, {routine}, step {step}, increment {increment}{}", material_point(point))
    };
    let contact_point = |node: i32| format!(", contact point {node}");
    let place = match &call.arguments {
        RecordedArguments::InitialState(point) => return format!("{plugin}, SDVINI{}", material_point(*point)),
        RecordedArguments::InitialStress(point) => return format!("{plugin}, SIGINI{}", material_point(*point)),
        RecordedArguments::HeatGeneration(place) => return heat("HETVAL", *place),
        RecordedArguments::HeatTransfer(place) => return heat("UMATHT", *place),
        RecordedArguments::ExternalDatabase([lop, ..]) => {
            return format!("{plugin}, UEXTERNALDB {}, step {step}, increment {increment}", occasion(*lop));
        }
        _ if !need.specimen => String::new(),
        RecordedArguments::Umat(umat) => material_point([umat.noel, umat.npt]),
        RecordedArguments::Uinter(uinter) => contact_point(uinter.node),
        RecordedArguments::Fric(fric) => contact_point(fric.node),
    };
    format!("{plugin}, step {step}, increment {increment}{place}")
}

/// Returns a description of LOP.
fn occasion(lop: i32) -> &'static str {
    match lop {
        0 => "at the start of the analysis (LOP = 0)",
        1 => "at the start of an increment (LOP = 1)",
        2 => "at the end of an increment (LOP = 2)",
        4 => "at a restart (LOP = 4)",
        5 => "at the start of a step (LOP = 5)",
        6 => "at the end of a step (LOP = 6)",
        _ => "at the end of the analysis (LOP = 3)",
    }
}

/// Returns the message about an end after the done-mark. `None`: the end was the usual one, or hurried by a signal or without a
/// library to wait for, and the results are complete.
pub(super) fn after_the_end(cause: Cause, code: u8, recording: &Recording, need: &Need) -> Option<String> {
    let is_hurried = matches!(cause, Cause::TimeLimit(_) | Cause::Interrupted(_))
        && (signals::received().is_some() || need.libraries.is_empty());
    if is_hurried || cause == Cause::Exit(code.into()) {
        return None;
    }
    let plugin = recording.last_call().map_or_else(|| "a plugin".to_owned(), |call| format!("plugin '{}'", call.name));
    let happened = cause.outside_a_call();
    Some(format!(
        "warning: {plugin}: after everything was written, {happened} (exit handlers of its library): nothing is lost"
    ))
}

impl Cause {
    fn within_a_call(self) -> String {
        match self {
            Self::Exit(code) => {
                format!(
                    "it ended the process instead of returning, exit code {code} (STOP, EXIT, or an error of its runtime)"
                )
            }
            Self::Signal(signal) => format!("it was ended by {}", signal_in_words(signal)),
            Self::TimeLimit(limit) => {
                format!("it did not return within {limit} s and was ended (material.call_time_limit_s)")
            }
            Self::Interrupted(time) => format!("it did not return within {time} s after that and was ended"),
            Self::Spoilt(spoilt) => spoilt.words(),
        }
    }

    fn outside_a_call(self) -> String {
        match self {
            Self::Exit(code) => format!("the process ended with exit code {code}"),
            Self::Signal(signal) => format!("the process was ended by {}", signal_in_words(signal)),
            Self::TimeLimit(limit) => format!("the process did not end within {limit} s"),
            Self::Interrupted(time) => format!("the process did not end within {time} s after the signal"),
            Self::Spoilt(spoilt) => format!("the process was ended: a plugin was called, and {}", spoilt.words()),
        }
    }

    fn at_loading(self) -> String {
        match self {
            Self::TimeLimit(limit) => format!("that took longer than {limit} s (material.call_time_limit_s)"),
            other => format!("{} at that moment", other.outside_a_call()),
        }
    }
}

/// Name of a signal, and what it means where a plugin causes it.
fn signal_in_words(signal: i32) -> String {
    const KNOWN: [(Signal, &str, &str); 16] = [
        (Signal::SEGV, "SIGSEGV", "an address that is not its own, or automatic arrays beyond the stack"),
        (Signal::BUS, "SIGBUS", "an address without memory"),
        (Signal::FPE, "SIGFPE", "a floating-point exception with traps on, or an integer division by zero"),
        (Signal::ILL, "SIGILL", "an instruction that this processor does not have, or a trap of the compiler"),
        (Signal::ABORT, "SIGABRT", "abort, by itself or by a runtime that found an error such as a stack overflow"),
        (Signal::KILL, "SIGKILL", "from outside; perhaps memory ran out"),
        (Signal::TERM, "SIGTERM", "from outside"),
        (Signal::INT, "SIGINT", "from outside"),
        (Signal::TRAP, "SIGTRAP", "a breakpoint"),
        (Signal::XCPU, "SIGXCPU", "the limit of CPU time"),
        (Signal::XFSZ, "SIGXFSZ", "a file beyond the limit of its size (ulimit -f)"),
        (Signal::ALARM, "SIGALRM", "a timer that it set itself"),
        (Signal::HUP, "SIGHUP", "from outside: the terminal was closed"),
        (Signal::QUIT, "SIGQUIT", "from outside"),
        (Signal::PIPE, "SIGPIPE", "nobody reads what it writes"),
        (Signal::SYS, "SIGSYS", "a system call that is not allowed"),
    ];
    match KNOWN.iter().find(|(known, ..)| known.as_raw() == signal) {
        Some((_, name, words)) => format!("signal {name} ({words})"),
        None => format!("signal {signal}"),
    }
}
