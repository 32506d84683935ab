//! `summary.json`: what came out, for scripts.

use super::compare::Comparison;
use super::{at, extremes, malformed, without_rounding};
use indexmap::IndexMap;
use pullout_run::bridging;
use pullout_run::columns::{self, Group};
use pullout_run::input::{self, Input};
use pullout_run::isolation::Aftermath;
use pullout_run::path::{FailedAt, Row, Statistics};
use pullout_run::pullout::Findings;
use serde::{Deserialize, Serialize};
use std::io;
use std::path::Path;

#[cfg(test)]
pub(crate) mod test;

/// Name of the file in the result directory.
pub const FILE: &str = "summary.json";

/// End of a run.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Status {
    /// Done to the end, or to an `until`.
    #[default]
    Done,
    /// No convergence or a plugin error; everything up to there is kept.
    Failed,
    /// A signal (Ctrl-C, SIGTERM); everything up to there is kept.
    Interrupted,
}

/// The content of `summary.json`.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Summary {
    /// End of the run.
    pub status: Status,
    /// Reason why it failed; absent if it did not.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub message: Option<String>,
    /// Kind and place of the failure; absent if there was none.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub failed_at: Option<FailedAt>,
    /// State of a point in which the increment was given up, by columns; absent if there is none.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub reached: Option<IndexMap<String, f64>>,
    /// The case's title.
    pub title: String,
    /// The plugin that was called.
    pub plugin: PluginFile,
    /// The plugins of a specimen's parts and contact pairs; empty for a point.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub plugins: Vec<PluginOf>,
    /// Extremes of each column from the fourth on, over all increments (written to the history or not).
    pub peaks: IndexMap<String, Peak>,
    /// Increments done.
    pub increments: u64,
    /// Newton iterations.
    pub iterations: u64,
    /// Calls of the plugin.
    pub plugin_calls: u64,
    /// Halvings of increments.
    pub cutbacks: u64,
    /// Seconds from start to end, pictures excluded.
    pub wall_time_s: f64,
    /// CPU time of the process from start to end, pictures excluded, s; absent where it was not measured.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub cpu_time_s: Option<f64>,
    /// One entry per `compare` of the case.
    pub compare: Vec<Comparison>,
    /// Findings that only specimens have.
    #[serde(flatten)]
    pub specimen: Option<Findings>,
    /// Findings that only bridging has.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub bridging: Option<bridging::Findings>,
    /// Things the user should know although nothing is wrong.
    pub warnings: Vec<String>,
    /// Facts of the model that every case of its kind has.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub notes: Vec<String>,
}

impl Summary {
    /// Says how a run ended and what it cost.
    pub fn of(aftermath: Aftermath) -> Self {
        let Aftermath { message, is_interrupted, failed_at, statistics, wall_time_s } = aftermath;
        let Statistics { increments, iterations, plugin_calls, cutbacks } = statistics;
        let status = match &message {
            None => Status::Done,
            Some(_) if is_interrupted => Status::Interrupted,
            Some(_) => Status::Failed,
        };
        let blank = Self::default();
        Self { status, message, failed_at, increments, iterations, plugin_calls, cutbacks, wall_time_s, ..blank }
    }

    /// Takes the comparisons with measured curves, and what they warn of.
    pub fn take_comparisons(&mut self, compared: Vec<Comparison>) {
        self.warnings.extend(compared.iter().filter_map(|comparison| comparison.warning.clone()));
        self.compare = compared;
    }

    /// The content of [`FILE`].
    ///
    /// # Errors
    /// The summary holds what JSON cannot.
    pub fn text(&self) -> io::Result<String> {
        Ok(serde_json::to_string_pretty(self).map_err(io::Error::other)? + "\n")
    }

