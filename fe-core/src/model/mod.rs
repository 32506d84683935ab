//! Model of an analysis: a mesh with laws, contact pairs, supports, loads and steps.
//!
//! A [`Model`] is data. A case file or a test fills these structs; [`crate::stepping::Analysis`] checks them together
//! and runs them.
//!
//! # Drives
//!
//! Everything that changes in time follows a *drive*: a named number, 0 at the start, that goes linearly to a target in
//! each [`Step`]. A support moves by it (mm along the support's direction), a load is multiplied by it. A test that
//! pulls a grip has one drive, the displacement of the grip; drag-out under pressure has two.

mod contact;
mod controls;
mod fields;
mod law;
mod scalar_field;

pub use contact::{
    Bearing, ContactLaw, ContactPair, Enforcement, Fit, HardLaw, Interference, NormalLaw, Quadrature, SoftLaw, Width,
};
pub use controls::{Controls, IncrementContext, Skipping, Spalling, Step, StepControl};
pub use fields::{FieldValues, Fields};
pub use law::PluginLaw;
pub use scalar_field::{CrackSurface, FieldCoupling, FieldKind, FixedValue, Flux, HeatTransfer, ScalarField};

use crate::mesh::specimen::PulledFibre;
use crate::mesh::{ElementEdge, Mesh};
use std::fmt::Display;
use umat_abi::host::Library;

/// A degree of freedom: the displacement of a node along x (0) or y (1); r and z in axial symmetry.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct Freedom {
    /// Index of the node.
    pub node: usize,
    /// 0 or 1.
    pub component: usize,
}

impl Freedom {
    /// Returns the place in vectors of displacements and forces: two per node.
    pub const fn index(self) -> usize {
        2 * self.node + self.component
    }
}

/// Nodes held, or moved, along one direction.
#[derive(Clone, Debug, PartialEq)]
pub struct Support {
    /// Name in messages and of its reaction.
    pub name: String,
    /// Nodes.
    pub nodes: Vec<usize>,
    /// The direction in which they are held, of any length > 0: not along an axis, a roller in rotated axes.
    pub direction: [f64; 2],
    /// The drive whose value is the displacement along `direction`, mm; `None`: held where it is.
    pub drive: Option<usize>,
}

/// u_dependent = Σ coefficient · u_i: a multi-point constraint.
#[derive(Clone, Debug, PartialEq)]
pub struct Coupling {
    /// The freedom that is eliminated.
    pub dependent: Freedom,
    /// Freedoms that it follows, with coefficients.
    pub terms: Vec<(Freedom, f64)>,
}

impl Coupling {
    /// Returns the nodes that it joins, the dependent one first.
    pub fn nodes(&self) -> impl Iterator<Item = usize> {
        std::iter::once(self.dependent.node).chain(self.terms.iter().map(|(freedom, _)| freedom.node))
    }
}

/// A load: a drive's value times this.
#[derive(Clone, Debug, PartialEq)]
pub struct Load {
    /// Name in messages.
    pub name: String,
    /// Drive that multiplies the load.
    pub drive: usize,
    /// Kind and place, and size at a drive of 1.
    pub kind: LoadKind,
}

/// Kinds of loads.
#[derive(Clone, Debug, PartialEq)]
pub enum LoadKind {
    /// A force at each of these nodes, N; direction fixed.
    Force {
        /// Nodes.
        nodes: Vec<usize>,
        /// Force on each, N (in axial symmetry on its whole circle).
        force: [f64; 2],
    },
    /// A traction per reference area, MPa; direction and area fixed.
    Traction {
        /// Edges.
        edges: Vec<ElementEdge>,
        /// Traction, MPa.
        traction: [f64; 2],
    },
    /// A pressure against the body, MPa; under large displacements it follows the edge.
    Pressure {
        /// Edges.
        edges: Vec<ElementEdge>,
        /// Pressure, MPa.
        pressure: f64,
    },
}

/// Definition of slip and load in the history.
#[derive(Clone, Debug, PartialEq)]
pub struct Measured {
    /// The drives whose mean is the `slip` of the history; none: 0.
    pub slip: Vec<usize>,
    /// Indices of the supports whose reactions together are the `load`.
    pub supports: Vec<usize>,
    /// The pull direction, unit length: `load` is the reaction along it, `load_lateral` that along its left normal.
    pub direction: [f64; 2],
    /// The direction of the embedded fibre towards its exit, unit length: of the axial and the shear component of the
    /// load, and of the slips of its nodes; `None`: the pull direction.
    pub axis: Option<[f64; 2]>,
    /// The node whose displacement along the axis is `slip_exit`.
    pub exit_node: Option<usize>,
    /// The node whose displacement along the axis is `slip_tail`.
    pub tail_node: Option<usize>,
    /// Index of the fibre's part.
    pub part: Option<usize>,
    /// The lines along which fibres are bonded: indices of the contact pairs that each consists of.
    pub interface_lines: Vec<Vec<usize>>,
    /// Each of several fibres; empty for a single one, to which the fields above apply.
    pub fibres: Vec<MeasuredFibre>,
    /// The wires of the fibres, in their order; one of a fibre that is alone.
    pub wires: Vec<Wire>,
    /// A bearing pressure t_N/(φ L) over the contact pressure: π/2 for a round fibre of which each line has half the
    /// circumference, 1 else.
    pub bearing_factor: f64,
}

