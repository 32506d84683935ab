#![doc = include_str!("doc.md")]

pub mod finite;

use umat_abi::law::StressState;

#[cfg(test)]
pub(crate) mod test;

/// The most components that a plane stress or strain has.
pub(crate) const MAX_COMPONENTS: usize = 4;

/// Assumption of a part about the third direction.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum PlaneModel {
    /// σ₃₃ = 0.
    PlaneStress,
    /// ε₃₃ = 0.
    PlaneStrain,
    /// A body of revolution about the y axis; x is the radius.
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
