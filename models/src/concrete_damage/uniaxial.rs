//! The law in uniaxial stress, in closed form: what the crack band and the dissipation are built on.
//!
//! With x = √(2Y/E*) the stress is σ = E f(D) x, f = E_c/E = (1 − D)(1 − βD)/(1 − ρD):
//! - compression: E* = E [2(1+ν) + β(1−2ν)]/3, ρ = [2(1+ν) β + 1 − 2ν]/3, and x is the axial strain;
//! - tension: E* = E, β = ρ = 1, so f = 1 − D. The axial strain is x (1 − κD), κ = 2ν²/(1−ν), because the
//!   cracked sides recover their contraction (usually neglected).

use super::evolution::Branch;
use crate::damage_law::{DamageLaw, damage, excess_integrals, integrity};
use crate::tensor::Elasticity;

/// One branch under uniaxial stress.
#[derive(Clone, Copy, Debug)]
pub(super) struct Uniaxial {
    /// D̂(Y).
    pub law: DamageLaw,
    /// E.
    pub youngs_modulus: f64,
    /// E*, with Y = E* x²/2.
    pub modulus: f64,
    beta: f64,
    rho: f64,
    /// (1 − ρ)^(1/B), 0 where nothing needs it.
    closing_root: f64,
    /// κ: the axial strain is x − κ (x − σ/E); 0 in compression.
    pub recovery: f64,
}

impl Uniaxial {
    /// The tensile branch.
    #[inline]
    pub fn tension(elasticity: &Elasticity, law: DamageLaw) -> Self {
        let nu = elasticity.poisson_ratio;
        let e = elasticity.youngs_modulus;
        // for ν < 0 the sides extend: nothing to recover
        let recovery = if nu > 0.0 { 2.0 * nu * nu / (1.0 - nu) } else { 0.0 };
        Self { law, youngs_modulus: e, modulus: e, beta: 1.0, rho: 1.0, closing_root: 0.0, recovery }
    }

    /// The compressive branch.
    #[inline]
    pub fn compression(elasticity: &Elasticity, law: DamageLaw, beta: f64) -> Self {
        let nu = elasticity.poisson_ratio;
        let (deviatoric, hydrostatic) = (2.0 * (1.0 + nu) / 3.0, (1.0 - 2.0 * nu) / 3.0);
        let e = elasticity.youngs_modulus;
        let rho = 1.0 - deviatoric * (1.0 - beta);
        let closing = 1.0 - rho;
        Self {
            law,
            youngs_modulus: e,
            modulus: e * (deviatoric + beta * hydrostatic),
            beta,
            rho,
            closing_root: if rho > beta && closing > 0.0 { closing.powf(1.0 / law.b) } else { 0.0 },
            recovery: 0.0,
        }
    }

    /// x at an energy release rate.
    #[inline]
    pub fn strain(&self, energy: f64) -> f64 {
        (2.0 * energy / self.modulus).sqrt()
    }

    /// f(D) = E_c/E, through the integrity.
    #[inline]
    pub fn stiffness_ratio(&self, eta: f64) -> f64 {
        let w = integrity(eta);
        w * ((1.0 - self.beta) + self.beta * w) / ((1.0 - self.rho) + self.rho * w)
    }

    /// −[f(D_1) − f(D_0)]/(D_1 − D_0) = β/ρ + [(1 − ρ)(ρ − β)/ρ]/[(1 − ρD_0)(1 − ρD_1)]; −f' if both agree.
    #[inline]
    pub fn stiffness_loss(&self, eta_0: f64, eta_1: f64) -> f64 {
        if self.rho == self.beta {
            return 1.0;
        }
        let rest = |eta: f64| (1.0 - self.rho) + self.rho * integrity(eta);
        self.beta / self.rho + (1.0 - self.rho) * (self.rho - self.beta) / (self.rho * rest(eta_0) * rest(eta_1))
    }

    /// −f'(D) and −f''(D) = 2 (1 − ρ)(ρ − β)/(1 − ρD)³, through the integrity.
    #[inline]
    pub fn stiffness_losses(&self, integrity: f64) -> (f64, f64) {
        if self.rho == self.beta {
            return (1.0, 0.0);
        }
        let per_rest = 1.0 / ((1.0 - self.rho) + self.rho * integrity);
        let numerator = (1.0 - self.rho) * (self.rho - self.beta) * per_rest * per_rest;
        ((self.beta + numerator) / self.rho, 2.0 * numerator * per_rest)
    }

    /// σ'(x)/E = f − 2 Y D̂'(Y) (−f').
    #[inline]
    pub fn slope(&self, energy: f64, eta: f64, rate: f64) -> f64 {
        self.stiffness_ratio(eta) - 2.0 * energy * rate * self.stiffness_loss(eta, eta)
    }

