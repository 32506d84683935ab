#![doc = include_str!("doc.md")]

use crate::damage_law::{DamageLaw, damage};
use crate::linear_elastic::{DISSIPATED_ENERGY, STRAIN_33, poisson_ratio, youngs_modulus};
use crate::tensor::{Elasticity, work};
use effective::EffectiveStress;
use equation::{Trial, Update};
use umat_abi::law::{Failure, Increment, Law, LawInfo, Request, Response, StressState};
use umat_abi::metadata::{DerivedOutput, Parameter, StateVariable, flags};
use weights::{Mixture, WeightGradients, Weights, has_direction};

mod effective;
mod equation;
mod root;
mod tangent;
mod weights;

pub use weights::{BetaMode, HydrostaticWeight, WeightTime};

#[cfg(test)]
mod test;

/// The law.
pub struct BiaxialDamage;

umat_abi::parameters! {
    /// The parameters.
    pub struct Parameters {
        /// E, ν.
        pub elasticity: Elasticity = youngs_modulus(31800.0), poisson_ratio(0.18);
        /// A_t, B_t, Y_t0.
        pub tension: DamageLaw =
            Parameter::new(c"A_t", c"1/MPa", 7000.0, c"rate of tensile damage").at_least(0.0).typically(1e-4, 1e6),
            Parameter::new(c"B_t", c"-", 1.1, c"exponent of tensile damage").above(0.0),
            Parameter::new(c"Y_t0", c"MPa", 1.9e-4, c"threshold of tensile damage").at_least(0.0).typically(1e-7, 0.1);
        /// A_c, B_c, Y_c0.
        pub compression: DamageLaw =
            Parameter::new(c"A_c", c"1/MPa", 29.0, c"rate of compressive damage").at_least(0.0).typically(1e-4, 1e6),
            Parameter::new(c"B_c", c"-", 0.94, c"exponent of compressive damage").above(0.0),
            Parameter::new(c"Y_c0", c"MPa", 3.0e-4, c"threshold of compressive damage")
                .at_least(0.0)
                .typically(1e-7, 1.0);
        /// A_m, B_m, `beta_mode`.
        pub hydrostatic: HydrostaticWeight =
            Parameter::new(c"A_m", c"1/MPa", 2.0, c"rate of the biaxial hydrostatic weight").at_least(0.0),
            Parameter::new(c"B_m", c"1/MPa", 0.7, c"decay of the biaxial hydrostatic weight").at_least(0.0),
            Parameter::new(c"beta_mode", c"-", 2.0, c"weighting of the hydrostatic part").one_of(BetaMode::CHOICES);
        /// Stress from which the weights are computed.
        pub weights: WeightTime =
            Parameter::new(c"weights", c"-", 0.0, c"weights of the current stress, or of the last converged one")
                .one_of(WeightTime::CHOICES);
    }
}

umat_abi::states! {
    /// The state variables.
    pub struct State {
        /// η_t.
        pub eta_t: f64 = StateVariable::new(c"eta_t", c"-", c"D_t/(1 - D_t) of tensile damage");
        /// η_c.
        pub eta_c: f64 = StateVariable::new(c"eta_c", c"-", c"D_c/(1 - D_c) of compressive damage");
        /// The largest Y_t.
        pub y_t_max: f64 = StateVariable::new(c"Y_t_max", c"MPa", c"largest tensile energy release rate so far");
        /// The largest Y_c.
        pub y_c_max: f64 = StateVariable::new(c"Y_c_max", c"MPa", c"largest compressive energy release rate so far");
        /// D.
        pub damage: f64 = StateVariable::new(c"D", c"-", c"active damage r_t D_t + r_c D_c");
        /// β.
        pub beta: f64 = StateVariable::new(c"beta", c"-", c"hydrostatic weight of the current stress");
        /// r_t.
        pub r_t: f64 = StateVariable::new(c"r_t", c"-", c"tensile weight of the current stress");
        /// ε33.
        pub strain_33: f64 = STRAIN_33;
        /// The work balance.
        pub dissipated_energy: f64 = DISSIPATED_ENERGY;
    }
}

/// Largest number below 1: D rounds to 1 where 1 − D is below the last digit.
const LARGEST_DAMAGE: f64 = 1.0 - f64::EPSILON / 2.0;
/// Suggested fraction of an increment that has no solution.
const CUT_BACK: f64 = 0.25;

/// Source of a step's weights.
#[derive(Clone, Copy, Debug)]
enum WeightSource {
    /// Weights that follow m.
    Implicit,
    /// Weights of the elastic stress at this strain: the first step of the lagged form.
    Elastic(Weights),
    /// Weights that the last converged stress left; also at zero stress, which has no direction.
    Stored(Weights),
}

impl WeightSource {
    fn new(parameters: &Parameters, effective: &EffectiveStress, biaxial: Option<f64>, state: &State) -> Self {
        let stored = Weights { r_t: state.r_t, r_c: 1.0 - state.r_t, beta: state.beta, mixture: Mixture::default() };
        let q = effective.principal(1.0);
        // a maximum of Y is 0 only if the strain was always zero
        let virgin = state.y_t_max == 0.0 && state.y_c_max == 0.0;
        let lagged = parameters.weights == WeightTime::Lagged;
        if !has_direction(&q) || (lagged && !virgin) {
            Self::Stored(stored)
        } else if lagged {
            let elastic = parameters.hydrostatic.weights(&q, effective.energies(1.0), biaxial);
            Self::Elastic(elastic.unwrap_or(stored))
        } else {
            Self::Implicit
        }
    }

