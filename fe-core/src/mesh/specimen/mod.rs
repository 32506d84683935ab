//! Meshes of specimens and of problems with known solutions, by parameters.
//!
//! [`perpendicular_fibre`] and [`inclined_fibre`] make a pull-out specimen with everything that a run must know of it, a
//! [`Specimen`]. The others ([`plate_with_hole`], [`thick_cylinder`], [`cook_membrane`], [`timoshenko_beam`], [`two_blocks`],
//! [`cylinder_on_plane`], [`drag_out_strip`], [`curved_channel`]) make a [`MeshDefinition`] with named sets. Lengths in mm.

mod bodies_in_contact;
mod curved_channel;
mod inclined_fibre;
mod one_body;
mod perpendicular_fibre;
mod requirement;
mod thickness;

#[cfg(test)]
mod test;

pub use bodies_in_contact::{CylinderOnPlane, DragOutStrip, TwoBlocks, cylinder_on_plane, drag_out_strip, two_blocks};
pub use curved_channel::{CurvedChannel, curved_channel};
pub use inclined_fibre::{FINE_DIAMETERS, InclinedFibre, InclinedMesh, Outside, inclined_fibre};
pub use one_body::{
    CylinderSection, PlateWithHole, ThickCylinder, TimoshenkoBeam, cook_membrane, plate_with_hole, thick_cylinder,
    timoshenko_beam,
};
pub use perpendicular_fibre::{
    AWAY_LENGTH, Configuration, FibreMesh, FibreSection, NEAR_CLEARANCE, PartMesh, PerpendicularFibre,
    perpendicular_fibre,
};
pub use requirement::{ParameterProblem, SpecimenError};
pub use thickness::GradedThickness;

use super::{MeshDefinition, Part};
use crate::element::{ElementKind, Integration};
use crate::kinematics::PlaneModel;

/// Two edge sets in contact.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct ContactSurfaces {
    /// What messages call the pair.
    pub name: String,
    /// The edge set that carries the contact points: the hole.
    pub slave: String,
    /// The edge set that they slide on: the fibre.
    pub master: String,
    /// What kind of contact it is.
    pub role: SurfaceRole,
}

/// What holds two surfaces of a specimen together.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SurfaceRole {
    /// Bond.
    Bonded,
    /// Bond with a small tensile capacity: the fibre separates from the matrix at its exit (6.27).
    Separation,
    /// Nothing: a rounded edge that the fibre may come to touch.
    Exit,
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
#[derive(Clone, Debug, PartialEq)]
pub struct Specimen {
    /// The mesh.
    pub definition: MeshDefinition,
    /// The outward normal of the exit face, unit length.
    pub pull_direction: [f64; 2],
    /// The direction of the embedded fibre towards its exit, unit length.
    pub fibre_direction: [f64; 2],
    /// What is in contact with what.
    pub contact_pairs: Vec<ContactSurfaces>,
    /// Contact width of each pair, mm: πφ/2 on each of the two lines of a round fibre (6.28). `None`: 2πr, in axial
    /// symmetry.
    pub contact_width: Option<f64>,
    /// The fibre's node on its axis at the exit face, before loading.
    pub exit_node: usize,
    /// The fibre's node on its axis at its embedded end.
    pub tail_node: usize,
    /// Nodes that follow others.
    pub couplings: Vec<NodeCoupling>,
    /// What a report must say about the model: assumptions and their size.
    pub notes: Vec<String>,
}

/// Elements, model and thickness of a body.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BodyChoice {
    /// The kind of its elements.
    pub kind: ElementKind,
    /// What it assumes about the third direction.
    pub model: PlaneModel,
    /// Thickness, mm; unused in axial symmetry.
    pub thickness: f64,
    /// The integration of its elements; `None`: the kind's default.
    pub integration: Option<Integration>,
}

impl BodyChoice {
    /// With the kind's default integration.
    pub fn new(kind: ElementKind, model: PlaneModel, thickness: f64) -> Self {
        Self { kind, model, thickness, integration: None }
    }

    fn part(self, name: &str) -> Part {
        Part { integration: self.integration, ..Part::new(name, self.model, self.thickness) }
    }
}
