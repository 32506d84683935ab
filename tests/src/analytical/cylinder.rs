//! A thick-walled cylinder under internal pressure in plane strain: Lamé (1852); Hill, *The Mathematical Theory of
//! Plasticity* (1950), chapter V, with Mises' criterion as 2τ_max = Y = 2σ_y/√3.

/// The cylinder.
#[derive(Clone, Copy, Debug)]
pub struct Cylinder {
    /// Inner radius a, mm.
    pub inner: f64,
    /// Outer radius b, mm.
    pub outer: f64,
    /// Young's modulus, MPa.
    pub modulus: f64,
    /// Poisson's ratio.
    pub poisson: f64,
}

impl Cylinder {
    /// (σ_r, σ_θ) at a radius, elastic.
    pub fn elastic_stress(&self, pressure: f64, radius: f64) -> (f64, f64) {
        let (a2, b2) = (self.inner * self.inner, self.outer * self.outer);
        let factor = pressure * a2 / (b2 - a2);
        let ratio = b2 / (radius * radius);
        (factor * (1.0 - ratio), factor * (1.0 + ratio))
    }

    /// Radial displacement at a radius, elastic, mm.
    pub fn elastic_displacement(&self, pressure: f64, radius: f64) -> f64 {
        let (a2, b2) = (self.inner * self.inner, self.outer * self.outer);
        let Self { modulus, poisson, .. } = *self;
        (1.0 + poisson) * pressure * a2 / (modulus * (b2 - a2)) * ((1.0 - 2.0 * poisson) * radius + b2 / radius)
    }

    /// The pressure that brings the plastic front to c: p = Y [ln(c/a) + ½(1 − c²/b²)].
    pub fn pressure_of_front(&self, yield_stress: f64, front: f64) -> f64 {
        let shear = 2.0 * yield_stress / 3.0_f64.sqrt();
        shear * ((front / self.inner).ln() + 0.5 * (1.0 - (front / self.outer).powi(2)))
    }

    /// The pressure at which all of it flows: p = Y ln(b/a).
    pub fn limit_pressure(&self, yield_stress: f64) -> f64 {
        2.0 * yield_stress / 3.0_f64.sqrt() * (self.outer / self.inner).ln()
    }

    /// Displacement of the outer surface when the front is at c: u_b = Y c² (1 − ν²)/(E b).
    pub fn outer_displacement(&self, yield_stress: f64, front: f64) -> f64 {
        let shear = 2.0 * yield_stress / 3.0_f64.sqrt();
        shear * front * front * (1.0 - self.poisson * self.poisson) / (self.modulus * self.outer)
    }
}
