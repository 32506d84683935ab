//! A fibre pulled out of a block: error against run time over mesh and increment, and what skipping saves.

pub(super) mod precision;
pub(super) mod skipping;

use super::runs::{Ran, run};
use super::{BenchError, Settings};
use std::path::PathBuf;
use tempfile::TempDir;

/// Chapter 7's base case.
const CASE: &str = include_str!("../../../cases/chapter-7/inclined-fibre.json");

/// Largest and first increment, mm.
const LARGEST_INCREMENT: f64 = 0.04;
const FIRST_INCREMENT: f64 = 2e-4;
/// and the least that one may be cut to.
const LEAST_INCREMENT: f64 = 2e-9;

/// The case as a file, for runs of it.
pub(super) struct Specimen<'s> {
    folder: TempDir,
    settings: &'s Settings,
    /// Pulled so far, mm.
    end: f64,
}

impl<'s> Specimen<'s> {
    pub fn new(settings: &'s Settings, end: f64) -> Result<Self, BenchError> {
        let specimen = Self { folder: tempfile::tempdir()?, settings, end };
        std::fs::write(specimen.file(), CASE)?;
        Ok(specimen)
    }

    fn file(&self) -> PathBuf {
        self.folder.path().join("case.json")
    }

    /// Runs it to the end with increments of at most so many mm.
    ///
    /// # Errors
    /// The case is refused, or the run does not reach its end, which it always does.
    pub fn run(&self, largest_increment: f64, set: &[String]) -> Result<Ran, BenchError> {
        let part = |increment: f64| (increment / self.end).min(1.0);
        let mut overrides = vec![
            format!("steps.0.slip={}", self.end),
            format!("steps.0.increments.initial={}", part(largest_increment.min(FIRST_INCREMENT))),
            format!("steps.0.increments.maximum={}", part(largest_increment)),
            format!("steps.0.increments.minimum={}", part(LEAST_INCREMENT)),
            "output.plots=false".into(),
        ];
        overrides.extend_from_slice(set);
        let ran = run(&self.file(), &overrides, &self.settings.plugin_paths, self.folder.path())?;
        match &ran.stopped {
            None => Ok(ran),
            Some(message) => Err(BenchError::Failed(format!("{}: {message}", set.join(" ")))),
        }
    }
}
