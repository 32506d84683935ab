//! Makes the results of a run that has ended: comparison, pictures, summary and report, next to its history.

use crate::compare::{Comparison, compare};
use crate::directory::ResultDirectory;
use crate::history::{HistoryFile, Rows};
use crate::page::{self, Account};
use crate::pictures;
use crate::plots::{self, Drawings, Spec};
use crate::record::RunRecorder;
use crate::summary::{self, PeakRecorder, PluginFile, PluginOf, Summary};
use crate::viewer::ViewerStates;
use maud::Markup;
use pullout_case::Case;
use pullout_run::isolation::Aftermath;
use pullout_run::path::{FailedAt, Statistics};
use pullout_run::pullout;
use std::io;
use std::path::Path;
use umat_abi::host::{LawDescription, Library};

/// A specimen's program and what its run gave.
pub type SpecimenRun<'p> = (&'p pullout::PulloutProgram, pullout::SpecimenOutcome);

/// Writes summary, plots and report next to a history. The summary comes first, so that no failing picture can prevent it.
/// The second result is what could not be written. `draws`: whether pictures are wanted.
///
/// # Errors
/// The summary cannot be written as JSON.
pub fn conclude(
    case: &Case,
    directory: &mut ResultDirectory,
    summary: Summary,
    specimen: Option<&SpecimenRun<'_>>,
    states: &ViewerStates,
    draws: bool,
) -> io::Result<(Summary, io::Result<()>)> {
    let compared = match case.about().compare.is_empty() {
        true => Ok(Vec::new()),
        false => HistoryFile::open(&directory.path().join("history.csv")).and_then(|rows| compare_all(case, &rows)),
    };
    write(case, directory, summary, compared, |directory| {
        if draws { draw(case, directory, specimen, states) } else { Ok(Default::default()) }
    })
}

/// Writes a summary with comparisons, and the report of it with what is drawn. The second result is what could not be
/// written.
pub(crate) fn write(
    case: &Case,
    directory: &mut ResultDirectory,
    mut summary: Summary,
    compared: io::Result<Vec<Comparison>>,
    draw: impl FnOnce(&mut ResultDirectory) -> io::Result<(Drawings, Option<Markup>)>,
) -> io::Result<(Summary, io::Result<()>)> {
    summary.take_comparisons(compared.as_ref().map(Vec::clone).unwrap_or_default());
    let text = summary.text()?;
    let written = directory.write(summary::FILE, text).and_then(|_| directory.remove_earlier()).and_then(|()| {
        let drawn = draw(directory);
        let (drawings, viewer) = drawn.as_ref().map_or(Default::default(), Clone::clone);
        page::write(directory, &Account::of(case), &mut summary, &drawings, viewer.as_ref())?;
        directory.finish()?;
        drawn.and(compared.map(|_| ()))
    });
    Ok((summary, written))
}

/// Compares a history with all curves of its case.
///
/// # Errors
/// The history cannot be read.
pub fn compare_all(case: &Case, history: &impl Rows) -> io::Result<Vec<Comparison>> {
    case.about().compare.iter().map(|curve| compare(history, curve)).collect()
}

/// Draws the history, and a specimen.
fn draw(
    case: &Case,
    directory: &mut ResultDirectory,
    specimen: Option<&SpecimenRun<'_>>,
    states: &ViewerStates,
) -> io::Result<(Drawings, Option<Markup>)> {
    let history = HistoryFile::open(&directory.path().join("history.csv"))?.for_pictures()?;
    let mut drawings = plots::draw(directory, plots::FOLDER, &history, &Spec::of(case, Account::of(case).inputs()))?;
    let Some((program, outcome)) = specimen else { return Ok((drawings, None)) };
    drawings.append(pictures::draw(directory, program, outcome)?);
    Ok((drawings, states.page(program, &history, outcome.peak.as_ref())?))
}

