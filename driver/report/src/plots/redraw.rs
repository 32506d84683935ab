//! Pictures of runs that have ended, drawn once more: several runs laid over each other, and other formats.

use super::export::Export;
use super::figure::Figure;
use super::{Drawings, FOLDER, Run, SPEC_FILE, Spec, selection, within, write_all};
use crate::directory::ResultDirectory;
use crate::history::History;
use pullout_run::input::{self, Input};
use std::io;
use std::path::{Path, PathBuf};

/// Reads what pictures need of a run, by its result directory.
///
/// # Errors
/// The directory has no history, or no pictures.
pub fn read(folder: &Path) -> io::Result<(History, Spec)> {
    let history = History::of_run(folder, |table| table.for_pictures())?;
    let spec = Spec::read(&folder.join(FOLDER).join(SPEC_FILE))?;
    Ok((history, spec))
}

/// Pictures that are to be drawn into a folder of a result directory.
pub struct Redrawing<'a> {
    folder: &'a str,
    figures: Vec<Figure>,
    /// Names of the figures' files.
    drawn: Vec<String>,
    /// A drawing, the name of its picture in another format, and what makes that.
    exports: Vec<(PathBuf, String, Export)>,
}

impl<'a> Redrawing<'a> {
    /// Plans the pictures of runs over each other in a folder (`""`: the directory itself), and of all drawings that are then
    /// there the other formats, by their file name extensions; and of the drawings of one run in `beside` as well, which are not
    /// drawn again: those of fields.
    pub fn new(
        runs: &[(History, Spec)],
        directory: &ResultDirectory,
        folder: &'a str,
        formats: &[(&str, Export)],
        beside: Option<&Path>,
    ) -> Self {
        let runs: Vec<_> = runs.iter().map(|(history, spec)| Run { history, spec }).collect();
        let figures = selection::figures(&runs);
        let drawn: Vec<String> = figures.iter().map(|figure| within(folder, &format!("{}.svg", figure.name))).collect();
        let mut drawings = drawn.clone();
        if !formats.is_empty() {
            drawings.extend(present(&directory.path().join(folder)).into_iter().map(|name| within(folder, &name)));
            drawings.sort();
            drawings.dedup();
        }
        let own = drawings.iter().map(|name| (directory.path().join(name), name.clone()));
        let others =
            beside.into_iter().flat_map(|beside| present(beside).into_iter().map(|name| (beside.join(&name), name)));
        let others = others.filter(|(_, name)| !drawings.contains(name));
        let named = |drawing: &str, extension: &str| {
            Path::new(drawing).with_extension(extension).to_string_lossy().into_owned()
        };
        let exports = own
            .chain(others)
            .flat_map(|(file, drawing)| {
                formats.iter().map(move |&(name, export)| (file.clone(), named(&drawing, name), export))
            })
            .collect();
        Self { folder, figures, drawn, exports }
    }

    /// The names of all files that are written, as seen from the directory.
    pub fn names(&self) -> impl Iterator<Item = &str> {
        self.drawn.iter().chain(self.exports.iter().map(|(_, name, _)| name)).map(String::as_str)
    }

    /// Draws.
    ///
    /// # Errors
    /// A file that cannot be written.
    pub fn draw(&self, directory: &mut ResultDirectory) -> io::Result<Drawings> {
        write_all(directory, self.folder, &self.figures)
    }

    /// Makes the other formats of what is drawn, and returns their files.
    ///
    /// # Errors
    /// A drawing that cannot be read or exported, a file that cannot be written.
    pub fn export(&self, directory: &mut ResultDirectory) -> io::Result<Vec<PathBuf>> {
        let export = |(drawing, name, export): &(PathBuf, String, Export)| {
            let svg = input::text(drawing, Input::Result)?;
            directory.write(name, export(&svg)?)
        };
        self.exports.iter().map(export).collect()
    }
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
