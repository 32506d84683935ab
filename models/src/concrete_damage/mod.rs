#![doc = include_str!("doc.md")]

mod block;
pub mod calibration;
mod crack_band;
mod criteria;
mod degraded;
mod dissipation;
mod evolution;
mod implex;
mod inelastic;
mod no_tension;
mod plane_stress;
mod softening;
mod uniaxial;

#[cfg(any(test, feature = "stability"))]
pub(crate) mod samples;
#[cfg(test)]
mod test;

use crate::damage_law::DamageLaw;
use crate::linear_elastic::{DISSIPATED_ENERGY, STRAIN_33, poisson_ratio, youngs_modulus};
use crate::tensor::{Elasticity, Spectral, stress_norm_squared};
use crack_band::CrackBand;
use dissipation::Start;
use evolution::Evolution;
use softening::Softening;
use umat_abi::law::{
    Block, BlockResponse, ConfigurationError, Failure, Increment, Lane, Law, LawInfo, Request, Response, StressState,
};
use umat_abi::metadata::{DerivedOutput, Parameter, StateVariable, flags};
use uniaxial::Uniaxial;

pub use implex::ConcreteDamageImplex;

/// The law.
pub struct ConcreteDamage;

/// PROPS by name.
#[derive(Clone, Copy, Debug)]
pub struct Parameters {
    /// E, ν.
    pub elasticity: Elasticity,
    /// A_t, B_t, Y_t0.
    pub tension: DamageLaw,
    /// A_c, B_c, Y_c0.
    pub compression: DamageLaw,
    /// β: how much of the hydrostatic stiffness compressive damage takes.
    pub beta: f64,
    /// ζ_c: how much confinement delays compressive damage.
    pub zeta_c: f64,
    /// b_t: inelastic fraction of the growth of tensile strain.
    pub b_t: f64,
    /// b_c: the same in compression.
    pub b_c: f64,
    /// G_f, N/mm; 0: no crack band in tension.
    pub fracture_energy: f64,
    /// G_c, N/mm; 0: no crack band in compression.
    pub crushing_energy: f64,
}

impl Parameters {
    /// IV-HP rather than IV-H.
    #[inline]
    fn has_inelastic_strain(&self) -> bool {
        self.b_t != 0.0 || self.b_c != 0.0
    }

    /// Whether a fracture energy is given.
    #[inline]
    fn wants_crack_band(&self) -> bool {
        self.fracture_energy > 0.0 || self.crushing_energy > 0.0
    }

    /// The refusal of an increment without a usable length.
    fn missing_length(&self) -> ConfigurationError {
        let parameter = if self.fracture_energy > 0.0 { "G_f" } else { "G_c" };
        ConfigurationError::CharacteristicLengthMissing { parameter }
    }

    /// The two branches, with crack bands as far as energies and a length are given.
    #[inline]
    fn softening(&self, length: Option<f64>) -> [Softening; 2] {
        let band = |fracture_energy: f64, inelastic_fraction: f64| {
            let length = length.filter(|_| fracture_energy > 0.0)?;
            Some(CrackBand { fracture_energy, length, inelastic_fraction })
        };
        [
            Softening {
                curve: Uniaxial::tension(&self.elasticity, self.tension),
                band: band(self.fracture_energy, self.b_t),
            },
            Softening {
                curve: Uniaxial::compression(&self.elasticity, self.compression, self.beta),
                band: band(self.crushing_energy, self.b_c),
            },
        ]
    }
}

/// Damage η and the largest energy release rate so far, of one branch.
#[derive(Clone, Copy, Debug, Default)]
struct Branch {
    eta: f64,
    maximum: f64,
}

/// Both branches.
#[derive(Clone, Copy, Debug, Default)]
struct History {
    tension: Branch,
    compression: Branch,
}

impl History {
    /// As it stands among the states.
    #[inline(always)]
    fn of(state: &[f64]) -> Self {
        Self {
            tension: Branch { eta: state[0], maximum: state[2] },
            compression: Branch { eta: state[1], maximum: state[3] },
        }
    }
}

