//! The state variables that the two plasticity laws share.

use crate::linear_elastic::{DISSIPATED_ENERGY, STRAIN_33};
use umat_abi::metadata::{EQUIVALENT_PLASTIC_STRAIN, StateVariable};

const fn plastic_strain(name: &'static std::ffi::CStr, component: u32) -> StateVariable {
    StateVariable::new(name, c"-", c"plastic strain (engineering shear)").strain_component(component)
}

umat_abi::states! {
    /// The state variables of a plasticity law.
    pub struct State {
        /// Equivalent plastic strain.
        pub peeq: f64 = StateVariable::new(
            EQUIVALENT_PLASTIC_STRAIN, c"-", c"equivalent plastic strain, the sum of sqrt(2/3 dep:dep)",
        );
        /// Plastic strain, engineering shear.
        pub plastic_strain: [f64; 6] =
            plastic_strain(c"plastic_strain_11", 1),
            plastic_strain(c"plastic_strain_22", 2),
            plastic_strain(c"plastic_strain_33", 3),
            plastic_strain(c"plastic_strain_12", 4),
            plastic_strain(c"plastic_strain_13", 5),
            plastic_strain(c"plastic_strain_23", 6);
        /// Total strain 33.
        pub strain_33: f64 = STRAIN_33;
        /// Energy dissipated since the virgin state.
        pub dissipated_energy: f64 = DISSIPATED_ENERGY;
    }
}

impl State {
    /// ε − εᵖ.
    #[inline(always)]
    pub fn elastic_strain(&self, strain: &[f64; 6]) -> [f64; 6] {
        std::array::from_fn(|i| strain[i] - self.plastic_strain[i])
    }
}
