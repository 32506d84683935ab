//! Requirements on parameters.

use crate::mesh::structured::{GradingError, StructuredError};
use crate::mesh::triangulation::TriangulationError;

/// A parameter that is not admissible.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("{}{name} is {value}, it must be {requirement}", fibre.map(|index| format!("fibre {}: ", index + 1)).unwrap_or_default())]
pub struct ParameterProblem {
    /// The index of the fibre that it belongs to, among fibres with names.
    pub fibre: Option<usize>,
    /// The parameter.
    pub name: &'static str,
    /// Its value.
    pub value: String,
    /// Requirement that it does not meet.
    pub requirement: String,
}

/// Reason why a specimen cannot be made.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum SpecimenError {
    /// All parameters that are not admissible.
    #[error("{}", problems.iter().map(ToString::to_string).collect::<Vec<_>>().join("; "))]
    Parameters {
        /// Each of them.
        problems: Vec<ParameterProblem>,
    },
    /// Sizes that do not divide a line.
    #[error("{line}: {source}")]
    Grading {
        /// Line that was to be divided.
        line: &'static str,
        /// Reason why it cannot be divided.
        source: GradingError,
    },
    /// A fibre so near the direction of the exit face that its hole has no edge there.
    #[error("no rounded edge touches both the exit face and the hole of {}", fibre.as_ref().map_or_else(|| "the fibre".to_owned(), |name| format!("the fibre '{name}'")))]
    Exit {
        /// Name.
        fibre: Option<String>,
    },
    /// A block that cannot be built.
    #[error(transparent)]
    Structured(#[from] StructuredError),
    /// An outline that cannot be filled.
    #[error(transparent)]
    Triangulation(#[from] TriangulationError),
}

impl SpecimenError {
    /// Names the line whose division failed.
    pub(super) fn along(line: &'static str) -> impl FnOnce(GradingError) -> Self {
        move |source| Self::Grading { line, source }
    }
}

/// Collects problems, so that all are reported at once.
#[derive(Default)]
pub(super) struct Requirements {
    problems: Vec<ParameterProblem>,
    fibre: Option<usize>,
}

impl Requirements {
    /// Sets the index of the fibre to which the parameters that follow belong; `None`: to no fibre.
    pub(super) fn of(&mut self, fibre: Option<usize>) {
        self.fibre = fibre;
    }

    /// Requires that a number is positive and finite.
    pub(super) fn positive(&mut self, name: &'static str, value: f64) {
        self.that(value > 0.0 && value.is_finite(), name, value, "positive");
    }

    /// Requires that a number is at least 1.
    pub(super) fn count(&mut self, name: &'static str, value: usize) {
        self.that(value > 0, name, value, "at least 1");
    }

    /// Requires any other condition.
    pub(super) fn that(
        &mut self,
        holds: bool,
        name: &'static str,
        value: impl ToString,
        requirement: impl Into<String>,
    ) {
        if !holds {
            let (fibre, value) = (self.fibre, value.to_string());
            self.problems.push(ParameterProblem { fibre, name, value, requirement: requirement.into() });
        }
    }

    /// All problems, if there are any.
    pub(super) fn check(self) -> Result<(), SpecimenError> {
        if self.problems.is_empty() { Ok(()) } else { Err(SpecimenError::Parameters { problems: self.problems }) }
    }
}
