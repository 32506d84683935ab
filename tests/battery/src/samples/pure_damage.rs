//! Parameter sets that the law is tried at.

pub const T51T: [f64; 5] = [31800.0, 0.18, 5000.0, 1.3, 2e-4];
pub const T51C: [f64; 5] = [31800.0, 0.18, 21.0, 1.05, 4e-4];
pub const S45T: [f64; 5] = [31800.0, 0.2, 4e-3, 1.2, 3.35e-2];
/// (PROPS, about the peak strain).
pub const SETS: [([f64; 5], f64); 6] = [
    (T51T, 1.2e-4),
    (T51C, 1.6e-3),
    (S45T, 0.1),
    // B < 1, nearly incompressible, no threshold
    ([31800.0, 0.499, 5000.0, 0.7, 0.0], 1e-4),
    // brittle
    ([31800.0, 0.2, 2e18, 6.4, 6.45e-4], 2e-4),
    ([31800.0, -0.3, 5000.0, 4.0, 2e-4], 1.2e-4),
];
