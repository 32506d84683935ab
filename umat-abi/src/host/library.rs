//! A loaded plugin library.

use super::description::LawDescription;
use super::discovery::library_name;
use super::guard::{Guard, WrittenInput};
use super::{prints, recorder, utilities};
use crate::batch::UmatBatch;
use crate::floating_point;
use crate::fric::FricFunction;
use crate::metadata::{BATCH_SYMBOL, PLUGIN_SYMBOL, Plugin};
use crate::uinter::UinterFunction;
use crate::umat::UmatFunction;
use libloading::os::unix as os;
use std::collections::BTreeMap;
use std::ffi::{CStr, OsStr, c_void};
use std::fmt;
use std::io;
use std::os::unix::fs::MetadataExt;
use std::path::{Path, PathBuf};
use std::sync::{Arc, Mutex, PoisonError, Weak};

/// Symbol that `plugin build --debug` puts into a library.
const DEBUG_SYMBOL: &str = "pullout_debug_v1";

/// Message why a file cannot be loaded as a library, or lacks what is called.
#[derive(Clone, Debug, thiserror::Error)]
#[error("{0}")]
pub struct LoadError(String);

impl LoadError {
    /// The dynamic loader, or the host in its place, refuses a file.
    pub fn refused(path: &Path, message: &str) -> Self {
        Self(format!("{}: cannot be loaded: {message}", path.display()))
    }
}

/// Device and inode, length, time of the last change in ns of a file: where they are the same, so is the content.
pub type Stamp = [i128; 4];

/// Reads the stamp of a file.
///
/// # Errors
/// The system's refusal.
pub fn stamp(file: &Path) -> io::Result<Stamp> {
    let file = file.metadata()?;
    let changed = i128::from(file.ctime()) * 1_000_000_000 + i128::from(file.ctime_nsec());
    Ok([file.dev().into(), file.ino().into(), file.len().into(), changed])
}

/// A library that is loaded, with its file and what that held then.
type Loaded = (PathBuf, Stamp, Weak<libloading::Library>);

static LOADED: Mutex<Vec<Loaded>> = Mutex::new(Vec::new());

/// Calls a function with each library that is still loaded.
pub(super) fn each_loaded(act: impl FnMut(Arc<libloading::Library>)) {
    let loaded = LOADED.lock().unwrap_or_else(PoisonError::into_inner);
    let libraries: Vec<_> = loaded.iter().filter_map(|(.., library)| library.upgrade()).collect();
    // unloading takes the lock of the loader, which may wait for this one
    drop(loaded);
    libraries.into_iter().for_each(act);
}

/// A user subroutine that a library may have in addition to UMAT, UINTER and FRIC.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Routine {
    /// Plain symbol.
    pub symbol: &'static str,
    /// Whether the host calls it.
    pub is_called: bool,
}

impl Routine {
    /// Returns its name as ABAQUS's manual has it.
    pub fn name(&self) -> String {
        self.symbol.to_uppercase()
    }

    /// Routines that libraries of UMATs usually have, and those of ABAQUS that no program of points and specimens calls: a law
    /// may rest on what they do.
    pub const ALL: [Self; 30] = {
        const fn called(symbol: &'static str) -> Routine {
            Routine { symbol, is_called: true }
        }
        const fn left_out(symbol: &'static str) -> Routine {
            Routine { symbol, is_called: false }
        }
        [
            called("uexternaldb"),
            called("sdvini"),
            called("sigini"),
            called("hetval"),
            called("umatht"),
            left_out("uvarm"),
            left_out("usdfld"),
            left_out("uel"),
            left_out("uelmat"),
            left_out("uhard"),
            left_out("uhyper"),
            left_out("uhypel"),
            left_out("umullins"),
            left_out("uanisohyper_inv"),
            left_out("uanisohyper_strain"),
            left_out("utrs"),
            left_out("creep"),
            left_out("uexpan"),
            left_out("ufield"),
            left_out("utemp"),
            left_out("uamp"),
            left_out("urdfil"),
            left_out("dload"),
            left_out("dflux"),
            left_out("vumat"),
            left_out("vuel"),
            left_out("vuinter"),
            left_out("vusdfld"),
            left_out("vuhard"),
            left_out("vuamp"),
        ]
    };
}

