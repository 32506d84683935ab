//! Deterministic random numbers, so that a state can be named by its number and found again.

use std::f64::consts::TAU;

/// splitmix64.
pub(super) struct Random(pub(super) u64);

impl Random {
    /// Uniform in [0, 1).
    pub(super) fn unit(&mut self) -> f64 {
        self.0 = self.0.wrapping_add(0x9E37_79B9_7F4A_7C15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
        ((z ^ (z >> 31)) >> 11) as f64 / (1_u64 << 53) as f64
    }

    /// Uniform in [−1, 1).
    pub(super) fn signed(&mut self) -> f64 {
        2.0 * self.unit() - 1.0
    }

    /// Log-uniform over two decades around 1.
    pub(super) fn magnitude(&mut self) -> f64 {
        10_f64.powf(2.0 * self.unit() - 1.0)
    }

    /// A rotation: any (three angles), or about axis 3.
    pub(super) fn rotation(&mut self, about_axis_3: bool) -> [[f64; 3]; 3] {
        let (s, c) = (TAU * self.unit()).sin_cos();
        let first = [[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]];
        if about_axis_3 {
            return first;
        }
        let (s, c) = (TAU * self.unit()).sin_cos();
        let second = [[1.0, 0.0, 0.0], [0.0, c, -s], [0.0, s, c]];
        let (s, c) = (TAU * self.unit()).sin_cos();
        let third = [[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]];
        product(&product(&first, &second), &third)
    }
}

fn product(a: &[[f64; 3]; 3], b: &[[f64; 3]; 3]) -> [[f64; 3]; 3] {
    std::array::from_fn(|i| std::array::from_fn(|j| (0..3).map(|k| a[i][k] * b[k][j]).sum()))
}
