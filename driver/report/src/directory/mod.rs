//! The result directory: who may write in it, and which of its files belong to pullout.
//!
//! ```text
//! DIR/manifest.json      what pullout wrote here, each file with its content (manifest)
//! DIR/.pullout.lock      while something writes here: process and host (lock)
//! DIR/previous/          earlier results, from when a run begins until the new summary stands
//! DIR/history.csv, …     results
//! ```
//!
//! Only files in the manifest whose content matches the manifest are ever replaced or removed; all others belong to the user. If
//! a user's file has a name that results may need, the directory is refused before anything runs, or `--overwrite` treats the
//! file like a result. Input files of a case are never touched.
//!
//! A killed run leaves its manifest open: the names that it claimed belong to pullout with any content. The next run sets these
//! files aside as well, so that nothing is removed before a new summary is complete.

use super::at;
use manifest::Manifest;
use std::fs::{self, File};
use std::io::{self, Write};
use std::os::unix::fs::MetadataExt;
use std::path::{Path, PathBuf};

mod lock;
mod manifest;
mod names;
#[cfg(test)]
mod test;

pub use lock::Lock;
pub use names::Kind;

/// File that says what the program wrote.
pub const MANIFEST: &str = "manifest.json";
/// Name of a file while it is written, next to its final place.
const PARTIAL: &str = ".pullout.partial";
/// Largest number of file names in a message.
const MOST_NAMES: usize = 10;

/// Manner of opening a directory.
#[derive(Clone, Copy, Debug, Default)]
pub struct Access<'a> {
    /// Files that the results are made from: never touched.
    pub inputs: &'a [PathBuf],
    /// Whether files in the way are replaced.
    pub overwrite: bool,
    /// The process that started this one holds the lock.
    pub is_locked: bool,
}

/// A directory that this process may write results into.
#[derive(Debug)]
pub struct ResultDirectory {
    path: PathBuf,
    kind: Kind,
    manifest: Manifest,
    lock: Option<Lock>,
    /// Files of the user's that are replaced because that was asked for.
    replaced: Vec<String>,
    notes: Vec<String>,
    /// Folders that were made for it, which vanish if nothing begins.
    made: Vec<PathBuf>,
}

impl ResultDirectory {
    /// Opens a directory (made if missing) for new results. Nothing in it changes before [`ResultDirectory::begin`].
    ///
    /// # Errors
    /// Somebody else writes there; files stand in the way; the operating system.
    pub fn open(path: &Path, kind: Kind, access: Access<'_>) -> io::Result<Self> {
        let made = make(path)?;
        let mut directory = Self::of(path, kind, Manifest::new(kind), made);
        if !access.is_locked {
            let (lock, note) = Lock::take(path)?;
            directory.lock = Some(lock);
            directory.notes.extend(note);
        }
        directory.survey(access)?;
        directory.refuse_links()?;
        Ok(directory)
    }

    /// Opens a directory (made if missing) to add to what is there.
    ///
    /// # Errors
    /// Somebody else writes there; the manifest is invalid; an error of the operating system.
    pub fn open_to_add(path: &Path, kind: Kind) -> io::Result<Self> {
        let made = make(path)?;
        let (lock, _) = Lock::take(path)?;
        let mut directory = Self::join(path, kind)?;
        (directory.lock, directory.made) = (Some(lock), made);
        Ok(directory)
    }

    /// Goes on with results that were begun, or adds to those of a finished run; the caller sees to it that nobody else
    /// writes there.
    ///
    /// # Errors
    /// The manifest cannot be read.
    pub fn join(path: &Path, kind: Kind) -> io::Result<Self> {
        let manifest = Manifest::read(path)?.unwrap_or_else(|| Manifest::new(kind));
        let directory = Self::of(path, kind, manifest, Vec::new());
        directory.refuse_links()?;
        Ok(directory)
    }

    fn of(path: &Path, kind: Kind, manifest: Manifest, made: Vec<PathBuf>) -> Self {
        Self { path: path.to_owned(), kind, manifest, lock: None, replaced: Vec::new(), notes: Vec::new(), made }
    }

    /// Takes over what another process, which had the directory from this one, noted in it.
    ///
    /// # Errors
    /// The manifest cannot be read.
    pub fn reread(&mut self) -> io::Result<()> {
        self.made.clear();
        self.manifest = Self::join(&self.path, self.kind)?.manifest.clone();
        Ok(())
    }

    /// Returns where it is.
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// Returns what the user should know.
    pub fn notes(&self) -> &[String] {
        &self.notes
    }

