//! From a case file to a program ([`Case`]), with everything that is wrong with it at once.
//!
//! A file is parsed (`json`), overridden (`--set`), compared with the schema that its serde types make
//! (`document`, `structure`), and resolved: plugin and parameters, steps, tables, curves. No step stops at
//! the first problem; only broken JSON and an unknown kind leave nothing to go on with.

use crate::input::{self, Input, folder_of};
use crate::path::program::{self, Program};
use crate::pullout;
use document::{InterfaceCase, PointCase, PulloutCase};
use fe_core::stepping::Analysis;
use problem::{Place, Problem};
use serde::de::DeserializeOwned;
use serde_json::Value;
use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};
use umat_abi::host::{ExternalDatabases, Library, announce_job};

mod arguments;
mod constraints;
mod document;
mod fields;
mod history;
mod interface;
mod json;
mod plugin;
mod point;
mod problem;
mod props;
mod specimen;
mod steps;
mod structure;
mod table;
#[cfg(test)]
mod test;

pub(crate) use document::{Piece, Positive};
pub(crate) use plugin::{not_found, where_to_look};
pub(crate) use problem::hint;
pub use problem::{CaseErrors, Place as JsonPlace, Problem as CaseProblem, ProblemKind};
pub use props::props_from_json;
use structure::Structure;
pub use structure::schema;
pub(crate) use table::CsvFile;

/// A case that was read.
#[derive(Clone, Debug)]
pub enum Case {
    /// A material or contact point along a path.
    Path(Box<Program>),
    /// A specimen in two dimensions.
    Pullout(Box<pullout::Program>),
}

impl Case {
    /// The case file.
    pub fn file(&self) -> &Path {
        match self {
            Self::Path(program) => &program.case_file,
            Self::Pullout(program) => &program.case_file,
        }
    }

    /// Tells what GETJOBNAME and GETOUTDIR answer from now on, after others may have been read.
    pub fn announce(&self) {
        match self {
            Self::Path(program) => announce(&program.case_file, &program.document),
            Self::Pullout(program) => announce(&program.case_file, &Value::Null),
        }
    }

    /// Calls laws that reading the case has not called, because their UEXTERNALDB must be told of one analysis only: here
    /// of one that ends at once.
    ///
    /// # Errors
    /// What is wrong with them.
    pub fn check_laws(&self) -> Result<(), CaseErrors> {
        let Self::Pullout(program) = self else { return Ok(()) };
        if !ExternalDatabases::is_in(program.model.libraries()) {
            return Ok(());
        }
        self.announce();
        Analysis::check_laws(&program.model).map_err(|error| {
            let problem = Problem::new(Place::root(), error.to_string());
            CaseErrors { file: program.case_file.clone(), problems: vec![problem] }
        })
    }

    /// Its title.
    pub fn title(&self) -> &str {
        match self {
            Self::Path(program) => &program.title,
            Self::Pullout(program) => &program.title,
        }
    }

    /// The history's columns, in the order of the CSV.
    pub fn columns(&self) -> Vec<String> {
        match self {
            Self::Path(program) => program.columns(),
            Self::Pullout(program) => program.columns(),
        }
    }

    /// Curves to compare with.
    pub fn compare(&self) -> &[program::Compare] {
        match self {
            Self::Path(program) => &program.compare,
            Self::Pullout(program) => &program.compare,
        }
    }

    /// Whether pictures are drawn.
    pub fn draws_plots(&self) -> bool {
        match self {
            Self::Path(program) => program.output.plots,
            Self::Pullout(program) => program.output.plots,
        }
    }

    /// The libraries that it calls.
    pub fn libraries(&self) -> Vec<PathBuf> {
        match self {
            Self::Path(program) => vec![program.plugin.library.path().to_owned()],
            Self::Pullout(program) => {
                program.laws().into_iter().map(|(_, law)| law.library.path().to_owned()).collect()
            }
        }
    }

