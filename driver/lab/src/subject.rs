//! What the lab was opened with: a law, a case, a library, or sources that are built again whenever they change.

use crate::Error;
use crate::done::Done;
use crate::watch::{FileWatch, with_included};
use pullout_check::build;
use pullout_check::description;
use pullout_report::page;
use pullout_run::input::{self, Input};
use pullout_run::isolation;
use serde_json::{Value, json};
use std::collections::BTreeSet;
use std::path::{Path, PathBuf};
use std::sync::{Arc, Condvar, Mutex, MutexGuard, PoisonError};
use std::time::Duration;
use umat_abi::host::{Found, library_path, names_a_file, search_paths};

/// Law of a lab that is opened without one.
const FIRST_LAW: &str = "j2_plasticity";
/// Time limit of loading a user's library, and of one call, s.
pub(crate) const CALL_TIME_LIMIT: f64 = 2.0;
/// Longest time that a page waits for a change of a source.
const LONGEST_WAIT: Duration = Duration::from_secs(20);

/// What the lab is about.
#[derive(Debug)]
pub(crate) struct Subject {
    /// The case to begin with.
    pub document: Value,
    /// Folder to which file names in cases are relative.
    pub folder: PathBuf,
    /// The shipped laws, as described by [`description::as_json`].
    pub laws: Vec<Value>,
    /// The run whose results are shown.
    pub finished: Option<Arc<Done>>,
    /// The user's own library or source.
    watched: Option<Watched>,
}

#[derive(Debug)]
struct Watched {
    /// The file as the command line, or the case, names it.
    named: String,
    file: PathBuf,
    /// The file and what it includes.
    files: Mutex<FileWatch>,
    state: Mutex<State>,
    changed: Condvar,
}

/// The current library of a file.
#[derive(Clone, Debug, Default)]
struct State {
    version: u64,
    library: Option<PathBuf>,
    /// The compiler's message, if it refused the current source.
    refusal: Option<String>,
    remarks: Vec<String>,
    /// All libraries of the file so far: cases with earlier settings name them.
    known: BTreeSet<PathBuf>,
    /// The library's description, if its laws have metadata.
    description: Value,
}

impl Subject {
    /// A case that stands in no file.
    pub fn of_document(document: Value, plugin_paths: &[PathBuf]) -> Result<Self, Error> {
        let (laws, folder) = (shipped(plugin_paths), std::path::absolute(".")?);
        Ok(Self { document, folder, laws, finished: None, watched: None })
    }

    /// The results of a run, which nothing changes.
    fn of_results(folder: &Path) -> Result<Self, Error> {
        let finished = Done::read(folder).map_err(|error| {
            Error::Subject(format!("{error}: is {} the result directory of a run with pictures?", folder.display()))
        })?;
        let document = json!({ "kind": "results", "title": finished.title() });
        let folder = std::path::absolute(folder)?;
        Ok(Self { document, folder, laws: Vec::new(), finished: Some(Arc::new(finished)), watched: None })
    }

    /// The report of the run whose results are shown.
    pub fn report(&self) -> Option<Vec<u8>> {
        let report = self.finished.as_ref().map(|_| self.folder.join(page::FILE))?;
        input::read(&report, Input::Result).ok()
    }

    /// Finds out what a word of the command line is.
    pub fn of(word: Option<&str>, plugin_paths: &[PathBuf]) -> Result<Self, Error> {
        if let Some(folder) = word.map(Path::new).filter(|word| word.is_dir()) {
            return Self::of_results(folder);
        }
        let laws = shipped(plugin_paths);
        let here = PathBuf::from(".");
        let word = word.unwrap_or(FIRST_LAW);
        let path = Path::new(word);
        if path.extension().is_some_and(|suffix| suffix == "json") || path.starts_with("/dev") {
            let text = input::read(path, Input::Case).map_err(|error| Error::Subject(format!("{word}: {error}")))?;
            let mut document: Value =
                serde_json::from_slice(&text).map_err(|error| Error::Subject(format!("{word}: {error}")))?;
            if document["title"].is_null() {
                document["title"] = json!(path.file_stem().unwrap_or_default().to_string_lossy());
            }
            let folder = std::path::absolute(here.join(input::folder_of(path)))?;
            let plugin = document["material"]["plugin"].as_str().filter(|plugin| names_a_file(plugin));
            let watched = plugin.map(|plugin| Watched::new(plugin, folder.join(plugin))).transpose()?;
            return Ok(Self { document, folder, laws, finished: None, watched });
        }
        if names_a_file(word) {
            let watched = Watched::new(word, library_path(Path::new(""), word))?;
            let document =
                json!({ "kind": "point", "material": { "props": [], "nstatv": 0 }, "mode": "3d", "steps": [] });
            let folder = std::path::absolute(here)?;
            return Ok(Self { document, folder, laws, finished: None, watched: Some(watched) });
        }
        let law = laws.iter().find(|law| law["name"] == word);
        let law = law.ok_or_else(|| {
            let names: Vec<_> = laws.iter().filter_map(|law| law["name"].as_str()).collect();
            Error::Subject(format!(
                "{word}: neither a law ({}) nor a case, a source, a library or a result directory",
                names.join(", ")
            ))
        })?;
        let entry_points = law["entry_points"].as_array();
        let is_bulk = entry_points.is_some_and(|names| names.iter().any(|name| name == "umat"));
        let kind = if is_bulk { "point" } else { "interface" };
        let document = json!({ "kind": kind, "material": { "plugin": word, "props": {} }, "steps": [] });
        Self::of_document(document, plugin_paths)
    }

