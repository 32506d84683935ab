//! Faults of the solids of a model.

use crate::model::PluginLaw;

/// The first fault of a model's solids, in words. Indices count from 1.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[error("{0}")]
pub struct SolidsError(pub(super) String);

impl SolidsError {
    /// A UMAT that cannot be called, or a routine around it that failed.
    pub(super) fn umat(part: &str, law: &PluginLaw, message: impl std::fmt::Display) -> Self {
        Self(format!("part '{part}': {}", law.error(message)))
    }
}
