//! Parameter sets that the law is tried at.

pub const UNIAXIAL: f64 = 0.0;
pub const BIAXIAL: f64 = 1.0;
pub const BLEND: f64 = 2.0;
pub const IMPLICIT: f64 = 0.0;
pub const LAGGED: f64 = 1.0;
pub const BETA: [f64; 3] = [UNIAXIAL, BIAXIAL, BLEND];

/// Table 5.1 with ν = 0.18.
pub const fn props(beta_mode: f64, weights: f64) -> [f64; 12] {
    [31800.0, 0.18, 7000.0, 1.1, 1.9e-4, 29.0, 0.94, 3.0e-4, 2.0, 0.7, beta_mode, weights]
}
