//! `pullout run` and `pullout check` of cases in processes of their own, and what such a process does.

use super::run::{self, Telling};
use super::{DONE, FAILED, NO_PLUGIN, Reading, complain};
use crate::isolation::{self, Aftermath, End, Failure, Job, Need, Stage, Task};
use crate::isolation::{prints, worker};
use crate::output::directory::ResultDirectory;
use crate::output::summary::{PluginFile, Status, Summary};
use crate::path::Statistics;
use crate::signals;
use std::io::{self, IsTerminal, Write};
use std::path::Path;
use std::time::Instant;

/// Validates a case. `before_run`: what ends the process now will end the run, and be told then.
pub(super) fn check(file: &Path, reading: &Reading, need: &Need, before_run: bool) -> u8 {
    let job = job(Stage::Check, file, None, reading, "null", before_run);
    match isolation::supervise(&job, need) {
        Ok(End::Done(code)) => code,
        Ok(End::Failed(failure)) if before_run && !failure.report.at_loading => DONE,
        Ok(End::Failed(failure)) => fail(file, &failure, &failure.report.message),
        Err(error) => refuse_to_start(file, &error),
    }
}

/// Runs a case into a directory that this process holds.
pub(super) fn run(
    file: &Path,
    directory: ResultDirectory,
    reading: &Reading,
    need: &Need,
    overwrite: bool,
    telling: Telling,
) -> u8 {
    let Telling { quiet, echo } = telling;
    let start = Instant::now();
    let run = Job { overwrite, echo, ..job(Stage::Run, file, Some(directory.path()), reading, "null", quiet) };
    let failure = match isolation::supervise(&run, need) {
        Ok(End::Done(code)) => return code,
        Ok(End::Failed(failure)) => failure,
        Err(error) => return refuse_to_start(file, &error),
    };
    if !quiet && io::stderr().is_terminal() {
        // what a progress bar left
        let _ = write!(io::stderr(), "\r\x1b[2K");
    }
    if let Some(signal) = signals::received()
        && (failure.report.at_loading || !failure.has_rows)
    {
        complain(format!("{}: interrupted by {} before anything was done", file.display(), signal.words()));
        return signal.exit_code();
    }
    if failure.report.at_loading {
        return fail(file, &failure, &failure.report.message);
    }
    match conclude(file, directory, reading, need, &failure, start.elapsed().as_secs_f64(), quiet) {
        Ok(code) => code,
        Err(error) => {
            complain(format!("{}: {error}", file.display()));
            fail(file, &failure, &failure.report.message)
        }
    }
}

/// Writes the replay case and the results of a run that was ended.
fn conclude(
    file: &Path,
    mut directory: ResultDirectory,
    reading: &Reading,
    need: &Need,
    failure: &Failure,
    wall_time_s: f64,
    quiet: bool,
) -> io::Result<u8> {
    if failure.has_rows {
        directory.reread()?;
    } else {
        directory.begin(&[])?;
    }
    prints::remove_empty(directory.path());
    let mut message = failure.report.message.clone();
    match &failure.replay {
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
    let aftermath = Aftermath { message, is_interrupted, statistics: failure.statistics, wall_time_s };
    if failure.has_rows {
        let text = serde_json::to_string(&aftermath)?;
        let job = job(Stage::Conclude, file, Some(directory.path()), reading, &text, quiet);
        if let End::Done(FAILED) = isolation::supervise(&job, need)? {
            return Ok(signals::received().map_or(FAILED, signals::Interrupt::exit_code));
        }
        directory.reread()?;
    }
    summary(file, failure, &aftermath)?.write(&mut directory)?;
    directory.remove_earlier()?;
    directory.finish()?;
    Ok(fail(file, failure, &aftermath.message))
}

/// What can be said of a run without its case.
fn summary(file: &Path, failure: &Failure, aftermath: &Aftermath) -> io::Result<Summary> {
    let plugin = failure.report.library().map(|library| PluginFile::identify(library, "")).transpose()?;
    let Statistics { increments, iterations, plugin_calls, cutbacks } = aftermath.statistics;
    Ok(Summary {
        status: if aftermath.is_interrupted { Status::Interrupted } else { Status::Failed },
        message: Some(aftermath.message.clone()),
        title: file.file_stem().unwrap_or_default().to_string_lossy().into_owned(),
        plugin: plugin.unwrap_or_default(),
        plugins: Vec::new(),
        peaks: Default::default(),
        increments,
        iterations,
        plugin_calls,
        cutbacks,
        wall_time_s: aftermath.wall_time_s,
        cpu_time_s: None,
        compare: Vec::new(),
        specimen: None,
        warnings: Vec::new(),
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
    let advice = "\"isolate\": false calls the plugin in this process";
    complain(format!("{}: no process can be started for it: {error}; {advice}", file.display()));
    FAILED
}

fn job<'a>(
    stage: Stage,
    case: &'a Path,
    out: Option<&'a Path>,
    reading: &'a Reading,
    aftermath: &'a str,
    quiet: bool,
) -> Job<'a> {
    let Reading { overrides, plugin_paths } = reading;
    Job {
        stage,
        case: Some(case),
        out,
        overwrite: false,
        overrides,
        plugin_paths,
        aftermath,
        quiet,
        echo: false,
        command: &[],
    }
}

/// What a worker does.
pub(super) fn work(task: &Task, reading: &Reading) -> u8 {
    let Task { case, out, quiet, .. } = task;
    let [case, out] = [case, out].map(|path| path.as_deref().unwrap_or(Path::new("")));
    let done = worker::work(task, || match task.stage {
        Stage::Check => run::check_here(case, reading, *quiet),
        Stage::Command => super::act_on(&task.command),
        Stage::Run => run::run_here(case, out, reading, task.overwrite, *quiet),
        Stage::Conclude => match serde_json::from_str(&task.aftermath) {
            Ok(aftermath) => run::conclude_here(case, out, reading, &aftermath, *quiet),
            Err(error) => {
                complain(error);
                super::BAD_INPUT
            }
        },
    });
    done.unwrap_or_else(|error| {
        complain(error);
        FAILED
    })
}
