//! What the lab was opened with: a law, a case, a library, or sources that are built again whenever they change.

use crate::LabError;
use crate::done::Done;
use crate::watch::{FileWatch, with_included};
use pullout_check::build;
use pullout_check::description;
use pullout_engine::CaseSource;
use pullout_report::page;
use pullout_run::input::{self, Input};
use pullout_run::isolation;
use serde_json::{Value, json};
use std::collections::BTreeSet;
use std::path::{Path, PathBuf};
use std::sync::{Arc, Condvar, Mutex, MutexGuard, PoisonError};
use std::time::Duration;
use umat_abi::host::{Found, library_path, names_a_file, real_path, search_paths};

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
    /// Files that the case reads: measured curves, tables, meshes.
    data: Vec<PathBuf>,
    /// All files of both; with a source what it includes.
    files: Mutex<FileWatch>,
    /// How often any of them has changed, and the data alone.
    versions: Mutex<[u64; 2]>,
    changed: Condvar,
}

#[derive(Debug)]
struct Watched {
    /// The file as the command line, or the case, names it.
    named: String,
    file: PathBuf,
    state: Mutex<State>,
}

/// The current library of a file.
#[derive(Clone, Debug, Default)]
struct State {
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
    pub fn of_document(document: Value, plugin_paths: &[PathBuf]) -> Result<Self, LabError> {
        Self::new(document, Path::new("."), shipped(plugin_paths), None)
    }

    /// A case, or the beginning of one, by whose folder its names are resolved, with the shipped laws; `named`: the library of the user's,
    /// and its file.
    fn new(document: Value, folder: &Path, laws: Vec<Value>, named: Option<(&str, PathBuf)>) -> Result<Self, LabError> {
        let folder = std::path::absolute(folder)?;
        let library: Vec<PathBuf> = named.iter().flat_map(|(_, file)| with_included(file)).collect();
        let is_data = |file: &PathBuf| library.iter().all(|other| real_path(other) != real_path(file));
        let data: Vec<PathBuf> =
            CaseSource::document(document.clone(), &folder).inputs().into_iter().filter(is_data).collect();
        // what is saved while a source is built is a change as well
        let files = Mutex::new(FileWatch::of(library.into_iter().chain(data.iter().cloned())));
        let watched = named.map(|(named, file)| Watched::new(named, file)).transpose()?;
        let (versions, changed) = (Mutex::new([1, 0]), Condvar::new());
        Ok(Self { document, folder, laws, finished: None, watched, data, files, versions, changed })
    }

    /// The results of a run, which nothing changes.
    fn of_results(folder: &Path) -> Result<Self, LabError> {
        let finished = Done::read(folder).map_err(|error| {
            LabError::Subject(format!("{error}: is {} the result directory of a run with pictures?", folder.display()))
        })?;
        let document = json!({ "kind": "results", "title": finished.title() });
        Ok(Self { finished: Some(Arc::new(finished)), ..Self::new(document, folder, Vec::new(), None)? })
    }

    /// The report of the run whose results are shown.
    pub fn report(&self) -> Option<Vec<u8>> {
        let report = self.finished.as_ref().map(|_| self.folder.join(page::FILE))?;
        input::read(&report, Input::Result).ok()
    }

    /// Finds out what a word of the command line is.
    pub fn of(word: Option<&str>, plugin_paths: &[PathBuf]) -> Result<Self, LabError> {
        if let Some(folder) = word.map(Path::new).filter(|word| word.is_dir()) {
            return Self::of_results(folder);
        }
        let word = word.unwrap_or(FIRST_LAW);
        let path = Path::new(word);
        if path.extension().is_some_and(|suffix| suffix == "json") || path.starts_with("/dev") {
            let text = input::read(path, Input::Case).map_err(|error| LabError::Subject(format!("{word}: {error}")))?;
            let mut document: Value =
                serde_json::from_slice(&text).map_err(|error| LabError::Subject(format!("{word}: {error}")))?;
            if document["title"].is_null() {
                document["title"] = json!(path.file_stem().unwrap_or_default().to_string_lossy());
            }
            let folder = Path::new(".").join(input::folder_of(path));
            let plugin =
                document["material"]["plugin"].as_str().filter(|plugin| names_a_file(plugin)).map(str::to_owned);
            let named = plugin.as_deref().map(|plugin| (plugin, folder.join(plugin)));
            return Self::new(document, &folder, shipped(plugin_paths), named);
        }
        if names_a_file(word) {
            let file = library_path(Path::new(""), word);
            let [props, nstatv] = used(&file);
            // E and ν come first by habit
            let values: Vec<f64> = PLACEHOLDERS.into_iter().chain(std::iter::repeat(1.0)).take(props).collect();
            let material = json!({ "props": values, "nstatv": nstatv });
            let document = json!({ "kind": "point", "material": material, "mode": "3d", "steps": [] });
            let mut subject = Self::new(document, Path::new("."), shipped(plugin_paths), Some((word, file)))?;
            if subject.library()["description"]["laws"].as_array().is_some_and(|laws| !laws.is_empty()) {
                subject.document["material"] = json!({ "props": [], "nstatv": 0 });
            }
            return Ok(subject);
        }
        let laws = shipped(plugin_paths);
        let law = laws.iter().find(|law| law["name"] == word);
        let law = law.ok_or_else(|| {
            let names: Vec<_> = laws.iter().filter_map(|law| law["name"].as_str()).collect();
            LabError::Subject(format!(
                "{word}: neither a law ({}) nor a case, a source, a library or a result directory",
                names.join(", ")
            ))
        })?;
        let entry_points = law["entry_points"].as_array();
        let is_bulk = entry_points.is_some_and(|names| names.iter().any(|name| name == "umat"));
        let kind = if is_bulk { "point" } else { "interface" };
        let document = json!({ "kind": kind, "material": { "plugin": word, "props": {} }, "steps": [] });
        Self::new(document, Path::new("."), laws, None)
    }

