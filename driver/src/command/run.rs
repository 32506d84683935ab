//! `pullout run` and `pullout check`.

use super::{BAD_INPUT, DONE, FAILED, Reading, Refusal, complain, isolated, option, study};
use fe_core::stepping::Recorded;
use fe_core::threads::Threads;
use pullout_case::Case;
use pullout_engine::{Followed, extent, follow};
use pullout_report::directory::{Access, Kind, ResultDirectory};
use pullout_report::ending::{conclude, summarise, summarise_rows};
use pullout_report::outcome;
use pullout_report::progress::{self, Progress};
use pullout_report::record::{Kept, RunRecorder};
use pullout_report::summary::{Status, Summary};
use pullout_report::viewer::States;
use pullout_run::isolation::prints::{Prints, say};
use pullout_run::isolation::{Need, worker};
use pullout_run::path::Stop;
use pullout_run::pullout::checkpoint::{self, Checkpoints};
use pullout_run::signals;
use std::collections::BTreeSet;
use std::ffi::OsString;
use std::io;
use std::num::NonZeroUsize;
use std::path::{Path, PathBuf};

mod bridging;
mod interruption;

pub(super) use interruption::Interruption;

/// Settings for running cases.
#[derive(Debug, clap::Args)]
pub(super) struct Arguments {
    /// Case files.
    #[arg(required = true, value_name = "CASE.json")]
    cases: Vec<PathBuf>,
    /// Result directory (of several cases: their parent).
    #[arg(short, long, value_name = "DIR")]
    out: Option<PathBuf>,
    /// Replace files in the result directory that this program did not write, or that were changed since; they are listed.
    #[arg(long)]
    overwrite: bool,
    #[command(flatten)]
    pub(super) reading: Reading,
    #[command(flatten)]
    pub(super) interruption: Interruption,
    /// Threads that share the work of a case of kind "pullout"; default: the number of processors. The results have the
    /// same bits with any number.
    #[arg(long, value_name = "N", value_parser = at_least_one, allow_negative_numbers = true)]
    threads: Option<NonZeroUsize>,
    /// Write increments.json: what a case that repeats the increments of this run names as "increments": {"recorded": FILE}.
    #[arg(long, conflicts_with = "restart")]
    record_increments: bool,
    /// Say nothing but errors.
    #[arg(long)]
    pub(super) quiet: bool,
    /// Show what the plugins print (Fortran's units 6 and 7, printf), which is kept in umat.log and umat.msg of the
    /// result directory.
    #[arg(long)]
    pub(super) echo: bool,
    /// End with this process; a study says so to its runs.
    #[arg(long, hide = true)]
    pub(super) parent: Option<u32>,
    /// Write the columns, and now and then the part that is done with the present row, into this file, a line of JSON each.
    #[arg(long, hide = true)]
    progress_to: Option<PathBuf>,
    /// Aftermath of the run of a worker that was ended, as JSON: nothing is run, the results are made of its rows.
    #[arg(long, hide = true)]
    aftermath: Option<String>,
}

/// Number of threads.
fn at_least_one(text: &str) -> Result<NonZeroUsize, String> {
    text.parse().map_err(|_| "a number from 1 on is needed".into())
}

impl Arguments {
    /// The command line of a worker that runs a case into a folder, or makes results of what a run left there.
    pub(super) fn of_worker(&self, file: &Path, folder: &Path, aftermath: Option<&str>) -> Vec<OsString> {
        let mut line: Vec<OsString> = vec!["run".into()];
        line.push(match &self.interruption.restart {
            Some(restart) => option("--restart", restart),
            None => option("--out", folder),
        });
        line.extend(self.interruption.checkpoint_every.map(|every| format!("--checkpoint-every={every}").into()));
        line.extend(self.overwrite.then(|| "--overwrite".into()));
        line.extend(self.record_increments.then(|| "--record-increments".into()));
        line.extend(self.quiet.then(|| "--quiet".into()));
        line.extend(self.threads.map(|count| format!("--threads={count}").into()));
        line.extend(self.parent.map(|parent| format!("--parent={parent}").into()));
        line.extend(self.progress_to.iter().map(|file| option("--progress-to", file)));
        line.extend(aftermath.map(|text| format!("--aftermath={text}").into()));
        line.extend(self.reading.command_line());
        line.extend(["--".into(), file.into()]);
        line
    }

