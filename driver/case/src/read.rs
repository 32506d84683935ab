//! Reads case files: JSON, overrides, structure, meaning.

use crate::document::bridging::BridgingCase;
use crate::document::{self, InterfaceCase, Plots, PointCase, PulloutCase};
use crate::point::Resolved;
use crate::problem::{CaseErrors, Place, Problem};
use crate::reader::Reader;
use crate::{bridging, history, increments, interface, json, point, specimen, structure};
use fe_core::stepping::Analysis;
use pullout_run::input::{self, Input, folder_of};
use pullout_run::isolation::{self, Need};
use pullout_run::program::{self, About, Program, job_folder};
use pullout_run::pullout;
use serde::de::DeserializeOwned;
use serde_json::{Value, json};
use std::path::{Path, PathBuf};
use umat_abi::host::{ExternalDatabases, announce_job};

/// A case that was read.
#[derive(Clone, Debug)]
pub enum Case {
    /// A material or contact point along a path.
    Path(Box<Program>),
    /// A specimen in two dimensions.
    Pullout(Box<pullout::PulloutProgram>),
    /// Fibres across a crack.
    Bridging(Box<pullout_run::bridging::BridgingProgram>),
}

impl Case {
    /// Returns what cases of all kinds say.
    pub fn about(&self) -> &About {
        match self {
            Self::Path(program) => &program.about,
            Self::Pullout(program) => &program.about,
            Self::Bridging(program) => &program.about,
        }
    }

    /// Sets the answers of GETJOBNAME and GETOUTDIR from now on, as other cases may have been read since.
    pub fn announce(&self) {
        match self {
            Self::Path(program) => announce(&program.about.case_file, &program.document),
            Self::Pullout(_) | Self::Bridging(_) => announce(&self.about().case_file, &Value::Null),
        }
    }

    /// Calls laws that reading the case has not called, because their UEXTERNALDB must see one analysis only: here one
    /// that ends at once.
    ///
    /// # Errors
    /// Problems that the laws report.
    pub fn check_laws(&self) -> Result<(), CaseErrors> {
        let Self::Pullout(program) = self else { return Ok(()) };
        if !ExternalDatabases::is_in(program.model.libraries()) {
            return Ok(());
        }
        self.announce();
        Analysis::check_laws(&program.model).map_err(|error| {
            let problem = Problem::new(Place::root(), error.to_string());
            CaseErrors { file: program.about.case_file.clone(), problems: vec![problem] }
        })
    }

    /// Name of its file, without folder and suffix.
    pub fn name(&self) -> String {
        self.about().case_file.file_stem().unwrap_or_default().to_string_lossy().into_owned()
    }

    /// The history's columns, in the order of the CSV; of bridging those of all its files.
    pub fn columns(&self) -> Vec<String> {
        match self {
            Self::Path(program) => program.columns(),
            Self::Pullout(program) => program.columns(),
            Self::Bridging(program) => program.columns(),
        }
    }

    /// Returns the columns that hold numbers of the run, which follow step and increment.
    pub fn columns_of_numbers(&self) -> Vec<String> {
        if let Self::Bridging(program) = self { program.columns() } else { self.columns().split_off(2) }
    }

    /// The libraries that it calls.
    pub fn libraries(&self) -> Vec<PathBuf> {
        match self {
            Self::Path(program) => vec![program.plugin.library.path().to_owned()],
            Self::Pullout(program) => {
                program.laws().into_iter().map(|(_, law)| law.library.path().to_owned()).collect()
            }
            Self::Bridging(_) => Vec::new(),
        }
    }
}

/// Reads a case file.
///
/// `overrides` are the texts of `--set`; `plugin_paths` are searched for plugins before the usual folders.
///
/// # Errors
/// Everything that is wrong with it.
pub fn read(path: &Path, overrides: &[String], plugin_paths: &[PathBuf]) -> Result<Case, CaseErrors> {
    read_by(Reader::new(folder_of(path), plugin_paths, false), path, None, overrides)
}

/// Reads a case that was made in memory as if it stood in the file `path`.
///
/// # Errors
/// Everything that is wrong with it.
pub fn read_document(document: Value, path: &Path, plugin_paths: &[PathBuf]) -> Result<Case, CaseErrors> {
    read_by(Reader::new(folder_of(path), plugin_paths, false), path, Some(document), &[])
}

