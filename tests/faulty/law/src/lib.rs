//! Two damage laws small enough to be right at a glance. The plugins next to this crate plant one error
//! each into them, and `driver/tests/conformance.rs` checks that the conformance test finds it.

mod interface;
mod solid;

pub use interface::{Half, InterfaceDamage, Share, Whole};
pub use solid::{Damage, Fault, Parts, State};

use umat_abi::law::ConfigurationError;
use umat_abi::table::Field;

/// D(r) = 1 − exp(−(r − Y₀)/Y_f) of the largest energy release rate r so far.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Evolution {
    threshold: f64,
    decay: f64,
}

impl Field<2> for Evolution {
    fn read([threshold, decay]: [f64; 2]) -> Result<Self, ConfigurationError> {
        Ok(Self { threshold, decay })
    }
}

impl Evolution {
    /// 1 − D.
    fn integrity(&self, r: f64) -> f64 {
        (-(r - self.threshold).max(0.0) / self.decay).exp()
    }

    /// D′.
    fn slope(&self, r: f64) -> f64 {
        if r > self.threshold { self.integrity(r) / self.decay } else { 0.0 }
    }

    /// ∫ Y dD = Y₀ + Y_f − (r + Y_f)(1 − D).
    fn dissipated(&self, r: f64) -> f64 {
        if r > self.threshold { self.threshold + self.decay - (r + self.decay) * self.integrity(r) } else { 0.0 }
    }
}
