#![doc = include_str!("doc.md")]

use crate::damage_law::{DamageLaw, damage};
use crate::linear_elastic::{DISSIPATED_ENERGY, STRAIN_33, poisson_ratio, youngs_modulus};
use crate::tensor::{Elasticity, work};
use effective::EffectiveStress;
use equation::{History, Trial, Update};
use umat_abi::law::{ConfigurationError, Failure, Increment, Law, LawInfo, Request, Response, StressState};
use umat_abi::metadata::{Choice, DerivedOutput, Parameter, StateVariable, flags};
use weights::{Mixture, WeightGradients, Weights, has_direction};

mod effective;
mod equation;
mod root;
mod tangent;
mod weights;

pub use weights::{BetaMode, HydrostaticWeight};

#[cfg(test)]
mod proportional;
#[cfg(any(test, feature = "stability"))]
pub(crate) mod samples;
#[cfg(test)]
mod test;

/// The law.
pub struct BiaxialDamage;

/// The parameters as the equations name them.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Parameters {
    /// E, ν.
    pub elasticity: Elasticity,
    /// A_t, B_t, Y_t0.
    pub tension: DamageLaw,
    /// A_c, B_c, Y_c0.
    pub compression: DamageLaw,
    /// A_m, B_m, `beta_mode`.
    pub hydrostatic: HydrostaticWeight,
    /// `weights` = 1: those of the last converged stress (Box 5.1).
    pub lagged: bool,
}

const BETA_MODES: [Choice; 3] =
    [Choice::new(0.0, c"uniaxial"), Choice::new(1.0, c"biaxial"), Choice::new(2.0, c"blend")];
const WEIGHTS: [Choice; 2] = [Choice::new(0.0, c"implicit"), Choice::new(1.0, c"lagged")];

const PARAMETERS: [Parameter; 12] = [
    youngs_modulus(31800.0),
    poisson_ratio(0.18),
    Parameter::new(c"A_t", c"1/MPa", 7000.0, c"rate of tensile damage").at_least(0.0),
    Parameter::new(c"B_t", c"-", 1.1, c"exponent of tensile damage").above(0.0),
    Parameter::new(c"Y_t0", c"MPa", 1.9e-4, c"threshold of tensile damage").at_least(0.0).typically(1e-7, 0.1),
    Parameter::new(c"A_c", c"1/MPa", 29.0, c"rate of compressive damage").at_least(0.0),
    Parameter::new(c"B_c", c"-", 0.94, c"exponent of compressive damage").above(0.0),
    Parameter::new(c"Y_c0", c"MPa", 3.0e-4, c"threshold of compressive damage").at_least(0.0).typically(1e-7, 1.0),
    Parameter::new(c"A_m", c"1/MPa", 2.0, c"rate of the biaxial hydrostatic weight").at_least(0.0),
    Parameter::new(c"B_m", c"1/MPa", 0.7, c"decay of the biaxial hydrostatic weight").at_least(0.0),
    Parameter::new(c"beta_mode", c"-", 2.0, c"how the hydrostatic part is weighted").one_of(&BETA_MODES),
    Parameter::new(c"weights", c"-", 0.0, c"of the stress sought, or of the last converged one").one_of(&WEIGHTS),
];

const STATES: [StateVariable; 9] = [
    StateVariable::new(c"eta_t", c"-", c"D_t/(1 - D_t) of tensile damage"),
    StateVariable::new(c"eta_c", c"-", c"D_c/(1 - D_c) of compressive damage"),
    StateVariable::new(c"Y_t_max", c"MPa", c"largest tensile energy release rate so far"),
    StateVariable::new(c"Y_c_max", c"MPa", c"largest compressive energy release rate so far"),
    StateVariable::new(c"D", c"-", c"damage r_t D_t + r_c D_c that acts now"),
    StateVariable::new(c"beta", c"-", c"hydrostatic weight of the stress now"),
    StateVariable::new(c"r_t", c"-", c"tensile weight of the stress now"),
    STRAIN_33,
    DISSIPATED_ENERGY,
];

/// Largest number below 1: D rounds to 1 where 1 − D is below the last digit.
const LARGEST_DAMAGE: f64 = 1.0 - f64::EPSILON / 2.0;
/// Suggested fraction of an increment that has no solution.
const CUT_BACK: f64 = 0.25;

