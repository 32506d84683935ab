//! Resources with which the parts of a case are resolved, and the problems found on the way.

use crate::problem::{Place, Problem};
use crate::table::{CsvFile, Table};
use std::collections::BTreeMap;
use std::fmt::Display;
use std::path::{Path, PathBuf};
use std::rc::Rc;
use umat_abi::host::Library;

/// Means and findings shared by all parts of a case while it is read.
pub struct Reader<'a> {
    /// The case file's folder, to which paths in it are relative.
    pub(crate) folder: &'a Path,
    pub(crate) plugin_paths: &'a [PathBuf],
    /// Whether the case is from an unknown source: it may name plugins of the search path and files within its folder alone.
    pub(crate) is_untrusted: bool,
    /// The libraries that are loaded, by file.
    pub(crate) libraries: BTreeMap<PathBuf, Library>,
    /// CSV files that were read, and tables of steps by the columns that they may have.
    files: BTreeMap<PathBuf, Rc<CsvFile>>,
    tables: BTreeMap<(PathBuf, Vec<String>), Rc<Table>>,
    pub(crate) problems: Vec<Problem>,
    pub(crate) warnings: Vec<String>,
    /// Facts of the model that need no attention.
    pub(crate) notes: Vec<String>,
    /// Those that decide the result: they are shown at the end of a run.
    pub(crate) highlights: Vec<String>,
    /// Values that the case leaves to defaults: a line for each place.
    pub(crate) defaults: Vec<String>,
}

impl<'a> Reader<'a> {
    /// Makes a reader for a file in this folder, from an unknown source perhaps.
    pub fn new(folder: &'a Path, plugin_paths: &'a [PathBuf], is_untrusted: bool) -> Self {
        Self {
            folder,
            plugin_paths,
            is_untrusted,
            libraries: BTreeMap::new(),
            files: BTreeMap::new(),
            tables: BTreeMap::new(),
            problems: Vec::new(),
            warnings: Vec::new(),
            notes: Vec::new(),
            highlights: Vec::new(),
            defaults: Vec::new(),
        }
    }

    /// Folders where plugins are looked for first.
    pub fn plugin_paths(&self) -> &[PathBuf] {
        self.plugin_paths
    }

    /// The file that a text of the case names.
    ///
    /// # Errors
    /// The case may not name it.
    pub fn named(&self, name: &str) -> Result<PathBuf, String> {
        if self.is_untrusted { within(self.folder, name, "case's") } else { Ok(self.folder.join(name)) }
    }

    /// A CSV file, which is read once.
    ///
    /// # Errors
    /// As of [`CsvFile::read`].
    pub(crate) fn csv(&mut self, path: &Path) -> Result<Rc<CsvFile>, Vec<String>> {
        if let Some(known) = self.files.get(path) {
            return Ok(Rc::clone(known));
        }
        let read = Rc::new(CsvFile::read(path)?);
        self.files.insert(path.to_owned(), Rc::clone(&read));
        Ok(read)
    }

    /// The table of a step in a file that is read once.
    ///
    /// # Errors
    /// As of [`Table::of`].
    pub(crate) fn table(&mut self, path: &Path, names: &[&str]) -> Result<Rc<Table>, Vec<String>> {
        let key = (path.to_owned(), names.iter().map(|name| (*name).to_owned()).collect());
        if let Some(known) = self.tables.get(&key) {
            return Ok(Rc::clone(known));
        }
        let read = Rc::new(Table::of(&*self.csv(path)?, names)?);
        self.tables.insert(key, Rc::clone(&read));
        Ok(read)
    }

    /// The folder that the text at a place names, relative to the current one, for files that are written, if it may.
    pub(crate) fn folder_to_write(&mut self, name: &str, place: &Place) -> Option<PathBuf> {
        let named = if self.is_untrusted { within(Path::new(""), name, "current") } else { Ok(name.into()) };
        self.without_problem(named, place)
    }

    /// The file that the text at a place names, if it may.
    pub fn file(&mut self, name: &str, place: &Place) -> Option<PathBuf> {
        self.without_problem(self.named(name), place)
    }

    /// Warns of a value that is hardly meant, a slip of units perhaps.
    pub(crate) fn warn_unusual(&mut self, what: &str, value: f64, unit: &str, range: [f64; 2]) {
        self.warn(outside_usual(what, value, unit, range));
    }

    /// Adds a warning, once: what several places have in common is found at each of them.
    pub(crate) fn warn(&mut self, warning: String) {
        if !self.warnings.contains(&warning) {
            self.warnings.push(warning);
        }
    }

