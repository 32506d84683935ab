#![doc = include_str!("doc.md")]

pub mod finite;

use schemars::JsonSchema;
use serde::Deserialize;
use umat_abi::law::StressState;

#[cfg(test)]
pub(crate) mod test;

/// The most components that a plane stress or strain has.
pub(crate) const MAX_COMPONENTS: usize = 4;

/// Assumption about the third direction.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum PlaneModel {
    /// σ33 = 0.
    PlaneStress,
    /// ε33 = 0.
    PlaneStrain,
    /// About the axis x = 0.
    Axisymmetric,
}

impl PlaneModel {
    /// All models.
    pub const ALL: [Self; 3] = [Self::PlaneStress, Self::PlaneStrain, Self::Axisymmetric];

    /// The components that a UMAT gets.
    pub const fn stress_state(self) -> StressState {
        match self {
            Self::PlaneStress => StressState::PlaneStress,
            Self::PlaneStrain | Self::Axisymmetric => StressState::PlaneStrainOrAxisymmetric,
        }
    }

    /// Volume per unit of area at x (the radius): the thickness, or the circumference 2πr, which ignores `thickness`.
    pub fn depth(self, x: f64, thickness: f64) -> f64 {
        match self {
            Self::PlaneStress | Self::PlaneStrain => thickness,
            Self::Axisymmetric => std::f64::consts::TAU * x,
        }
    }
}
