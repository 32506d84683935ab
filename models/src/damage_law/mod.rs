//! The damage function shared by models I–IV (docs/theory/common.md; thesis eqs 4.10, 4.23–4.25).
//!
//! D̂(Y) = 0 for Y ≤ Y₀, else x^B/(1 + x^B), x = A (Y − Y₀).
//!
//! Everything is expressed in **η = D/(1 − D) = x^B**, which is also the stored state: D → 1 costs no
//! digits (1 − D = 1/(1 + η)), and zero is virgin.

use std::ffi::CStr;
use umat_abi::law::ConfigurationError;
use umat_abi::metadata::Parameter;
use umat_abi::table::Field;

#[cfg(test)]
mod test;

/// A, the scale of a damage function, in a law's parameter table.
pub(crate) const fn scale_parameter(name: &'static CStr, default_value: f64) -> Parameter {
    Parameter::new(name, c"1/MPa", default_value, c"scale A of the damage function").above(0.0).typically(1e-4, 1e6)
}

/// B, its exponent.
pub(crate) const fn exponent_parameter(name: &'static CStr, default_value: f64) -> Parameter {
    Parameter::new(name, c"-", default_value, c"exponent B of the damage function").above(0.0)
}

/// Y₀, its threshold.
pub(crate) const fn threshold_parameter(name: &'static CStr, default_value: f64) -> Parameter {
    Parameter::new(name, c"MPa", default_value, c"damage energy release rate at which damage begins")
        .at_least(0.0)
        .typically(1e-7, 1.0)
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

impl Field<3> for DamageLaw {
    #[inline(always)]
    fn read([a, b, threshold]: [f64; 3]) -> Result<Self, ConfigurationError> {
        Ok(Self { a, b, threshold })
    }
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
    pub(crate) fn damage_rate(&self, damage_energy_release_rate: f64, eta: f64) -> f64 {
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
    pub(crate) fn excess_rate(&self, eta: f64) -> f64 {
        eta.powf(1.0 / self.b - 1.0) / (self.a * self.b)
    }

    /// ∫₀^D (Y₀ + Z(D')) dD': what growing D from 0 dissipates when its conjugate force is Y itself
    /// (models I, II and III, or uniaxial tension of IV-H); N·mm/mm³. Exact for any η.
    pub fn dissipation(&self, eta: f64) -> f64 {
        self.dissipation_with(eta, eta.powf(1.0 / self.b))
    }

    /// [`Self::dissipation`] of an η = η̂(Y).
    pub(crate) fn dissipation_on_curve(&self, eta: f64, damage_energy_release_rate: f64) -> f64 {
        self.dissipation_with(eta, self.root_on_curve(eta, damage_energy_release_rate))
    }

    /// η^(1/B) of an η = η̂(Y): A (Y − Y₀), but where η has reached its largest value, and of a state that a host began
    /// with, without Y.
    #[inline]
    pub(crate) fn root_on_curve(&self, eta: f64, damage_energy_release_rate: f64) -> f64 {
        let root = self.a * (damage_energy_release_rate - self.threshold);
        if eta < ETA_MAX && root > 0.0 { root } else { eta.powf(1.0 / self.b) }
    }

    /// `root` = η^(1/B).
    #[inline]
    fn dissipation_with(&self, eta: f64, root: f64) -> f64 {
        if eta <= 0.0 {
            return 0.0;
        }
        let [excess] = excess_integrals([eta], 1.0 / self.b, [root]);
        self.threshold * damage(eta) + excess / self.a
    }
}

/// Terms of a series in a ratio ≤ 1/2 until rounding: 2⁻⁶⁰ is below it.
const SERIES_TERMS: u32 = 64;
/// The complement of the integral loses digits (it is the difference of two poles) as p comes this close to an integer.
const POLE_DISTANCE: f64 = 0.02;

/// Returns ∫₀^η t^p/(1 + t)² dt = ∫₀^D (d/(1−d))^p dd, p > 0, the incomplete beta function B_D(1+p, 1−p), for several η
/// at once; `powers` = η^p.
#[inline]
pub(crate) fn excess_integrals<const N: usize>(etas: [f64; N], p: f64, powers: [f64; N]) -> [f64; N] {
    if etas.iter().all(|&eta| eta <= 1.0) {
        return lower_integrals(etas, p, powers);
    }
    if p < 2.0 - POLE_DISTANCE && (p - p.round()).abs() > POLE_DISTANCE {
        // B_D(1+p, 1−p) = B(1+p, 1−p) − B_{1−D}(1−p, 1+p), by continuation also for p > 1
        let angle = std::f64::consts::PI * p;
        let whole = angle / angle.sin();
        if etas.iter().all(|&eta| eta > 1.0) {
            return lower_integrals(etas.map(f64::recip), -p, powers).map(|rest| whole - rest);
        }
        return std::array::from_fn(|i| {
            if etas[i] <= 1.0 {
                let [lower] = lower_integrals([etas[i]], p, [powers[i]]);
                lower
            } else {
                let [rest] = lower_integrals([etas[i].recip()], -p, [powers[i]]);
                whole - rest
            }
        });
    }
    std::array::from_fn(|i| {
        let [lower] = lower_integrals([etas[i].min(1.0)], p, [powers[i].min(1.0)]);
        if etas[i] <= 1.0 { lower } else { upper_integral(etas[i], p) + lower }
    })
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

/// Number of pairs of levels of the continued fraction that bring gain^levels below rounding (58 bits), by the number
/// of bits that a level gains: from D = 1/2, where it is 2.54, on.
const PAIRS: [u8; 30] = {
    let mut pairs = [12; 30];
    let mut bits = 3;
    while bits < pairs.len() {
        pairs[bits] = 58_u8.div_ceil(2 * bits as u8);
        bits += 1;
    }
    pairs
};

/// gain = (1−√ω)/(1+√ω) = D/(1+√ω)², at most 0.3432 D for D ≤ 1/2, rounded up to a power of two.
#[inline]
fn pairs_of_levels(d: f64) -> u8 {
    let exponent = ((0.3432 * d).to_bits() >> 52) as usize;
    PAIRS[1022_usize.saturating_sub(exponent).min(PAIRS.len() - 1)]
}

/// The parts D ≤ 1/2: D^(1+p) (1−D)^(1−p)/(1+p) · ₂F₁(2, 1; 2+p; D), p > −2 and no negative integer; `powers` = η^p.
///
/// Gauss's continued fraction ₂F₁(2, 1; c; z) = 1/(1 + d₁z/(1 + d₂z/(1 + …))) with
/// d_{2k+1} = −(2+k)(c−1+k)/((c−1+2k)(c+2k)), d_{2k} = −k(c−3+k)/((c−2+2k)(c−1+2k)), from the last level that counts, as
/// one numerator and one denominator: a division is all that it waits for, at its end.
#[inline]
fn lower_integrals<const N: usize>(etas: [f64; N], p: f64, powers: [f64; N]) -> [f64; N] {
    let damages = etas.map(damage);
    let c = 2.0 + p;
    let (mut numerators, mut denominators) = ([1.0; N], [1.0; N]);
    let mut k = f64::from(damages.iter().fold(0, |most, &d| most.max(pairs_of_levels(d))));
    while k >= 1.0 {
        // level 2k, then 2k − 1, each as n/m z
        let even = [-k * (c - 3.0 + k), (c - 2.0 + 2.0 * k) * (c - 1.0 + 2.0 * k)];
        let odd = [-(1.0 + k) * (c - 2.0 + k), (c - 3.0 + 2.0 * k) * (c - 2.0 + 2.0 * k)];
        for i in 0..N {
            let widened = even[1] * numerators[i];
            let outer = odd[1] * (widened + even[0] * (damages[i] * denominators[i]));
            numerators[i] = outer + odd[0] * (damages[i] * widened);
            denominators[i] = outer;
        }
        k -= 1.0;
    }
    let mut integrals = [0.0; N];
    for i in 0..N {
        // D^(1+p) (1−D)^(1−p) = η^(1+p) (1−D)²
        let w = integrity(etas[i]);
        integrals[i] = etas[i] * powers[i] * w * w * denominators[i] / ((1.0 + p) * numerators[i]);
    }
    integrals
}