/// Summarises a recorded run, without comparisons with curves. `message` and `failed_at` say why it failed.
///
/// # Errors
/// A plugin's file cannot be read.
pub fn summarise(
    case: &Case,
    record: &mut RunRecorder,
    statistics: Statistics,
    message: Option<String>,
    failed_at: Option<FailedAt>,
    specimen: Option<&mut SpecimenRun<'_>>,
) -> io::Result<Summary> {
    let [wall_time_s, cpu_time_s] = record.times();
    let aftermath = Aftermath { message, is_interrupted: record.was_ended(), failed_at, statistics, wall_time_s };
    let mut summary = summary_of(case, aftermath)?;
    summary.peaks = record.peaks.peaks();
    summary.cpu_time_s = Some(cpu_time_s);
    summary.reached = record.take_reached(case.columns());
    summary.warnings.append(&mut record.warnings);
    summary.specimen = specimen.map(|(_, outcome)| std::mem::take(&mut outcome.findings));
    let moved = summary.specimen.as_ref().and_then(|findings| findings.initial_displacement);
    summary.warnings.extend(moved.map(|moved| {
        format!(
            "the initial stress was not in equilibrium with the supports and the loads at the start: before the first step nodes \
             moved by up to {moved:.3e} mm until it was"
        )
    }));
    Ok(summary)
}

/// Says what came out of a run that was ended from outside: its peaks are those of the rows that were written.
///
/// # Errors
/// The history or a plugin's file cannot be read.
pub fn summarise_rows(case: &Case, folder: &Path, aftermath: Aftermath) -> io::Result<Summary> {
    let mut peaks = PeakRecorder::new(&case.columns());
    HistoryFile::open(&folder.join("history.csv"))?.each_row(|row| peaks.observe(&row))?;
    Ok(Summary { peaks: peaks.peaks(), ..summary_of(case, aftermath)? })
}

/// Says how a run of a case ended, which plugins it called, and what the case and they warn of.
fn summary_of(case: &Case, aftermath: Aftermath) -> io::Result<Summary> {
    let (plugin, plugins) = plugins(case)?;
    let (title, notes) = (case.about().title.clone(), case.about().notes.clone());
    Ok(Summary { title, plugin, plugins, warnings: warnings(case), notes, ..Summary::of(aftermath) })
}

/// The plugin of a point; of a specimen, the first contact pair's or else the first part's, and all of them.
fn plugins(case: &Case) -> io::Result<(PluginFile, Vec<PluginOf>)> {
    let version = |law: Option<&LawDescription>| law.map_or(String::new(), |law| law.version.clone());
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
        Case::Bridging(_) => Ok(Default::default()),
    }
}

/// The case's warnings, and those that a run adds.
fn warnings(case: &Case) -> Vec<String> {
    let mut warnings = case.about().warnings.to_vec();
    let libraries: Vec<(&str, &Library)> = match case {
        Case::Path(program) => vec![(&program.plugin.name, &program.plugin.library)],
        Case::Pullout(program) => {
            program.laws().into_iter().map(|(_, law)| (law.name.as_str(), &law.library)).collect()
        }
        Case::Bridging(_) => Vec::new(),
    };
    for (name, library) in libraries.iter().filter(|(_, library)| library.calls_change_floating_point()) {
        warnings.push(format!(
            "{}: calls of '{name}' switched the processor's floating-point modes (flush to zero, rounding, traps); pullout restored them after each call",
            library.path().display()
        ));
    }
    for (name, library) in libraries {
        let written = library.written_inputs();
        let Some([step, increment, ..]) = written.values().map(|written| written.place).min() else { continue };
        let names: Vec<String> = written.iter().map(|(name, written)| written.named(name)).collect();
        warnings.push(format!(
            "{}: '{name}' writes {}, which are inputs (first in step {step}, increment {increment}): each call gets copies, so its changes were lost",
            library.path().display(),
            names.join(", ")
        ));
    }
    warnings
}
