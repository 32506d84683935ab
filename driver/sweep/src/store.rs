//! The folder of a sweep. Nothing in it is written twice, and nobody waits for a lock: new files are put into their places
//! whole, so that any number of processes on any file system may work at the same time.
//!
//! ```text
//! sweep.json             what is run and kept
//! files/<sha256>/…       the files that a case names, and libraries that were not built with the program
//! parts/*.jsonl          a row for each run that is over
//! replay/<key>.json      the case that repeats what failed
//! running/…              what workers are at
//! collected/<sha256>     the contents of tables that were collected, which may be replaced
//! ```

use crate::table::{Column, Table, replace};
use pullout_case::Reader;
use pullout_case::study::{Columns, QuantityOfFile};
use pullout_engine::RunKey;
use pullout_report::{at, directory::refuse_file};
use pullout_run::input::{self, Input};
use pullout_run::isolation::{self, Need};
use serde::{Deserialize, Serialize};
use serde_json::{Map, Value};
use sha2::{Digest, Sha256};
use std::collections::{BTreeMap, HashMap};
use std::fs::{self, File};
use std::io::{self, Write};
use std::path::{Path, PathBuf};
use umat_abi::host;

/// Plan of a sweep: its runs and what is kept of them.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct Sweep {
    /// Version of this format.
    pub version: u32,
    /// Title.
    pub title: String,
    /// The case, in which files have the names that they have in the folders below `files`.
    pub base: Value,
    /// Dotted paths of what is varied.
    pub parameters: Vec<String>,
    /// Values, run by run; files have the names that they have below `files`.
    pub runs: Vec<Vec<Value>>,
    /// Original values that name files, by the number of the run.
    #[serde(default, skip_serializing_if = "BTreeMap::is_empty")]
    pub written: BTreeMap<usize, Vec<Value>>,
    /// Folders below `files`.
    pub bundles: Vec<String>,
    /// The folder of each run; empty: the first is that of all.
    pub bundle_of: Vec<usize>,
    /// Numbers and curves that are kept.
    pub(crate) keep: Keep,
}

/// Numbers and curves that are kept of a run.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub(crate) struct Keep {
    /// The curve whose peak and work count.
    pub curve: Columns,
    /// End of the integral for the work; `None`: the end of the run.
    pub work_to: Option<f64>,
    /// Numbers by their names.
    pub quantities: BTreeMap<String, QuantityOfFile>,
    /// History columns.
    pub curves: Vec<String>,
    /// Values of the curve's x at which they are kept; `None`: at their own rows.
    pub grid: Option<Vec<f64>>,
}

/// Version of [`Sweep`].
pub const VERSION: u32 = 1;

/// The folder of a sweep.
#[derive(Clone, Debug)]
pub struct Store {
    folder: PathBuf,
}

/// Puts a file into its place whole.
fn put(path: &Path, content: &[u8]) -> io::Result<()> {
    let folder = path.parent().unwrap_or(Path::new("."));
    fs::create_dir_all(folder)?;
    replace(path, |mut file| file.write_all(content), |_| Ok(()))
}

impl Store {
    /// Makes a store in a folder.
    pub fn new(folder: &Path) -> Self {
        Self { folder: folder.into() }
    }

    /// The folder.
    pub fn folder(&self) -> &Path {
        &self.folder
    }

    /// Returns what is run.
    ///
    /// # Errors
    /// There is none, or of another version.
    pub fn sweep(&self) -> io::Result<Sweep> {
        let path = self.folder.join("sweep.json");
        let wrong =
            |message: String| io::Error::new(io::ErrorKind::InvalidData, format!("{}: {message}", path.display()));
        let text = fs::read(&path).map_err(|error| wrong(format!("{error}: `pullout sweep plan` begins a sweep")))?;
        let sweep: Sweep = serde_json::from_slice(&text).map_err(|error| wrong(error.to_string()))?;
        let runs = sweep.runs.len();
        if !sweep.bundles.iter().all(|bundle| is_hash(bundle)) {
            return Err(wrong("bundles: are not names that this program gives to folders below files/".into()));
        }
        let is_sound = sweep.version == VERSION
            && sweep.runs.iter().chain(sweep.written.values()).all(|run| run.len() == sweep.parameters.len())
            && (sweep.bundle_of.is_empty() || sweep.bundle_of.len() == runs)
            && !sweep.bundles.is_empty()
            && sweep.bundle_of.iter().all(|bundle| *bundle < sweep.bundles.len());
        if is_sound { Ok(sweep) } else { Err(wrong("it is of another version: plan the sweep again".into())) }
    }