    /// What the case leaves to defaults, a line for each place: "material.props: nu = 0.18".
    pub fn defaults(&self) -> &[String] {
        match self {
            Self::Path(program) => &program.defaults,
            Self::Pullout(program) => &program.defaults,
        }
    }

    /// Things the user should know although nothing is wrong.
    pub fn warnings(&self) -> &[String] {
        match self {
            Self::Path(program) => &program.warnings,
            Self::Pullout(program) => &program.warnings,
        }
    }
}

/// What the parts of a case are resolved with, and what they find.
pub(crate) struct Reader<'a> {
    /// The case file's folder, to which paths in it are relative.
    folder: &'a Path,
    plugin_paths: &'a [PathBuf],
    /// Nobody has looked at the case: it names plugins of the search path, and files within its folder.
    is_untrusted: bool,
    /// The libraries that are loaded, by file.
    libraries: BTreeMap<PathBuf, Library>,
    problems: Vec<Problem>,
    warnings: Vec<String>,
    /// What the case leaves to defaults: a line for each place.
    defaults: Vec<String>,
}

impl<'a> Reader<'a> {
    /// For a file in this folder.
    pub(crate) fn new(folder: &'a Path, plugin_paths: &'a [PathBuf]) -> Self {
        Self {
            folder,
            plugin_paths,
            is_untrusted: false,
            libraries: BTreeMap::new(),
            problems: Vec::new(),
            warnings: Vec::new(),
            defaults: Vec::new(),
        }
    }

    /// The same, for a file that nobody has looked at.
    pub(crate) fn of_untrusted(folder: &'a Path, plugin_paths: &'a [PathBuf]) -> Self {
        Self { is_untrusted: true, ..Self::new(folder, plugin_paths) }
    }

    /// The file that a text of the case names.
    ///
    /// # Errors
    /// The case may not name it.
    pub(crate) fn named(&self, name: &str) -> Result<PathBuf, String> {
        if self.is_untrusted { within(self.folder, name) } else { Ok(self.folder.join(name)) }
    }

    /// The file that the text at a place names, if it may.
    pub(crate) fn file(&mut self, name: &str, place: &Place) -> Option<PathBuf> {
        self.named(name).map_err(|message| self.problem(place, message)).ok()
    }

    /// The case, if nothing is wrong with it.
    fn finish(self, path: &Path, case: Option<Case>) -> Result<Case, CaseErrors> {
        match case {
            Some(case) if self.problems.is_empty() => Ok(case),
            _ => Err(CaseErrors { file: path.into(), problems: self.problems }),
        }
    }

    /// Warns of a value that nobody means, a slip of units perhaps.
    fn warn_unusual(&mut self, what: &str, value: f64, unit: &str, [lower, upper]: [f64; 2]) {
        let [value, lower, upper] = [value, lower, upper].map(crate::output::number::rounded);
        let warning = format!(
            "{what} = {value} {unit} is outside the usual range, {lower} to {upper} {unit}: is it in units of N, mm, MPa?"
        );
        if !self.warnings.contains(&warning) {
            self.warnings.push(warning);
        }
    }

    /// Notes the names and values that a place of the case leaves to defaults.
    fn note_defaults(&mut self, place: &Place, taken: &[String]) {
        if !taken.is_empty() {
            self.defaults.push(format!("{}: {}", place.in_words(), taken.join(", ")));
        }
    }

    /// Everything that is wrong.
    pub(crate) fn into_problems(self) -> Vec<Problem> {
        self.problems
    }

    /// Puts problems of structure before those of meaning, found since there were `before`, and drops what they explain.
    fn add_structural(&mut self, structure: Structure, before: usize) {
        let meaning = self.problems.split_off(before);
        let places: BTreeSet<&Place> = structure.problems.iter().filter_map(|problem| problem.place.as_ref()).collect();
        let explained = |problem: &Problem| {
            problem.place.as_ref().is_some_and(|place| place.contains_one_of(&places)) || structure.explains(problem)
        };
        let meaning: Vec<Problem> = meaning.into_iter().filter(|problem| !explained(problem)).collect();
        self.problems.extend(structure.problems);
        self.problems.extend(meaning);
    }

