//! Fields of a run for ParaView.

use fe_core::model::Model;
use fe_core::output::{Fields, Series, SeriesFiles};
use fe_core::stepping::Snapshot;
use serde::{Deserialize, Serialize};
use std::io;
use std::path::Path;
use std::time::{Duration, Instant};

/// Writes the fields of increments beside the history.
#[derive(Debug)]
pub struct FieldWriter {
    series: Series,
    /// Time of the last state that was written, s.
    last: Option<f64>,
    spent: Duration,
}

/// What was written.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct WrittenFields {
    files: SeriesFiles,
    last: Option<f64>,
}

impl FieldWriter {
    /// Goes on after what was written.
    ///
    /// # Errors
    /// A file cannot be written or removed.
    pub fn resume(folder: &Path, model: &Model, written: &WrittenFields) -> io::Result<Self> {
        let series = Series::resume(folder, &model.mesh, written.files.clone()).map_err(io::Error::other)?;
        Ok(Self { series, last: written.last, spent: Duration::ZERO })
    }

    /// What was written so far.
    pub fn written(&self) -> WrittenFields {
        WrittenFields { files: self.series.files().clone(), last: self.last }
    }

    /// Into `fields/` of a folder, indexed by `fields.pvd`.
    ///
    /// # Errors
    /// The folder cannot be made.
    pub fn create(folder: &Path, model: &Model) -> io::Result<Self> {
        let series = Series::create(folder, &model.mesh).map_err(io::Error::other)?;
        Ok(Self { series, last: None, spent: Duration::ZERO })
    }

    /// Adds an increment.
    ///
    /// # Errors
    /// A file cannot be written.
    pub fn write(&mut self, snapshot: &Snapshot<'_>) -> io::Result<()> {
        let start = Instant::now();
        self.series.write(&Fields::of(snapshot)).map_err(io::Error::other)?;
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

    /// How long it took to write.
    pub fn spent(&self) -> Duration {
        self.spent
    }
}