    /// Refuses a folder whose `sweep.json` is not a plan: it is the user's, a sweep file perhaps.
    ///
    /// # Errors
    /// That is so, or it cannot be read.
    pub(crate) fn may_plan(&self) -> io::Result<()> {
        refuse_file(&self.folder)?;
        let path = self.folder.join("sweep.json");
        if fs::symlink_metadata(&path).is_err_and(|error| error.kind() == io::ErrorKind::NotFound) {
            return Ok(());
        }
        let written: Option<Value> = fs::read(&path).ok().and_then(|text| serde_json::from_slice(&text).ok());
        // plans of all versions
        let is_plan = written.as_ref().is_some_and(|written| {
            written["version"].is_u64() && written["runs"].is_array() && written["kind"].is_null()
        });
        if is_plan {
            return Ok(());
        }
        let message = "is no plan that this program wrote, and would be replaced by one: choose another --out";
        Err(io::Error::new(io::ErrorKind::InvalidData, format!("{} {message}", path.display())))
    }

    /// Begins a sweep, or changes its runs. Finished runs are kept.
    ///
    /// # Errors
    /// The file cannot be written.
    pub fn plan(&self, sweep: &Sweep) -> io::Result<()> {
        put(&self.folder.join("sweep.json"), serde_json::to_string(sweep)?.as_bytes())
    }

    /// Files with parts of the rows. Those of earlier versions, in Parquet, have rows of other programs, which do not count.
    ///
    /// # Errors
    /// The folder cannot be read.
    pub fn parts(&self) -> io::Result<Vec<PathBuf>> {
        let folder = self.folder.join("parts");
        if !folder.exists() {
            return Ok(Vec::new());
        }
        let entries: io::Result<Vec<fs::DirEntry>> = fs::read_dir(folder)?.collect();
        let mut parts: Vec<PathBuf> = entries?.into_iter().map(|entry| entry.path()).collect();
        parts.retain(|path| !is_hidden(path) && path.extension().is_some_and(|extension| extension == "jsonl"));
        parts.sort();
        Ok(parts)
    }

    /// Adds rows. The name of their file has the hash of its content.
    ///
    /// # Errors
    /// They cannot be written.
    pub fn add(&self, rows: &Table, first: usize) -> io::Result<()> {
        let folder = self.folder.join("parts");
        fs::create_dir_all(&folder)?;
        let new = folder.join(format!(".part{}", unique()?));
        rows.write(&new)?;
        let hash = input::digits(input::hash(&new, Input::Mesh)?);
        let part = folder.join(format!("{first:07}-{hash}.jsonl"));
        fs::rename(&new, &part).map_err(at(&part))
    }

    /// Reads columns of a part, if its content is what its name says.
    ///
    /// # Errors
    /// It cannot be read, or is damaged.
    pub(crate) fn part(path: &Path, wants: impl Fn(&str) -> bool) -> io::Result<Table> {
        let name = path.file_stem().unwrap_or_default().to_string_lossy();
        let hash = input::digits(input::hash(path, Input::Mesh)?);
        if name.split_once('-').is_some_and(|(_, named)| named == hash) {
            return Table::read(path, wants);
        }
        let message = format!("{}: is damaged: remove it, and its runs are run again", path.display());
        Err(io::Error::new(io::ErrorKind::InvalidData, message))
    }

    /// Checks the files that cases name against the hashes that their folders have as names.
    ///
    /// # Errors
    /// A folder has other files than those that were planned.
    pub(crate) fn check_bundles(&self, sweep: &Sweep) -> io::Result<()> {
        for bundle in &sweep.bundles {
            let folder = self.folder.join("files").join(bundle);
            let mut files = BTreeMap::new();
            collect_files(&folder, "", &mut files)?;
            // of a plan of an earlier version
            let before = files.iter().map(|(name, file)| {
                let is_plugin = name.starts_with("plugins/");
                (if is_plugin { format!("./{name}") } else { name.clone() }, file.clone())
            });
            let before = Bundle { files: before.collect() };
            if (Bundle { files }).digest()? != *bundle && before.digest()? != *bundle {
                let message = "has not the files that were planned: remove it, and plan the sweep again";
                return Err(io::Error::new(io::ErrorKind::InvalidData, format!("{}: {message}", folder.display())));
            }
        }
        Ok(())
    }

