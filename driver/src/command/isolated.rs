//! `pullout run` and `pullout check` of cases in processes of their own.

use super::{DONE, FAILED, NO_PLUGIN, Refusal, complain};
use pullout_case::CaseProblem;
use pullout_engine::{CaseSource, Inspection, Job, Message, RunOptions, interrupted};
use pullout_report::directory::ResultDirectory;
use pullout_report::summary::{self, PluginFile, Summary};
use pullout_run::isolation::{self, Aftermath, End, ForwardedLines, Need, Passage, Watch, Work, WorkerFailure, prints};
use pullout_run::program::job_folder;
use pullout_run::{replay, signals};
use serde_json::Value;
use std::io::{self, IsTerminal, Write};
use std::path::Path;
use std::time::Instant;

/// Validates a case.
pub(super) fn check(inspection: &Inspection, need: &Need) -> u8 {
    carry_out(inspection, need, &inspection.case.file, inspection.quiet)
}

/// Validates a case that will be run. If a plugin ends the process now, it will end the run too, which reports it. The second
/// result is the columns of the rows, if the worker sent them. `reported`: lines about other cases, which are not repeated.
pub(super) fn check_before_run(
    case: &CaseSource,
    need: &Need,
    reported: Option<&ForwardedLines>,
) -> (u8, Option<Vec<String>>) {
    let inspection = Inspection { case: case.clone(), quiet: true, before_run: true };
    let mut columns = None;
    let ended = Passage::new(&inspection).and_then(|mut passage| {
        let ended = isolation::supervise(&mut passage, &Watch { reported, ..Watch::default() }, need)?;
        columns = passage.heard().into_iter().find_map(|message| match message {
            Message::Columns(names) => Some(names),
            Message::Row(_) | Message::Refused(_) => None,
        });
        Ok(ended)
    });
    let code = match ended {
        Ok(End::Done(code)) => code,
        Ok(End::Failed(failure)) if failure.report.at_loading => {
            let is_new = reported.is_none_or(|lines| lines.is_new(failure.report.message.as_bytes()));
            if is_new { fail(&case.file, &failure, &failure.report.message) } else { NO_PLUGIN }
        }
        Ok(End::Failed(_)) => DONE,
        Err(error) => refuse_to_start(&case.file, &error),
    };
    (code, columns)
}

/// Warns that plugins run in another process although the case says otherwise.
pub(super) fn warn_about_in_process(file: &Path, need: &Need, quiet: bool) {
    if need.is_against_a_wish && !quiet {
        let what = "\"isolate\": false needs --in-process; the plugins run in a separate process";
        complain(format!("{}: {what}", file.display()));
    }
}

/// Executes work in a worker and returns the exit code. Messages begin with `file`; `quiet`: only errors are reported.
pub(super) fn carry_out(work: &impl Work, need: &Need, file: &Path, quiet: bool) -> u8 {
    warn_about_in_process(file, need, quiet);
    match supervise(work, &Watch::default(), need) {
        Ok(End::Done(code)) => code,
        Ok(End::Failed(failure)) => fail(file, &failure, &failure.report.message),
        Err(error) => refuse_to_start(file, &error),
    }
}

/// Passes work to a worker and supervises it.
fn supervise(work: &impl Work, wishes: &Watch<'_>, need: &Need) -> io::Result<End> {
    isolation::supervise(&mut Passage::new(work)?, wishes, need)
}

/// Runs a case into a directory that this process holds.
pub(super) fn run(job: &Job, directory: ResultDirectory, need: &Need) -> u8 {
    let (file, RunOptions { quiet, echo, .. }) = (&job.case.file, &job.options);
    warn_about_in_process(file, need, *quiet);
    let start = Instant::now();
    // this process shows what is printed
    let mut silent = job.clone();
    silent.options.echo = false;
    let wishes = Watch { echo: echo.then_some(directory.path()), ..Watch::default() };
    let failure = match supervise(&silent, &wishes, need) {
        Ok(End::Done(code)) => return code,
        Ok(End::Failed(failure)) => failure,
        Err(error) => return refuse_to_start(file, &error),
    };
    if !*quiet && io::stderr().is_terminal() {
        // what a progress bar left
        let _ = write!(io::stderr(), "\r\x1b[2K");
    }
    if let Some(signal) = signals::received()
        && (failure.report.at_loading || !failure.has_rows)
    {
        complain(format!("{}: interrupted by {} before anything was done", file.display(), signal.words()));
        return signal.exit_code();
    }
    // a run that did not go on leaves what was there as it was
    if failure.report.at_loading || (job.goes_on && !failure.has_rows) {
        return fail(file, &failure, &failure.report.message);
    }
    match conclude(&silent, directory, need, &failure, start.elapsed().as_secs_f64()) {
        Ok(code) => code,
        Err(error) => {
            complain(format!("{}: {error}", file.display()));
            fail(file, &failure, &failure.report.message)
        }
    }
}

