//! Interface of a constitutive law: pure functions from (parameters, history, strain) to (stress, tangent, new
//! history), and the one table that describes its parameters and states.
//!
//! That table makes the metadata of the shared library, the checks of PROPS and the printed documentation. Nothing here
//! touches a pointer or the C side: [`crate::export`] does.

use crate::metadata::{
    ABI_VERSION, DerivedOutput, Parameter, Plugin, RepeatingGroup, StateVariable, Table, Text, Validate, stress_states,
};
use crate::table::{Parameters, States, all_finite};
use std::ffi::CStr;

pub use crate::table::{ConfigurationError, MAX_STATES};

/// Stress state, which determines the components that exist. Components are always embedded in six,
/// 11, 22, 33, 12, 13, 23, strains with engineering shear.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum StressState {
    /// NTENS 6, NDI 3, NSHR 3.
    ThreeD,
    /// NTENS 4, NDI 3, NSHR 1: plane strain (ε33 prescribed, usually 0) or axisymmetric (33 = θθ).
    PlaneStrainOrAxisymmetric,
    /// NTENS 3, NDI 2, NSHR 1: σ33 = σ13 = σ23 = 0; the law finds ε33.
    PlaneStress,
    /// NTENS 1, NDI 1, NSHR 0: σ11 alone, as in trusses, wires and beams in a plane.
    OneD,
    /// NTENS 2, NDI 1, NSHR 1: σ11 and σ12 alone, as in beams in space.
    Beam,
}

impl StressState {
    /// Recognises the (NTENS, NDI, NSHR) triples that ABAQUS and its peers use for solids; [`Law`]s have no others.
    pub fn from_counts(ntens: i32, ndi: i32, nshr: i32) -> Option<Self> {
        match (ntens, ndi, nshr) {
            (6, 3, 3) => Some(Self::ThreeD),
            (4, 3, 1) => Some(Self::PlaneStrainOrAxisymmetric),
            (3, 2, 1) => Some(Self::PlaneStress),
            _ => None,
        }
    }

    /// Index among the six components of each of the NTENS components.
    pub fn components(self) -> &'static [usize] {
        match self {
            Self::ThreeD => &[0, 1, 2, 3, 4, 5],
            Self::PlaneStrainOrAxisymmetric => &[0, 1, 2, 3],
            Self::PlaneStress => &[0, 1, 3],
            Self::OneD => &[0],
            Self::Beam => &[0, 3],
        }
    }

    /// Six components of a tensor from those that the state has, in its order; 0 for the others.
    pub fn six(self, values: &[f64]) -> [f64; 6] {
        let mut six = [0.0; 6];
        self.components().iter().zip(values).for_each(|(&component, value)| six[component] = *value);
        six
    }

    /// Returns whether it is one of a plane, whose calls may go through six components.
    pub fn is_plane(self) -> bool {
        matches!(self, Self::PlaneStrainOrAxisymmetric | Self::PlaneStress)
    }

    /// Returns the [`crate::metadata::stress_states`] bits of the stress states with these components.
    pub fn bits(self) -> u32 {
        match self {
            Self::ThreeD => stress_states::THREE_D,
            Self::PlaneStrainOrAxisymmetric => stress_states::PLANE_STRAIN | stress_states::AXISYMMETRIC,
            Self::PlaneStress => stress_states::PLANE_STRESS,
            Self::OneD | Self::Beam => 0,
        }
    }

    /// (NTENS, NDI, NSHR).
    pub fn counts(self) -> (i32, i32, i32) {
        match self {
            Self::ThreeD => (6, 3, 3),
            Self::PlaneStrainOrAxisymmetric => (4, 3, 1),
            Self::PlaneStress => (3, 2, 1),
            Self::OneD => (1, 1, 0),
            Self::Beam => (2, 1, 1),
        }
    }
}

/// Results that a caller requests.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Request {
    /// Stress, states and energies only (a host that passes DDSDDE = NULL).
    Stress,
    /// The consistent tangent as well.
    StressAndTangent,
}

impl Request {
    /// True if the tangent is wanted.
    pub fn wants_tangent(self) -> bool {
        self == Self::StressAndTangent
    }
}

