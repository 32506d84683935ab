//! `pullout examples`: the cases that came with the program.

use super::{DONE, NO_PLUGIN, Refusal, say};
use pullout_check::description::table;
use serde_json::Value;
use std::fs;
use std::path::{Path, PathBuf};

#[derive(Debug, clap::Args)]
pub(super) struct Arguments {
    /// Only those with all of these words in path, title or description.
    #[arg(value_name = "WORD")]
    words: Vec<String>,
}

pub(super) fn list(arguments: &Arguments) -> Result<u8, Refusal> {
    let folder = folder().ok_or_else(|| Refusal {
        code: NO_PLUGIN,
        ..Refusal::failed(
            "no examples: neither share/pullout/cases of the installation nor the cases of the source tree are there",
        )
    })?;
    let mut files = Vec::new();
    collect(&folder, &mut files)?;
    files.sort();
    let words: Vec<String> = arguments.words.iter().map(|word| word.to_lowercase()).collect();
    let rows: Vec<[String; 3]> = files.iter().filter_map(|file| row(file, &words)).collect();
    if rows.is_empty() {
        return Err(Refusal::input(format!("none of the examples has all of: {}", arguments.words.join(", "))));
    }
    let header = ["CASE", "KIND", "SHOWS"].map(String::from);
    let first = rows[0][0].clone();
    say(&table(&std::iter::once(header).chain(rows).collect::<Vec<_>>()));
    say(&format!("\nRun one: pullout run {first}\n"));
    Ok(DONE)
}

/// Path, kind and title of a case, if it has all words.
fn row(file: &Path, words: &[String]) -> Option<[String; 3]> {
    let document: Value = serde_json::from_slice(&fs::read(file).ok()?).ok()?;
    let text = |key: &str| document[key].as_str().unwrap_or_default().to_owned();
    let row = [file.display().to_string(), text("kind"), text("title")];
    let all = format!("{}\n{}", row.join("\n"), text("description")).to_lowercase();
    (!row[1].is_empty() && words.iter().all(|word| all.contains(word))).then_some(row)
}

/// The cases of the installation, or of the source tree that the program was built in; shown from the working directory if
/// they are below it.
fn folder() -> Option<PathBuf> {
    let program = std::env::current_exe().ok()?;
    let installed = program.ancestors().nth(2)?.join("share").join("pullout").join("cases");
    let tree =
        program.ancestors().nth(3).filter(|tree| tree.join("Cargo.toml").is_file()).map(|tree| tree.join("cases"));
    let found = std::iter::once(installed).chain(tree).find(|folder| folder.is_dir())?;
    let here = std::env::current_dir().ok();
    Some(here.and_then(|here| found.strip_prefix(here).ok().map(Path::to_owned)).unwrap_or(found))
}

fn collect(folder: &Path, files: &mut Vec<PathBuf>) -> std::io::Result<()> {
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
