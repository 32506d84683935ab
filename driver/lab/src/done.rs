//! Shows finished runs.

use pullout_report::history::History;
use pullout_report::plots::Spec;
use pullout_report::summary::{self, Summary};
use serde_json::Value;
use std::io;
use std::path::Path;

/// A run that is over.
#[derive(Debug)]
pub(crate) struct Done {
    /// All rows.
    pub history: History,
    /// How it ended, and what came out.
    pub summary: Summary,
    /// A case that repeats what failed.
    pub replay: Option<Value>,
    /// What the law printed.
    pub prints: String,
    /// What is drawn; `None`: nothing came so far.
    pub spec: Option<Spec>,
    /// Time that it took.
    pub milliseconds: f64,
}

impl Done {
    /// Reads a run from its result directory.
    pub fn read(folder: &Path) -> io::Result<Self> {
        let summary = Summary::read(&folder.join(summary::FILE))?;
        let history = History::of_run(folder, |table| table.read())?;
        let (spec, milliseconds) = (Some(Spec::of_run(folder)?), 1e3 * summary.wall_time_s);
        Ok(Self { history, summary, replay: None, prints: String::new(), spec, milliseconds })
    }

    /// The case's title.
    pub fn title(&self) -> &str {
        &self.summary.title
    }
}