    /// Waits for the turn to take runs, which one worker has at a time, as long as it keeps the file. On a file system without locks
    /// all have it, and some runs may be run twice.
    pub(crate) fn turn(&self) -> io::Result<File> {
        let path = self.folder.join("turn");
        let file = File::options().write(true).create(true).truncate(false).open(&path).map_err(at(&path))?;
        let _ = file.lock();
        Ok(file)
    }

    /// Makes a file for what a worker on a machine is at, and locks it.
    pub(crate) fn running(&self, host: &str, head: &[u8]) -> io::Result<(File, PathBuf)> {
        let folder = self.folder.join("running");
        fs::create_dir_all(&folder)?;
        loop {
            let path = folder.join(format!("{host}.{}", unique()?));
            let mut file = File::options().read(true).append(true).create_new(true).open(&path).map_err(at(&path))?;
            // a file system without locks does without: see `claim`
            let _ = file.lock();
            // before it was locked, it looked like one left by a worker that was ended just there
            if path.exists() {
                file.write_all(head).map_err(at(&path))?;
                return Ok((file, path));
            }
        }
    }

    /// The files of all workers.
    pub(crate) fn claims(&self) -> io::Result<Vec<PathBuf>> {
        match fs::read_dir(self.folder.join("running")) {
            Ok(entries) => {
                let mut claims: Vec<PathBuf> = entries.flatten().map(|entry| entry.path()).collect();
                // others' files stay
                claims.retain(|path| path.extension().is_some_and(|unique| unique.len() == UNIQUE));
                Ok(claims)
            }
            Err(error) if error.kind() == io::ErrorKind::NotFound => Ok(Vec::new()),
            Err(error) => Err(error),
        }
    }

    /// Returns whether a file would lie in a folder of the store.
    pub(crate) fn has_inside(&self, path: &Path) -> bool {
        let folder = path.parent().filter(|folder| !folder.as_os_str().is_empty()).unwrap_or(Path::new("."));
        let (Ok(folder), Ok(own)) = (fs::canonicalize(folder), fs::canonicalize(&self.folder)) else { return false };
        ["files", "parts", "replay", "running", "collected"].iter().any(|name| folder.starts_with(own.join(name)))
    }

    /// Returns whether a table with this content was collected.
    pub(crate) fn has_collected(&self, content: &[u8; 32]) -> bool {
        self.collected(content).is_file()
    }

    /// Notes the content of a table that is collected.
    pub(crate) fn note_collected(&self, content: &[u8; 32]) -> io::Result<()> {
        if self.has_collected(content) { Ok(()) } else { put(&self.collected(content), b"") }
    }

    fn collected(&self, content: &[u8; 32]) -> PathBuf {
        self.folder.join("collected").join(input::digits(content))
    }

    /// Keeps the case that repeats a failure.
    ///
    /// # Errors
    /// The file cannot be written.
    pub(crate) fn keep_replay(&self, key: &str, case: &str) -> io::Result<()> {
        put(&self.folder.join("replay").join(format!("{key}.json")), case.as_bytes())
    }

    /// The folder in which the case of a run stands.
    pub(crate) fn bundle(&self, sweep: &Sweep, run: usize) -> PathBuf {
        self.folder.join("files").join(sweep.bundle_of(run))
    }
}

/// Returns whether a file is not in its place yet.
fn is_hidden(path: &Path) -> bool {
    path.file_name().is_some_and(|name| name.to_string_lossy().starts_with('.'))
}

/// Returns whether a text is a SHA-256.
fn is_hash(text: &str) -> bool {
    text.len() == 64 && text.bytes().all(|digit| matches!(digit, b'0'..=b'9' | b'a'..=b'f'))
}

/// Collects all files below a folder by their names in it; links to folders are files that cannot be read.
fn collect_files(folder: &Path, inside: &str, files: &mut BTreeMap<String, PathBuf>) -> io::Result<()> {
    for entry in fs::read_dir(folder).map_err(at(folder))? {
        let entry = entry?;
        let name = format!("{inside}{}", entry.file_name().to_string_lossy());
        if entry.file_type()?.is_dir() {
            collect_files(&entry.path(), &format!("{name}/"), files)?;
        } else {
            files.insert(name, entry.path());
        }
    }
    Ok(())
}

