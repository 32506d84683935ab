//! Runs cases for other programs: what comes out stays in memory, nothing is written or printed.
//!
//! A case is read ([`CaseSource::read`]) and run ([`Prepared::run`]); rows, summary, and the kind and place of a failure
//! make an [`Outcome`]. Another thread ends a run by a flag. The command `pullout run` follows a case by the same
//! function and differs in where the rows go: [`run_into`] a folder.
//!
//! Libraries that were not built with this program may end the process that calls them. Cases that call one run in a child,
//! as do those of kind "bridging" that start others or make beams at random: a [`Job`] into a folder of which nothing stays.
//! [`set_program`] says which file the program is.

mod apart;
mod here;
mod job;
mod key;

pub use fe_core::stepping::{Along, Trail};
pub use here::{interrupted, run_into};
pub use job::{Inspection, Job, Keep, Message, RunOptions};
pub use key::RunKey;
pub use pullout_run::isolation::{identity, let_all_in, set_program};

use pullout_case::{Case, CaseErrors, Reader};
use pullout_report::history::History;
use pullout_report::plots::Spec;
use pullout_report::progress::Listener;
use pullout_report::summary::{Status, Summary};
use pullout_run::input::{self, Input};
use pullout_run::isolation::{self, Need};
use pullout_run::{bridging, columns};
use serde::{Deserialize, Serialize};
use serde_json::Value;
use std::collections::BTreeMap;
use std::io;
use std::num::NonZeroUsize;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::atomic::AtomicBool;

/// A case before it is read.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct CaseSource {
    /// The case file; of a document the file in which it would stand, by whose folder names in it are resolved.
    #[serde(with = "isolation::path")]
    pub file: PathBuf,
    /// The document to use instead of the file's.
    pub document: Option<Value>,
    /// Changes, each as `a.b.c=VALUE`.
    pub overrides: Vec<String>,
    /// Folders where plugins are looked for first.
    #[serde(with = "isolation::paths")]
    pub plugin_paths: Vec<PathBuf>,
    /// Whether it is from an unknown source (`--untrusted`).
    pub is_untrusted: bool,
}

/// A case that was read.
#[derive(Debug)]
pub struct Prepared {
    source: CaseSource,
    /// The case, if it runs in this process; else it runs in a child.
    case: Option<Box<Case>>,
}

/// Settings of a run.
#[derive(Default)]
pub struct Settings {
    /// Number of threads that share the work of a case of kind "pullout". The results do not depend on it, to the bit.
    pub threads: Option<NonZeroUsize>,
    /// Ends the run when it is set: within an increment of a point, or an iteration of a specimen.
    pub stop: Arc<AtomicBool>,
    /// Keeps the increments, so that another run can repeat them, and the states of a specimen.
    pub records: bool,
    /// The states of a run of the same specimen with nearly the same numbers, along which this one goes: the difference of both
    /// is that of the solutions, whatever the tolerance, and costs an iteration or two in each increment. Not for a run in a child.
    pub along: Option<Along>,
    /// Makes the viewer of a specimen; not of a run in a child.
    pub views: bool,
    /// Receives the columns of the rows that the listener will hear, before the first; on the thread of [`Prepared::run`].
    pub columns: Option<Box<dyn FnOnce(Vec<String>) + Send>>,
    /// Receives progress, on the thread of [`Prepared::run`] or, of a specimen with several threads, on one of these.
    pub listener: Option<Listener>,
    /// Folder for the fields that the case asks for; without one they are left out.
    pub fields: Option<PathBuf>,
}

/// JSON that a run makes in addition to rows and summary, by the name of its file in a result folder, without ".json". A run in a child
/// has the same as one in this process.
pub type Documents = BTreeMap<String, Value>;

/// A case that repeats the increment that failed, or the call that ended the child.
pub const REPLAY: &str = "replay";
/// The increments of a finished run, if they are kept: `"increments": {"recorded": …}` in a case that repeats them.
pub const INCREMENTS: &str = "increments";

/// Results of a run.
#[derive(Debug)]
pub struct Outcome {
    /// All rows by columns; for a case of kind "bridging", its tables side by side.
    pub history: History,
    /// Contents of `summary.json`. [`Status::Interrupted`]: the run was asked to end.
    pub summary: Summary,
    /// What else the run made: see [`Documents`].
    pub documents: Documents,
    /// The states of a specimen whose run is done, if they are kept ([`Settings::along`]); not of a run in a child.
    pub trail: Option<Arc<Trail>>,
    /// A specimen over the run, as a page of HTML: the viewer of `report.html` by itself.
    pub view: Option<String>,
    /// What pictures of the rows need besides them; `None`: a plugin ended the child before the case was read.
    pub spec: Option<Spec>,
    /// Text that plugins printed in a child.
    pub prints: String,
}

impl Outcome {
    /// Returns whether the run reached its end.
    pub fn is_done(&self) -> bool {
        self.summary.status == Status::Done
    }

