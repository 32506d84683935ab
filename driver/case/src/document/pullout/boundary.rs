//! Grip, supports, loads, couplings.

use schemars::JsonSchema;
use serde::Deserialize;
use std::collections::BTreeMap;

/// Along an axis, or anywhere.
#[derive(Clone, Copy, Debug, Deserialize, JsonSchema)]
#[serde(untagged)]
pub enum Direction {
    /// "x" or "y" (r or z in axial symmetry).
    Axis(Axis),
    /// A vector of any length > 0.
    Vector([f64; 2]),
}

/// A coordinate axis.
#[derive(Clone, Copy, Debug, Deserialize, JsonSchema, PartialEq, Eq)]
#[serde(rename_all = "lowercase")]
pub enum Axis {
    /// First; r in axial symmetry.
    X,
    /// Second; z in axial symmetry.
    Y,
}

/// Nodes that are pulled: displaced by the drive "slip".
#[derive(Clone, Debug, Default, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Grip {
    /// Node set; default: the specimen's.
    pub nodes: Option<String>,
    /// Pull direction; default: the specimen's.
    pub direction: Option<Direction>,
    /// Across the pull direction (default fixed).
    pub lateral: Option<Lateral>,
}

/// Condition of the grip across the pull direction.
#[derive(Clone, Copy, Debug, Deserialize, JsonSchema, PartialEq, Eq)]
#[serde(rename_all = "lowercase")]
pub enum Lateral {
    /// Held.
    Fixed,
    /// Free to move.
    Free,
}

/// Supports of the specimen.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(untagged)]
pub enum Supports {
    /// Name of one of the specimen's ways.
    Named(String),
    /// Supports by name.
    Given(BTreeMap<String, Support>),
}

/// Nodes held, or moved by a drive.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Support {
    /// Node set; default: the one called like the support. The nodes of a part are a set of its name.
    pub nodes: Option<String>,
    /// Direction in which they are held; default: both.
    pub direction: Option<SupportDirection>,
    /// The drive whose value is the displacement along the direction, mm; default: held.
    pub drive: Option<String>,
}

/// A direction of a support.
#[derive(Clone, Copy, Debug, Deserialize, JsonSchema)]
#[serde(untagged)]
pub enum SupportDirection {
    /// "both".
    Both(Both),
    /// One.
    One(Direction),
}

/// The word "both".
#[derive(Clone, Copy, Debug, Deserialize, JsonSchema)]
#[serde(rename_all = "lowercase")]
pub enum Both {
    /// x and y.
    Both,
}

/// A load at a drive of 1: exactly one of force, traction and pressure.
#[derive(Clone, Debug, Default, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Load {
    /// Node set of a force; default: the one called like the load.
    pub nodes: Option<String>,
    /// Edge set of a traction or pressure; default: the one called like the load.
    pub edges: Option<String>,
    /// Force at each node, N; in axial symmetry on its whole circle.
    pub force: Option<[f64; 2]>,
    /// Traction, MPa.
    pub traction: Option<[f64; 2]>,
    /// Pressure against the body, MPa; follows the edge under large displacements.
    pub pressure: Option<f64>,
    /// The drive that multiplies it; default: one called like the load.
    pub drive: Option<String>,
}

/// A constraint between nodes.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(untagged)]
pub enum Coupling {
    /// Nodes of a set move with the edges beside them.
    Tie(Tie),
    /// u of a freedom = Σ factor · u of others.
    Terms(Terms),
}

/// Nodes that move with edges beside them.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Tie {
    /// Node set that is tied, of the finer side: where it is the coarser one, stresses are wrong.
    pub tie: String,
    /// Edge set that it is tied to.
    pub to: String,
}

/// u of a freedom = Σ factor · u of others.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Terms {
    /// The freedom that follows.
    pub dependent: FreedomOf,
    /// Displacements that it follows.
    #[schemars(length(min = 1))]
    pub terms: Vec<Term>,
}

/// A displacement of a node.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct FreedomOf {
    /// The node.
    pub node: NodeReference,
    /// Axis of the displacement.
    pub component: Axis,
}

/// A displacement of a node and its factor.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Term {
    /// The node.
    pub node: NodeReference,
    /// Axis of the displacement.
    pub component: Axis,
    /// Factor (default 1).
    pub factor: Option<f64>,
}

/// A node.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(untagged)]
pub enum NodeReference {
    /// A node set of one node.
    Set(String),
    /// The node at this position, mm.
    Position([f64; 2]),
}

/// Quantities that the history calls slip and load.
#[derive(Clone, Debug, Default, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Measure {
    /// Drive that is the slip; default: "slip".
    pub slip: Option<String>,
    /// Support whose reaction is the load; default: the grip. Without either the load is nan.
    pub load: Option<String>,
    /// Pull direction; default: that of the support named as load if it has only one, else the grip's.
    pub direction: Option<Direction>,
    /// Node of slip_exit.
    pub exit: Option<NodeReference>,
    /// Node of slip_tail.
    pub tail: Option<NodeReference>,
}
