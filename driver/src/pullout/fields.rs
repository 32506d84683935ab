//! Fields of a run for ParaView.

use fe_core::model::Model;
use fe_core::output::{Fields, Series};
use fe_core::stepping::Snapshot;
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

impl FieldWriter {
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
