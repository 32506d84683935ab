//! A loaded plugin library.

use super::description::Law;
use super::guard::Guard;
use super::{recorder, utilities};
use crate::floating_point;
use crate::fric::FricFunction;
use crate::metadata::{BATCH_SYMBOL, PLUGIN_SYMBOL, Plugin, UmatBatch};
use crate::uinter::UinterFunction;
use crate::umat::UmatFunction;
use std::fmt;
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// A shared library that can be loaded is no plugin, or no library.
#[derive(Clone, Debug)]
pub enum LoadError {
    /// The dynamic loader refused it.
    Open {
        /// The file.
        path: PathBuf,
        /// The loader's words.
        message: String,
    },
    /// It has none of the symbols tried.
    Symbol {
        /// The file.
        path: PathBuf,
        /// The symbols tried, in order.
        tried: Vec<String>,
    },
    /// Its metadata is of another version or inconsistent.
    Metadata {
        /// The file.
        path: PathBuf,
        /// What is wrong.
        message: String,
    },
}

impl fmt::Display for LoadError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Open { path, message } => write!(f, "{}: cannot be loaded: {message}", path.display()),
            Self::Symbol { path, tried } => {
                write!(f, "{}: has none of the symbols {}", path.display(), tried.join(", "))
            }
            Self::Metadata { path, message } => write!(f, "{}: {message}", path.display()),
        }
    }
}

impl std::error::Error for LoadError {}

/// A plugin library. Clones share the loaded library, which stays loaded as long as one lives.
#[derive(Clone)]
pub struct Library {
    path: PathBuf,
    laws: Arc<[Law]>,
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
    pub fn open(path: &Path) -> Result<Self, LoadError> {
        let utilities = utilities::load();
        let control = floating_point::control();
        let opened = recorder::loading(path, || open_locally(path));
        let changed = floating_point::modes(floating_point::control()) != floating_point::modes(control);
        floating_point::set_control(control);
        let handle = opened.map_err(|error| {
            let words = loaders_words(path, &error);
            // what is undefined may be one of the utility routines
            let unavailable = utilities.err().filter(|_| words.contains("undefined symbol"));
            let unavailable = unavailable.map_or_else(String::new, |reason| format!("; {reason}"));
            LoadError::Open { path: path.into(), message: words + &unavailable }
        })?;
        let metadata_error = |message| LoadError::Metadata { path: path.into(), message };
        // SAFETY: the symbol, if there is one, is the function that abi.md §2 defines.
        let laws = match unsafe { handle.get::<extern "C" fn() -> *const Plugin>(PLUGIN_SYMBOL) } {
            // SAFETY: the pointer comes from the library's own function.
            Ok(description) => unsafe { Law::read_all(description()) }.map_err(metadata_error)?,
            Err(_) => Vec::new(),
        };
        let guard = laws.is_empty().then(|| Guard::new(path));
        let handle = Arc::new(handle);
        if recorder::installed().is_some() {
            // What it does when it is unloaded it does at the worker's exit, behind the done-mark.
            std::mem::forget(Arc::clone(&handle));
        }
        Ok(Self { path: path.into(), laws: laws.into(), changes_floating_point: changed, guard, handle })
    }

    /// The file.
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// The laws that its metadata describes; none for a plain UMAT.
    pub fn laws(&self) -> &[Law] {
        &self.laws
    }

    /// What messages call the law that CMNAME chooses: its name, or the file's if the library describes none.
    pub(super) fn name_of_law(&self, cmname: &str) -> String {
        let wanted = cmname.trim().to_lowercase();
        let named = |law: &&Law| self.laws.len() == 1 || wanted.starts_with(&law.name.to_lowercase());
        let law = self.laws.iter().filter(named).max_by_key(|law| law.name.len());
        let stem = self.path.file_stem().map_or_else(String::new, |stem| stem.to_string_lossy().into_owned());
        law.map_or_else(|| stem.strip_prefix("lib").unwrap_or(&stem).to_owned(), |law| law.name.clone())
    }

    /// Whether loading it switched floating-point modes (flush-to-zero); they were restored.
    pub fn changes_floating_point(&self) -> bool {
        self.changes_floating_point
    }

    /// Whether a call so far switched floating-point modes; they were restored behind it. Not looked for where metadata
    /// vouch for the library.
    pub fn calls_change_floating_point(&self) -> bool {
        self.guard.as_ref().is_some_and(Guard::changed_modes)
    }

    /// The same library, without metadata but known to be thread-safe: calls do not wait for each other.
    #[must_use]
    pub fn thread_safe(mut self) -> Self {
        self.guard = self.guard.map(|guard| guard.of_thread_safe());
        self
    }

    /// How it is called; `None`: its metadata vouch for it.
    pub(super) fn guard(&self) -> Option<Guard> {
        self.guard.clone()
    }

    /// The UMAT entry point: `symbol` if given, else the usual spellings.
    ///
    /// # Errors
    /// [`LoadError::Symbol`].
    pub fn umat(&self, symbol: Option<&str>) -> Result<UmatFunction, LoadError> {
        // SAFETY: a function of this name in a UMAT library has the UMAT signature; no check is possible.
        unsafe { self.entry("umat", symbol) }
    }