/// Number of characters of a name that no other process uses.
const UNIQUE: usize = 32;

/// A name that no other process takes.
fn unique() -> io::Result<String> {
    let mut random = [0; UNIQUE / 2];
    io::Read::read_exact(&mut File::open("/dev/urandom")?, &mut random)?;
    Ok(input::digits(random))
}

impl Sweep {
    fn bundle_of(&self, run: usize) -> &str {
        &self.bundles[self.bundle_of.get(run).copied().unwrap_or_default()]
    }

    /// The case of a run.
    pub fn document(&self, run: usize) -> Value {
        with(&self.base, &self.parameters, &self.runs[run])
    }

    /// The columns of what is varied, for some of the runs, as it was given; their types are those of all runs.
    pub(crate) fn varied(&self, runs: &[usize]) -> Vec<(String, Column)> {
        let column = |(index, path): (usize, &String)| {
            let values = || runs.iter().map(|run| &self.written.get(run).unwrap_or(&self.runs[*run])[index]);
            let text = |value: &Value| Some(value.as_str().map_or_else(|| value.to_string(), str::to_owned));
            let are_numbers = self.runs.iter().all(|run| run[index].is_number());
            let column = match are_numbers {
                true => Column::Number(values().map(Value::as_f64).collect()),
                false => Column::Text(values().map(text).collect()),
            };
            (format!("par.{path}"), column)
        };
        self.parameters.iter().enumerate().map(column).collect()
    }

    /// Returns whether a parameter has whole numbers alone, written as such.
    pub(crate) fn is_whole(&self, parameter: usize) -> bool {
        self.runs.iter().all(|run| run[parameter].is_i64())
    }

    /// Returns the sweep of these runs alone.
    pub fn part(&self, runs: &[usize]) -> Self {
        let bundle = |&run: &usize| self.bundle_of.get(run).copied().unwrap_or_default();
        Self {
            version: self.version,
            title: self.title.clone(),
            base: self.base.clone(),
            parameters: self.parameters.clone(),
            runs: runs.iter().map(|&run| self.runs[run].clone()).collect(),
            written: BTreeMap::new(),
            bundles: self.bundles.clone(),
            bundle_of: runs.iter().map(bundle).collect(),
            keep: self.keep.clone(),
        }
    }

    /// Returns what watches over calls of the libraries of a run.
    pub fn need(&self, store: &Store, run: usize) -> Need {
        let file = store.bundle(self, run).join("case.json");
        let document = self.document(run);
        let mut need = Need::default();
        for material in isolation::materials(&document) {
            need.watch(material, input::folder_of(&file), &[]);
        }
        need
    }
}

/// A case with values at dotted paths.
pub fn with(base: &Value, paths: &[String], values: &[Value]) -> Value {
    let texts: Vec<String> = paths.iter().zip(values).map(|(path, value)| format!("{path}={value}")).collect();
    // the plan has tried it
    pullout_case::overridden(base.clone(), &texts).unwrap_or_default()
}

/// Keys of runs: hashes of everything that their rows depend on.
pub struct Keys<'s> {
    sweep: &'s Sweep,
    /// The program and what is kept.
    common: RunKey,
    /// Hashes of libraries by their names.
    libraries: HashMap<String, Option<[u8; 32]>>,
}

impl<'s> Keys<'s> {
    /// Makes the keys of a sweep that is run by a program.
    pub fn new(sweep: &'s Sweep, engine: [u8; 32]) -> Self {
        let common = RunKey::new(engine).with_value(&serde_json::to_value(&sweep.keep).unwrap_or_default());
        Self { sweep, common, libraries: HashMap::new() }
    }

    /// Returns the key of a run.
    pub fn of(&mut self, run: usize) -> String {
        let document = self.sweep.document(run);
        let mut key = self.common.clone().with(self.sweep.bundle_of(run));
        for material in isolation::materials(&document) {
            let Some(name) = material["plugin"].as_str().filter(|name| !host::names_a_file(name)) else { continue };
            let hash = self.libraries.entry(name.to_owned()).or_insert_with(|| {
                let path = isolation::locate(name, Path::new(""), &[])?;
                input::hash(&path, Input::Library).ok()
            });
            key = key.with(hash.unwrap_or_default());
        }
        key.with_case(document).digits()
    }
}

