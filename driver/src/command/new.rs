//! `pullout new`: writes the starter files of a tutorial. They exist only on the pages of the book.

use super::{DONE, Refusal, say};
use clap::ValueEnum;
use serde_json::Value;
use std::fs;
use std::path::{Path, PathBuf};

#[derive(Debug, clap::Args)]
pub(super) struct NewArguments {
    /// What to start with.
    kind: Kind,
    /// Folder for the files; created if necessary.
    #[arg(value_name = "DIR", default_value = ".")]
    folder: PathBuf,
}

/// A tutorial's first files.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
enum Kind {
    /// A material point with a shipped law and a measured curve.
    Point,
    /// A UMAT in Fortran, and a case that drives it.
    Umat,
    /// The same UMAT in C.
    UmatC,
    /// A law in Rust, with descriptions of its parameters and states.
    Law,
    /// The bond law of a fibre, at one point.
    Bond,
    /// A fibre pulled out of its block.
    Fibre,
    /// A hooked fibre from its data sheet.
    HookedFibre,
    /// Fibres across a crack: σ(w), the notched beam and f_R.
    Beam,
    /// A family of runs, with claims.
    Study,
    /// Thousands of runs that leave one row of numbers each.
    Sweep,
}

/// A page of the book.
struct Page {
    text: &'static str,
    name: &'static str,
    files: &'static [&'static str],
}

impl Kind {
    fn page(self) -> Page {
        macro_rules! page {
            ($name:literal, $($file:literal),+) => {
                Page { text: include_str!(concat!("../../../docs/using/", $name, ".md")), name: $name, files: &[$($file),+] }
            };
        }
        match self {
            Self::Point => page!("first-run", "case.json"),
            Self::Umat => page!("umat", "my_umat.f", "umat.json"),
            Self::UmatC => page!("umat", "my_umat.c", "umat.json"),
            Self::Law => page!("law", "Cargo.toml", "src/lib.rs"),
            Self::Bond => page!("bond-law", "bond.json", "measured.csv"),
            Self::Fibre => page!("fibre", "fibre.json"),
            Self::HookedFibre => page!("hooked-fibre", "hooked.json"),
            Self::Beam => page!("bridging", "beam.json"),
            Self::Study => page!("study", "fibre.json", "friction.json"),
            Self::Sweep => page!("sweeps", "bond.json", "bonds.json"),
        }
    }
}

pub(super) fn write(arguments: &NewArguments) -> Result<u8, Refusal> {
    let page = arguments.kind.page();
    let Page { text, files, .. } = page;
    let place = |file: &str| arguments.folder.join(file);
    let in_the_way: Vec<String> = files
        .iter()
        .map(|file| place(file))
        .filter(|file| file.exists())
        .map(|file| file.display().to_string())
        .collect();
    if !in_the_way.is_empty() {
        return Err(Refusal::input(format!("{}: exists already; nothing was written", in_the_way.join(", "))));
    }
    for file in files {
        let path = place(file);
        let content = page.content(file)?;
        let written =
            fs::create_dir_all(path.parent().unwrap_or(Path::new(""))).and_then(|()| fs::write(&path, content));
        written.map_err(|error| Refusal::failed(format!("{}: {error}", path.display())))?;
        say(&format!("{}\n", path.display()));
    }
    let commands = next(text, &mark(files[0]));
    if !commands.is_empty() {
        let place = (arguments.folder != Path::new(".")).then(|| format!("cd {}", arguments.folder.display()));
        let lines: String =
            place.iter().map(String::as_str).chain(commands).map(|line| format!("  {line}\n")).collect();
        say(&format!("\nNext:\n{lines}"));
    }
    Ok(DONE)
}

/// Returns the case of a mix of fibres without random beams and walls, which take too long for a picture.
pub(super) fn bridging() -> Result<Value, Refusal> {
    let page = Kind::Beam.page();
    let mut document: Value = serde_json::from_str(page.content("beam.json")?).map_err(Refusal::failed)?;
    if let Some(members) = document.as_object_mut() {
        members.retain(|name, _| !["scatter", "orientation"].contains(&name.as_str()));
    }
    Ok(document)
}

impl Page {
    /// Returns the content of a file.
    fn content(&self, file: &str) -> Result<&'static str, Refusal> {
        let content = self.text.split_once(&mark(file)).and_then(|(_, rest)| fence(rest));
        content.ok_or_else(|| Refusal::failed(format!("the page {} has no {file}", self.name)))
    }
}

/// Returns the mark that precedes a file's content on a page.
fn mark(file: &str) -> String {
    format!("<!-- file: {file} -->\n")
}

/// Returns the commands of a page after a mark, to the end of the first script that runs something.
fn next<'t>(text: &'t str, mark: &str) -> Vec<&'t str> {
    const RUNS: [&str; 4] = ["pullout run ", "pullout fit ", "pullout study ", "pullout sweep "];
    let mut commands = Vec::new();
    let behind = text.split_once(mark).map_or("", |(_, rest)| rest);
    for script in behind.split("<!-- run -->\n").skip(1).filter_map(fence) {
        let is_command = |line: &&str| ["pullout ", "cargo ", "gcc ", "  "].iter().any(|start| line.starts_with(start));
        commands.extend(script.lines().filter(is_command));
        if RUNS.iter().any(|run| script.contains(run)) {
            break;
        }
    }
    commands
}

/// Returns the content of the fenced block at the start of a text, including the end of its last line.
fn fence(text: &str) -> Option<&str> {
    let (_, rest) = text.strip_prefix("```")?.split_once('\n')?;
    rest.find("\n```\n").and_then(|end| rest.get(..=end))
}
