//! Runs in a child: `pullout run` into a folder of which nothing stays.

use super::{Error, Outcome, Settings, Source};
use pullout_case::{CaseErrors, CaseProblem, JsonPlace};
use pullout_report::history::History;
use pullout_report::progress::Listener;
use pullout_report::summary::{self, Summary};
use pullout_run::input::{self, Input};
use pullout_run::isolation::{self, all_are_let_in, prints};
use pullout_run::path::Row;
use pullout_run::signals::Interrupt;
use std::fs::File;
use std::io::{self, Read, Seek, SeekFrom, Write};
use std::path::{Path, PathBuf};
use std::process::{Child, Command, ExitStatus, Stdio};
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};

/// Time between two looks at the flag.
const POLL: Duration = Duration::from_millis(20);
/// A child that was told to end has so long to finish its increment and its results, then again to end at once.
const PATIENCE: Duration = Duration::from_millis(500);

/// Exit codes of `pullout check` and `run`: the case is wrong; its plugin cannot be loaded.
const BAD_INPUT: i32 = 2;
const NO_PLUGIN: i32 = 3;

/// A document's child reads it from here, relative to its working directory.
const STREAM: &str = "/dev/stdin";

pub(super) fn run(source: &Source, settings: Settings) -> Result<Outcome, Error> {
    let folder = passing(tempfile::tempdir())?;
    let [out, problems, told_of] = ["out", "problems.json", "progress"].map(|name| folder.path().join(name));
    let out = settings.fields.unwrap_or(out);
    let mut printed = passing(tempfile::tempfile())?;
    let mut command = Command::new(isolation::program()?);
    command.args(["run", "--quiet", "--set=output.plots=false"]);
    command.arg("--parent").arg(std::process::id().to_string());
    command.args(settings.threads.map(|count| format!("--threads={count}")));
    command.args(settings.records.then_some("--record-increments"));
    command.arg("--out").arg(&out).arg("--problems").arg(&problems);
    let mut hearer = settings.listener.map(|listener| Hearer::new(told_of, settings.columns, listener));
    command.args(hearer.iter().flat_map(|hearer| ["--progress-to".as_ref(), hearer.file.as_os_str()]));
    name_case(&mut command, source)?;
    command.stdout(printed.try_clone()?).stderr(printed.try_clone()?);
    let mut child = isolation::spawn(command)?;
    let ended = wait(&mut child, &settings.stop, &mut || hearer.iter_mut().for_each(Hearer::hear))?;
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
        let mut columns = passing(tempfile::NamedTempFile::new())?;
        let wrong = passing(tempfile::NamedTempFile::new())?;
        let mut command = Command::new(isolation::program()?);
        command.args(["check", "--before-run", "--columns"]).arg(columns.path());
        command.arg("--problems").arg(wrong.path());
        name_case(&mut command, source)?;
        let mut printed = passing(tempfile::tempfile())?;
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
    command.args(source.is_untrusted.then_some("--untrusted"));
    for folder in &source.plugin_paths {
        command.arg("--plugin-path").arg(std::path::absolute(folder)?);
    }
    match source.text().filter(|_| source.document.is_some()) {
        Some(document) => {
            let folder = input::folder_of(&source.file);
            if !folder.as_os_str().is_empty() {
                command.current_dir(folder);
            }
            let mut text = passing(tempfile::tempfile())?;
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

/// A temporary file or folder by which a child and this process pass things.
fn passing<T>(made: io::Result<T>) -> io::Result<T> {
    let why = |error: io::Error| {
        let folder = std::env::temp_dir();
        io::Error::other(format!(
            "{error}: what runs in a process of its own passes its results through the folder for temporary files, {}; TMPDIR names another one, \
             which can be written",
            folder.display()
        ))
    };
    made.map_err(why)
}

/// Reader of the progress that a child writes down: the columns, then rows with the part that is done in front, a line each, as JSON.
struct Hearer {
    file: PathBuf,
    read: u64,
    columns: Option<Box<dyn FnOnce(Vec<String>) + Send>>,
    listener: Listener,
}

impl Hearer {
    fn new(file: PathBuf, columns: Option<Box<dyn FnOnce(Vec<String>) + Send>>, listener: Listener) -> Self {
        Self { file, read: 0, columns, listener }
    }

    /// Tells what is new: the last row.
    fn hear(&mut self) {
        let mut text = String::new();
        let mut read = || -> io::Result<usize> {
            let mut file = File::open(&self.file)?;
            file.seek(SeekFrom::Start(self.read))?;
            file.read_to_string(&mut text)
        };
        let Some(end) = read().ok().and_then(|_| text.rfind('\n')) else { return };
        let mut lines = text[..end].lines();
        if self.read == 0
            && let Some(names) = lines.next().and_then(|line| serde_json::from_str(line).ok())
            && let Some(columns) = self.columns.take()
        {
            columns(names);
        }
        self.read += end as u64 + 1;
        let row = lines.next_back().and_then(|line| serde_json::from_str::<Vec<Option<f64>>>(line).ok());
        let numbers: Vec<f64> = row.into_iter().flatten().map(|value| value.unwrap_or(f64::NAN)).collect();
        if let [part, step, increment, values @ .., iterations] = &numbers[..] {
            let [step, increment, iterations] = [step, increment, iterations].map(|count| *count as u32);
            (self.listener)(*part, &Row { step, increment, values, iterations });
        }
    }
}

/// Waits for a child, and tells it to end if the flag is set: kindly, again, and by force. Now and then, and at the end, something is done.
fn wait(child: &mut Child, stop: &AtomicBool, meanwhile: &mut dyn FnMut()) -> io::Result<ExitStatus> {
    let mut told: Option<(Instant, u32)> = None;
    loop {
        let ended = isolation::wait_for(child, POLL)?;
        meanwhile();
        if let Some(status) = ended {
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

fn plainly(text: Vec<u8>) -> String {
    String::from_utf8_lossy(&text).into_owned()
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
        prints: prints::FILES.iter().filter_map(|name| std::fs::read(out.join(name)).ok()).map(plainly).collect(),
    })
}
