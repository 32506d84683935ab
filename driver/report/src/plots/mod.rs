//! The pictures of a run, or of several on top of each other, as SVG.
//!
//! [`Spec`] says what a history's columns mean and which measured curves belong to it. It is kept next to the pictures,
//! so that [`redraw`] can redraw them without the case. `selection` decides which pictures there are,
//! [`figure`] draws one, `field` draws fields on a mesh.

use super::directory::ResultDirectory;
use super::history::History;
use super::{at, malformed};
use figure::Figure;
use pullout_case::Case;
use pullout_run::input::{self, Input};
use pullout_run::program::{Caption, Compare, Control, PointDrive, PointKind, PointStep, Program};
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;
use std::io;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::{Path, PathBuf};

mod axis;
mod decimation;
pub mod export;
pub(crate) mod field;
pub mod figure;
mod inset;
mod legend;
mod markup;
pub mod quantity;
pub mod redraw;
pub mod selection;

#[cfg(test)]
mod test;

/// Folder of the pictures of a run in its result directory.
pub const FOLDER: &str = "plots";
/// File next to the pictures that holds the [`Spec`].
pub const SPEC_FILE: &str = "spec.json";

/// Description of a run that its pictures need besides its history.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Spec {
    /// Title of the case.
    pub title: String,
    /// Name of the law.
    pub law: String,
    /// Kind of case.
    pub subject: CaseKind,
    /// Units of state variables by column.
    pub units: BTreeMap<String, String>,
    /// Measured curves.
    pub curves: Vec<MeasuredCurve>,
    /// Texts of the run's inputs. Overlaid runs are named by the inputs that differ.
    #[serde(default)]
    pub inputs: BTreeMap<String, String>,
    /// Titles and legends of pictures, by their names.
    #[serde(default)]
    pub captions: BTreeMap<String, Caption>,
}

/// Kind of case.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum CaseKind {
    /// A material point; these of the six strain components were controlled.
    Point {
        /// Indices of components.
        controlled: Vec<usize>,
    },
    /// A contact point.
    Interface,
    /// A specimen.
    Pullout,
    /// Fibres across a crack.
    Bridging,
}

/// A measured curve in the history's units and signs.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct MeasuredCurve {
    /// Label in the legend.
    pub label: String,
    /// The history's column along x.
    pub x: String,
    /// The history's column along y.
    pub y: String,
    /// Points, scaled.
    pub points: Vec<(f64, f64)>,
}

/// A run to draw.
#[derive(Clone, Copy, Debug)]
pub struct PlottedRun<'a> {
    /// History.
    pub history: &'a History,
    /// Meaning of the history.
    pub spec: &'a Spec,
    /// Name of its result directory; may be empty.
    pub name: &'a str,
}

/// A drawn picture.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Picture {
    /// The file.
    pub path: PathBuf,
    /// Content.
    pub svg: String,
    /// Whether it is a field over a specimen at a moment, which a report folds.
    pub is_field: bool,
}

/// Pictures in their files, and why others are missing.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Drawings {
    /// Pictures, in the order of the report.
    pub pictures: Vec<Picture>,
    /// A warning of each picture that could not be drawn.
    pub warnings: Vec<String>,
}

impl Drawings {
    /// Writes a picture into a folder of a result directory, or notes why there is none.
    ///
    /// # Errors
    /// A file that cannot be written.
    pub fn keep(
        &mut self,
        directory: &mut ResultDirectory,
        folder: &str,
        name: &str,
        drawn: Result<String, impl std::fmt::Display>,
    ) -> io::Result<()> {
        match drawn {
            Ok(svg) => {
                let path = directory.write(&within(folder, &format!("{name}.svg")), &svg)?;
                self.pictures.push(Picture { path, svg, is_field: false });
            }
            Err(reason) => self.warnings.push(format!("the picture {name} could not be drawn: {reason}")),
        }
        Ok(())
    }

    /// Appends other pictures and warnings.
    pub fn append(&mut self, others: Self) {
        self.pictures.extend(others.pictures);
        self.warnings.extend(others.warnings);
    }
}

/// Draws: where the drawing library panics, its message is the error.
fn guarded<T>(draw: impl FnOnce() -> Result<T, String>) -> Result<T, String> {
    catch_unwind(AssertUnwindSafe(draw)).unwrap_or_else(|panic| {
        let text = panic.downcast_ref::<&str>().map(ToString::to_string);
        Err(text.or_else(|| panic.downcast_ref::<String>().cloned()).unwrap_or_else(|| "the drawing failed".into()))
    })
}