    /// Refuses folders of results that are links: what is replaced and removed there would lie elsewhere.
    fn refuse_links(&self) -> io::Result<()> {
        let is_link =
            |folder: &PathBuf| fs::symlink_metadata(self.path.join(folder)).is_ok_and(|entry| entry.is_symlink());
        match self.manifest.folders().iter().find(|folder| is_link(folder)) {
            None => Ok(()),
            Some(folder) => {
                let message = "is a link: results are replaced only where they lie in the result directory itself";
                Err(super::malformed(&self.path.join(folder), message))
            }
        }
    }

    /// Finds out what stands in the way.
    fn survey(&mut self, access: Access<'_>) -> io::Result<()> {
        let path = self.path.clone();
        let mut foreign = Vec::new();
        match Manifest::read(&path) {
            Ok(Some(manifest)) => self.manifest = manifest,
            Ok(None) => {}
            Err(error) if error.kind() == io::ErrorKind::InvalidData => foreign.push(MANIFEST.to_owned()),
            Err(error) => return Err(error),
        }
        let mut names = self.kind.present(&path);
        names.extend(self.manifest.present(&path));
        let owned = |name: &String| self.manifest.owns(name, &path);
        foreign.extend(names.iter().filter(|name| !owned(name)).cloned());
        names.extend(self.manifest.aside());
        let read: Vec<String> = names
            .into_iter()
            .filter(|name| access.inputs.iter().any(|input| is_same(&path.join(name), input)))
            .collect();
        if !read.is_empty() {
            return Err(io::Error::other(format!(
                "{}: the results would replace {} there, which is an input of the case: choose another --out",
                path.display(),
                listed(&read)
            )));
        }
        if !self.manifest.is_empty() && !self.manifest.kind.agrees_with(self.kind) && !access.overwrite {
            return Err(io::Error::other(format!(
                "{}: holds the results of {}: choose another --out, or replace them with --overwrite",
                path.display(),
                self.manifest.kind.words()
            )));
        }
        self.make_way(foreign, access.overwrite)
    }

    /// Notes files of the user's that are replaced, or refuses.
    fn make_way(&mut self, foreign: Vec<String>, overwrite: bool) -> io::Result<()> {
        if foreign.is_empty() {
            return Ok(());
        }
        let (path, listed) = (self.path.display(), listed(&foreign));
        if !overwrite {
            return Err(io::Error::other(format!(
                "{path}: {listed} would be replaced, but this program did not write it, or it was changed since: choose \
                 another --out, or replace it with --overwrite"
            )));
        }
        self.notes.push(format!("{path}: --overwrite replaces {listed}"));
        self.replaced = foreign;
        Ok(())
    }

    /// Sets earlier results aside, except those whose names match one of `kept`, and claims the names that the new ones need.
    ///
    /// # Errors
    /// A file that cannot be written or moved.
    pub fn begin(&mut self, kept: &[&str]) -> io::Result<()> {
        self.made.clear();
        let mut earlier = self.manifest.present(&self.path);
        earlier.extend(std::mem::take(&mut self.replaced));
        let is_kept = |name: &String| kept.iter().any(|pattern| names::fits(pattern, name));
        let earlier: Vec<String> = earlier.into_iter().filter(|name| !is_kept(name)).collect();
        // What was foreign is ours from here on, wherever a kill leaves it.
        self.manifest.claim(earlier.iter().map(String::as_str));
        self.manifest.claim(self.kind.claims().iter().copied());
        self.manifest.kind = self.kind;
        if !earlier.is_empty() {
            let aside = self.free_name();
            // A foreign manifest makes room for ours first.
            let (first, rest): (Vec<String>, Vec<String>) = earlier.into_iter().partition(|name| name == MANIFEST);
            self.manifest.set_aside(&aside, first.iter().chain(&rest));
            first.iter().try_for_each(|name| self.move_aside(name, &aside))?;
            self.manifest.write(&self.path)?;
            rest.iter().try_for_each(|name| self.move_aside(name, &aside))?;
        }
        self.manifest.forget_all_but(self.kind.claims());
        self.manifest.write(&self.path)
    }

    fn move_aside(&self, name: &str, aside: &str) -> io::Result<()> {
        let to = self.path.join(aside).join(name);
        let folder = to.parent().unwrap_or(&self.path);
        fs::create_dir_all(folder).map_err(at(folder))?;
        fs::rename(self.path.join(name), &to).map_err(at(&to))
    }

    /// A name for a folder of earlier results.
    fn free_name(&self) -> String {
        let candidates = std::iter::once(names::ASIDE.to_owned()).chain((2..).map(|k| format!("previous-{k}")));
        let is_free = |name: &String| fs::symlink_metadata(self.path.join(name)).is_err();
        candidates.into_iter().find(is_free).unwrap_or_default()
    }

