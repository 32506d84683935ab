//! `pullout run` and `pullout check`.

use super::{BAD_INPUT, DONE, FAILED, Reading, complain, isolated, refuse, study};
use crate::case::{self, Case};
use crate::isolation::prints::{self, Prints, say};
use crate::isolation::{Aftermath, Need, worker};
use crate::output::compare::compare;
use crate::output::history::History;
use crate::output::plots::{self, Spec};
use crate::output::progress::{Extent, Progress};
use crate::output::report::{self, Account};
use crate::output::summary::{PeakRecorder, PluginFile, PluginOf, Status, Summary};
use crate::path::program::Kind;
use crate::path::{self, Statistics, Stop};
use crate::pullout;
use crate::pullout::checkpoint::{self, Checkpoints};
use fe_core::threads::Threads;
use std::collections::BTreeSet;
use std::fs;
use std::io;
use std::num::NonZeroUsize;
use std::path::{Path, PathBuf};
use std::time::Duration;
use umat_abi::host::{Law, Library};

mod interruption;
mod record;

pub(super) use interruption::Interruption;
use record::{Kept, Record};

/// Validates cases.
pub(super) fn check(cases: &[PathBuf], reading: &Reading) -> u8 {
    let check = |file: &PathBuf| match reading.need(file) {
        _ if case::is_study(file) => study::check(file, reading),
        Some(need) => isolated::check(file, reading, &need, false),
        None => check_here(file, reading, false),
    };
    cases.iter().map(check).max().unwrap_or(DONE)
}

/// Validates a case in this process. `quiet`: says nothing but errors.
pub(super) fn check_here(file: &Path, reading: &Reading, quiet: bool) -> u8 {
    match reading.case(file) {
        Ok(_) if quiet => DONE,
        Ok(case) => {
            say(&format!("{}: no errors\n", file.display()));
            case.warnings().iter().for_each(|warning| complain(format!("{}: warning: {warning}", file.display())));
            DONE
        }
        Err(errors) => refuse(&errors),
    }
}

/// A case that is to be run.
enum Job<'f> {
    Here(Box<Case>, Checkpoints),
    Isolated { file: &'f Path, need: Need },
}

/// What the user wants to see of a run.
#[derive(Clone, Copy, Debug)]
pub(super) struct Telling {
    /// Nothing but errors.
    pub(super) quiet: bool,
    /// What the plugins print.
    pub(super) echo: bool,
}

