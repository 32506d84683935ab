//! A fibre that slides over a circular channel: Euler and Eytelwein's rope friction, with bond in addition.
//!
//! ```text
//! dT/dθ = (r/R) (μ T + q r)          r: channel, R: line of the fibre's force, q: bond per length
//! T = T₁ eˣ + q r θ (r/R) (eˣ − 1)/x          x = μ θ r/R
//! ```
//!
//! Bond and friction act at r and the force at R, so that their moments about the centre balance as T R. A thin fibre has
//! R = r; then T = (T₁ + q r/μ) e^(μθ) − q r/μ, and T = e^(μθ) P₀ with the load P₀ without friction if q = 0 on the arc.

/// A fibre over an arc.
#[derive(Clone, Copy, Debug)]
pub struct Capstan {
    /// r, where the fibre touches the channel, mm.
    pub radius: f64,
    /// R, of the line along which it is pulled, mm.
    pub line_radius: f64,
    /// θ, radians.
    pub angle: f64,
    /// μ.
    pub friction: f64,
    /// q, N/mm.
    pub bond: f64,
}

impl Capstan {
    /// The pull that makes the fibre slide when it is held back by a force, N.
    pub fn pull(&self, held_back: f64) -> f64 {
        let lever = self.radius / self.line_radius;
        let exponent = self.friction * self.angle * lever;
        let mean_gain = if exponent == 0.0 { 1.0 } else { exponent.exp_m1() / exponent };
        held_back * exponent.exp() + self.bond * self.radius * self.angle * lever * mean_gain
    }

    /// e^(μθ) times the pull P₀ without friction, N: what bond on the arc is often taken to give.
    pub fn amplified_pull(&self, held_back: f64) -> f64 {
        (self.friction * self.angle).exp() * Self { friction: 0.0, ..*self }.pull(held_back)
    }
}