    /// Returns what the results are part of: a study has something to add to those of its runs.
    fn kind(&self) -> Kind {
        if self.parent.is_some() { Kind::Member } else { Kind::Run }
    }
}

/// Validates cases. `quiet`: says nothing but errors; `before_run`: leaves to the run what belongs to it; `columns`: where
/// those of the rows are written.
pub(super) fn check(cases: &[PathBuf], reading: &Reading, quiet: bool, before_run: bool, columns: Option<&Path>) -> u8 {
    let check = |file: &PathBuf| match reading.need(file) {
        _ if pullout_case::is_study(file) => study::check(file, reading, quiet),
        Some(need) if columns.is_some() => isolated::check_before_run(file, reading, &need, columns, None),
        Some(need) => isolated::check(file, reading, &need, quiet),
        None => check_here(file, reading, quiet, before_run, columns).unwrap_or_else(Refusal::told),
    };
    cases.iter().map(check).max().unwrap_or(DONE)
}

/// Validates a case in this process.
fn check_here(
    file: &Path,
    reading: &Reading,
    quiet: bool,
    before_run: bool,
    columns: Option<&Path>,
) -> Result<u8, Refusal> {
    let case = reading.case(file)?;
    if let Some(path) = columns {
        let text = serde_json::json!(case.columns_of_numbers()).to_string();
        std::fs::write(path, text).map_err(|error| Refusal::failed(format!("{}: {error}", path.display())))?;
    }
    if !before_run {
        let _prints = Prints::discard();
        case.check_laws()?;
    }
    if !quiet {
        say(&format!("{}: no errors\n", file.display()));
        // the standard output has a line for each case
        case.about().defaults.iter().for_each(|line| complain(format!("{}: by default, {line}", file.display())));
        case.about().warnings.iter().for_each(|warning| complain(format!("{}: warning: {warning}", file.display())));
    }
    Ok(DONE)
}

/// A case that is to be run.
enum Job<'f> {
    Here(Box<Case>, Checkpoints),
    Isolated { file: &'f Path, need: Need },
}

/// Amount of a run that the user wants to see.
#[derive(Clone, Copy, Debug)]
struct Telling<'f> {
    /// Errors alone.
    quiet: bool,
    /// Prints of the plugins as well.
    echo: bool,
    /// The increments in a file.
    records: bool,
    /// File for the progress, if there is one.
    progress_to: Option<&'f Path>,
}

impl Job<'_> {
    /// The libraries that it calls.
    fn libraries(&self) -> Vec<PathBuf> {
        match self {
            Self::Here(case, _) => case.libraries(),
            Self::Isolated { need, .. } => need.libraries.keys().cloned().collect(),
        }
    }
}