    /// Adds what is wrong.
    pub(crate) fn push(&mut self, problem: Problem) {
        self.problems.push(problem);
    }

    pub(crate) fn problem(&mut self, place: &Place, message: impl Into<String>) {
        self.problems.push(Problem::new(place.clone(), message));
    }

    /// A piece, if it could be read.
    pub(crate) fn piece<'p, T>(&mut self, piece: &'p Piece<T>, place: &Place) -> Option<&'p T> {
        match &piece.0 {
            Ok(value) => Some(value),
            Err(message) => {
                self.problem(place, format!("cannot be read: {message}"));
                None
            }
        }
    }

    /// A piece that may be left out, if it is there and could be read.
    pub(crate) fn optional<'p, T>(&mut self, piece: Option<&'p Piece<T>>, place: &Place) -> Option<&'p T> {
        piece.and_then(|piece| self.piece(piece, place))
    }
}

/// The members that the kinds of points share.
struct Common<'c> {
    title: Option<&'c Piece<String>>,
    description: Option<&'c Piece<String>>,
    until: Option<&'c Piece<document::Until>>,
    compare: Option<&'c Piece<Vec<Piece<document::Compare>>>>,
    output: Option<&'c Piece<document::Output>>,
    controls: Option<&'c Piece<document::Controls>>,
}

/// What the kinds of points resolve; [`finish`] adds the rest.
struct Resolved {
    plugin: Option<program::Plugin>,
    kind: Option<program::Kind>,
    columns: Option<Vec<String>>,
    characteristic_length: Option<f64>,
}

/// Reads a case file.
///
/// `overrides` are the texts of `--set`; `plugin_paths` are searched for plugins before the usual folders.
///
/// # Errors
/// Everything that is wrong with it.
pub fn read(path: &Path, overrides: &[String], plugin_paths: &[PathBuf]) -> Result<Case, CaseErrors> {
    read_by(Reader::new(folder_of(path), plugin_paths), path, overrides)
}

/// Reads a case file that nobody has looked at: it may name plugins of the search path by their names, no symbol in
/// them, and files within its folder.
///
/// # Errors
/// Everything that is wrong with it.
pub fn read_untrusted(path: &Path, overrides: &[String], plugin_paths: &[PathBuf]) -> Result<Case, CaseErrors> {
    read_by(Reader::of_untrusted(folder_of(path), plugin_paths), path, overrides)
}

fn read_by(mut reader: Reader<'_>, path: &Path, overrides: &[String]) -> Result<Case, CaseErrors> {
    let case = text_with(path, overrides, &mut reader.problems).and_then(|text| read_with(&mut reader, path, text));
    reader.finish(path, case)
}

/// Reads a case that was made in memory as if it stood in the file `path`.
///
/// # Errors
/// Everything that is wrong with it.
pub fn read_document(document: Value, path: &Path, plugin_paths: &[PathBuf]) -> Result<Case, CaseErrors> {
    let mut reader = Reader::new(folder_of(path), plugin_paths);
    let case = read_with(&mut reader, path, document);
    reader.finish(path, case)
}

/// Whether a file is a study rather than a case.
pub fn is_study(path: &Path) -> bool {
    document(path, &[]).is_some_and(|document| document["kind"] == structure::STUDY)
}

/// A case file as JSON with its overrides, nothing of it checked; `None` if it is no JSON.
pub fn document(path: &Path, overrides: &[String]) -> Option<Value> {
    text_with(path, overrides, &mut Vec::new())
}

/// The files that a case is read from: its own, and those that texts of it name (meshes, tables, measured curves), with
/// the overrides. Plugins that are found by name are not among them.
pub fn inputs(path: &Path, overrides: &[String]) -> Vec<PathBuf> {
    let mut files = vec![path.to_owned()];
    named_files(&document(path, overrides).unwrap_or_default(), folder_of(path), &mut files);
    files
}

