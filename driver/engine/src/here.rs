//! Runs in this process.

use super::{Outcome, Settings};
use fe_core::stepping::Recorded;
use fe_core::threads::Threads;
use pullout_case::Case;
use pullout_report::ending::{Specimen, compare_all, summarise};
use pullout_report::history::History;
use pullout_report::page;
use pullout_report::progress::{Extent, Progress};
use pullout_report::record::RunRecorder;
use pullout_report::summary::Status;
use pullout_report::viewer::States;
use pullout_run::path::{self, Statistics, Stop};
use pullout_run::pullout;
use pullout_run::pullout::checkpoint::Checkpoints;
use std::io;
use std::num::NonZeroUsize;
use std::path::Path;
use std::sync::Arc;

/// Results of a run besides its rows.
pub struct Followed<'c> {
    /// Cost of the run.
    pub statistics: Statistics,
    /// End of the run.
    pub result: Result<(), Stop>,
    /// Findings of a specimen.
    pub specimen: Option<Specimen<'c>>,
}

/// Follows a case of any kind but "bridging" to its end; fields and checkpoints, if it has any, go to `folder`.
pub fn follow<'c>(case: &'c Case, record: &mut RunRecorder, folder: &Path, checkpoints: &Checkpoints) -> Followed<'c> {
    let (statistics, result, specimen) = match case {
        Case::Bridging(_) => (Statistics::default(), Ok(()), None),
        Case::Path(program) => {
            let (statistics, result) = path::run(program, record);
            (statistics, result, None)
        }
        Case::Pullout(program) => {
            let mut outcome = pullout::run(program, folder, checkpoints, record);
            let result = std::mem::replace(&mut outcome.result, Ok(()));
            (outcome.statistics, result, Some((&**program, outcome)))
        }
    };
    record.progress.finish();
    Followed { statistics, result, specimen }
}

/// Returns how far a run goes.
pub fn extent(case: &Case) -> Extent {
    match case {
        Case::Path(program) => Extent::Increments(path::increments(program)),
        Case::Pullout(program) => Extent::Time(program.model.steps.iter().map(|step| step.time).sum()),
        Case::Bridging(_) => Extent::Increments(0),
    }
}

/// The viewer as a page of its own.
fn view((program, outcome): &Specimen<'_>, history: &History, states: &States) -> io::Result<Option<String>> {
    Ok(states.page(program, history, outcome.peak.as_ref())?.map(|viewer| page::around("Over the run", &viewer)))
}

/// Runs a case; what it would write is left out.
pub(super) fn run(case: &Case, settings: Settings) -> io::Result<Outcome> {
    let Settings { threads, stop, records, along, views, columns, listener, fields } = settings;
    let threads = threads.unwrap_or(NonZeroUsize::MIN);
    let with_own;
    let case = match case {
        Case::Pullout(program) => {
            let mut program = program.clone();
            program.threads = Threads::new(threads).map_err(io::Error::other)?;
            if fields.is_none() {
                program.fields_every = None;
            }
            // what is drawn is told of while the run goes on
            program.about.plots = views;
            program.keeps_trail = records;
            if let Some(along) = along {
                if along.trail.has_steps_of(&program.model) {
                    program.about.recorded = Some(Arc::new(along.trail.recorded.clone()));
                }
                program.along = Some(along);
            }
            with_own = Case::Pullout(program);
            &with_own
        }
        _ => case,
    };
    case.announce();
    if let Some(columns) = columns {
        columns(case.columns());
    }
    let progress = Progress::to(listener, extent(case));
    let mut record = RunRecorder::in_memory(case.columns(), progress, stop, threads == NonZeroUsize::MIN);
    record.recorded = records.then(Recorded::default);
    if views {
        record.keep_states();
    }
    let Followed { statistics, result, mut specimen } =
        follow(case, &mut record, fields.as_deref().unwrap_or(Path::new("")), &Checkpoints::default());
    let (message, failed_at, replay) = match result {
        Ok(()) if record.was_ended() => (Some(format!("told to end after {}", record.place())), None, None),
        Ok(()) => (None, None, None),
        Err(Stop::Write(error)) => return Err(error),
        Err(Stop::Failed(failure)) => {
            let failed_at = failure.place();
            (Some(failure.message), Some(failed_at), Some(failure.replay).filter(|replay| !replay.is_null()))
        }
    };
    let mut summary = summarise(case, &mut record, statistics, message, failed_at, specimen.as_mut())?;
    // those of a run that was not at its end would repeat a part of it
    let recorded = record.recorded.take().filter(|_| summary.status == Status::Done);
    let increments = recorded.map(serde_json::to_value).transpose()?;
    let trail = specimen.as_mut().and_then(|(_, outcome)| outcome.trail.take());
    let trail = trail.filter(|_| summary.status == Status::Done).map(Arc::new);
    let states = record.take_states();
    let history = record.into_history();
    summary.take_comparisons(compare_all(case, &history)?);
    let view = match specimen {
        Some(specimen) => view(&specimen, &history, &states)?,
        None => None,
    };
    Ok(Outcome { history, summary, replay, increments, trail, view, prints: String::new() })
}
