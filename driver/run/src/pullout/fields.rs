//! Fields of a run for ParaView.

use crate::input::{digest, hexadecimal};
use crate::isolation::worker;
use fe_core::model::Model;
use fe_core::output::{Fields, Series, SeriesFiles};
use fe_core::stepping::Snapshot;
use serde::{Deserialize, Serialize};
use std::io;
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

/// Writes the fields of increments, in addition to the history.
#[derive(Debug)]
pub struct FieldWriter {
    series: Series,
    /// Time of the last state that was written, s.
    last: Option<f64>,
    /// Time that the writing took.
    pub(super) spent: Duration,
    /// Directory, and SHA-256 of each file that was written, if checkpoints must record it.
    hashed: Option<(PathBuf, Vec<String>)>,
}

/// The files written.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct WrittenFields {
    files: SeriesFiles,
    /// SHA-256 of each.
    sha256: Vec<String>,
    last: Option<f64>,
}

impl WrittenFields {
    /// Says what of the files in a directory is not as it was written.
    pub(super) fn changed(&self, folder: &Path) -> Option<String> {
        let mut files = self.files.names().zip(&self.sha256);
        let changed = files.find(|(name, sha256)| hash(&folder.join(name)).ok().as_ref() != Some(*sha256));
        changed.map(|(name, _)| name.to_owned())
    }
}

fn hash(path: &Path) -> io::Result<String> {
    digest(path, u64::MAX).map(hexadecimal)
}

impl FieldWriter {
    /// Goes on after what was written.
    ///
    /// # Errors
    /// A file cannot be written or removed.
    pub fn resume(folder: &Path, model: &Model, written: &WrittenFields) -> io::Result<Self> {
        let series = Series::resume(folder, &model.mesh, written.files.clone())?;
        let hashed = Some((folder.to_owned(), written.sha256.clone()));
        Ok(Self { series, last: written.last, spent: Duration::ZERO, hashed })
    }

    /// Returns what was written so far.
    pub fn written(&self) -> WrittenFields {
        let sha256 = self.hashed.as_ref().map(|(_, sha256)| sha256.clone()).unwrap_or_default();
        WrittenFields { files: self.series.files().clone(), sha256, last: self.last }
    }

    /// Into `fields/` of a folder, indexed by `fields.pvd`; `is_hashed`: for checkpoints.
    ///
    /// # Errors
    /// The folder cannot be made.
    pub fn create(folder: &Path, model: &Model, is_hashed: bool) -> io::Result<Self> {
        let series = Series::create(folder, &model.mesh)?;
        let hashed = is_hashed.then(|| (folder.to_owned(), Vec::new()));
        Ok(Self { series, last: None, spent: Duration::ZERO, hashed })
    }

    /// Adds an increment.
    ///
    /// # Errors
    /// A file cannot be written.
    pub fn write(&mut self, snapshot: &Snapshot<'_>) -> io::Result<()> {
        let start = Instant::now();
        worker::look_after_plugins();
        self.series.write(&snapshot.model().mesh, &Fields::of(snapshot))?;
        if let Some((folder, sha256)) = &mut self.hashed {
            let new = self.series.files().names().skip(sha256.len());
            let new: io::Result<Vec<String>> = new.map(|name| hash(&folder.join(name))).collect();
            sha256.extend(new?);
        }
        self.last = Some(snapshot.time());
        self.spent += start.elapsed();
        Ok(())
    }

    /// Adds the last increment of a run, unless it was its turn.
    ///
    /// # Errors
    /// A file cannot be written.
    pub fn finish(&mut self, snapshot: &Snapshot<'_>) -> io::Result<()> {
        if self.last == Some(snapshot.time()) { Ok(()) } else { self.write(snapshot) }
    }
}