/// One strain increment. Components 11, 22, 33, 12, 13, 23; strains with engineering shear;
/// stresses in MPa. Components that the stress state lacks are 0.
#[derive(Clone, Copy, Debug)]
pub struct Increment {
    /// Stress state, which determines the components that exist.
    pub stress_state: StressState,
    /// Total strain at the end of the increment (STRAN + DSTRAN).
    pub strain: [f64; 6],
    /// Strain increment (DSTRAN).
    pub strain_increment: [f64; 6],
    /// Stress at the start of the increment (STRESS on entry), rotated by the host under NLGEOM.
    pub stress: [f64; 6],
    /// CELENT, mm; `None` if the host passed NULL, zero, a negative number or NaN.
    pub characteristic_length: Option<f64>,
    /// DTIME, s; 1 if the host passed NULL, zero, a negative number or NaN.
    pub time_increment: f64,
    /// TEMP + DTEMP: the temperature, or another field, at the end of the increment. 0 for laws that are not [`Law::COUPLED`].
    pub temperature: f64,
}

impl Increment {
    /// An increment without strain, stress and characteristic length, into which the components of a host are read.
    #[inline(always)]
    pub const fn at_rest(stress_state: StressState) -> Self {
        Self {
            stress_state,
            strain: [0.0; 6],
            strain_increment: [0.0; 6],
            stress: [0.0; 6],
            characteristic_length: None,
            time_increment: 1.0,
            temperature: 0.0,
        }
    }
}

/// Results of an update other than the new state variables.
#[derive(Clone, Copy, Debug)]
pub struct Response {
    /// Stress at the end of the increment, MPa.
    pub stress: [f64; 6],
    /// `tangent[i][j]` = ∂σ_i/∂ε_j (engineering shear), the exact derivative of the algorithm, MPa.
    /// Meaningful only if requested. In plane stress the condensed one, in rows and columns 0, 1, 3.
    pub tangent: [[f64; 6]; 6],
    /// Stored (free) energy per volume at the end of the increment, N·mm/mm³.
    pub stored_energy: f64,
    /// Energy dissipated per volume since the virgin state, N·mm/mm³.
    pub dissipated_energy: f64,
}

/// Heat that a material generates, and derivatives by and of the temperature: results for fully coupled steps alone. A UMAT leaves what
/// it does not set at 0. The vectors have the components of the call; those of a [`Law`] are always embedded in six.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Heat {
    /// RPL: heat generated per volume and time, at the end of the increment.
    pub rpl: f64,
    /// DDSDDT: derivative of the stress by the temperature.
    pub ddsddt: [f64; 6],
    /// DRPLDE: derivative of RPL by the strain increment, by engineering shear.
    pub drplde: [f64; 6],
    /// DRPLDT: derivative of RPL by the temperature.
    pub drpldt: f64,
}

impl Heat {
    fn is_finite(&self) -> bool {
        all_finite(&[self.rpl, self.drpldt]) && all_finite(&self.ddsddt) && all_finite(&self.drplde)
    }
}

/// The fraction that is suggested where an increment cannot be computed at all.
pub(crate) const CUT_BACK: f64 = 0.5;

/// Refuses results that are not finite. A result that overflows here may not in a smaller increment.
#[inline]
fn require_finite(numbers: &[&[f64]], state: &impl States) -> Result<(), Failure> {
    if state.is_finite() && numbers.iter().all(|numbers| all_finite(numbers)) {
        Ok(())
    } else {
        Err(Failure::CutBack { fraction: CUT_BACK, reason: NO_NUMBER })
    }
}

/// Reason why a result is refused.
const NO_NUMBER: &str = "a result is not a finite number";

impl Response {
    /// Refuses a response or a state that is not finite. A result that overflows at this strain may not at a smaller one.
    ///
    /// # Errors
    /// [`Failure::CutBack`].
    #[inline(always)]
    pub fn check(&self, state: &impl States, request: Request) -> Result<(), Failure> {
        let energies = [self.stored_energy, self.dissipated_energy];
        let tangent_is_finite = !request.wants_tangent() || all_finite(self.tangent.as_flattened());
        // one decision: they are independent, a branch for each would not be
        if tangent_is_finite & all_finite(&self.stress) & all_finite(&energies) & state.is_finite() {
            Ok(())
        } else {
            Err(Failure::CutBack { fraction: 0.25, reason: NO_NUMBER })
        }
    }
}

