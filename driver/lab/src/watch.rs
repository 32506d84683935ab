//! Changes of files: of a case and all that it names, of a source and all that it includes.

use pullout_check::build;
use pullout_engine::CaseSource;
use pullout_run::input::folder_of;
use pullout_run::isolation::{materials, named_file};
use std::collections::BTreeMap;
use std::os::unix::fs::MetadataExt;
use std::path::{Path, PathBuf};
use std::thread;
use std::time::{Duration, SystemTime};
use umat_abi::host::{is_source, real_path};

/// Time between two looks at the files.
const LOOK: Duration = Duration::from_millis(50);

/// State of a file: a file that is written again has another one.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct FileStamp {
    modified: SystemTime,
    length: u64,
    inode: u64,
}

impl FileStamp {
    /// The present state of a file; `None`: it is not there.
    pub fn of(file: &Path) -> Option<Self> {
        let data = file.metadata().ok()?;
        Some(Self { modified: data.modified().ok()?, length: data.len(), inode: data.ino() })
    }
}

/// Files whose changes are waited for.
#[derive(Clone, Debug)]
pub struct FileWatch(BTreeMap<PathBuf, Option<FileStamp>>);

impl FileWatch {
    /// Watches files from their present state on.
    pub fn of(files: impl IntoIterator<Item = PathBuf>) -> Self {
        Self(files.into_iter().map(|file| (file.clone(), FileStamp::of(&file))).collect())
    }

    /// Watches everything that a run of a case depends on.
    pub fn of_case(source: &CaseSource) -> Self {
        let document = source.text().unwrap_or_default();
        let of_plugin = |plugin: &str| named_file(plugin, folder_of(&source.file), &source.plugin_paths);
        let plugins = materials(&document).into_iter().filter_map(|material| of_plugin(material["plugin"].as_str()?));
        // a file that is named in several ways is one
        let mut files: BTreeMap<PathBuf, PathBuf> = BTreeMap::new();
        for file in source.inputs().into_iter().chain(plugins).flat_map(|file| with_included(&file)) {
            files.entry(real_path(&file)).or_insert(file);
        }
        Self::of(files.into_values())
    }

    /// Adds other files.
    #[must_use]
    pub fn and(mut self, other: Self) -> Self {
        self.0.extend(other.0);
        self
    }

    /// The files.
    pub fn files(&self) -> impl Iterator<Item = &Path> {
        self.0.keys().map(PathBuf::as_path)
    }

    /// Waits until files have changed and are whole: all are there, and none has changed since the last look (editors and
    /// compilers take files away for a moment, and write them in pieces). Returns those that have changed; none if `ends` says so.
    pub fn wait(&mut self, ends: &dyn Fn() -> bool) -> Vec<PathBuf> {
        let mut last = self.0.clone();
        while !ends() {
            thread::sleep(LOOK);
            let Self(present) = Self::of(self.0.keys().cloned());
            let changed: Vec<&PathBuf> = present.keys().filter(|file| present[*file] != self.0[*file]).collect();
            let is_whole = changed.iter().all(|file| present[*file].is_some());
            if present == last && is_whole && !changed.is_empty() {
                let changed = changed.into_iter().cloned().collect();
                self.0 = present;
                return changed;
            }
            last = present;
        }
        Vec::new()
    }
}

/// A file, and of a source all that it includes.
pub(crate) fn with_included(file: &Path) -> Vec<PathBuf> {
    if is_source(file) { build::inputs(file) } else { vec![file.to_owned()] }
}