/// A plugin library. Clones share the loaded library, which stays loaded as long as one lives.
#[derive(Clone)]
pub struct Library {
    path: PathBuf,
    laws: Arc<[LawDescription]>,
    routines: Arc<[Routine]>,
    changes_floating_point: bool,
    guard: Option<Guard>,
    handle: Arc<libloading::Library>,
}

impl fmt::Debug for Library {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Library").field("path", &self.path).finish_non_exhaustive()
    }
}

impl Library {
    /// Loads a library and reads its metadata if it has any; before the first, the utility routines that it may call.
    ///
    /// # Errors
    /// The loader's refusal, or metadata that this program cannot read.
    ///
    /// # Safety
    /// The library's initialisers, and later its entry points, run in this process with all that it may do: either
    /// somebody vouches for them, or the process exists for this library alone and may end with it. What it exports
    /// as `umat_`, `uinter_`, `fric_`, `sdvini_`, `uexternaldb_`, `hetval_`, `umatht_` or under a symbol that is asked for has that
    /// signature, and writes no further than its counts allow.
    pub unsafe fn open(path: &Path) -> Result<Self, LoadError> {
        let stamp = stamp(path).ok();
        if stamp.is_some_and(|stamp| is_loaded_otherwise(path, stamp)) {
            // the loader goes by the name and would give what it has
            let message = "the file was changed since this process loaded it, and what it held then is still in use";
            return Err(LoadError::refused(path, message));
        }
        let utilities = utilities::load();
        let control = floating_point::control();
        // SAFETY: the caller vouches for what loading it runs.
        let opened = recorder::loading(path, || unsafe { open_locally(path) });
        let changed = floating_point::modes(floating_point::control()) != floating_point::modes(control);
        floating_point::set_control(control);
        let handle = opened.map_err(|error| {
            let words = loaders_words(path, &error);
            // what is undefined may be one of the utility routines
            let unavailable = utilities.err().filter(|_| words.contains("undefined symbol"));
            let unavailable = unavailable.map_or_else(String::new, |reason| format!("; {reason}"));
            LoadError::refused(path, &(words + &unavailable))
        })?;
        let metadata_error = |message| LoadError(format!("{}: {message}", path.display()));
        let handle = Arc::new(handle);
        let mut library = Self {
            path: path.into(),
            laws: Arc::default(),
            routines: Arc::default(),
            changes_floating_point: changed,
            guard: None,
            handle,
        };
        // SAFETY: the symbol, if there is one, is the function that the contract defines.
        if let Some(description) = unsafe { library.own_symbol::<extern "C" fn() -> *const Plugin>(PLUGIN_SYMBOL) } {
            // SAFETY: the pointer comes from the library's own function; each law keeps the library.
            let laws = unsafe { LawDescription::read_all(description(), &library.handle) };
            library.laws = laws.map_err(metadata_error)?.into();
        }
        if let Some(stamp) = stamp {
            let mut loaded = LOADED.lock().unwrap_or_else(PoisonError::into_inner);
            loaded.retain(|(.., library)| library.strong_count() > 0);
            loaded.push((path.into(), stamp, Arc::downgrade(&library.handle)));
        }
        prints::note_loaded(&library.handle);
        // SAFETY: the symbol is only looked for.
        let is_debug = unsafe { library.own_symbol::<*const c_void>(DEBUG_SYMBOL) }.is_some();
        let is_isolated = recorder::installed().is_some();
        library.guard = if library.laws.is_empty() {
            Some(Guard::new(path, is_debug))
        } else {
            // isolated with its metadata: nobody vouches for more than what they say
            is_isolated.then(Guard::default)
        };
        if is_isolated {
            // What it does when unloaded, it does at the worker's exit, after the done-mark.
            std::mem::forget(Arc::clone(&library.handle));
        }
        // SAFETY: only their presence is asked for.
        let has = |routine: &Routine| unsafe { library.find::<*const ()>(routine.symbol) }.is_some();
        library.routines = Routine::ALL.into_iter().filter(has).collect();
        Ok(library)
    }

