//! Many runs in a child: what it is told, and how it tells what came out.
//!
//! A row is with the supervisor once it is written; what ends the child takes nothing but the run that it is at, whose
//! number is the number of rows.

use crate::run::{Measured, measure};
use crate::store::{Store, Sweep};
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
}

/// Carries out a batch that is told in a file; its rows go to another.
///
/// # Errors
/// The files cannot be read or written.
pub fn carry_out(batch: &Path, rows: &Path) -> io::Result<()> {
    let start = Instant::now();
    let Batch { folder, sweep, seconds } = serde_json::from_slice(&fs::read(batch)?)?;
    let store = Store::new(&folder);
    let mut rows = out_of_reach(File::options().append(true).open(rows)?);
    let _prints = Prints::discard();
    let stop = Arc::new(AtomicBool::new(false));
    for run in 0..sweep.runs.len() {
        stop.store(signals::received().is_some(), Ordering::Relaxed);
        let Some(measured) = measure(&store, &sweep, run, &stop) else { break };
        rows.write_all(&framed(&measured)?)?;
        if start.elapsed() > Duration::from_secs_f64(seconds) {
            break;
        }
    }
    Ok(())
}

/// A row with its length before it.
fn framed(row: &Measured) -> io::Result<Vec<u8>> {
    let content = postcard::to_stdvec(row).map_err(io::Error::other)?;
    let length = u32::try_from(content.len()).map_err(io::Error::other)?;
    Ok([&length.to_le_bytes()[..], &content].concat())
}

/// The whole rows that a child wrote.
pub(crate) fn rows(mut content: &[u8]) -> Vec<Measured> {
    let mut rows = Vec::new();
    while let Some((length, rest)) = content.split_first_chunk() {
        let Ok(length) = usize::try_from(u32::from_le_bytes(*length)) else { break };
        let Some((row, rest)) = rest.split_at_checked(length) else { break };
        let Ok(row) = postcard::from_bytes(row) else { break };
        rows.push(row);
        content = rest;
    }
    rows
}