/// Reads a case file, or a document as if it stood there. One from an unknown source may name plugins of the search path by
/// their names, no symbol in them, and files within its folder.
///
/// # Errors
/// Everything that is wrong with it.
pub fn read_by(
    mut reader: Reader<'_>,
    path: &Path,
    document: Option<Value>,
    overrides: &[String],
) -> Result<Case, CaseErrors> {
    let text = match document.map(|document| overridden(document, overrides)) {
        Some(text) => text.map_err(|problems| reader.problems.extend(problems)).ok(),
        None => text_with(path, overrides, &mut reader.problems),
    };
    let case = text.and_then(|text| read_with(&mut reader, path, text));
    finished(reader, path, case)
}

/// The case, if nothing is wrong with it.
fn finished(reader: Reader<'_>, path: &Path, case: Option<Case>) -> Result<Case, CaseErrors> {
    match case {
        Some(case) if reader.problems.is_empty() => Ok(case),
        _ => Err(CaseErrors { file: path.into(), problems: reader.problems }),
    }
}

/// Returns whether a file is a study rather than a case.
pub fn is_study(path: &Path) -> bool {
    document(path, &[]).is_some_and(|document| document["kind"] == structure::STUDY)
}

/// Applies overrides to a document as to a file.
///
/// # Errors
/// Overrides that cannot be applied, and texts that no page can show.
pub fn overridden(mut document: Value, overrides: &[String]) -> Result<Value, Vec<Problem>> {
    let mut problems: Vec<Problem> = overrides.iter().filter_map(|text| json::set(&mut document, text).err()).collect();
    json::check_texts(&document, &Place::root(), &mut problems);
    if problems.is_empty() { Ok(document) } else { Err(problems) }
}

/// A case file as JSON with its overrides, nothing of it checked; `None` if it is no JSON.
pub fn document(path: &Path, overrides: &[String]) -> Option<Value> {
    text_with(path, overrides, &mut Vec::new())
}

/// Reads a case file as JSON: what it says, nothing of it checked.
///
/// # Errors
/// Everything that is wrong with it as JSON.
pub fn read_text(path: &Path) -> Result<Value, CaseErrors> {
    let mut problems = Vec::new();
    match text_with(path, &[], &mut problems) {
        Some(document) if problems.is_empty() => Ok(document),
        _ => Err(CaseErrors { file: path.into(), problems }),
    }
}

/// Returns why a case needs its own process, if it does. A case that cannot be read does not: reading it again reports
/// what is wrong.
pub fn need(path: &Path, overrides: &[String], plugin_paths: &[PathBuf]) -> Option<Need> {
    isolation::need(&document(path, overrides)?, path, plugin_paths)
}

/// The files that a case is read from: its own, and those that texts of it name (meshes, tables, measured curves), with
/// the overrides. Plugins that are found by name are not among them.
pub fn inputs(path: &Path, overrides: &[String]) -> Vec<PathBuf> {
    let mut files = vec![path.to_owned()];
    files.extend(named_inputs(&document(path, overrides).unwrap_or_default(), path));
    files
}

/// The files that texts of a document name which stands in the file `path`, that one left out.
pub fn named_inputs(document: &Value, path: &Path) -> Vec<PathBuf> {
    let mut files = vec![path.to_owned()];
    named_files(document, folder_of(path), &mut files);
    files.split_off(1)
}

fn named_files(value: &Value, folder: &Path, files: &mut Vec<PathBuf>) {
    match value {
        Value::String(text) if !text.is_empty() => {
            let path = folder.join(text);
            if path.is_file() && !files.contains(&path) {
                files.push(path.clone());
                // a case that another one runs names files of its own
                if path.extension().is_some_and(|extension| extension == "json") {
                    named_files(&document(&path, &[]).unwrap_or_default(), folder_of(&path), files);
                }
            }
        }
        Value::Array(entries) => entries.iter().for_each(|entry| named_files(entry, folder, files)),
        Value::Object(members) => members.values().for_each(|member| named_files(member, folder, files)),
        _ => {}
    }
}

