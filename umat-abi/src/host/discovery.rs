//! Search for plugins in folders (docs/reference/abi.md).

use std::env;
use std::path::{Path, PathBuf};
use std::sync::OnceLock;

/// A plugin library on the search path.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Found {
    /// The name that case files use: the file name without `lib` and suffix.
    pub name: String,
    /// The file.
    pub path: PathBuf,
}

/// `lib<name>.so`, `lib<name>.dylib` or `<name>.dll`.
pub fn library_file_name(name: &str) -> String {
    format!("{}{name}{}", env::consts::DLL_PREFIX, env::consts::DLL_SUFFIX)
}

/// The name of a library that describes nothing: its file's, without `lib` and suffix.
pub fn library_name(library: &Path) -> String {
    let stem = library.file_stem().unwrap_or_default().to_string_lossy();
    stem.strip_prefix("lib").unwrap_or(&stem).to_owned()
}

/// Suffixes of sources in Fortran, C and C++, in small letters.
pub const SOURCES: [&str; 16] =
    ["f", "for", "ftn", "f77", "fpp", "f90", "f95", "f03", "f08", "f18", "c", "cpp", "cc", "cxx", "cp", "c++"];

/// Returns whether a file is a source by its suffix.
pub fn is_source(file: &Path) -> bool {
    let suffix = file.extension().unwrap_or_default().to_string_lossy().to_ascii_lowercase();
    SOURCES.contains(&&*suffix)
}

/// Returns whether a plugin is named by its file (a library's suffix or a source's, or a folder) rather than by its law.
pub fn names_a_file(plugin: &str) -> bool {
    const SUFFIXES: [&str; 3] = ["so", "dylib", "dll"];
    let path = Path::new(plugin);
    let is_library = path.extension().is_some_and(|suffix| SUFFIXES.iter().any(|known| suffix == *known));
    plugin.contains(['/', '\\']) || is_library || is_source(path)
}

/// A library's path, relative to a folder. Never a bare file name: the loader would take that for a name on its own
/// search path.
pub fn library_path(folder: &Path, file: &str) -> PathBuf {
    let path = folder.join(file);
    if path.is_absolute() || path.starts_with(".") { path } else { Path::new(".").join(path) }
}

/// The place of a file, links followed: a path may be spelled in several ways.
pub fn real_path(file: &Path) -> PathBuf {
    file.canonicalize().unwrap_or_else(|_| file.to_owned())
}

/// Returns the folders that are searched for plugins, in order: the given ones, `PULLOUT_PLUGIN_PATH`, and the
/// program's own. These are `deps/` next to the executable (or its folder if that is `deps/`), the executable's folder,
/// and `<prefix>/lib/pullout`. Folders that do not exist are listed as well.
pub fn search_paths(given: &[PathBuf]) -> Vec<PathBuf> {
    let mut paths = given.to_vec();
    if let Some(variable) = env::var_os("PULLOUT_PLUGIN_PATH") {
        paths.extend(env::split_paths(&variable).filter(|path| !path.as_os_str().is_empty()));
    }
    paths.extend(installed_paths());
    paths
}

/// See [`search_also`].
static BESIDES: OnceLock<PathBuf> = OnceLock::new();

/// Counts a folder, for good, among the program's own, as the last of them. The caller answers for the utility routines
/// there, which are loaded unasked.
pub fn search_also(folder: PathBuf) {
    let _ = BESIDES.set(folder);
}

/// See [`search_from_program`].
static PROGRAM: OnceLock<PathBuf> = OnceLock::new();

/// Takes a file for the executable whose installed folders are searched, instead of the present one's: for an interpreter
/// that has loaded the host as a module. Says so once, for good.
pub fn search_from_program(program: &Path) {
    let _ = PROGRAM.set(program.to_owned());
}

/// The folders in which a program finds what was installed with it.
pub fn installed_paths() -> Vec<PathBuf> {
    let mut paths = Vec::new();
    let program = PROGRAM.get().cloned().or_else(|| env::current_exe().ok());
    if let Some(folder) = program.as_deref().and_then(Path::parent) {
        if folder.file_name().is_some_and(|name| name == "deps") {
            paths.push(folder.to_path_buf());
        } else {
            paths.push(folder.join("deps"));
            paths.push(folder.to_path_buf());
        }
        if let Some(prefix) = folder.parent() {
            paths.push(prefix.join("lib").join("pullout"));
        }
    }
    paths.extend(BESIDES.get().cloned());
    paths
}

impl Found {
    /// Finds a plugin by name; the first folder that has it wins.
    pub fn by_name(name: &str, paths: &[PathBuf]) -> Option<Self> {
        let file = library_file_name(name);
        paths
            .iter()
            .map(|folder| folder.join(&file))
            .find(|path| path.is_file())
            .map(|path| Self { name: name.to_owned(), path })
    }

    /// Returns every library file in the folders, sorted by name; of several with the same name, the first found.
    pub fn all(paths: &[PathBuf]) -> Vec<Self> {
        let mut found: Vec<Self> = Vec::new();
        for folder in paths {
            for entry in std::fs::read_dir(folder).into_iter().flatten().flatten() {
                let path = entry.path();
                if let Some(name) = plugin_name(&path)
                    && !found.iter().any(|other| other.name == name)
                {
                    found.push(Self { name, path });
                }
            }
        }
        found.sort_by(|a, b| a.name.cmp(&b.name));
        found
    }
}

fn plugin_name(path: &Path) -> Option<String> {
    let file = path.file_name()?.to_str()?;
    let name = file.strip_prefix(env::consts::DLL_PREFIX)?.strip_suffix(env::consts::DLL_SUFFIX)?;
    (!name.is_empty() && path.is_file()).then(|| name.to_owned())
}