const PARAMETERS: [Parameter; 14] = [
    youngs_modulus(31800.0),
    poisson_ratio(0.18),
    Parameter::new(c"A_t", c"1/MPa", 5000.0, c"rate of tensile damage").above(0.0),
    Parameter::new(c"B_t", c"-", 1.3, c"exponent of tensile damage").above(0.0),
    Parameter::new(c"Y_t0", c"MPa", 1.905_077e-4, c"threshold of tensile damage").at_least(0.0).typically(1e-7, 0.1),
    Parameter::new(c"A_c", c"1/MPa", 31.47479, c"rate of compressive damage").above(0.0),
    Parameter::new(c"B_c", c"-", 1.05, c"exponent of compressive damage").above(0.0),
    Parameter::new(c"Y_c0", c"MPa", 3.0e-4, c"threshold of compressive damage").at_least(0.0).typically(1e-7, 1.0),
    Parameter::new(c"beta", c"-", 0.17227, c"share of the hydrostatic stiffness that compressive damage takes")
        .within(0.0, 1.0),
    Parameter::new(c"zeta_c", c"-", 0.0, c"delay of compressive damage by confinement").at_least(0.0),
    Parameter::new(c"b_t", c"-", 0.0, c"inelastic fraction of tensile strain growth (0: none)")
        .at_least(0.0)
        .below(1.0),
    Parameter::new(c"b_c", c"-", 0.0, c"inelastic fraction of compressive strain growth (0: none)")
        .at_least(0.0)
        .below(1.0),
    Parameter::new(c"G_f", c"N/mm", 0.0, c"fracture energy in tension (0: no crack band)")
        .at_least(0.0)
        .typically(0.002, 20.0),
    Parameter::new(c"G_c", c"N/mm", 0.0, c"fracture energy in compression (0: no crack band)")
        .at_least(0.0)
        .typically(0.1, 1000.0),
];

/// The first states of both integrations.
const HISTORY_STATES: [StateVariable; 5] = [
    StateVariable::new(c"eta_t", c"-", c"tensile damage D_t/(1 - D_t)"),
    StateVariable::new(c"eta_c", c"-", c"compressive damage D_c/(1 - D_c)"),
    StateVariable::new(c"Y_t_max", c"MPa", c"largest tensile energy release rate above Y_t0 so far"),
    StateVariable::new(c"Y_c_max", c"MPa", c"largest compressive energy release rate above Y_c0 so far"),
    StateVariable::new(c"crack_band", c"-", c"0 off, 1 on"),
];

const STATES: [StateVariable; 13] = [
    HISTORY_STATES[0],
    HISTORY_STATES[1],
    HISTORY_STATES[2],
    HISTORY_STATES[3],
    HISTORY_STATES[4],
    StateVariable::new(c"inelastic_strain_11", c"-", c"inelastic strain").strain_component(1),
    StateVariable::new(c"inelastic_strain_22", c"-", c"inelastic strain").strain_component(2),
    StateVariable::new(c"inelastic_strain_33", c"-", c"inelastic strain").strain_component(3),
    StateVariable::new(c"inelastic_strain_12", c"-", c"inelastic strain, engineering shear").strain_component(4),
    StateVariable::new(c"inelastic_strain_13", c"-", c"inelastic strain, engineering shear").strain_component(5),
    StateVariable::new(c"inelastic_strain_23", c"-", c"inelastic strain, engineering shear").strain_component(6),
    STRAIN_33,
    DISSIPATED_ENERGY,
];

const CRACK_BAND: usize = 4;
const CRACK_BAND_OFF: f64 = 0.0;
const CRACK_BAND_ON: f64 = 1.0;
const INELASTIC_STRAIN: usize = 5;
const STRAIN_33_STATE: usize = 11;
const DISSIPATED_ENERGY_STATE: usize = 12;

impl Law for ConcreteDamage {
    const INFO: LawInfo = LawInfo {
        name: c"concrete_damage",
        description: c"Concrete: tensile and compressive damage with crack closure (IV-H), inelastic strain (IV-HP)",
        parameters: &PARAMETERS,
        repeating: None,
        states: &STATES,
        derived: &const { [DerivedOutput::damage(c"D_t", 0), DerivedOutput::damage(c"D_c", 1)] },
        // no PATH_EXACT: IV-HP (b_t, b_c > 0) is not, and a flag speaks for all parameters
        flags: flags::THREAD_SAFE | flags::USES_CELENT | flags::STRESS_ONLY | flags::ISOTROPIC,
    };

    const FINITE_OR_FAILS: bool = true;

    type Parameters<'p> = Parameters;

