//! The direction of the stress as a function of one scalar: principal σ_i = (1 − D) q_i(m),
//! q_i = 2μ e_i + m k θ, m = (1 − Dβ)/(1 − D) (doc.md), and the energies a, b along it.

use crate::tensor::{Elasticity, Spectral, trace};
use umat_abi::law::StressState;

/// The strain of one update, ready to be evaluated at any m.
///
/// Every q_i = `offset` + `position`(m) · `slope` is linear in a rising function of m: m itself, or in
/// plane stress c = (m k − 2μ/3)/(m k + 4μ/3), for there ε33 = (ε11 + ε22)(2μ/3 − m k)/(4μ/3 + m k) gives
/// q_3 = 0 and q_α = 2μ (ε_α + c (ε11 + ε22)).
#[derive(Clone, Copy, Debug)]
pub(super) struct EffectiveStress {
    elasticity: Elasticity,
    /// The strain; component 33 is 0 in plane stress until m is known.
    strain: [f64; 6],
    /// Principal values of the strain, or in plane stress of its in-plane part.
    pub spectral: Spectral,
    /// Index of the principal direction that is axis 3, in plane stress.
    pub out_of_plane: Option<usize>,
    offset: [f64; 3],
    slope: [f64; 3],
    /// tr ε, or in plane stress ε11 + ε22.
    trace: f64,
}

/// Derivative of a scalar with respect to the free strain components and m.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Gradient {
    /// ∂/∂ε at constant m, stress-like (conjugate to engineering shear).
    pub strain: [f64; 6],
    /// ∂/∂m at constant free strain.
    pub m: f64,
}

impl Gradient {
    /// Σ factor · gradient.
    pub fn combination<const N: usize>(terms: [(f64, &Gradient); N]) -> Self {
        let mut sum = Self::default();
        for (factor, gradient) in terms {
            for i in 0..6 {
                sum.strain[i] += factor * gradient.strain[i];
            }
            sum.m += factor * gradient.m;
        }
        sum
    }
}

/// Coincidences of the q_i that kink the weights.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Kinks {
    /// |q_i| = |q_j|: the largest changes.
    pub ties: bool,
    /// |q_i| = ω₀ |q_j|: the blend begins or ends.
    pub blend_ratio: Option<f64>,
}

/// 3 zeros, 3 + 3 ties, 12 ends of the blend.
pub(super) const MOST_BREAK_POINTS: usize = 21;

impl EffectiveStress {
    /// Decomposes the strain.
    pub fn new(elasticity: &Elasticity, stress_state: StressState, strain: &[f64; 6]) -> Self {
        let two_mu = 2.0 * elasticity.shear_modulus;
        let mut strain = *strain;
        if stress_state == StressState::PlaneStress {
            strain[2] = 0.0;
            let spectral = Spectral::of_strain(&strain);
            let out_of_plane = (0..3).find(|&i| spectral.directions[i][2] != 0.0);
            let trace = strain[0] + strain[1];
            let mut offset = spectral.values.map(|value| two_mu * value);
            let mut slope = [two_mu * trace; 3];
            if let Some(i) = out_of_plane {
                offset[i] = 0.0;
                slope[i] = 0.0;
            }
            Self { elasticity: *elasticity, strain, spectral, out_of_plane, offset, slope, trace }
        } else {
            let spectral = Spectral::of_strain(&strain);
            let trace = trace(&strain);
            let offset = spectral.values.map(|value| two_mu * (value - trace / 3.0));
            let slope = [elasticity.bulk_modulus * trace; 3];
            Self { elasticity: *elasticity, strain, spectral, out_of_plane: None, offset, slope, trace }
        }
    }

    /// True if q does not depend on m.
    pub fn is_constant(&self) -> bool {
        self.slope == [0.0; 3]
    }

    fn plane_stress(&self) -> bool {
        self.out_of_plane.is_some()
    }

    /// 4μ/3 + m k, the denominator of ε33(m).
    fn constrained(&self, m: f64) -> f64 {
        4.0 / 3.0 * self.elasticity.shear_modulus + m * self.elasticity.bulk_modulus
    }

    fn position(&self, m: f64) -> f64 {
        if self.plane_stress() { 1.0 - 2.0 * self.elasticity.shear_modulus / self.constrained(m) } else { m }
    }

    /// The m of a position.
    fn multiplier(&self, position: f64) -> f64 {
        if self.plane_stress() {
            let two_mu = 2.0 * self.elasticity.shear_modulus;
            (two_mu / (1.0 - position) - 2.0 / 3.0 * two_mu) / self.elasticity.bulk_modulus
        } else {
            position
        }
    }

    /// q(m).
    pub fn principal(&self, m: f64) -> [f64; 3] {
        let position = self.position(m);
        std::array::from_fn(|i| self.offset[i] + position * self.slope[i])
    }

    /// ε33/(ε11 + ε22) in plane stress.
    fn lateral_ratio(&self, m: f64) -> f64 {
        2.0 * self.elasticity.shear_modulus / self.constrained(m) - 1.0
    }

    /// ∂ε33/∂m in plane stress, else 0.
    pub fn strain_33_rate(&self, m: f64) -> f64 {
        if !self.plane_stress() {
            return 0.0;
        }
        let constrained = self.constrained(m);
        -2.0 * self.elasticity.shear_modulus / constrained * (self.elasticity.bulk_modulus / constrained) * self.trace
    }

