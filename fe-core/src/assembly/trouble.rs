//! Why an attempt of an increment cannot go on, and where.

use std::fmt;

/// Where in a model something happened; indices from 0, told from 1.
#[derive(Clone, Debug, PartialEq)]
pub enum Place {
    /// An integration point of an element.
    Element {
        /// Index of the element.
        element: usize,
        /// Index of the point.
        point: usize,
        /// Reference position, mm.
        position: [f64; 2],
    },
    /// A contact point.
    Contact {
        /// Name of the pair.
        pair: String,
        /// Index of the point.
        point: usize,
        /// Present position, mm.
        position: [f64; 2],
    },
    /// A node.
    Node {
        /// Index of the node.
        node: usize,
        /// Reference position, mm.
        position: [f64; 2],
    },
    /// The system of equations.
    System,
}

impl fmt::Display for Place {
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

/// An attempt of an increment that must be given up.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[error("{place}: {reason}")]
pub struct Trouble {
    /// Where.
    pub place: Place,
    /// What, in words.
    pub reason: String,
    /// The fraction of the increment to repeat with, 0 < fraction < 1; `None`: no smaller increment will help.
    pub fraction: Option<f64>,
}
