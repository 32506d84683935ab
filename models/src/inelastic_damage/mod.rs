#![doc = include_str!("doc.md")]

use crate::damage_law::{DamageLaw, ETA_MAX, exponent_parameter, integrity, scale_parameter, threshold_parameter};
use crate::linear_elastic::{DISSIPATED_ENERGY, STRAIN_33, poisson_ratio, youngs_modulus};
use crate::tensor::{IsotropicSplit, add_dyad, isotropic_stiffness};
use umat_abi::law::{ConfigurationError, Failure, Increment, Law, LawInfo, Request, Response, StressState};
use umat_abi::metadata::{DerivedOutput, Parameter, StateVariable, flags};
use umat_abi::table::require;

mod closed_criterion;
mod marched_criterion;
mod poisson_effect;

use poisson_effect::PoissonEffect;

pub use poisson_effect::LambdaForm;

#[cfg(test)]
mod test;

umat_abi::parameters! {
    /// The parameters.
    pub struct Parameters {
        /// E.
        youngs_modulus: f64 = youngs_modulus(31800.0);
        /// ν.
        poisson_ratio: f64 = poisson_ratio(0.2);
        /// A, B, Y_0.
        damage_law: DamageLaw =
            scale_parameter(c"A", 2e18).typically(1e-4, 1e20),
            exponent_parameter(c"B", 6.4),
            threshold_parameter(c"Y_0", 6.45e-4);
        /// κ.
        kappa: f64 =
            Parameter::new(c"kappa", c"MPa", 3.5, c"measure of the inelastic strain: > 0 tension, < 0 compression");
        /// α.
        alpha: f64 = Parameter::new(
            c"alpha", c"-", 1.0, c"Poisson effect: the apparent Poisson ratio tends to nu/alpha",
        ).above(0.0);
        /// Form of λ(D).
        lambda_form: LambdaForm =
            Parameter::new(c"lambda_form", c"-", 0.0, c"growth of the Poisson effect with damage")
                .one_of(LambdaForm::CHOICES);
    }
}

umat_abi::states! {
    /// The state variables.
    pub struct State {
        /// η.
        pub eta: f64 = StateVariable::new(c"eta", c"-", c"D/(1 - D)");
        /// ε33.
        pub strain_33: f64 = STRAIN_33;
        /// ∫ Y dD.
        pub dissipated_energy: f64 = DISSIPATED_ENERGY;
    }
}

/// The law.
pub struct InelasticDamage;

impl Law for InelasticDamage {
    const INFO: LawInfo = LawInfo {
        name: c"inelastic_damage",
        description: c"Model II: one damage variable with isotropic inelastic strain",
        derived: &const { [DerivedOutput::damage(c"D", 0)] },
        flags: flags::SYMMETRIC_TANGENT
            | flags::THREAD_SAFE
            | flags::STRESS_ONLY
            | flags::PATH_EXACT
            | flags::ISOTROPIC,
        ..LawInfo::of::<Parameters, State>()
    };

    type Parameters<'p> = Parameters;
    type State = State;

    fn check(parameters: &Parameters) -> Result<(), ConfigurationError> {
        parameters.check_definiteness(2.0)
    }

    fn update(
        parameters: &Parameters,
        increment: &Increment,
        state: &mut State,
        request: Request,
    ) -> Result<Response, Failure> {
        let split = IsotropicSplit::new(increment.stress_state, &increment.strain);
        parameters.check_definiteness(split.dimension())?;
        let before = state.eta;
        let eta = parameters.eta(&split, before)?;
        let end = parameters.equilibrium(&split, eta);

        let mut tangent = [[0.0; 6]; 6];
        if request.wants_tangent() {
            tangent = isotropic_stiffness(increment.stress_state, end.twice_shear, end.bulk);
            if eta > before && eta < ETA_MAX {
                let gradient = parameters.release_rate_gradient(&split, eta);
                let resistance = parameters.damage_law.excess_rate(eta) - parameters.release_rate_slope(&split, eta);
                let omega = integrity(eta);
                add_dyad(&mut tangent, -omega * omega / resistance, &gradient, &gradient);
            }
        }
        state.eta = eta;
        state.strain_33 = match increment.stress_state {
            StressState::PlaneStress => end.strain_33,
            _ => increment.strain[2],
        };
        // dearer than all the rest: only where it can change (0: of a state that a host began with)
        if eta > before || (state.dissipated_energy == 0.0 && eta > 0.0) {
            // the closed form is monotone up to its last digit
            state.dissipated_energy = state.dissipated_energy.max(parameters.damage_law.dissipation(eta));
        }
        Ok(Response {
            stress: split.stress(end.twice_shear, end.bulk * end.elastic_trace),
            tangent,
            stored_energy: 0.5
                * (end.twice_shear * split.deviator_norm_squared() + end.bulk * end.elastic_trace * end.elastic_trace),
            dissipated_energy: state.dissipated_energy,
        })
    }
}

/// The damaged solid at one η.
struct Equilibrium {
    /// 2μ(D) = Eω/R.
    twice_shear: f64,
    /// k_n(D) = Eω/(n S).
    bulk: f64,
    /// t = θ − nκη/E.
    elastic_trace: f64,
    /// −νρ t/S + κη/E: ε33 in plane stress.
    strain_33: f64,
}

