//! Contact pairs as a model states them.

use super::PluginLaw;
use crate::mesh::ElementEdge;
use crate::schema::{positive, whole};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

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
#[derive(Clone, Copy, Debug, PartialEq, Deserialize, Serialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum NormalLaw {
    /// Penalty, bilateral up to a tension.
    // (6.19)
    Hard(HardLaw),
    /// Soft exponential.
    // (6.20)
    Soft(SoftLaw),
}

/// Penalty, bilateral up to a tension.
// p = ε_N (−g_N), in tension not above p_0
#[derive(Clone, Copy, Debug, Default, PartialEq, Deserialize, Serialize, JsonSchema)]
#[serde(default, deny_unknown_fields)]
pub struct HardLaw {
    /// Tension that opens a point for good, MPa. 0 is unilateral.
    #[schemars(range(min = 0.0))]
    pub p_0: f64,
    /// Opening over which the tension falls to 0, mm. At 0 it falls at once.
    #[serde(rename = "delta_N")]
    #[schemars(range(min = 0.0))]
    pub delta_n: f64,
}

/// Soft exponential.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize, Serialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct SoftLaw {
    /// Pressure at gap 0, MPa.
    #[schemars(schema_with = "positive")]
    pub p_0: f64,
    /// Gap at which the pressure is 0, mm.
    #[schemars(schema_with = "positive")]
    pub g_0: f64,
}

/// Position of the contact points.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize, Serialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Quadrature {
    /// The slave nodes.
    // with their shape functions' share of the edge (the thesis)
    Nodes,
    /// Number of Gauss points on each slave edge.
    Gauss(#[schemars(schema_with = "whole::<1, 10>")] usize),
    /// Number of Gauss points on each segment between slave nodes and projected master nodes.
    // exact on edges that do not match
    Segments(#[schemars(schema_with = "whole::<1, 10>")] usize),
}

impl Default for Quadrature {
    fn default() -> Self {
        Self::Gauss(2)
    }
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
#[derive(Clone, Copy, Debug, PartialEq, Deserialize, Serialize, JsonSchema)]
#[serde(rename_all = "snake_case", deny_unknown_fields)]
pub enum Enforcement {
    /// The penalty alone.
    Penalty,
    /// Penalty with multiplier updates.
    Uzawa {
        /// Largest gap or penetration of a closed point, mm.
        #[serde(default = "usual_tolerance")]
        #[schemars(schema_with = "positive")]
        tolerance: f64,
        /// Largest number of updates in an increment.
        #[serde(default = "usual_updates")]
        #[schemars(schema_with = "whole::<1, 100>")]
        max_updates: usize,
    },
    /// Multiplier condensed locally, in one loop. For comparisons only: where points open and close it is 10 to 300
    /// times slower than uzawa, and at ratios of 30 000 and more it often does not end.
    // with the block −1/ε' of the multiplier: stiffness ε_N + ε' (crate::contact)
    PerturbedLagrangian {
        /// Stiffness of the multiplier over the penalty.
        #[serde(default = "usual_ratio")]
        #[schemars(range(min = 1e4))]
        ratio: f64,
    },
}

impl Default for Enforcement {
    fn default() -> Self {
        Self::Uzawa { tolerance: usual_tolerance(), max_updates: usual_updates() }
    }
}

fn usual_tolerance() -> f64 {
    1e-6
}

fn usual_updates() -> usize {
    4
}

fn usual_ratio() -> f64 {
    1e4
}
