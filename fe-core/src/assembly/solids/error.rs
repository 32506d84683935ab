//! Faults of the solids of a model.

use crate::kinematics::PlaneModel;
use crate::model::{LawError, PluginLaw};

/// The first fault of a model's solids. Indices count from 0, in messages from 1.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum SolidsError {
    /// Not one law for each part.
    #[error("the mesh has {parts} parts, but {laws} laws were given")]
    LawCount {
        /// Parts of the mesh.
        parts: usize,
        /// Laws given.
        laws: usize,
    },
    /// Not one choice of averaging for each part.
    #[error("the mesh has {parts} parts, but {choices} choices of average dilatation were given")]
    AverageDilatationCount {
        /// Parts of the mesh.
        parts: usize,
        /// Choices given.
        choices: usize,
    },
    /// Not one choice of large displacements for each part.
    #[error("the mesh has {parts} parts, but {choices} choices of large displacements were given")]
    LargeDisplacementCount {
        /// Parts of the mesh.
        parts: usize,
        /// Choices given.
        choices: usize,
    },
    /// UMAT cannot be called.
    #[error("part '{part}': {source}")]
    Umat {
        /// Name of the part.
        part: String,
        /// Why.
        source: LawError,
    },
    /// The law does not offer the part's plane model.
    #[error("part '{part}': {law} has no {} form", model_name(*model))]
    PlaneModel {
        /// Name of the part.
        part: String,
        /// Name of the law.
        law: String,
        /// The part's plane model.
        model: PlaneModel,
    },
    /// The law refuses its parameters, or those with an element's size.
    #[error("part '{part}', element {} (characteristic length {length} mm): {law}: {message}", element + 1)]
    Parameters {
        /// Name of the part.
        part: String,
        /// Name of the law.
        law: String,
        /// The element with the part's greatest characteristic length.
        element: usize,
        /// The characteristic length, mm.
        length: f64,
        /// The law's words.
        message: String,
    },
    /// The tangent of the virgin state is no usable stiffness.
    #[error("part '{part}': {law} gives no usable stiffness at zero strain: {reason}")]
    VirginTangent {
        /// Name of the part.
        part: String,
        /// Name of the law.
        law: String,
        /// The value returned.
        reason: String,
    },
}

impl SolidsError {
    /// A UMAT that cannot be called, or a routine around it that failed.
    pub(super) fn umat(part: &str, law: &PluginLaw, message: impl ToString) -> Self {
        Self::Umat { part: part.to_owned(), source: law.error(message) }
    }
}

fn model_name(model: PlaneModel) -> &'static str {
    match model {
        PlaneModel::PlaneStress => "plane-stress",
        PlaneModel::PlaneStrain => "plane-strain",
        PlaneModel::Axisymmetric => "axisymmetric",
    }
}
