//! The damage function shared by models I–IV (models.md §1.2; thesis eqs 4.10, 4.23–4.25).
//!
//! D̂(Y) = 0 for Y ≤ Y₀, else x^B/(1 + x^B), x = A (Y − Y₀).
//!
//! Everything is expressed in **η = D/(1 − D) = x^B**, which is also the stored state: D → 1 costs no
//! digits (1 − D = 1/(1 + η)), and zero is virgin.

use std::ffi::CStr;
use umat_abi::metadata::Parameter;

#[cfg(test)]
mod test;

/// A, the scale of a damage function, in a law's parameter table.
pub(crate) const fn scale_parameter(name: &'static CStr, default_value: f64) -> Parameter {
    Parameter::new(name, c"1/MPa", default_value, c"scale A of the damage function").above(0.0)
}

/// B, its exponent.
pub(crate) const fn exponent_parameter(name: &'static CStr, default_value: f64) -> Parameter {
    Parameter::new(name, c"-", default_value, c"exponent B of the damage function").above(0.0)
}

/// Y₀, its threshold.
pub(crate) const fn threshold_parameter(name: &'static CStr, default_value: f64) -> Parameter {
    Parameter::new(name, c"MPa", default_value, c"damage energy release rate at which damage begins").at_least(0.0)
}

/// Largest η: 1 − D stays a normal number and products of two of them do not overflow.
pub const ETA_MAX: f64 = 1e150;

/// D = η/(1 + η).
#[inline]
pub fn damage(eta: f64) -> f64 {
    eta / (1.0 + eta)
}

/// ω = 1 − D = 1/(1 + η).
#[inline]
pub fn integrity(eta: f64) -> f64 {
    1.0 / (1.0 + eta)
}

/// The parameters A (1/MPa), B (–), Y₀ (MPa) of one damage function.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DamageLaw {
    /// A, 1/MPa.
    pub a: f64,
    /// B.
    pub b: f64,
    /// Threshold Y₀, MPa.
    pub threshold: f64,
}

impl DamageLaw {
    /// η̂(Y) = [A (Y − Y₀)]^B, 0 below the threshold, at most [`ETA_MAX`].
    #[inline]
    pub fn eta(&self, damage_energy_release_rate: f64) -> f64 {
        let x = self.a * (damage_energy_release_rate - self.threshold);
        if x <= 0.0 { 0.0 } else { x.powf(self.b).min(ETA_MAX) }
    }

    /// D̂'(Y) = B D (1 − D)/(Y − Y₀) at an η on the curve; 0 at and below the threshold, and where η has reached
    /// its largest value.
    #[inline]
    pub fn damage_rate(&self, damage_energy_release_rate: f64, eta: f64) -> f64 {
        let excess = damage_energy_release_rate - self.threshold;
        if excess <= 0.0 || eta >= ETA_MAX { 0.0 } else { self.b * damage(eta) * integrity(eta) / excess }
    }

    /// Z(D) = Y − Y₀ on the curve: η^(1/B)/A.
    #[inline]
    pub fn excess(&self, eta: f64) -> f64 {
        eta.powf(1.0 / self.b) / self.a
    }

    /// dZ/dη = η^(1/B − 1)/(A B); dZ/dD is (1 + η)² times that. For B > 1 infinite at η = 0.
    #[inline]
    pub fn excess_rate(&self, eta: f64) -> f64 {
        eta.powf(1.0 / self.b - 1.0) / (self.a * self.b)
    }

    /// ∫₀^D (Y₀ + Z(D')) dD': what growing D from 0 dissipates when its conjugate force is Y itself
    /// (models I, II and III, or uniaxial tension of IV-H); N·mm/mm³. Exact for any η.
    pub fn dissipation(&self, eta: f64) -> f64 {
        if eta <= 0.0 {
            return 0.0;
        }
        self.threshold * damage(eta) + excess_integral(eta, 1.0 / self.b) / self.a
    }

    /// lim η→∞ of [`Self::dissipation`]: Y₀ + (π/B)/(A sin(π/B)) for B > 1, infinite otherwise
    /// (models.md §10).
    pub fn total_dissipation(&self) -> f64 {
        if self.b <= 1.0 {
            return f64::INFINITY;
        }
        let p = std::f64::consts::PI / self.b;
        self.threshold + p / (self.a * p.sin())
    }
}