    /// Returns the peaks for people: a value that is rounding compared with the largest of its kind becomes 0.
    pub fn peaks_without_rounding(&self) -> IndexMap<&str, Peak> {
        let mut greatest: Vec<(&str, Group, f64)> = Vec::new();
        // of one kind is what has a unit in common, and numbers without one of the same group
        let kind = |name: &str| match columns::shown(name) {
            Some((_, "", Group::Other)) | None => None,
            Some((_, "", group)) => Some(("", group)),
            Some((_, unit, _)) => Some((unit, Group::Other)),
        };
        let of = |greatest: &[(&str, Group, f64)], kind: (&str, Group)| {
            greatest.iter().position(|(unit, group, _)| (*unit, *group) == kind)
        };
        let magnitude = |peak: &Peak| extremes([peak.max, peak.min].into_iter().flatten().map(f64::abs)).1;
        for (name, peak) in &self.peaks {
            let Some(kind) = kind(name) else { continue };
            match of(&greatest, kind) {
                Some(place) => greatest[place].2 = greatest[place].2.max(magnitude(peak)),
                None => greatest.push((kind.0, kind.1, magnitude(peak))),
            }
        }
        let shown = |(name, peak): (&'_ String, &Peak)| {
            let place = kind(name).and_then(|kind| of(&greatest, kind));
            let scale = place.map_or_else(|| magnitude(peak), |place| greatest[place].2);
            let [max, min] = [peak.max, peak.min].map(|value| value.map(|value| without_rounding(value, scale)));
            Peak { max, min, ..*peak }
        };
        self.peaks.iter().map(|entry| (entry.0.as_str(), shown(entry))).collect()
    }

    /// Reads a file.
    pub fn read(path: &Path) -> io::Result<Self> {
        let text = input::read(path, Input::Result).map_err(at(path))?;
        serde_json::from_slice(&text).map_err(|error| malformed(path, error))
    }
}

/// Identity of a plugin's file.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct PluginFile {
    /// Path of the file that it was loaded from.
    pub path: String,
    /// Version as the metadata have it; empty for a plain UMAT.
    pub version: String,
    /// SHA-256 of the file's bytes, hexadecimal.
    pub sha256: String,
}

/// The plugin of a part or of contact pairs.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct PluginOf {
    /// "part fibre", "contact left, right".
    #[serde(rename = "of")]
    pub subject: String,
    /// The law's name.
    pub law: String,
    /// The file.
    #[serde(flatten)]
    pub file: PluginFile,
}

impl PluginFile {
    /// Hashes the file.
    pub fn identify(path: &Path, version: &str) -> io::Result<Self> {
        let sha256 = input::digits(input::hash(path, Input::Library).map_err(at(path))?);
        Ok(Self { path: path.display().to_string(), version: version.to_owned(), sha256 })
    }
}

/// Extremes of a column. `None` (null) if the column holds no finite number.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Peak {
    /// Greatest value.
    pub max: Option<f64>,
    /// Least value.
    pub min: Option<f64>,
    /// Line in which it was greatest (first time).
    pub max_at: Option<HistoryLine>,
    /// Line in which it was least (first time).
    pub min_at: Option<HistoryLine>,
}

/// A line of the history.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct HistoryLine {
    /// Step.
    pub step: u32,
    /// Increment.
    pub increment: u32,
    /// Total time.
    pub time: f64,
}

/// Gathers the peaks of columns during a run, increments that `output.every` leaves out included.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
pub struct PeakRecorder(Vec<(String, Peak)>);

impl PeakRecorder {
    /// Makes a peak recorder for a history with these columns.
    pub fn new(columns: &[String]) -> Self {
        let last = columns.len().saturating_sub(1).max(3.min(columns.len()));
        let names = columns.get(3..last).unwrap_or_default();
        Self(names.iter().map(|name| (name.clone(), Peak::default())).collect())
    }

    /// Takes an increment into account.
    pub fn observe(&mut self, row: &Row<'_>) {
        let Some((&time, values)) = row.values.split_first() else { return };
        let line = Some(HistoryLine { step: row.step, increment: row.increment, time });
        let columns = self.0.iter_mut().map(|(_, peak)| peak).zip(values);
        for (peak, &value) in columns.filter(|(_, value)| value.is_finite()) {
            if peak.max.is_none_or(|max| value > max) {
                (peak.max, peak.max_at) = (Some(value), line);
            }
            if peak.min.is_none_or(|min| value < min) {
                (peak.min, peak.min_at) = (Some(value), line);
            }
        }
    }

    /// The peaks, in the history's order.
    pub fn peaks(&self) -> IndexMap<String, Peak> {
        self.0.iter().cloned().collect()
    }
}