    /// Returns what σ'/E stays above beyond the peak: f > 0, D(1 − D) ≤ 1/4, Y/(Y − Y₀) falls, and w/[(1 − ρ) + ρw]² ≤ 1/[4ρ(1 − ρ)]
    /// with w = 1 − D, in σ'/E = f − 2B Y/(Y − Y₀) D(1 − D)(−f').
    #[inline]
    pub fn slope_bound(&self, peak: &Point) -> f64 {
        let loss = 0.25 * (self.beta + (self.rho - self.beta).max(0.0) / self.rho) / self.rho;
        -2.0 * self.law.b * peak.energy / peak.excess * loss
    }

    /// ∫₀^D Y (−f') dD: E/E* of it is dissipated in uniaxial stress.
    pub fn dissipation(&self, eta: f64) -> f64 {
        let [dissipation] = self.dissipations([eta], [eta.powf(1.0 / self.law.b)]);
        dissipation
    }

    /// [`Self::dissipation`] between two points of the curve, η and Y of each.
    pub fn dissipation_between(&self, start: &Branch, end: &Branch) -> f64 {
        let root = |branch: &Branch| self.law.root_on_curve(branch.eta, branch.maximum);
        let [before, after] = self.dissipations([start.eta, end.eta], [root(start), root(end)]);
        (after - before).max(0.0)
    }

    /// Returns the dissipations of several η ≥ 0 with `roots` = η^(1/B).
    ///
    /// Partial fractions of f leave ∫ Z dD and ∫ Z/(1 − ρD)² dD, both incomplete beta functions, the second
    /// one of (1 − ρ)η.
    #[inline]
    fn dissipations<const N: usize>(&self, etas: [f64; N], roots: [f64; N]) -> [f64; N] {
        let p = 1.0 / self.law.b;
        let (closing, closing_root) = (1.0 - self.rho, self.closing_root);
        let mut excess = excess_integrals(etas, p, roots).map(|integral| self.beta / self.rho * integral);
        if closing_root > 0.0 {
            let weight = (self.rho - self.beta) / (self.rho * closing_root);
            let rest = excess_integrals(etas.map(|eta| closing * eta), p, roots.map(|root| closing_root * root));
            for i in 0..N {
                excess[i] += weight * rest[i];
            }
        }
        std::array::from_fn(|i| self.law.threshold * (1.0 - self.stiffness_ratio(etas[i])) + excess[i] / self.law.a)
    }

    /// The limit of [`Self::dissipation`] for D → 1; B > 1.
    pub fn total_dissipation(&self) -> f64 {
        let p = 1.0 / self.law.b;
        let mut weight = self.beta / self.rho;
        if self.closing_root > 0.0 {
            weight += (self.rho - self.beta) / (self.rho * self.closing_root);
        }
        let beta_function = std::f64::consts::PI * p / (std::f64::consts::PI * p).sin();
        self.law.threshold + weight * beta_function / self.law.a
    }

    /// ∫₀^x σ dx = (E/E*) [f Y + ∫ Y (−f') dD].
    pub fn work(&self, energy: f64, eta: f64) -> f64 {
        self.youngs_modulus / self.modulus * (self.stiffness_ratio(eta) * energy + self.dissipation(eta))
    }

    /// η with f(D) = `ratio`: with m = 1 + η the positive root of
    /// (1 − ρ) m² + (ρ − F(1 − β)) m − F β = 0, F = 1/`ratio`.
    #[inline]
    pub fn eta_of_stiffness(&self, ratio: f64) -> f64 {
        let inverse = 1.0 / ratio;
        let leading = 1.0 - self.rho;
        let linear = self.rho - inverse * (1.0 - self.beta);
        let last = inverse * self.beta;
        let root = (linear * linear + 4.0 * leading * last).sqrt();
        let m = if linear > 0.0 { 2.0 * last / (linear + root) } else { (root - linear) / (2.0 * leading) };
        (m - 1.0).max(0.0)
    }

    /// The point η = e^q of the curve.
    #[inline]
    pub fn point(&self, q: f64) -> Point {
        let eta = q.exp();
        let excess = (q / self.law.b).exp() / self.law.a;
        let energy = self.law.threshold + excess;
        let rate = self.law.b * damage(eta) * integrity(eta) / excess;
        Point { eta, excess, energy, slope: self.slope(energy, eta, rate), strain: self.strain(energy) }
    }
}

/// A point of the uniaxial curve.
#[derive(Clone, Copy, Debug)]
pub(super) struct Point {
    pub eta: f64,
    /// Y − Y₀.
    pub excess: f64,
    /// Y.
    pub energy: f64,
    /// σ'(x)/E.
    pub slope: f64,
    /// x.
    pub strain: f64,
}
