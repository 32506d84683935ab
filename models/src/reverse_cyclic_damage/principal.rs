//! Energy, stress and stiffness as functions of the principal strains (doc.md).

use crate::damage_law::{DamageLaw, damage, integrity};
use crate::tensor::{Elasticity, Spectral};

umat_abi::choices! {
    /// Split of the volumetric energy.
    pub enum Variant {
        /// Splits by the sums of the positive and of the negative principal strains (5.1).
        Thesis = 0.0 c"thesis",
        /// Splits by the sign of the volume change.
        Regular = 1.0 c"regular",
    }
}

/// One damage variable at the end of an increment.
pub(super) struct Damage {
    /// η.
    pub eta: f64,
    /// D̂'(Y) while D grows, else 0.
    rate: f64,
}

impl Damage {
    pub fn grown(law: &DamageLaw, release_rate: f64, eta_before: f64) -> Self {
        let eta = law.eta(release_rate);
        if eta > eta_before {
            Self { eta, rate: law.damage_rate(release_rate, eta) }
        } else {
            Self { eta: eta_before, rate: 0.0 }
        }
    }
}

/// H(x) with H(0) = ½.
fn step(x: f64) -> f64 {
    if x > 0.0 {
        1.0
    } else if x < 0.0 {
        0.0
    } else {
        0.5
    }
}

/// The half of the energy that one of D_t, D_c takes away.
#[derive(Clone, Copy)]
struct EnergyShare {
    /// h_i or h̄_i: share of the deviatoric term.
    share: [f64; 3],
    /// v_i or v̄_i.
    volumetric_share: [f64; 3],
    /// p_i or n_i.
    strains: [f64; 3],
    /// V or V̄.
    volume_change: f64,
}

/// The principal strains sorted by sign. A direction that the plane form leaves out has no share.
pub(super) struct SignSplit {
    variant: Variant,
    /// λ, in plane stress νE/(1−ν²).
    lambda: f64,
    shear_modulus: f64,
    values: [f64; 3],
    /// False for a direction that the plane form leaves out.
    present: [bool; 3],
    tension: EnergyShare,
    compression: EnergyShare,
}

impl SignSplit {
    /// 3-D, plane strain, axisymmetry.
    pub fn in_space(variant: Variant, elasticity: &Elasticity, spectral: &Spectral) -> Self {
        Self::new(variant, elasticity.lambda, elasticity.shear_modulus, spectral.values, [true; 3])
    }

    /// The reduced plane stress: direction 3, which the decomposition of a plane strain leaves
    /// exactly as it is, takes no part.
    pub fn in_plane(variant: Variant, elasticity: &Elasticity, spectral: &Spectral) -> Self {
        let nu = elasticity.poisson_ratio;
        let lambda = nu * elasticity.youngs_modulus / (1.0 - nu * nu);
        let present = spectral.directions.map(|direction| direction[2] == 0.0);
        Self::new(variant, lambda, elasticity.shear_modulus, spectral.values, present)
    }

    fn new(variant: Variant, lambda: f64, shear_modulus: f64, values: [f64; 3], present: [bool; 3]) -> Self {
        let of_present = |f: &dyn Fn(usize) -> f64| std::array::from_fn(|i| if present[i] { f(i) } else { 0.0 });
        let positive: [f64; 3] = of_present(&|i| values[i].max(0.0));
        let negative: [f64; 3] = of_present(&|i| values[i].min(0.0));
        let share: [f64; 3] = of_present(&|i| step(values[i]));
        let other_share: [f64; 3] = of_present(&|i| step(-values[i]));
        let part = |share: [f64; 3], strains: [f64; 3], sign: f64| {
            let (volumetric_share, volume_change) = match variant {
                Variant::Thesis => (share, strains.iter().sum()),
                Variant::Regular => {
                    let change: f64 = sign * values.iter().sum::<f64>();
                    // the tangent takes its square: ½, the mean of both sides, at θ = 0
                    (of_present(&|_| step(change).sqrt()), sign * change.max(0.0))
                }
            };
            EnergyShare { share, volumetric_share, strains, volume_change }
        };
        let tension = part(share, positive, 1.0);
        let compression = part(other_share, negative, -1.0);
        Self { variant, lambda, shear_modulus, values, present, tension, compression }
    }