fn named_files(value: &Value, folder: &Path, files: &mut Vec<PathBuf>) {
    match value {
        Value::String(text) if !text.is_empty() => {
            let path = folder.join(text);
            if path.is_file() {
                files.push(path);
            }
        }
        Value::Array(entries) => entries.iter().for_each(|entry| named_files(entry, folder, files)),
        Value::Object(members) => members.values().for_each(|member| named_files(member, folder, files)),
        _ => {}
    }
}

fn text_with(path: &Path, overrides: &[String], problems: &mut Vec<Problem>) -> Option<Value> {
    let text = match input::text(path, Input::Case) {
        Ok(text) => text,
        Err(error) => {
            problems.push(Problem::unreadable(format!("the case file cannot be read: {error}")));
            return None;
        }
    };
    let mut document = match json::parse(&text) {
        Ok((document, repeated)) => {
            problems.extend(repeated);
            document
        }
        Err(problem) => {
            problems.push(problem);
            return None;
        }
    };
    for text in overrides {
        if let Err(problem) = json::set(&mut document, text) {
            problems.push(problem);
        }
    }
    json::check_texts(&document, &Place::root(), problems);
    Some(document)
}

/// The folder that GETOUTDIR answers: as in ABAQUS the one from which the job is submitted, so that what a UMAT reads lies
/// beside the case. A replay, which lies elsewhere, names its original's.
pub fn job_folder(path: &Path, document: &Value) -> PathBuf {
    let mut folder = Path::new(".").join(folder_of(path));
    folder.extend(document["job_folder"].as_str());
    std::path::absolute(&folder).unwrap_or(folder)
}

/// A file in a folder, links followed.
fn within(folder: &Path, name: &str) -> Result<PathBuf, String> {
    use std::path::Component;
    let leads_out = || format!("{name} leads out of the case's folder, which --untrusted does not allow");
    if !Path::new(name).components().all(|part| matches!(part, Component::Normal(_) | Component::CurDir)) {
        return Err(leads_out());
    }
    let path = folder.join(name);
    // what does not exist leads nowhere; whoever reads it says so
    let Ok(place) = path.canonicalize() else { return Ok(path) };
    let folder = Path::new(".").join(folder).canonicalize().map_err(|error| error.to_string())?;
    if place.starts_with(folder) { Ok(path) } else { Err(leads_out()) }
}

/// Tells what GETJOBNAME and GETOUTDIR answer from now on.
fn announce(path: &Path, document: &Value) {
    announce_job(&path.file_stem().unwrap_or_default().to_string_lossy(), &job_folder(path, document));
}

fn read_with(reader: &mut Reader<'_>, path: &Path, document: Value) -> Option<Case> {
    if let Some(folder) = document["job_folder"].as_str() {
        reader.file(folder, &Place::root().key("job_folder"))?;
    }
    // a library may be called while its case is read
    announce(path, &document);
    let kind = match structure::kind_of(&document) {
        Ok(kind) => kind.to_owned(),
        Err(problem) => {
            reader.problems.push(problem);
            return None;
        }
    };
    resolve(reader, path, &kind, document)
}

