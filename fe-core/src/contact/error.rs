//! Faults of contact pairs. Messages count points, nodes and elements from 1.

/// A contact pair that cannot be set up.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[allow(missing_docs, reason = "the message of each variant says what its fields are")]
pub enum ContactError {
    /// A point that has no foot on the master.
    #[error("contact '{pair}', point {} at ({:.6}, {:.6}): {reason}", point + 1, position[0], position[1])]
    NoFoot { pair: String, point: usize, position: [f64; 2], reason: &'static str },
    /// The surfaces do not lie on each other.
    #[error("contact '{pair}', point {} at ({:.6}, {:.6}): its gap is {gap:.3e} mm at the start, up to ±{allowed:.3e} is taken as a fault of the mesh{}", point + 1, position[0], position[1], if *gap > 0.0 { "; more may only open a pair that carries neither tension nor bond" } else { "" })]
    InitialGap { pair: String, point: usize, position: [f64; 2], gap: f64, allowed: f64 },
    /// An enforcement that the law cannot have.
    #[error("contact '{pair}': {reason}")]
    Enforcement { pair: String, reason: &'static str },
    /// Any other: a master that is no single row of edges, nothing to put points on, a number out of range, a law that
    /// refuses its parameters or cannot be called.
    #[error("contact '{pair}': {reason}")]
    Unusable { pair: String, reason: String },
}
