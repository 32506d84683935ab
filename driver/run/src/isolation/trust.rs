//! Choice of the libraries that may run in this process: loading a library already runs its initialisers.

use super::{system, worker};
use crate::input::{self, Input};
use std::collections::{BTreeMap, BTreeSet, btree_map::Entry};
use std::env;
use std::fs::{self, Metadata};
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Mutex, PoisonError};
use umat_abi::host::{self, Library, LoadError};

/// Length and SHA-256 of the plugins and the utility routines that were built with this program. It stands in the program itself: neither a case
/// nor a folder of plugins can add to it. A plugin that was built again without the program no longer fits.
static SHIPPED: &[(u64, [u8; 32])] = shipped::manifest!();

/// Whether every library may run in this process.
static ALL_ARE_LET_IN: AtomicBool = AtomicBool::new(false);

/// Lets every library run in this process: the user has said so on the command line.
pub fn let_all_in() {
    ALL_ARE_LET_IN.store(true, Ordering::Relaxed);
}

/// Returns whether the user has said so.
pub fn all_are_let_in() -> bool {
    ALL_ARE_LET_IN.load(Ordering::Relaxed)
}

/// The files of [`let_in`].
static LET_IN: Mutex<BTreeSet<PathBuf>> = Mutex::new(BTreeSet::new());

/// Lets a library run in this process from now on: the user answers for it.
pub fn let_in(library: &Path) {
    LET_IN.lock().unwrap_or_else(PoisonError::into_inner).insert(host::real_path(library));
}

/// Returns whether the user answers for a library.
pub(super) fn is_let_in(library: &Path) -> bool {
    all_are_let_in() || LET_IN.lock().unwrap_or_else(PoisonError::into_inner).contains(&host::real_path(library))
}

/// Returns whether a library was built with this program.
pub fn is_shipped(library: &Path) -> bool {
    shipped(library).is_some()
}

/// The SHA-256 of a library that was built with this program.
fn shipped(library: &Path) -> Option<[u8; 32]> {
    // the length spares reading files that are large, or none
    let length = fs::metadata(library).ok().filter(Metadata::is_file)?.len();
    SHIPPED.iter().find(|(other, _)| *other == length)?;
    let hash = input::hash(library, Input::Library).ok()?;
    SHIPPED.iter().any(|(_, other)| *other == hash).then_some(hash)
}

/// Finds the laws where Cargo has built them where none were installed with this program, as by `cargo install`. The folder
/// counts if the utility routines there are those that were built with this program; each law is judged when it is loaded.
pub fn look_where_it_was_built() {
    if host::utilities_path().is_ok() {
        return;
    }
    let name = host::library_file_name(host::UTILITIES);
    let built = env::split_paths(env!("PULLOUT_SHIPPED_PLUGINS")).find(|library| library.ends_with(&name));
    if let Some(utilities) = built
        && is_shipped(&utilities)
        && let Some(folder) = utilities.parent()
    {
        host::search_also(folder.to_path_buf());
    }
}

/// Returns whether a library may be loaded into this process.
pub fn may_run_here(library: &Path) -> bool {
    !system::IS_SUPPORTED || is_let_in(library) || worker::is_this_process() || is_shipped(library)
}

/// Loads a library into this process. One that was built with this program stays loaded: to load it again takes as long as
/// fifty increments of a point.
///
/// # Errors
/// As of [`Library::open`]; a library that may not run here.
pub fn load(library: &Path) -> Result<Library, LoadError> {
    static KEPT: Mutex<BTreeMap<PathBuf, ([u8; 32], Library)>> = Mutex::new(BTreeMap::new());
    let kept = || KEPT.lock().unwrap_or_else(PoisonError::into_inner);
    let hash = shipped(library);
    match kept().entry(library.to_path_buf()) {
        Entry::Occupied(of_path) if Some(of_path.get().0) == hash => return Ok(of_path.get().1.clone()),
        Entry::Occupied(of_another_file) => drop(of_another_file.remove()),
        Entry::Vacant(_) => {}
    }
    // unit tests read cases with libraries of all kinds, as workers do
    if !cfg!(test) && !may_run_here(library) {
        return Err(LoadError::refused(library, "it runs in a process of its own only, or with --in-process"));
    }
    // SAFETY: the library was built with this program, or the user (or a test) answers for it, or this process is a worker,
    // which is there to be ended by it.
    let loaded = unsafe { Library::open(library) }?;
    kept().extend(hash.map(|hash| (library.to_path_buf(), (hash, loaded.clone()))));
    Ok(loaded)
}
