//! Runs in this process.

use super::{Documents, INCREMENTS, Job, Keep, Message, Outcome, REPLAY, Settings};
use fe_core::stepping::Recorded;
use fe_core::threads::Threads;
use pullout_case::Case;
use pullout_report::bridging;
use pullout_report::directory::{Access, Kind, ResultDirectory};
use pullout_report::ending::{SpecimenRun, compare_all, conclude, summarise};
use pullout_report::history::History;
use pullout_report::page;
use pullout_report::plots::Spec;
use pullout_report::progress::{Extent, Progress};
use pullout_report::record::{Kept, RunRecorder, cpu_time};
use pullout_report::summary::{Status, Summary};
use pullout_report::viewer::ViewerStates;
use pullout_run::bridging::{BridgingProgram, complete};
use pullout_run::isolation::prints::Prints;
use pullout_run::isolation::{send, worker};
use pullout_run::path::{self, Statistics, Stop};
use pullout_run::pullout::checkpoint::{self, Checkpoints};
use pullout_run::{pullout, signals};
use std::collections::BTreeMap;
use std::io;
use std::num::NonZeroUsize;
use std::sync::Arc;
use std::time::Instant;

/// State of an earlier run with which a restarted one goes on.
const KEPT: [&str; 7] =
    ["history.csv", checkpoint::FILE, "fields.pvd", "fields/#.vtu", "fields/contact_#.vtu", "umat.log", "umat.msg"];

/// Returns how far a run goes.
fn extent(case: &Case) -> Extent {
    match case {
        Case::Path(program) => Extent::Increments(path::increments(program)),
        Case::Pullout(program) => Extent::Time(program.model.steps.iter().map(|step| step.time).sum()),
        Case::Bridging(_) => Extent::Increments(0),
    }
}

/// Returns the message about a run that was asked to end, with the place it had reached.
pub fn interrupted(place: &str, has_checkpoints: bool) -> String {
    let Some(signal) = signals::received() else { return format!("asked to end after {place}") };
    let go_on = if has_checkpoints { "; --restart goes on from its last checkpoint" } else { "" };
    format!("interrupted by {} after {place}: what was done so far is kept{go_on}", signal.words())
}

/// A run that has ended; its rows are in the record.
struct Ended<'c> {
    record: RunRecorder,
    summary: Summary,
    specimen: Option<SpecimenRun<'c>>,
    documents: Documents,
    /// Rows or fields that could not be written.
    unwritten: Option<io::Error>,
}

/// Follows a case of any kind but "bridging" to its end. `settings`: those of a specimen; `records`: its increments are kept.
fn carry_out<'c>(
    case: &'c Case,
    mut record: RunRecorder,
    records: bool,
    settings: &pullout::SpecimenSettings<'_>,
) -> io::Result<Ended<'c>> {
    record.recorded = records.then(Recorded::default);
    let (statistics, result, mut specimen) = match case {
        Case::Bridging(_) => (Statistics::default(), Ok(()), None),
        Case::Path(program) => {
            let (statistics, result) = path::run(program, &mut record);
            (statistics, result, None)
        }
        Case::Pullout(program) => {
            let mut outcome = pullout::run(program, settings, &mut record);
            let result = std::mem::replace(&mut outcome.result, Ok(()));
            (outcome.statistics, result, Some((&**program, outcome)))
        }
    };
    record.progress.finish();
    match &result {
        // it may be a plugin that took the right to write
        Err(Stop::Write(_)) => worker::end_if_spoilt(),
        _ => worker::look_after_plugins(),
    }
    let (mut failed_at, mut documents, mut unwritten) = (None, Documents::new(), None);
    let message = match result {
        Ok(()) => record.was_ended().then(|| interrupted(&record.place(), settings.checkpoints.every.is_some())),
        Err(Stop::Write(error)) => {
            let message = format!("{}: {error}", record.place());
            unwritten = Some(error);
            Some(message)
        }
        Err(Stop::Failed(failure)) => {
            failed_at = Some(failure.place());
            documents.extend((!failure.replay.is_null()).then_some((REPLAY.to_owned(), failure.replay)));
            Some(failure.message)
        }
    };
    let summary = summarise(case, &mut record, statistics, message, failed_at, specimen.as_mut())?;
    // those of a run that was not at its end would repeat a part of it
    if let Some(recorded) = record.recorded.take().filter(|_| summary.status == Status::Done) {
        documents.insert(INCREMENTS.to_owned(), serde_json::to_value(recorded)?);
    }
    Ok(Ended { record, summary, specimen, documents, unwritten })
}

/// Returns a listener that sends rows to the process that started this one.
fn row_sender(columns: Vec<String>) -> pullout_report::progress::Listener {
    send(&Message::Columns(columns));
    Box::new(|part, row| {
        let place = [row.step, row.increment].map(f64::from);
        let numbers =
            [part].into_iter().chain(place).chain(row.values.iter().copied()).chain([f64::from(row.iterations)]);
        send(&Message::Row(numbers.map(|value| Some(value).filter(|value| value.is_finite())).collect()));
    })
}

