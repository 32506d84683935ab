//! Runs in a child: a [`Job`] into a folder of which nothing stays.

use super::{CaseSource, Documents, Error, Inspection, Job, Keep, Message, Outcome, RunOptions, Settings};
use pullout_case::{CaseErrors, CaseProblem};
use pullout_report::directory::MANIFEST;
use pullout_report::history::History;
use pullout_report::plots::Spec;
use pullout_report::summary::{self, Summary};
use pullout_run::input::{self, Input};
use pullout_run::isolation::{Child, Work, prints};
use pullout_run::path::Row;
use pullout_run::signals::Interrupt;
use std::io;
use std::path::{Path, absolute};
use std::sync::atomic::Ordering;
use std::time::Duration;

/// Time that a child has to finish its increment and its results after it was asked to end; then again to end at once.
const PATIENCE: Duration = Duration::from_millis(500);

pub(super) fn run(source: &CaseSource, settings: Settings) -> Result<Outcome, Error> {
    let passing = tempfile::tempdir().map_err(unwritable)?;
    let Settings { threads, stop, records, mut columns, mut listener, fields, .. } = settings;
    let folder = absolute(fields.unwrap_or_else(|| passing.path().join("out")))?;
    let options = RunOptions { threads, record_increments: records, quiet: true, ..RunOptions::default() };
    let job = Job { keep: Keep::Passing, sends_rows: listener.is_some(), ..Job::new(placed(source)?, folder, options) };
    let mut child = start(&job, source)?;
    let mut refused = None;
    let is_stopped = || stop.load(Ordering::Relaxed);
    child.wait(&|| is_stopped().then_some(Interrupt::Termination), Some(PATIENCE), &mut |messages| {
        let mut last = None;
        for message in messages {
            match message {
                Message::Columns(names) => columns.take().into_iter().for_each(|hear| hear(names.clone())),
                Message::Row(row) => last = Some(row),
                Message::Refused(problems) => refused = Some(problems),
            }
        }
        let numbers: Vec<f64> = last.into_iter().flatten().map(|value| value.unwrap_or(f64::NAN)).collect();
        if let ([part, step, increment, values @ .., iterations], Some(hear)) = (&numbers[..], &mut listener) {
            let [step, increment, iterations] = [step, increment, iterations].map(|count| *count as u32);
            hear(*part, &Row { step, increment, values, iterations });
        }
    })?;
    read(&job.folder).or_else(|_| match refused {
        _ if is_stopped() => Err(Error::Stopped),
        Some(problems) => Err(CaseErrors { file: source.file.clone(), problems }.into()),
        None => Err(Error::System(io::Error::other(plainly(child.printed()?).trim_end().to_owned()))),
    })
}

/// Checks a case in a child. Returns the columns of its rows, or `None` if a plugin ended the process.
pub(super) fn columns(source: &CaseSource) -> Result<Option<Vec<String>>, CaseErrors> {
    let wrong = |problems| CaseErrors { file: source.file.clone(), problems };
    let ask = || -> io::Result<Vec<Message>> {
        let inspection = Inspection { case: placed(source)?, quiet: true, before_run: true };
        let mut received = Vec::new();
        start(&inspection, source)?.wait(&|| None, None, &mut |messages| received.extend(messages))?;
        Ok(received)
    };
    let received = ask().map_err(|error| wrong(vec![CaseProblem::unreadable(error.to_string())]))?;
    received.into_iter().try_fold(None, |columns, message| match message {
        Message::Columns(names) => Ok(Some(names)),
        Message::Row(_) => Ok(columns),
        Message::Refused(problems) => Err(wrong(problems)),
    })
}

/// Starts a child. For a document without a file, the child works in the folder where the file would be.
fn start(work: &impl Work, source: &CaseSource) -> io::Result<Child> {
    let folder = Some(input::folder_of(&source.file)).filter(|folder| !folder.as_os_str().is_empty());
    Child::start(work, folder.filter(|_| source.document.is_some()))
}

/// Returns a case as it is named from another folder.
fn placed(source: &CaseSource) -> io::Result<CaseSource> {
    let mut source = source.clone();
    if source.document.is_some() {
        source.file = absolute(&source.file)?;
    }
    for folder in &mut source.plugin_paths {
        *folder = absolute(&*folder)?;
    }
    Ok(source)
}

/// Says what the folder is for in which no results can be put.
fn unwritable(error: io::Error) -> io::Error {
    let folder = std::env::temp_dir();
    io::Error::other(format!(
        "{error}: what runs in a process of its own passes its results through the folder for temporary files, {}; TMPDIR names another one, \
         which can be written",
        folder.display()
    ))
}

fn plainly(text: Vec<u8>) -> String {
    String::from_utf8_lossy(&text).into_owned()
}

/// Returns what the child left.
fn read(out: &Path) -> io::Result<Outcome> {
    let summary = Summary::read(&out.join(summary::FILE))?;
    let history = History::of_run(out, |table| table.read()).unwrap_or_default();
    let mut documents = Documents::new();
    for entry in out.read_dir()?.flatten() {
        let file = entry.file_name().to_string_lossy().into_owned();
        if let Some(name) = file.strip_suffix(".json")
            && ![summary::FILE, MANIFEST].contains(&&*file)
        {
            let read = input::read(&entry.path(), Input::Case).ok().and_then(|text| serde_json::from_slice(&text).ok());
            documents.extend(read.map(|document| (name.to_owned(), document)));
        }
    }
    Ok(Outcome {
        history,
        summary,
        documents,
        trail: None,
        view: None,
        spec: Spec::of_run(out).ok(),
        prints: prints::FILES.iter().filter_map(|name| std::fs::read(out.join(name)).ok()).map(plainly).collect(),
    })
}
