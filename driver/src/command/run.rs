//! `pullout run` and `pullout check`.

use super::{BAD_INPUT, DONE, FAILED, Reading, Refusal, browser, complain, isolated, study, watch};
use fe_core::threads::Threads;
use pullout_case::{Case, CaseProblem};
use pullout_engine::{Inspection, Job, Keep, Message, RunOptions, run_into};
use pullout_lab::FileStamp;
use pullout_report::directory::{Access, Kind, ResultDirectory};
use pullout_report::ending::{conclude, summarise_rows};
use pullout_report::outcome;
use pullout_report::page;
use pullout_report::plots::{self, Spec};
use pullout_report::summary::{self, Status, Summary};
use pullout_report::viewer::ViewerStates;
use pullout_run::isolation::prints::{Prints, say};
use pullout_run::isolation::{Aftermath, Need, send, worker};
use pullout_run::pullout::checkpoint::Checkpoints;
use pullout_run::signals;
use std::cell::Cell;
use std::collections::{BTreeMap, BTreeSet};
use std::io;
use std::path::{Path, PathBuf};

mod bridging;
mod interruption;
#[cfg(test)]
mod test;

/// Settings for running cases.
#[derive(Debug, clap::Args)]
pub(super) struct RunArguments {
    /// Case files.
    #[arg(required = true, value_name = "CASE.json")]
    cases: Vec<PathBuf>,
    /// Result directory; for several cases, its parent [default: out/<case>/].
    #[arg(short, long, value_name = "DIR")]
    out: Option<PathBuf>,
    #[command(flatten)]
    pub(super) reading: Reading,
    /// Continue the interrupted run in this result directory from its last checkpoint. The results go on there; `--out`
    /// is not given. Later rows and fields are computed again, bit for bit the same. A checkpoint does not contain a library's own memory (SAVE, COMMON):
    /// pullout calls the library's UEXTERNALDB with LOP = 4.
    #[arg(long, value_name = "DIR", conflicts_with = "record_increments")]
    restart: Option<PathBuf>,
    /// Run again whenever a case, or one of its sources, libraries or data files, is saved. End with Ctrl-C.
    #[arg(long, conflicts_with_all = ["restart", "in_process"])]
    watch: bool,
    /// Open the report in the browser as soon as it is written.
    #[arg(long)]
    open: bool,
    /// Print the summary of each case as one line of JSON, with the case and its result directory, and nothing else.
    #[arg(long, conflicts_with = "echo")]
    json: bool,
    #[command(flatten)]
    options: RunOptions,
}

/// Validates cases. `quiet`: prints only errors.
pub(super) fn check(cases: &[PathBuf], reading: &Reading, quiet: bool) -> u8 {
    let check = |file: &PathBuf| match pullout_case::is_study(file) {
        true => study::check(file, reading, quiet),
        false => inspect(&Inspection { case: reading.source(file), quiet, before_run: false }),
    };
    cases.iter().map(check).max().unwrap_or(DONE)
}

/// Validates a case, here or in a process of its own.
pub(super) fn inspect(inspection: &Inspection) -> u8 {
    match inspection.case.need() {
        Some(need) if inspection.before_run => isolated::check_before_run(&inspection.case, &need, None).0,
        Some(need) => isolated::check(inspection, &need),
        None => inspect_here(inspection).unwrap_or_else(Refusal::report),
    }
}

/// Validates a case in this process.
fn inspect_here(Inspection { case: source, quiet, before_run }: &Inspection) -> Result<u8, Refusal> {
    let case = super::read(source)?;
    if *before_run {
        send(&Message::Columns(case.columns_of_numbers()));
    } else {
        let _prints = Prints::discard();
        case.check_laws()?;
    }
    if !quiet {
        let file = source.file.display();
        say(&format!("{file}: no errors\n"));
        // the standard output has a line for each case
        case.about().defaults.iter().for_each(|line| complain(format!("{file}: note: defaults used: {line}")));
        case.about().warnings.iter().for_each(|warning| complain(format!("{file}: warning: {warning}")));
    }
    Ok(DONE)
}

/// Process of a run.
enum Way {
    Here(Box<Case>, Checkpoints),
    Apart(Need),
}