/// An update that could not be completed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Failure {
    /// The input makes no sense at all: stress is returned as NaN.
    Configuration(ConfigurationError),
    /// The increment cannot be integrated (NaN input, no convergence): the host's arrays stay as
    /// they were and it is asked to retry with `fraction` of the increment, 0 < fraction < 1.
    CutBack {
        /// Suggested PNEWDT.
        fraction: f64,
        /// Reason, in a few words.
        reason: &'static str,
    },
}

impl From<ConfigurationError> for Failure {
    fn from(error: ConfigurationError) -> Self {
        Self::Configuration(error)
    }
}

/// The table that describes a law to hosts and people. Built in a `const`.
#[derive(Clone, Copy, Debug)]
pub struct LawInfo {
    /// The law's name, which is also its library's (`lib<name>.so`).
    pub name: &'static CStr,
    /// One sentence.
    pub description: &'static CStr,
    /// Parameters in PROPS order (of a repeating group: its first occurrence).
    pub parameters: &'static [Parameter],
    /// A group of parameters at the end of PROPS that may occur several times.
    pub repeating: Option<RepeatingGroup>,
    /// State variables in STATEV order; all zero is the virgin state.
    pub states: &'static [StateVariable],
    /// Quantities that hosts can derive from a state variable.
    pub derived: &'static [DerivedOutput],
    /// [`crate::metadata::flags`].
    pub flags: u32,
}

impl LawInfo {
    /// The tables of parameters and states; name, description and flags are the law's to fill in.
    pub const fn of<P: Parameters<'static>, S: States>() -> Self {
        Self {
            name: c"",
            description: c"",
            parameters: P::TABLE,
            repeating: P::REPEATING,
            states: S::TABLE,
            derived: &[],
            flags: 0,
        }
    }

    /// The description that a library exports of the law.
    pub const fn plugin(&self, version: &'static CStr, kinds: u32, stress_states: u32, validate: Validate) -> Plugin {
        let (has_repeating, repeating) = match self.repeating {
            Some(group) => (1, group),
            None => (0, RepeatingGroup::new(c"", 0, 0, -1)),
        };
        Plugin {
            abi_version: ABI_VERSION,
            struct_size: size_of::<Plugin>() as u32,
            law: Text::new(self.name),
            version: Text::new(version),
            description: Text::new(self.description),
            kinds,
            stress_states,
            flags: self.flags,
            has_repeating,
            parameters: Table::new(self.parameters),
            repeating,
            states: Table::new(self.states),
            derived: Table::new(self.derived),
            validate,
            next: std::ptr::null(),
            reserved: std::ptr::null(),
        }
    }
}

/// A constitutive law of a material point.
///
/// `update` is a function of its arguments: same input, same output, on any thread.
pub trait Law {
    /// Name, parameters, states.
    const INFO: LawInfo;
    /// [`crate::metadata::stress_states`] that the law can compute.
    const STRESS_STATES: u32 = crate::metadata::stress_states::ALL;
    /// The parameters as the law's equations name them ([`crate::parameters!`]).
    type Parameters<'p>: Parameters<'p>;
    /// The state variables ([`crate::states!`]).
    type State: States;

    /// Advances `state` over the increment, whose numbers are finite. On `Err` the contents of `state` do not matter, nor on a
    /// result that is not finite: the caller discards them.
    ///
    /// A law ends its states with `strain_33` and `dissipated_energy` and writes both.
    fn update(
        parameters: &Self::Parameters<'_>,
        increment: &Increment,
        state: &mut Self::State,
        request: Request,
    ) -> Result<Response, Failure>;

    /// Whether the law depends on TEMP: hosts call [`Self::update_coupled`] in place of [`Self::elastic`] and [`Self::update`].
    const COUPLED: bool = false;

