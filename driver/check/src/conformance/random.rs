//! Deterministic random numbers, so that a state can be named by its number and found again.

use nalgebra::Matrix3;
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
        let mut angle = || (TAU * self.unit()).sin_cos();
        let about_3 = |(s, c): (f64, f64)| Matrix3::new(c, -s, 0.0, s, c, 0.0, 0.0, 0.0, 1.0);
        let about_1 = |(s, c): (f64, f64)| Matrix3::new(1.0, 0.0, 0.0, 0.0, c, -s, 0.0, s, c);
        let first = about_3(angle());
        if about_axis_3 { first } else { first * about_1(angle()) * about_3(angle()) }
    }
}
