//! `pullout run` and `pullout check`.

use super::{BAD_INPUT, DONE, FAILED, Reading, complain, isolated, option, refuse, study};
use fe_core::threads::Threads;
use pullout_case::Case;
use pullout_report::compare::{Comparison, compare};
use pullout_report::directory::{Access, Kind, Refusal, ResultDirectory};
use pullout_report::history::HistoryFile;
use pullout_report::page::{self, Account};
use pullout_report::plots::{self, Picture, Spec};
use pullout_report::progress::{Extent, Progress};
use pullout_report::summary::{PeakRecorder, PluginFile, PluginOf, Status, Summary};
use pullout_run::isolation::prints::{Prints, say};
use pullout_run::isolation::{Aftermath, Need, worker};
use pullout_run::path::{self, Statistics, Stop};
use pullout_run::program;
use pullout_run::pullout;
use pullout_run::pullout::checkpoint::{self, Checkpoints};
use pullout_run::signals;
use std::collections::BTreeSet;
use std::ffi::OsString;
use std::io;
use std::num::NonZeroUsize;
use std::path::{Path, PathBuf};
use std::time::Duration;
use umat_abi::host::{Law, Library};

mod interruption;
mod record;

pub(super) use interruption::Interruption;
use record::{Kept, Record};

/// How cases are run.
#[derive(Debug, clap::Args)]
pub(super) struct Arguments {
    /// Case files.
    #[arg(required = true, value_name = "CASE.json")]
    cases: Vec<PathBuf>,
    /// Result directory (of several cases: their parent).
    #[arg(long, value_name = "DIR")]
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
    #[arg(long, value_name = "N")]
    threads: Option<NonZeroUsize>,
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
    /// What came of the run of a worker that was ended, as JSON: nothing is run, the results are made of its rows.
    #[arg(long, hide = true)]
    aftermath: Option<String>,
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
        line.extend(self.quiet.then(|| "--quiet".into()));
        line.extend(self.threads.map(|count| format!("--threads={count}").into()));
        line.extend(self.parent.map(|parent| format!("--parent={parent}").into()));
        line.extend(aftermath.map(|text| format!("--aftermath={text}").into()));
        line.extend(self.reading.command_line());
        line.extend(["--".into(), file.into()]);
        line
    }

    /// What the results are part of: a study has something to add to those of its runs.
    fn kind(&self) -> Kind {
        if self.parent.is_some() { Kind::Member } else { Kind::Run }
    }
}

/// Validates cases. `quiet`: says nothing but errors; `before_run`: leaves to the run what belongs to it.
pub(super) fn check(cases: &[PathBuf], reading: &Reading, quiet: bool, before_run: bool) -> u8 {
    let check = |file: &PathBuf| match reading.need(file) {
        _ if pullout_case::is_study(file) => study::check(file, reading, quiet),
        Some(need) => isolated::check(file, reading, &need, quiet),
        None => check_here(file, reading, quiet, before_run),
    };
    cases.iter().map(check).max().unwrap_or(DONE)
}

/// Validates a case in this process.
fn check_here(file: &Path, reading: &Reading, quiet: bool, before_run: bool) -> u8 {
    let case = match reading.case(file) {
        Ok(case) => case,
        Err(errors) => return refuse(&errors),
    };
    if !before_run {
        let _prints = Prints::discard();
        if let Err(errors) = case.check_laws() {
            return refuse(&errors);
        }
    }
    if !quiet {
        say(&format!("{}: no errors\n", file.display()));
        // the standard output has a line for each case
        case.defaults().iter().for_each(|line| complain(format!("{}: by default, {line}", file.display())));
        case.warnings().iter().for_each(|warning| complain(format!("{}: warning: {warning}", file.display())));
    }
    DONE
}

/// A case that is to be run.
enum Job<'f> {
    Here(Box<Case>, Checkpoints),
    Isolated { file: &'f Path, need: Need },
}

