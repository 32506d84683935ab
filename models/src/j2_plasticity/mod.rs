#![doc = include_str!("doc.md")]

mod hardening;
mod history;
mod plane_stress;
mod radial_return;

pub use hardening::Hardening;
pub(crate) use history::{PlasticHistory, STATES};

use crate::linear_elastic::{poisson_ratio, youngs_modulus};
use crate::tensor::{Elasticity, trace};
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

/// What a return mapping finds.
struct Returned {
    equivalent_stress: f64,
    mean_stress: f64,
    stress: [f64; 6],
    tangent: [[f64; 6]; 6],
    peeq_increment: f64,
    plastic_increment: [f64; 6],
    /// Elastic strain 33 at the end and plastic increment 33 (plane stress only).
    strain_33: f64,
}

/// Elastic trial strains beyond this are errors of the host; their squares times moduli stay numbers.
const LARGEST_TRIAL_STRAIN: f64 = 1e100;

/// A trial state outside the yield surface by less than this times the stresses involved is on it:
/// that is what rounding leaves of a returned state, and repeating an increment must not flow again.
pub(crate) const YIELD_ROUNDING: f64 = 8.0 * f64::EPSILON;

/// Refuses NaN, infinity and the absurd.
pub(crate) fn check_trial_strain(trial: &[f64; 6]) -> Result<(), Failure> {
    if trial.iter().all(|strain| strain.abs() < LARGEST_TRIAL_STRAIN) {
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

    type Parameters<'p> = Parameters<'p>;

    fn parameters(props: &[f64]) -> Result<Parameters<'_>, ConfigurationError> {
        let elasticity = Elasticity::new(props[0], props[1]);
        Ok(Parameters { elasticity, hardening: Hardening::new(&props[FIXED..], &elasticity)? })
    }

    fn update(
        parameters: &Parameters<'_>,
        increment: &Increment,
        state: &mut [f64],
        request: Request,
    ) -> Result<Response, Failure> {
        let mut history = PlasticHistory::read(state);
        let trial = history.elastic_strain(&increment.strain);
        check_trial_strain(&trial)?;
        let plane_stress = increment.stress_state == StressState::PlaneStress;
        let returned = if plane_stress {
            plane_stress::plane_stress_return(parameters, &trial, history.peeq, request)
        } else {
            let volumetric = trace(&increment.strain);
            radial_return::radial_return(parameters, &trial, volumetric, history.peeq, request)
        };
        let end = history.peeq + returned.peeq_increment;
        history.strain_33 =
            if plane_stress { history.plastic_strain[2] + returned.strain_33 } else { increment.strain[2] };
        if end > history.peeq {
            history.dissipated_energy += parameters.hardening.work(history.peeq, end);
        }
        history.peeq = end;
        for i in 0..6 {
            history.plastic_strain[i] += returned.plastic_increment[i];
        }
        history.write(state);
        let Elasticity { shear_modulus, bulk_modulus, .. } = parameters.elasticity;
        Ok(Response {
            stress: returned.stress,
            tangent: returned.tangent,
            stored_energy: returned.equivalent_stress.powi(2) / (6.0 * shear_modulus)
                + returned.mean_stress.powi(2) / (2.0 * bulk_modulus),
            dissipated_energy: history.dissipated_energy,
        })
    }
}
