//! The names of results.

use serde::{Deserialize, Serialize};
use std::collections::BTreeSet;
use std::fs;
use std::path::{Component, Path};

/// Source of results.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Kind {
    /// A case.
    Run,
    /// A case that a study runs.
    Member,
    /// A study.
    Study,
    /// A fit.
    Fit,
    /// Pictures alone.
    Pictures,
}

/// Files that a run writes while it goes on. `#` is a number, `*` any text.
const GROWING: [&str; 13] = [
    "history.csv",
    "checkpoint.bin",
    "checkpoint.partial",
    "fields.pvd",
    "fields.partial",
    "fields/#.vtu",
    "fields/#.partial",
    "fields/contact_#.vtu",
    "fields/contact_#.partial",
    // a law's own output
    "umat.log",
    "umat.msg",
    "replay.json",
    "increments.json",
];
/// Other files that would be replaced, or taken for results.
const RUN: [&str; 11] = [
    "summary.json",
    "report.html",
    "bridging.csv",
    "beam.csv",
    "scatter.csv",
    "fibres.csv",
    "abaqus.inp",
    "crack_band.csv",
    "fields/*.vtu",
    "plots/*.svg",
    "plots/spec.json",
];
/// Files that a study writes into the directory of a run.
const MEMBER: [&str; 2] = ["run.json", "output.txt"];
const STUDY: [&str; 5] = ["study.csv", "study.json", "report.html", "plots/*.svg", "plots/*.png"];
const FIT: [&str; 18] = [
    "curve.csv",
    "fit.json",
    "report.html",
    "powers-law.json",
    "powers-case.json",
    "powers-curve.csv",
    "piecewise-law.json",
    "piecewise-case.json",
    "piecewise-curve.csv",
    "fitted-case.json",
    "fitted-curve.csv",
    // of several tests
    "fitted-case-#.json",
    "fitted-curve-#.csv",
    "sigma.csv",
    "bond-case.json",
    "abaqus.inp",
    "crack_band.csv",
    "plots/*.svg",
];

/// Picture files, next to results or in a directory of their own.
const PICTURES: [&str; 12] = [
    "*.svg",
    "*.png",
    "*.pdf",
    "*.gif",
    "plots/*.svg",
    "plots/*.png",
    "plots/*.pdf",
    "plots/*.gif",
    "compared/*.svg",
    "compared/*.png",
    "compared/*.pdf",
    "spec.json",
];

/// Returns whether results of any kind may have this name, or are claimed by it as a pattern.
pub(super) fn is_of_results(name: &str) -> bool {
    let patterns = [&GROWING[..], &RUN, &MEMBER, &STUDY, &FIT, &PICTURES, &[super::MANIFEST]].concat();
    patterns.into_iter().any(|pattern| pattern == name || fits(pattern, name))
}

/// A folder of earlier results.
pub(super) fn is_aside(folder: &str) -> bool {
    folder == ASIDE || fits("previous-#", folder)
}

/// The first of these folders.
pub(super) const ASIDE: &str = "previous";

impl Kind {
    /// Returns what is claimed when results begin; other files when they are written.
    pub(super) fn claims(self) -> &'static [&'static str] {
        match self {
            Self::Run | Self::Member => &GROWING,
            Self::Study | Self::Fit | Self::Pictures => &[],
        }
    }

    /// Patterns of all names that results may have.
    fn patterns(self) -> Vec<&'static str> {
        match self {
            Self::Run => [&GROWING[..], &RUN].concat(),
            Self::Member => [&GROWING[..], &RUN, &MEMBER].concat(),
            Self::Study => STUDY.to_vec(),
            Self::Fit => FIT.to_vec(),
            Self::Pictures => Vec::new(),
        }
    }

    /// Files in a directory that have such a name.
    pub(super) fn present(self, directory: &Path) -> BTreeSet<String> {
        self.patterns().into_iter().flat_map(|pattern| present(pattern, directory)).collect()
    }

    /// Returns whether results of one kind may take the place of those of the other unasked.
    pub(super) fn agrees_with(self, other: Self) -> bool {
        self.words() == other.words()
    }

    /// "a run".
    pub(super) fn words(self) -> &'static str {
        match self {
            Self::Run | Self::Member => "a run",
            Self::Study => "a study",
            Self::Fit => "a fit",
            Self::Pictures => "several runs in pictures",
        }
    }
}

/// Files in a directory whose names fit a pattern; only the last part of a pattern is one.
pub(super) fn present(pattern: &str, directory: &Path) -> Vec<String> {
    if !pattern.contains(['*', '#']) {
        let is_there = is_file(&directory.join(pattern));
        return is_there.then(|| pattern.to_owned()).into_iter().collect();
    }
    let (folder, _) = pattern.rsplit_once('/').unwrap_or(("", pattern));
    let entries = fs::read_dir(directory.join(folder)).into_iter().flatten().flatten();
    let names = entries.filter(|entry| is_file(&entry.path())).filter_map(|entry| {
        let name = entry.file_name().into_string().ok()?;
        let name = if folder.is_empty() { name } else { format!("{folder}/{name}") };
        fits(pattern, &name).then_some(name)
    });
    names.collect()
}

/// A link to a folder is one as well.
fn is_file(path: &Path) -> bool {
    fs::symlink_metadata(path).is_ok_and(|entry| !entry.is_dir())
}

/// Returns whether a name leads nowhere but into a directory, as text: no `..`, not absolute.
pub(super) fn lies_within(name: &str) -> bool {
    !name.is_empty() && Path::new(name).components().all(|part| matches!(part, Component::Normal(_)))
}

/// Returns whether a name matches a pattern: `#` matches digits, `*` anything except `/`.
pub(super) fn fits(pattern: &str, name: &str) -> bool {
    let Some(wild) = pattern.find(['*', '#']) else { return pattern == name };
    let (before, rest) = pattern.split_at(wild);
    let after = &rest[1..];
    let middle = name.strip_prefix(before).and_then(|name| name.strip_suffix(after));
    let is_number = rest.starts_with('#');
    middle.is_some_and(|middle| {
        !middle.is_empty()
            && if is_number { middle.bytes().all(|byte| byte.is_ascii_digit()) } else { !middle.contains('/') }
    })
}
