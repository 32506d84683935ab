//! Contact pairs as a model states them.

use super::PluginLaw;
use crate::mesh::ElementEdge;

/// Two surfaces in contact, with law and enforcement.
#[derive(Clone, Debug)]
pub struct ContactPair {
    /// Name in messages.
    pub name: String,
    /// The surface that carries the contact points: the concrete's hole.
    pub slave: Vec<ElementEdge>,
    /// The surface that they slide on: the fibre. One chain of edges.
    pub master: Vec<ElementEdge>,
    /// The law.
    pub law: ContactLaw,
    /// Rule that places the contact points on the slave edges.
    pub quadrature: Quadrature,
    /// Contact area per length of the slave edge.
    pub width: Width,
    /// The hard normal law's penalty: this times min(E t/h of either body)/(contact width). 100 unless the case says
    /// otherwise.
    pub penalty_factor: f64,
    /// Enforcement of the hard normal law.
    pub enforcement: Enforcement,
    /// Whether a point's contact fades as it passes either end of the master.
    pub release: bool,
    /// Whether the master will bend: its normals are smoothed over all nodes, not only where it is curved at first.
    pub master_bends: bool,
    /// Slip up to which the bond is elastic, mm, which limits increments; 0: the law is asked.
    pub critical_slip: f64,
    /// How the surfaces fit at the start, and are made to.
    pub fit: Fit,
    /// Strength of the slave's surface against crushing; `None`: it carries any pressure.
    pub bearing: Option<Bearing>,
}

/// Crushing strength of a surface that a wire is pressed into. Crushing is permanent, and occurs where the contact
/// pressure exceeds the strength.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Bearing {
    /// The greatest pressure, p_b, MPa.
    pub strength: f64,
    /// Crushed depth at which it is reached, δ_b, mm; 0: at once.
    pub depth: f64,
}

/// Gaps and overlaps of the mesh that are measured as 0, and an overlap that a drive brings about.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Fit {
    /// Gaps and overlaps of points up to this are measured as 0, mm; greater ones are kept, except for the faults of
    /// facets.
    pub closes_within: f64,
    /// The interference.
    pub interference: Option<Interference>,
}

/// An overlap that the surfaces are pressed apart by.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Interference {
    /// Drive that multiplies the overlap.
    pub drive: usize,
    /// At a drive of 1, mm, the same everywhere; `None`: each point's overlap in the mesh, which presses nothing at a drive of 0.
    pub depth: Option<f64>,
}

/// The law that a contact pair follows.
#[derive(Clone, Debug)]
pub enum ContactLaw {
    /// UINTER: the plugin returns the whole traction.
    Uinter(PluginLaw),
    /// FRIC: the plugin returns the tangential traction, the host has the normal law.
    Fric {
        /// The tangential law.
        law: PluginLaw,
        /// The normal law.
        normal: NormalLaw,
    },
}

/// The host's normal laws (`g_N` > 0 open, p > 0 compression).
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum NormalLaw {
    /// Hard, bilateral up to a tension (6.19).
    Hard(HardLaw),
    /// Soft exponential (6.20).
    Soft(SoftLaw),
}

/// p = ε_N (−g_N), in tension not above p_0; unilateral if p_0 = 0.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct HardLaw {
    /// Tension that opens a point for good, MPa.
    pub p_0: f64,
    /// Opening over which the tension falls from p_0 to 0, mm; 0: at once.
    pub delta_n: f64,
}

/// The soft exponential law.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SoftLaw {
    /// Pressure at gap 0, MPa.
    pub p_0: f64,
    /// Gap at which the pressure is 0, mm.
    pub g_0: f64,
}

/// Rule that places the contact points.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Quadrature {
    /// Gauss points of each slave edge (2 by default).
    Gauss {
        /// Points per edge, 1 to 10.
        points: usize,
    },
    /// The slave nodes, with their shape functions' share of the edge (the thesis).
    Nodes,
    /// Gauss points of the segments between slave nodes and projected master nodes: exact on edges that do not match.
    Segments {
        /// Points per segment, 1 to 10.
        points: usize,
    },
}

/// Contact area per length of the slave edge.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Width {
    /// A given width, mm: πφ/2 on each of the two lines of a round fibre.
    Given(f64),
    /// The thickness of the slave's elements; 2πr in axial symmetry.
    OfPart,
}

/// Enforcement of the hard normal law.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Enforcement {
    /// The penalty alone.
    Penalty,
    /// Penalty with Uzawa updates of the multiplier until |g_N| ≤ `tolerance` at closed points.
    Uzawa {
        /// Greatest penetration or gap of a closed point, mm.
        tolerance: f64,
        /// Most updates in an increment.
        max_updates: usize,
    },
    /// One loop with the multiplier of the block −1/ε' condensed locally: stiffness ε_N + ε' ([`crate::contact`]).
    PerturbedLagrangian {
        /// ε'/ε_N, at least 1e4.
        ratio: f64,
    },
}
