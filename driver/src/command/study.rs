//! `pullout study`, and what `pullout check` does with a study.

use super::{BAD_INPUT, DONE, FAILED, Reading, Refusal, complain, isolated, run, say};
use pullout_case::{CaseErrors, CaseProblem};
use pullout_report::directory::{Access, Kind, ResultDirectory};
use pullout_run::isolation::ForwardedLines;
use pullout_run::isolation::prints::Prints;
use pullout_run::signals;
use pullout_study::{Demand, Execution, Results, Study, StudyProgress, claims};
use std::collections::BTreeSet;
use std::io;
use std::path::{Path, PathBuf};

/// Settings for running studies.
#[derive(Debug, clap::Args)]
pub(super) struct StudyArguments {
    /// Study files.
    #[arg(required = true, value_name = "FAMILY.json")]
    studies: Vec<PathBuf>,
    /// Result directory; for several studies, its parent [default: out/<study>/].
    #[arg(short, long, value_name = "DIR")]
    out: Option<PathBuf>,
    #[command(flatten)]
    pub(super) reading: Reading,
    /// Number of runs at a time [default: the number of processors].
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..))]
    jobs: Option<u16>,
    /// Run only these, even if they are finished (may be repeated; * matches all series or all labels).
    #[arg(long, value_name = "SERIES/LABEL")]
    only: Vec<String>,
    /// Repeat runs that are finished and unchanged.
    #[arg(long)]
    force: bool,
    /// Also replace files in the result directories that pullout did not write or that were changed since, and list
    /// them.
    #[arg(long)]
    overwrite: bool,
    /// Print only errors.
    #[arg(long)]
    quiet: bool,
    /// Print study.json of each study as one line, with its result directory, and nothing else.
    #[arg(long)]
    json: bool,
}

impl StudyArguments {
    /// Returns whether only errors are reported.
    fn is_quiet(&self) -> bool {
        self.quiet || self.json
    }
}

/// Runs studies, once all of them have been read without an error.
pub(super) fn run_all(arguments: &StudyArguments) -> u8 {
    let StudyArguments { studies, out, reading, .. } = arguments;
    let mut folders = BTreeSet::new();
    let mut read = Vec::new();
    let mut code = DONE;
    for file in studies {
        let folder = super::folder_of(file, out.as_deref(), studies.len() == 1);
        if !folders.insert(folder.clone()) {
            complain(format!("{}: another study has the same name, and so the same result directory", file.display()));
            code = code.max(BAD_INPUT);
        }
        match read_study(file, reading) {
            Ok(study) => read.push((study, folder)),
            Err(error) => code = code.max(error),
        }
    }
    if code == DONE {
        code = read.iter().map(|(study, folder)| check_selection(study, folder, arguments)).max().unwrap_or(DONE);
    }
    if code != DONE {
        return code;
    }
    let mut ready = Vec::new();
    for (study, folder) in &read {
        match open(study, folder, arguments) {
            Ok(directory) => ready.push((study, directory)),
            Err(refused) => code = code.max(refused),
        }
    }
    if code != DONE {
        return code;
    }
    let run = |(study, directory): (&Study, ResultDirectory)| {
        if let Some(signal) = signals::received() {
            complain(format!("{}: not run: interrupted by {}", study.file.display(), signal.words()));
            return signal.exit_code();
        }
        run_one(study, directory, arguments).unwrap_or_else(|error| {
            complain(format!("{}: {error}", study.file.display()));
            FAILED
        })
    };
    ready.into_iter().map(run).max().unwrap_or(DONE)
}

/// Validates a study and the cases of all its runs.
pub(super) fn check(file: &Path, reading: &Reading, quiet: bool) -> u8 {
    match read_study(file, reading) {
        Ok(_) if quiet => DONE,
        Ok(study) => {
            let (runs, claims) = (study.runs.len(), study.claims.len());
            say(&format!("{}: no errors ({runs} runs, {claims} claims)\n", file.display()));
            DONE
        }
        Err(code) => code,
    }
}

/// Returns a study whose cases are all correct, or the exit code.
fn read_study(file: &Path, reading: &Reading) -> Result<Study, u8> {
    let mut apart = Vec::new();
    let prints = Prints::discard();
    let read = pullout_study::read(&reading.source(file), &mut |own| {
        let need = own.need();
        let is_isolated = need.is_some();
        apart.extend(need.map(|need| (own.clone(), need)));
        is_isolated
    });
    drop(prints);
    let own = read.as_ref().map_or_else(|errors| Refusal::from(errors.clone()).report(), |_| DONE);
    let lines = ForwardedLines::default();
    let mut reported: Option<Vec<CaseProblem>> = None;
    let theirs = apart.iter().map(|(own, need)| {
        let (code, known) = isolated::check_before_run(own, need, Some(&lines));
        let Ok(study) = &read else { return code };
        // what is wrong has been said, of the case alone
        if code == BAD_INPUT {
            for run in study.runs.iter().filter(|run| run.case == *own) {
                complain(format!("{}: that is the case of {}", file.display(), run.folder.display()));
            }
        }
        let unmet = known.map_or_else(Vec::new, |known| Demand::unmet(&study.demands, &known));
        if code != DONE || unmet.is_empty() {
            return code;
        }
        // problems that all cases share are reported once
        if reported.replace(unmet.clone()).is_none_or(|before| before != unmet) {
            Refusal::from(CaseErrors { file: file.into(), problems: unmet }).report();
        }
        BAD_INPUT
    });
    let code = theirs.fold(own, u8::max);
    match (read, code) {
        (Ok(study), DONE) => Ok(study),
        (_, code) => Err(code),
    }
}