/// Terms of a series in a ratio ≤ 1/2 until rounding: 2⁻⁶⁰ is below it.
const SERIES_TERMS: u32 = 64;
/// The complement of the integral loses digits (it is the difference of two poles) as p comes this close to an integer.
const POLE_DISTANCE: f64 = 0.02;

/// ∫₀^η t^p/(1 + t)² dt = ∫₀^D (d/(1−d))^p dd, p > 0: the incomplete beta function B_D(1+p, 1−p).
pub(crate) fn excess_integral(eta: f64, p: f64) -> f64 {
    if eta <= 1.0 {
        return lower_integral(eta, p);
    }
    if p < 2.0 - POLE_DISTANCE && (p - p.round()).abs() > POLE_DISTANCE {
        // B_D(1+p, 1−p) = B(1+p, 1−p) − B_{1−D}(1−p, 1+p), by continuation also for p > 1
        let angle = std::f64::consts::PI * p;
        return angle / angle.sin() - lower_integral(1.0 / eta, -p);
    }
    upper_integral(eta, p) + lower_integral(1.0, p)
}

/// The part between D = 1/2 and D, for any p: ∫_ω^{1/2} (1−w)^p w^−p dw with the binomial series of (1−w)^p. Each term
/// integrates to (2^−s − ω^s)/s, s = k + 1 − p, which tends to −ln(2ω) as s → 0 (B = 1, 1/2, …).
#[cold]
fn upper_integral(eta: f64, p: f64) -> f64 {
    let integrity = integrity(eta);
    let log_ratio = -(2.0 * integrity).ln();
    let mut upper = 0.0;
    let mut binomial = 1.0;
    for k in 0..SERIES_TERMS {
        let k = f64::from(k);
        let s = k + 1.0 - p;
        // (2^−s − ω^s)/s = 2^−s (1 − e^{−s·log_ratio})/s
        let term = if s == 0.0 { log_ratio } else { 0.5_f64.powf(s) * -(-s * log_ratio).exp_m1() / s };
        upper += binomial * term;
        if (binomial * term).abs() <= 1e-18 * upper.abs() && k > p {
            break;
        }
        binomial *= -(p - k) / (k + 1.0);
    }
    upper
}

/// Levels of the continued fraction at D = 1/2, where each gains a factor of (√2 − 1)² = 0.17.
const MOST_LEVELS: f64 = 24.0;

/// The part D ≤ 1/2: D^(1+p) (1−D)^(1−p)/(1+p) · ₂F₁(2, 1; 2+p; D), p > −2 and no negative integer.
///
/// Gauss's continued fraction ₂F₁(2, 1; c; z) = 1/(1 + d₁z/(1 + d₂z/(1 + …))) with
/// d_{2k+1} = −(2+k)(c−1+k)/((c−1+2k)(c+2k)), d_{2k} = −k(c−3+k)/((c−2+2k)(c−1+2k)), from the last level that counts.
fn lower_integral(eta: f64, p: f64) -> f64 {
    let d = damage(eta);
    let w = integrity(eta);
    let root = w.sqrt();
    let gain = (1.0 - root) / (1.0 + root);
    // half the levels that bring gain^levels below rounding
    let pairs = (0.5 * (f64::EPSILON.ln() - 4.0) / gain.max(f64::MIN_POSITIVE).ln()).ceil().min(0.5 * MOST_LEVELS);
    let c = 2.0 + p;
    let mut fraction = 1.0;
    let mut k = pairs;
    while k >= 1.0 {
        let even = -k * (c - 3.0 + k) / ((c - 2.0 + 2.0 * k) * (c - 1.0 + 2.0 * k));
        let j = k - 1.0;
        let odd = -(2.0 + j) * (c - 1.0 + j) / ((c - 1.0 + 2.0 * j) * (c + 2.0 * j));
        fraction = 1.0 + odd * d / (1.0 + even * d / fraction);
        k -= 1.0;
    }
    // D^(1+p) (1−D)^(1−p) = η^(1+p) (1−D)²
    eta.powf(1.0 + p) * w * w / ((1.0 + p) * fraction)
}
