//! Reasons why a system was not solved. Messages count equations from 1.

/// A system that cannot be solved, or was not solved accurately.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[allow(missing_docs, reason = "the message of each variant says what its fields are")]
pub enum SolverError {
    /// NaN or infinite.
    #[error("the entry in row {}, column {} of the matrix is not finite", row + 1, column + 1)]
    NotFinite { row: usize, column: usize },
    /// NaN or infinite.
    #[error("the right side of equation {} is not finite", equation + 1)]
    RightSide { equation: usize },
    /// No unique solution.
    #[error("the system is singular{}", equation.map_or(String::new(), |equation| format!(" at equation {}", equation + 1)))]
    Singular { equation: Option<usize> },
    /// A matrix that must be positive definite is not.
    #[error("the matrix is not positive definite: no positive pivot at equation {}", equation + 1)]
    NotDefinite { equation: usize },
    /// Solved without a factor.
    #[error("there is no factor to solve with")]
    NotFactorised,
    /// The residual of the solution is larger than accepted.
    #[error("the solution leaves {residual:.1e} of the right side, more than {tolerance:.0e}, after refinement")]
    Residual { residual: f64, tolerance: f64 },
    /// Out of memory, or of indices.
    #[error("the factor is too large: {0}")]
    TooLarge(String),
}

impl From<faer::sparse::FaerError> for SolverError {
    fn from(error: faer::sparse::FaerError) -> Self {
        Self::TooLarge(error.to_string())
    }
}

impl From<faer::dyn_stack::mem::AllocError> for SolverError {
    fn from(_: faer::dyn_stack::mem::AllocError) -> Self {
        Self::TooLarge("no memory for its workspace".to_owned())
    }
}
