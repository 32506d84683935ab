//! Messages of the command line on a study: runs as they end, and the outcome.

use super::claims::{ClaimFinding, Verdict};
use super::execution::RunOutcome;
use super::results::{Results, RunResult};
use super::{Study, StudyRun};
use indicatif::{ProgressBar, ProgressStyle};
use pullout_run::number::significant;
use pullout_run::signals;
use std::fmt::Write;
use std::io::{self, IsTerminal};
use std::path::Path;
use std::time::Duration;

/// Reports runs as they end, with a progress bar if the standard error is a terminal.
pub struct StudyProgress<'s> {
    study: &'s Study,
    /// Result directory of the study.
    folder: &'s Path,
    bar: Option<ProgressBar>,
    quiet: bool,
}

impl<'s> StudyProgress<'s> {
    /// Begins with no run; `folder` is the result directory of the study. `quiet`: nothing is reported.
    pub fn new(study: &'s Study, folder: &'s Path, quiet: bool) -> Self {
        let bar = (!quiet && io::stderr().is_terminal()).then(|| {
            let style = ProgressStyle::with_template("{bar:30} {pos}/{len} runs, {elapsed}");
            let bar = ProgressBar::new(study.runs.len() as u64);
            if let Ok(style) = style {
                bar.set_style(style);
            }
            bar.enable_steady_tick(Duration::from_secs(1));
            bar
        });
        Self { study, folder, bar, quiet }
    }

    /// Records a run that ended with an exit code, the `count`-th of `of` that are due. Returns a line for the standard
    /// output, unless the bar shows it.
    pub fn ended(&self, run: &StudyRun, code: u8, count: usize, of: usize) -> Option<String> {
        if self.quiet {
            return None;
        }
        let result = RunResult::read(run, self.study, self.folder, RunOutcome::Ran(code));
        let (name, unit) = (self.study.name_of(run), &self.study.units[1]);
        let peak = result.peak.map_or(String::new(), |peak| format!(", peak {} {unit}", significant(peak, 5)));
        let time = result.summary.as_ref().map_or(String::new(), |s| format!(", {} s", significant(s.wall_time_s, 3)));
        let how = match code {
            0 => String::from("done"),
            _ if signals::received().is_some() => "interrupted".into(),
            // its increments went to their end, but a file of its results could not be written
            _ if result.is_done() => format!("done, FAILED with exit code {code}"),
            _ => "FAILED".into(),
        };
        let line = format!("[{count}/{of}] {name}: {how}{peak}{time}");
        let Some(bar) = &self.bar else { return Some(line + "\n") };
        bar.set_length(of as u64);
        bar.set_position(count as u64);
        bar.println(line);
        None
    }

    /// Takes the bar away.
    pub fn finish(&self) {
        self.bar.iter().for_each(ProgressBar::finish_and_clear);
    }
}

/// Returns lines with the number of runs done and the verdict on each claim. `folder`: where the results are.
pub fn outcome(study: &Study, results: &Results, findings: &[ClaimFinding], folder: &Path) -> String {
    let count = |wanted: fn(&RunResult) -> bool| results.runs.iter().filter(|run| wanted(run)).count();
    let (done, kept) = (count(RunResult::is_done), count(|run| run.is_kept));
    let kept = if kept > 0 { format!(" ({kept} as they were)") } else { String::new() };
    let mut text =
        format!("{}: {done} of {} runs done{kept} -> {}\n", study.title, results.runs.len(), folder.display());
    for ClaimFinding { claim, verdict, figures, .. } in findings {
        let mark = if *verdict == Verdict::Holds { ' ' } else { '!' };
        // writing to a String cannot fail
        let _ = writeln!(text, "{mark} {}: {claim}", verdict.words());
        figures.iter().for_each(|line| {
            let _ = writeln!(text, "      {line}");
        });
    }
    text
}