fn text_with(path: &Path, overrides: &[String], problems: &mut Vec<Problem>) -> Option<Value> {
    let unreadable = |error| Problem::unreadable(format!("the case file cannot be read: {error}"));
    let parsed = input::text(path, Input::Case).map_err(unreadable).and_then(|text| json::parse(&text));
    let (mut document, repeated) = parsed.map_err(|problem| problems.push(problem)).ok()?;
    problems.extend(repeated);
    problems.extend(overrides.iter().filter_map(|text| json::set(&mut document, text).err()));
    json::check_texts(&document, &Place::root(), problems);
    Some(document)
}

/// Sets the answers of GETJOBNAME and GETOUTDIR from now on.
fn announce(path: &Path, document: &Value) {
    announce_job(&path.file_stem().unwrap_or_default().to_string_lossy(), &job_folder(path, document));
}

fn read_with(reader: &mut Reader<'_>, path: &Path, document: Value) -> Option<Case> {
    if let Some(folder) = document["job_folder"].as_str() {
        reader.file(folder, &Place::root().key("job_folder"))?;
    }
    for (index, name) in document["files"].as_array().into_iter().flatten().enumerate() {
        let place = Place::root().key("files").index(index);
        let file = name.as_str().and_then(|name| reader.file(name, &place));
        if let Some(file) = file.filter(|file| !file.is_file()) {
            reader.problem(&place, format!("there is no file {} (relative to the case file)", file.display()));
        }
    }
    // a library may be called while its case is read
    announce(path, &document);
    match structure::kind_of(&document).map(str::to_owned) {
        Ok(kind) => resolve(reader, path, &kind, document),
        Err(problem) => {
            reader.problems.push(problem);
            None
        }
    }
}