    /// Weights that do not follow m.
    fn fixed(&self) -> Option<Weights> {
        match *self {
            Self::Implicit => None,
            Self::Elastic(weights) | Self::Stored(weights) => Some(weights),
        }
    }

    fn gradients(&self, parameters: &Parameters, effective: &EffectiveStress, trial: &Trial) -> WeightGradients {
        match self {
            Self::Implicit => parameters.hydrostatic.gradients(effective, trial.m, &trial.weights),
            Self::Elastic(weights) => {
                let mut gradients = parameters.hydrostatic.gradients(effective, 1.0, weights);
                gradients.r_t.m = 0.0;
                gradients.beta.m = 0.0;
                gradients
            }
            Self::Stored(_) => WeightGradients::default(),
        }
    }
}

/// σ = (1 − D)(2μ e + m k θ I).
fn stress(parameters: &Parameters, effective: &EffectiveStress, trial: &Trial) -> [f64; 6] {
    let integrity = trial.integrity();
    let volumetric = trial.m * integrity * (parameters.elasticity.bulk_modulus * effective.volumetric(trial.m));
    let mut stress = effective.deviatoric_stress(trial.m).map(|component| integrity * component);
    for normal in &mut stress[..3] {
        *normal += volumetric;
    }
    if effective.out_of_plane.is_some() {
        stress[2] = 0.0;
    }
    stress
}

impl Law for BiaxialDamage {
    const INFO: LawInfo = LawInfo {
        name: c"biaxial_damage",
        description:
            c"Biaxial damage of concrete (thesis model IV): tension, compression and weighted hydrostatic part",
        derived: &const { [DerivedOutput::damage(c"D_t", 0), DerivedOutput::damage(c"D_c", 1)] },
        flags: flags::THREAD_SAFE | flags::STRESS_ONLY | flags::ISOTROPIC,
        ..LawInfo::of::<Parameters, State>()
    };

    type Parameters<'p> = Parameters;
    type State = State;

    fn update(
        parameters: &Parameters,
        increment: &Increment,
        state: &mut State,
        request: Request,
    ) -> Result<Response, Failure> {
        let history = *state;
        let effective = EffectiveStress::new(&parameters.elasticity, increment.stress_state, &increment.strain);
        if !effective.energy_bound().is_finite() {
            return Err(Failure::CutBack { fraction: CUT_BACK, reason: "the elastic energy is not finite" });
        }
        let biaxial = parameters.hydrostatic.constant_biaxial(&effective);
        let source = WeightSource::new(parameters, &effective, biaxial, state);
        let trial = Update { parameters, history: &history, effective: &effective, fixed: source.fixed(), biaxial }
            .solve()
            .ok_or(Failure::CutBack { fraction: CUT_BACK, reason: "no stress direction satisfies m = M(m)" })?;
        let stress = stress(parameters, &effective, &trial);
        let tangent = if !request.wants_tangent() {
            [[0.0; 6]; 6]
        } else if trial.eta_t == 0.0 && trial.eta_c == 0.0 {
            parameters.elasticity.tangent(increment.stress_state == StressState::PlaneStress, request)
        } else {
            let gradients = source.gradients(parameters, &effective, &trial);
            tangent::consistent_tangent(parameters, &history, &effective, &trial, &gradients)
        };
        let strain = effective.strain(trial.m);
        commit(parameters, &effective, &trial, state);
        state.strain_33 = strain[2];
        state.dissipated_energy += work_balance(increment, &strain, &stress);
        let stored_energy = 0.5 * work(&stress, &strain);
        Ok(Response { stress, tangent, stored_energy, dissipated_energy: state.dissipated_energy })
    }
}

/// σ_mid : Δε − ΔΨ, which with Ψ = ½ σ:ε is ½ (σ_n : ε_{n+1} − σ_{n+1} : ε_n). It may be negative.
fn work_balance(increment: &Increment, strain: &[f64; 6], stress: &[f64; 6]) -> f64 {
    let mut start = [0.0; 6];
    let mut end = [0.0; 6];
    for &i in increment.stress_state.components() {
        start[i] = increment.strain[i] - increment.strain_increment[i];
        end[i] = strain[i];
    }
    0.5 * (work(&increment.stress, &end) - work(stress, &start))
}

/// Writes damage and the weights of the converged stress.
fn commit(parameters: &Parameters, effective: &EffectiveStress, trial: &Trial, state: &mut State) {
    (state.eta_t, state.eta_c) = (trial.eta_t, trial.eta_c);
    state.y_t_max = state.y_t_max.max(trial.y_t());
    state.y_c_max = state.y_c_max.max(trial.y_c());
    state.damage = damage(trial.ratio).min(LARGEST_DAMAGE);
    let weights = if parameters.weights == WeightTime::Lagged {
        let q = effective.principal(trial.m);
        parameters.hydrostatic.weights(&q, effective.energies(trial.m), None).unwrap_or(trial.weights)
    } else {
        trial.weights
    };
    (state.beta, state.r_t) = (weights.beta, weights.r_t);
}