impl Way {
    /// The libraries that it calls.
    fn libraries(&self) -> Vec<PathBuf> {
        match self {
            Self::Here(case, _) => case.libraries(),
            Self::Apart(need) => need.libraries.keys().cloned().collect(),
        }
    }
}

/// Runs cases, once all of them have been read without an error.
pub(super) fn run(arguments: &RunArguments) -> u8 {
    let RunArguments { cases, out, restart, reading, .. } = arguments;
    if restart.is_some() && cases.len() > 1 {
        complain("--restart continues a single run: give one case");
        return BAD_INPUT;
    }
    if let (Some(folder), Some(out)) = (restart, out)
        && folder != out
    {
        let folder = folder.display();
        complain(format!(
            "--restart {folder} goes on in {folder}, where the interrupted run has its results: leave out --out"
        ));
        return BAD_INPUT;
    }
    if restart.is_some() && reading.untrusted {
        complain("--restart trusts the saved state, which --untrusted does not allow: run the case from its start");
        return BAD_INPUT;
    }
    let jobs = arguments.jobs();
    let to_open = Cell::new(arguments.open);
    let once = || {
        let code = run_all(&jobs, arguments.json);
        if to_open.get() {
            to_open.set(!open_reports(&jobs));
        }
        code
    };
    match arguments.watch {
        true => {
            let sources: Vec<_> = jobs.iter().map(|job| job.case.clone()).collect();
            watch::again_and_again(&sources, &once)
        }
        false => once(),
    }
}

/// Shows the existing reports in the browser, or prints their paths. Returns whether there is any.
fn open_reports(jobs: &[Job]) -> bool {
    let reports = jobs.iter().map(|job| job.folder.join(page::FILE)).filter(|report| report.is_file());
    let shown = reports.map(|report| {
        if let Err(reason) = browser::show(&report) {
            complain(format!("--open: no browser: {reason}; the report is {}", report.display()));
        }
    });
    shown.count() > 0
}

impl RunArguments {
    /// The runs, in the order of the cases.
    fn jobs(&self) -> Vec<Job> {
        let Self { cases, out, reading, restart, options, json, watch: _, open: _ } = self;
        // what it says is the summary
        let options = RunOptions { quiet: options.quiet || *json, ..options.clone() };
        let job = |file: &PathBuf| {
            let folder = super::folder_of(file, out.as_deref().or(restart.as_deref()), cases.len() == 1);
            Job { goes_on: restart.is_some(), ..Job::new(reading.source(file), folder, options.clone()) }
        };
        cases.iter().map(job).collect()
    }
}

/// Executes a job for another process.
pub(super) fn carry_out(job: &Job) -> u8 {
    match &job.aftermath {
        Some(aftermath) => conclude_here(job, aftermath.clone()).unwrap_or_else(Refusal::report),
        None => run_all(std::slice::from_ref(job), false),
    }
}

