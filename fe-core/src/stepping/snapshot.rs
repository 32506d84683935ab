//! The state of a run at the end of an increment, for code that writes fields.

use super::newton::Committed;
use crate::assembly::{Equations, Solids};
use crate::contact::Contact;
use crate::field::Field;
use crate::model::Model;

/// Views of everything that is known at the end of an increment.
#[derive(Clone, Copy, Debug)]
pub struct Snapshot<'a> {
    pub(super) model: &'a Model,
    pub(super) solids: &'a Solids,
    pub(super) contact: &'a Contact,
    pub(super) field: Option<&'a Field>,
    pub(super) equations: &'a Equations,
    pub(super) committed: &'a Committed,
    pub(super) time: f64,
}

impl<'a> Snapshot<'a> {
    /// The model.
    pub fn model(&self) -> &'a Model {
        self.model
    }

    /// Total time, s.
    pub fn time(&self) -> f64 {
        self.time
    }

    /// Displacements, two per node, mm.
    pub fn displacements(&self) -> &'a [f64] {
        &self.committed.displacements
    }

    /// Values of the drives.
    pub fn drives(&self) -> &'a [f64] {
        &self.committed.drives
    }

    /// Forces of the supports on the body, two per node, N; forces on coupled freedoms are handed to what they follow.
    pub fn reactions(&self) -> Vec<f64> {
        let mut forces = self.committed.reactions.clone();
        self.equations.transfer_coupled_forces(&mut forces);
        forces
    }

    /// The force of a support along a direction, N.
    pub fn reaction_of(&self, support: usize, direction: [f64; 2]) -> f64 {
        let forces = self.reactions();
        let nodes = &self.model.supports[support].nodes;
        nodes.iter().map(|node| forces[2 * node] * direction[0] + forces[2 * node + 1] * direction[1]).sum()
    }

    /// Material points.
    pub fn solids(&self) -> &'a Solids {
        self.solids
    }

    /// Contact points.
    pub fn contact(&self) -> &'a Contact {
        self.contact
    }

    /// The scalar field, one value per node, NaN where it has none; `None` without a field.
    pub fn field(&self) -> Option<Vec<f64>> {
        self.field.map(Field::values)
    }

    /// The greatest pressure of a contact point, MPa; 0 without contact.
    pub(crate) fn greatest_pressure(&self) -> f64 {
        self.contact.points().map(|point| point.weight * point.pressure).fold(0.0, f64::max)
    }

    /// Displacement of a node along a direction, mm.
    pub fn displacement_of(&self, node: usize, direction: [f64; 2]) -> f64 {
        let u = &self.committed.displacements;
        u[2 * node] * direction[0] + u[2 * node + 1] * direction[1]
    }
}
