//! Parameters from what a test report states: E, ν, f_t, f_c (docs/theory/calibration.md).
//!
//! Scaling is exact: with A ~ E/f² and Y₀ ~ f²/E stresses scale with f and strains with f/E. Tension is the
//! default set scaled. In compression A_c and β follow from two strengths, uniaxial f_c and 1.160 f_c at
//! −1/−1 (Kupfer), both closed functions of D_c.

use super::crack_band::{maximum, peak};
use super::stress_and_tangent::degraded_elasticity;
use super::uniaxial::Uniaxial;
use super::{ConcreteDamage, Parameters};
use crate::damage_law::DamageLaw;
use crate::tensor::Elasticity;
use umat_abi::law::{ConfigurationError, Law, out_of_bounds};
use umat_abi::metadata::open_bounds;
use umat_abi::table::require_at_most;

/// A_t f_t²/E of the default set.
const TENSILE_RATE: f64 = 1.926_101;
/// B_t of the default set.
const TENSILE_EXPONENT: f64 = 1.3;
/// Y_t0 E/f_t² of the default set.
const TENSILE_THRESHOLD: f64 = 0.494_549;
/// Y_c0 E/f_c² of the default set.
const COMPRESSIVE_THRESHOLD: f64 = 0.012_524;
/// B_c of the default set.
pub const COMPRESSIVE_EXPONENT: f64 = 1.05;
/// Strength at −1/−1 over f_c (Kupfer).
const BIAXIAL_STRENGTH: f64 = 1.160;

/// Measured properties of a concrete.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ConcreteProperties {
    /// E, MPa.
    pub youngs_modulus: f64,
    /// ν.
    pub poisson_ratio: f64,
    /// f_t, MPa.
    pub tensile_strength: f64,
    /// f_c > 0, MPa.
    pub compressive_strength: f64,
    /// G_f, N/mm; `None`: no crack band in tension.
    pub fracture_energy: Option<f64>,
    /// G_c, N/mm; `None`: no crack band in compression.
    pub crushing_energy: Option<f64>,
}

/// PROPS of `concrete_damage` for a concrete, with B_c = [`COMPRESSIVE_EXPONENT`].
///
/// # Errors
/// A value out of bounds, f_t above f_c, or a ν for which no β in \[0, 1\] gives the biaxial strength.
pub fn properties(concrete: &ConcreteProperties) -> Result<[f64; 14], ConfigurationError> {
    properties_with_exponent(concrete, COMPRESSIVE_EXPONENT)
}

/// PROPS of `concrete_damage` for a concrete, with any B_c: smaller is more ductile, and B_c > 1 is needed for a finite
/// energy.
///
/// # Errors
/// As [`properties`].
pub fn properties_with_exponent(
    concrete: &ConcreteProperties,
    compressive_exponent: f64,
) -> Result<[f64; 14], ConfigurationError> {
    let &ConcreteProperties {
        youngs_modulus: e,
        poisson_ratio: nu,
        tensile_strength: ft,
        compressive_strength: fc,
        ..
    } = concrete;
    for (parameter, value) in [("f_t", ft), ("f_c", fc)] {
        if !(value > 0.0 && value.is_finite()) {
            let (lower, upper, open_bounds) = (0.0, f64::INFINITY, open_bounds::LOWER);
            return Err(ConfigurationError::OutOfBounds { parameter, value, lower, upper, open_bounds });
        }
    }
    require_at_most(ft <= fc, "f_t must not exceed f_c, in MPa", ft, fc)?;
    let table = ConcreteDamage::INFO.parameters;
    for (index, value) in [(0, e), (1, nu), (6, compressive_exponent)] {
        if !table[index].admits(value) {
            return Err(out_of_bounds(&table[index], value));
        }
    }
    let (rate, beta) = compression(nu, compressive_exponent).ok_or(ConfigurationError::Inconsistent {
        rule: "no beta in [0, 1] gives the biaxial strength 1.160 f_c with this nu and B_c",
        value: nu,
    })?;
    Ok([
        e,
        nu,
        TENSILE_RATE * e / (ft * ft),
        TENSILE_EXPONENT,
        TENSILE_THRESHOLD * ft * ft / e,
        rate * e / (fc * fc),
        compressive_exponent,
        COMPRESSIVE_THRESHOLD * fc * fc / e,
        beta,
        0.0,
        0.0,
        0.0,
        concrete.fracture_energy.unwrap_or(0.0),
        concrete.crushing_energy.unwrap_or(0.0),
    ])
}

