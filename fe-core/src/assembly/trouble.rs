//! Reasons why an attempt of an increment cannot go on, and their locations.

use serde::{Deserialize, Serialize};
use std::fmt;

/// Location in a model where an attempt failed; indices from 0, shown and written from 1.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(tag = "kind", rename_all = "snake_case")]
pub enum Location {
    /// An integration point of an element.
    Element {
        /// Index of the element.
        #[serde(with = "from_one")]
        element: usize,
        /// Index of the point.
        #[serde(with = "from_one")]
        point: usize,
        /// Reference position, mm.
        position: [f64; 2],
    },
    /// A contact point.
    Contact {
        /// Name of the pair.
        pair: String,
        /// Index of the point.
        #[serde(with = "from_one")]
        point: usize,
        /// Present position, mm.
        position: [f64; 2],
    },
    /// A node.
    Node {
        /// Index of the node.
        #[serde(with = "from_one")]
        node: usize,
        /// Reference position, mm.
        position: [f64; 2],
    },
    /// The system of equations.
    System,
}

/// Writes an index as users count, from 1.
mod from_one {
    use serde::{Deserialize, Deserializer, Serializer};

    pub(super) fn serialize<S: Serializer>(index: &usize, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.serialize_u64(*index as u64 + 1)
    }

    pub(super) fn deserialize<'de, D: Deserializer<'de>>(deserializer: D) -> Result<usize, D::Error> {
        usize::deserialize(deserializer).map(|number| number.saturating_sub(1))
    }
}

impl fmt::Display for Location {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let at = |f: &mut fmt::Formatter<'_>, [x, y]: [f64; 2]| write!(f, " at ({x:.6}, {y:.6})");
        match self {
            Self::Element { element, point, position } => {
                write!(f, "element {}, integration point {}", element + 1, point + 1)?;
                at(f, *position)
            }
            Self::Contact { pair, point, position } => {
                write!(f, "contact '{pair}', point {}", point + 1)?;
                at(f, *position)
            }
            Self::Node { node, position } => {
                write!(f, "node {}", node + 1)?;
                at(f, *position)
            }
            Self::System => write!(f, "the system of equations"),
        }
    }
}

/// The fraction of the increment to repeat with where what fails asks for none.
pub(crate) const USUAL_FRACTION: f64 = 0.5;

/// Reason why an attempt of an increment cannot go on, at a location that is known to the caller.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Setback {
    /// Message.
    pub(crate) reason: String,
    /// As [`PointFailure::fraction`].
    pub(crate) fraction: Option<f64>,
}

impl Setback {
    /// Adds the location.
    pub(crate) fn at(self, place: Location) -> PointFailure {
        PointFailure { place, reason: self.reason, fraction: self.fraction, is_limit_point: false }
    }
}

/// An attempt of an increment that must be given up.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[error("{place}: {reason}")]
pub struct PointFailure {
    /// Location of the failure.
    pub place: Location,
    /// Message.
    pub reason: String,
    /// The fraction of the increment to repeat with, 0 < fraction < 1; `None`: no smaller increment will help.
    pub fraction: Option<f64>,
    /// Whether a load that the step moves has reached its limit point.
    pub is_limit_point: bool,
}
