//! Batch of runs in a child: its input, and the report of its results.
//!
//! A row is kept once it is written (`claim`); what ends the child takes nothing but the run that it is at.

use crate::claim::{BEGINS, encoded, framed};
use crate::run::measure;
use crate::store::{Store, Sweep};
use pullout_report::at;
use pullout_run::isolation::{out_of_reach, prints::Prints};
use pullout_run::signals;
use serde::{Deserialize, Serialize};
use std::fs::{self, File};
use std::io::{self, Write};
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};

/// Runs of a child.
#[derive(Debug, Serialize, Deserialize)]
pub(crate) struct Batch {
    /// The store.
    pub folder: PathBuf,
    /// The runs alone.
    pub sweep: Sweep,
    /// Seconds after which it ends, behind the run that is over.
    pub seconds: f64,
    /// Whether the cases are from an unknown source.
    pub is_untrusted: bool,
}

/// Carries out a batch that a file describes; its rows go to another.
///
/// # Errors
/// The files cannot be read or written.
pub fn carry_out(batch: &Path, rows: &Path) -> io::Result<()> {
    let start = Instant::now();
    let Batch { folder, sweep, seconds, is_untrusted } = serde_json::from_slice(&fs::read(batch)?)?;
    let store = Store::new(&folder);
    let named = rows;
    let mut rows = out_of_reach(File::options().append(true).open(named).map_err(at(named))?);
    let _prints = Prints::discard();
    let stop = Arc::new(AtomicBool::new(false));
    rows.write_all(&BEGINS).map_err(at(named))?;
    for run in 0..sweep.runs.len() {
        stop.store(signals::received().is_some(), Ordering::Relaxed);
        let Some(measured) = measure(&store, &sweep, run, is_untrusted, &stop) else { break };
        let mut row = framed(&encoded(&measured)?)?;
        let is_last = run + 1 == sweep.runs.len() || start.elapsed() > Duration::from_secs_f64(seconds);
        if !is_last {
            row.extend(BEGINS);
        }
        rows.write_all(&row).map_err(at(named))?;
        if is_last {
            break;
        }
    }
    Ok(())
}
