//! Runs what has to be run, each in a process of its own, so many at a time.

use super::{Study, StudyRun};
use pullout_engine::{Job, Keep, Message, RunOptions};
use pullout_report::directory::{Kind, ResultDirectory};
use pullout_report::summary::{Status, Summary};
use pullout_run::in_threads;
use pullout_run::input::{self, Input};
use pullout_run::isolation::Child;
use pullout_run::signals;
use serde::{Deserialize, Serialize};
use std::fs;
use std::io;
use std::num::NonZeroUsize;
use std::panic::resume_unwind;
use std::path::Path;
use std::sync::Mutex;
use std::sync::atomic::{AtomicUsize, Ordering};

/// File in a result directory that says which case it is of.
const MARK: &str = "run.json";
/// File in a result directory with what the run printed, if it printed anything.
const PRINTED: &str = "output.txt";

/// Settings of a study's execution.
#[derive(Clone, Debug)]
pub struct Execution<'a> {
    /// The study's directory.
    pub out: &'a Path,
    /// Most processes at a time.
    pub jobs: usize,
    /// Threads of each.
    pub threads: usize,
    /// SERIES, SERIES/LABEL or */LABEL: these are run in any case and no others; empty: all, as far as it is needed.
    pub only: &'a [String],
    /// Run again what is done already.
    pub force: bool,
    /// Keep what failed: it would fail again.
    pub keep_failed: bool,
    /// Replace what stands in the way in result directories.
    pub overwrite: bool,
}

/// Outcome of a run.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum RunOutcome {
    /// Run, with this exit code.
    Ran(u8),
    /// Results were there.
    Kept,
    /// Not run, because other runs were requested.
    NotRun,
}

/// File in a result directory that marks the run as finished.
#[derive(Debug, Serialize, Deserialize)]
struct Mark {
    /// Arguments with which `pullout run` was called.
    arguments: Vec<String>,
    /// Fingerprint of everything that the results depend on.
    fingerprint: String,
}

impl Execution<'_> {
    /// Returns whether a run is asked for.
    pub fn wants(&self, study: &Study, run: &StudyRun) -> bool {
        let (series, member) = (&study.series[run.series].name, &study.members[run.member].label);
        self.only.is_empty()
            || self.only.iter().any(|wanted| {
                let (of_series, of_member) = wanted.split_once('/').unwrap_or((wanted, "*"));
                (of_series == "*" || of_series == series) && (of_member == "*" || of_member == member)
            })
    }

    /// Returns what becomes of a run if nothing more is run.
    fn present(&self, study: &Study, run: &StudyRun) -> Option<RunOutcome> {
        let folder = self.out.join(&run.folder);
        let is_its_own = input::read(&folder.join(MARK), Input::Result)
            .ok()
            .and_then(|text| serde_json::from_slice::<Mark>(&text).ok())
            .is_some_and(|mark| mark.fingerprint == run.fingerprint);
        let summary = is_its_own.then(|| Summary::read(&folder.join("summary.json")).ok()).flatten();
        let is_done = summary.as_ref().is_some_and(|summary| match summary.status {
            Status::Done => true,
            Status::Failed => self.keep_failed,
            Status::Interrupted => false,
        });
        let again = self.force || !self.only.is_empty();
        match self.wants(study, run) {
            false => Some(if summary.is_some() { RunOutcome::Kept } else { RunOutcome::NotRun }),
            true if is_done && !again => Some(RunOutcome::Kept),
            true => None,
        }
    }

    /// Returns whether a run has to be run.
    pub fn is_due(&self, study: &Study, run: &StudyRun) -> bool {
        self.present(study, run).is_none()
    }

    fn run(&self, run: &StudyRun) -> io::Result<u8> {
        let folder = self.out.join(&run.folder);
        fs::create_dir_all(&folder)?;
        let mut arguments = vec![run.case.file.display().to_string()];
        arguments.extend(run.case.overrides.iter().map(|text| format!("--set={text}")));
        let (threads, overwrite) = (NonZeroUsize::new(self.threads), self.overwrite);
        let options = RunOptions { threads, overwrite, quiet: true, ..RunOptions::default() };
        let job = Job { keep: Keep::Member, ..Job::new(run.case.clone(), folder.clone(), options) };
        let mut child = Child::start(&job, None)?;
        let status = child.wait(&signals::received, None, &mut |_: Vec<Message>| {})?;
        let printed = child.printed()?;
        let mut directory = ResultDirectory::join(&folder, Kind::Member)?;
        if !printed.is_empty() {
            directory.write(PRINTED, printed)?;
        }
        // a signal has no exit code
        let code = status.code().and_then(|code| u8::try_from(code).ok()).unwrap_or(1);
        if is_refused(code) {
            // what is there is of an earlier run
            directory.finish()?;
            return Ok(code);
        }
        let mark = Mark { arguments, fingerprint: run.fingerprint.clone() };
        directory.write(MARK, format!("{}\n", serde_json::to_string_pretty(&mark)?))?;
        directory.finish()?;
        Ok(code)
    }
}

/// Returns whether an exit code says that nothing was run.
pub(super) fn is_refused(code: u8) -> bool {
    matches!(code, 2 | 3)
}

/// Runs what is asked for and not there yet. `finished` hears of each run that was started when it is over (how many, of
/// how many).
///
/// # Errors
/// Directories that cannot be written, processes that cannot be started. The others run nevertheless.
pub fn execute(
    study: &Study,
    execution: &Execution<'_>,
    finished: &(dyn Fn(&StudyRun, u8, usize, usize) + Sync),
) -> io::Result<Vec<RunOutcome>> {
    let states: Vec<Option<RunOutcome>> = study.runs.iter().map(|run| execution.present(study, run)).collect();
    let due: Vec<usize> = (0..states.len()).filter(|&index| states[index].is_none()).collect();
    let (next, over) = (AtomicUsize::new(0), AtomicUsize::new(0));
    let ended: Mutex<Vec<(usize, io::Result<u8>)>> = Mutex::new(Vec::new());
    let work = || {
        while signals::received().is_none()
            && let Some(&index) = due.get(next.fetch_add(1, Ordering::Relaxed))
        {
            let run = &study.runs[index];
            let code = execution.run(run);
            let count = over.fetch_add(1, Ordering::Relaxed) + 1;
            finished(run, *code.as_ref().unwrap_or(&1), count, due.len());
            if let Ok(mut ended) = ended.lock() {
                ended.push((index, code));
            }
        }
    };
    for ended in in_threads((0..execution.jobs.clamp(1, due.len().max(1))).map(|_| work)) {
        ended?.unwrap_or_else(|panic| resume_unwind(panic));
    }
    let mut states: Vec<RunOutcome> = states.into_iter().map(|state| state.unwrap_or(RunOutcome::NotRun)).collect();
    for (index, code) in ended.into_inner().unwrap_or_default() {
        let name = study.name_of(&study.runs[index]);
        states[index] = RunOutcome::Ran(
            code.map_err(|error| io::Error::new(error.kind(), format!("{name}: cannot be run: {error}")))?,
        );
    }
    Ok(states)
}
