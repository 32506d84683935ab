//! α = 1: the criterion f(η) = c₀ − w(2η + η²) − η^(1/B)/A = 0 (doc.md).

use super::Parameters;
use crate::damage_law::ETA_MAX;
use crate::tensor::IsotropicSplit;
use umat_abi::law::Failure;

/// Monotone and quadratic from a bound that is at most a factor off: a few steps; the limit only
/// keeps the loop finite.
const MAX_ITERATIONS: usize = 100;
/// Relative step below which the next one is rounding.
const NEGLIGIBLE_STEP: f64 = 2e-16;

/// η at the end of the increment.
pub(super) fn eta(parameters: &Parameters, split: &IsotropicSplit, eta_before: f64) -> Result<f64, Failure> {
    let n = split.dimension();
    let (r, s) = parameters.denominators(n, 1.0);
    let energy =
        0.5 * parameters.youngs_modulus * (split.deviator_norm_squared() / r + split.trace * split.trace / (n * s));
    let drive = energy + parameters.kappa * split.trace / s - parameters.damage_law.threshold;
    if !drive.is_finite() {
        return Err(Failure::CutBack { fraction: 0.25, reason: "the strain energy overflows" });
    }
    let work = parameters.inelastic_work(n);
    let resistance = work * (2.0 * eta_before + eta_before * eta_before) + parameters.damage_law.excess(eta_before);
    if drive <= resistance {
        return Ok(eta_before);
    }
    Ok(eta_before.max(root(parameters, drive, work)?))
}

/// The root for c₀ = `drive` > 0, w = `work` ≥ 0. Unknown y with η = y^b, Z = y^c/A: y = η^(1/B) for
/// B ≥ 1 and y = η for B < 1, so that both exponents are ≥ 1 and f is concave in y.
fn root(parameters: &Parameters, drive: f64, work: f64) -> Result<f64, Failure> {
    let law = &parameters.damage_law;
    let (b, c) = if law.b >= 1.0 { (law.b, 1.0) } else { (1.0, 1.0 / law.b) };
    // each bound drops one of the falling terms; sqrt(1 + q) − 1 = q/(1 + sqrt(1 + q))
    let q = drive / work;
    let without_excess = if q.is_finite() { (q / (1.0 + (1.0 + q).sqrt())).powf(1.0 / b) } else { f64::INFINITY };
    let without_work = (law.a * drive).powf(1.0 / c);
    let mut y = without_excess.min(without_work).min(ETA_MAX.powf(1.0 / b));
    for _ in 0..MAX_ITERATIONS {
        let eta = y.powf(b);
        let excess = y.powf(c) / law.a;
        let residual = drive - work * (2.0 * eta + eta * eta) - excess;
        // −y f'(y)
        let slope = 2.0 * work * b * (eta + eta * eta) + c * excess;
        let step = residual / slope;
        // rising again is rounding: from the right the steps fall
        if step.is_nan() || step >= -NEGLIGIBLE_STEP {
            return Ok(eta.min(ETA_MAX));
        }
        let next = y + y * step;
        if next == y {
            // subnormal: no number between
            return Ok(eta);
        }
        y = next;
    }
    Err(Failure::CutBack { fraction: 0.5, reason: "no convergence of the damage criterion" })
}