/// What the user wants to see of a run.
#[derive(Clone, Copy, Debug)]
struct Telling {
    /// Nothing but errors.
    quiet: bool,
    /// What the plugins print.
    echo: bool,
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
    let threads = arguments.threads.unwrap_or_else(super::processors);
    let threads = match Threads::new(threads) {
        Ok(threads) => threads,
        Err(error) => {
            complain(format!("--threads {threads}: {error}"));
            return BAD_INPUT;
        }
    };
    let mut stems = BTreeSet::new();
    let mut jobs = Vec::new();
    let mut code = DONE;
    for file in cases {
        let stem = file.file_stem().unwrap_or_default().to_owned();
        let folder = match arguments.out.as_deref().or(interruption.restart.as_deref()) {
            Some(out) if cases.len() == 1 => out.to_path_buf(),
            Some(out) => out.join(&stem),
            None => Path::new("out").join(&stem),
        };
        if let Some(aftermath) = &arguments.aftermath {
            return conclude_here(file, &folder, arguments, aftermath);
        }
        if !stems.insert(stem) {
            complain(format!("{}: another case has the same name, and so the same result directory", file.display()));
            code = code.max(BAD_INPUT);
        }
        match reading.need(file) {
            Some(need) => {
                // nothing is run before all cases were read; a single one is read by the worker that runs it
                if cases.len() > 1 {
                    code = code.max(isolated::check_before_run(file, reading, &need));
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
                        jobs.push((Job::Here(Box::new(case), checkpoints), file, folder));
                    }
                    Err(message) => {
                        complain(format!("{}: {message}", file.display()));
                        code = code.max(BAD_INPUT);
                    }
                },
                Err(errors) => code = code.max(refuse(&errors)),
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
            Err(refused) => code = code.max(refused),
        }
    }
    if code != DONE {
        return code;
    }
    // of a worker's run, the supervisor shows what is printed
    let telling = Telling { quiet: *quiet, echo: *echo };
    let run = |(job, directory): (Job<'_>, ResultDirectory)| {
        if let Some(signal) = signals::received() {
            complain(format!("{}: not run: interrupted by {}", directory.path().display(), signal.words()));
            return signal.exit_code();
        }
        match job {
            Job::Here(case, checkpoints) => run_into(&case, directory, &checkpoints, telling),
            Job::Isolated { file, need } => isolated::run(file, directory, arguments, &need),
        }
    };
    ready.into_iter().map(run).max().unwrap_or(DONE)
}

/// Opens the result directory of a case, or says why not.
fn open(file: &Path, folder: &Path, arguments: &Arguments, libraries: &[PathBuf]) -> Result<ResultDirectory, u8> {
    let inputs = [&pullout_case::inputs(file, &arguments.reading.overrides), libraries].concat();
    let is_locked = worker::is_this_process();
    open_for(folder, arguments.kind(), Access { inputs: &inputs, overwrite: arguments.overwrite, is_locked })
}

/// Opens a result directory, or says why not.
pub(super) fn open_for(folder: &Path, kind: Kind, access: Access<'_>) -> Result<ResultDirectory, u8> {
    match ResultDirectory::open(folder, kind, access) {
        Ok(directory) => {
            if !access.is_locked {
                directory.notes().iter().for_each(complain);
            }
            Ok(directory)
        }
        Err(refusal) => Err(refused(refusal)),
    }
}

/// Says why a result directory cannot be used; the result is the exit code.
pub(super) fn refused(refusal: Refusal) -> u8 {
    match refusal {
        Refusal::Content(message) => {
            complain(message);
            BAD_INPUT
        }
        Refusal::System(error) => {
            complain(error);
            FAILED
        }
    }
}

/// Makes results of the rows that a run left which was ended from outside.
fn conclude_here(file: &Path, folder: &Path, arguments: &Arguments, aftermath: &str) -> u8 {
    let case = match arguments.reading.case(file) {
        Ok(case) => case,
        Err(errors) => return refuse(&errors),
    };
    let concluded = ResultDirectory::join(folder, arguments.kind()).and_then(|mut directory| {
        let end = RunEnd::of(&case, folder, serde_json::from_str(aftermath)?)?;
        conclude(&case, &mut directory, end, None)
    });
    tell(&case, folder, arguments.quiet, concluded)
}