    #[inline(always)]
    fn parameters(props: &[f64]) -> Result<Parameters, ConfigurationError> {
        let parameters = Parameters {
            elasticity: Elasticity::new(props[0], props[1]),
            tension: DamageLaw { a: props[2], b: props[3], threshold: props[4] },
            compression: DamageLaw { a: props[5], b: props[6], threshold: props[7] },
            beta: props[8],
            zeta_c: props[9],
            b_t: props[10],
            b_c: props[11],
            fracture_energy: props[12],
            crushing_energy: props[13],
        };
        // ∫ σ dε of the curve itself is infinite for B ≤ 1 (docs/theory/crack-band.md)
        if parameters.fracture_energy > 0.0 && parameters.tension.b <= 1.0 {
            let rule = "G_f > 0 needs B_t > 1: otherwise the curve dissipates without limit";
            return Err(ConfigurationError::Inconsistent { rule, value: parameters.tension.b });
        }
        if parameters.crushing_energy > 0.0 && parameters.compression.b <= 1.0 {
            let rule = "G_c > 0 needs B_c > 1: otherwise the curve dissipates without limit";
            return Err(ConfigurationError::Inconsistent { rule, value: parameters.compression.b });
        }
        Ok(parameters)
    }

    fn needs_characteristic_length(parameters: &Parameters) -> bool {
        parameters.wants_crack_band()
    }

    fn check_characteristic_length(parameters: &Parameters, length: f64) -> Result<(), ConfigurationError> {
        for (softening, name) in parameters.softening(Some(length)).iter().zip(["G_f", "G_c"]) {
            if let Some(band) = &softening.band {
                band.check(&softening.curve, name)?;
            }
        }
        Ok(())
    }

    #[inline(always)]
    fn elastic(
        parameters: &Parameters,
        increment: &Increment,
        state: &mut [f64],
        request: Request,
    ) -> Option<Response> {
        if length_is_unchecked(parameters, increment, state) || state[0] != 0.0 || state[1] != 0.0 {
            return None;
        }
        let trial = trial_strain(increment, state);
        let elastic = elastic_response(parameters, increment.stress_state, &trial)?;
        elastic.response(parameters, increment, &trial, state, request)
    }

    #[inline]
    fn update(
        parameters: &Parameters,
        increment: &Increment,
        state: &mut [f64],
        request: Request,
    ) -> Result<Response, Failure> {
        if let Some(response) = Self::elastic(parameters, increment, state, request) {
            return Ok(response);
        }
        advance(parameters, increment, state, request)
    }

    const UPDATES_BLOCKS: bool = true;

    #[inline(always)]
    fn update_block(parameters: &Parameters, block: &Block, state: &mut [Lane]) -> Option<BlockResponse> {
        block::update(parameters, block, state)
    }
}

/// What the state of that name says after an increment.
#[inline(always)]
fn crack_band(parameters: &Parameters) -> f64 {
    if parameters.wants_crack_band() { CRACK_BAND_ON } else { CRACK_BAND_OFF }
}

/// A UMAT has no set-up phase: the first call of a point is where the length is checked. None at all is seen in any.
#[inline(always)]
fn length_is_unchecked(parameters: &Parameters, increment: &Increment, state: &[f64]) -> bool {
    parameters.wants_crack_band() && (increment.characteristic_length.is_none() || state[CRACK_BAND] != CRACK_BAND_ON)
}

/// ε − ε_p.
#[inline(always)]
fn trial_strain(increment: &Increment, state: &[f64]) -> [f64; 6] {
    let mut trial = increment.strain;
    for i in 0..6 {
        trial[i] -= state[INELASTIC_STRAIN + i];
    }
    trial
}

