//! Deterministic random numbers, so that a state can be named by its number and found again.

use nalgebra::Matrix3;
use pullout_run::deformation::matrix;
use std::f64::consts::TAU;

/// Seed of all random numbers.
pub(super) const SEED: u64 = 0x5EED;

/// Random numbers that come again.
pub(super) struct Random(fastrand::Rng);

impl Random {
    /// Starts the numbers of one of the checks.
    pub(super) fn of_check(check: u64) -> Self {
        Self(fastrand::Rng::with_seed(SEED ^ check))
    }

    /// Starts the numbers of a state of the sample.
    pub(super) fn of_state(number: usize) -> Self {
        Self(fastrand::Rng::with_seed(SEED.wrapping_add(number as u64).wrapping_mul(0xD134_2543_DE82_EF95)))
    }

    /// Uniform in [0, 1).
    pub(super) fn unit(&mut self) -> f64 {
        self.0.f64()
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
    pub(super) fn rotation(&mut self, about_axis_3: bool) -> Matrix3<f64> {
        let (s, c) = (TAU * self.unit()).sin_cos();
        let first = [[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]];
        if about_axis_3 {
            return matrix(&first);
        }
        let (s, c) = (TAU * self.unit()).sin_cos();
        let second = [[1.0, 0.0, 0.0], [0.0, c, -s], [0.0, s, c]];
        let (s, c) = (TAU * self.unit()).sin_cos();
        let third = [[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]];
        matrix(&product(&product(&first, &second), &third))
    }
}

fn product(a: &[[f64; 3]; 3], b: &[[f64; 3]; 3]) -> [[f64; 3]; 3] {
    std::array::from_fn(|i| std::array::from_fn(|j| (0..3).map(|k| a[i][k] * b[k][j]).sum()))
}
