//! What a case of kind "pullout" asks for: a model of the FE core, and what is to be written.

use crate::columns;
use crate::program::{Compare, Until};
use fe_core::model::{ContactLaw, Model, PluginLaw};
use fe_core::threads::Threads;
use std::path::PathBuf;

/// Everything a run needs.
#[derive(Clone, Debug)]
pub struct Program {
    /// The case file, for messages.
    pub case_file: PathBuf,
    /// The case's title.
    pub title: String,
    /// The case's description, for the report.
    pub description: String,
    /// What the mesh is: "specimen perpendicular_fibre" or "file block.msh".
    pub mesh: String,
    /// Diameter of the round fibre of a specimen that has one, mm.
    pub fibre_diameter: Option<f64>,
    /// What is computed.
    pub model: Model,
    /// What ends each step of the model early.
    pub step_untils: Vec<Option<Until>>,
    /// Stops the run early, after any increment of any step.
    pub until: Option<Until>,
    /// What is written.
    pub output: Output,
    /// Curves to compare with.
    pub compare: Vec<Compare>,
    /// Things the user should know although nothing is wrong.
    pub warnings: Vec<String>,
    /// What the case leaves to defaults, a line for each place.
    pub defaults: Vec<String>,
    /// Threads that share the work. No bit of the results depends on it.
    pub threads: Threads,
}

/// What is written.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Output {
    /// Every n-th increment (and the last of each step and of the run) goes to the history.
    pub every: usize,
    /// Draw plots.
    pub plots: bool,
    /// Every n-th increment (and the last of each step) is written as fields; `None`: no fields.
    pub fields_every: Option<usize>,
}

impl Program {
    /// The history's columns.
    pub fn columns(&self) -> Vec<String> {
        columns::of_specimen()
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