/// Runs cases, after all of them were read without an error.
pub(super) fn run(arguments: &Arguments) -> u8 {
    let Arguments { cases, reading, interruption, quiet, echo, .. } = arguments;
    if interruption.restart.is_some() && cases.len() > 1 {
        complain("--restart goes on with one run: name its case alone");
        return BAD_INPUT;
    }
    if interruption.restart.is_some() && reading.untrusted {
        complain("--restart goes on with a state that is believed: with --untrusted, run the case from its start");
        return BAD_INPUT;
    }
    let threads = arguments.threads.unwrap_or_else(super::processors);
    let threads = match Threads::new(threads) {
        Ok(threads) => threads,
        Err(error) => {
            complain(format!("--threads {threads}: {error}"));
            return BAD_INPUT;
        }
    };
    let mut folders = BTreeSet::new();
    let mut jobs = Vec::new();
    let mut code = DONE;
    for file in cases {
        let asked_for = arguments.out.as_deref().or(interruption.restart.as_deref());
        let folder = super::folder_of(file, asked_for, cases.len() == 1);
        if let Some(aftermath) = &arguments.aftermath {
            return conclude_here(file, &folder, arguments, aftermath).unwrap_or_else(Refusal::told);
        }
        if !folders.insert(folder.clone()) {
            complain(format!("{}: another case has the same name, and so the same result directory", file.display()));
            code = code.max(BAD_INPUT);
        }
        match reading.need(file) {
            Some(need) => {
                // nothing is run before all cases were read; a single one is read by the worker that runs it
                if cases.len() > 1 {
                    code = code.max(isolated::check_before_run(file, reading, &need, None, None));
                }
                if let Err(message) = interruption.suits(need.specimen) {
                    complain(format!("{}: {message}", file.display()));
                    code = code.max(BAD_INPUT);
                }
                jobs.push((Job::Isolated { file, need }, file, folder));
            }
            None => match reading.case(file) {
                Ok(mut case) => match interruption.checkpoints(&case) {
                    Ok(checkpoints) => {
                        if let Case::Pullout(program) = &mut case {
                            program.threads = threads.clone();
                            interruption.warn_of_memory(program);
                        }
                        if let Case::Bridging(program) = &mut case {
                            program.threads = arguments.threads.unwrap_or_else(super::processors);
                        }
                        jobs.push((Job::Here(Box::new(case), checkpoints), file, folder));
                    }
                    Err(message) => {
                        complain(format!("{}: {message}", file.display()));
                        code = code.max(BAD_INPUT);
                    }
                },
                Err(errors) => code = code.max(Refusal::from(errors).told()),
            },
        }
    }
    if code != DONE {
        return code;
    }
    let mut ready = Vec::new();
    for (job, file, folder) in jobs {
        match open(file, &folder, arguments, &job.libraries()) {
            Ok(directory) => ready.push((job, directory)),
            Err(refusal) => code = code.max(refusal.told()),
        }
    }
    if code != DONE {
        return code;
    }
    // of a worker's run, the supervisor shows what is printed
    let (records, progress_to) = (arguments.record_increments, arguments.progress_to.as_deref());
    let telling = Telling { quiet: *quiet, echo: *echo, records, progress_to };
    let run = |(job, directory): (Job<'_>, ResultDirectory)| {
        if let Some(signal) = signals::received() {
            complain(format!("{}: not run: interrupted by {}", directory.path().display(), signal.words()));
            return signal.exit_code();
        }
        match job {
            Job::Here(case, checkpoints) => run_into(&case, directory, &checkpoints, telling, reading),
            Job::Isolated { file, need } => isolated::run(file, directory, arguments, &need),
        }
    };
    ready.into_iter().map(run).max().unwrap_or(DONE)
}

/// Opens the result directory of a case.
fn open(file: &Path, folder: &Path, arguments: &Arguments, libraries: &[PathBuf]) -> Result<ResultDirectory, Refusal> {
    let inputs = [&pullout_case::inputs(file, &arguments.reading.overrides), libraries].concat();
    let is_locked = worker::is_this_process();
    open_for(folder, arguments.kind(), Access { inputs: &inputs, overwrite: arguments.overwrite, is_locked })
}

/// Opens a result directory, and says what the user should know of it.
pub(super) fn open_for(folder: &Path, kind: Kind, access: Access<'_>) -> Result<ResultDirectory, Refusal> {
    let directory = ResultDirectory::open(folder, kind, access).map_err(Refusal::input)?;
    if !access.is_locked {
        directory.notes().iter().for_each(complain);
    }
    Ok(directory)
}

/// Makes results of the rows that a run left which was ended from outside.
fn conclude_here(file: &Path, folder: &Path, arguments: &Arguments, aftermath: &str) -> Result<u8, Refusal> {
    let case = arguments.reading.case(file)?;
    let concluded = ResultDirectory::join(folder, arguments.kind()).and_then(|mut directory| {
        let summary = summarise_rows(&case, folder, serde_json::from_str(aftermath)?)?;
        conclude(&case, &mut directory, summary, None, &States::default())
    });
    Ok(tell(&case, folder, arguments.quiet, concluded))
}

