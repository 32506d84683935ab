//! Batch of runs in a child: its input, and the report of its results.
//!
//! A row is kept once it is written (`claim`); what ends the child takes nothing but the run that it is at.

use crate::claim::{BEGINS, encoded, framed};
use crate::run::measure;
use crate::store::{Store, Sweep};
use pullout_report::at;
use pullout_run::isolation::{self, Work, out_of_reach, prints::Prints};
use pullout_run::signals;
use serde::{Deserialize, Serialize};
use std::fs::File;
use std::io::{self, Write};
use std::path::PathBuf;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};

/// Runs of a child.
#[derive(Debug, Serialize, Deserialize)]
pub struct Batch {
    /// The store.
    #[serde(with = "isolation::path")]
    pub(crate) folder: PathBuf,
    /// File of the rows.
    #[serde(with = "isolation::path")]
    pub(crate) rows: PathBuf,
    /// The runs alone.
    pub(crate) sweep: Sweep,
    /// Seconds after which it ends, once the current run is finished.
    pub(crate) seconds: f64,
    /// Whether the cases are from an unknown source.
    pub is_untrusted: bool,
}

impl Work for Batch {
    const NAME: &'static str = "batch";
}

impl Batch {
    /// Carries it out.
    ///
    /// # Errors
    /// The files cannot be read or written.
    pub fn carry_out(&self) -> io::Result<()> {
        let start = Instant::now();
        let Self { folder, rows, sweep, seconds, is_untrusted } = self;
        let store = Store::new(folder);
        let mut file = out_of_reach(File::options().append(true).open(rows).map_err(at(rows))?);
        let _prints = Prints::discard();
        let stop = Arc::new(AtomicBool::new(false));
        file.write_all(&BEGINS).map_err(at(rows))?;
        for run in 0..sweep.runs.len() {
            stop.store(signals::received().is_some(), Ordering::Relaxed);
            let Some(measured) = measure(&store, sweep, run, *is_untrusted, &stop) else { break };
            let mut row = framed(&encoded(&measured)?)?;
            let is_last = run + 1 == sweep.runs.len() || start.elapsed() > Duration::from_secs_f64(*seconds);
            if !is_last {
                row.extend(BEGINS);
            }
            file.write_all(&row).map_err(at(rows))?;
            if is_last {
                break;
            }
        }
        Ok(())
    }
}