    /// Advances as [`Self::update`] does, and returns the heat that the material generates. A [coupled](Self::COUPLED) law writes this
    /// function, and [`Self::update`] by it.
    ///
    /// # Errors
    /// Those of [`Self::update`].
    #[inline(always)]
    fn update_coupled(
        parameters: &Self::Parameters<'_>,
        increment: &Increment,
        state: &mut Self::State,
        request: Request,
    ) -> Result<(Response, Heat), Failure> {
        Ok((Self::update(parameters, increment, state, request)?, Heat::default()))
    }

    /// Returns the response of an increment without irreversible change, where that is cheap to recognise. Where it returns
    /// `None`, `state` is unchanged and [`Self::update`] is called. `increment` may hold NaN and infinity, for which it returns
    /// `None`. Implementations are `#[inline(always)]`: an isotropic tangent stays the few numbers that it is made of.
    #[inline(always)]
    fn elastic(
        _parameters: &Self::Parameters<'_>,
        _increment: &Increment,
        _state: &mut Self::State,
        _request: Request,
    ) -> Option<Response> {
        None
    }

    /// Refuses parameters that contradict each other.
    ///
    /// # Errors
    /// The rule that is broken.
    #[inline(always)]
    fn check(_parameters: &Self::Parameters<'_>) -> Result<(), ConfigurationError> {
        Ok(())
    }

    /// Refuses a characteristic length that these parameters cannot work with, or the lack of one.
    ///
    /// # Errors
    /// [`ConfigurationError::CharacteristicLengthMissing`] or [`ConfigurationError::CharacteristicLengthTooLarge`].
    fn check_characteristic_length(
        _parameters: &Self::Parameters<'_>,
        _length: Option<f64>,
    ) -> Result<(), ConfigurationError> {
        Ok(())
    }
}

/// Reads PROPS as a host passes them.
///
/// # Errors
/// A value that the table or [`Law::check`] does not admit.
#[inline(always)]
pub fn parameters_of<L: Law>(props: &[f64]) -> Result<L::Parameters<'_>, ConfigurationError> {
    let parameters = read_parameters::<L::Parameters<'_>>(&L::INFO, props)?;
    L::check(&parameters)?;
    Ok(parameters)
}

/// Reads PROPS of any law.
///
/// # Errors
/// A value that the table does not admit, or values that contradict each other.
#[inline(always)]
pub fn read_parameters<'p, P: Parameters<'p>>(info: &LawInfo, props: &'p [f64]) -> Result<P, ConfigurationError> {
    if !P::admits(props) {
        check_properties(info, props)?;
    }
    P::read(props)
}

/// Evaluates [`Law::elastic`] and checks its results.
///
/// # Errors
/// A result that is not finite.
#[inline(always)]
pub fn elastic<L: Law>(
    parameters: &L::Parameters<'_>,
    increment: &Increment,
    state: &mut L::State,
    request: Request,
) -> Result<Option<Response>, Failure> {
    let response = L::elastic(parameters, increment, state, request);
    if let Some(response) = &response {
        response.check(state, request)?;
    }
    Ok(response)
}

/// Evaluates [`Law::update`] where [`elastic`] returned `None`, and checks the strain and the results.
///
/// # Errors
/// NaN or infinity in the strain or in a result, or the law's own refusal; `state` does not matter then.
#[inline(always)]
pub fn update<L: Law>(
    parameters: &L::Parameters<'_>,
    increment: &Increment,
    state: &mut L::State,
    request: Request,
) -> Result<Response, Failure> {
    if !all_finite(&increment.strain) {
        return Err(Failure::CutBack { fraction: CUT_BACK, reason: "NaN or infinity in STRAN or DSTRAN" });
    }
    let response = L::update(parameters, increment, state, request);
    if let Ok(response) = &response {
        response.check(state, request)?;
    }
    response
}

/// Evaluates [`Law::update_coupled`], and checks the inputs and the results.
///
/// # Errors
/// NaN or infinity in the strain, the temperature or a result, or the law's own refusal; `state` does not matter then.
#[inline(always)]
pub fn update_coupled<L: Law>(
    parameters: &L::Parameters<'_>,
    increment: &Increment,
    state: &mut L::State,
    request: Request,
) -> Result<(Response, Heat), Failure> {
    if !all_finite(&increment.strain) || !increment.temperature.is_finite() {
        return Err(Failure::CutBack { fraction: CUT_BACK, reason: "NaN or infinity in STRAN, DSTRAN, TEMP or DTEMP" });
    }
    let (response, heat) = L::update_coupled(parameters, increment, state, request)?;
    response.check(state, request)?;
    if heat.is_finite() { Ok((response, heat)) } else { Err(Failure::CutBack { fraction: 0.25, reason: NO_NUMBER }) }
}

