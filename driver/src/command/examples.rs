//! `pullout examples`: lists the cases installed with pullout.

use super::{DONE, NO_PLUGIN, Refusal, say};
use pullout_check::description::table;
use pullout_run::isolation;
use serde_json::Value;
use std::fs;
use std::io;
use std::path::{Path, PathBuf};

#[derive(Debug, clap::Args)]
pub(super) struct ExamplesArguments {
    /// List only cases with all these words in path, title or description.
    #[arg(value_name = "WORD")]
    words: Vec<String>,
}

/// A case installed with pullout.
#[derive(Debug)]
pub struct Example {
    /// Its file.
    pub path: PathBuf,
    /// Its kind.
    pub kind: String,
    /// Its title.
    pub title: String,
}

pub(super) fn list(arguments: &ExamplesArguments) -> Result<u8, Refusal> {
    let found =
        find(&arguments.words).map_err(|error| Refusal { code: NO_PLUGIN, ..Refusal::failed(error.to_string()) })?;
    // shown from the working directory if they are below it
    let here = std::env::current_dir().unwrap_or_default();
    let row =
        |Example { path, kind, title }| [path.strip_prefix(&here).unwrap_or(&path).display().to_string(), kind, title];
    let rows: Vec<[String; 3]> = found.into_iter().map(row).collect();
    let Some([first, ..]) = rows.first().cloned() else {
        return Err(Refusal::input(format!("none of the examples has all of: {}", arguments.words.join(", "))));
    };
    let header = ["CASE", "KIND", "SHOWS"].map(String::from);
    say(&table(&std::iter::once(header).chain(rows).collect::<Vec<_>>()));
    say(&format!("\nRun one: pullout run {first}\n"));
    Ok(DONE)
}

/// Finds the installed cases that have all words in path, title or description, sorted by path.
///
/// # Errors
/// They are not installed, or cannot be listed.
pub fn find(words: &[String]) -> io::Result<Vec<Example>> {
    let missing =
        "no examples: neither share/pullout/cases of the installation nor the cases of the source tree are there";
    let folder = folder().ok_or_else(|| io::Error::new(io::ErrorKind::NotFound, missing))?;
    let mut files = Vec::new();
    collect(&folder, &mut files)?;
    files.sort();
    let words: Vec<String> = words.iter().map(|word| word.to_lowercase()).collect();
    Ok(files.into_iter().filter_map(|file| example(file, &words)).collect())
}

/// Returns a case if it has all words.
fn example(path: PathBuf, words: &[String]) -> Option<Example> {
    let document: Value = serde_json::from_slice(&fs::read(&path).ok()?).ok()?;
    let text = |key: &str| document[key].as_str().unwrap_or_default().to_owned();
    let (kind, title) = (text("kind"), text("title"));
    let all = format!("{}\n{kind}\n{title}\n{}", path.display(), text("description")).to_lowercase();
    (!kind.is_empty() && words.iter().all(|word| all.contains(word))).then_some(Example { path, kind, title })
}

/// Returns the folder of the cases: that of the installation, or of the source tree in which pullout was built.
fn folder() -> Option<PathBuf> {
    // of an interpreter that has loaded this as a module it is the script that was installed
    let program = isolation::program().and_then(Path::canonicalize).ok()?;
    let installed = program.ancestors().nth(2)?.join("share").join("pullout").join("cases");
    let tree =
        program.ancestors().nth(3).filter(|tree| tree.join("Cargo.toml").is_file()).map(|tree| tree.join("cases"));
    std::iter::once(installed).chain(tree).find(|folder| folder.is_dir())
}

fn collect(folder: &Path, files: &mut Vec<PathBuf>) -> io::Result<()> {
    for entry in fs::read_dir(folder)? {
        let path = entry?.path();
        if path.is_dir() {
            collect(&path, files)?;
        } else if path.extension().is_some_and(|suffix| suffix == "json") {
            files.push(path);
        }
    }
    Ok(())
}
