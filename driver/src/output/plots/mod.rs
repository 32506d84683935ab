//! The pictures of a run, or of several on top of each other, as SVG.
//!
//! [`Spec`] says what a history's columns mean and which measured curves belong to it; it is kept beside the pictures
//! so that `pullout plot` can redraw them without the case. [`selection`] decides which pictures there are,
//! [`figure`] draws one; [`field`] draws what a mesh carries.

use super::history::History;
use super::{at, malformed};
use crate::case::Case;
use crate::path::program::{Compare, Control, Kind, PointDrive, PointStep, Program};
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;
use std::io;
use std::path::{Path, PathBuf};

mod axis;
mod decimation;
pub mod field;
pub mod figure;
mod legend;
mod markup;
pub mod png;
pub mod quantity;
pub mod selection;

#[cfg(test)]
mod test;

/// File beside the pictures that holds the [`Spec`].
pub const SPEC_FILE: &str = "spec.json";

/// What a picture needs to know of a run besides its history.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Spec {
    /// Title of the case.
    pub title: String,
    /// Name of the law.
    pub law: String,
    /// What was driven.
    pub subject: Subject,
    /// Units of state variables by column.
    pub units: BTreeMap<String, String>,
    /// Measured curves.
    pub curves: Vec<Curve>,
}

/// What was driven.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Subject {
    /// A material point; these of the six strain components were controlled.
    Point {
        /// Indices of components.
        controlled: Vec<usize>,
    },
    /// A contact point.
    Interface,
    /// A specimen.
    Pullout,
}

/// A measured curve in the history's units and signs.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Curve {
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
pub struct Run<'a> {
    /// Its history.
    pub history: &'a History,
    /// What the history means.
    pub spec: &'a Spec,
}

/// A drawn picture.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Picture {
    /// The file.
    pub path: PathBuf,
    /// Its content.
    pub svg: String,
}

/// Draws a run into `folder` (made if missing) and leaves the spec there.
pub fn draw(folder: &Path, history: &History, spec: &Spec) -> io::Result<Vec<Picture>> {
    let pictures = draw_overlay(folder, &[Run { history, spec }])?;
    spec.write(&folder.join(SPEC_FILE))?;
    Ok(pictures)
}

/// Draws several runs on top of each other into `folder`; the legend names them by their titles.
pub fn draw_overlay(folder: &Path, runs: &[Run<'_>]) -> io::Result<Vec<Picture>> {
    std::fs::create_dir_all(folder).map_err(at(folder))?;
    let mut pictures = Vec::new();
    for figure in selection::figures(runs) {
        let path = folder.join(format!("{}.svg", figure.name));
        let svg = figure.svg().map_err(at(&path))?;
        std::fs::write(&path, &svg).map_err(at(&path))?;
        pictures.push(Picture { path, svg });
    }
    Ok(pictures)
}

impl Spec {
    /// Of a case.
    pub fn of(case: &Case) -> Self {
        let columns = case.columns();
        let curves = case.compare().iter().filter_map(|compare| Curve::of(compare, &columns)).collect();
        let (law, subject, units) = match case {
            Case::Path(program) => of_point(program),
            Case::Pullout(program) => {
                let law = program.laws().first().map_or(String::new(), |(_, law)| law.name.clone());
                (law, Subject::Pullout, BTreeMap::new())
            }
        };
        Self { title: case.title().to_owned(), law, subject, units, curves }
    }

    /// Reads what [`draw`] left in a folder.
    pub fn read(path: &Path) -> io::Result<Self> {
        let text = std::fs::read(path).map_err(at(path))?;
        serde_json::from_slice(&text).map_err(|error| malformed(path, error))
    }

    fn write(&self, path: &Path) -> io::Result<()> {
        let text = serde_json::to_string(self).map_err(|error| malformed(path, error))?;
        std::fs::write(path, text).map_err(at(path))
    }
}

impl Curve {
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

/// Law, subject and units of a material or contact point.
fn of_point(program: &Program) -> (String, Subject, BTreeMap<String, String>) {
    let law = program.plugin.law.as_ref();
    let units = law.map(|law| law.states.iter().map(|state| (state.name.clone(), state.unit.clone())).collect());
    let subject = match &program.kind {
        Kind::Point(point) => Subject::Point { controlled: controlled(&point.steps) },
        Kind::Interface(_) => Subject::Interface,
    };
    (program.plugin.name.clone(), subject, units.unwrap_or_default())
}

/// The strain components that some step prescribes (a held one is not driven).
fn controlled(steps: &[PointStep]) -> Vec<usize> {
    let prescribed = |component: usize| {
        steps.iter().any(|step| match &step.drive {
            PointDrive::Ramp { controls, .. } | PointDrive::Table { controls, .. } => {
                matches!(controls[component], Control::Strain(_))
            }
            PointDrive::DeformationGradient { .. } => true,
        })
    };
    (0..6).filter(|&component| prescribed(component)).collect()
}
