//! A cantilever with a parabolic end shear in plane stress: Timoshenko & Goodier, *Theory of Elasticity*, § 21, with the
//! root at x = 0 and the load P, positive upwards, at x = L.

/// The cantilever: 0 ≤ x ≤ L, |y| ≤ h/2.
#[derive(Clone, Copy, Debug)]
pub struct Cantilever {
    /// L, mm.
    pub length: f64,
    /// h, mm.
    pub height: f64,
    /// Thickness, mm.
    pub thickness: f64,
    /// Young's modulus, MPa.
    pub modulus: f64,
    /// Poisson's ratio.
    pub poisson: f64,
    /// End load, N.
    pub load: f64,
}

impl Cantilever {
    fn inertia(&self) -> f64 {
        self.thickness * self.height.powi(3) / 12.0
    }

    /// (σ_xx, σ_yy, σ_xy), MPa.
    pub fn stress(&self, [x, y]: [f64; 2]) -> [f64; 3] {
        let factor = self.load / self.inertia();
        [-factor * (self.length - x) * y, 0.0, factor / 2.0 * (self.height * self.height / 4.0 - y * y)]
    }

    /// Displacement, mm; the root's middle neither moves nor turns.
    pub fn displacement(&self, [x, y]: [f64; 2]) -> [f64; 2] {
        let Self { length, height, poisson, .. } = *self;
        let factor = self.load / (6.0 * self.modulus * self.inertia());
        let h2 = height * height / 4.0;
        [
            -factor * y * ((6.0 * length - 3.0 * x) * x + (2.0 + poisson) * (y * y - h2)),
            factor
                * (3.0 * poisson * y * y * (length - x) + (4.0 + 5.0 * poisson) * h2 * x + (3.0 * length - x) * x * x),
        ]
    }

    /// Strain energy, N mm: half the work of the end shear and the root's tractions, by the stresses' integral.
    pub fn strain_energy(&self) -> f64 {
        let Self { length, height, thickness, modulus, poisson, load } = *self;
        let bending = load * load * length.powi(3) / (6.0 * modulus * self.inertia());
        let shear_modulus = modulus / (2.0 * (1.0 + poisson));
        bending + 0.6 * load * load * length / (shear_modulus * height * thickness)
    }
}
