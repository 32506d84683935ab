//! Box 4.2 with λ = 1/(1−D) (α = 1): Newton's method for stress and damage together (eqs 4.28–4.30 as corrected).

use super::{Components, DamageSurface, Point};
use models::tensor::trace;
use nalgebra::{SMatrix, SVector};

/// σ and D of the last step.
pub(super) struct InelasticDamage {
    youngs_modulus: f64,
    poisson_ratio: f64,
    surface: DamageSurface,
    kappa: f64,
    damage: f64,
    release_rate: f64,
}

/// Iterations before a step is given up.
const MOST_ITERATIONS: usize = 60;
/// Size of the last step relative to σ and D: convergence is quadratic, and the remaining error is its square.
const TOLERANCE: f64 = 1e-10;
/// Damage from which the first iteration starts if D = 0: Z' is infinite there.
const LEAST_DAMAGE: f64 = 1e-8;

type Unknowns = SVector<f64, 7>;
type Jacobian = SMatrix<f64, 7, 7>;

impl InelasticDamage {
    /// Virgin; PROPS as `inelastic_damage` has them, with α = 1.
    pub fn new(props: &[f64]) -> Self {
        Self {
            youngs_modulus: props[0],
            poisson_ratio: props[1],
            surface: DamageSurface::new(&props[2..5]),
            kappa: props[5],
            damage: 0.0,
            release_rate: 0.0,
        }
    }

    /// The stress at fixed damage (eq. 4.27 is linear): 2μ e + k tr(ε) I, of ε − κ D/(E(1−D)) I.
    fn stress(&self, strain: &Components, damage: f64) -> Components {
        let (e, nu) = (self.youngs_modulus * (1.0 - damage), self.poisson_ratio);
        let inelastic = self.kappa * damage / e;
        let (mu, lambda) = (e / (2.0 * (1.0 + nu)), e * nu / ((1.0 + nu) * (1.0 - 2.0 * nu)));
        let volume = trace(strain) - 3.0 * inelastic;
        std::array::from_fn(
            |i| {
                if i < 3 { lambda * volume + 2.0 * mu * (strain[i] - inelastic) } else { mu * strain[i] }
            },
        )
    }

    /// ∂Y/∂σ = ∂ε/∂D and Y(σ, D): Y = [(1+ν) σ:σ − ν tr²σ + 2κ tr σ]/(2E(1−D)²).
    fn release(&self, stress: &Components, damage: f64) -> (Components, f64) {
        let nu = self.poisson_ratio;
        let sum = trace(stress);
        let factor = 1.0 / (self.youngs_modulus * (1.0 - damage).powi(2));
        let gradient = std::array::from_fn(|i| {
            if i < 3 {
                factor * ((1.0 + nu) * stress[i] - nu * sum + self.kappa)
            } else {
                factor * 2.0 * (1.0 + nu) * stress[i]
            }
        });
        let norm: f64 = stress.iter().enumerate().map(|(i, s)| s * s * if i < 3 { 1.0 } else { 2.0 }).sum();
        (gradient, 0.5 * factor * ((1.0 + nu) * norm - nu * sum * sum + 2.0 * self.kappa * sum))
    }

    /// F₁ = ε(σ, D) − ε, F₂ = Y(σ, D) − Y₀ − Z(D), and their derivatives.
    fn equations(&self, strain: &Components, stress: &Components, damage: f64) -> (Unknowns, Jacobian) {
        let (e, nu) = (self.youngs_modulus * (1.0 - damage), self.poisson_ratio);
        let sum = trace(stress);
        let (gradient, release_rate) = self.release(stress, damage);
        let mut residual = Unknowns::zeros();
        let mut jacobian = Jacobian::zeros();
        for i in 0..6 {
            let computed = if i < 3 {
                ((1.0 + nu) * stress[i] - nu * sum + self.kappa * damage) / e
            } else {
                2.0 * (1.0 + nu) * stress[i] / e
            };
            residual[i] = computed - strain[i];
            for j in 0..3 {
                if i < 3 {
                    jacobian[(i, j)] = -nu / e;
                }
            }
            jacobian[(i, i)] += if i < 3 { (1.0 + nu) / e } else { 2.0 * (1.0 + nu) / e };
            jacobian[(i, 6)] = gradient[i];
            jacobian[(6, i)] = gradient[i];
        }
        residual[6] = self.surface.value(release_rate, damage);
        let b = self.surface.b;
        let hardening = (damage / (1.0 - damage)).powf(1.0 / b - 1.0) / (self.surface.a * b * (1.0 - damage).powi(2));
        jacobian[(6, 6)] = 2.0 * release_rate / (1.0 - damage) - hardening;
        (residual, jacobian)
    }

    /// Step 5.
    fn iterate(&self, strain: &Components, predictor: &Components) -> Result<(Components, f64), String> {
        let mut damage = self.damage.max(LEAST_DAMAGE);
        let mut stress = *predictor;
        for _ in 0..MOST_ITERATIONS {
            let (residual, jacobian) = self.equations(strain, &stress, damage);
            let step = jacobian.lu().solve(&residual).ok_or("Box 4.2: the Jacobian is singular")?;
            if !step.iter().all(|component| component.is_finite()) {
                return Err("Box 4.2: Newton's method diverges".into());
            }
            let size = stress.iter().fold(0.0_f64, |size, s| size.max(s.abs()));
            let change = (0..6).fold(0.0_f64, |change, i| change.max(step[i].abs()));
            for i in 0..6 {
                stress[i] -= step[i];
            }
            // never beyond D = 1, nor back below where it starts
            let next = (damage - step[6]).min(0.5 * (1.0 + damage)).max(0.5 * damage);
            let moved = (next - damage).abs();
            damage = next;
            if change <= TOLERANCE * size && moved <= TOLERANCE * damage {
                return Ok((stress, damage));
            }
        }
        Err("Box 4.2: Newton's method does not converge".into())
    }
}

impl Point for InelasticDamage {
    fn update(&mut self, strain: &Components) -> Result<Components, String> {
        // 1: the stress at the old damage
        let mut stress = self.stress(strain, self.damage);
        let (_, predicted) = self.release(&stress, self.damage);
        // 2 to 4
        let was_damaging = self.surface.value(self.release_rate, self.damage) >= 0.0;
        let unloads = was_damaging && predicted < self.release_rate;
        self.release_rate = predicted;
        if !unloads && self.surface.value(predicted, self.damage) > 0.0 {
            // 5 and 7
            (stress, self.damage) = self.iterate(strain, &stress)?;
            let eta = self.damage / (1.0 - self.damage);
            self.release_rate = self.surface.threshold + eta.powf(1.0 / self.surface.b) / self.surface.a;
        }
        Ok(stress)
    }
}