    /// ½λV² + μ Σp².
    fn release_rate(&self, part: &EnergyShare) -> f64 {
        let squares: f64 = part.strains.iter().map(|e| e * e).sum();
        0.5 * self.lambda * part.volume_change * part.volume_change + self.shear_modulus * squares
    }

    /// Y_t (5.6).
    pub fn tensile_release_rate(&self) -> f64 {
        self.release_rate(&self.tension)
    }

    /// Y_c (5.7).
    pub fn compressive_release_rate(&self) -> f64 {
        self.release_rate(&self.compression)
    }

    /// y_i = ∂Y/∂ε_i = λ v_i V + 2μ p_i.
    fn release_rate_gradient(&self, part: &EnergyShare) -> [f64; 3] {
        std::array::from_fn(|i| {
            self.lambda * part.volumetric_share[i] * part.volume_change + 2.0 * self.shear_modulus * part.strains[i]
        })
    }

    /// λ of the cross energy X = λ Σp Σn, which only the thesis's form has.
    fn cross_lambda(&self) -> f64 {
        if self.variant == Variant::Thesis { self.lambda } else { 0.0 }
    }

    /// Ψ.
    pub fn stored_energy(&self, omega_t: f64, omega_c: f64) -> f64 {
        omega_t * self.tensile_release_rate()
            + omega_c * self.compressive_release_rate()
            + self.cross_lambda() * self.tension.volume_change * self.compression.volume_change
    }

    /// σ_i (5.8).
    pub fn principal_stresses(&self, omega_t: f64, omega_c: f64) -> [f64; 3] {
        let (t, c) = (&self.tension, &self.compression);
        let (tensile, compressive) = (self.release_rate_gradient(t), self.release_rate_gradient(c));
        let cross = self.cross_lambda();
        std::array::from_fn(|i| {
            omega_t * tensile[i]
                + omega_c * compressive[i]
                + cross * (t.share[i] * c.volume_change + c.share[i] * t.volume_change)
        })
    }

    /// H_ij = ∂σ_i/∂ε_j.
    pub fn principal_tangent(&self, tensile: &Damage, compressive: &Damage) -> [[f64; 3]; 3] {
        let (t, c) = (&self.tension, &self.compression);
        let (y_t, y_c) = (self.release_rate_gradient(t), self.release_rate_gradient(c));
        let (omega_t, omega_c) = (integrity(tensile.eta), integrity(compressive.eta));
        let cross = self.cross_lambda();
        let mut tangent = [[0.0; 3]; 3];
        for i in 0..3 {
            for j in 0..3 {
                tangent[i][j] = self.lambda
                    * (omega_t * t.volumetric_share[i] * t.volumetric_share[j]
                        + omega_c * c.volumetric_share[i] * c.volumetric_share[j])
                    + cross * (t.share[i] * c.share[j] + c.share[i] * t.share[j])
                    - tensile.rate * y_t[i] * y_t[j]
                    - compressive.rate * y_c[i] * y_c[j];
            }
            tangent[i][i] += 2.0 * self.shear_modulus * (omega_t * t.share[i] + omega_c * c.share[i]);
        }
        tangent
    }

    /// d_12, d_13, d_23.
    pub fn shear_moduli(&self, tensile: &Damage, compressive: &Damage) -> [f64; 3] {
        let (t, c) = (&self.tension, &self.compression);
        let (omega_t, omega_c) = (integrity(tensile.eta), integrity(compressive.eta));
        let twice_shear = 2.0 * self.shear_modulus;
        let omega: [f64; 3] = std::array::from_fn(|i| omega_t * t.share[i] + omega_c * c.share[i]);
        // what σ_i loses when ε_i becomes positive
        let jump =
            self.cross_lambda() * (damage(compressive.eta) * c.volume_change - damage(tensile.eta) * t.volume_change);
        // Principal strains are known to rounding of the largest: closer to 0 than that, a jump has no
        // slope.
        let rounding = f64::EPSILON * self.values[0].abs().max(self.values[2].abs());
        [(0, 1), (0, 2), (1, 2)].map(|(i, j)| {
            if !(self.present[i] && self.present[j]) {
                return 0.0;
            }
            if t.share[i] == t.share[j] {
                return twice_shear * omega[i];
            }
            let distance = self.values[i] - self.values[j];
            twice_shear * (omega[i] * self.values[i] - omega[j] * self.values[j]) / distance
                + (t.share[i] - t.share[j]) * jump / distance.max(rounding)
        })
    }
}
