//! `pullout plot`.

use super::{DONE, Refusal, complain, say};
use pullout_report::directory::{Kind, ResultDirectory};
use pullout_report::history::History;
use pullout_report::plots::export::{self, Export};
use pullout_report::plots::{self, Run, SPEC_FILE, Spec, selection, within};
use pullout_run::input::{self, Input};
use std::io;
use std::path::{Path, PathBuf};

/// Settings for drawing pictures again.
#[derive(Debug, clap::Args)]
pub(super) struct Arguments {
    /// Result directories of runs; or that of one study, with --png or --pdf.
    #[arg(required = true, value_name = "RESULT_DIR")]
    results: Vec<PathBuf>,
    /// Directory of the pictures; default: plots/ of the first.
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
    /// Make a PNG of every picture there as well, those of a specimen's fields among them.
    #[arg(long)]
    png: bool,
    /// Make a PDF of every picture there as well.
    #[arg(long)]
    pdf: bool,
    /// Replace pictures there that this program did not write, or that were changed since.
    #[arg(long)]
    overwrite: bool,
}

pub(super) fn plot(arguments: &Arguments) -> Result<u8, Refusal> {
    let mut runs = Vec::new();
    let first = &arguments.results[0];
    let is_study = arguments.results.len() == 1 && arguments.out.is_none() && first.join("study.json").is_file();
    if is_study && !arguments.png && !arguments.pdf {
        let message = "`pullout study` draws the pictures of a study: --png or --pdf?";
        return Err(Refusal::input(format!("{}: {message}", first.display())));
    }
    for folder in arguments.results.iter().filter(|_| !is_study) {
        let refused = |error| Refusal::input(format!("{error}: is it the result directory of a run with pictures?"));
        runs.push(read(folder).map_err(refused)?);
    }
    let (root, kind, folder) = match &arguments.out {
        Some(out) => (out, Kind::Pictures, ""),
        None => (first, if is_study { Kind::Study } else { Kind::Run }, "plots"),
    };
    let paths = draw(&runs, ResultDirectory::open_to_add(root, kind)?, folder, arguments)?;
    paths.iter().for_each(|path| say(&format!("{}\n", path.display())));
    Ok(DONE)
}

/// Draws into a folder of a directory; the result is the files.
fn draw(
    runs: &[(History, Spec)],
    mut directory: ResultDirectory,
    folder: &str,
    arguments: &Arguments,
) -> Result<Vec<PathBuf>, Refusal> {
    let runs: Vec<_> = runs.iter().map(|(history, spec)| Run { history, spec }).collect();
    let figures = selection::figures(&runs);
    let drawn: Vec<String> = figures.iter().map(|figure| within(folder, &format!("{}.svg", figure.name))).collect();
    let formats: [(bool, &str, Export); 2] = [(arguments.png, "png", export::png), (arguments.pdf, "pdf", export::pdf)];
    let formats: Vec<_> = formats.into_iter().filter(|(is_wanted, ..)| *is_wanted).collect();
    let mut drawings = drawn.clone();
    if !formats.is_empty() {
        drawings.extend(present(&directory.path().join(folder)).into_iter().map(|name| within(folder, &name)));
        drawings.sort();
        drawings.dedup();
    }
    let named =
        |drawing: &String, extension: &str| Path::new(drawing).with_extension(extension).to_string_lossy().into_owned();
    let exports: Vec<(&String, String, Export)> = drawings
        .iter()
        .flat_map(|drawing| formats.iter().map(move |&(_, name, export)| (drawing, named(drawing, name), export)))
        .collect();
    let names = drawn.iter().chain(exports.iter().map(|(_, name, _)| name));
    let foreign = directory.foreign(names.map(String::as_str));
    if !foreign.is_empty() && !arguments.overwrite {
        return Err(Refusal::input(format!(
            "{}: {} would be replaced, but this program did not write it, or it was changed since: choose another \
             --out, or replace it with --overwrite",
            directory.path().display(),
            foreign.join(", ")
        )));
    }
    if !foreign.is_empty() {
        complain(format!("{}: --overwrite replaces {}", directory.path().display(), foreign.join(", ")));
    }
    let drawings = plots::write_all(&mut directory, folder, &figures)?;
    drawings.warnings.iter().for_each(|warning| complain(format!("warning: {warning}")));
    let mut paths: Vec<PathBuf> = drawings.pictures.into_iter().map(|picture| picture.path).collect();
    for (drawing, name, export) in &exports {
        let svg = input::text(&directory.path().join(drawing), Input::Result)?;
        paths.push(directory.write(name, export(&svg)?)?);
    }
    directory.finish()?;
    Ok(paths)
}

/// The drawings in a folder.
fn present(folder: &Path) -> Vec<String> {
    let names = std::fs::read_dir(folder)
        .into_iter()
        .flatten()
        .flatten()
        .filter_map(|entry| entry.file_name().into_string().ok());
    names.filter(|name| name.ends_with(".svg")).collect()
}

fn read(folder: &Path) -> io::Result<(History, Spec)> {
    let history = History::of_run(folder, |table| table.for_pictures())?;
    let spec = Spec::read(&folder.join("plots").join(SPEC_FILE))?;
    Ok((history, spec))
}
