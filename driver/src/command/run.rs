//! `pullout run` and `pullout check`.

use super::{BAD_INPUT, DONE, FAILED, Reading, complain, refuse, say};
use crate::case;
use crate::output::compare::compare;
use crate::output::history::{History, HistoryWriter};
use crate::output::plots::{self, Spec};
use crate::output::progress::Progress;
use crate::output::report::{self, Account};
use crate::output::summary::{PeakRecorder, PluginFile, Status, Summary};
use crate::path::program::{Kind, Program};
use crate::path::{self, Observer, Row, Statistics, Stop};
use std::collections::BTreeSet;
use std::fs;
use std::io;
use std::path::{Path, PathBuf};
use std::time::Instant;

/// Validates cases.
pub(super) fn check(cases: &[PathBuf], reading: &Reading) -> u8 {
    let mut code = DONE;
    for file in cases {
        match case::read(file, &reading.overrides, &reading.plugin_paths) {
            Ok(program) => {
                say(&format!("{}: no errors\n", file.display()));
                program.warnings.iter().for_each(|warning| complain(format!("{}: warning: {warning}", file.display())));
            }
            Err(errors) => code = code.max(refuse(&errors)),
        }
    }
    code
}

/// Runs cases, after all of them were read without an error.
pub(super) fn run(cases: &[PathBuf], out: Option<&Path>, reading: &Reading, quiet: bool) -> u8 {
    let mut stems = BTreeSet::new();
    let mut jobs = Vec::new();
    let mut code = DONE;
    for file in cases {
        let stem = file.file_stem().unwrap_or_default().to_owned();
        let folder = match out {
            Some(out) if cases.len() == 1 => out.to_path_buf(),
            Some(out) => out.join(&stem),
            None => Path::new("out").join(&stem),
        };
        if !stems.insert(stem) {
            complain(format!("{}: another case has the same name, and so the same result directory", file.display()));
            code = code.max(BAD_INPUT);
        }
        match case::read(file, &reading.overrides, &reading.plugin_paths) {
            Ok(program) => jobs.push((program, folder)),
            Err(errors) => code = code.max(refuse(&errors)),
        }
    }
    if code != DONE {
        return code;
    }
    jobs.iter().map(|(program, folder)| run_one(program, folder, quiet)).max().unwrap_or(DONE)
}

/// Runs one case and says what came out.
fn run_one(program: &Program, folder: &Path, quiet: bool) -> u8 {
    match run_into(program, folder, quiet) {
        Ok(summary) => {
            if !quiet {
                say(&outcome(&summary, program, folder));
            }
            for warning in &summary.warnings {
                complain(format!("{}: warning: {warning}", program.case_file.display()));
            }
            match &summary.message {
                None => DONE,
                Some(message) => {
                    complain(format!("{}: {message}", program.case_file.display()));
                    FAILED
                }
            }
        }
        Err(error) => {
            complain(format!("{}: {error}", program.case_file.display()));
            FAILED
        }
    }
}

