//! The state of a run at the end of an increment, for whoever writes fields.

use super::WireRecord;
use super::newton::Committed;
use crate::assembly::{Equations, Solids};
use crate::contact::Contact;
use crate::model::{Model, Wire, WireSection};

/// Views of everything that is known at the end of an increment.
#[derive(Clone, Copy, Debug)]
pub struct Snapshot<'a> {
    pub(super) model: &'a Model,
    pub(super) solids: &'a Solids,
    pub(super) contact: &'a Contact,
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

    /// The greatest pressure of a contact point, MPa; 0 without contact.
    pub(crate) fn greatest_pressure(&self) -> f64 {
        self.contact.points().map(|point| point.weight * point.pressure).fold(0.0, f64::max)
    }

    /// Returns the greatest axial strain and stress of the sections of a wire, each by itself.
    pub(super) fn wire(&self, wire: &Wire) -> WireRecord {
        let mesh = &self.model.mesh;
        let u = self.displacements();
        let mut greatest = WireRecord::default();
        for WireSection { ends: [a, b], elements } in &wire.sections {
            let along = |moved: f64| {
                let at = |node: usize, k: usize| mesh.nodes()[node][k] + moved * u[2 * node + k];
                [at(*b, 0) - at(*a, 0), at(*b, 1) - at(*a, 1)]
            };
            let [before, after] = [along(0.0), along(1.0)];
            let [length, stretched] = [before, after].map(|[x, y]: [f64; 2]| x.hypot(y));
            let [x, y] = after.map(|x| x / stretched);
            let points = elements.iter().flat_map(|&element| {
                (0..self.solids.point_count(element)).map(move |point| self.solids.point(element, point))
            });
            let (mut force, mut volume) = (0.0, 0.0);
            for point in points {
                let [s11, s22, _, s12] = point.stress;
                force += point.volume * (s11 * x * x + s22 * y * y + 2.0 * s12 * x * y);
                volume += point.volume;
            }
            let strain = stretched / length - 1.0;
            // metal keeps its volume where it matters
            let stress = if volume > 0.0 { force / volume / (1.0 + strain) } else { 0.0 };
            greatest = WireRecord { strain: greatest.strain.max(strain), stress: greatest.stress.max(stress) };
        }
        greatest
    }

    /// Displacement of a node along a direction, mm.
    pub fn displacement_of(&self, node: usize, direction: [f64; 2]) -> f64 {
        let u = &self.committed.displacements;
        u[2 * node] * direction[0] + u[2 * node + 1] * direction[1]
    }
}
