//! Box 5.1: weights and β are those of the last converged stress.

use super::{Components, DamageSurface, Point};
use models::tensor::{Elasticity, Spectral, deviator, strain_norm_squared, trace};

/// Ratio |σ|₂/|σ|₁, as in `biaxial_damage`, at which the biaxial β replaces the uniaxial one. The text leaves it open.
const BLEND_RATIO: f64 = 0.2;

/// Damage, energy release rates and weights of the last step.
pub(super) struct BiaxialDamage {
    elasticity: Elasticity,
    surfaces: [DamageSurface; 2],
    /// A_m, B_m.
    hydrostatic: [f64; 2],
    damage: [f64; 2],
    release_rates: [f64; 2],
    /// `None`: virgin.
    weights: Option<Weights>,
}

/// Weights that follow from the direction of a stress.
#[derive(Clone, Copy)]
struct Weights {
    /// r_t.
    tensile: f64,
    /// β.
    beta: f64,
    /// The β of eq. 5.31, in which its own energy release rate Y_E = a + β b occurs.
    biaxial: f64,
}

impl BiaxialDamage {
    /// Virgin; PROPS as `biaxial_damage` has them, `beta_mode` blend.
    pub fn new(props: &[f64]) -> Self {
        Self {
            elasticity: Elasticity::new(props[0], props[1]),
            surfaces: [DamageSurface::new(&props[2..5]), DamageSurface::new(&props[5..8])],
            hydrostatic: [props[8], props[9]],
            damage: [0.0; 2],
            release_rates: [0.0; 2],
            weights: None,
        }
    }

    /// r_t (eq. 5.29) and β (eqs 5.30, 5.31) of a stress at the energies a and b; `None`: it has no direction.
    fn weights_of(&self, stress: &Components, [a, b]: [f64; 2]) -> Option<Weights> {
        let principal = Spectral::of_stress(stress).values;
        let mut sizes = principal.map(f64::abs);
        sizes.sort_by(f64::total_cmp);
        let [_, second, largest] = sizes;
        let all: f64 = sizes.iter().sum();
        if all == 0.0 {
            return None;
        }
        let tensile: f64 = principal.iter().map(|s| s.max(0.0)).sum();
        let uniaxial = (trace(stress) / 3.0).abs() / largest;
        let y = a + self.weights.map_or(0.0, |weights| weights.biaxial) * b;
        let [rate, decay] = self.hydrostatic;
        let biaxial = 1.0 - 1.0 / (1.0 + rate * y * (-decay * y).exp());
        let t = (second / largest / BLEND_RATIO).min(1.0);
        let blend = t * t * (3.0 - 2.0 * t);
        Some(Weights { tensile: tensile / all, beta: (1.0 - blend) * uniaxial + blend * biaxial, biaxial })
    }
}

impl Point for BiaxialDamage {
    fn update(&mut self, strain: &Components) -> Result<Components, String> {
        let Elasticity { shear_modulus, bulk_modulus, .. } = self.elasticity;
        let volume = trace(strain);
        let shape = deviator(strain);
        let energies = [shear_modulus * strain_norm_squared(&shape), 0.5 * bulk_modulus * volume * volume];
        let first = || self.weights_of(&self.elasticity.stress(strain), energies);
        let Some(weights) = self.weights.or_else(first) else { return Ok([0.0; 6]) };
        let Weights { tensile, beta, .. } = weights;
        // 1 (eqs 5.32, 5.33)
        let total = energies[0] + beta * energies[1];
        let release_rates = [tensile * total, (1.0 - tensile) * total];
        // 2 to 5, tension and compression each for itself
        for k in 0..2 {
            let loads = release_rates[k] >= self.release_rates[k];
            if loads && self.surfaces[k].value(release_rates[k], self.damage[k]) > 0.0 {
                self.damage[k] = self.surfaces[k].damage(release_rates[k]);
            }
        }
        self.release_rates = release_rates;
        // 6 (eq. 5.29)
        let damage = tensile * self.damage[0] + (1.0 - tensile) * self.damage[1];
        // 7 (eq. 5.34)
        let mean = (1.0 - damage * beta) * bulk_modulus * volume;
        let stress = std::array::from_fn(|i| {
            let part = (1.0 - damage) * shear_modulus * shape[i];
            if i < 3 { mean + 2.0 * part } else { part }
        });
        // 9 and 10
        self.weights = self.weights_of(&stress, energies).or(Some(weights));
        Ok(stress)
    }
}