/// One update as hosts get it, on the values of STATEV, which stay as they are where it fails.
///
/// # Errors
/// As [`update`].
pub fn advance_values<L: Law>(
    parameters: &L::Parameters<'_>,
    increment: &Increment,
    values: &mut [f64],
    request: Request,
) -> Result<Response, Failure> {
    let mut state = L::State::read(values);
    let response = match elastic::<L>(parameters, increment, &mut state, request)? {
        Some(response) => response,
        None => update::<L>(parameters, increment, &mut state, request)?,
    };
    state.write(values);
    Ok(response)
}

/// One increment of a contact point: normal and tangential together (UINTER).
#[derive(Clone, Copy, Debug)]
pub struct InterfaceIncrement {
    /// NDIR: 1 normal + 0…2 tangential directions.
    pub directions: usize,
    /// RDISP at the **end** of the increment: \[0\] > 0 is penetration, \[1\], \[2\] slips; mm.
    pub relative_displacement: [f64; 3],
    /// DRDISP, mm.
    pub increment: [f64; 3],
    /// Traction at the start (STRESS on entry): \[0\] > 0 is compression; MPa.
    pub traction: [f64; 3],
}

/// Results of a UINTER update other than the new states.
#[derive(Clone, Copy, Debug, Default)]
pub struct InterfaceResponse {
    /// Traction at the end: \[0\] > 0 is compression; MPa.
    pub traction: [f64; 3],
    /// `tangent[i][j]` = ∂traction_i/∂relative_displacement_j, MPa/mm.
    pub tangent: [[f64; 3]; 3],
    /// Elastic (stored) energy per area at the end, N/mm.
    pub stored_energy: f64,
    /// Energy dissipated per area since the virgin state, by friction, bond and opening together, N/mm.
    pub dissipated_energy: f64,
}

/// One increment of the tangential part alone (FRIC): the host owns the normal law.
#[derive(Clone, Copy, Debug)]
pub struct TangentialIncrement {
    /// NFDIR: 1 or 2 tangential directions.
    pub directions: usize,
    /// DGAM, the slip increment, mm.
    pub slip_increment: [f64; 2],
    /// Pressure at the end, PRESS > 0 in compression, MPa.
    pub pressure: f64,
}

/// Results of a FRIC update other than the new states.
#[derive(Clone, Copy, Debug, Default)]
pub struct TangentialResponse {
    /// TAU, MPa.
    pub traction: [f64; 2],
    /// DDTDDG, MPa/mm.
    pub slip_tangent: [[f64; 2]; 2],
    /// DDTDDP.
    pub pressure_tangent: [f64; 2],
    /// DSLIP: the non-recoverable part of the slip increment, mm.
    pub inelastic_slip_increment: [f64; 2],
    /// SED, N/mm.
    pub stored_energy: f64,
    /// SFD since the virgin state, N/mm.
    pub dissipated_energy: f64,
}

/// A law of a contact point, offered as UINTER (normal and tangential) and as FRIC (tangential).
pub trait InterfaceLaw {
    /// Name, parameters, states.
    const INFO: LawInfo;
    /// The parameters as the law's equations name them ([`crate::parameters!`]).
    type Parameters<'p>: Parameters<'p>;
    /// The state variables ([`crate::states!`]).
    type State: States;

    /// Normal and tangential traction; see [`Law::update`] for the rules of `state`.
    fn update(
        parameters: &Self::Parameters<'_>,
        increment: &InterfaceIncrement,
        state: &mut Self::State,
        request: Request,
    ) -> Result<InterfaceResponse, Failure>;

