//! Runs in a child: `pullout run` into a folder of which nothing stays.

use super::{Error, Outcome, Settings, Source};
use pullout_case::{CaseErrors, CaseProblem, JsonPlace};
use pullout_report::history::History;
use pullout_report::summary::{self, Summary};
use pullout_run::input::{self, Input};
use pullout_run::isolation::{self, all_are_let_in};
use pullout_run::signals::Interrupt;
use std::fs::File;
use std::io::{self, Read, Seek, Write};
use std::path::Path;
use std::process::{Child, Command, ExitStatus, Stdio};
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};
use wait_timeout::ChildExt;

/// Time between two looks at the flag.
const POLL: Duration = Duration::from_millis(20);
/// A child that was told to end has so long to finish its increment and its results, then again to end at once.
const PATIENCE: Duration = Duration::from_millis(500);

/// Exit codes of `pullout check` and `run`: the case is wrong; its plugin cannot be loaded.
const BAD_INPUT: i32 = 2;
const NO_PLUGIN: i32 = 3;

/// A document's child reads it from here, relative to its working directory.
const STREAM: &str = "/dev/stdin";

pub(super) fn run(source: &Source, settings: &Settings) -> Result<Outcome, Error> {
    let folder = tempfile::tempdir()?;
    let [out, problems] = ["out", "problems.json"].map(|name| folder.path().join(name));
    let mut printed = tempfile::tempfile()?;
    let mut command = Command::new(isolation::program()?);
    command.args(["run", "--quiet", "--set=output.plots=false"]);
    command.arg("--parent").arg(std::process::id().to_string());
    command.args(settings.threads.map(|count| format!("--threads={count}")));
    command.args(settings.records.then_some("--record-increments"));
    command.arg("--out").arg(&out).arg("--problems").arg(&problems);
    name_case(&mut command, source)?;
    command.stdout(printed.try_clone()?).stderr(printed.try_clone()?);
    let mut child = isolation::spawn(command)?;
    let ended = wait(&mut child, &settings.stop)?;
    read(source, &out).or_else(|_| {
        if settings.stop.load(Ordering::Relaxed) {
            return Err(Error::Stopped);
        }
        // it says what is wrong
        let words = words_in(&mut printed)?;
        Err(match told(&problems).or_else(|| in_words(ended.code(), &words)) {
            Some(problems) => CaseErrors { file: source.file.clone(), problems }.into(),
            None => Error::System(io::Error::other(words.trim_end().to_owned())),
        })
    })
}

/// Reads a file that a child wrote, from its start.
fn words_in(printed: &mut File) -> io::Result<String> {
    printed.rewind()?;
    io::read_to_string(printed)
}

/// Checks a case in a child; what is wrong with it, or the columns of its rows.
pub(super) fn columns(source: &Source) -> Result<Option<Vec<String>>, Vec<CaseProblem>> {
    let ask = || -> io::Result<Result<Vec<u8>, Vec<CaseProblem>>> {
        let mut columns = tempfile::NamedTempFile::new()?;
        let wrong = tempfile::NamedTempFile::new()?;
        let mut command = Command::new(isolation::program()?);
        command.args(["check", "--before-run", "--columns"]).arg(columns.path());
        command.arg("--problems").arg(wrong.path());
        name_case(&mut command, source)?;
        let mut printed = tempfile::tempfile()?;
        command.stdout(Stdio::null()).stderr(printed.try_clone()?);
        let ended = isolation::spawn(command)?.wait()?;
        let words = words_in(&mut printed)?;
        if let Some(problems) = told(wrong.path()).or_else(|| in_words(ended.code(), &words)) {
            return Ok(Err(problems));
        }
        let mut text = Vec::new();
        columns.read_to_end(&mut text)?;
        Ok(Ok(text))
    };
    let columns = ask().map_err(|error| vec![CaseProblem::unreadable(error.to_string())])??;
    Ok(serde_json::from_slice(&columns).ok())
}

/// Returns the problems of a case that a child has written down.
fn told(file: &Path) -> Option<Vec<CaseProblem>> {
    serde_json::from_slice(&input::read(file, Input::Case).ok()?).ok()
}

/// Returns what is wrong from the words of a child that did not come to read the case: it may not write where it should, the library ends the
/// process that loads it.
fn in_words(code: Option<i32>, words: &str) -> Option<Vec<CaseProblem>> {
    let own = format!("{STREAM}: ");
    let lines = words.lines().map(|line| line.strip_prefix(&own).unwrap_or(line).to_owned());
    match code {
        Some(BAD_INPUT) => Some(lines.map(CaseProblem::unreadable).collect()),
        Some(NO_PLUGIN) => Some(lines.map(|line| CaseProblem::plugin(JsonPlace::root(), line)).collect()),
        _ => None,
    }
}

/// Names a case in a command line; a document is read from a file that the child has as its standard input.
fn name_case(command: &mut Command, source: &Source) -> io::Result<()> {
    command.args(all_are_let_in().then_some("--in-process"));
    for folder in &source.plugin_paths {
        command.arg("--plugin-path").arg(std::path::absolute(folder)?);
    }
    match source.text().filter(|_| source.document.is_some()) {
        Some(document) => {
            let folder = input::folder_of(&source.file);
            if !folder.as_os_str().is_empty() {
                command.current_dir(folder);
            }
            let mut text = tempfile::tempfile()?;
            text.write_all(document.to_string().as_bytes())?;
            text.rewind()?;
            command.arg(STREAM).stdin(text);
        }
        None => {
            command.stdin(Stdio::null());
            command.args(source.overrides.iter().map(|text| format!("--set={text}")));
            command.arg("--").arg(&source.file);
        }
    }
    Ok(())
}

/// Waits for a child, and tells it to end if the flag is set: kindly, again, and by force.
fn wait(child: &mut Child, stop: &AtomicBool) -> io::Result<ExitStatus> {
    let mut told: Option<(Instant, u32)> = None;
    loop {
        if let Some(status) = child.wait_timeout(POLL)? {
            return Ok(status);
        }
        let times = match told {
            None if stop.load(Ordering::Relaxed) => 1,
            Some((last, times)) if last.elapsed() > PATIENCE => times + 1,
            _ => continue,
        };
        told = Some((Instant::now(), times));
        if times > 2 {
            child.kill()?;
        } else {
            Interrupt::Termination.pass_on_to(child);
        }
    }
}

/// Returns what the child left.
fn read(source: &Source, out: &Path) -> io::Result<Outcome> {
    let mut summary = Summary::read(&out.join(summary::FILE))?;
    if source.document.is_some() && source.text().is_some_and(|document| document["title"].is_null()) {
        summary.title = source.file.file_stem().unwrap_or_default().to_string_lossy().into_owned();
    }
    // the folder goes, the case is handed on
    let place = format!(" (replay case: {})", out.join("replay.json").display());
    summary.message = summary.message.map(|message| message.replace(&place, ""));
    let history = History::of_run(out, |table| table.read()).unwrap_or_default();
    let json = |name: &str| serde_json::from_slice(&input::read(&out.join(name), Input::Case).ok()?).ok();
    Ok(Outcome {
        history,
        summary,
        replay: json("replay.json"),
        increments: json("increments.json"),
        trail: None,
        view: None,
    })
}