/// Runs cases, after all of them were read without an error.
pub(super) fn run(
    cases: &[PathBuf],
    out: Option<&Path>,
    reading: &Reading,
    interruption: &Interruption,
    threads: NonZeroUsize,
    telling: Telling,
) -> u8 {
    if interruption.restart.is_some() && cases.len() > 1 {
        complain("--restart goes on with one run: name its case alone");
        return BAD_INPUT;
    }
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
        let folder = match out.or(interruption.restart.as_deref()) {
            Some(out) if cases.len() == 1 => out.to_path_buf(),
            Some(out) => out.join(&stem),
            None => Path::new("out").join(&stem),
        };
        if !stems.insert(stem) {
            complain(format!("{}: another case has the same name, and so the same result directory", file.display()));
            code = code.max(BAD_INPUT);
        }
        match reading.need(file) {
            Some(_) if interruption.is_asked_for() => {
                complain(format!(
                    "{}: its plugins run in a process of their own, whose memory no checkpoint holds: leave --checkpoint-every \
                     and --restart out, or set \"isolate\": false in the material if they keep nothing between calls",
                    file.display()
                ));
                code = code.max(BAD_INPUT);
            }
            Some(need) => {
                // nothing is run before all cases were read; a single one is read by the worker that runs it
                if cases.len() > 1 {
                    code = code.max(isolated::check(file, reading, &need, true));
                }
                jobs.push((Job::Isolated { file, need }, folder));
            }
            None => match reading.case(file) {
                Ok(mut case) => match interruption.checkpoints(&case) {
                    Ok(checkpoints) => {
                        if let Case::Pullout(program) = &mut case {
                            program.threads = threads.clone();
                        }
                        jobs.push((Job::Here(Box::new(case), checkpoints), folder));
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
    let run = |(job, folder): &(Job<'_>, PathBuf)| match job {
        Job::Here(case, checkpoints) => tell(case, folder, telling.quiet, run_into(case, folder, checkpoints, telling)),
        Job::Isolated { file, need } => isolated::run(file, folder, reading, need, telling),
    };
    jobs.iter().map(run).max().unwrap_or(DONE)
}

/// Reads and runs a case in this process.
pub(super) fn run_here(file: &Path, folder: &Path, reading: &Reading, quiet: bool) -> u8 {
    match reading.case(file) {
        Ok(case) => {
            // the supervisor shows what is printed
            let telling = Telling { quiet, echo: false };
            tell(&case, folder, quiet, run_into(&case, folder, &Checkpoints::default(), telling))
        }
        Err(errors) => refuse(&errors),
    }
}

/// Makes results of the rows that a run left which was ended from outside.
pub(super) fn conclude_here(file: &Path, folder: &Path, reading: &Reading, aftermath: &Aftermath, quiet: bool) -> u8 {
    match reading.case(file) {
        Ok(case) => {
            let end = RunEnd::of(&case, folder, aftermath);
            tell(&case, folder, quiet, end.and_then(|end| conclude(&case, folder, end, None)))
        }
        Err(errors) => refuse(&errors),
    }
}

/// Says what came out of a run; the result is its exit code.
fn tell(case: &Case, folder: &Path, quiet: bool, summary: io::Result<Summary>) -> u8 {
    match summary {
        Ok(summary) => {
            if !quiet {
                say(&outcome(&summary, case, folder));
            }
            for warning in &summary.warnings {
                complain(format!("{}: warning: {warning}", case.file().display()));
            }
            match &summary.message {
                None => DONE,
                Some(message) => {
                    complain(format!("{}: {message}", case.file().display()));
                    FAILED
                }
            }
        }
        Err(error) => {
            complain(format!("{}: {error}", case.file().display()));
            FAILED
        }
    }
}

/// Files that an earlier run may have left and this one may not write.
pub(super) fn remove_leftovers(folder: &Path) -> io::Result<()> {
    remove_conclusions(folder)?;
    let names = ["fields.pvd", checkpoint::FILE, checkpoint::PARTIAL].map(|name| folder.join(name));
    let printed = prints::FILES.map(|name| folder.join(name));
    remove(files(folder.join("fields"), "vtu").chain(names).chain(printed))
}

/// What is made when a run is over.
fn remove_conclusions(folder: &Path) -> io::Result<()> {
    let names = ["replay.json", "report.html", "summary.json"].map(|name| folder.join(name));
    remove(files(folder.join("plots"), "svg").chain(names))
}

/// The files of a folder with an extension.
fn files(folder: PathBuf, wanted: &'static str) -> impl Iterator<Item = PathBuf> {
    let files = fs::read_dir(folder).into_iter().flatten().flatten().map(|entry| entry.path());
    files.filter(move |path| path.extension().is_some_and(|extension| extension == wanted))
}

fn remove(leftovers: impl Iterator<Item = PathBuf>) -> io::Result<()> {
    for path in leftovers {
        match fs::remove_file(&path) {
            Err(error) if error.kind() != io::ErrorKind::NotFound => {
                return Err(io::Error::new(error.kind(), format!("{}: {error}", path.display())));
            }
            _ => {}
        }
    }
    Ok(())
}

fn run_into(case: &Case, folder: &Path, checkpoints: &Checkpoints, telling: Telling) -> io::Result<Summary> {
    fs::create_dir_all(folder)
        .map_err(|error| io::Error::new(error.kind(), format!("{}: {error}", folder.display())))?;
    let kept = checkpoints.from.as_deref().and_then(Kept::of);
    if kept.is_some() {
        remove_conclusions(folder)?
    } else {
        remove_leftovers(folder)?
    }
    case.announce();
    let _prints = Prints::keep(folder, telling.echo)?;
    let columns = case.columns();
    let history_file = folder.join("history.csv");
    worker::note_start();
    let progress = Progress::new(&title(case), extent(case), shown(case), telling.quiet);
    let mut record = match kept {
        None => Record::new(&history_file, &columns, progress)?,
        Some(kept) => Record::resume(&history_file, &columns, progress, kept)?,
    };
    let (statistics, result, specimen) = match case {
        Case::Path(program) => {
            let (statistics, result) = path::run(program, &mut record);
            (statistics, result, None)
        }
        Case::Pullout(program) => {
            let mut outcome = pullout::run(program, folder, checkpoints, &mut record);
            let result = std::mem::replace(&mut outcome.result, Ok(()));
            (outcome.statistics, result, Some((&**program, outcome)))
        }
    };
    record.progress.finish();
    let message = match result {
        Ok(()) => None,
        Err(Stop::Write(error)) => Some(error.to_string()),
        Err(Stop::Failed(failure)) if failure.replay.is_null() => Some(failure.message),
        Err(Stop::Failed(failure)) => {
            let replay = folder.join("replay.json");
            fs::write(&replay, format!("{:#}\n", failure.replay))?;
            Some(format!("{} (replay case: {})", failure.message, replay.display()))
        }
    };
    let [wall_time_s, cpu_time_s] = record.times();
    let end = RunEnd { peaks: record.peaks, statistics, message, wall_time_s, cpu_time_s: Some(cpu_time_s) };
    conclude(case, folder, end, specimen)
}

/// How a run ended.
struct RunEnd {
    peaks: PeakRecorder,
    statistics: Statistics,
    /// Why it failed.
    message: Option<String>,
    wall_time_s: f64,
    /// Not known of a process that was ended.
    cpu_time_s: Option<f64>,
}

/// CPU time of this process so far.
fn cpu_time() -> Duration {
    let time = rustix::time::clock_gettime(rustix::time::ClockId::ProcessCPUTime);
    Duration::try_from(time).unwrap_or_default()
}

impl RunEnd {
    /// Of a run that was ended from outside: its peaks are those of the rows that were written.
    fn of(case: &Case, folder: &Path, aftermath: &Aftermath) -> io::Result<Self> {
        let history = History::read(&folder.join("history.csv"))?;
        let mut peaks = PeakRecorder::new(&case.columns());
        history.each_row(|row| peaks.observe(&row));
        let Aftermath { message, statistics, wall_time_s } = aftermath.clone();
        Ok(Self { peaks, statistics, message: Some(message), wall_time_s, cpu_time_s: None })
    }
}

/// Writes summary, plots and report beside a history.
fn conclude(
    case: &Case,
    folder: &Path,
    end: RunEnd,
    mut specimen: Option<(&pullout::Program, pullout::Outcome<'_>)>,
) -> io::Result<Summary> {
    let mut summary = summarise(case, &end)?;
    summary.specimen = specimen.as_mut().map(|(_, outcome)| std::mem::take(&mut outcome.findings));
    if let Some(moved) = summary.specimen.as_ref().and_then(|findings| findings.initial_displacement) {
        summary.warnings.push(format!(
            "the initial stress was not in equilibrium with the supports and all drives at 0: before the first step nodes \
             moved by up to {moved:.3e} mm until it was"
        ));
    }
    let mut pictures = Vec::new();
    // a long history is read back only if something is made of it
    if case.draws_plots() || !case.compare().is_empty() {
        let history = History::read(&folder.join("history.csv"))?;
        summary.compare = case.compare().iter().map(|curve| compare(&history, curve)).collect();
        if case.draws_plots() {
            pictures = plots::draw(&folder.join("plots"), &history, &Spec::of(case))?;
            if let Some((program, outcome)) = &specimen {
                pictures.extend(pullout::pictures::draw(&folder.join("plots"), program, outcome)?);
            }
        }
    }
    summary.write(&folder.join("summary.json"))?;
    report::write(&folder.join("report.html"), &Account::of(case), &summary, &pictures)?;
    Ok(summary)
}

fn summarise(case: &Case, end: &RunEnd) -> io::Result<Summary> {
    let (plugin, plugins) = plugins(case)?;
    let statistics = &end.statistics;
    Ok(Summary {
        status: if end.message.is_none() { Status::Done } else { Status::Failed },
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
        warnings: warnings(case),
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
            Kind::Point(_) => &["e11", "s11"],
            Kind::Interface(_) => &["slip", "tau"],
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
    let done = if summary.status == Status::Done { "done" } else { "FAILED" };
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
            Kind::Point(_) => (&["s11", "s22", "s33", "s12", "s13", "s23"][..], "MPa"),
            Kind::Interface(_) => (&["tau", "p"][..], "MPa"),
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