    /// ∂ε33/∂ε11 = ∂ε33/∂ε22 at constant m in plane stress, else 0.
    pub fn strain_33_ratio(&self, m: f64) -> f64 {
        if self.plane_stress() { self.lateral_ratio(m) } else { 0.0 }
    }

    /// The strain, in plane stress with ε33(m).
    pub fn strain(&self, m: f64) -> [f64; 6] {
        let mut strain = self.strain;
        if self.plane_stress() {
            strain[2] = self.lateral_ratio(m) * self.trace;
        }
        strain
    }

    /// tr ε, in plane stress with ε33(m): 2μ (ε11 + ε22)/(4μ/3 + m k).
    pub fn volumetric(&self, m: f64) -> f64 {
        if self.plane_stress() {
            2.0 * self.elasticity.shear_modulus / self.constrained(m) * self.trace
        } else {
            self.trace
        }
    }

    /// a = μ e:e and b = k θ²/2.
    pub fn energies(&self, m: f64) -> (f64, f64) {
        let theta = self.volumetric(m);
        let mut values = self.spectral.values;
        if let Some(i) = self.out_of_plane {
            values[i] = self.lateral_ratio(m) * self.trace;
        }
        let squares: f64 = values.iter().map(|value| (value - theta / 3.0).powi(2)).sum();
        (self.elasticity.shear_modulus * squares, 0.5 * self.elasticity.bulk_modulus * theta * theta)
    }

    /// A bound of a + b over all m: exact in 3-D; in plane stress the value at m → ∞, where θ = 0,
    /// because the elastic energy grows from its minimum in ε33, which is at m = 1.
    pub fn energy_bound(&self) -> f64 {
        let (a, b) = self.energies(1.0);
        if self.plane_stress() {
            let squares: f64 = self.spectral.values.iter().map(|value| value * value).sum();
            (a + b).max(self.elasticity.shear_modulus * (squares + self.trace * self.trace))
        } else {
            a + b
        }
    }

    /// The m in (1, upper) at which the weights have kinks, ascending; returns how many.
    pub fn break_points(&self, kinks: Kinks, upper: f64, points: &mut [f64; MOST_BREAK_POINTS]) -> usize {
        let mut count = 0;
        // q_i = factor · q_j
        let mut add = |i: usize, j: usize, factor: f64| {
            let slope = self.slope[i] - factor * self.slope[j];
            let m = self.multiplier((factor * self.offset[j] - self.offset[i]) / slope);
            if m > 1.0 && m < upper && count < MOST_BREAK_POINTS {
                points[count] = m;
                count += 1;
            }
        };
        for i in 0..3 {
            add(i, i, 0.0);
            for j in 0..3 {
                if kinks.ties && j > i {
                    add(i, j, 1.0);
                    add(i, j, -1.0);
                }
                if let Some(ratio) = kinks.blend_ratio
                    && j != i
                {
                    add(i, j, ratio);
                    add(i, j, -ratio);
                }
            }
        }
        points[..count].sort_unstable_by(f64::total_cmp);
        count
    }

    /// ∂/∂(free strain, m) from ∂/∂(strain, m): in plane stress ε33 follows the others.
    fn reduced(&self, mut strain: [f64; 6], rate: f64, m: f64) -> Gradient {
        if !self.plane_stress() {
            return Gradient { strain, m: rate };
        }
        let normal = strain[2];
        strain[0] += normal * self.lateral_ratio(m);
        strain[1] += normal * self.lateral_ratio(m);
        strain[2] = 0.0;
        Gradient { strain, m: rate + normal * self.strain_33_rate(m) }
    }

    /// Gradients of a and b: ∂a/∂ε = 2μ e, ∂b/∂ε = k θ I.
    pub fn energy_gradients(&self, m: f64) -> (Gradient, Gradient) {
        let mean = self.elasticity.bulk_modulus * self.volumetric(m);
        let a = self.deviatoric_stress(m);
        (self.reduced(a, 0.0, m), self.reduced([mean, mean, mean, 0.0, 0.0, 0.0], 0.0, m))
    }

    /// 2μ e.
    pub fn deviatoric_stress(&self, m: f64) -> [f64; 6] {
        let mean = self.volumetric(m) / 3.0;
        let mu = self.elasticity.shear_modulus;
        let strain = self.strain(m);
        std::array::from_fn(|i| if i < 3 { 2.0 * mu * (strain[i] - mean) } else { mu * strain[i] })
    }

    /// The gradient of a function of q with partial derivatives φ_i: 2μ dev(Σ φ_i N_i) + m k (Σ φ_i) I,
    /// and k θ Σ φ_i for m (doc.md). In plane stress q_3 stays 0: its φ does not count.
    pub fn lift(&self, mut partial: [f64; 3], m: f64) -> Gradient {
        if let Some(i) = self.out_of_plane {
            partial[i] = 0.0;
        }
        let (mu, k) = (self.elasticity.shear_modulus, self.elasticity.bulk_modulus);
        let sum: f64 = partial.iter().sum();
        let mut strain = self.spectral.stress(&partial).map(|component| 2.0 * mu * component);
        for normal in &mut strain[..3] {
            *normal += sum * (m * k - 2.0 * mu / 3.0);
        }
        self.reduced(strain, k * self.volumetric(m) * sum, m)
    }
}