    /// Returns whether calls trap invalid operations, because the library is made to be debugged.
    pub fn traps(&self) -> bool {
        self.guard.as_ref().is_some_and(Guard::traps)
    }

    /// The file.
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// The laws that its metadata describes; none for a plain UMAT.
    pub fn laws(&self) -> &[LawDescription] {
        &self.laws
    }

    /// Returns the name in messages of the law that CMNAME chooses: its own, or the file's if the library describes none.
    pub(super) fn name_of_law(&self, cmname: &str) -> String {
        let law = match &*self.laws {
            [law] => Some(law),
            laws => LawDescription::named(laws, cmname),
        };
        law.map_or_else(|| library_name(&self.path), |law| law.name.clone())
    }

    /// Returns whether loading it switched floating-point modes (flush-to-zero); they were restored.
    pub fn changes_floating_point(&self) -> bool {
        self.changes_floating_point
    }

    /// Returns the inputs that calls so far wrote into, each with the first call that did. The changes were lost with the calls. Not looked for where somebody vouches for the library, but if it is [`Self::watched`].
    pub fn written_inputs(&self) -> BTreeMap<&'static str, WrittenInput> {
        self.guard.as_ref().map(Guard::written).unwrap_or_default()
    }

    /// Returns the same library for calls that get copies of their inputs even where somebody vouches for it. Its
    /// [`Self::written_inputs`] are those of calls prepared from now on, with what this returns.
    #[must_use]
    pub fn watched(mut self) -> Self {
        self.guard = Some(self.guard.as_ref().map_or_else(Guard::default, Guard::afresh));
        self
    }

    /// Returns whether a call so far switched floating-point modes; they were restored after it. This is not checked
    /// where metadata vouch for the library.
    pub fn calls_change_floating_point(&self) -> bool {
        self.guard.as_ref().is_some_and(Guard::changed_modes)
    }

    /// Returns the same library, without metadata but known to be thread-safe: calls do not wait for each other.
    ///
    /// # Safety
    /// The entry points may run in several threads at once.
    #[must_use]
    pub unsafe fn thread_safe(mut self) -> Self {
        self.guard = self.guard.map(|guard| guard.of_thread_safe());
        self
    }

    /// Returns whether several threads may call it at once, as far as it or its user says.
    pub fn is_thread_safe(&self) -> bool {
        self.guard.as_ref().is_none_or(Guard::is_of_thread_safe)
    }

    /// Returns how it is called; `None`: its metadata vouch for it.
    pub(super) fn guard(&self) -> Option<Guard> {
        self.guard.clone()
    }

    /// The UMAT entry point: `symbol` if given, else the usual spellings.
    ///
    /// # Errors
    /// There is none, or the symbol is not called like an entry point.
    pub fn umat(&self, symbol: Option<&str>) -> Result<UmatFunction, LoadError> {
        // SAFETY: a function of this name in a UMAT library has the UMAT signature; no check is possible.
        unsafe { self.entry("umat", symbol) }
    }

    /// The function for many points, if the library has one: only libraries that describe a law can.
    pub fn batch(&self) -> Option<UmatBatch> {
        if self.laws.len() != 1 {
            return None;
        }
        // SAFETY: the symbol, if there is one, is the function that the contract defines; callers keep the library.
        unsafe { self.own_symbol(BATCH_SYMBOL) }
    }

    /// Returns the same library, known to keep floating-point modes and to be thread-safe as one with metadata is: nothing
    /// is made sure of in calls.
    ///
    /// # Safety
    /// The entry points may run in several threads at once, and leave floating-point modes as they found them.
    #[must_use]
    pub unsafe fn vouched_for(mut self) -> Self {
        self.guard = None;
        self
    }

    /// The UINTER entry point.
    ///
    /// # Errors
    /// As [`Self::umat`].
    pub fn uinter(&self, symbol: Option<&str>) -> Result<UinterFunction, LoadError> {
        // SAFETY: as for `umat`.
        unsafe { self.entry("uinter", symbol) }
    }

    /// The FRIC entry point.
    ///
    /// # Errors
    /// As [`Self::umat`].
    pub fn fric(&self, symbol: Option<&str>) -> Result<FricFunction, LoadError> {
        // SAFETY: as for `umat`.
        unsafe { self.entry("fric", symbol) }
    }

    /// Finds `symbol`, or else `name_`, `name`, `NAME`, `<libname>_`, in this order.
    ///
    /// # Safety
    /// `F` is the type of the function with that name.
    unsafe fn entry<F: Copy>(&self, name: &str, symbol: Option<&str>) -> Result<F, LoadError> {
        let like_the_library = format!("{}_", library_name(&self.path));
        let tried = match symbol {
            Some(symbol) => {
                let words = symbol.to_ascii_lowercase();
                let is_entry_point = ["umat", "uinter", "fric"].iter().any(|entry| words.contains(entry));
                if !is_entry_point && symbol != like_the_library {
                    return Err(LoadError(format!(
                        "'{symbol}' is not the name of an entry point: that contains umat, uinter or fric in lower or upper \
                         case, or is the library's own name with an underscore"
                    )));
                }
                vec![symbol.to_owned()]
            }
            None => spellings(name).into_iter().chain([like_the_library]).collect(),
        };
        // SAFETY: forwarded to the caller; the function outlives its use because callers keep the library.
        let found = tried.iter().find_map(|symbol| unsafe { self.own_symbol(symbol) });
        // what other libraries that it loads define does not count
        found.ok_or_else(|| LoadError(format!("{}: has none of the symbols {}", self.path.display(), tried.join(", "))))
    }

    /// Returns which of UMAT, UINTER and FRIC it has, under any of their usual names. One that is called like the library may be
    /// any of them.
    pub fn entry_points(&self) -> Vec<&'static str> {
        let has = |name: &&str| spellings(name).iter().any(|symbol| self.umat(Some(symbol)).is_ok());
        let mut found: Vec<&'static str> = ["umat", "uinter", "fric"].into_iter().filter(has).collect();
        if found.is_empty() && self.umat(None).is_ok() {
            found.push("one called like the library");
        }
        found
    }

    /// Returns which of the routines around the laws it has.
    pub fn routines(&self) -> &[Routine] {
        &self.routines
    }

    /// Finds a routine that the library itself defines, under one of its usual spellings.
    ///
    /// # Safety
    /// `F` is the type of the function with that name; it is not used after the library.
    pub(super) unsafe fn find<F: Copy>(&self, name: &str) -> Option<F> {
        // SAFETY: forwarded to the caller.
        spellings(name).iter().find_map(|symbol| unsafe { self.own_symbol(symbol) })
    }

    /// Finds a function that the library itself defines. The loader also searches the libraries that it depends on, where
    /// `system` and anything else is: those do not count.
    ///
    /// # Safety
    /// As of [`Self::find`].
    unsafe fn own_symbol<F: Copy>(&self, symbol: &str) -> Option<F> {
        // SAFETY: forwarded to the caller.
        let function = unsafe { self.handle.get::<F>(symbol) }.ok()?;
        // SAFETY: a function is as large as an address.
        let address = unsafe { self.handle.get::<*const c_void>(symbol) }.ok()?;
        is_own(&self.path, *address).then(|| *function)
    }
}

