//! Requirements on parameters.

use crate::element::{EdgeKind, ElementKind};
use crate::mesh::MeshError;

/// A parameter that is not admissible.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("{}{name} is {value}, it must be {requirement}", fibre.map(|index| format!("fibre {}: ", index + 1)).unwrap_or_default())]
pub struct ParameterProblem {
    /// The index of the fibre that it belongs to, among fibres with names.
    pub fibre: Option<usize>,
    /// The parameter.
    pub name: &'static str,
    /// Value of the parameter.
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
    /// A line that cannot be divided, a block that cannot be built, an outline that cannot be filled.
    #[error(transparent)]
    Mesh(#[from] MeshError),
}

impl SpecimenError {
    /// Names the line whose division failed.
    pub(super) fn along(line: &'static str) -> impl FnOnce(MeshError) -> Self {
        move |error| Self::Mesh(MeshError(format!("{line}: {error}")))
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

    /// Requires that numbers are positive and finite.
    pub(super) fn positive<const N: usize>(&mut self, numbers: [(&'static str, f64); N]) {
        for (name, value) in numbers {
            self.that(value > 0.0 && value.is_finite(), name, value, "positive");
        }
    }

    /// Requires that numbers are at least 1.
    pub(super) fn count<const N: usize>(&mut self, numbers: [(&'static str, usize); N]) {
        for (name, value) in numbers {
            self.that(value > 0, name, value, "at least 1");
        }
    }

    /// Requires that a fibre of these elements has nodes on its axis.
    pub(super) fn nodes_on_axis(&mut self, element: ElementKind, elements_across: usize) {
        let holds = element.edge_kind() == EdgeKind::Quadratic || elements_across.is_multiple_of(2);
        let requirement = format!("even with {element}: the fibre needs nodes on its axis");
        self.that(holds, "elements_across", elements_across, requirement);
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
