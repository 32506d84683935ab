//! The utility routines that third-party UMATs call, in a library of their own (`umat-abi/utilities`).

use super::discovery::{Found, installed_paths};
use super::library::loaders_words;
use libloading::os::unix as os;
use std::path::{Path, PathBuf};
use std::sync::OnceLock;

/// Name of the library of the utility routines, as of a plugin.
pub const UTILITIES: &str = "pullout_utilities";
/// Symbol of the function that passes the job's name and folder to it.
const JOB_SYMBOL: &str = "pullout_utilities_job_v1";
type JobFunction = unsafe extern "C" fn(name: *const u8, name_length: usize, folder: *const u8, folder_length: usize);

/// Returns the library of the utility routines. It is searched only next to the plugins that were installed with the
/// program, as it is loaded into the program's process.
///
/// # Errors
/// A message that lists the folders searched.
pub fn utilities_path() -> Result<PathBuf, String> {
    let searched = installed_paths();
    Found::by_name(UTILITIES, &searched).map(|found| found.path).ok_or_else(|| {
        let folders: Vec<String> = searched.iter().map(|folder| folder.display().to_string()).collect();
        format!("the library {UTILITIES} with the utility routines is in none of {}", folders.join(", "))
    })
}

/// Loads the utility routines before the first plugin, for all that follow; stays loaded. Otherwise returns why SINV, ROTSIG, XIT
/// and the like are not available to plugins that call them.
pub(super) fn load() -> Result<&'static libloading::Library, &'static String> {
    static LIBRARY_OR_REASON: OnceLock<Result<libloading::Library, String>> = OnceLock::new();
    LIBRARY_OR_REASON
        .get_or_init(|| {
            let path = utilities_path()?;
            // RTLD_GLOBAL: what plugins leave undefined is found here
            // SAFETY: the library is our own and has no initialisers.
            let opened = unsafe { os::Library::open(Some(&path), os::RTLD_NOW | os::RTLD_GLOBAL) };
            opened.map(Into::into).map_err(|error| {
                format!("the library {UTILITIES} with the utility routines: {}", loaders_words(&path, &error))
            })
        })
        .as_ref()
}

/// Sets the answers of GETJOBNAME and GETOUTDIR from now on. Has no effect without the library of the utility routines.
pub fn announce_job(name: &str, folder: &Path) {
    let Ok(library) = load() else { return };
    let folder = folder.to_string_lossy();
    // SAFETY: the symbol, if there is one, is the function of that type in our own library; two texts and their
    // lengths.
    unsafe {
        if let Ok(function) = library.get::<JobFunction>(JOB_SYMBOL) {
            function(name.as_ptr(), name.len(), folder.as_ptr(), folder.len());
        }
    }
}
