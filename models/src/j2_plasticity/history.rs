//! The state variables that the two plasticity laws share.

use crate::linear_elastic::{DISSIPATED_ENERGY, STRAIN_33};
use umat_abi::metadata::StateVariable;

const fn plastic_strain(name: &'static std::ffi::CStr, component: u32) -> StateVariable {
    StateVariable::new(name, c"-", c"plastic strain (engineering shear)").strain_component(component)
}

/// STATEV of a plasticity law.
pub(crate) const STATES: [StateVariable; 9] = [
    StateVariable::new(c"peeq", c"-", c"equivalent plastic strain, the sum of sqrt(2/3 dep:dep)"),
    plastic_strain(c"plastic_strain_11", 1),
    plastic_strain(c"plastic_strain_22", 2),
    plastic_strain(c"plastic_strain_33", 3),
    plastic_strain(c"plastic_strain_12", 4),
    plastic_strain(c"plastic_strain_13", 5),
    plastic_strain(c"plastic_strain_23", 6),
    STRAIN_33,
    DISSIPATED_ENERGY,
];

/// Number of the total strain 33 among them.
pub(crate) const STRAIN_33_STATE: usize = 7;

/// The same as numbers.
#[derive(Clone, Copy, Debug)]
pub(crate) struct PlasticHistory {
    /// Equivalent plastic strain.
    pub peeq: f64,
    /// Plastic strain, engineering shear.
    pub plastic_strain: [f64; 6],
    /// Total strain 33.
    pub strain_33: f64,
    /// Energy dissipated since the virgin state.
    pub dissipated_energy: f64,
}

impl PlasticHistory {
    /// From STATEV.
    #[inline]
    pub fn read(state: &[f64]) -> Self {
        Self {
            peeq: state[0],
            plastic_strain: std::array::from_fn(|i| state[1 + i]),
            strain_33: state[STRAIN_33_STATE],
            dissipated_energy: state[8],
        }
    }

    /// To STATEV.
    #[inline]
    pub fn write(&self, state: &mut [f64]) {
        state[0] = self.peeq;
        state[1..7].copy_from_slice(&self.plastic_strain);
        state[STRAIN_33_STATE] = self.strain_33;
        state[8] = self.dissipated_energy;
    }

    /// ε − εᵖ.
    #[inline]
    pub fn elastic_strain(&self, strain: &[f64; 6]) -> [f64; 6] {
        std::array::from_fn(|i| strain[i] - self.plastic_strain[i])
    }
}