/// Files that an earlier run may have left and this one may not write.
fn remove_leftovers(folder: &Path) -> io::Result<()> {
    let pictures = fs::read_dir(folder.join("plots")).into_iter().flatten().flatten().map(|entry| entry.path());
    let leftovers = pictures
        .filter(|path| path.extension().is_some_and(|extension| extension == "svg"))
        .chain(["replay.json", "report.html", "summary.json"].map(|name| folder.join(name)));
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

/// Writes the history as the run goes on, and knows the peaks and the progress.
struct Record {
    writer: HistoryWriter,
    peaks: PeakRecorder,
    progress: Progress,
    done: u64,
}

impl Observer for Record {
    fn row(&mut self, row: Row<'_>) -> io::Result<()> {
        if row.step == 0 {
            self.peaks.observe(&row);
        }
        self.writer.write(&row)
    }

    fn increment_done(&mut self, row: Row<'_>) {
        self.peaks.observe(&row);
        self.done += 1;
        self.progress.advance(self.done, row.values);
    }
}

fn run_into(program: &Program, folder: &Path, quiet: bool) -> io::Result<Summary> {
    fs::create_dir_all(folder)
        .map_err(|error| io::Error::new(error.kind(), format!("{}: {error}", folder.display())))?;
    remove_leftovers(folder)?;
    let columns = program.columns();
    let history_file = folder.join("history.csv");
    let start = Instant::now();
    let mut record = Record {
        writer: HistoryWriter::create(&history_file, &columns)?,
        peaks: PeakRecorder::new(&columns),
        progress: Progress::new(&title(program), path::increments(program), shown(program), quiet),
        done: 0,
    };
    let (statistics, result) = path::run(program, &mut record);
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
    let mut summary = summarise(program, &record.peaks, statistics, message, start.elapsed().as_secs_f64())?;
    let mut pictures = Vec::new();
    // a long history is read back only if something is made of it
    if program.output.plots || !program.compare.is_empty() {
        let history = History::read(&history_file)?;
        summary.compare = program.compare.iter().map(|curve| compare(&history, curve)).collect();
        if program.output.plots {
            pictures = plots::draw(&folder.join("plots"), &history, &Spec::of(program))?;
        }
    }
    summary.write(&folder.join("summary.json"))?;
    report::write(&folder.join("report.html"), &Account::of(program), &summary, &pictures)?;
    Ok(summary)
}

fn summarise(
    program: &Program,
    peaks: &PeakRecorder,
    statistics: Statistics,
    message: Option<String>,
    wall_time_s: f64,
) -> io::Result<Summary> {
    let plugin = &program.plugin;
    let version = plugin.law.as_ref().map_or("", |law| &law.version);
    let mut warnings = program.warnings.clone();
    if plugin.library.changes_floating_point() {
        warnings.push(format!(
            "loading '{}' changed the floating-point modes (flush-to-zero); they were restored, and are around each call",
            plugin.name
        ));
    }
    Ok(Summary {
        status: if message.is_none() { Status::Done } else { Status::Failed },
        message,
        title: program.title.clone(),
        plugin: PluginFile::identify(plugin.library.path(), version)?,
        peaks: peaks.peaks(),
        increments: statistics.increments,
        iterations: statistics.iterations,
        plugin_calls: statistics.plugin_calls,
        cutbacks: statistics.cutbacks,
        wall_time_s,
        compare: Vec::new(),
        warnings,
    })
}

fn title(program: &Program) -> String {
    let stem = program.case_file.file_stem().unwrap_or_default();
    stem.to_string_lossy().into_owned()
}

/// Columns that a progress line tells: the first strain and stress, or slip and traction.
fn shown(program: &Program) -> Vec<(String, usize)> {
    let names: &[&str] = match &program.kind {
        Kind::Point(_) => &["e11", "s11"],
        Kind::Interface(_) => &["slip", "tau"],
    };
    let columns = program.columns();
    // values begin behind step and increment
    let index = |name: &str| columns.iter().position(|column| column == name).map(|k| k - 2);
    names.iter().filter_map(|name| Some(((*name).to_owned(), index(name)?))).collect()
}

/// A few lines on standard output.
fn outcome(summary: &Summary, program: &Program, folder: &Path) -> String {
    use std::fmt::Write;
    let done = if summary.status == Status::Done { "done" } else { "FAILED" };
    let mut text = format!(
        "{}: {done}, {} increments, {} plugin calls, {:.3} s -> {}\n",
        title(program),
        summary.increments,
        summary.plugin_calls,
        summary.wall_time_s,
        folder.display()
    );
    let interesting = match &program.kind {
        Kind::Point(_) => &["s11", "s22", "s33", "s12", "s13", "s23"][..],
        Kind::Interface(_) => &["tau", "p"][..],
    };
    for name in interesting {
        if let Some(peak) = summary.peaks.get(*name)
            && let (Some(max), Some(min)) = (peak.max, peak.min)
            && (max.abs() > 1e-6 || min.abs() > 1e-6)
        {
            let _ = writeln!(text, "  {name}: max {max:.6} MPa, min {min:.6} MPa");
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