fn execution<'a>(folder: &'a Path, arguments: &'a StudyArguments) -> Execution<'a> {
    let processors = super::processors().get();
    let jobs = arguments.jobs.map_or(processors, usize::from);
    Execution {
        out: folder,
        jobs,
        threads: (processors / jobs).max(1),
        only: &arguments.only,
        force: arguments.force,
        keep_failed: false,
        overwrite: arguments.overwrite,
    }
}

/// Refuses an `--only` that matches no run.
fn check_selection(study: &Study, folder: &Path, arguments: &StudyArguments) -> u8 {
    let mut code = DONE;
    for wanted in &arguments.only {
        let only = std::slice::from_ref(wanted);
        let execution = Execution { only, ..execution(folder, arguments) };
        if !study.runs.iter().any(|run| execution.wants(study, run)) {
            let names: Vec<String> = study.runs.iter().map(|run| study.name_of(run)).collect();
            let hint = pullout_case::hint(wanted, &names);
            complain(format!("{}: --only {wanted}: there is no such run{hint}", study.file.display()));
            code = BAD_INPUT;
        }
    }
    code
}

/// Opens the directory of a study, or returns why it cannot. The directories of the pending runs must be usable as well.
fn open(study: &Study, folder: &Path, arguments: &StudyArguments) -> Result<ResultDirectory, u8> {
    let execution = execution(folder, arguments);
    let mut inputs = vec![study.file.clone()];
    let mut of_runs = Vec::new();
    for run in &study.runs {
        let own = run.case.inputs();
        inputs.extend_from_slice(&own);
        if execution.is_due(study, run) {
            of_runs.push((folder.join(&run.folder), own));
        }
    }
    let access = |inputs| Access { inputs, overwrite: arguments.overwrite, is_locked: false };
    let open = |folder: &Path, kind, inputs| run::open_for(folder, kind, access(inputs)).map_err(Refusal::report);
    let directory = open(folder, Kind::Study, &inputs)?;
    let refused = of_runs.iter().filter_map(|(folder, inputs)| open(folder, Kind::Member, inputs).err());
    refused.max().map_or(Ok(directory), Err)
}

fn run_one(study: &Study, mut directory: ResultDirectory, arguments: &StudyArguments) -> io::Result<u8> {
    directory.begin(&[])?;
    let folder = &directory.path().to_owned();
    let progress = StudyProgress::new(study, folder, arguments.is_quiet());
    let states = pullout_study::execute(study, &execution(folder, arguments), &|run, code, count, of| {
        if let Some(line) = progress.ended(run, code, count, of) {
            say(&line);
        }
    })?;
    progress.finish();
    let results = Results::read(study, folder, &states);
    let findings = claims::test_all(study, &results);
    pullout_study::write_csv(&mut directory, study, &results)?;
    pullout_study::write_json(&mut directory, study, &results, &findings)?;
    directory.remove_earlier()?;
    let drawings = pullout_study::pictures::draw(&mut directory, study, &results)?;
    pullout_study::write_report(&mut directory, study, &results, &findings, &drawings.pictures)?;
    directory.finish()?;
    if arguments.json {
        super::say_json(("study", &study.file), folder, pullout_study::FILE)?;
    }
    if !arguments.is_quiet() {
        say(&pullout_study::outcome(study, &results, &findings, folder));
    }
    drawings.warnings.iter().for_each(|warning| complain(format!("{}: warning: {warning}", study.file.display())));
    for (run, result) in study.runs.iter().zip(&results.runs) {
        if let Some(message) = &result.message {
            complain(format!("{}: {message}", study.name_of(run)));
        }
    }
    if let Some(signal) = signals::received() {
        let done = results.runs.iter().filter(|run| run.is_done()).count();
        complain(format!(
            "{}: interrupted by {}: {done} of {} runs are done and kept; the same command goes on",
            study.file.display(),
            signal.words(),
            results.runs.len()
        ));
        return Ok(signal.exit_code());
    }
    let of_kept = results.runs.iter().map(|result| if result.message.is_some() { FAILED } else { DONE });
    let of_run = states.iter().map(|state| match state {
        pullout_study::RunOutcome::Ran(code) => *code,
        pullout_study::RunOutcome::Kept | pullout_study::RunOutcome::NotRun => DONE,
    });
    Ok(of_run.chain(of_kept).max().unwrap_or(DONE))
}
