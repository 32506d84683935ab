//! α ≠ 1: Y(ε, ·) need not be monotone; the continuous branch is the smallest root η ≥ η_n of
//! r(η) = Y(ε, η) − Y₀ − Z(η) (doc.md).

use super::Parameters;
use crate::damage_law::ETA_MAX;
use crate::tensor::IsotropicSplit;
use umat_abi::law::Failure;

/// Below e^−14 damage does not show in the stress: the march starts there.
const MARCH_START: f64 = 8.315_287_191_035_679e-7;
/// One step of 1/16 in ln η.
const MARCH_FACTOR: f64 = 1.064_494_458_917_859_4;
/// Replaces η = 0+, where λ' and Z' of the power form may be infinite; λ'' ~ η^(α−2) is finite here.
const ETA_MIN: f64 = 1e-150;
/// Bisection of 150 decades to the last bit takes 62 halvings of the logarithm.
const MAX_ITERATIONS: usize = 200;
/// Relative width below which the root is known to rounding.
const NEGLIGIBLE_STEP: f64 = 2e-16;

/// r(η) with Z(η) given.
fn residual(parameters: &Parameters, split: &IsotropicSplit, eta: f64, excess: f64) -> f64 {
    parameters.release_rate(split, eta) - parameters.damage_law.threshold - excess
}

/// η at the end of the increment.
pub(super) fn eta(parameters: &Parameters, split: &IsotropicSplit, eta_before: f64) -> Result<f64, Failure> {
    let law = &parameters.damage_law;
    let mut lower = eta_before.max(ETA_MIN);
    if residual(parameters, split, lower, law.excess(lower)) <= 0.0 {
        return Ok(eta_before);
    }
    let mut upper = if lower < MARCH_START { MARCH_START } else { lower * MARCH_FACTOR };
    // Z grows by the same factor each step: no power needed
    let mut excess = law.excess(upper);
    let excess_factor = MARCH_FACTOR.powf(1.0 / law.b);
    loop {
        let value = residual(parameters, split, upper, excess);
        if value <= 0.0 {
            return Ok(eta_before.max(root(parameters, split, lower, upper)?));
        }
        if value.is_nan() {
            return Err(Failure::CutBack { fraction: 0.25, reason: "the damage energy release rate overflows" });
        }
        if upper >= ETA_MAX {
            return Ok(ETA_MAX);
        }
        lower = upper;
        upper = (upper * MARCH_FACTOR).min(ETA_MAX);
        excess *= excess_factor;
    }
}

/// Newton's method kept within the bracket r(lower) > 0 ≥ r(upper); where it leaves the bracket or
/// converges too slowly, ln η is halved instead.
fn root(parameters: &Parameters, split: &IsotropicSplit, mut lower: f64, mut upper: f64) -> Result<f64, Failure> {
    let mut eta = lower.sqrt() * upper.sqrt();
    let mut last_step = upper - lower;
    for _ in 0..MAX_ITERATIONS {
        let value = residual(parameters, split, eta, parameters.damage_law.excess(eta));
        if value > 0.0 {
            lower = eta;
        } else {
            upper = eta;
        }
        let slope = parameters.release_rate_slope(split, eta) - parameters.damage_law.excess_rate(eta);
        let newton = eta - value / slope;
        let trusted = newton > lower && newton < upper && 2.0 * (newton - eta).abs() <= last_step;
        let next = if trusted { newton } else { lower.sqrt() * upper.sqrt() };
        last_step = (next - eta).abs();
        if last_step <= NEGLIGIBLE_STEP * eta || upper - lower <= NEGLIGIBLE_STEP * upper {
            return Ok(next);
        }
        eta = next;
    }
    Err(Failure::CutBack { fraction: 0.5, reason: "no convergence of the damage criterion" })
}