impl Parameters {
    /// Ψ(·, D) is positive definite for every D iff −α < ν and (n−1)ν < α: ρ runs from 1 to 1/α.
    fn check_definiteness(&self, dimension: f64) -> Result<(), ConfigurationError> {
        require(self.poisson_ratio > -self.alpha, "alpha must exceed -nu", self.alpha)?;
        let rule =
            if dimension == 2.0 { "alpha must exceed nu" } else { "alpha must exceed 2 nu, except in plane stress" };
        require((dimension - 1.0) * self.poisson_ratio < self.alpha, rule, self.alpha)
    }

    /// λ = 1/(1−D), whichever form: the criterion is a closed one.
    fn has_closed_criterion(&self) -> bool {
        self.alpha == 1.0
    }

    /// η at the end of the increment.
    fn eta(&self, split: &IsotropicSplit, eta_before: f64) -> Result<f64, Failure> {
        if self.has_closed_criterion() {
            closed_criterion::eta(self, split, eta_before)
        } else {
            // a march may step over the largest value
            marched_criterion::eta(self, split, eta_before).map(|eta| eta.min(ETA_MAX))
        }
    }

    fn poisson_effect(&self, eta: f64) -> PoissonEffect {
        PoissonEffect::new(self.lambda_form, self.alpha, eta)
    }

    /// nκη/E, the inelastic trace.
    fn inelastic_trace(&self, dimension: f64, eta: f64) -> f64 {
        dimension * self.kappa * eta / self.youngs_modulus
    }

    /// (R, S) = (1 + νρ, 1 − (n−1)νρ).
    fn denominators(&self, dimension: f64, rho: f64) -> (f64, f64) {
        let nu_rho = self.poisson_ratio * rho;
        (1.0 + nu_rho, 1.0 - (dimension - 1.0) * nu_rho)
    }

    /// w = W_n((κ/E) I_n) = nκ²/(2E(1−(n−1)ν)).
    fn inelastic_work(&self, dimension: f64) -> f64 {
        let (_, s) = self.denominators(dimension, 1.0);
        0.5 * dimension * self.kappa * self.kappa / (self.youngs_modulus * s)
    }

    fn equilibrium(&self, split: &IsotropicSplit, eta: f64) -> Equilibrium {
        let n = split.dimension();
        let rho = self.poisson_effect(eta).rho;
        let (r, s) = self.denominators(n, rho);
        let modulus = self.youngs_modulus * integrity(eta);
        let elastic_trace = split.trace - self.inelastic_trace(n, eta);
        Equilibrium {
            twice_shear: modulus / r,
            bulk: modulus / (n * s),
            elastic_trace,
            strain_33: self.kappa * eta / self.youngs_modulus - self.poisson_ratio * rho * elastic_trace / s,
        }
    }

    /// Y(ε, η).
    fn release_rate(&self, split: &IsotropicSplit, eta: f64) -> f64 {
        let n = split.dimension();
        let effect = self.poisson_effect(eta);
        let (r, s) = self.denominators(n, effect.rho);
        let (r_growth, s_growth) = self.denominators(n, effect.lambda_rate);
        let q = (split.trace - self.inelastic_trace(n, eta)) / s;
        0.5 * self.youngs_modulus * (r_growth * split.deviator_norm_squared() / (r * r) + s_growth * q * q / n)
            + self.kappa * (1.0 + eta) * q
    }

    /// ∂Y/∂η at fixed strain.
    fn release_rate_slope(&self, split: &IsotropicSplit, eta: f64) -> f64 {
        let n = split.dimension();
        if self.has_closed_criterion() {
            // the general expression cancels to this one
            return -2.0 * self.inelastic_work(n) * (1.0 + eta);
        }
        let effect = self.poisson_effect(eta);
        let (r, s) = self.denominators(n, effect.rho);
        let (r_growth, s_growth) = self.denominators(n, effect.lambda_rate);
        let nu = self.poisson_ratio;
        let r_slope = nu * effect.rho_rate(eta);
        let r_curvature = nu * effect.lambda_curvature(self.lambda_form, self.alpha, eta);
        let (s_slope, s_curvature) = (-(n - 1.0) * r_slope, -(n - 1.0) * r_curvature);
        let q = (split.trace - self.inelastic_trace(n, eta)) / s;
        let q_slope = -(self.inelastic_trace(n, 1.0) + q * s_slope) / s;
        let deviatoric = split.deviator_norm_squared() * (r_curvature - 2.0 * r_growth * r_slope / r) / (r * r);
        let volumetric = (s_curvature * q * q + 2.0 * s_growth * q * q_slope) / n;
        0.5 * self.youngs_modulus * (deviatoric + volumetric) + self.kappa * (q + (1.0 + eta) * q_slope)
    }

    /// Y_ε = ∂Y/∂ε, as a stress.
    fn release_rate_gradient(&self, split: &IsotropicSplit, eta: f64) -> [f64; 6] {
        let n = split.dimension();
        let effect = self.poisson_effect(eta);
        let (r, s) = self.denominators(n, effect.rho);
        if self.has_closed_criterion() {
            // K₀ : (ε + (κ/E) I), free of the cancellation below
            return split.stress(self.youngs_modulus / r, (self.youngs_modulus * split.trace / n + self.kappa) / s);
        }
        let (r_growth, s_growth) = self.denominators(n, effect.lambda_rate);
        let q = (split.trace - self.inelastic_trace(n, eta)) / s;
        let mean = (self.youngs_modulus * s_growth * q / n + self.kappa * (1.0 + eta)) / s;
        split.stress(self.youngs_modulus * r_growth / (r * r), mean)
    }
}