    /// The function for many points, if the library has one: only libraries that describe a law can.
    pub(super) fn batch(&self) -> Option<UmatBatch> {
        if self.laws.len() != 1 {
            return None;
        }
        // SAFETY: the symbol, if there is one, is the function that the contract defines; callers keep the library.
        unsafe { self.handle.get::<UmatBatch>(BATCH_SYMBOL) }.ok().map(|function| *function)
    }

    /// The same library, known to keep floating-point modes and to be thread-safe as one with metadata is: nothing is made
    /// sure of in calls.
    #[must_use]
    pub fn vouched_for(mut self) -> Self {
        self.guard = None;
        self
    }

    /// The UINTER entry point.
    ///
    /// # Errors
    /// [`LoadError::Symbol`].
    pub fn uinter(&self, symbol: Option<&str>) -> Result<UinterFunction, LoadError> {
        // SAFETY: as for `umat`.
        unsafe { self.entry("uinter", symbol) }
    }

    /// The FRIC entry point.
    ///
    /// # Errors
    /// [`LoadError::Symbol`].
    pub fn fric(&self, symbol: Option<&str>) -> Result<FricFunction, LoadError> {
        // SAFETY: as for `umat`.
        unsafe { self.entry("fric", symbol) }
    }

    /// `name_`, `name`, `NAME`, `<libname>_`, in this order (abi.md §4).
    ///
    /// # Safety
    /// `F` is the type of the function with that name.
    unsafe fn entry<F: Copy>(&self, name: &str, symbol: Option<&str>) -> Result<F, LoadError> {
        let tried = match symbol {
            Some(symbol) => vec![symbol.to_owned()],
            None => {
                let stem = self.path.file_stem().map_or_else(String::new, |s| s.to_string_lossy().into_owned());
                let library = stem.strip_prefix("lib").unwrap_or(&stem).to_owned();
                spellings(name).into_iter().chain([format!("{library}_")]).collect()
            }
        };
        for symbol in &tried {
            // SAFETY: forwarded to the caller; the function outlives its use because callers keep the library.
            if let Ok(function) = unsafe { self.handle.get::<F>(symbol.as_str()) } {
                return Ok(*function);
            }
        }
        Err(LoadError::Symbol { path: self.path.clone(), tried })
    }

    /// Which of UMAT, UINTER and FRIC it has, under any of their usual names. One that is called like the library may be
    /// any of them.
    pub fn entry_points(&self) -> Vec<&'static str> {
        let has = |name: &&str| spellings(name).iter().any(|symbol| self.umat(Some(symbol)).is_ok());
        let mut found: Vec<&'static str> = ["umat", "uinter", "fric"].into_iter().filter(has).collect();
        if found.is_empty() && self.umat(None).is_ok() {
            found.push("one called like the library");
        }
        found
    }

    /// A routine under one of its usual spellings.
    ///
    /// # Safety
    /// `F` is the type of the function with that name; it is not used after the library.
    pub(super) unsafe fn find<F: Copy>(&self, name: &str) -> Option<F> {
        // SAFETY: forwarded to the caller.
        spellings(name).iter().find_map(|symbol| unsafe { self.handle.get::<F>(symbol.as_str()) }.ok().map(|f| *f))
    }
}

/// Why the loader refused a file; without the file's name, which the reader knows.
pub(super) fn loaders_words(path: &Path, error: &libloading::Error) -> String {
    // the error itself only tells which call failed
    let words = std::error::Error::source(error).map_or_else(|| error.to_string(), ToString::to_string);
    words.strip_prefix(&format!("{}: ", path.display())).map_or_else(|| words.clone(), str::to_owned)
}

/// As gfortran, C and upper-casing compilers spell a routine.
fn spellings(name: &str) -> [String; 3] {
    [format!("{name}_"), name.to_owned(), name.to_ascii_uppercase()]
}

/// RTLD_NOW | RTLD_LOCAL | RTLD_DEEPBIND: two plugins that define the same helper or COMMON block must not run
/// each other's code, and a plugin's own `sinv_` must win over anybody's.
#[cfg(target_os = "linux")]
fn open_locally(path: &Path) -> Result<libloading::Library, libloading::Error> {
    use libloading::os::unix::{Library, RTLD_LOCAL, RTLD_NOW};
    /// `<dlfcn.h>` of glibc on Linux.
    const RTLD_DEEPBIND: i32 = if cfg!(target_env = "gnu") { 8 } else { 0 };
    // SAFETY: loading runs the library's initialisers: that is what loading a plugin means.
    unsafe { Library::open(Some(path), RTLD_NOW | RTLD_LOCAL | RTLD_DEEPBIND) }.map(Into::into)
}

#[cfg(not(target_os = "linux"))]
fn open_locally(path: &Path) -> Result<libloading::Library, libloading::Error> {
    // SAFETY: loading runs the library's initialisers: that is what loading a plugin means.
    unsafe { libloading::Library::new(path) }
}
