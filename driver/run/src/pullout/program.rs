//! Contents of a case of kind "pullout": a model of the FE core, and the output that is written.

use crate::columns;
use crate::program::{About, Until};
use fe_core::model::{ContactLaw, Model, PluginLaw};
use fe_core::stepping::Along;
use fe_core::threads::Threads;
use serde::{Deserialize, Serialize};

/// A moment that pictures show.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub enum PictureAt {
    /// As soon as the slip reaches this, mm.
    Slip(f64),
    /// Number of the increment in the run, from 1.
    Increment(u64),
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
    /// The model.
    pub model: Model,
    /// Bounds that end each step of the model early.
    pub step_untils: Vec<Option<Until>>,
    /// Every n-th increment (and the last of each step) is written as fields; `None`: no fields.
    pub fields_every: Option<usize>,
    /// Moments at which fields are kept for pictures, beside the greatest load and the end.
    pub pictures_at: Vec<PictureAt>,
    /// The plastic strain beyond which a fibre counts as ruptured.
    pub rupture_strain: f64,
    /// Threads that share the work. No bit of the results depends on it.
    pub threads: Threads,
    /// Whether the states that the run goes through are kept.
    pub keeps_trail: bool,
    /// The states of a run with nearly the same parameters, along which this one goes.
    pub along: Option<Along>,
}

impl PulloutProgram {
    /// The history's columns.
    pub fn columns(&self) -> Vec<String> {
        columns::of_specimen(&self.model.measured.fibres)
    }

    /// All laws with what they are of, those of contact first; pairs of the same law stand together.
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