/// Says what came out of a run; the result is its exit code.
fn tell(case: &Case, folder: &Path, quiet: bool, concluded: io::Result<(Summary, io::Result<()>)>) -> u8 {
    let complain = |message: &dyn std::fmt::Display| complain(format!("{}: {message}", case.file().display()));
    let (summary, written) = match concluded {
        Ok(concluded) => concluded,
        Err(error) => {
            complain(&error);
            return FAILED;
        }
    };
    if !quiet {
        say(&outcome(&summary, case, folder));
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

/// What is said of a run that a signal ended at a place.
pub(super) fn interrupted(place: &str, has_checkpoints: bool) -> String {
    let signal = signals::received().map_or("a signal", signals::Interrupt::words);
    let go_on = if has_checkpoints { "; --restart goes on from its last checkpoint" } else { "" };
    format!("interrupted by {signal} after {place}: what was done so far is kept{go_on}")
}

/// What of an earlier run a restarted one goes on with.
const KEPT: [&str; 7] =
    ["history.csv", checkpoint::FILE, "fields.pvd", "fields/#.vtu", "fields/contact_#.vtu", "umat.log", "umat.msg"];

/// Runs a case, and says what came out; the result is its exit code.
fn run_into(case: &Case, mut directory: ResultDirectory, checkpoints: &Checkpoints, telling: Telling) -> u8 {
    let concluded = run_case(case, &mut directory, checkpoints, telling);
    tell(case, directory.path(), telling.quiet, concluded)
}

fn run_case(
    case: &Case,
    directory: &mut ResultDirectory,
    checkpoints: &Checkpoints,
    telling: Telling,
) -> io::Result<(Summary, io::Result<()>)> {
    let kept = checkpoints.from.as_deref().and_then(|saved| Kept::of(saved, &case.columns()));
    directory.begin(if kept.is_some() { &KEPT } else { &[] })?;
    // a plugin may change the folder in which this process works
    let folder = std::path::absolute(directory.path())?;
    case.announce();
    let prints = Prints::keep(&folder, telling.echo)?;
    let columns = case.columns();
    let history_file = folder.join("history.csv");
    worker::note_start();
    let progress = Progress::new(&title(case), extent(case), shown(case), telling.quiet);
    let mut record = match kept {
        None => Record::new(&history_file, &columns, progress, checkpoints.every.is_some())?,
        Some(kept) => Record::resume(&history_file, &columns, progress, kept)?,
    };
    let (statistics, result, specimen) = match case {
        Case::Path(program) => {
            let (statistics, result) = path::run(program, &mut record);
            (statistics, result, None)
        }
        Case::Pullout(program) => {
            let mut outcome = pullout::run(program, &folder, checkpoints, &mut record);
            let result = std::mem::replace(&mut outcome.result, Ok(()));
            (outcome.statistics, result, Some((&**program, outcome)))
        }
    };
    record.progress.finish();
    // what plugins printed is complete before the results are listed
    drop(prints);
    let is_interrupted = record.was_ended();
    let message = match result {
        Ok(()) if is_interrupted => Some(interrupted(&record.place(), checkpoints.every.is_some())),
        Ok(()) => None,
        Err(Stop::Write(error)) => Some(format!("{}: {error}", record.place())),
        Err(Stop::Failed(failure)) if failure.replay.is_null() => Some(failure.message),
        Err(Stop::Failed(failure)) => {
            let replay = directory.write("replay.json", format!("{:#}\n", failure.replay))?;
            Some(format!("{} (replay case: {})", failure.message, replay.display()))
        }
    };
    let [wall_time_s, cpu_time_s] = record.times();
    let (peaks, warnings) = (record.peaks, record.warnings);
    let cpu_time_s = Some(cpu_time_s);
    let end = RunEnd { peaks, statistics, message, is_interrupted, wall_time_s, cpu_time_s, warnings };
    conclude(case, directory, end, specimen)
}

/// How a run ended.
struct RunEnd {
    peaks: PeakRecorder,
    statistics: Statistics,
    /// Why it failed.
    message: Option<String>,
    /// A signal asked for its end.
    is_interrupted: bool,
    wall_time_s: f64,
    /// Not known of a process that was ended.
    cpu_time_s: Option<f64>,
    /// What the run itself found that the user should know.
    warnings: Vec<String>,
}

/// CPU time of this process so far.
fn cpu_time() -> Duration {
    let time = rustix::time::clock_gettime(rustix::time::ClockId::ProcessCPUTime);
    Duration::try_from(time).unwrap_or_default()
}

impl RunEnd {
    /// Of a run that was ended from outside: its peaks are those of the rows that were written.
    fn of(case: &Case, folder: &Path, aftermath: Aftermath) -> io::Result<Self> {
        let mut peaks = PeakRecorder::new(&case.columns());
        HistoryFile::open(&folder.join("history.csv"))?.each_row(|row| peaks.observe(&row))?;
        let Aftermath { message, is_interrupted, statistics, wall_time_s } = aftermath;
        let (message, warnings) = (Some(message), Vec::new());
        Ok(Self { peaks, statistics, message, is_interrupted, wall_time_s, cpu_time_s: None, warnings })
    }
}

/// Writes summary, plots and report beside a history: the summary first, so that nothing that is drawn can take it away.
/// The second result is what could not be written.
fn conclude(
    case: &Case,
    directory: &mut ResultDirectory,
    end: RunEnd,
    mut specimen: Option<(&pullout::Program, pullout::Outcome<'_>)>,
) -> io::Result<(Summary, io::Result<()>)> {
    let mut summary = summarise(case, &end)?;
    summary.specimen = specimen.as_mut().map(|(_, outcome)| std::mem::take(&mut outcome.findings));
    if let Some(moved) = summary.specimen.as_ref().and_then(|findings| findings.initial_displacement) {
        summary.warnings.push(format!(
            "the initial stress was not in equilibrium with the supports and all drives at 0: before the first step nodes \
             moved by up to {moved:.3e} mm until it was"
        ));
    }
    let compared = compare_all(case, directory.path());
    summary.compare = compared.as_ref().map(Vec::clone).unwrap_or_default();
    let written = summary.write(directory).and_then(|()| directory.remove_earlier()).and_then(|()| {
        let pictures = draw(case, directory, specimen.as_ref());
        let shown = pictures.as_deref().unwrap_or_default();
        page::write(directory, &Account::of(case), &summary, shown)?;
        directory.finish()?;
        pictures.and(compared.map(|_| ()))
    });
    Ok((summary, written))
}

/// Compares a history with all curves of its case.
fn compare_all(case: &Case, folder: &Path) -> io::Result<Vec<Comparison>> {
    if case.compare().is_empty() {
        return Ok(Vec::new());
    }
    let history = HistoryFile::open(&folder.join("history.csv"))?;
    case.compare().iter().map(|curve| compare(&history, curve)).collect()
}

/// Draws what the case asks for.
fn draw(
    case: &Case,
    directory: &mut ResultDirectory,
    specimen: Option<&(&pullout::Program, pullout::Outcome<'_>)>,
) -> io::Result<Vec<Picture>> {
    if !case.draws_plots() {
        return Ok(Vec::new());
    }
    let history = HistoryFile::open(&directory.path().join("history.csv"))?.for_pictures()?;
    let mut pictures = plots::draw(directory, "plots", &history, &Spec::of(case))?;
    if let Some((program, outcome)) = specimen {
        pictures.extend(pullout_report::pictures::draw(directory, "plots", program, outcome)?);
    }
    Ok(pictures)
}

fn summarise(case: &Case, end: &RunEnd) -> io::Result<Summary> {
    let (plugin, plugins) = plugins(case)?;
    let statistics = &end.statistics;
    Ok(Summary {
        status: match &end.message {
            None => Status::Done,
            Some(_) if end.is_interrupted => Status::Interrupted,
            Some(_) => Status::Failed,
        },
        message: end.message.clone(),
        title: case.title().to_owned(),
        plugin,
        plugins,
        peaks: end.peaks.peaks(),
        increments: statistics.increments,
        iterations: statistics.iterations,
        plugin_calls: statistics.plugin_calls,
        cutbacks: statistics.cutbacks,
        wall_time_s: end.wall_time_s,
        cpu_time_s: end.cpu_time_s,
        compare: Vec::new(),
        specimen: None,
        warnings: warnings(case).into_iter().chain(end.warnings.iter().cloned()).collect(),
    })
}

/// The plugin of a point; of a specimen, the first contact pair's or else the first part's, and all of them.
fn plugins(case: &Case) -> io::Result<(PluginFile, Vec<PluginOf>)> {
    let version = |law: Option<&Law>| law.map_or(String::new(), |law| law.version.clone());
    match case {
        Case::Path(program) => {
            let plugin = &program.plugin;
            let file = PluginFile::identify(plugin.library.path(), &version(plugin.law.as_ref()))?;
            Ok((file, Vec::new()))
        }
        Case::Pullout(program) => {
            let mut plugins = Vec::new();
            for (subject, law) in program.laws() {
                let file = PluginFile::identify(law.library.path(), &version(law.law.as_ref()))?;
                plugins.push(PluginOf { subject, law: law.name.clone(), file });
            }
            let first = plugins.first().map(|plugin| plugin.file.clone()).unwrap_or_default();
            Ok((first, plugins))
        }
    }
}

/// The case's warnings, and those that a run adds.
fn warnings(case: &Case) -> Vec<String> {
    let mut warnings = case.warnings().to_vec();
    let libraries: Vec<(&str, &Library)> = match case {
        Case::Path(program) => vec![(&program.plugin.name, &program.plugin.library)],
        Case::Pullout(program) => {
            program.laws().into_iter().map(|(_, law)| (law.name.as_str(), &law.library)).collect()
        }
    };
    for (name, library) in libraries.iter().filter(|(_, library)| library.calls_change_floating_point()) {
        warnings.push(format!(
            "{}: calls of '{name}' switched the processor's floating-point modes (flush to zero, rounding, traps); they \
             were restored behind each",
            library.path().display()
        ));
    }
    for (name, library) in libraries {
        let written = library.written_inputs();
        let Some([step, increment, ..]) = written.values().min() else { continue };
        let names: Vec<&str> = written.keys().copied().collect();
        warnings.push(format!(
            "{}: '{name}' writes {}, which are inputs (first in step {step}, increment {increment}): each call gets copies, \
             what it changed there was lost with the call",
            library.path().display(),
            names.join(", ")
        ));
    }
    warnings
}

fn title(case: &Case) -> String {
    let stem = case.file().file_stem().unwrap_or_default();
    stem.to_string_lossy().into_owned()
}

/// How far a run goes.
fn extent(case: &Case) -> Extent {
    match case {
        Case::Path(program) => Extent::Increments(path::increments(program)),
        Case::Pullout(program) => Extent::Time(program.model.steps.iter().map(|step| step.time).sum()),
    }
}

/// Columns that a progress line tells: the first strain and stress, slip and traction, or slip and load.
fn shown(case: &Case) -> Vec<(String, usize)> {
    let names: &[&str] = match case {
        Case::Path(program) => match &program.kind {
            program::Kind::Point(_) => &["e11", "s11"],
            program::Kind::Interface(_) => &["slip", "tau"],
        },
        Case::Pullout(_) => &["slip", "load"],
    };
    let columns = case.columns();
    // values begin behind step and increment
    let index = |name: &str| columns.iter().position(|column| column == name).map(|k| k - 2);
    names.iter().filter_map(|name| Some(((*name).to_owned(), index(name)?))).collect()
}

/// A few lines on standard output.
fn outcome(summary: &Summary, case: &Case, folder: &Path) -> String {
    use std::fmt::Write;
    let done = match summary.status {
        Status::Done => "done",
        Status::Failed => "FAILED",
        Status::Interrupted => "interrupted",
    };
    let mut text = format!(
        "{}: {done}, {} increments, {} plugin calls, {:.3} s -> {}\n",
        title(case),
        summary.increments,
        summary.plugin_calls,
        summary.wall_time_s,
        folder.display()
    );
    let (interesting, unit) = match case {
        Case::Path(program) => match &program.kind {
            program::Kind::Point(_) => (&["s11", "s22", "s33", "s12", "s13", "s23"][..], "MPa"),
            program::Kind::Interface(_) => (&["tau", "p"][..], "MPa"),
        },
        Case::Pullout(_) => (&["load", "load_lateral"][..], "N"),
    };
    for name in interesting {
        if let Some(peak) = summary.peaks.get(*name)
            && let (Some(max), Some(min)) = (peak.max, peak.min)
            && (max.abs() > 1e-6 || min.abs() > 1e-6)
        {
            let _ = writeln!(text, "  {name}: max {max:.6} {unit}, min {min:.6} {unit}");
        }
    }
    for comparison in &summary.compare {
        let _ = match comparison.rms {
            Some(rms) => {
                writeln!(text, "  {}: RMS {rms:.4} over {} points", comparison.file, comparison.points)
            }
            None => writeln!(text, "  {}: no point within the path's range", comparison.file),
        };
    }
    text
}