/// Returns the case that repeats the call that ended a worker.
pub(super) fn replay(failure: &WorkerFailure, case: &CaseSource) -> Option<Value> {
    let mut replay = failure.replay.clone()?;
    let (document, file) = (case.text().unwrap_or_default(), &case.file);
    let stem = || file.file_stem().unwrap_or_default().to_string_lossy().into_owned();
    let title = document["title"].as_str().map_or_else(stem, str::to_owned);
    replay::entitle(&mut replay, replay::OF_CALL, &title, &job_folder(file, &document));
    Some(replay)
}

/// Writes the replay case and the results of a run that was ended.
fn conclude(
    job: &Job,
    mut directory: ResultDirectory,
    need: &Need,
    failure: &WorkerFailure,
    wall_time_s: f64,
) -> io::Result<u8> {
    if failure.has_rows {
        directory.reread()?;
    } else {
        directory.begin(&[])?;
    }
    prints::remove_empty(directory.path());
    let mut message = Some(failure.report.message.clone());
    match replay(failure, &job.case) {
        Some(case) => {
            let replay = directory.write("replay.json", format!("{case:#}\n"))?;
            job.keep.name_replay(&mut message, &replay);
        }
        None if failure.report.call.as_ref().is_some_and(|call| !call.arguments.is_routine()) => {
            message = message.map(|message| message + " (no replay case: an argument was NaN or infinite)");
        }
        None => {}
    }
    let mut message = message.unwrap_or_default();
    let is_interrupted = signals::received().is_some();
    if is_interrupted {
        message = format!("{}; {message}", interrupted("the last row", false));
    }
    let aftermath = Aftermath {
        message: Some(message.clone()),
        is_interrupted,
        failed_at: (!is_interrupted).then(|| failure.report.failed_at()),
        statistics: failure.statistics,
        wall_time_s,
    };
    if failure.has_rows {
        let rest = Job { aftermath: Some(aftermath.clone()), folder: directory.path().to_owned(), ..job.clone() };
        // the worker receives the signal too, before or after it reports its end
        let own = signals::received().map_or(FAILED, signals::Interrupt::exit_code);
        match supervise(&rest, &Watch::default(), need)? {
            End::Done(code) if code == FAILED || code == own => return Ok(own),
            End::Done(_) | End::Failed(_) => {}
        }
        directory.reread()?;
    }
    directory.write(summary::FILE, summary(&job.case.file, failure, aftermath)?.text()?)?;
    directory.remove_earlier()?;
    directory.finish()?;
    Ok(fail(&job.case.file, failure, &message))
}

/// Returns the summary of a run whose case could not be read here.
fn summary(file: &Path, failure: &WorkerFailure, aftermath: Aftermath) -> io::Result<Summary> {
    let plugin = failure.report.library().map(|library| PluginFile::identify(library, "")).transpose()?;
    Ok(Summary {
        title: file.file_stem().unwrap_or_default().to_string_lossy().into_owned(),
        plugin: plugin.unwrap_or_default(),
        ..Summary::of(aftermath)
    })
}

fn fail(file: &Path, failure: &WorkerFailure, message: &str) -> u8 {
    if failure.report.at_loading && signals::received().is_none() {
        return Refusal::of(file, CaseProblem::library(message)).report();
    }
    complain(format!("{}: {message}", file.display()));
    signals::received().map_or(FAILED, signals::Interrupt::exit_code)
}

fn refuse_to_start(file: &Path, error: &io::Error) -> u8 {
    let file = file.display();
    complain(match error.kind() {
        _ if isolation::is_out_of_descriptors(error) => format!(
            "{file}: the system's limit of open files (ulimit -n) leaves no room for the process that calls the plugin: raise it"
        ),
        io::ErrorKind::FileTooLarge => format!(
            "{file}: the system's limit of the size of files (ulimit -f) leaves no room for what two processes share: raise \
             it, as results may need more as well"
        ),
        _ => {
            format!("{file}: no process can be started for it: {error}; --in-process calls the plugin in this process")
        }
    });
    FAILED
}
