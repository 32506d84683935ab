//! Grip, supports, loads, couplings.

use schemars::JsonSchema;
use serde::Deserialize;
use std::collections::BTreeMap;

/// Along an axis, or anywhere.
#[derive(Clone, Copy, Debug, Deserialize, JsonSchema)]
#[serde(untagged)]
pub(crate) enum Direction {
    /// "x" or "y" (r or z in axial symmetry).
    Axis(Axis),
    /// A vector of any length > 0.
    Vector([f64; 2]),
}

/// A coordinate axis.
#[derive(Clone, Copy, Debug, Deserialize, JsonSchema, PartialEq, Eq)]
#[serde(rename_all = "lowercase")]
pub(crate) enum Axis {
    /// First; r in axial symmetry.
    X,
    /// Second; z in axial symmetry.
    Y,
}

/// Nodes that are pulled: displaced by the drive "slip".
#[derive(Clone, Debug, Default, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(crate) struct Grip {
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
pub(crate) enum Lateral {
    /// Held.
    Fixed,
    /// Free to move.
    Free,
}

/// Supports of the specimen.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(untagged)]
pub(crate) enum Supports {
    /// Name of one of the specimen's support conditions.
    Named(String),
    /// Supports by name.
    Given(BTreeMap<String, Support>),
}

/// Nodes held, or moved by a drive.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(crate) struct Support {
    /// Node set; default: the set with the support's name. Every part has a node set of its own name.
    pub nodes: Option<String>,
    /// Direction in which the nodes are held; default: both.
    pub direction: Option<SupportDirection>,
    /// Drive whose value is the displacement along the direction, mm; default: the nodes are held.
    pub drive: Option<String>,
}

/// A direction of a support.
#[derive(Clone, Copy, Debug, Deserialize, JsonSchema)]
#[serde(untagged)]
pub(crate) enum SupportDirection {
    /// "both".
    Both(Both),
    /// One.
    One(Direction),
}

/// The word "both".
#[derive(Clone, Copy, Debug, Deserialize, JsonSchema)]
#[serde(rename_all = "lowercase")]
pub(crate) enum Both {
    /// x and y.
    Both,
}

/// A load at a drive of 1: exactly one of force, traction and pressure.
#[derive(Clone, Debug, Default, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(crate) struct Load {
    /// Node set of a force; default: the set with the load's name.
    pub nodes: Option<String>,
    /// Edge set of a traction or pressure; default: the set with the load's name.
    pub edges: Option<String>,
    /// Force at each node, N; in axial symmetry, the force on the node's full circle.
    pub force: Option<[f64; 2]>,
    /// Traction, MPa.
    pub traction: Option<[f64; 2]>,
    /// Pressure on the body, MPa. It follows the edge under large displacements.
    pub pressure: Option<f64>,
    /// Drive that multiplies the load; default: the drive with the load's name.
    pub drive: Option<String>,
}

/// A constraint between nodes.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(untagged)]
pub(crate) enum Coupling {
    /// Nodes of a set move with adjacent edges.
    Tie(Tie),
    /// One displacement as a sum of others: u = Σ factor · u.
    Terms(Terms),
}

/// Nodes that move with adjacent edges.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(crate) struct Tie {
    /// Node set that is tied. It must be the finer side, otherwise stresses are wrong.
    pub tie: String,
    /// Edge set that the nodes are tied to.
    pub to: String,
}

/// One displacement as a sum of others: u = Σ factor · u.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(crate) struct Terms {
    /// The dependent displacement.
    pub dependent: FreedomOf,
    /// The displacements it depends on, with their factors.
    #[schemars(length(min = 1))]
    pub terms: Vec<Term>,
}

/// A displacement of a node.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(crate) struct FreedomOf {
    /// The node.
    pub node: NodeReference,
    /// Axis of the displacement.
    pub component: Axis,
}

/// A displacement of a node and its factor.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(crate) struct Term {
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
pub(crate) enum NodeReference {
    /// A node set of one node.
    Set(String),
    /// The node at this position, mm.
    Position([f64; 2]),
}

/// What the history columns slip and load measure.
#[derive(Clone, Debug, Default, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(crate) struct Measure {
    /// Drive whose value is the slip; default: "slip".
    pub slip: Option<String>,
    /// Support whose reaction is the load; default: the grip. Without either, the load is nan.
    pub load: Option<String>,
    /// Pull direction; default: that of the support named as load if it has only one, else the grip's.
    pub direction: Option<Direction>,
    /// Node of slip_exit.
    pub exit: Option<NodeReference>,
    /// Node of slip_tail.
    pub tail: Option<NodeReference>,
}
