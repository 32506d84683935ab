//! `pullout run` and `pullout check` of cases in processes of their own, and what such a process does.

use super::run::{self, Arguments};
use super::{DONE, FAILED, NO_PLUGIN, Reading, Refusal, complain, option};
use pullout_report::directory::ResultDirectory;
use pullout_report::summary::{self, PluginFile, Summary};
use pullout_run::isolation::{self, Aftermath, End, Failure, Job, Need, Task, Told};
use pullout_run::isolation::{prints, worker};
use pullout_run::program::job_folder;
use pullout_run::{replay, signals};
use serde_json::Value;
use std::ffi::OsString;
use std::io::{self, IsTerminal, Write};
use std::path::Path;
use std::time::Instant;

/// Validates a case.
pub(super) fn check(file: &Path, reading: &Reading, need: &Need, quiet: bool) -> u8 {
    carry_out(&check_line(file, reading, quiet.then_some("--quiet")), need, file, quiet)
}

/// Validates a case that is to be run: what ends the process now will end the run, and be reported then.
/// `columns`: where those of the rows are written; `told`: what was told of other cases, and is not told again.
pub(super) fn check_before_run(
    file: &Path,
    reading: &Reading,
    need: &Need,
    columns: Option<&Path>,
    told: Option<&Told>,
) -> u8 {
    let mut command = check_line(file, reading, Some("--before-run"));
    if let Some(path) = columns {
        command.insert(1, option("--columns", path));
    }
    match isolation::supervise(&Job { command: &command, told, ..Job::default() }, need) {
        Ok(End::Done(code)) => code,
        Ok(End::Failed(failure)) if failure.report.at_loading => {
            let is_new = told.is_none_or(|told| told.is_new(failure.report.message.as_bytes()));
            if is_new { fail(file, &failure, &failure.report.message) } else { NO_PLUGIN }
        }
        Ok(End::Failed(_)) => DONE,
        Err(error) => refuse_to_start(file, &error),
    }
}

/// The command line that validates a case.
fn check_line(file: &Path, reading: &Reading, flag: Option<&str>) -> Vec<OsString> {
    let mut line = vec!["check".into()];
    line.extend(flag.map(Into::into));
    line.extend(reading.command_line());
    line.extend(["--".into(), file.into()]);
    line
}

/// Says that a wish of the case is not granted.
pub(super) fn tell_of_wish(file: &Path, need: &Need, quiet: bool) {
    if need.is_against_a_wish && !quiet {
        let what = "\"isolate\": false is granted by --in-process only; its plugins run in a process of their own";
        complain(format!("{}: {what}", file.display()));
    }
}

/// Carries out a command line of this program in a worker; the exit code. `file` is what messages begin with; `quiet`:
/// only errors are reported.
pub(super) fn carry_out(line: &[OsString], need: &Need, file: &Path, quiet: bool) -> u8 {
    tell_of_wish(file, need, quiet);
    match isolation::supervise(&Job { command: line, ..Job::default() }, need) {
        Ok(End::Done(code)) => code,
        Ok(End::Failed(failure)) => fail(file, &failure, &failure.report.message),
        Err(error) => refuse_to_start(file, &error),
    }
}

/// Runs a case into a directory that this process holds.
pub(super) fn run(file: &Path, directory: ResultDirectory, arguments: &Arguments, need: &Need) -> u8 {
    let Arguments { quiet, echo, .. } = arguments;
    tell_of_wish(file, need, *quiet);
    let start = Instant::now();
    let command = arguments.of_worker(file, directory.path(), None);
    let job = Job { command: &command, echo: echo.then_some(directory.path()), ..Job::default() };
    let failure = match isolation::supervise(&job, need) {
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
    if failure.report.at_loading || (arguments.interruption.restart.is_some() && !failure.has_rows) {
        return fail(file, &failure, &failure.report.message);
    }
    match conclude(file, directory, arguments, need, &failure, start.elapsed().as_secs_f64()) {
        Ok(code) => code,
        Err(error) => {
            complain(format!("{}: {error}", file.display()));
            fail(file, &failure, &failure.report.message)
        }
    }
}

/// The case that repeats the call that ended a worker.
pub(super) fn replay(failure: &Failure, file: &Path, overrides: &[String]) -> Option<Value> {
    let mut replay = failure.replay.clone()?;
    let document = pullout_case::document(file, overrides).unwrap_or_default();
    let stem = || file.file_stem().unwrap_or_default().to_string_lossy().into_owned();
    let title = document["title"].as_str().map_or_else(stem, str::to_owned);
    replay::entitle(&mut replay, replay::OF_CALL, &title, &job_folder(file, &document));
    Some(replay)
}

/// Writes the replay case and the results of a run that was ended.
fn conclude(
    file: &Path,
    mut directory: ResultDirectory,
    arguments: &Arguments,
    need: &Need,
    failure: &Failure,
    wall_time_s: f64,
) -> io::Result<u8> {
    if failure.has_rows {
        directory.reread()?;
    } else {
        directory.begin(&[])?;
    }
    prints::remove_empty(directory.path());
    let mut message = failure.report.message.clone();
    match replay(failure, file, &arguments.reading.overrides) {
        Some(case) => {
            let replay = directory.write("replay.json", format!("{case:#}\n"))?;
            message += &format!(" (replay case: {})", replay.display());
        }
        None if failure.report.call.as_ref().is_some_and(|call| !call.arguments.is_routine()) => {
            message += " (no replay case: an argument was NaN or infinite)";
        }
        None => {}
    }
    let is_interrupted = signals::received().is_some();
    if is_interrupted {
        message = format!("{}; {message}", run::interrupted("the last row", false));
    }
    let aftermath = Aftermath {
        message: Some(message.clone()),
        is_interrupted,
        failed_at: (!is_interrupted).then(|| failure.report.failed_at()),
        statistics: failure.statistics,
        wall_time_s,
    };
    if failure.has_rows {
        let text = serde_json::to_string(&aftermath)?;
        let command = arguments.of_worker(file, directory.path(), Some(&text));
        // the worker hears of the signal too, before it tells of its end or after
        let own = signals::received().map_or(FAILED, signals::Interrupt::exit_code);
        match isolation::supervise(&Job { command: &command, ..Job::default() }, need)? {
            End::Done(code) if code == FAILED || code == own => return Ok(own),
            End::Done(_) | End::Failed(_) => {}
        }
        directory.reread()?;
    }
    directory.write(summary::FILE, summary(file, failure, aftermath)?.text()?)?;
    directory.remove_earlier()?;
    directory.finish()?;
    Ok(fail(file, failure, &message))
}

/// Returns what can be said of a run without its case.
fn summary(file: &Path, failure: &Failure, aftermath: Aftermath) -> io::Result<Summary> {
    let plugin = failure.report.library().map(|library| PluginFile::identify(library, "")).transpose()?;
    Ok(Summary {
        title: file.file_stem().unwrap_or_default().to_string_lossy().into_owned(),
        plugin: plugin.unwrap_or_default(),
        ..Summary::of(aftermath)
    })
}

fn fail(file: &Path, failure: &Failure, message: &str) -> u8 {
    complain(format!("{}: {message}", file.display()));
    match signals::received() {
        Some(signal) => signal.exit_code(),
        None if failure.report.at_loading => NO_PLUGIN,
        None => FAILED,
    }
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

/// Does what a worker is there for.
pub(super) fn work(task: &Task) -> Refusal {
    Refusal::failed(worker::work(task, || super::act_on(&task.command)))
}
