#![doc = include_str!("doc.md")]

mod hardening;
mod history;
mod plane_stress;
mod radial_return;

pub use hardening::Hardening;
pub use history::State;

use crate::linear_elastic::{poisson_ratio, youngs_modulus};
use crate::tensor::Elasticity;
use umat_abi::law::{ConfigurationError, Failure, Increment, Law, LawInfo, Request, Response, StressState};
use umat_abi::metadata::{Parameter, RepeatingGroup, flags};

#[cfg(test)]
mod test;

/// The law.
pub struct J2Plasticity;

umat_abi::parameters! {
    /// The parameters; the hardening table stays in PROPS.
    pub struct Parameters<'p> {
        /// E, ν.
        pub elasticity: Elasticity = youngs_modulus(210_000.0), poisson_ratio(0.3);
        ..RepeatingGroup::new(c"hardening", 2, 1, -1) =>
        /// σ_y(p).
        pub hardening: Hardening<'p> =
            Parameter::new(c"yield_stress", c"MPa", 347.0, c"yield stress at this equivalent plastic strain")
                .typically(10.0, 1e4)
                .above(0.0),
            Parameter::new(c"equivalent_plastic_strain", c"-", 0.0, c"0 in the first pair, then increasing")
                .at_least(0.0);
    }
}

/// Result of a return mapping.
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
    /// Writes the new state, and completes the response.
    #[inline(always)]
    fn finish(self, parameters: &Parameters<'_>, state: &mut State) -> Response {
        let end = state.peeq + self.peeq_increment;
        if end > state.peeq {
            state.dissipated_energy += parameters.hardening.work(state.peeq, end);
        }
        state.peeq = end;
        state.strain_33 = self.strain_33;
        for i in 0..6 {
            state.plastic_strain[i] += self.plastic_increment[i];
        }
        let Elasticity { shear_modulus, bulk_modulus, .. } = parameters.elasticity;
        Response {
            stress: self.stress,
            tangent: self.tangent,
            stored_energy: self.equivalent_stress.powi(2) / (6.0 * shear_modulus)
                + self.mean_stress.powi(2) / (2.0 * bulk_modulus),
            dissipated_energy: state.dissipated_energy,
        }
    }
}

/// The greatest equivalent stress without flow, MPa. The deviator is a difference of strains: its rounding grows with the volumetric
/// strain, 2μ |tr ε| as a stress.
#[inline(always)]
fn admissible_stress(hardening: &Hardening<'_>, peeq: f64, volumetric_stress: f64) -> f64 {
    let yield_stress = hardening.yield_stress(peeq);
    yield_stress + YIELD_ROUNDING * (yield_stress + volumetric_stress)
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
        flags: flags::SYMMETRIC_TANGENT | flags::THREAD_SAFE | flags::STRESS_ONLY | flags::ISOTROPIC,
        ..LawInfo::of::<Parameters<'_>, State>()
    };

    type Parameters<'p> = Parameters<'p>;
    type State = State;

    #[inline(always)]
    fn check(Parameters { elasticity, hardening }: &Parameters<'_>) -> Result<(), ConfigurationError> {
        hardening.check(elasticity)
    }

    #[inline(always)]
    fn elastic(
        Parameters { elasticity, hardening }: &Parameters<'_>,
        increment: &Increment,
        state: &mut State,
        request: Request,
    ) -> Option<Response> {
        if increment.stress_state == StressState::PlaneStress {
            return None;
        }
        let strain = state.elastic_strain(&increment.strain);
        let trial = radial_return::TrialState::new(elasticity, &strain, &increment.strain);
        // squares: no root is taken; false for NaN too
        let admissible = admissible_stress(hardening, state.peeq, trial.volumetric_stress(elasticity));
        let is_elastic = trial.equivalent_stress_squared(elasticity) <= admissible * admissible;
        if !(is_elastic && check_trial_strain(&strain).is_ok()) {
            return None;
        }
        state.strain_33 = increment.strain[2];
        Some(trial.elastic_response(elasticity, state.dissipated_energy, request))
    }

    // of its own: the elastic one stays short
    #[inline(never)]
    fn update(
        parameters: &Parameters<'_>,
        increment: &Increment,
        state: &mut State,
        request: Request,
    ) -> Result<Response, Failure> {
        let strain = state.elastic_strain(&increment.strain);
        check_trial_strain(&strain)?;
        let returned = if increment.stress_state == StressState::PlaneStress {
            plane_stress::plane_stress_return(parameters, &strain, state, request)
        } else {
            radial_return::radial_return(parameters, &strain, &increment.strain, state.peeq, request)
        };
        Ok(returned.finish(parameters, state))
    }
}
