//! `manifest.json`.

use super::names::{self, Kind};
use super::{MANIFEST, at, fs, io, write_whole};
use pullout_run::input::{self, Input};
use serde::{Deserialize, Serialize};
use std::collections::{BTreeMap, BTreeSet};
use std::hash::Hasher;
use std::os::unix::fs::MetadataExt;
use std::path::{Path, PathBuf};
use twox_hash::XxHash64;

/// Files beyond this size are known by size and time alone: what memory does not keep takes as long to read as to write.
const MOST_HASHED: u64 = 64 << 20;

/// Record of the files that the program wrote.
#[derive(Clone, Debug, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct Manifest {
    /// The version of the program.
    pullout: String,
    /// Source of the results.
    pub(super) kind: Kind,
    /// Each file with its content; without one it is being written, or was when the program was killed. Names may be
    /// patterns then.
    files: BTreeMap<String, Option<Content>>,
    /// Folders of earlier results with their files.
    earlier: BTreeMap<String, Vec<String>>,
}

/// The content of a file.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct Content {
    bytes: u64,
    /// Time of the last change, s and ns.
    modified: (i64, i64),
    /// Hash of it, hexadecimal.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    xxh64: Option<String>,
    /// The same of results that an earlier program wrote.
    #[serde(default, skip_serializing)]
    sha256: Option<String>,
}

impl Content {
    fn of(path: &Path) -> io::Result<Self> {
        let file = fs::metadata(path).map_err(at(path))?;
        let xxh64 = (file.len() <= MOST_HASHED).then(|| xxh64(path).map_err(at(path))).transpose()?;
        Ok(Self { bytes: file.len(), modified: (file.mtime(), file.mtime_nsec()), xxh64, sha256: None })
    }

    /// Returns whether a file has it. A copy of the file has another time, and so has one that was changed: its hash decides.
    fn is_in(&self, path: &Path) -> bool {
        let Ok(file) = fs::metadata(path) else { return false };
        let same_hash = || match (&self.xxh64, &self.sha256) {
            (Some(hash), _) => xxh64(path).is_ok_and(|of| of == *hash),
            (None, Some(hash)) => input::digest(path, u64::MAX).is_ok_and(|of| input::hexadecimal(of) == *hash),
            (None, None) => false,
        };
        file.len() == self.bytes && ((file.mtime(), file.mtime_nsec()) == self.modified || same_hash())
    }
}

fn xxh64(path: &Path) -> io::Result<String> {
    let mut hash = XxHash64::with_seed(0);
    input::in_pieces(path, u64::MAX, |piece| hash.write(piece))?;
    Ok(input::digits(hash.finish().to_be_bytes()))
}

impl Manifest {
    pub(super) fn new(kind: Kind) -> Self {
        let pullout = env!("CARGO_PKG_VERSION").into();
        Self { pullout, kind, files: BTreeMap::new(), earlier: BTreeMap::new() }
    }

    /// Reads the manifest of a directory; `None`: nothing there is ours.
    pub(super) fn read(directory: &Path) -> io::Result<Option<Self>> {
        let path = directory.join(MANIFEST);
        match input::read(&path, Input::Result) {
            Ok(text) => {
                let manifest: Option<Self> = serde_json::from_slice(&text).ok();
                // anyone who can write into the folder can write a manifest: it may name only files in the folder whose names are
                // those of results
                let ours = manifest.filter(Self::names_results);
                ours.map(Some).ok_or_else(|| super::super::malformed(&path, "not ours"))
            }
            Err(error) if error.kind() == io::ErrorKind::NotFound => Ok(None),
            Err(error) => Err(at(&path)(error)),
        }
    }

    pub(super) fn write(&self, directory: &Path) -> io::Result<()> {
        let path = directory.join(MANIFEST);
        write_whole(&path, format!("{}\n", serde_json::to_string_pretty(self)?).as_bytes())
    }

    /// Returns whether all its names are names of results: files, and folders of earlier results with their files.
    fn names_results(&self) -> bool {
        let mut names = self.files.keys().chain(self.earlier.values().flatten());
        names.all(|name| names::lies_within(name) && names::is_of_results(name))
            && self.earlier.keys().all(|folder| names::is_aside(folder))
    }

    /// Returns the folders that contain result files, without the directory itself.
    pub(super) fn folders(&self) -> BTreeSet<PathBuf> {
        let mut folders = BTreeSet::from(["fields", "plots"].map(PathBuf::from));
        for name in self.files.keys().chain(&self.aside()) {
            folders.extend(Path::new(name).ancestors().skip(1).map(Path::to_owned));
        }
        folders.remove(Path::new(""));
        folders
    }

    /// Returns whether it lists nothing.
    pub(super) fn is_empty(&self) -> bool {
        self.files.is_empty() && self.earlier.is_empty()
    }

    /// Files that are there and have a name that it lists.
    pub(super) fn present(&self, directory: &Path) -> BTreeSet<String> {
        self.files.keys().flat_map(|pattern| names::present(pattern, directory)).collect()
    }

    /// Returns whether pullout wrote the file of this name.
    pub(super) fn owns(&self, name: &str, directory: &Path) -> bool {
        match self.files.get(name) {
            Some(Some(content)) => content.is_in(&directory.join(name)),
            Some(None) => true,
            None => self.is_claimed(name),
        }
    }

    /// Returns whether a name is being written.
    pub(super) fn is_claimed(&self, name: &str) -> bool {
        self.files.iter().any(|(pattern, content)| content.is_none() && names::fits(pattern, name))
    }

    /// Lists names as being written.
    pub(super) fn claim<'n>(&mut self, names: impl IntoIterator<Item = &'n str>) {
        self.files.extend(names.into_iter().map(|name| (name.to_owned(), None)));
    }

    /// Drops all names but these.
    pub(super) fn forget_all_but(&mut self, names: &[&str]) {
        self.files.retain(|name, _| names.contains(&name.as_str()));
    }

    /// Lists files as set aside in a folder.
    pub(super) fn set_aside<'n>(&mut self, folder: &str, files: impl Iterator<Item = &'n String>) {
        self.earlier.insert(folder.to_owned(), files.cloned().collect());
    }

    /// The files that were set aside, by their present names.
    pub(super) fn aside(&self) -> Vec<String> {
        self.earlier
            .iter()
            .flat_map(|(folder, files)| files.iter().map(move |file| format!("{folder}/{file}")))
            .collect()
    }

    pub(super) fn forget_aside(&mut self) {
        self.earlier.clear();
    }

    /// Records the content of all files that were being written.
    pub(super) fn close(&mut self, directory: &Path) -> io::Result<()> {
        let (written, known): (Vec<_>, Vec<_>) =
            std::mem::take(&mut self.files).into_iter().partition(|(_, content)| content.is_none());
        self.files = known.into_iter().collect();
        for name in written.iter().flat_map(|(pattern, _)| names::present(pattern, directory)) {
            let content = Content::of(&directory.join(&name))?;
            self.files.insert(name, Some(content));
        }
        Ok(())
    }
}