/// Executes jobs with the same options. `json`: prints their summaries.
fn run_all(jobs: &[Job], json: bool) -> u8 {
    let count = jobs.first().and_then(|job| job.options.threads).unwrap_or_else(super::processors);
    let threads = match Threads::new(count) {
        Ok(threads) => threads,
        Err(error) => return Refusal::input(format!("--threads {count}: {error}")).report(),
    };
    let mut folders = BTreeSet::new();
    let mut ways = Vec::new();
    let mut code = DONE;
    for job in jobs {
        let source = &job.case;
        if !folders.insert(&job.folder) {
            let file = source.file.display();
            complain(format!("{file}: another case has the same name, and so the same result directory"));
            code = code.max(BAD_INPUT);
        }
        let unsuited = |message| Refusal::of(&source.file, CaseProblem::unreadable(message));
        let way = match source.need() {
            Some(need) => {
                // nothing is run before all cases were read; a single one is read by the worker that runs it
                if jobs.len() > 1 {
                    code = code.max(isolated::check_before_run(source, &need, None).0);
                }
                interruption::suits(job, need.specimen).map_err(unsuited).map(|()| Way::Apart(need))
            }
            None => super::read(source).map_err(Refusal::from).and_then(|case| {
                let checkpoints = interruption::checkpoints(job, &case).map_err(unsuited)?;
                Ok(Way::Here(Box::new(case), checkpoints))
            }),
        };
        match way {
            Ok(way) => ways.push((way, job)),
            Err(refusal) => code = code.max(refusal.report()),
        }
    }
    if code != DONE {
        return code;
    }
    let mut ready = Vec::new();
    for (way, job) in ways {
        match open(job, &way.libraries()) {
            Ok(directory) => ready.push((way, job, directory)),
            Err(refusal) => code = code.max(refusal.report()),
        }
    }
    if code != DONE {
        return code;
    }
    let run = |(way, job, mut directory): (Way, &Job, ResultDirectory)| {
        if let Some(signal) = signals::received() {
            complain(format!("{}: not run: interrupted by {}", directory.path().display(), signal.words()));
            return signal.exit_code();
        }
        let (case, checkpoints) = match way {
            Way::Here(case, checkpoints) => (case, checkpoints),
            Way::Apart(need) => return isolated::run(job, directory, &need),
        };
        let concluded = match &*case {
            Case::Bridging(program) => bridging::run_case(&case, program, job, count, &mut directory),
            _ => {
                let warnings = interruption::warnings(job, &case);
                run_into(&case, job, &mut directory, threads.clone(), &checkpoints, warnings)
            }
        };
        let concluded = concluded.and_then(|ended| describe(&case, job, &mut directory).map(|()| ended));
        print_outcome(&case, directory.path(), job.options.quiet, concluded)
    };
    let run_and_say = |ready: (Way, &Job, ResultDirectory)| {
        let job = ready.1;
        let summary = || FileStamp::of(&job.folder.join(summary::FILE));
        let before = summary();
        let code = run(ready);
        // one that was not begun leaves the summary of an earlier run
        let said = (json && summary() != before)
            .then(|| super::say_json(("case", &job.case.file), &job.folder, summary::FILE));
        match said {
            Some(Err(error)) => {
                complain(error);
                code.max(FAILED)
            }
            _ => code,
        }
    };
    ready.into_iter().map(run_and_say).max().unwrap_or(DONE)
}

/// Returns the kind of results to which those of a job belong: a study adds to the results of its runs.
pub(super) fn kind(job: &Job) -> Kind {
    if job.keep == Keep::Member { Kind::Member } else { Kind::Run }
}

/// Opens the result directory of a case.
fn open(job: &Job, libraries: &[PathBuf]) -> Result<ResultDirectory, Refusal> {
    let inputs = [&job.case.inputs(), libraries].concat();
    let is_locked = worker::is_this_process();
    open_for(&job.folder, kind(job), Access { inputs: &inputs, overwrite: job.options.overwrite, is_locked })
}

/// Opens a result directory and prints what the user should know about it.
pub(super) fn open_for(folder: &Path, kind: Kind, access: Access<'_>) -> Result<ResultDirectory, Refusal> {
    let directory = ResultDirectory::open(folder, kind, access).map_err(Refusal::input)?;
    if !access.is_locked {
        directory.notes().iter().for_each(complain);
    }
    Ok(directory)
}

/// Makes results from the rows of a run that was ended from outside.
fn conclude_here(job: &Job, aftermath: Aftermath) -> Result<u8, Refusal> {
    let case = super::read(&job.case)?;
    let concluded = ResultDirectory::join(&job.folder, kind(job)).and_then(|mut directory| {
        let summary = summarise_rows(&case, &job.folder, aftermath)?;
        let ended = conclude(&case, &mut directory, summary, None, &ViewerStates::default(), job.keep.draws(&case))?;
        describe(&case, job, &mut directory)?;
        Ok(ended)
    });
    Ok(print_outcome(&case, &job.folder, job.options.quiet, concluded))
}

/// Writes the data from which the process that asked for a run draws its pictures: this process draws nothing.
fn describe(case: &Case, job: &Job, directory: &mut ResultDirectory) -> io::Result<()> {
    match job.keep {
        Keep::Passing => Spec::of(case, BTreeMap::new()).write(directory, plots::FOLDER),
        Keep::All | Keep::Member => Ok(()),
    }
}

/// Prints the outcome of a run. Returns its exit code.
fn print_outcome(case: &Case, folder: &Path, quiet: bool, concluded: io::Result<(Summary, io::Result<()>)>) -> u8 {
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
