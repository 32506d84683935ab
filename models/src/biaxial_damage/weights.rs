//! The weights that the stress direction gives: r_t of tensile damage (thesis eq. 5.29) and β of the
//! hydrostatic part (eqs 5.30, 5.31 as repaired in doc.md).

use super::effective::{EffectiveStress, Gradient, Kinks};
use umat_abi::law::ConfigurationError;
use umat_abi::table::Field;

/// ω₀: from this ratio of the second to the largest principal stress on, the state is biaxial.
const BLEND_RATIO: f64 = 0.2;
/// Principal stresses below this are a zero state: their ratios would be made of subnormal numbers.
const LEAST_STRESS: f64 = 1e-290;
/// Number of cells in which the least root of β = g(a + βb) is searched where it may not be unique.
const BETA_CELLS: u32 = 64;
/// Bisection alone takes 53; Newton, which leads, takes 3.
const BETA_ITERATIONS: u32 = 80;

umat_abi::choices! {
    /// `beta_mode`.
    pub enum BetaMode {
        /// β_u = |σ_m|/max|σ_p| (eq. 5.30).
        Uniaxial = 0.0 c"uniaxial",
        /// β_b = g(a + β_b b) (eq. 5.31).
        Biaxial = 1.0 c"biaxial",
        /// (1 − w) β_u + w β_b with w from the ratio of the two largest |σ_p|.
        Blend = 2.0 c"blend",
    }
}

umat_abi::choices! {
    /// `weights`.
    pub enum WeightTime {
        /// Weights of the stress sought.
        Implicit = 0.0 c"implicit",
        /// Weights of the last converged stress (Box 5.1).
        Lagged = 1.0 c"lagged",
    }
}

/// A_m, B_m of g(y) = 1 − 1/(1 + A_m y e^(−B_m y)), and which β is used.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct HydrostaticWeight {
    /// A_m, 1/MPa.
    pub a: f64,
    /// B_m, 1/MPa.
    pub b: f64,
    /// Form of β.
    pub mode: BetaMode,
}

/// r_t, r_c = 1 − r_t (kept apart: it loses no digits when small) and β.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Weights {
    pub r_t: f64,
    pub r_c: f64,
    pub beta: f64,
    /// Parts of which β is mixed.
    pub mixture: Mixture,
}

/// β = (1 − w) β_u + w β_b.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Mixture {
    /// w.
    pub blend: f64,
    /// β_u, 0 if never wanted.
    pub uniaxial: f64,
    /// β_b, 0 if w is 0.
    pub biaxial: f64,
}

impl Mixture {
    fn beta(&self) -> f64 {
        match self.blend {
            0.0 => self.uniaxial,
            1.0 => self.biaxial,
            w => (1.0 - w) * self.uniaxial + w * self.biaxial,
        }
    }
}

/// Gradients of r_t and β.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct WeightGradients {
    pub r_t: Gradient,
    pub beta: Gradient,
}

/// False if the principal stresses ∝ q are zero, or so small that their ratios mean nothing.
pub(super) fn has_direction(q: &[f64; 3]) -> bool {
    q.iter().any(|x| x.abs() >= LEAST_STRESS)
}

/// Indices of the largest and second largest |q_i|.
fn two_largest(q: &[f64; 3]) -> (usize, usize) {
    let mut order = [0, 1, 2];
    for (i, j) in [(0, 1), (1, 2), (0, 1)] {
        if q[order[i]].abs() < q[order[j]].abs() {
            order.swap(i, j);
        }
    }
    (order[0], order[1])
}

/// Smoothstep w of ω₂/ω₀ and its derivative with respect to ω₂.
fn blend(ratio: f64) -> (f64, f64) {
    let t = ratio / BLEND_RATIO;
    if t >= 1.0 { (1.0, 0.0) } else { (t * t * (3.0 - 2.0 * t), 6.0 * t * (1.0 - t) / BLEND_RATIO) }
}

/// β_u of principal stresses whose largest is number `largest`.
fn uniaxial(q: &[f64; 3], largest: usize) -> f64 {
    ((q[0] + q[1] + q[2]).abs() / (3.0 * q[largest].abs())).min(1.0)
}

impl Field<3> for HydrostaticWeight {
    fn read([a, b, mode]: [f64; 3]) -> Result<Self, ConfigurationError> {
        Ok(Self { a, b, mode: BetaMode::read([mode])? })
    }
}

impl HydrostaticWeight {
    /// g and g'.
    fn curve(&self, y: f64) -> (f64, f64) {
        let decay = (-self.b * y).exp();
        let h = self.a * (y * decay);
        let slope = self.a * (1.0 - self.b * y) * decay / ((1.0 + h) * (1.0 + h));
        (if h < 1.0 { h / (1.0 + h) } else { 1.0 - 1.0 / (1.0 + h) }, slope)
    }

    /// The least root in [0, 1] of g(a + x b) − x, which is ≥ 0 at 0 and < 0 at 1.
    fn biaxial(&self, a: f64, b: f64) -> f64 {
        let (mut lower, mut upper) = (0.0, 1.0);
        // |g'| ≤ A_m: the root is unique if b A_m < 1
        if b * self.a >= 1.0 {
            for cell in 1..=BETA_CELLS {
                upper = f64::from(cell) / f64::from(BETA_CELLS);
                if self.curve(a + upper * b).0 <= upper {
                    break;
                }
                lower = upper;
            }
        }
        // a Newton step this small leaves an error of its square where |b² g''| < 1
        let enough = if b * (self.a + self.b) < 0.25 { 1e-8 } else { f64::EPSILON };
        let mut x: f64 = lower;
        for _ in 0..BETA_ITERATIONS {
            let (value, slope) = self.curve(a + x * b);
            let residual = value - x;
            if residual > 0.0 {
                lower = x;
            } else {
                upper = x;
            }
            let newton = x + residual / (1.0 - b * slope);
            let next = if newton >= lower && newton <= upper { newton } else { 0.5 * (lower + upper) };
            let done = (next - x).abs() <= enough * next;
            x = next;
            if done {
                break;
            }
        }
        x
    }