    /// Tangential traction under a pressure that the host gives.
    fn update_tangential(
        parameters: &Self::Parameters<'_>,
        increment: &TangentialIncrement,
        state: &mut Self::State,
        request: Request,
    ) -> Result<TangentialResponse, Failure>;
}

/// One update of a contact point as hosts get it.
///
/// # Errors
/// NaN or infinity in the displacements or in a result, or the law's own refusal; `state` does not matter then.
pub fn advance_contact<L: InterfaceLaw>(
    parameters: &L::Parameters<'_>,
    increment: &InterfaceIncrement,
    state: &mut L::State,
    request: Request,
) -> Result<InterfaceResponse, Failure> {
    if !(all_finite(&increment.relative_displacement) && all_finite(&increment.increment)) {
        return Err(Failure::CutBack { fraction: CUT_BACK, reason: "NaN or infinity in RDISP or DRDISP" });
    }
    let response = L::update(parameters, increment, state, request)?;
    let energies = [response.stored_energy, response.dissipated_energy];
    require_finite(&[&response.traction, response.tangent.as_flattened(), &energies], state)?;
    Ok(response)
}

/// One update of the tangential part as hosts get it.
///
/// # Errors
/// NaN or infinity in the slip, the pressure or a result, or the law's own refusal; `state` does not matter then.
pub fn advance_sliding<L: InterfaceLaw>(
    parameters: &L::Parameters<'_>,
    increment: &TangentialIncrement,
    state: &mut L::State,
    request: Request,
) -> Result<TangentialResponse, Failure> {
    if !(all_finite(&increment.slip_increment) && increment.pressure.is_finite()) {
        return Err(Failure::CutBack { fraction: CUT_BACK, reason: "NaN or infinity in DGAM or PRESS" });
    }
    let response = L::update_tangential(parameters, increment, state, request)?;
    let by_slip = response.slip_tangent.as_flattened();
    let energies = [response.stored_energy, response.dissipated_energy];
    let TangentialResponse { traction, pressure_tangent, inelastic_slip_increment, .. } = &response;
    require_finite(&[traction, by_slip, pressure_tangent, inelastic_slip_increment, &energies], state)?;
    Ok(response)
}

/// The error for a value that the parameter's row of the table does not admit.
pub fn out_of_bounds(parameter: &'static Parameter, value: f64) -> ConfigurationError {
    ConfigurationError::OutOfBounds {
        parameter: parameter.name(),
        value,
        lower: parameter.lower,
        upper: parameter.upper,
        open_bounds: parameter.open_bounds,
    }
}

/// Checks PROPS against a law's table: count, finiteness, bounds, choices, repeating group.
///
/// # Errors
/// The first disagreement, in PROPS order.
pub fn check_properties(info: &LawInfo, props: &[f64]) -> Result<(), ConfigurationError> {
    let table = info.parameters;
    let count_error = |expected| ConfigurationError::ParameterCount { given: props.len(), expected };
    let (fixed, group_size) = match info.repeating {
        None if props.len() == table.len() => (table.len(), 0),
        None => return Err(count_error(table.len())),
        Some(group) => {
            let size = group.size as usize;
            let fixed = group.given(props, table.len() - size);
            let least = fixed + size * group.minimum as usize;
            if props.len() < least {
                return Err(count_error(least));
            }
            let rest = props.len() - fixed;
            if group.count_parameter >= 0 {
                let value = props[group.count_parameter as usize];
                let parameter = &table[group.count_parameter as usize];
                if !((0.0..=1e6).contains(&value) && value.fract() == 0.0) {
                    return Err(out_of_bounds(parameter, value));
                }
                if size * value as usize != rest {
                    return Err(count_error(fixed + size * value as usize));
                }
            } else if !rest.is_multiple_of(size) {
                return Err(count_error(fixed + size * (rest / size + 1)));
            }
            (fixed, size)
        }
    };
    let group = table[table.len() - group_size..].iter();
    for (parameter, &value) in table[..fixed].iter().chain(group.cycle()).zip(props) {
        if parameter.admits(value) {
            continue;
        }
        return Err(if parameter.choices().is_empty() {
            out_of_bounds(parameter, value)
        } else {
            ConfigurationError::NotAChoice { parameter: parameter.name(), value }
        });
    }
    Ok(())
}