    /// Notes a fact of the model, once.
    pub(crate) fn note(&mut self, note: String) {
        if !self.notes.contains(&note) {
            self.notes.push(note);
        }
    }

    /// Adds a note that decides the result.
    pub(crate) fn highlight(&mut self, note: String) {
        if !self.highlights.contains(&note) {
            self.highlights.push(note.clone());
            self.note(note);
        }
    }

    /// Warns of a key without effect.
    pub(crate) fn warn_no_effect(&mut self, place: &Place, reason: impl Display) {
        self.warn(format!("{place}: has no effect: {reason}"));
    }

    /// Notes the names and values that a place of the case leaves to defaults.
    pub(crate) fn note_defaults(&mut self, place: &Place, taken: &[String]) {
        let line = format!("{}: {}", place.in_words(), taken.join(", "));
        // a law of contact is read for each kind of surface
        if !taken.is_empty() && !self.defaults.contains(&line) {
            self.defaults.push(line);
        }
    }

    /// Everything that is wrong.
    pub fn into_problems(self) -> Vec<Problem> {
        self.problems
    }

    /// Adds what is wrong.
    pub fn push(&mut self, problem: Problem) {
        self.problems.push(problem);
    }

    /// Adds what is wrong at a place.
    pub fn problem(&mut self, place: &Place, message: impl Into<String>) {
        self.problems.push(Problem::new(place.clone(), message));
    }

    /// Returns a value, or reports at a place why there is none.
    pub(crate) fn without_problem<T, E: ToString>(&mut self, value: Result<T, E>, place: &Place) -> Option<T> {
        value.map_err(|error| self.problem(place, error.to_string())).ok()
    }

    /// Returns a value, or reports all reasons at a place why there is none.
    pub(crate) fn without_problems<T>(&mut self, value: Result<T, Vec<String>>, place: &Place) -> Option<T> {
        value.map_err(|messages| messages.into_iter().for_each(|message| self.problem(place, message))).ok()
    }
}

/// Resolves what a place of the case may leave to defaults, and notes name and value of what it does leave.
#[derive(Default)]
pub struct UsedDefaults(pub Vec<String>);

impl UsedDefaults {
    /// Notes a value that is a default.
    pub fn note(&mut self, name: &str, value: impl Display) {
        self.0.push(format!("{name} = {value}"));
    }

    /// Returns what is given, or else the default.
    pub fn or<T: Copy + Display>(&mut self, name: &str, given: Option<impl Into<T>>, default: T) -> T {
        if given.is_none() {
            self.note(name, default);
        }
        given.map_or(default, Into::into)
    }

    /// Returns a given real number, or else the default.
    pub fn real(&mut self, name: &str, given: Option<impl Into<f64>>, default: f64) -> f64 {
        if given.is_none() {
            self.note(name, pullout_run::number::rounded(default));
        }
        given.map_or(default, Into::into)
    }
}

/// Usual tensile strengths of fibres, MPa.
pub const USUAL_STRENGTH_OF_WIRES: [f64; 2] = [50.0, 1e4];

/// Returns the warning of a value that is hardly meant, a slip of units perhaps.
pub fn outside_usual(what: &str, value: f64, unit: &str, [lower, upper]: [f64; 2]) -> String {
    let [value, lower, upper] = [value, lower, upper].map(pullout_run::number::rounded);
    let question = match unit {
        "" | "-" => {
            return format!(
                "{what} = {value} is outside the usual range, {lower} to {upper}, of this number without a unit"
            );
        }
        "1/K" => "is it per K (steel: 0.000012)?",
        _ => "is it in units of N, mm, MPa?",
    };
    format!("{what} = {value} {unit} is outside the usual range, {lower} to {upper} {unit}: {question}")
}

/// Returns a file in a folder, links followed; `whose`: description of the folder.
fn within(folder: &Path, name: &str, whose: &str) -> Result<PathBuf, String> {
    use std::path::Component;
    let leads_out = || format!("{name} leads out of the {whose} folder, which --untrusted does not allow");
    if !Path::new(name).components().all(|part| matches!(part, Component::Normal(_) | Component::CurDir)) {
        return Err(leads_out());
    }
    let path = folder.join(name);
    let own = Path::new(".").join(folder).canonicalize().map_err(|error| error.to_string())?;
    // what does not exist lies where the folders before it lie; a link to what does not exist leads anywhere
    for part in path.ancestors().filter(|part| !part.as_os_str().is_empty()) {
        match part.canonicalize() {
            Ok(place) if place.starts_with(&own) => break,
            Ok(_) => return Err(leads_out()),
            Err(_) if part.is_symlink() => return Err(leads_out()),
            Err(_) => {}
        }
    }
    Ok(path)
}