    /// Returns whether a case may name this plugin: a shipped law, or what the command line named.
    pub fn admits(&self, plugin: &str) -> bool {
        self.laws.iter().any(|law| law["name"] == plugin) || self.is_own(plugin)
    }

    /// Returns whether the command line named this plugin, itself or in a case.
    pub fn is_own(&self, plugin: &str) -> bool {
        self.watched.as_ref().is_some_and(|watched| watched.lock().known.contains(Path::new(plugin)))
    }

    /// The user's library at present, for the page; null if there is none.
    pub fn library(&self) -> Value {
        let Some(watched) = &self.watched else { return Value::Null };
        let state = watched.lock();
        json!({
            "named": watched.named,
            "version": state.version,
            "library": state.library,
            "refusal": state.refusal,
            "remarks": state.remarks,
            "description": state.description,
        })
    }

    /// Waits until the user's library is another one than the page knows, or for some seconds.
    pub fn library_after(&self, version: u64) -> Value {
        if let Some(watched) = &self.watched {
            let same = |state: &mut State| state.version == version;
            let waited = watched.changed.wait_timeout_while(watched.lock(), LONGEST_WAIT, same);
            drop(waited.unwrap_or_else(PoisonError::into_inner));
        }
        self.library()
    }

    /// Makes a library of the user's file whenever it, or what it includes, has changed; for ever.
    pub fn watch(&self) {
        let Some(watched) = &self.watched else { return };
        let mut files = watched.files.lock().unwrap_or_else(PoisonError::into_inner);
        loop {
            files.wait(&|| false);
            *files = FileWatch::of(with_included(&watched.file));
            watched.refresh();
        }
    }
}

impl Watched {
    /// Makes the library of a file for the first time. If the compiler refuses the source, that is no error.
    fn new(named: &str, file: PathBuf) -> Result<Self, Error> {
        let file = std::path::absolute(file)?;
        if !file.is_file() {
            return Err(Error::Subject(format!("{named}: there is no such file")));
        }
        // what is saved while it is built is a change as well
        let files = Mutex::new(FileWatch::of(with_included(&file)));
        let watched = Self { named: named.to_owned(), file, files, state: Mutex::default(), changed: Condvar::new() };
        watched.refresh();
        Ok(watched)
    }

    fn lock(&self) -> MutexGuard<'_, State> {
        self.state.lock().unwrap_or_else(PoisonError::into_inner)
    }

    fn refresh(&self) {
        let remarks = std::cell::RefCell::new(Vec::new());
        let built = if umat_abi::host::is_source(&self.file) {
            build::kept(&self.file, &|remark| remarks.borrow_mut().push(remark)).map_err(|refusal| refusal.to_string())
        } else {
            Ok(self.file.clone())
        };
        let description = built.as_ref().ok().and_then(|library| description::of_file(library, CALL_TIME_LIMIT).ok());
        let mut state = self.lock();
        state.version += 1;
        state.remarks = remarks.into_inner();
        match built {
            Ok(library) => {
                state.known.insert(library.clone());
                state.library = Some(library);
                state.refusal = None;
                state.description = description.unwrap_or_default();
            }
            Err(refusal) => state.refusal = Some(refusal),
        }
        drop(state);
        self.changed.notify_all();
    }
}

/// Laws that were built with this program.
fn shipped(plugin_paths: &[PathBuf]) -> Vec<Value> {
    let found = Found::all(&search_paths(plugin_paths)).into_iter();
    let libraries = found.filter(|found| isolation::is_shipped(&found.path));
    let described =
        libraries.filter_map(|found| isolation::load(&found.path).ok()).map(|library| description::as_json(&library));
    let mut laws: Vec<Value> = Vec::new();
    for library in described {
        let Some(of_library) = library["laws"].as_array() else { continue };
        laws.extend(
            of_library
                .iter()
                .filter(|law| laws.iter().all(|known| known["name"] != law["name"]))
                .cloned()
                .collect::<Vec<_>>(),
        );
    }
    laws
}
