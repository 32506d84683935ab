//! An elastic cylinder on an elastic half-plane, in plane strain: Johnson, *Contact Mechanics* (1985), § 4.2(c).

/// Two bodies pressed together along a line.
#[derive(Clone, Copy, Debug)]
pub struct LineContact {
    /// Radius of the cylinder, mm.
    pub radius: f64,
    /// Young's modulus and Poisson's ratio of either body.
    pub bodies: [(f64, f64); 2],
}

impl LineContact {
    /// 1/E* = Σ (1 − ν²)/E.
    pub fn modulus(&self) -> f64 {
        1.0 / self.bodies.iter().map(|(modulus, poisson)| (1.0 - poisson * poisson) / modulus).sum::<f64>()
    }

    /// Half width a = √(4PR/(πE*)) under a force per length, N/mm.
    pub fn half_width(&self, force_per_length: f64) -> f64 {
        (4.0 * force_per_length * self.radius / (std::f64::consts::PI * self.modulus())).sqrt()
    }

    /// Peak pressure p_0 = 2P/(πa).
    pub fn peak_pressure(&self, force_per_length: f64) -> f64 {
        2.0 * force_per_length / (std::f64::consts::PI * self.half_width(force_per_length))
    }

    /// p(x) = p_0 √(1 − x²/a²).
    pub fn pressure(&self, force_per_length: f64, x: f64) -> f64 {
        let part = x / self.half_width(force_per_length);
        self.peak_pressure(force_per_length) * (1.0 - part * part).max(0.0).sqrt()
    }
}