/// Says what came out of a run; the result is its exit code.
fn tell(case: &Case, folder: &Path, quiet: bool, concluded: io::Result<(Summary, io::Result<()>)>) -> u8 {
    let complain =
        |message: &dyn std::fmt::Display| complain(format!("{}: {message}", &case.about().case_file.display()));
    let (summary, written) = match concluded {
        Ok(concluded) => concluded,
        Err(error) => {
            complain(&error);
            return FAILED;
        }
    };
    if !quiet {
        say(&outcome::of_run(&summary, case, folder));
    }
    summary.warnings.iter().for_each(|warning| complain(&format!("warning: {warning}")));
    summary.message.iter().for_each(|message| complain(message));
    if let Err(error) = &written {
        complain(error);
    }
    match (summary.status, signals::received()) {
        (Status::Interrupted, Some(signal)) => signal.exit_code(),
        (Status::Done, _) if written.is_ok() => DONE,
        _ => FAILED,
    }
}

/// Returns what is said of a run that a signal ended at a place.
pub(super) fn interrupted(place: &str, has_checkpoints: bool) -> String {
    let signal = signals::received().map_or("a signal", signals::Interrupt::words);
    let go_on = if has_checkpoints { "; --restart goes on from its last checkpoint" } else { "" };
    format!("interrupted by {signal} after {place}: what was done so far is kept{go_on}")
}

/// State of an earlier run with which a restarted one goes on.
const KEPT: [&str; 7] =
    ["history.csv", checkpoint::FILE, "fields.pvd", "fields/#.vtu", "fields/contact_#.vtu", "umat.log", "umat.msg"];

/// Runs a case, and says what came out; the result is its exit code.
fn run_into(
    case: &Case,
    mut directory: ResultDirectory,
    checkpoints: &Checkpoints,
    telling: Telling<'_>,
    reading: &Reading,
) -> u8 {
    let concluded = match case {
        Case::Bridging(program) => bridging::run_case(case, program, &mut directory, reading, telling.quiet),
        _ => run_case(case, &mut directory, checkpoints, telling),
    };
    tell(case, directory.path(), telling.quiet, concluded)
}

fn run_case(
    case: &Case,
    directory: &mut ResultDirectory,
    checkpoints: &Checkpoints,
    telling: Telling<'_>,
) -> io::Result<(Summary, io::Result<()>)> {
    let kept = checkpoints.from.as_deref().and_then(Kept::of);
    directory.begin(if kept.is_some() { &KEPT } else { &[] })?;
    // a plugin may change the folder in which this process works
    let folder = std::path::absolute(directory.path())?;
    case.announce();
    let prints = Prints::keep(&folder, telling.echo)?;
    let columns = case.columns();
    let history_file = folder.join("history.csv");
    worker::note_start();
    let progress = match telling.progress_to {
        Some(file) => Progress::to(Some(progress::writer(file, &columns)?), extent(case)),
        None => Progress::of(case, extent(case), telling.quiet),
    };
    let mut record = match kept {
        None => RunRecorder::new(&history_file, &columns, progress, checkpoints.every.is_some())?,
        Some(kept) => RunRecorder::resume(&history_file, &columns, progress, kept)?,
    };
    record.recorded = telling.records.then(Recorded::default);
    let Followed { statistics, result, mut specimen } = follow(case, &mut record, &folder, checkpoints);
    match &result {
        // it may be a plugin that took the right to write
        Err(Stop::Write(_)) => worker::end_if_spoilt(),
        _ => worker::look_after_plugins(),
    }
    // those of a run that was not at its end would repeat a part of it
    if let Some(recorded) = record.recorded.take().filter(|_| result.is_ok() && !record.was_ended()) {
        directory.write("increments.json", serde_json::to_string(&recorded)?)?;
    }
    // what plugins printed is complete before the results are listed
    drop(prints);
    let failed_at = match &result {
        Err(Stop::Failed(failure)) => Some(failure.place()),
        _ => None,
    };
    let message = match result {
        Ok(()) if record.was_ended() => Some(interrupted(&record.place(), checkpoints.every.is_some())),
        Ok(()) => None,
        Err(Stop::Write(error)) => Some(format!("{}: {error}", record.place())),
        Err(Stop::Failed(failure)) if failure.replay.is_null() => Some(failure.message),
        Err(Stop::Failed(failure)) => {
            let replay = directory.write("replay.json", format!("{:#}\n", failure.replay))?;
            Some(format!("{} (replay case: {})", failure.message, replay.display()))
        }
    };
    let summary = summarise(case, &mut record, statistics, message, failed_at, specimen.as_mut())?;
    conclude(case, directory, summary, specimen.as_ref(), &record.take_states())
}