    /// Returns whether a case may name this plugin: a shipped law, or what the command line named.
    pub fn admits(&self, plugin: &str) -> bool {
        self.laws.iter().any(|law| law["name"] == plugin) || self.is_own(plugin)
    }

    /// Returns whether the command line named this plugin, itself or in a case.
    pub fn is_own(&self, plugin: &str) -> bool {
        self.watched.as_ref().is_some_and(|watched| watched.lock().known.contains(Path::new(plugin)))
    }

    /// What is watched at present, for the page: how often it has changed, and the user's library if there is one.
    pub fn library(&self) -> Value {
        let [version, _] = *self.versions();
        let Some(watched) = &self.watched else { return json!({ "named": null, "version": version }) };
        let state = watched.lock();
        json!({
            "named": watched.named,
            "version": version,
            "library": state.library,
            "refusal": state.refusal,
            "remarks": state.remarks,
            "description": state.description,
        })
    }

    fn versions(&self) -> MutexGuard<'_, [u64; 2]> {
        self.versions.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// How often the data of the case have changed.
    pub fn data_version(&self) -> u64 {
        self.versions()[1]
    }

    /// Waits until something has changed since the page asked, or for some seconds.
    pub fn library_after(&self, version: u64) -> Value {
        let same = |versions: &mut [u64; 2]| versions[0] == version;
        let waited = self.changed.wait_timeout_while(self.versions(), LONGEST_WAIT, same);
        drop(waited.unwrap_or_else(PoisonError::into_inner));
        self.library()
    }

    /// Makes a library of the user's file whenever it, or what it includes, has changed, and notes changes of the data; for ever.
    pub fn watch(&self) {
        let mut files = self.files.lock().unwrap_or_else(PoisonError::into_inner);
        while files.files().next().is_some() {
            let changed = files.wait(&|| false);
            let of_library = || self.watched.iter().flat_map(|watched| with_included(&watched.file));
            *files = FileWatch::of(of_library().chain(self.data.iter().cloned()));
            let is_data = |file: &PathBuf| self.data.contains(file);
            if let Some(watched) = self.watched.as_ref().filter(|_| !changed.iter().all(is_data)) {
                watched.refresh();
            }
            let mut versions = self.versions();
            versions[0] += 1;
            versions[1] += u64::from(changed.iter().any(is_data));
            drop(versions);
            self.changed.notify_all();
        }
    }
}

impl Watched {
    /// Makes the library of a file for the first time. If the compiler refuses the source, that is no error.
    fn new(named: &str, file: PathBuf) -> Result<Self, LabError> {
        let file = std::path::absolute(file)?;
        if !file.is_file() {
            return Err(LabError::Subject(format!("{named}: there is no such file")));
        }
        let watched = Self { named: named.to_owned(), file, state: Mutex::default() };
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
    }
}

/// How many PROPS and state variables a source uses: the greatest numbers between their brackets.
fn used(file: &Path) -> [usize; 2] {
    let sources = if umat_abi::host::is_source(file) { build::inputs(file) } else { Vec::new() };
    let texts: Vec<Vec<u8>> = sources.iter().filter_map(|source| input::read(source, Input::Source).ok()).collect();
    let text = texts.iter().map(|text| String::from_utf8_lossy(text).to_lowercase()).collect::<Vec<_>>().join("\n");
    ["props", "statev"].map(|name| {
        let greatest = |(at, _): (usize, &str)| {
            let is_part_of_a_name = text[..at].ends_with(|before: char| before.is_alphanumeric() || before == '_');
            let rest = text[at + name.len()..].trim_start_matches(' ');
            // C counts from 0
            let (rest, first) =
                rest.strip_prefix('(').map(|rest| (rest, 0)).or(rest.strip_prefix('[').map(|rest| (rest, 1)))?;
            let inner = rest.split([')', ']', '\n']).next().filter(|_| !is_part_of_a_name)?;
            let numbers = inner.split([':', ',']).filter_map(|number| number.trim().parse::<usize>().ok());
            numbers.max().map(|number| number.saturating_add(first)).filter(|number| *number <= MOST_USED)
        };
        text.match_indices(name).filter_map(greatest).max().unwrap_or(0)
    })
}

/// PROPS and state variables of a source at most.
const MOST_USED: usize = 1000;
/// What the first PROPS of a law are taken for until its user types others: E, MPa, and ν.
const PLACEHOLDERS: [f64; 2] = [2e5, 0.3];

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