/// Where the weights of a step come from.
#[derive(Clone, Copy, Debug)]
enum WeightSource {
    /// They follow m.
    Implicit,
    /// Those of the elastic stress at this strain: the first step of the lagged form.
    Elastic(Weights),
    /// Those that the last converged stress left; also at zero stress, which has no direction.
    Stored(Weights),
}

impl WeightSource {
    fn new(parameters: &Parameters, effective: &EffectiveStress, biaxial: Option<f64>, state: &[f64]) -> Self {
        let stored = Weights { r_t: state[6], r_c: 1.0 - state[6], beta: state[5], mixture: Mixture::default() };
        let q = effective.principal(1.0);
        // any strain but zero leaves a maximum of Y behind
        let virgin = state[2] == 0.0 && state[3] == 0.0;
        if !has_direction(&q) || (parameters.lagged && !virgin) {
            Self::Stored(stored)
        } else if parameters.lagged {
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
        parameters: &PARAMETERS,
        repeating: None,
        states: &STATES,
        derived: &const { [DerivedOutput::damage(c"D_t", 0), DerivedOutput::damage(c"D_c", 1)] },
        flags: flags::THREAD_SAFE | flags::STRESS_ONLY | flags::ISOTROPIC,
    };

    type Parameters<'p> = Parameters;

    fn parameters(props: &[f64]) -> Result<Parameters, ConfigurationError> {
        let mode = match props[10] {
            0.0 => BetaMode::Uniaxial,
            1.0 => BetaMode::Biaxial,
            _ => BetaMode::Blend,
        };
        Ok(Parameters {
            elasticity: Elasticity::new(props[0], props[1]),
            tension: DamageLaw { a: props[2], b: props[3], threshold: props[4] },
            compression: DamageLaw { a: props[5], b: props[6], threshold: props[7] },
            hydrostatic: HydrostaticWeight { a: props[8], b: props[9], mode },
            lagged: props[11] == 1.0,
        })
    }

    fn update(
        parameters: &Parameters,
        increment: &Increment,
        state: &mut [f64],
        request: Request,
    ) -> Result<Response, Failure> {
        let history = History { eta_t: state[0], eta_c: state[1], y_t_max: state[2], y_c_max: state[3] };
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
        if !stress.iter().all(|component| component.is_finite()) {
            return Err(Failure::CutBack { fraction: CUT_BACK, reason: "the stress is not finite" });
        }
        let tangent = if !request.wants_tangent() {
            [[0.0; 6]; 6]
        } else if trial.eta_t == 0.0 && trial.eta_c == 0.0 {
            elastic_tangent(&parameters.elasticity, increment.stress_state)
        } else {
            let gradients = source.gradients(parameters, &effective, &trial);
            tangent::consistent_tangent(parameters, &history, &effective, &trial, &gradients)
        };
        let strain = effective.strain(trial.m);
        state[8] += work_balance(increment, &strain, &stress);
        commit(parameters, &effective, &trial, &history, state);
        state[7] = strain[2];
        Ok(Response { stress, tangent, stored_energy: 0.5 * work(&stress, &strain), dissipated_energy: state[8] })
    }
}

fn elastic_tangent(elasticity: &Elasticity, stress_state: StressState) -> [[f64; 6]; 6] {
    if stress_state == StressState::PlaneStress { elasticity.plane_stress_stiffness() } else { elasticity.stiffness() }
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
fn commit(parameters: &Parameters, effective: &EffectiveStress, trial: &Trial, history: &History, state: &mut [f64]) {
    state[0] = trial.eta_t;
    state[1] = trial.eta_c;
    state[2] = history.y_t_max.max(trial.y_t());
    state[3] = history.y_c_max.max(trial.y_c());
    state[4] = damage(trial.ratio).min(LARGEST_DAMAGE);
    let weights = if parameters.lagged {
        let q = effective.principal(trial.m);
        parameters.hydrostatic.weights(&q, effective.energies(trial.m), None).unwrap_or(trial.weights)
    } else {
        trial.weights
    };
    state[5] = weights.beta;
    state[6] = weights.r_t;
}
