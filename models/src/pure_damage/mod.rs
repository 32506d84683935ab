#![doc = include_str!("doc.md")]

use crate::damage_law::{DamageLaw, exponent_parameter, integrity, scale_parameter, threshold_parameter};
use crate::linear_elastic::{DISSIPATED_ENERGY, STRAIN_33, poisson_ratio, youngs_modulus};
use crate::tensor::{Elasticity, IsotropicSplit, add_dyad, isotropic_stiffness};
use umat_abi::law::{ConfigurationError, Failure, Increment, Law, LawInfo, Request, Response, StressState};
use umat_abi::metadata::{DerivedOutput, Parameter, StateVariable, flags};

#[cfg(any(test, feature = "stability"))]
pub(crate) mod samples;
#[cfg(test)]
mod test;

const PARAMETERS: [Parameter; 5] = [
    youngs_modulus(31800.0),
    poisson_ratio(0.18),
    scale_parameter(c"A", 5000.0),
    exponent_parameter(c"B", 1.3),
    threshold_parameter(c"Y_0", 2e-4),
];

const STATES: [StateVariable; 4] = [
    StateVariable::new(c"eta", c"-", c"D/(1 - D)"),
    StateVariable::new(c"Y_max", c"MPa", c"largest damage energy release rate so far"),
    STRAIN_33,
    DISSIPATED_ENERGY,
];

/// Number of the dissipated energy among them.
const DISSIPATED: usize = 3;

/// E, ν and the damage function.
#[derive(Clone, Copy, Debug)]
pub struct Parameters {
    elasticity: Elasticity,
    damage_law: DamageLaw,
}

/// The law.
pub struct PureDamage;

impl Law for PureDamage {
    const INFO: LawInfo = LawInfo {
        name: c"pure_damage",
        description: c"Model I: one isotropic damage variable, no inelastic strain",
        parameters: &PARAMETERS,
        repeating: None,
        states: &STATES,
        derived: &const { [DerivedOutput::damage(c"D", 0)] },
        flags: flags::SYMMETRIC_TANGENT
            | flags::THREAD_SAFE
            | flags::STRESS_ONLY
            | flags::PATH_EXACT
            | flags::ISOTROPIC,
    };

    const FINITE_OR_FAILS: bool = true;

    type Parameters<'p> = Parameters;

    #[inline(always)]
    fn parameters(props: &[f64]) -> Result<Parameters, ConfigurationError> {
        let damage_law = DamageLaw { a: props[2], b: props[3], threshold: props[4] };
        Ok(Parameters { elasticity: Elasticity::new(props[0], props[1]), damage_law })
    }

    #[inline(always)]
    fn elastic(
        parameters: &Parameters,
        increment: &Increment,
        state: &mut [f64],
        request: Request,
    ) -> Option<Response> {
        let Parameters { elasticity, damage_law } = parameters;
        let undamaged = Undamaged::new(elasticity, increment);
        let eta = state[0];
        // false for NaN too (0: of a damaged state that a host began with)
        let is_below = undamaged.release_rate <= damage_law.threshold;
        if !is_below || (state[DISSIPATED] == 0.0 && eta > 0.0) {
            return None;
        }
        let response = undamaged.response(increment.stress_state, eta, state[DISSIPATED], request);
        let response = response.finite_by_diagonal(&[]).ok()?;
        undamaged.record(elasticity, increment, state);
        Some(response)
    }

    #[inline(always)]
    fn update(
        parameters: &Parameters,
        increment: &Increment,
        state: &mut [f64],
        request: Request,
    ) -> Result<Response, Failure> {
        if let Some(response) = Self::elastic(parameters, increment, state, request) {
            return Ok(response);
        }
        let Parameters { elasticity, damage_law } = parameters;
        let undamaged = Undamaged::new(elasticity, increment);
        let (before, grown) = (state[0], damage_law.eta(undamaged.release_rate));
        let eta = before.max(grown);
        let mut dissipated = state[DISSIPATED];
        // dearer than all the rest: only where it can change
        // the closed form is monotone but for its last digit
        if grown > before {
            dissipated = dissipated.max(damage_law.dissipation_on_curve(eta, undamaged.release_rate));
        } else if dissipated == 0.0 {
            dissipated = damage_law.dissipation(eta);
        }
        let mut response = undamaged.response(increment.stress_state, eta, dissipated, request);
        if request.wants_tangent() && grown > before {
            let rate = damage_law.damage_rate(undamaged.release_rate, eta);
            add_dyad(&mut response.tangent, -rate, &undamaged.stress, &undamaged.stress);
        }
        state[0] = eta;
        state[DISSIPATED] = dissipated;
        undamaged.record(elasticity, increment, state);
        response.finite_by_diagonal(state)
    }
}

/// What the end strain of an increment does to the solid without damage.
struct Undamaged {
    twice_shear: f64,
    bulk: f64,
    /// s̄.
    stress: [f64; 6],
    /// Y.
    release_rate: f64,
}

impl Undamaged {
    #[inline(always)]
    fn new(elasticity: &Elasticity, increment: &Increment) -> Self {
        let split = IsotropicSplit::new(increment.stress_state, &increment.strain);
        let twice_shear = 2.0 * elasticity.shear_modulus;
        let bulk = elasticity.bulk_modulus_in(split.dimension());
        Self {
            twice_shear,
            bulk,
            stress: split.stress(twice_shear, bulk * split.trace),
            release_rate: 0.5 * (twice_shear * split.deviator_norm_squared() + bulk * split.trace * split.trace),
        }
    }

    /// With η, and a tangent that knows nothing of growth.
    #[inline(always)]
    fn response(&self, stress_state: StressState, eta: f64, dissipated_energy: f64, request: Request) -> Response {
        let omega = integrity(eta);
        Response {
            stress: self.stress.map(|s| omega * s),
            tangent: if request.wants_tangent() {
                isotropic_stiffness(stress_state, omega * self.twice_shear, omega * self.bulk)
            } else {
                [[0.0; 6]; 6]
            },
            stored_energy: omega * self.release_rate,
            dissipated_energy,
        }
    }

    /// The states that do not depend on damage.
    #[inline(always)]
    fn record(&self, elasticity: &Elasticity, increment: &Increment, state: &mut [f64]) {
        state[1] = state[1].max(self.release_rate);
        state[2] = if increment.stress_state == StressState::PlaneStress {
            elasticity.plane_stress_strain_33(&increment.strain)
        } else {
            increment.strain[2]
        };
    }
}
