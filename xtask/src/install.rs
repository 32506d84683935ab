//! Destinations of files under the prefix.

use crate::build::{ALL_LAWS, Products};
use crate::licences;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};

/// The name under which ABAQUS/Standard finds user subroutines in `usub_lib_dir`.
const ABAQUS_LIBRARY: &str = "libstandardU.so";

/// Suffix of the libraries for Kratos where Cargo builds them. Where they are installed, they have a folder of their own.
const KRATOS_SUFFIX: &str = "_kratos";

/// Command by which the program writes its manual pages and completions below `share`.
const PAGES: &str = "pages";

/// Files for the programs of others, with the version filled in at `@VERSION@`.
const TEMPLATES: [(&str, &str); 3] = [
    ("lib/pkgconfig/pullout.pc", include_str!("../templates/pullout.pc")),
    ("lib/cmake/pullout/pullout-config.cmake", include_str!("../templates/pullout-config.cmake")),
    ("lib/cmake/pullout/pullout-config-version.cmake", include_str!("../templates/pullout-config-version.cmake")),
];

/// Files that are copied as they are, from the workspace.
const SOURCES: [(&str, &str); 4] = [
    ("include/pullout_umat.h", "umat-abi/include/pullout_umat.h"),
    ("include/pullout_umat.f90", "umat-abi/fortran/pullout_umat.f90"),
    ("share/doc/pullout/LICENSE-MIT", "LICENSE-MIT"),
    ("share/doc/pullout/LICENSE-APACHE", "LICENSE-APACHE"),
];

/// Folder for the cases of the workspace: `pullout examples` searches it.
const CASES: &str = "share/pullout/cases";

/// Third-party licences, and the list of third-party packages.
const LICENCES: &str = "share/doc/pullout/THIRD-PARTY.txt";
const BILL: &str = "share/doc/pullout/pullout.cdx.json";

/// Installs everything under the prefix. Returns the files in the order in which they were written.
///
/// # Errors
/// A message with the file.
pub fn install(workspace: &Path, products: &Products, prefix: &Path) -> Result<Vec<PathBuf>, String> {
    let program = prefix.join("bin").join(name(&products.program)?);
    copy(&products.program, &program)?;
    let mut files = vec![program];
    files.extend(all_but_the_program(workspace, products, prefix)?);
    let mut put = |from: &Path, to: PathBuf| copy(from, &to).map(|()| files.push(to));
    // the laws once more as ABAQUS and Kratos want them
    let plugins = plugins(prefix);
    let all_laws = format!("{}{ALL_LAWS}{}", std::env::consts::DLL_PREFIX, std::env::consts::DLL_SUFFIX);
    let all_laws = products.libraries.iter().find(|library| library.ends_with(&all_laws));
    let all_laws = all_laws.ok_or_else(|| format!("the build made no {ALL_LAWS}"))?;
    put(all_laws, plugins.join("abaqus").join(ABAQUS_LIBRARY))?;
    for library in &products.kratos {
        let law = name(library)?.to_string_lossy().replace(KRATOS_SUFFIX, "");
        put(library, plugins.join("kratos").join(law))?;
    }
    files.extend(pages(Command::new(&products.program), &prefix.join("share"))?);
    Ok(files)
}

/// Returns the folder for laws.
fn plugins(prefix: &Path) -> PathBuf {
    prefix.join("lib").join("pullout")
}

/// Installs the parts of every installation under the prefix: laws, headers, licences. Returns the files.
///
/// # Errors
/// As of [`install`].
pub fn all_but_the_program(workspace: &Path, products: &Products, prefix: &Path) -> Result<Vec<PathBuf>, String> {
    let mut files = Vec::new();
    let mut put = |from: &Path, to: PathBuf| copy(from, &to).map(|()| files.push(to));
    for library in &products.libraries {
        put(library, plugins(prefix).join(name(library)?))?;
    }
    for (to, from) in SOURCES {
        put(&workspace.join(from), prefix.join(to))?;
    }
    let cases = workspace.join("cases");
    let found = files_below(&cases).map_err(|error| format!("{}: {error}", cases.display()))?;
    for from in found {
        let to = prefix.join(CASES).join(from.strip_prefix(&cases).map_err(|error| error.to_string())?);
        put(&from, to)?;
    }
    let version = env!("CARGO_PKG_VERSION");
    let others = licences::packages(workspace)?;
    let made = [(LICENCES, licences::collected(&others)), (BILL, licences::bill(&others, version))];
    let filled = TEMPLATES.map(|(to, text)| (to, text.replace("@VERSION@", version)));
    for (to, text) in made.into_iter().chain(filled) {
        let to = prefix.join(to);
        write(&to, |unfinished| fs::write(unfinished, &text))?;
        files.push(to);
    }
    Ok(files)
}

/// Lets a program write its manual pages and shell completions into a folder next to `share`, and moves them there.
/// Returns the files, sorted.
///
/// # Errors
/// As of [`install`].
pub fn pages(mut program: Command, share: &Path) -> Result<Vec<PathBuf>, String> {
    let fresh = share.with_extension("unfinished");
    let within = |error: std::io::Error| format!("{}: {error}", fresh.display());
    if fresh.exists() {
        fs::remove_dir_all(&fresh).map_err(within)?;
    }
    let ended = program.arg(PAGES).arg(&fresh).stdin(Stdio::null()).status();
    let ended = ended.map_err(|error| format!("{program:?}: {error}"))?;
    if !ended.success() {
        return Err(format!("{program:?}: {ended}"));
    }
    let mut files = Vec::new();
    for from in files_below(&fresh).map_err(within)? {
        let to = share.join(from.strip_prefix(&fresh).map_err(|error| error.to_string())?);
        copy(&from, &to)?;
        files.push(to);
    }
    fs::remove_dir_all(&fresh).map_err(within)?;
    files.sort();
    Ok(files)
}

fn files_below(folder: &Path) -> std::io::Result<Vec<PathBuf>> {
    let mut files = Vec::new();
    for entry in fs::read_dir(folder)? {
        let path = entry?.path();
        if path.is_dir() {
            files.extend(files_below(&path)?);
        } else {
            files.push(path);
        }
    }
    Ok(files)
}

fn name(file: &Path) -> Result<&std::ffi::OsStr, String> {
    file.file_name().ok_or_else(|| format!("{}: not a file", file.display()))
}

/// Copies a file, whose folder is made.
///
/// # Errors
/// As of [`install`].
pub fn copy(from: &Path, to: &Path) -> Result<(), String> {
    if !from.is_file() {
        return Err(format!("{}: does not exist", from.display()));
    }
    write(to, |unfinished| fs::copy(from, unfinished).map(|_| ()))
}

/// Writes next to the file, then renames: a program that runs from an older installation keeps the library it has
/// mapped.
fn write(to: &Path, fill: impl FnOnce(&Path) -> std::io::Result<()>) -> Result<(), String> {
    let mut unfinished = to.as_os_str().to_owned();
    unfinished.push(".unfinished");
    let folder = to.parent().unwrap_or(Path::new("."));
    let written =
        fs::create_dir_all(folder).and_then(|()| fill(unfinished.as_ref())).and_then(|()| fs::rename(&unfinished, to));
    written.map_err(|error| format!("{}: {error}", to.display()))
}

#[cfg(test)]
mod test;
