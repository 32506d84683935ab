//! Libraries built because a source was named where a library is expected. They are kept in the user's cache under a hash of the
//! source, the files it includes, and the compiler.

use super::scan::Scan;
use super::source::{Language, PluginSource};
use super::{BuildRequest, Refusal, build};
use pullout_run::input::{self, Input};
use std::env;
use std::fmt::Write;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;
use umat_abi::host::library_file_name;

/// Returns the library of one source, from the cache or built now. If it is built now, `notify` receives the messages of the
/// build.
///
/// # Errors
/// [`Refusal`].
pub fn kept(file: &Path, notify: &dyn Fn(String)) -> Result<PathBuf, Refusal> {
    let source = PluginSource::new(file, None)?;
    let stem = file.file_stem().unwrap_or_default().to_string_lossy();
    let folder = cache().join(hash(&source));
    let library = folder.join(library_file_name(&stem));
    if library.is_file() {
        return Ok(library);
    }
    let in_words = |error: std::io::Error| std::io::Error::new(error.kind(), format!("{}: {error}", folder.display()));
    fs::create_dir_all(&folder).map_err(in_words)?;
    let request = BuildRequest {
        sources: vec![file.to_owned()],
        output: Some(library),
        form: None,
        flags: Vec::new(),
        debug: false,
    };
    let built = build(&request)?;
    notify(format!("{}: built as {}", file.display(), built.library.display()));
    built.words().into_iter().for_each(notify);
    Ok(built.library)
}

/// Returns `pullout/libraries` in the user's cache or, if there is none, in the folder for temporary files.
fn cache() -> PathBuf {
    let absolute = |name: &str| env::var_os(name).map(PathBuf::from).filter(|path| path.is_absolute());
    let folder = absolute("XDG_CACHE_HOME").or_else(|| absolute("HOME").map(|home| home.join(".cache")));
    folder.unwrap_or_else(env::temp_dir).join("pullout").join("libraries")
}

/// A hash, in hexadecimal digits, of what a library is made of.
fn hash(source: &PluginSource) -> String {
    let mut text = format!("{}\n", env!("CARGO_PKG_VERSION"));
    if let Some(compiler) = source.language.compiler() {
        let version = Command::new(compiler).arg("--version").output();
        text += &version.map(|output| String::from_utf8_lossy(&output.stdout).into_owned()).unwrap_or_default();
    }
    for file in inputs_of(source) {
        let content = input::hash(&file, Input::Source).unwrap_or_default();
        let _ = writeln!(text, "{} {content:02x?}", super::absolute(&file).display());
    }
    input::fingerprint(&text)
}

/// The files that a library of a source is made of: itself, and the user's files that it includes.
pub fn inputs(file: &Path) -> Vec<PathBuf> {
    PluginSource::new(file, None).map_or_else(|_| vec![file.to_owned()], |source| inputs_of(&source))
}

/// The source and the files of the user's that it includes.
fn inputs_of(source: &PluginSource) -> Vec<PathBuf> {
    let mut files = vec![source.file.clone()];
    if let Language::Fortran(_) = source.language {
        files.extend(Scan::of(source).files);
        return files;
    }
    // a rule of make: the object, and what it is made of
    let Some(compiler) = source.language.compiler() else { return files };
    let mut command = Command::new(compiler);
    command
        .args(["-MM", "-MG", "-MT", "-"])
        .args(source.header_folders().iter().flat_map(|folder| ["-isystem".as_ref(), folder.as_path()]));
    let folder = source.file.parent().unwrap_or(Path::new(""));
    command.arg(super::absolute(&source.file));
    if let Ok(rule) = command.output().map(|output| String::from_utf8_lossy(&output.stdout).into_owned()) {
        let names = rule.split_whitespace().filter(|word| !["-:", "\\"].contains(word));
        files.extend(names.map(|name| folder.join(name)));
    }
    files
}
