//! Parameter sets that the law is tried at.

pub const E: f64 = 210_000.0;
pub const NU: f64 = 0.3;

pub const PERFECT: [f64; 4] = [E, NU, 347.0, 0.0];
pub const LINEAR: [f64; 6] = [E, NU, 347.0, 0.0, 2447.0, 1.0];
/// Joints with large jumps of the slope: 40 000, 0, 60 000, −20 000, 0 MPa.
pub const JOINTS: [f64; 12] = [E, NU, 347.0, 0.0, 387.0, 1e-3, 387.0, 2e-3, 507.0, 4e-3, 407.0, 9e-3];
pub const SOFTENING: [f64; 6] = [E, NU, 347.0, 0.0, 147.0, 2e-3];
pub const STEEP: [f64; 8] = [E, 0.0, 200.0, 0.0, 200.0, 1e-3, 2200.0, 2e-3];
pub const NEARLY_INCOMPRESSIBLE: [f64; 6] = [E, 0.499, 347.0, 0.0, 447.0, 5e-3];
pub const AUXETIC: [f64; 6] = [E, -0.4, 347.0, 0.0, 447.0, 5e-3];
pub const SETS: [&[f64]; 7] = [&PERFECT, &LINEAR, &JOINTS, &SOFTENING, &STEEP, &NEARLY_INCOMPRESSIBLE, &AUXETIC];