/// The wire of a fibre: its sections, and what they carry along the axis. Bending does not rupture a wire: it breaks by
/// the mean stress of a section, or by its elongation without bending over a gauge length.
#[derive(Clone, Debug, PartialEq)]
pub struct Wire {
    /// Sections from the embedded end to the grip.
    pub sections: Vec<WireSection>,
    /// Tensile strength, the greatest force over the initial area, MPa; `None`: not given.
    pub strength: Option<f64>,
    /// Axial strain over the gauge length at which it breaks; `None`: not given.
    pub elongation: Option<f64>,
    /// Gauge length, mm.
    pub gauge: f64,
}

/// A section of a wire: a column of elements across it.
#[derive(Clone, Debug, PartialEq)]
pub struct WireSection {
    /// Nodes at its ends, each on the left side, on the axis and on the right side.
    pub ends: [[usize; 3]; 2],
    /// Elements.
    pub elements: Vec<usize>,
}

impl Wire {
    /// Gauge length of elongations, in diameters: that of tests of wires and bars.
    const GAUGE: f64 = 5.0;

    /// Divides the elements of a fibre among the pieces between its stations, each to the nearest one.
    pub fn new(mesh: &Mesh, fibre: &PulledFibre) -> Self {
        let pieces =
            fibre.stations.windows(2).map(|ends| WireSection { ends: [ends[0], ends[1]], elements: Vec::new() });
        let mut sections: Vec<WireSection> = pieces.collect();
        let middle = |nodes: &[usize]| {
            let sum = nodes.iter().fold([0.0; 2], |[x, y], &node| {
                let [u, v] = mesh.nodes()[node];
                [x + u, y + v]
            });
            sum.map(|sum| sum / nodes.len() as f64)
        };
        let middles: Vec<[f64; 2]> = sections.iter().map(|section| middle(section.ends.as_flattened())).collect();
        for (index, element) in mesh.elements().iter().enumerate().filter(|(_, element)| element.part() == fibre.part) {
            let at = middle(element.nodes());
            let distance = |k: &usize| crate::plane::distance(middles[*k], at);
            if let Some(nearest) = (0..sections.len()).min_by(|a, b| distance(a).total_cmp(&distance(b))) {
                sections[nearest].elements.push(index);
            }
        }
        Self { sections, strength: None, elongation: None, gauge: Self::GAUGE * fibre.diameter }
    }

    /// Returns whether the wire can break.
    pub fn has_limits(&self) -> bool {
        self.strength.is_some() || self.elongation.is_some()
    }

    /// Returns the strain and the stress, of the initial area, of a section as parts of those at which it breaks: the greater one. 0: the
    /// wire cannot break.
    pub fn utilisation(&self, strain: f64, stress: f64) -> f64 {
        let part = |value: f64, limit: Option<f64>| limit.map_or(0.0, |limit| value / limit);
        part(strain, self.elongation).max(part(stress, self.strength))
    }

    /// Returns whether a section with this strain and this stress, of the initial area, has broken.
    pub fn breaks(&self, strain: f64, stress: f64) -> bool {
        self.utilisation(strain, stress) >= 1.0
    }
}

/// Quantities that are measured of one of several fibres.
#[derive(Clone, Debug, PartialEq)]
pub struct MeasuredFibre {
    /// Name.
    pub name: String,
    /// The drive that pulls it.
    pub slip: usize,
    /// Index of the support whose reaction is its load.
    pub support: usize,
    /// The direction of its axis where it leaves the block, unit length.
    pub axis: [f64; 2],
    /// The node whose displacement along the axis is its `slip_exit`.
    pub exit_node: usize,
    /// The node whose displacement along the axis is its `slip_tail`.
    pub tail_node: usize,
    /// Index of its part.
    pub part: Option<usize>,
    /// Lines of bond among [`Measured::interface_lines`].
    pub lines: Vec<usize>,
}

/// A pull whose direction is so near to the fibre's axis (sine of the angle between them) is along it.
const ALONG_AXIS: f64 = 1e-9;

impl Measured {
    /// The measured slip among the values of the drives, mm.
    pub fn slip_of(&self, drives: &[f64]) -> f64 {
        let sum: f64 = self.slip.iter().map(|&drive| drives[drive]).sum();
        if self.slip.is_empty() { 0.0 } else { sum / self.slip.len() as f64 }
    }

    /// Directions of the axial component of the load and of the shear component, which is positive where the fibre is
    /// bent towards the pull direction, or to its left if it is pulled along its axis (7.2: P_f and P_b).
    pub fn components(&self) -> [[f64; 2]; 2] {
        self.components_along(self.axis.unwrap_or(self.direction))
    }