/// Returns whether a library that was loaded from this path, or this file, had another content than the file has now.
fn is_loaded_otherwise(path: &Path, now: Stamp) -> bool {
    let loaded = LOADED.lock().unwrap_or_else(PoisonError::into_inner);
    let is_same_file = |other: &Path, then: &Stamp| other == path || then[..2] == now[..2];
    loaded.iter().any(|(other, then, library)| *then != now && is_same_file(other, then) && library.strong_count() > 0)
}

/// Returns whether an address that the loader found lies in the library of this path.
fn is_own(path: &Path, address: *const c_void) -> bool {
    // a library that was loaded before has the name that it had then
    let file = |path: &Path| path.metadata().ok().map(|data| (data.dev(), data.ino()));
    owner_of(address).is_some_and(|owner| owner == path || file(&owner).is_some_and(|owner| file(path) == Some(owner)))
}

/// The file of the library that an address lies in, as the loader names it.
fn owner_of(address: *const c_void) -> Option<PathBuf> {
    use std::os::unix::ffi::OsStrExt;
    let mut place = std::mem::MaybeUninit::<libc::Dl_info>::uninit();
    // SAFETY: `dladdr` reads no memory at the address, and fills the place if it returns another value than 0.
    let name = unsafe {
        if libc::dladdr(address, place.as_mut_ptr()) == 0 || (*place.as_ptr()).dli_fname.is_null() {
            return None;
        }
        CStr::from_ptr((*place.as_ptr()).dli_fname)
    };
    Some(PathBuf::from(OsStr::from_bytes(name.to_bytes())))
}