/// Runs a case of any kind but "bridging" into a folder. The second result is what could not be written. `warnings`: what the
/// options of the job bring with them.
///
/// # Errors
/// Nothing can be written at all.
pub fn run_into(
    case: &Case,
    job: &Job,
    directory: &mut ResultDirectory,
    threads: Threads,
    checkpoints: &Checkpoints,
    warnings: Vec<String>,
) -> io::Result<(Summary, io::Result<()>)> {
    let kept = checkpoints.from.as_deref().and_then(Kept::of);
    directory.begin(if kept.is_some() { &KEPT } else { &[] })?;
    // a plugin may change the folder in which this process works
    let folder = std::path::absolute(directory.path())?;
    let draws = job.keep.draws(case);
    case.announce();
    let prints = Prints::keep(&folder, job.options.echo)?;
    let columns = case.columns();
    let history = folder.join("history.csv");
    worker::note_start();
    let progress = match job.sends_rows {
        true => Progress::to(Some(row_sender(columns.clone())), extent(case)),
        false => Progress::of(case, extent(case), job.options.quiet),
    };
    let mut record = match kept {
        None => RunRecorder::new(&history, &columns, progress, checkpoints.every.is_some())?,
        Some(kept) => RunRecorder::resume(&history, &columns, progress, kept)?,
    };
    record.warnings = warnings;
    let folder = Some(&*folder);
    let settings =
        pullout::SpecimenSettings { threads, folder, checkpoints, pictures: draws, keeps_trail: false, along: None };
    let ended = carry_out(case, record, job.options.record_increments, &settings)?;
    let Ended { mut record, mut summary, specimen, documents, unwritten: _ } = ended;
    // what plugins printed is complete before the results are listed
    drop(prints);
    for (name, document) in documents {
        let (is_replay, file) = (name == REPLAY, format!("{name}.json"));
        // a replay is read by people
        let text = if is_replay { format!("{document:#}\n") } else { document.to_string() };
        let written = directory.write(&file, text)?;
        if is_replay {
            job.keep.name_replay(&mut summary.message, &written);
        }
    }
    conclude(case, directory, summary, specimen.as_ref(), &record.take_states(), draws)
}

impl Keep {
    /// Returns whether pictures of a case are drawn.
    pub fn draws(self, case: &Case) -> bool {
        self != Self::Passing && case.about().plots
    }

    /// Says in a message where the replay case stands, if it stays there.
    pub fn name_replay(self, message: &mut Option<String>, replay: &std::path::Path) {
        if let Some(message) = message.as_mut().filter(|_| self != Self::Passing) {
            *message += &format!(" (replay case: {})", replay.display());
        }
    }
}

/// The viewer as a page of its own.
fn view((program, outcome): &SpecimenRun<'_>, history: &History, states: &ViewerStates) -> io::Result<Option<String>> {
    Ok(states.page(program, history, outcome.peak.as_ref())?.map(|viewer| page::around("Over the run", &viewer)))
}

/// Runs a case of kind "bridging", whose tables pass through a folder of which nothing stays.
fn run_bridging(case: &Case, program: &BridgingProgram, threads: NonZeroUsize) -> io::Result<Outcome> {
    let folder = tempfile::tempdir()?;
    let mut directory = ResultDirectory::open(folder.path(), Kind::Run, Access::default())?;
    directory.begin(&[])?;
    let (start, cpu_start) = (Instant::now(), cpu_time());
    let done = complete(program, None, threads);
    let times = [start.elapsed().as_secs_f64(), (cpu_time() - cpu_start).as_secs_f64()];
    let done = done.as_ref().map(|(composite, results)| (program, composite, results)).map_err(Clone::clone);
    let (summary, written) = bridging::conclude(case, &mut directory, done, times, false)?;
    written?;
    let history = History::of_run(folder.path(), |table| table.read()).unwrap_or_default();
    let spec = Some(Spec::of(case, BTreeMap::new()));
    let (documents, trail, view) = (Documents::new(), None, None);
    Ok(Outcome { history, summary, documents, trail, view, spec, prints: String::new() })
}

/// Runs a case in memory; what it would write but fields is left out.
pub(super) fn run(case: &Case, settings: Settings) -> io::Result<Outcome> {
    let Settings { threads, stop, records, along, views, columns, listener, fields } = settings;
    // a point is the work of one: others would wait
    let threads = threads.filter(|_| !matches!(case, Case::Path(_))).unwrap_or(NonZeroUsize::MIN);
    case.announce();
    if let Some(columns) = columns {
        columns(case.columns());
    }
    if let Case::Bridging(program) = case {
        return run_bridging(case, program, threads);
    }
    let progress = Progress::to(listener, extent(case));
    let mut record = RunRecorder::in_memory(case.columns(), progress, stop, threads == NonZeroUsize::MIN);
    if views {
        record.keep_states();
    }
    let ended = Threads::within(threads, |threads| {
        let settings = pullout::SpecimenSettings {
            threads,
            folder: fields.as_deref(),
            checkpoints: &Checkpoints::default(),
            // pictures need states that are reported during the run
            pictures: views,
            keeps_trail: records,
            along,
        };
        carry_out(case, record, records, &settings)
    });
    let ended = ended.map_err(io::Error::other)??;
    let Ended { mut record, mut summary, mut specimen, documents, unwritten } = ended;
    if let Some(error) = unwritten {
        return Err(error);
    }
    let trail = specimen.as_mut().and_then(|(_, outcome)| outcome.trail.take());
    let trail = trail.filter(|_| summary.status == Status::Done).map(Arc::new);
    let states = record.take_states();
    let history = record.into_history();
    summary.take_comparisons(compare_all(case, &history)?);
    let view = match specimen {
        Some(specimen) => view(&specimen, &history, &states)?,
        None => None,
    };
    let spec = Some(Spec::of(case, BTreeMap::new()));
    Ok(Outcome { history, summary, documents, trail, view, spec, prints: String::new() })
}
