//! Meshes of specimens and of problems with known solutions, by parameters.
//!
//! [`perpendicular_fibre`] and [`fibres`] make a pull-out specimen with everything that a run must know of it, a
//! [`Specimen`]. The others ([`plate_with_hole`], [`thick_cylinder`], [`cook_membrane`], [`beam`], [`two_blocks`],
//! [`hertz`], [`drag_out_strip`], [`curved_channel`]) make a [`MeshDefinition`] with named sets. Lengths in mm.

mod bodies_in_contact;
mod curved_channel;
mod fibres;
mod one_body;
mod perpendicular_fibre;
mod requirement;
mod thickness;

#[cfg(test)]
mod test;

pub use bodies_in_contact::*;
pub use curved_channel::{CurvedChannel, curved_channel};
pub use fibres::{FINE_DIAMETERS, Fibre, Fibres, FibresMesh, Segment, fibres};
pub use one_body::*;
pub use perpendicular_fibre::{Configuration, FibreMesh, PerpendicularFibre, perpendicular_fibre};
pub use requirement::{ParameterProblem, SpecimenError};
pub use thickness::GradedThickness;

use super::structured::Grading;
use super::{MeshDefinition, Part};
use crate::kinematics::PlaneModel;

/// Two edge sets in contact.
#[derive(Clone, Debug, PartialEq)]
pub struct ContactSurfaces {
    /// Name of the pair in messages.
    pub name: String,
    /// The edge set that carries the contact points: the hole.
    pub slave: String,
    /// The edge set that they slide on: the fibre.
    pub master: String,
    /// Kind of contact.
    pub role: SurfaceRole,
    /// Contact width, mm: πφ/2 on each of the two lines of a round fibre (6.28). `None`: 2πr, in axial symmetry.
    pub width: Option<f64>,
}

/// Bond between two surfaces of a specimen.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SurfaceRole {
    /// Bond.
    Bonded,
    /// Bond with a small tensile capacity: the fibre separates from the matrix at its exit (6.27).
    Separation,
    /// No bond: a rounded edge that the fibre may come to touch.
    Exit,
    /// The end of the hole, on which a fibre that is pushed in comes to bear: no contact unless it is asked for.
    End,
}

/// A node whose displacement follows those of others, in both directions: u = Σ factor · u_node.
#[derive(Clone, Debug, PartialEq)]
pub struct NodeCoupling {
    /// The node that follows.
    pub dependent: usize,
    /// Node and factor.
    pub terms: Vec<(usize, f64)>,
}

/// A pull-out specimen.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Specimen {
    /// The mesh.
    pub definition: MeshDefinition,
    /// The outward normal of the exit face, unit length.
    pub pull_direction: [f64; 2],
    /// The fibres, in the order of the parameters.
    pub fibres: Vec<PulledFibre>,
    /// Pairs of surfaces in contact.
    pub contact_pairs: Vec<ContactSurfaces>,
    /// Nodes that follow others.
    pub couplings: Vec<NodeCoupling>,
    /// Notes on the model for reports: assumptions and their size.
    pub notes: Vec<String>,
}

/// A fibre of a specimen.
#[derive(Clone, Debug, PartialEq)]
pub struct PulledFibre {
    /// Name; `None` of a fibre that is alone.
    pub name: Option<String>,
    /// Index of its part.
    pub part: usize,
    /// Diameter, mm.
    pub diameter: f64,
    /// The direction of its axis where it leaves the block, unit length.
    pub direction: [f64; 2],
    /// Node on its axis at the exit face, before loading.
    pub exit_node: usize,
    /// Node on its axis at its embedded end.
    pub tail_node: usize,
    /// Nodes at the ends of its columns of elements, from the embedded end to the grip: on its left side, on its axis (in the middle or on
    /// the axis of symmetry) and on its right side.
    pub stations: Vec<[usize; 3]>,
    /// Contact surfaces of its embedded end and of the end of its hole.
    pub end: ContactSurfaces,
}

/// Divides a line, which messages call `line`.
fn positions(length: f64, grading: Grading, line: &'static str) -> Result<Vec<f64>, SpecimenError> {
    grading.positions(length).map_err(SpecimenError::along(line))
}

/// Divides a line into equal pieces.
fn uniform(length: f64, count: usize, line: &'static str) -> Result<Vec<f64>, SpecimenError> {
    positions(length, Grading::Uniform { count }, line)
}

/// πφ/2: the width of each of the two lines of contact of a round fibre (6.28), mm.
fn contact_width(diameter: f64) -> f64 {
    0.5 * std::f64::consts::PI * diameter
}

/// A body in plane strain of thickness 1: who knows more of it changes its part.
fn body(name: &str) -> Part {
    Part::new(name, PlaneModel::PlaneStrain, 1.0)
}