/// Halvings of an interval: 2⁻⁶⁰ exhausts a double.
const HALVINGS: usize = 60;

/// The zero of a function with one change of sign between the ends; `None` without one.
fn bisection(f: impl Fn(f64) -> f64, mut lower: f64, mut upper: f64) -> Option<f64> {
    let rising = f(upper) > 0.0;
    if rising == (f(lower) > 0.0) {
        return None;
    }
    for _ in 0..HALVINGS {
        let middle = 0.5 * (lower + upper);
        if (f(middle) > 0.0) == rising { upper = middle } else { lower = middle }
    }
    Some(0.5 * (lower + upper))
}

/// (A_c f_c²/E, β) for E = f_c = 1.
fn compression(poisson_ratio: f64, exponent: f64) -> Option<(f64, f64)> {
    let rate = |beta: f64| {
        let strength = |log_rate: f64| uniaxial_strength(&solid(poisson_ratio, exponent, log_rate.exp(), beta)) - 1.0;
        bisection(strength, 1e-3_f64.ln(), 1e3_f64.ln()).map(f64::exp)
    };
    let excess = |beta: f64| {
        rate(beta).map_or(f64::NAN, |a| biaxial_strength(&solid(poisson_ratio, exponent, a, beta)) - BIAXIAL_STRENGTH)
    };
    let beta = bisection(excess, 0.0, 1.0)?;
    Some((rate(beta)?, beta))
}

/// Returns the law for E = 1 with the given compressive parameters; tension has no influence.
fn solid(poisson_ratio: f64, exponent: f64, rate: f64, beta: f64) -> Parameters {
    let law = DamageLaw { a: rate, b: exponent, threshold: COMPRESSIVE_THRESHOLD };
    Parameters {
        elasticity: Elasticity::new(1.0, poisson_ratio),
        tension: law,
        compression: law,
        beta,
        zeta_c: 0.0,
        b_t: 0.0,
        b_c: 0.0,
        fracture_energy: 0.0,
        crushing_energy: 0.0,
    }
}

/// The peak of E_c(D_c) x in uniaxial compression.
fn uniaxial_strength(parameters: &Parameters) -> f64 {
    let curve = Uniaxial::compression(&parameters.elasticity, parameters.compression, parameters.beta);
    let point = peak(&curve);
    curve.youngs_modulus * curve.stiffness_ratio(point.eta) * point.strain
}

/// The peak of E_c/(1 − ν_c) e in plane stress −1/−1, with Y_c = e² (1+ν)²/(1−ν)² (2μ/3) + e² 2βk (1−2ν)²/(1−ν)²
/// of the strain (2ν/(1−ν), −1, −1) e.
fn biaxial_strength(parameters: &Parameters) -> f64 {
    let elasticity = &parameters.elasticity;
    let nu = elasticity.poisson_ratio;
    let (shear, volume) = ((1.0 + nu) / (1.0 - nu), (1.0 - 2.0 * nu) / (1.0 - nu));
    let energy_of_unit = 2.0 / 3.0 * elasticity.shear_modulus * shear * shear
        + 2.0 * parameters.beta * elasticity.bulk_modulus * volume * volume;
    let curve = Uniaxial::compression(elasticity, parameters.compression, parameters.beta);
    let stress = |q: f64| {
        let point = curve.point(q);
        let degraded = degraded_elasticity(parameters, point.eta);
        degraded.youngs_modulus / (1.0 - degraded.poisson_ratio) * (point.energy / energy_of_unit).sqrt()
    };
    // one hump in ln η, not far from the uniaxial one
    stress(maximum(stress, -8.0, 8.0, 1e-8))
}
