//! Parameter sets that the law is tried at.

pub const T51: [f64; 9] = [31800.0, 0.18, 5000.0, 1.3, 2e-4, 21.0, 1.05, 4e-4, 0.0];
pub const T51_REGULAR: [f64; 9] = [31800.0, 0.18, 5000.0, 1.3, 2e-4, 21.0, 1.05, 4e-4, 1.0];
pub const S525: [f64; 9] = [31800.0, 0.2, 4e-3, 1.2, 3.35e-2, 4e-3, 1.2, 1.5e-2, 0.0];
/// B < 1, nearly incompressible, no thresholds.
pub const SOFT: [f64; 9] = [31800.0, 0.499, 5000.0, 0.7, 0.0, 21.0, 0.9, 0.0, 1.0];
/// (PROPS, about the peak strain).
pub const SETS: [([f64; 9], f64); 5] = [
    (T51, 4e-4),
    (T51_REGULAR, 4e-4),
    (S525, 0.1),
    (SOFT, 2e-4),
    ([31800.0, 0.0, 2e18, 6.4, 6.45e-4, 21.0, 1.05, 4e-4, 0.0], 4e-4),
];
