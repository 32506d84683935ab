//! Pictures of runs that have ended, drawn once more: several runs laid over each other, and other formats.

use super::export::Export;
use super::figure::Figure;
use super::{Drawings, FOLDER, Picture, PlottedRun, Spec, selection, within, write_all};
use crate::directory::ResultDirectory;
use crate::history::History;
use pullout_run::input::{self, Input};
use std::io;
use std::path::{Path, PathBuf};

/// What pictures need of a run.
pub struct DrawnRun {
    history: History,
    spec: Spec,
    /// Name of its result directory.
    name: String,
}

impl DrawnRun {
    /// Reads it from its result directory.
    ///
    /// # Errors
    /// The directory has no history, or no pictures.
    pub fn read(folder: &Path) -> io::Result<Self> {
        let history = History::of_run(folder, |table| table.for_pictures())?;
        let spec = Spec::of_run(folder)?;
        let whole = folder.canonicalize();
        let name = whole.as_deref().unwrap_or(folder).file_name().unwrap_or_default().to_string_lossy().into_owned();
        Ok(Self { history, spec, name })
    }
}

/// Pictures to draw into a folder of a result directory.
pub struct Redrawing<'a> {
    folder: &'a str,
    figures: Vec<Figure>,
    /// Names of the figures' files.
    drawn: Vec<String>,
    /// Drawings that come along from elsewhere: the file, and its name here.
    taken: Vec<(PathBuf, String)>,
    /// Names of a drawing and of its picture in another format, and what makes that.
    exports: Vec<(String, String, Export)>,
}

impl<'a> Redrawing<'a> {
    /// Plans the pictures of runs over each other in a folder (`""`: the directory itself), and of all drawings that are then
    /// there the other formats, by their file name extensions. `source`: the result directory whose other drawings, those of
    /// fields among them, come along.
    pub fn new(
        runs: &[DrawnRun],
        directory: &ResultDirectory,
        folder: &'a str,
        source: Option<&Path>,
        formats: &[(&str, Export)],
    ) -> Self {
        let runs: Vec<_> =
            runs.iter().map(|DrawnRun { history, spec, name }| PlottedRun { history, spec, name }).collect();
        let figures = selection::figures(&runs);
        let drawn: Vec<String> = figures.iter().map(|figure| within(folder, &format!("{}.svg", figure.name))).collect();
        let source = source.map(|source| source.join(FOLDER));
        let is_elsewhere =
            |source: &PathBuf| source.canonicalize().ok() != directory.path().join(folder).canonicalize().ok();
        let others = source
            .filter(is_elsewhere)
            .into_iter()
            .flat_map(|source| present(&source).into_iter().map(move |name| (source.join(&name), name)));
        let taken: Vec<(PathBuf, String)> = others
            .map(|(file, name)| (file, within(folder, &name)))
            .filter(|(_, name)| !drawn.contains(name))
            .collect();
        let mut drawings: Vec<String> = drawn.iter().chain(taken.iter().map(|(_, name)| name)).cloned().collect();
        if !formats.is_empty() {
            drawings.extend(present(&directory.path().join(folder)).into_iter().map(|name| within(folder, &name)));
            drawings.sort();
            drawings.dedup();
        }
        let named = |drawing: &str, extension: &str| {
            Path::new(drawing).with_extension(extension).to_string_lossy().into_owned()
        };
        let exports = drawings
            .iter()
            .flat_map(|drawing| {
                formats.iter().map(move |&(name, export)| (drawing.clone(), named(drawing, name), export))
            })
            .collect();
        Self { folder, figures, drawn, taken, exports }
    }

    /// Returns the names of all written files, relative to the directory.
    pub fn names(&self) -> impl Iterator<Item = &str> {
        let taken = self.taken.iter().map(|(_, name)| name);
        self.drawn.iter().chain(taken).chain(self.exports.iter().map(|(_, name, _)| name)).map(String::as_str)
    }

    /// Draws.
    ///
    /// # Errors
    /// A file that cannot be written.
    pub fn draw(&self, directory: &mut ResultDirectory) -> io::Result<Drawings> {
        let mut drawings = write_all(directory, self.folder, &self.figures)?;
        for (file, name) in &self.taken {
            let svg = input::text(file, Input::Result)?;
            let path = directory.write(name, &svg)?;
            drawings.pictures.push(Picture { path, svg, is_field: false });
        }
        Ok(drawings)
    }

    /// Makes the other formats of what is drawn, and returns their files.
    ///
    /// # Errors
    /// A drawing that cannot be read or exported, a file that cannot be written.
    pub fn export(&self, directory: &mut ResultDirectory) -> io::Result<Vec<PathBuf>> {
        let export = |(drawing, name, export): &(String, String, Export)| {
            let svg = input::text(&directory.path().join(drawing), Input::Result)?;
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