    /// The unit of a column: "MPa"; empty for numbers and for names that no history has.
    pub fn unit(column: &str) -> &'static str {
        columns::shown(column).map_or("", |(_, unit, _)| unit)
    }
}

/// A run of which nothing came out.
#[derive(Debug, thiserror::Error)]
pub enum Error {
    /// The case is wrong, or a plugin cannot be loaded.
    #[error(transparent)]
    Case(#[from] CaseErrors),
    /// Processes or files that the system does not give; a child that said why it did not run.
    #[error(transparent)]
    System(#[from] io::Error),
    /// A child was asked to end and had to be ended by force.
    #[error("the run was ended before it had results")]
    Stopped,
}

impl CaseSource {
    /// Makes the source of a case file.
    pub fn file(file: &Path) -> Self {
        Self { file: file.into(), ..Self::default() }
    }

    /// A document, which names other files relative to a folder.
    pub fn document(document: Value, folder: &Path) -> Self {
        Self { document: Some(document), ..Self::file(&folder.join("case.json")) }
    }

    /// The case as JSON with its overrides, nothing of it checked; `None` if it is no JSON.
    pub fn text(&self) -> Option<Value> {
        match &self.document {
            Some(document) => pullout_case::overridden(document.clone(), &self.overrides).ok(),
            None => pullout_case::document(&self.file, &self.overrides),
        }
    }

    /// The files that the case is read from: its own, and those that it names.
    pub fn inputs(&self) -> Vec<PathBuf> {
        match &self.document {
            Some(_) => pullout_case::named_inputs(&self.text().unwrap_or_default(), &self.file),
            None => pullout_case::inputs(&self.file, &self.overrides),
        }
    }

    /// Returns why the case needs a separate process, if it does.
    pub fn need(&self) -> Option<Need> {
        isolation::need(&self.text()?, &self.file, &self.plugin_paths)
    }

    /// Reads and checks the case. A case that must not run in this process is checked by its run.
    ///
    /// # Errors
    /// Everything that is wrong with it.
    pub fn read(self) -> Result<Prepared, CaseErrors> {
        if self.need().is_some() {
            return Ok(Prepared { source: self, case: None });
        }
        let case = self.case()?;
        let runs_here = match &case {
            // beams at random take their time, which nothing ends here, and simulations start other processes
            Case::Bridging(program) => {
                program.scatter.is_none() && !matches!(program.source, bridging::LoadSource::Simulated(_))
            }
            Case::Path(_) | Case::Pullout(_) => true,
        };
        Ok(Prepared { source: self, case: runs_here.then(|| Box::new(case)) })
    }

    /// Reads and checks the case in this process, wherever it is to be run.
    ///
    /// # Errors
    /// Everything that is wrong with it.
    pub fn case(&self) -> Result<Case, CaseErrors> {
        pullout_case::read_by(self.reader(), &self.file, self.document.clone(), &self.overrides)
    }

    /// Makes a reader for the file, or for the document that replaces it.
    pub fn reader(&self) -> Reader<'_> {
        Reader::new(input::folder_of(&self.file), &self.plugin_paths, self.is_untrusted)
    }

    /// Returns the key of its run; `libraries`: those that it calls, where they are known.
    pub fn key(&self, libraries: Option<Vec<PathBuf>>) -> String {
        let of_need = || self.need().map(|need| need.libraries.into_keys().collect()).unwrap_or_default();
        let document = self.text().unwrap_or_default();
        let mut files = pullout_case::named_inputs(&document, &self.file);
        files.extend(libraries.unwrap_or_else(of_need));
        files.sort();
        files.dedup();
        // the run reports a file that cannot be read
        let hash = |file: &PathBuf| input::hash(file, Input::Mesh).unwrap_or_default();
        let key = RunKey::new(identity().unwrap_or_default());
        files.iter().fold(key, |key, file| key.with(hash(file))).with_case(document).digits()
    }

    /// Checks the case in the process in which it will run, and returns the columns of its rows after step and
    /// increment. `None`: the plugin ended the process, as it would end the run.
    ///
    /// # Errors
    /// Everything that is wrong with it.
    pub fn columns(&self) -> Result<Option<Vec<String>>, CaseErrors> {
        match self.clone().read()?.case {
            Some(case) => Ok(Some(case.columns_of_numbers())),
            None => apart::columns(self),
        }
    }
}

impl Prepared {
    /// The case, if it runs in this process.
    pub fn case(&self) -> Option<&Case> {
        self.case.as_deref()
    }

    /// Runs the case. A failed run is an outcome with the results so far.
    ///
    /// Plugins with automatic arrays need a stack of [`pullout_run::PLUGIN_STACK`] on the calling thread.
    ///
    /// # Errors
    /// The run has no outcome.
    pub fn run(&self, settings: Settings) -> Result<Outcome, Error> {
        match self.case() {
            Some(case) => Ok(here::run(case, settings)?),
            None => apart::run(&self.source, settings),
        }
    }
}
