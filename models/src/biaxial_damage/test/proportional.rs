//! Proportional stress states in closed form, against which the law is tested: once the energy release
//! rate Y is chosen, weights, damage, stress and strain are explicit.

use super::super::{BetaMode, Parameters};
use crate::damage_law::DamageLaw;

/// Proportional stress in closed form: at the energy release rate `y` every other quantity is explicit.
pub struct Proportional {
    /// Principal stresses, largest magnitude 1.
    pub direction: [f64; 3],
    /// Parameters of the law; `beta_mode` uniaxial or biaxial.
    pub parameters: Parameters,
}

/// A point of such a path.
pub struct Equilibrium {
    pub strain: [f64; 6],
    pub stress: [f64; 6],
    pub damage: f64,
}

impl Proportional {
    /// The point at Y.
    pub fn at(&self, y: f64) -> Equilibrium {
        let Parameters { elasticity, tension, compression, hydrostatic, .. } = &self.parameters;
        let s = self.direction;
        let (tensile, sum) = s.iter().fold((0.0, 0.0), |(p, all), x| (p + x.max(0.0), all + x.abs()));
        let r_t = tensile / sum;
        let trace: f64 = s.iter().sum();
        let h = hydrostatic.a * y * (-hydrostatic.b * y).exp();
        let beta = if hydrostatic.mode == BetaMode::Uniaxial { trace.abs() / 3.0 } else { h / (1.0 + h) };
        let part = |law: &DamageLaw, r: f64| {
            let x = (law.a * (r * y - law.threshold)).max(0.0).powf(law.b);
            r * x / (1.0 + x)
        };
        let damage = part(tension, r_t) + part(compression, 1.0 - r_t);
        let (mu, k) = (elasticity.shear_modulus, elasticity.bulk_modulus);
        let deviator = s.map(|x| x - trace / 3.0);
        let squares: f64 = deviator.iter().map(|x| x * x).sum();
        let (d, v) = (1.0 - damage, 1.0 - damage * beta);
        let size = (y / (squares / (4.0 * mu * d * d) + beta * trace * trace / (18.0 * k * v * v))).sqrt();
        let strain = |i: usize| size * (deviator[i] / (2.0 * mu * d) + trace / (9.0 * k * v));
        Equilibrium {
            strain: [strain(0), strain(1), strain(2), 0.0, 0.0, 0.0],
            stress: [size * s[0], size * s[1], size * s[2], 0.0, 0.0, 0.0],
            damage,
        }
    }

    /// Y at the largest |σ11| for Y from `lower` to `upper`.
    pub fn peak(&self, lower: f64, upper: f64) -> f64 {
        let size = |log_y: f64| self.at(log_y.exp()).stress[0].abs();
        let step = (upper / lower).ln() / 1000.0;
        let grid = |i: usize| lower.ln() + step * i as f64;
        let best = (0..=1000).max_by(|&i, &j| size(grid(i)).total_cmp(&size(grid(j)))).expect("a grid");
        let (mut lower, mut upper) = (grid(best) - step, grid(best) + step);
        for _ in 0..100 {
            let (a, b) = (lower + (upper - lower) / 3.0, upper - (upper - lower) / 3.0);
            if size(a) < size(b) {
                lower = a;
            } else {
                upper = b;
            }
        }
        lower.exp()
    }
}