/// The files of a case on their way into a store.
#[derive(Default)]
pub struct Bundle {
    /// Files by their names in the folder.
    files: BTreeMap<String, PathBuf>,
}

impl Bundle {
    /// Takes in what a case that stands in `folder` names, as far as `reader` lets it, and writes the names in the bundle into it.
    ///
    /// # Errors
    /// Two files with one name.
    pub fn take(&mut self, document: &mut Value, folder: &Path, reader: &Reader<'_>) -> io::Result<()> {
        match document {
            Value::Object(members) => self.take_members(members, folder, reader),
            Value::Array(entries) => entries.iter_mut().try_for_each(|entry| self.take(entry, folder, reader)),
            Value::String(text) if !text.is_empty() && reader.named(text).is_ok_and(|file| file.is_file()) => {
                let name = inside(text);
                self.add(name.clone(), folder.join(&*text))?;
                *text = name;
                Ok(())
            }
            _ => Ok(()),
        }
    }

    fn take_members(&mut self, members: &mut Map<String, Value>, folder: &Path, reader: &Reader<'_>) -> io::Result<()> {
        for (key, member) in members {
            match member.as_str().filter(|_| key == "plugin") {
                Some(name) => {
                    let path = isolation::locate(name, folder, reader.plugin_paths());
                    if let Some(path) = path.filter(|path| host::names_a_file(name) || !isolation::is_shipped(path)) {
                        let file = path.file_name().unwrap_or_default().to_string_lossy();
                        let name = format!("plugins/{file}");
                        self.add(name.clone(), path.clone())?;
                        *member = format!("./{name}").into();
                    }
                }
                None => self.take(member, folder, reader)?,
            }
        }
        Ok(())
    }

    fn add(&mut self, name: String, file: PathBuf) -> io::Result<()> {
        match self.files.insert(name.clone(), file.clone()) {
            Some(other) if input::hash(&other, Input::Mesh)? != input::hash(&file, Input::Mesh)? => {
                let message = format!("{} and {} would both be {name} in the store", other.display(), file.display());
                Err(io::Error::new(io::ErrorKind::InvalidInput, message))
            }
            _ => Ok(()),
        }
    }

    /// Returns the hash of names and contents.
    fn digest(&self) -> io::Result<String> {
        let mut digest = Sha256::new();
        for (name, file) in &self.files {
            digest.update(name);
            digest.update([0]);
            digest.update(input::hash(file, Input::Mesh)?);
        }
        Ok(input::hexadecimal(digest))
    }

    /// Copies the files into a store; the name of their folder.
    ///
    /// # Errors
    /// They cannot be read or written.
    pub(crate) fn put_into(&self, store: &Store) -> io::Result<String> {
        let bundle = self.digest()?;
        let folder = store.folder.join("files").join(&bundle);
        if !folder.exists() {
            // whole, or not there
            let parent = store.folder.join("files");
            fs::create_dir_all(&parent)?;
            let new = tempfile::Builder::new().prefix(".new").tempdir_in(&parent)?;
            for (name, file) in &self.files {
                put(&new.path().join(name), &input::read(file, Input::Mesh)?)?;
            }
            use std::os::unix::fs::PermissionsExt;
            fs::set_permissions(new.path(), fs::Permissions::from_mode(0o755))?;
            let new = new.keep();
            if let Err(error) = fs::rename(&new, &folder) {
                fs::remove_dir_all(&new)?;
                // another process was faster
                if !folder.exists() {
                    return Err(error);
                }
            }
        }
        Ok(bundle)
    }
}

/// The name of a file in a folder of its own: what leads out of it does no longer.
fn inside(name: &str) -> String {
    use std::path::Component;
    let part = |part: Component<'_>| match part {
        Component::ParentDir => Some("up".to_owned()),
        Component::RootDir => Some("root".to_owned()),
        Component::Normal(name) => Some(name.to_string_lossy().into_owned()),
        Component::CurDir | Component::Prefix(_) => None,
    };
    Path::new(name).components().filter_map(part).collect::<Vec<_>>().join("/")
}