/// The update of a point that is damaged or may become so, or that is called for the first time. A function of its own: the
/// elastic one stays short.
#[inline(never)]
fn advance(
    parameters: &Parameters,
    increment: &Increment,
    state: &mut [f64],
    request: Request,
) -> Result<Response, Failure> {
    if let Some(response) = begin(parameters, increment, state, request)? {
        return Ok(response);
    }
    let history = History::of(state);
    let trial = trial_strain(increment, state);
    let softening = parameters.softening(increment.characteristic_length);
    let evolve = |strain: &[f64; 3]| Evolution::new(parameters, &softening, &history, strain);
    let point = solve_point(parameters, evolve, &history, increment, state, trial)?;
    let stress = point.stress(parameters);
    let dissipation = if point.dissipates() {
        let start = point.start(&history, increment, state);
        let axes = Spectral::of_strain(&start.elastic_strain);
        dissipation::increment(parameters, &softening, &start, &axes.values, &point.evolution, &point.axes, &stress)
    } else {
        0.0
    };
    let energy = point.evolution.solid.energy();
    if !point.is_finite(energy, dissipation, &stress) {
        return Err(overflow(parameters, increment));
    }
    let tangent = if request.wants_tangent() { point.tangent(parameters) } else { [[0.0; 6]; 6] };
    point.commit(state, dissipation);
    state[CRACK_BAND] = crack_band(parameters);
    let dissipated_energy = state[DISSIPATED_ENERGY_STATE];
    Response { stress, tangent, stored_energy: energy, dissipated_energy }.finite(state)
}

/// Checks the strain and, at the first call of a point, the length; the response if it turns out to be elastic.
#[inline(always)]
fn begin(
    parameters: &Parameters,
    increment: &Increment,
    state: &mut [f64],
    request: Request,
) -> Result<Option<Response>, Failure> {
    increment.check_strain()?;
    if !length_is_unchecked(parameters, increment, state) {
        return Ok(None);
    }
    let length = increment.characteristic_length.ok_or_else(|| parameters.missing_length())?;
    ConcreteDamage::check_characteristic_length(parameters, length)?;
    state[CRACK_BAND] = CRACK_BAND_ON;
    Ok(ConcreteDamage::elastic(parameters, increment, state, request))
}

/// Why a result is no number: a length that grew beyond the limit, or else the strain.
#[cold]
fn overflow(parameters: &Parameters, increment: &Increment) -> Failure {
    let length = increment.characteristic_length.map(|h| ConcreteDamage::check_characteristic_length(parameters, h));
    match length {
        Some(Err(error)) => error.into(),
        _ => Failure::CutBack { fraction: 0.5, reason: "the strain is not finite or overflows the energy" },
    }
}

/// Stress and energy of the virgin solid.
struct ElasticResponse {
    stress: [f64; 6],
    energy: f64,
}

impl ElasticResponse {
    /// Writes the state; `None`, and nothing written, if a number is not finite.
    #[inline(always)]
    fn response(
        self,
        parameters: &Parameters,
        increment: &Increment,
        trial: &[f64; 6],
        state: &mut [f64],
        request: Request,
    ) -> Option<Response> {
        let elasticity = &parameters.elasticity;
        let plane_stress = increment.stress_state == StressState::PlaneStress;
        let response = Response {
            stress: self.stress,
            tangent: elasticity.tangent(plane_stress, request),
            stored_energy: self.energy,
            // inelastic strain can be dissipated before η leaves 0 (underflow of a steep damage function)
            dissipated_energy: state[DISSIPATED_ENERGY_STATE],
        };
        let response = response.finite_by_diagonal(&[]).ok()?;
        state[CRACK_BAND] = crack_band(parameters);
        state[STRAIN_33_STATE] = if plane_stress {
            elasticity.plane_stress_strain_33(trial) + state[INELASTIC_STRAIN + 2]
        } else {
            increment.strain[2]
        };
        Some(response)
    }
}

/// The response of the virgin solid, if a bound without principal values shows that nothing can grow:
/// s̄_1² ≤ s̄ : s̄ bounds Y_t = ⟨s̄_1⟩²/(2E), and Y_c ≤ ½ s̄ : ε.
#[inline(always)]
fn elastic_response(parameters: &Parameters, stress_state: StressState, strain: &[f64; 6]) -> Option<ElasticResponse> {
    let elasticity = &parameters.elasticity;
    let plane_stress = stress_state == StressState::PlaneStress;
    let mut strain = *strain;
    if plane_stress {
        strain[2] = elasticity.plane_stress_strain_33(&strain);
    }
    let mut stress = elasticity.stress(&strain);
    let energy = elasticity.stored_energy(&strain);
    // a square that overflows is none below
    let limit = (2.0 * elasticity.youngs_modulus * parameters.tension.threshold).min(f64::MAX);
    // false for NaN too
    if !(stress_norm_squared(&stress) <= limit && energy <= parameters.compression.threshold) {
        return None;
    }
    if plane_stress {
        stress[2] = 0.0;
    }
    Some(ElasticResponse { stress, energy })
}