/// Resolves a study file; what is wrong with it goes to the reader.
pub fn read_study<D: DeserializeOwned, T>(
    reader: &mut Reader<'_>,
    path: &Path,
    resolve: impl FnOnce(&mut Reader<'_>, D) -> Option<T>,
) -> Option<T> {
    let document = text_with(path, &[], &mut reader.problems)?;
    read_family(reader, structure::STUDY, document, resolve)
}

/// Resolves the document of a sweep; what is wrong with it goes to the reader.
pub fn read_sweep<D: DeserializeOwned, T>(
    reader: &mut Reader<'_>,
    document: Value,
    resolve: impl FnOnce(&mut Reader<'_>, D) -> Option<T>,
) -> Option<T> {
    read_family(reader, structure::SWEEP, document, resolve)
}

/// Resolves the document of several runs.
fn read_family<D: DeserializeOwned, T>(
    reader: &mut Reader<'_>,
    kind: &str,
    document: Value,
    resolve: impl FnOnce(&mut Reader<'_>, D) -> Option<T>,
) -> Option<T> {
    if document["kind"] != kind {
        let what = document["kind"]
            .as_str()
            .map_or_else(String::new, |other| format!(", this is {}", structure::what_runs(other)));
        reader.problem(&Place::root().key("kind"), format!("a {kind} has the kind \"{kind}\"{what}"));
        return None;
    }
    let document = typed(reader, kind, &document)?;
    resolve(reader, document)
}

/// Checks first the structure, then the meaning: a document of another structure has none.
fn resolve(reader: &mut Reader<'_>, path: &Path, kind: &str, document: Value) -> Option<Case> {
    match kind {
        "interface" => {
            let case: InterfaceCase = typed(reader, kind, &document)?;
            let resolved = interface::resolve(reader, &case);
            finish(reader, path, document, resolved, &case.head, &case.course, &case.path)
        }
        "pullout" => {
            let case: PulloutCase = typed(reader, kind, &document)?;
            specimen::resolve(reader, path, &case).map(|program| Case::Pullout(Box::new(program)))
        }
        "bridging" => {
            let case: BridgingCase = typed(reader, kind, &document)?;
            let others = bridging::ReferencedCases { specimen, document: |file| self::document(file, &[]), law };
            bridging::resolve(reader, path, &case, &others).map(|program| Case::Bridging(Box::new(program)))
        }
        _ => {
            let case: PointCase = typed(reader, kind, &document)?;
            let resolved = point::resolve(reader, &case);
            finish(reader, path, document, resolved, &case.head, &case.course, &case.path)
        }
    }
}

/// A specimen that another case takes curves of; `None`: its plugins must not be loaded here, its own run checks them.
fn specimen(reader: &Reader<'_>, file: &Path, overrides: &[String]) -> bridging::ReadSpecimen {
    let error_of = |problems: Vec<Problem>| {
        let first = problems.into_iter().next().unwrap_or_else(|| Problem::unreadable("it is wrong".to_owned()));
        let message = format!("{}: {first}", file.display());
        bridging::WrongSpecimen { place: first.place, message }
    };
    let no_specimen = || bridging::WrongSpecimen { place: None, message: "is no case of kind \"pullout\"".to_owned() };
    let mut problems = Vec::new();
    let document = text_with(file, overrides, &mut problems);
    // a case that is its own base would be read without end
    let Some(document) = document.filter(|_| problems.is_empty()) else { return Err(error_of(problems)) };
    if document["kind"] != "pullout" {
        return Err(no_specimen());
    }
    if need(file, overrides, reader.plugin_paths).is_some() {
        let problems = structure::check("pullout", &document);
        return if problems.is_empty() { Ok(None) } else { Err(error_of(problems)) };
    }
    match read_by(Reader::new(folder_of(file), reader.plugin_paths, reader.is_untrusted), file, None, overrides) {
        Ok(Case::Pullout(program)) => Ok(Some(program)),
        Ok(_) => Err(no_specimen()),
        Err(errors) => Err(error_of(errors.problems)),
    }
}

/// A law of contact that another case takes the traction of.
fn law(reader: &Reader<'_>, material: &Value, steps: &[Value]) -> bridging::ReadLaw {
    let document = json!({ "kind": "interface", "material": material, "steps": steps });
    let file = reader.folder.join("law.json");
    if isolation::need(&document, &file, reader.plugin_paths).is_some() {
        let message = "runs in a process of its own, where no other case can ask it: give points [slip, traction]";
        return Err(Problem::new(bridging::law_place(), message));
    }
    match read_by(Reader::new(reader.folder, reader.plugin_paths, reader.is_untrusted), &file, Some(document), &[]) {
        Ok(Case::Path(program)) => Ok(program),
        Ok(_) => Err(Problem::new(bridging::law_place(), "is no law of contact")),
        Err(errors) => {
            let first = errors.problems.into_iter().next();
            Err(first.map_or_else(|| Problem::new(bridging::law_place(), "cannot be read"), Problem::of_bond_law))
        }
    }
}

/// A document, unless its structure is wrong.
fn typed<T: DeserializeOwned>(reader: &mut Reader<'_>, kind: &str, document: &Value) -> Option<T> {
    let problems = structure::check(kind, document);
    if !problems.is_empty() {
        reader.problems.extend(problems);
        return None;
    }
    let read = T::deserialize(document).map_err(|error| format!("cannot be read: {error}"));
    reader.without_problem(read, &Place::root())
}

/// Puts the program of a point together if nothing is missing.
fn finish<S>(
    reader: &mut Reader<'_>,
    path: &Path,
    document: Value,
    resolved: Resolved,
    head: &document::CommonCaseEntries,
    course: &document::Course,
    given: &document::Path<S>,
) -> Option<Case> {
    let root = Place::root();
    let about = history::about(reader, path, head, course.until.as_ref(), resolved.columns.as_deref());
    let output = given.output.clone().unwrap_or_default();
    if output.vtu == Some(true) {
        reader.warn("output.vtu: a case of this kind has no mesh; no VTU file is written".into());
    }
    if output.heat.is_some() && matches!(resolved.kind, program::PointKind::Interface(_)) {
        reader.warn_no_effect(&root.key("output").key("heat"), "a contact law returns none of it");
    }
    let (plugin, kind) = (resolved.plugin?, resolved.kind);
    let most: Vec<Option<u64>> = pullout_run::path::increments_of_steps(&kind).into_iter().map(Some).collect();
    let (plots, captions) = Plots::of(output.plots.as_ref());
    Some(Case::Path(Box::new(Program {
        about: About {
            recorded: increments::recorded(reader, course.increments.as_ref(), &most, about.until.is_some()),
            every: output.every.map_or(1, |every| every.0),
            plots,
            captions,
            warnings: std::mem::take(&mut reader.warnings),
            notes: std::mem::take(&mut reader.notes),
            highlights: std::mem::take(&mut reader.highlights),
            defaults: std::mem::take(&mut reader.defaults),
            ..about
        },
        document,
        plugin,
        kind,
        characteristic_length: resolved.characteristic_length,
        controls: *given.controls.clone().unwrap_or_default(),
    })))
}
