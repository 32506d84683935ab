//! λ(D) of (4.17): how the Poisson effect grows with damage.

use crate::damage_law::integrity;

umat_abi::choices! {
    /// Form of λ(D).
    pub enum LambdaForm {
        /// λ = (1 + cD)/(1 − D), c = 1/α − 1, that is 1 + η/α.
        Rational = 0.0 c"rational",
        /// λ = 1/(1 − D^α) (4.19).
        Power = 1.0 c"power",
    }
}

/// ρ = (1−D)λ, the apparent Poisson ratio over ν, and λ' = dλ/dη, all that Ψ and Y need; both stay
/// bounded as η → ∞.
#[derive(Clone, Copy, Debug)]
pub(super) struct PoissonEffect {
    /// ρ: 1 at D = 0, 1/α at D = 1.
    pub rho: f64,
    /// dλ/dη.
    pub lambda_rate: f64,
}

impl PoissonEffect {
    /// Evaluates λ at one η ≥ 0. For the power form with α < 1, λ' is infinite at η = 0, where only ρ is valid.
    #[inline]
    pub fn new(form: LambdaForm, alpha: f64, eta: f64) -> Self {
        let omega = integrity(eta);
        if form == LambdaForm::Rational || alpha == 1.0 {
            let rate = 1.0 / alpha;
            return Self { rho: omega * (1.0 + rate * eta), lambda_rate: rate };
        }
        if eta == 0.0 {
            return Self { rho: 1.0, lambda_rate: 0.0 };
        }
        // ln D without loss at either end; 1 − D^α likewise
        let log_damage = -(1.0 / eta).ln_1p();
        let rho = omega / -(alpha * log_damage).exp_m1();
        // α D^(α−1) (ωλ)² = dλ/dη, because dD/dη = ω²
        Self { rho, lambda_rate: alpha * ((alpha - 1.0) * log_damage).exp() * rho * rho }
    }

    /// dρ/dη = ω (λ' − ρ).
    pub fn rho_rate(&self, eta: f64) -> f64 {
        integrity(eta) * (self.lambda_rate - self.rho)
    }

    /// d²λ/dη² at one η > 0: 0, or λ' [(α−1) ω²/D + 2ρ'/ρ].
    pub fn lambda_curvature(&self, form: LambdaForm, alpha: f64, eta: f64) -> f64 {
        if form == LambdaForm::Rational || alpha == 1.0 {
            return 0.0;
        }
        let omega = integrity(eta);
        self.lambda_rate * ((alpha - 1.0) * omega / eta + 2.0 * self.rho_rate(eta) / self.rho)
    }
}