/// Draws a run into a folder of a result directory and writes the spec there.
///
/// # Errors
/// A file that cannot be written.
pub fn draw(directory: &mut ResultDirectory, folder: &str, history: &History, spec: &Spec) -> io::Result<Drawings> {
    let figures = selection::figures(&[PlottedRun { history, spec, name: "" }]);
    let mut drawings = write_all(directory, folder, &figures)?;
    drawings.warnings.extend(spec.captions_of_nothing(history, &figures));
    spec.write(directory, folder)?;
    Ok(drawings)
}

/// Writes figures into a folder of a result directory (`""`: the directory itself).
///
/// # Errors
/// A file that cannot be written.
pub fn write_all(directory: &mut ResultDirectory, folder: &str, figures: &[Figure]) -> io::Result<Drawings> {
    let mut drawings = Drawings::default();
    for figure in figures {
        drawings.keep(directory, folder, &figure.name, figure.svg())?;
    }
    Ok(drawings)
}

/// The name of a file in a folder of a result directory.
pub fn within(folder: &str, file: &str) -> String {
    if folder.is_empty() { file.to_owned() } else { format!("{folder}/{file}") }
}

impl Spec {
    /// Says what pictures a case has that was given these inputs.
    pub fn of(case: &Case, inputs: BTreeMap<String, String>) -> Self {
        let columns = case.columns();
        let curves = case.about().compare.iter().filter_map(|compare| MeasuredCurve::of(compare, &columns)).collect();
        let (law, subject, units) = match case {
            Case::Path(program) => of_point(program),
            Case::Pullout(program) => {
                let law = program.laws().first().map_or(String::new(), |(_, law)| law.name.clone());
                (law, CaseKind::Pullout, BTreeMap::new())
            }
            Case::Bridging(_) => ("computed".into(), CaseKind::Bridging, BTreeMap::new()),
        };
        let captions = case.about().captions.clone();
        Self { title: case.about().title.to_owned(), law, subject, units, curves, inputs, captions }
    }

    /// A warning of each word that no picture takes.
    fn captions_of_nothing(&self, history: &History, figures: &[Figure]) -> Vec<String> {
        let names: Vec<&str> = figures.iter().map(|figure| figure.name.as_str()).collect();
        let of_picture = |(name, caption): (&String, &Caption)| {
            if !names.contains(&name.as_str()) {
                let names = names.join(", ");
                return vec![format!("output.plots.{name}: there is no such picture of curves; there are {names}")];
            }
            let unknown = caption.legend.keys().filter(|column| history.column(column).is_none());
            unknown.map(|column| format!("output.plots.{name}.legend.{column}: there is no such column")).collect()
        };
        self.captions.iter().flat_map(of_picture).collect()
    }

    /// Leaves it in a folder of a result directory.
    ///
    /// # Errors
    /// A file that cannot be written.
    pub fn write(&self, directory: &mut ResultDirectory, folder: &str) -> io::Result<()> {
        let text = serde_json::to_string(self).map_err(io::Error::other)?;
        directory.write(&within(folder, SPEC_FILE), text).map(|_| ())
    }

    /// Reads that of a run from its result directory.
    pub fn of_run(folder: &Path) -> io::Result<Self> {
        Self::read(&folder.join(FOLDER).join(SPEC_FILE))
    }

    /// Reads what [`draw`] left in a folder.
    pub fn read(path: &Path) -> io::Result<Self> {
        let text = input::read(path, Input::Result).map_err(at(path))?;
        serde_json::from_slice(&text).map_err(|error| malformed(path, error))
    }
}

impl MeasuredCurve {
    fn of(compare: &Compare, columns: &[String]) -> Option<Self> {
        let scaled = compare.points.iter().map(|(x, y)| (x * compare.scale_x, y * compare.scale_y));
        Some(Self {
            label: compare.label.clone(),
            x: columns.get(compare.x)?.clone(),
            y: columns.get(compare.y)?.clone(),
            points: scaled.filter(|(x, y)| x.is_finite() && y.is_finite()).collect(),
        })
    }
}

/// Returns law, subject and units of a material or contact point.
fn of_point(program: &Program) -> (String, CaseKind, BTreeMap<String, String>) {
    let law = program.plugin.law.as_ref();
    let units = law.map(|law| law.states.iter().map(|state| (state.name.clone(), state.unit.clone())).collect());
    let subject = match &program.kind {
        PointKind::Point(point) => CaseKind::Point { controlled: controlled(&point.steps) },
        PointKind::Interface(_) => CaseKind::Interface,
    };
    (program.plugin.name.clone(), subject, units.unwrap_or_default())
}

/// The strain components that some step prescribes (a held one is not driven).
fn controlled(steps: &[PointStep]) -> Vec<usize> {
    let prescribed = |component: usize| {
        steps.iter().any(|step| match &step.goal.drive {
            PointDrive::Components { controls, .. } => matches!(controls[component], Control::Strain(_)),
            PointDrive::DeformationGradient(_) => true,
        })
    };
    (0..6).filter(|&component| prescribed(component)).collect()
}