    /// Returns the directions of [`Self::components`] for an axis of this direction.
    pub(crate) fn components_along(&self, [x, y]: [f64; 2]) -> [[f64; 2]; 2] {
        let left = [-y, x];
        let towards_pull = left[0] * self.direction[0] + left[1] * self.direction[1] > -ALONG_AXIS;
        [[x, y], if towards_pull { left } else { [y, -x] }]
    }
}

impl Default for Measured {
    fn default() -> Self {
        Self {
            slip: Vec::new(),
            supports: Vec::new(),
            direction: [0.0, 1.0],
            axis: None,
            exit_node: None,
            tail_node: None,
            part: None,
            interface_lines: Vec::new(),
            fibres: Vec::new(),
            wires: Vec::new(),
            bearing_factor: 1.0,
        }
    }
}

/// Everything that a computation needs.
#[derive(Clone, Debug)]
pub struct Model {
    /// The mesh.
    pub mesh: Mesh,
    /// The law of each part.
    pub laws: Vec<PluginLaw>,
    /// Whether nearly incompressible Q4 are averaged, of each part ([`crate::kinematics`]).
    pub average_dilatation: Vec<bool>,
    /// Contact pairs.
    pub contacts: Vec<ContactPair>,
    /// Names of the drives.
    pub drives: Vec<String>,
    /// Values of the drives at the start; empty: all 0. Initial stresses are in equilibrium with them.
    pub initial_drives: Vec<f64>,
    /// Supports.
    pub supports: Vec<Support>,
    /// Multi-point constraints.
    pub couplings: Vec<Coupling>,
    /// Loads.
    pub loads: Vec<Load>,
    /// Large displacements of each part: updated Lagrangian, `DROT`. Contact is on the deformed surfaces and slides far
    /// either way.
    pub nlgeom: Vec<bool>,
    /// Definition of slip and load in the history.
    pub measured: Measured,
    /// Temperature and field variables.
    pub fields: Fields,
    /// A scalar per node that laws are given as temperature; `None`: temperature is that of `fields`.
    pub field: Option<ScalarField>,
    /// Steps, in order.
    pub steps: Vec<Step>,
    /// Tolerances and limits.
    pub controls: Controls,
    /// Computations that may be skipped.
    pub skipping: Skipping,
}

impl Model {
    /// Returns whether any part has large displacements.
    pub fn has_large_displacements(&self) -> bool {
        self.nlgeom.contains(&true)
    }

    /// Returns whether only drives do work: no temperature, field variable or free strain changes; a phase field has no energy of its own. What these do to a material is no
    /// work of the drives.
    pub fn is_driven_alone(&self) -> bool {
        let shrinks = |law: &PluginLaw| law.frame.as_ref().is_some_and(|frame| frame.shrinkage.is_some());
        let has_heat = self.field.as_ref().is_some_and(|field| !field.is_phase_field());
        !self.fields.change() && !has_heat && !self.laws.iter().any(shrinks)
    }

    /// Returns whether any part starts from a stress.
    pub fn has_initial_stress(&self) -> bool {
        let model = |part: usize| self.mesh.parts()[part].model;
        self.laws.iter().enumerate().any(|(part, law)| !law.initial_stresses(model(part)).are_zero())
    }

    /// Returns whether a law extrapolates: its increments take time, however far they lead.
    pub fn extrapolates(&self) -> bool {
        self.laws.iter().any(|law| law.overstress_work().is_some())
    }

    /// The parts across slave edges from those edges' own: what slides there does so in front of them. A cover is one.
    pub fn parts_behind(&self) -> Vec<usize> {
        let part_of = |edge: ElementEdge| self.mesh.elements()[edge.element].part();
        let slaves = self.contacts.iter().flat_map(|pair| &pair.slave);
        let across = slaves.filter_map(|&edge| {
            let other = part_of(self.mesh.neighbour(edge)?);
            (other != part_of(edge)).then_some(other)
        });
        std::collections::BTreeSet::from_iter(across).into_iter().collect()
    }

    /// The libraries of its laws, parts first; some may be named several times.
    pub fn libraries(&self) -> impl Iterator<Item = &Library> {
        let of_contact = self.contacts.iter().map(|pair| match &pair.law {
            ContactLaw::Uinter(law) | ContactLaw::Fric { law, .. } => law,
        });
        self.laws.iter().chain(of_contact).map(|law| &law.library)
    }
}

/// Message why a model cannot be computed. Points, nodes and elements are counted from 1.
#[derive(Debug, thiserror::Error)]
#[error("{0}")]
pub struct ModelError(pub(crate) String);

impl ModelError {
    /// A fault of a part.
    pub(crate) fn of_part(part: &str, reason: impl Display) -> Self {
        Self(format!("part '{part}': {reason}"))
    }

    /// A fault of a contact pair.
    pub(crate) fn of_pair(pair: &str, reason: impl Display) -> Self {
        Self(format!("contact '{pair}': {reason}"))
    }
}