/// The end of an increment, in the principal axes of the trial strain.
struct PointResponse {
    /// ε − ε_p,n, ε33 found.
    trial: [f64; 6],
    axes: Spectral,
    /// Position of direction 3 among the axes, in plane stress.
    normal: Option<usize>,
    evolution: Evolution,
}

/// Decomposes the trial strain and advances the history; in plane stress finds ε33.
#[inline]
fn solve_point(
    parameters: &Parameters,
    evolve: impl Fn(&[f64; 3]) -> Evolution,
    history: &History,
    increment: &Increment,
    state: &[f64],
    mut trial: [f64; 6],
) -> Result<PointResponse, Failure> {
    if increment.stress_state != StressState::PlaneStress {
        let axes = Spectral::of_strain(&trial);
        let evolution = evolve(&axes.values);
        return Ok(PointResponse { trial, axes, normal: None, evolution });
    }
    let elastic = parameters.elasticity.plane_stress_strain_33(&trial);
    let guess = state[STRAIN_33_STATE] - state[INELASTIC_STRAIN + 2]
        + parameters.elasticity.plane_stress_strain_33(&increment.strain_increment);
    let solution = plane_stress::solve(parameters, evolve, history, &trial, elastic, guess)
        .ok_or(Failure::CutBack { fraction: 0.25, reason: "no strain 33 makes stress 33 vanish" })?;
    trial[2] = solution.strain_33;
    Ok(PointResponse { trial, axes: solution.axes, normal: Some(solution.normal), evolution: solution.evolution })
}

impl PointResponse {
    #[inline]
    fn stress(&self, parameters: &Parameters) -> [f64; 6] {
        let mut stress = if self.evolution.is_undamaged() {
            parameters.elasticity.stress(&self.trial)
        } else {
            self.axes.stress(&self.evolution.solid.stress)
        };
        if self.normal.is_some() {
            stress[2] = 0.0;
        }
        stress
    }

    #[inline]
    fn tangent(&self, parameters: &Parameters) -> [[f64; 6]; 6] {
        let elasticity = &parameters.elasticity;
        match (self.evolution.is_undamaged(), self.normal) {
            (true, None) => elasticity.stiffness(),
            (true, Some(_)) => elasticity.plane_stress_stiffness(),
            (false, normal) => {
                let full = self.evolution.tangent(parameters);
                let (principal, shear) = normal.map_or(full, |k| plane_stress::condense(full, k));
                self.axes.tangent(&principal, &shear)
            }
        }
    }

    /// Whether damage or inelastic strain grows.
    #[inline]
    fn dissipates(&self) -> bool {
        self.evolution.growth.iter().any(Option::is_some) || self.evolution.flow.is_some()
    }

    /// Where the increment starts from.
    #[inline]
    fn start(&self, history: &History, increment: &Increment, state: &[f64]) -> Start {
        let mut strain: [f64; 6] = std::array::from_fn(|i| increment.strain[i] - increment.strain_increment[i]);
        if self.normal.is_some() {
            strain[2] = state[STRAIN_33_STATE];
        }
        Start {
            elastic_strain: std::array::from_fn(|i| strain[i] - state[INELASTIC_STRAIN + i]),
            stress: increment.stress,
            history: *history,
        }
    }

    /// Whether all results are numbers.
    #[inline]
    fn is_finite(&self, energy: f64, dissipation: f64, stress: &[f64; 6]) -> bool {
        let History { tension, compression } = self.evolution.history;
        let reached = tension.maximum + compression.maximum;
        (energy + dissipation + reached + stress.iter().sum::<f64>()).is_finite()
    }

    /// Writes the new state.
    #[inline]
    fn commit(&self, state: &mut [f64], dissipation: f64) {
        let History { tension, compression } = self.evolution.history;
        state[..4].copy_from_slice(&[tension.eta, compression.eta, tension.maximum, compression.maximum]);
        state[STRAIN_33_STATE] = self.trial[2] + state[INELASTIC_STRAIN + 2];
        if let Some(flow) = &self.evolution.flow {
            let principal = std::array::from_fn(|i| flow.tension[i] + flow.compression[i]);
            let inelastic = self.axes.strain(&principal);
            for i in 0..6 {
                state[INELASTIC_STRAIN + i] += inelastic[i];
            }
        }
        state[DISSIPATED_ENERGY_STATE] += dissipation;
    }
}