/// Returns why the loader refused a file; without the file's name, which the reader knows.
pub(super) fn loaders_words(path: &Path, error: &libloading::Error) -> String {
    // the error itself only names the call that failed
    let words = std::error::Error::source(error).map_or_else(|| error.to_string(), ToString::to_string);
    words.strip_prefix(&format!("{}: ", path.display())).map_or_else(|| words.clone(), str::to_owned)
}

/// Returns the names of a routine as gfortran, C and upper-casing compilers spell it.
fn spellings(name: &str) -> [String; 3] {
    [format!("{name}_"), name.to_owned(), name.to_ascii_uppercase()]
}

/// Opens a library with RTLD_NOW | RTLD_LOCAL | RTLD_DEEPBIND: two plugins that define the same helper or COMMON block
/// must not run each other's code, and a plugin's own `sinv_` must win over anybody's.
///
/// # Safety
/// As of [`Library::open`].
unsafe fn open_locally(path: &Path) -> Result<libloading::Library, libloading::Error> {
    #[cfg(target_os = "linux")]
    let deep = if binds_deeply() { libc::RTLD_DEEPBIND } else { 0 };
    #[cfg(not(target_os = "linux"))]
    let deep = 0;
    // SAFETY: forwarded to the caller.
    unsafe { os::Library::open(Some(path), os::RTLD_NOW | os::RTLD_LOCAL | deep) }.map(Into::into)
}

/// Returns whether plugins are bound to their own symbols first. Not where `malloc` is another library's than the C
/// library's (`LD_PRELOAD` of jemalloc or tcmalloc): a plugin bound deeply would take memory from the one and have it
/// freed by the other.
#[cfg(all(target_os = "linux", target_env = "gnu"))]
pub fn binds_deeply() -> bool {
    // asked of each library: the search among all of the C library's symbols is a tenth of a short run
    static ANSWER: std::sync::LazyLock<bool> = std::sync::LazyLock::new(|| {
        let c_library = libc::gnu_get_libc_version as *const c_void;
        // SAFETY: a name that ends with NUL, looked up among the libraries that the process started with.
        let malloc = unsafe { libc::dlsym(libc::RTLD_DEFAULT, c"malloc".as_ptr()) };
        owner_of(malloc) == owner_of(c_library)
    });
    *ANSWER
}

/// Returns whether plugins are bound to their own symbols first: the loader cannot.
#[cfg(not(all(target_os = "linux", target_env = "gnu")))]
pub fn binds_deeply() -> bool {
    false
}