/// Resolves a study file; what is wrong with it goes to the reader.
pub(crate) fn read_study<D: DeserializeOwned, T>(
    reader: &mut Reader<'_>,
    path: &Path,
    resolve: impl FnOnce(&mut Reader<'_>, D) -> Option<T>,
) -> Option<T> {
    let mut document = text_with(path, &[], &mut reader.problems)?;
    if document["kind"] != structure::STUDY {
        let what =
            document["kind"].as_str().map_or_else(String::new, |kind| format!(", this is a case of kind '{kind}'"));
        reader.problem(&Place::root().key("kind"), format!("a study has the kind \"{}\"{what}", structure::STUDY));
        return None;
    }
    let structural = structure::check(structure::STUDY, &mut document);
    let before = reader.problems.len();
    let study = typed(reader, document).and_then(|document| resolve(reader, document));
    reader.add_structural(structural, before);
    study
}

/// Structure first, then meaning; what the structure explains is not said twice.
fn resolve(reader: &mut Reader<'_>, path: &Path, kind: &str, document: Value) -> Option<Case> {
    let mut readable = document.clone();
    let structural = structure::check(kind, &mut readable);
    let before = reader.problems.len();
    let program = match kind {
        "interface" => typed(reader, readable).and_then(|case: InterfaceCase| {
            let resolved = interface::resolve(reader, &case);
            let InterfaceCase { title, description, until, compare, output, controls, .. } = &case;
            finish(reader, path, document, resolved, &common(title, description, until, compare, output, controls))
        }),
        "pullout" => typed(reader, readable).and_then(|case: PulloutCase| {
            specimen::resolve(reader, path, &case).map(|program| Case::Pullout(Box::new(program)))
        }),
        _ => typed(reader, readable).and_then(|case: PointCase| {
            let resolved = point::resolve(reader, &case);
            let PointCase { title, description, until, compare, output, controls, .. } = &case;
            finish(reader, path, document, resolved, &common(title, description, until, compare, output, controls))
        }),
    };
    reader.add_structural(structural, before);
    program
}

fn typed<T: DeserializeOwned>(reader: &mut Reader<'_>, document: Value) -> Option<T> {
    serde_json::from_value(document)
        .map_err(|error| reader.problem(&Place::root(), format!("cannot be read: {error}")))
        .ok()
}

fn common<'c>(
    title: &'c Option<Piece<String>>,
    description: &'c Option<Piece<String>>,
    until: &'c Option<Piece<document::Until>>,
    compare: &'c Option<Piece<Vec<Piece<document::Compare>>>>,
    output: &'c Option<Piece<document::Output>>,
    controls: &'c Option<Piece<document::Controls>>,
) -> Common<'c> {
    Common {
        title: title.as_ref(),
        description: description.as_ref(),
        until: until.as_ref(),
        compare: compare.as_ref(),
        output: output.as_ref(),
        controls: controls.as_ref(),
    }
}

/// Resolves what the kinds of points share, and puts the program together if nothing is missing.
fn finish(
    reader: &mut Reader<'_>,
    path: &Path,
    document: Value,
    resolved: Resolved,
    common: &Common<'_>,
) -> Option<Case> {
    let root = Place::root();
    let title = reader.optional(common.title, &root.key("title")).cloned();
    let description = reader.optional(common.description, &root.key("description")).cloned();
    let columns = resolved.columns.as_deref();
    let place = root.key("until");
    let until = reader.optional(common.until, &place).and_then(|until| history::until(reader, until, columns, &place));
    let compare = history::compare_all(reader, common.compare, columns, &root.key("compare"));
    let output = reader.optional(common.output, &root.key("output")).cloned().unwrap_or_default();
    if output.vtu == Some(true) {
        reader.warnings.push("output.vtu: a case of this kind has no mesh; no VTU file is written".into());
    }
    let limits = reader.optional(common.controls, &root.key("controls")).cloned().unwrap_or_default();
    let default = program::Controls::default();
    let limit = |given: Option<u64>, default| given.and_then(|n| u32::try_from(n).ok()).unwrap_or(default);
    Some(Case::Path(Box::new(Program {
        case_file: path.into(),
        title: title.unwrap_or_else(|| path.file_stem().map_or_else(String::new, |s| s.to_string_lossy().into())),
        description: description.unwrap_or_default(),
        document,
        plugin: resolved.plugin?,
        kind: resolved.kind?,
        characteristic_length: resolved.characteristic_length,
        until,
        controls: program::Controls {
            max_iterations: limit(limits.max_iterations.map(|n| n.0), default.max_iterations),
            max_cutbacks: limit(limits.max_cutbacks.map(|n| n.0), default.max_cutbacks),
        },
        output: program::Output {
            every: output.every.map_or(1, |every| usize::try_from(every.0).unwrap_or(usize::MAX)),
            plots: output.plots.unwrap_or(true),
        },
        compare,
        warnings: std::mem::take(&mut reader.warnings),
        defaults: std::mem::take(&mut reader.defaults),
    })))
}
