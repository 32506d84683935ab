//! An elastic fibre in a rigid matrix: one-dimensional shear lag.
//!
//! ```text
//! EA u'' = c τ(u)        c = πφ, EA = E πφ²/4, x from the tail (u' = 0) to the exit (P = EA u')
//! ```

use std::f64::consts::PI;

/// A round fibre of finite stiffness, embedded in something rigid.
#[derive(Clone, Copy, Debug)]
pub struct Fibre {
    /// Diameter φ, mm.
    pub diameter: f64,
    /// Young's modulus, MPa.
    pub modulus: f64,
    /// Embedded length L, mm.
    pub length: f64,
}

impl Fibre {
    /// πφ, mm.
    pub fn perimeter(&self) -> f64 {
        PI * self.diameter
    }

    /// EA, N.
    pub fn axial_stiffness(&self) -> f64 {
        self.modulus * PI * self.diameter * self.diameter / 4.0
    }

    /// β = √(k πφ/(EA)), 1/mm.
    pub fn decay(&self, bond_stiffness: f64) -> f64 {
        (bond_stiffness * self.perimeter() / self.axial_stiffness()).sqrt()
    }

    /// Linear bond: P = EA β tanh(βL) u, with u at the exit.
    pub fn elastic_load(&self, bond_stiffness: f64, exit_slip: f64) -> f64 {
        let decay = self.decay(bond_stiffness);
        self.axial_stiffness() * decay * (decay * self.length).tanh() * exit_slip
    }

    /// Linear bond: the tail's slip u/cosh(βL).
    pub fn elastic_tail_slip(&self, bond_stiffness: f64, exit_slip: f64) -> f64 {
        exit_slip / (self.decay(bond_stiffness) * self.length).cosh()
    }

    /// Bond that is linear up to τ_m and drops to τ_f: load and exit slip when a length a has debonded.
    ///
    /// ```text
    /// P(a) = πφ [τ_f a + (τ_m/β) tanh β(L−a)]
    /// u(a) = τ_m/k + (πφ/EA) [τ_f a²/2 + (τ_m a/β) tanh β(L−a)]
    /// ```
    pub fn debonding(&self, bond: &DroppingBond, debonded: f64) -> (f64, f64) {
        let decay = self.decay(bond.stiffness);
        let bonded_part = bond.strength / decay * (decay * (self.length - debonded)).tanh();
        let load = self.perimeter() * (bond.friction * debonded + bonded_part);
        let stretch = bond.friction * debonded * debonded / 2.0 + bonded_part * debonded;
        (load, bond.strength / bond.stiffness + self.perimeter() / self.axial_stiffness() * stretch)
    }

    /// The debonded length at the peak: cosh² β(L−a) = τ_m/τ_f; 0 if the load falls from the start.
    pub fn debonded_at_peak(&self, bond: &DroppingBond) -> f64 {
        let bonded = (bond.strength / bond.friction).sqrt().acosh() / self.decay(bond.stiffness);
        (self.length - bonded).max(0.0)
    }

    /// Constant friction τ on what is still embedded: P = πφ τ (L − s), s the slip of the tail.
    pub fn friction_load(&self, friction: f64, tail_slip: f64) -> f64 {
        self.perimeter() * friction * (self.length - tail_slip).max(0.0)
    }
}

/// τ = k s up to τ_m, then τ_f.
#[derive(Clone, Copy, Debug)]
pub struct DroppingBond {
    /// k, MPa/mm.
    pub stiffness: f64,
    /// τ_m, MPa.
    pub strength: f64,
    /// τ_f < τ_m, MPa.
    pub friction: f64,
}