    /// Writes a file: it appears under its name when it is complete.
    ///
    /// # Errors
    /// The file cannot be written.
    pub fn write(&mut self, name: &str, content: impl AsRef<[u8]>) -> io::Result<PathBuf> {
        // what has another name could not be read back as ours
        debug_assert!(cfg!(test) || names::is_of_results(name), "{name}");
        let path = self.path.join(name);
        if !self.manifest.is_claimed(name) {
            self.manifest.claim([name]);
            self.manifest.write(&self.path)?;
        }
        let folder = path.parent().unwrap_or(&self.path);
        fs::create_dir_all(folder).map_err(at(folder))?;
        write_whole(&path, content.as_ref())?;
        Ok(path)
    }

    /// Makes sure that files of these names may be added: none is there that the program did not write, or it is to be
    /// replaced, which is noted ([`Self::notes`]).
    ///
    /// # Errors
    /// Such a file exists and `overwrite` is false.
    pub fn admit<'n>(&mut self, names: impl IntoIterator<Item = &'n str>, overwrite: bool) -> io::Result<()> {
        let is_there = |name: &&str| fs::symlink_metadata(self.path.join(name)).is_ok();
        let names = names.into_iter().filter(is_there).filter(|name| !self.manifest.owns(name, &self.path));
        let foreign = names.map(str::to_owned).collect();
        self.make_way(foreign, overwrite)
    }

    /// Removes the earlier results: new ones stand.
    ///
    /// # Errors
    /// A file that cannot be removed.
    pub fn remove_earlier(&mut self) -> io::Result<()> {
        for name in self.manifest.aside() {
            let path = self.path.join(&name);
            match fs::remove_file(&path) {
                Err(error) if error.kind() != io::ErrorKind::NotFound => return Err(at(&path)(error)),
                _ => {}
            }
            // folders that are empty now
            for folder in Path::new(&name).ancestors().skip(1).filter(|folder| !folder.as_os_str().is_empty()) {
                let _ = fs::remove_dir(self.path.join(folder));
            }
        }
        self.manifest.forget_aside();
        self.manifest.write(&self.path)
    }

    /// Lists what was written with its content: what is changed from now on is the user's.
    ///
    /// # Errors
    /// A file that cannot be read, or the manifest not written.
    pub fn finish(&mut self) -> io::Result<()> {
        self.manifest.close(&self.path)?;
        self.manifest.write(&self.path)
    }
}

impl Drop for ResultDirectory {
    fn drop(&mut self) {
        self.lock = None;
        // Only empty folders can be removed; that nothing began is then all there is to say.
        for folder in self.made.iter().rev() {
            let _ = fs::remove_dir(folder);
        }
    }
}

/// Writes a file next to its final place and moves it there. If that fails, the partial file is removed.
pub(super) fn write_whole(path: &Path, content: &[u8]) -> io::Result<()> {
    let partial = path.with_file_name(PARTIAL);
    let write = || {
        // what a kill left there, or a link that leads elsewhere
        let _ = fs::remove_file(&partial);
        File::create_new(&partial)?.write_all(content)?;
        fs::rename(&partial, path)
    };
    let written = write();
    if written.is_err() {
        let _ = fs::remove_file(&partial);
    }
    written.map_err(at(path))
}

/// Makes a folder with its parents; the result is those that were missing, the outermost first.
fn make(path: &Path) -> io::Result<Vec<PathBuf>> {
    let missing: Vec<PathBuf> = path
        .ancestors()
        .take_while(|folder| !folder.as_os_str().is_empty() && !folder.exists())
        .map(Path::to_owned)
        .collect();
    refuse_file(path)?;
    fs::create_dir_all(path).map_err(at(path))?;
    Ok(missing.into_iter().rev().collect())
}

/// Refuses the path of a folder that is a file, or leads through one.
///
/// # Errors
/// That is so.
pub fn refuse_file(path: &Path) -> io::Result<()> {
    match path.ancestors().find(|folder| folder.exists() && !folder.is_dir()) {
        Some(file) => Err(super::malformed(file, "is no folder")),
        None => Ok(()),
    }
}

/// Returns whether two names are of one file.
fn is_same(one: &Path, other: &Path) -> bool {
    let identity = |path: &Path| fs::metadata(path).ok().map(|file| (file.dev(), file.ino()));
    identity(one).is_some_and(|one| identity(other) == Some(one))
}

fn listed(names: &[String]) -> String {
    let shown = names.iter().take(MOST_NAMES).cloned().collect::<Vec<_>>().join(", ");
    match names.len().saturating_sub(MOST_NAMES) {
        0 => shown,
        more => format!("{shown} and {more} more"),
    }
}
