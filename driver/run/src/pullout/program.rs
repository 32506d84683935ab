//! Contents of a case of kind "pullout": a model of the FE core, and the output that is written.

use super::checkpoint::Checkpoints;
use crate::columns;
use crate::program::{About, Until};
use fe_core::model::{ContactLaw, Model, PluginLaw};
use fe_core::stepping::{Along, Recorded};
use fe_core::threads::Threads;
use serde::{Deserialize, Serialize};
use std::path::Path;

/// A moment that pictures show.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub enum PictureAt {
    /// As soon as the slip reaches this, mm.
    Slip(f64),
    /// Number of the increment in the run, from 1.
    Increment(u64),
}

/// The axis of a fibre in its block.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FibreAxis {
    /// Its length in the block, mm.
    pub embedded: f64,
    /// Its direction where it leaves the block, unit length.
    pub direction: [f64; 2],
}

/// A run of a specimen.
#[derive(Clone, Debug)]
pub struct PulloutProgram {
    /// Properties that programs of all kinds have.
    pub about: About,
    /// Description of the mesh: "specimen perpendicular_fibre" or "file block.msh".
    pub mesh: String,
    /// Diameter of the round fibre of a specimen that has one, mm.
    pub fibre_diameter: Option<f64>,
    /// Axis of the only fibre.
    pub fibre_axis: Option<FibreAxis>,
    /// The model.
    pub model: Model,
    /// Bounds that end each step of the model early.
    pub step_untils: Vec<Option<Until>>,
    /// Every n-th increment (and the last of each step) is written as fields; `None`: no fields.
    pub fields_every: Option<usize>,
    /// Moments at which fields are kept for pictures, in addition to the greatest load and the end.
    pub pictures_at: Vec<PictureAt>,
    /// The plastic strain beyond which a fibre counts as ruptured.
    pub rupture_strain: f64,
}

/// Settings of a run that are no part of its case.
#[derive(Debug)]
pub struct SpecimenSettings<'a> {
    /// Threads that share the work. No bit of the results depends on it.
    pub threads: Threads,
    /// Folder of the fields that the case asks for, and of checkpoints; `None`: there are none.
    pub folder: Option<&'a Path>,
    /// Checkpoints that are made and gone on from.
    pub checkpoints: &'a Checkpoints,
    /// Whether states that pictures show are kept.
    pub pictures: bool,
    /// Whether the states that the run goes through are kept.
    pub keeps_trail: bool,
    /// The states of a run with nearly the same parameters, along which this one goes.
    pub along: Option<Along>,
}

impl<'a> SpecimenSettings<'a> {
    /// Settings of a run with one thread that keeps what its case asks for.
    pub fn new(program: &PulloutProgram, folder: &'a Path, checkpoints: &'a Checkpoints) -> Self {
        Self {
            threads: Threads::default(),
            folder: Some(folder),
            checkpoints,
            pictures: program.about.plots,
            keeps_trail: false,
            along: None,
        }
    }

    /// The increments that a run repeats: those of the run along which it goes, or of its case.
    pub(super) fn recorded<'s>(&'s self, program: &'s PulloutProgram) -> Option<&'s Recorded> {
        let along = self.along.as_ref().map(|along| &along.trail);
        let along = along.filter(|trail| trail.has_steps_of(&program.model)).map(|trail| &trail.recorded);
        along.or(program.about.recorded.as_deref())
    }
}

impl PulloutProgram {
    /// The history's columns.
    pub fn columns(&self) -> Vec<String> {
        columns::of_specimen(&self.model.measured.fibres)
    }

    /// Returns all laws with the names of their parts or pairs, those of contact first. Pairs with the same law are
    /// joined.
    pub fn laws(&self) -> Vec<(String, &PluginLaw)> {
        let mut laws: Vec<(String, &PluginLaw)> = Vec::new();
        for pair in &self.model.contacts {
            let (ContactLaw::Uinter(law) | ContactLaw::Fric { law, .. }) = &pair.law;
            match laws.iter_mut().find(|(_, other)| other.cmname == law.cmname && other.props == law.props) {
                Some((subject, _)) => *subject = format!("{subject}, {}", pair.name),
                None => laws.push((format!("contact {}", pair.name), law)),
            }
        }
        let parts = self.model.mesh.parts().iter().zip(&self.model.laws);
        laws.extend(parts.map(|(part, law)| (format!("part {}", part.name), law)));
        laws
    }
}