    /// Returns which coincidences kink r_t and β.
    pub(super) fn kinks(&self) -> Kinks {
        match self.mode {
            BetaMode::Uniaxial => Kinks { ties: true, blend_ratio: None },
            BetaMode::Biaxial => Kinks { ties: false, blend_ratio: None },
            BetaMode::Blend => Kinks { ties: true, blend_ratio: Some(BLEND_RATIO) },
        }
    }

    /// β_b where it does not depend on m: the energies are constant but in plane stress.
    pub(super) fn constant_biaxial(&self, effective: &EffectiveStress) -> Option<f64> {
        if self.mode == BetaMode::Uniaxial || effective.out_of_plane.is_some() {
            return None;
        }
        let (a, b) = effective.energies(1.0);
        Some(self.biaxial(a, b))
    }

    /// The weights of principal stresses ∝ q at energies a, b (`biaxial`: β_b if known before); `None` for
    /// zero stress, which has no direction.
    pub(super) fn weights(&self, q: &[f64; 3], (a, b): (f64, f64), biaxial: Option<f64>) -> Option<Weights> {
        if !has_direction(q) {
            return None;
        }
        let (first, second) = two_largest(q);
        let scale = q[first].abs();
        let (mut tensile, mut compressive) = (0.0, 0.0);
        for value in q {
            tensile += value.max(0.0) / scale;
            compressive += (-value).max(0.0) / scale;
        }
        let blend = match self.mode {
            BetaMode::Uniaxial => 0.0,
            BetaMode::Biaxial => 1.0,
            BetaMode::Blend => blend(q[second].abs() / scale).0,
        };
        let mixture = Mixture {
            blend,
            uniaxial: if self.mode == BetaMode::Biaxial { 0.0 } else { uniaxial(q, first) },
            biaxial: if blend > 0.0 { biaxial.unwrap_or_else(|| self.biaxial(a, b)) } else { 0.0 },
        };
        let sum = tensile + compressive;
        Some(Weights { r_t: tensile / sum, r_c: compressive / sum, beta: mixture.beta(), mixture })
    }

    /// Bounds of β between two points without a kink between them, where w and β_u are monotone; β_b is
    /// the same at both or, in plane stress, 0 < β_b = g(y) ≤ A_m y for y ≤ `energy`.
    pub(super) fn beta_bounds(&self, ends: [&Weights; 2], biaxial: Option<f64>, energy: f64) -> (f64, f64) {
        let [start, end] = ends.map(|weights| weights.mixture);
        let (u_lower, u_upper) = (start.uniaxial.min(end.uniaxial), start.uniaxial.max(end.uniaxial));
        let (b_lower, b_upper) = biaxial.map_or((0.0, (self.a * energy).min(1.0)), |beta| (beta, beta));
        let mix = |w: f64, u: f64, b: f64| (1.0 - w) * u + w * b;
        (
            mix(start.blend, u_lower, b_lower).min(mix(end.blend, u_lower, b_lower)),
            mix(start.blend, u_upper, b_upper).max(mix(end.blend, u_upper, b_upper)),
        )
    }

    /// Derivatives of the weights at m (doc.md); zero for zero stress.
    pub(super) fn gradients(&self, effective: &EffectiveStress, m: f64, weights: &Weights) -> WeightGradients {
        let q = effective.principal(m);
        if !has_direction(&q) {
            return WeightGradients::default();
        }
        let (first, second) = two_largest(&q);
        // P + N
        let sum: f64 = q.iter().map(|x| x.abs()).sum();
        let share = q.map(|x| match x {
            x if x > 0.0 => weights.r_c / sum,
            x if x < 0.0 => weights.r_t / sum,
            _ => 0.0,
        });
        let mixture = &weights.mixture;
        let (w, w_rate) = match self.mode {
            BetaMode::Blend => blend(q[second].abs() / q[first].abs()),
            _ => (mixture.blend, 0.0),
        };
        let mut beta = Gradient::default();
        if w < 1.0 {
            let mut partial = mean_ratio_partial(&q, first, mixture.uniaxial).map(|x| (1.0 - w) * x);
            let ratio_rate = w_rate * (mixture.biaxial - mixture.uniaxial) / q[first];
            partial[second] += ratio_rate * (q[second] * q[first]).signum();
            partial[first] -= ratio_rate * (q[second] / q[first]).abs();
            beta = effective.lift(partial, m);
        }
        if w > 0.0 {
            let (a, b) = effective.energies(m);
            let slope = self.curve(a + mixture.biaxial * b).1;
            let (a_gradient, b_gradient) = effective.energy_gradients(m);
            let factor = w * slope / (1.0 - b * slope);
            let terms = [(1.0, &beta), (factor, &a_gradient), (factor * mixture.biaxial, &b_gradient)];
            beta = Gradient::combination(terms);
        }
        WeightGradients { r_t: effective.lift(share, m), beta }
    }
}

/// ∂β_u/∂q_i.
fn mean_ratio_partial(q: &[f64; 3], largest: usize, beta_u: f64) -> [f64; 3] {
    let scale = q[largest].abs();
    let mut partial = [(q[0] + q[1] + q[2]).signum() / (3.0 * scale); 3];
    partial[largest] -= beta_u * q[largest].signum() / scale;
    partial
}
