#![doc = include_str!("doc.md")]

mod hardening;
mod history;
mod plane_stress;
mod radial_return;

pub use hardening::Hardening;
use history::STRAIN_33_STATE;
pub(crate) use history::{PlasticHistory, STATES};

use crate::linear_elastic::{poisson_ratio, youngs_modulus};
use crate::tensor::Elasticity;
use umat_abi::law::{ConfigurationError, Failure, Increment, Law, LawInfo, Request, Response, StressState};
use umat_abi::metadata::{Parameter, RepeatingGroup, flags};

#[cfg(any(test, feature = "stability"))]
pub(crate) mod samples;
#[cfg(test)]
mod test;

/// The law.
pub struct J2Plasticity;

/// Elasticity and the hardening table, which stays in PROPS.
#[derive(Clone, Copy, Debug)]
pub struct Parameters<'p> {
    /// E and ν.
    pub elasticity: Elasticity,
    /// σ_y(p).
    pub hardening: Hardening<'p>,
}

/// Parameters before the table.
const FIXED: usize = 2;

/// Where an increment starts from.
struct Start {
    history: PlasticHistory,
    /// End strain less old plastic strain.
    trial: [f64; 6],
    /// End strain.
    strain: [f64; 6],
}

impl Start {
    #[inline(always)]
    fn new(increment: &Increment, state: &[f64]) -> Self {
        let history = PlasticHistory::read(state);
        Self { history, trial: history.elastic_strain(&increment.strain), strain: increment.strain }
    }

    /// Whether the trial strain is neither NaN nor absurd.
    #[inline(always)]
    fn is_usable(&self) -> bool {
        check_trial_strain(&self.trial).is_ok()
    }
}

/// What a return mapping finds.
struct Returned {
    equivalent_stress: f64,
    mean_stress: f64,
    stress: [f64; 6],
    tangent: [[f64; 6]; 6],
    peeq_increment: f64,
    plastic_increment: [f64; 6],
    /// Total strain 33 at the end.
    strain_33: f64,
}

impl Returned {
    /// Writes the new history, and completes the response.
    #[inline(always)]
    fn finish(
        self,
        parameters: &Parameters<'_>,
        mut history: PlasticHistory,
        state: &mut [f64],
    ) -> Result<Response, Failure> {
        let end = history.peeq + self.peeq_increment;
        if end > history.peeq {
            history.dissipated_energy += parameters.hardening.work(history.peeq, end);
        }
        history.peeq = end;
        history.strain_33 = self.strain_33;
        for i in 0..6 {
            history.plastic_strain[i] += self.plastic_increment[i];
        }
        history.write(state);
        let Elasticity { shear_modulus, bulk_modulus, .. } = parameters.elasticity;
        Response {
            stress: self.stress,
            tangent: self.tangent,
            stored_energy: self.equivalent_stress.powi(2) / (6.0 * shear_modulus)
                + self.mean_stress.powi(2) / (2.0 * bulk_modulus),
            dissipated_energy: history.dissipated_energy,
        }
        .finite_by_diagonal(state)
    }
}

/// The greatest equivalent stress without flow, MPa.
#[inline(always)]
fn admissible_stress(hardening: &Hardening<'_>, peeq: f64) -> f64 {
    hardening.yield_stress(peeq) * (1.0 + YIELD_ROUNDING)
}

/// Elastic trial strains beyond this are errors of the host; their squares times moduli stay numbers.
const LARGEST_TRIAL_STRAIN: f64 = 1e100;

/// A trial state outside the yield surface by less than this times the stresses involved is on it:
/// that is what rounding leaves of a returned state, and repeating an increment must not flow again.
pub(crate) const YIELD_ROUNDING: f64 = 8.0 * f64::EPSILON;

/// Refuses NaN, infinity and the absurd.
#[inline(always)]
pub(crate) fn check_trial_strain(trial: &[f64; 6]) -> Result<(), Failure> {
    if trial.iter().fold(true, |usable, strain| usable & (strain.abs() < LARGEST_TRIAL_STRAIN)) {
        Ok(())
    } else {
        Err(Failure::CutBack { fraction: 0.25, reason: "the strain is not a usable number" })
    }
}

impl Law for J2Plasticity {
    const INFO: LawInfo = LawInfo {
        name: c"j2_plasticity",
        description: c"Von Mises plasticity with isotropic hardening from a table",
        parameters: &const {
            [
                youngs_modulus(210_000.0),
                poisson_ratio(0.3),
                Parameter::new(c"yield_stress", c"MPa", 347.0, c"yield stress at this equivalent plastic strain")
                    .typically(1.0, 1e4)
                    .above(0.0),
                Parameter::new(c"equivalent_plastic_strain", c"-", 0.0, c"0 in the first pair, then increasing")
                    .at_least(0.0),
            ]
        },
        repeating: Some(RepeatingGroup::new(c"hardening", 2, 1, -1)),
        states: &STATES,
        derived: &[],
        flags: flags::SYMMETRIC_TANGENT | flags::THREAD_SAFE | flags::STRESS_ONLY | flags::ISOTROPIC,
    };

    const FINITE_OR_FAILS: bool = true;
    type Parameters<'p> = Parameters<'p>;

    #[inline(always)]
    fn parameters(props: &[f64]) -> Result<Parameters<'_>, ConfigurationError> {
        let elasticity = Elasticity::new(props[0], props[1]);
        Ok(Parameters { elasticity, hardening: Hardening::new(&props[FIXED..], &elasticity)? })
    }

    #[inline(always)]
    fn elastic(
        parameters: &Parameters<'_>,
        increment: &Increment,
        state: &mut [f64],
        request: Request,
    ) -> Option<Response> {
        let Parameters { elasticity, hardening } = parameters;
        if increment.stress_state == StressState::PlaneStress {
            return None;
        }
        let start = Start::new(increment, state);
        let trial = radial_return::TrialState::new(elasticity, &start);
        // squares: no root is taken; false for NaN too
        let admissible = admissible_stress(hardening, start.history.peeq);
        if !(trial.equivalent_stress_squared(elasticity) <= admissible * admissible && start.is_usable()) {
            return None;
        }
        let response = trial.elastic_response(elasticity, start.history.dissipated_energy, request);
        let response = response.finite_by_diagonal(&[]).ok()?;
        state[STRAIN_33_STATE] = increment.strain[2];
        Some(response)
    }

    #[inline(always)]
    fn update(
        parameters: &Parameters<'_>,
        increment: &Increment,
        state: &mut [f64],
        request: Request,
    ) -> Result<Response, Failure> {
        if let Some(response) = Self::elastic(parameters, increment, state, request) {
            return Ok(response);
        }
        let start = Start::new(increment, state);
        check_trial_strain(&start.trial)?;
        if increment.stress_state == StressState::PlaneStress {
            plane_stress::plane_stress_return(parameters, &start, state, request)
        } else {
            let trial = radial_return::TrialState::new(&parameters.elasticity, &start);
            radial_return::radial_return(parameters, &start, &trial, state, request)
        }
    }
}
