//! What a law is: pure functions from (parameters, history, strain) to (stress, tangent, new
//! history), and the one table that describes its parameters and states.
//!
//! The same table makes the metadata of the shared library, the checks of PROPS and the printed
//! documentation. Nothing here touches a pointer or the C side: [`crate::export`] does.

use crate::metadata::{DerivedOutput, Parameter, RepeatingGroup, StateVariable, open_bounds, stress_states};
use std::ffi::CStr;
use std::fmt;

/// Largest number of state variables of a law exported by this crate: the boundary keeps the trial
/// state on the stack, so that a failed update leaves the caller's STATEV as it was.
pub const MAX_STATES: usize = 64;

/// Which components a stress state has. Components are always embedded in six,
/// 11, 22, 33, 12, 13, 23, strains with engineering shear.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum StressState {
    /// NTENS 6, NDI 3, NSHR 3.
    ThreeD,
    /// NTENS 4, NDI 3, NSHR 1: plane strain (ε33 prescribed, usually 0) or axisymmetric (33 = θθ).
    PlaneStrainOrAxisymmetric,
    /// NTENS 3, NDI 2, NSHR 1: σ33 = σ13 = σ23 = 0; the law finds ε33.
    PlaneStress,
}

impl StressState {
    /// Recognises the (NTENS, NDI, NSHR) triples that ABAQUS and its peers use for solids.
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
        }
    }

    /// The [`crate::metadata::stress_states`] bits that these components serve.
    pub fn bits(self) -> u32 {
        match self {
            Self::ThreeD => stress_states::THREE_D,
            Self::PlaneStrainOrAxisymmetric => stress_states::PLANE_STRAIN | stress_states::AXISYMMETRIC,
            Self::PlaneStress => stress_states::PLANE_STRESS,
        }
    }

    /// (NTENS, NDI, NSHR).
    pub fn counts(self) -> (i32, i32, i32) {
        match self {
            Self::ThreeD => (6, 3, 3),
            Self::PlaneStrainOrAxisymmetric => (4, 3, 1),
            Self::PlaneStress => (3, 2, 1),
        }
    }
}

/// What a caller wants back.
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
    /// Which components exist.
    pub stress_state: StressState,
    /// Total strain at the end of the increment (STRAN + DSTRAN).
    pub strain: [f64; 6],
    /// Strain increment (DSTRAN).
    pub strain_increment: [f64; 6],
    /// Stress at the start of the increment (STRESS on entry), rotated by the host under NLGEOM.
    pub stress: [f64; 6],
    /// CELENT, mm; `None` if the host passed NULL, zero, a negative number or NaN.
    pub characteristic_length: Option<f64>,
    /// DTIME, s, where the law asks for it; 1 if the host passed NULL, zero, a negative number or NaN.
    pub time_increment: f64,
}

impl Increment {
    /// Nothing strained or stressed, without a characteristic length: what the components of a host are read into.
    #[inline(always)]
    pub const fn at_rest(stress_state: StressState) -> Self {
        Self {
            stress_state,
            strain: [0.0; 6],
            strain_increment: [0.0; 6],
            stress: [0.0; 6],
            characteristic_length: None,
            time_increment: 1.0,
        }
    }

    /// Refuses NaN and infinity, which comparisons in a law could hide.
    ///
    /// # Errors
    /// [`Failure::CutBack`].
    #[inline]
    pub fn check_strain(&self) -> Result<(), Failure> {
        // 0 · ±∞ and 0 · NaN are NaN
        if self.strain.iter().map(|x| 0.0 * x).sum::<f64>() == 0.0 {
            Ok(())
        } else {
            Err(Failure::CutBack { fraction: 0.25, reason: "the strain is not finite" })
        }
    }
}

/// What an update returns beside the new state variables.
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

impl Response {
    /// The response itself if every number of it and of the new state is finite. What overflows at
    /// this strain may not at a smaller one.
    ///
    /// # Errors
    /// [`Failure::CutBack`] otherwise.
    #[inline(always)]
    pub fn finite(self, state: &[f64]) -> Result<Self, Failure> {
        let is_finite = all_finite(self.tangent.as_flattened());
        self.finite_beside_tangent(is_finite, state)
    }

    /// [`Self::finite`] of a law whose tangent is isotropic, or that and a symmetric dyad: its diagonal is finite only where all of
    /// it is (|a_i a_j| ≤ max(a_i², a_j²)). `state`: what the stress and the energies do not tell of the new state.
    ///
    /// # Errors
    /// As [`Self::finite`].
    #[inline(always)]
    pub fn finite_by_diagonal(self, state: &[f64]) -> Result<Self, Failure> {
        let diagonal: [f64; 6] = std::array::from_fn(|i| self.tangent[i][i]);
        self.finite_beside_tangent(all_finite(&diagonal), state)
    }

    #[inline(always)]
    fn finite_beside_tangent(self, tangent_is_finite: bool, state: &[f64]) -> Result<Self, Failure> {
        let energies = [self.stored_energy, self.dissipated_energy];
        if tangent_is_finite & all_finite(&self.stress) & all_finite(&energies) & all_finite(state) {
            Ok(self)
        } else {
            Err(Failure::CutBack { fraction: 0.25, reason: "a result is not a finite number" })
        }
    }
}

/// Whether none is NaN or infinite: all are looked at, without an early exit, which vectorises. x − x is +0 of a number
/// and NaN of anything else (in the default rounding mode, in which laws run).
///
/// Two by two from the first: a pair that a copy has just written in two halves would have to wait for both.
#[inline(always)]
#[expect(clippy::eq_op, reason = "x - x is not 0 of every x")]
pub(crate) fn all_finite(values: &[f64]) -> bool {
    let (pairs, last) = values.as_chunks::<2>();
    let mut bits = [0, 0];
    for pair in pairs {
        bits[0] |= (pair[0] - pair[0]).to_bits();
        bits[1] |= (pair[1] - pair[1]).to_bits();
    }
    for x in last {
        bits[0] |= (x - x).to_bits();
    }
    bits[0] | bits[1] == 0
}

/// How many points [`Law::update_block`] advances: two registers of AVX2, four of SSE2.
pub const LANES: usize = 8;

/// One number of each point of a block.
pub type Lane = [f64; LANES];

/// [`Increment`]s of LANES points, component by component.
#[derive(Clone, Copy, Debug)]
pub struct Block {
    /// Which components exist.
    pub stress_state: StressState,
    /// Total strain at the end of the increment; finite.
    pub strain: [Lane; 6],
    /// Strain increment.
    pub strain_increment: [Lane; 6],
    /// Stress at the start of the increment.
    pub stress: [Lane; 6],
    /// CELENT, mm.
    pub characteristic_length: [Option<f64>; LANES],
}

/// What the boundary needs of the [`Response`]s of LANES points.
#[derive(Clone, Copy, Debug)]
pub struct BlockResponse {
    /// Stress at the end of the increment, MPa.
    pub stress: [Lane; 6],
    /// Stored energy per volume at the end of the increment, N·mm/mm³.
    pub stored_energy: Lane,
}

/// PROPS, the characteristic length or the state layout are wrong: no increment can be computed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum ConfigurationError {
    /// NPROPS does not fit the parameter table.
    ParameterCount {
        /// What the host passed.
        given: usize,
        /// The least that the law needs.
        expected: usize,
    },
    /// A parameter is NaN, infinite, or outside its bounds.
    OutOfBounds {
        /// Name in the parameter table.
        parameter: &'static str,
        /// What the host passed.
        value: f64,
        /// Least admissible value.
        lower: f64,
        /// Greatest admissible value.
        upper: f64,
        /// Which of them are not admissible themselves ([`crate::metadata::open_bounds`]).
        open_bounds: u32,
    },
    /// A selecting parameter has a value that names no variant.
    NotAChoice {
        /// Name in the parameter table.
        parameter: &'static str,
        /// What the host passed.
        value: f64,
    },
    /// Two or more parameters contradict each other.
    Inconsistent {
        /// Which rule is broken, in words.
        rule: &'static str,
        /// The number that breaks it.
        value: f64,
    },
    /// A crack band is asked for, and CELENT is NULL, NaN, infinite or not positive.
    CharacteristicLengthMissing {
        /// Which fracture energy: the parameter's name.
        parameter: &'static str,
    },
    /// The crack band cannot dissipate the fracture energy over so long an element.
    CharacteristicLengthTooLarge {
        /// Which fracture energy: the parameter's name.
        parameter: &'static str,
        /// CELENT, mm.
        length: f64,
        /// Largest admissible CELENT, mm.
        limit: f64,
    },
}

impl fmt::Display for ConfigurationError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match *self {
            Self::ParameterCount { given, expected } => {
                write!(f, "{given} properties given, {expected} expected")
            }
            Self::OutOfBounds { parameter, value, lower, upper, open_bounds } => {
                // no number is infinite: such a bound is open
                let is_open = |bit: u32, bound: f64| open_bounds & bit != 0 || bound.is_infinite();
                let left = if is_open(open_bounds::LOWER, lower) { '(' } else { '[' };
                let right = if is_open(open_bounds::UPPER, upper) { ')' } else { ']' };
                write!(f, "{parameter} = {value} is outside its bounds {left}{lower}, {upper}{right}")
            }
            Self::NotAChoice { parameter, value } => {
                write!(f, "{parameter} = {value} is none of its listed values")
            }
            Self::Inconsistent { rule, value } => write!(f, "{rule} (found {value})"),
            Self::CharacteristicLengthMissing { parameter } => write!(
                f,
                "{parameter} > 0 asks for a crack band, which needs the element's length (CELENT > 0), but this program \
                 gives none: set {parameter} to 0 for the law without crack band, or let the program give the length"
            ),
            Self::CharacteristicLengthTooLarge { parameter, length, limit } => write!(
                f,
                "characteristic length {length} mm is too large for {parameter}: the limit is {limit:.6} mm; \
                 refine the mesh or raise {parameter}"
            ),
        }
    }
}

impl std::error::Error for ConfigurationError {}

/// An update that could not be completed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Failure {
    /// The input makes no sense at all: stress is returned as NaN.
    Configuration(ConfigurationError),
    /// This increment cannot be integrated (NaN input, no convergence): the host's arrays stay as
    /// they were and it is asked to retry with `fraction` of the increment, 0 < fraction < 1.
    CutBack {
        /// Suggested PNEWDT.
        fraction: f64,
        /// Why, in a few words.
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

/// A constitutive law of a material point.
///
/// `update` is a function of its arguments: same input, same output, on any thread.
pub trait Law {
    /// Name, parameters, states.
    const INFO: LawInfo;
    /// [`crate::metadata::stress_states`] that the law can compute.
    const STRESS_STATES: u32 = crate::metadata::stress_states::ALL;
    /// The parameters as the law's equations name them; may borrow tables from PROPS.
    type Parameters<'p>;

    /// Reads PROPS. Number, finiteness, bounds and choices were checked against
    /// [`LawInfo::parameters`] before; what remains are relations between parameters.
    fn parameters(props: &[f64]) -> Result<Self::Parameters<'_>, ConfigurationError>;

    /// Advances `state` (exactly [`LawInfo::states`] values) over the increment.
    /// On `Err` the contents of `state` do not matter: the caller discards them.
    ///
    /// A law ends its states with `strain_33` and `dissipated_energy` and writes both.
    fn update(
        parameters: &Self::Parameters<'_>,
        increment: &Increment,
        state: &mut [f64],
        request: Request,
    ) -> Result<Response, Failure>;

    /// The early way out of [`Self::update`], where nothing irreversible happens and that is quickly told: the same response,
    /// to the same bits. The boundary asks for it first, and writes it down on a path of its own, where an isotropic
    /// tangent stays the few numbers that it is made of.
    ///
    /// `increment` is not looked at before, `state` is. `Some`: every number of the response and of the new state is finite.
    /// `None`: `state` is as it was. `#[inline(always)]` wherever it is implemented.
    #[inline(always)]
    fn elastic(
        _parameters: &Self::Parameters<'_>,
        _increment: &Increment,
        _state: &mut [f64],
        _request: Request,
    ) -> Option<Response> {
        None
    }

    /// Whether every number of a response and of a new state is finite, [`Self::update`] failing otherwise
    /// ([`Response::finite`]): the boundary does not look at them again.
    const FINITE_OR_FAILS: bool = false;

    /// Whether [`Self::update`] looks at [`Increment::time_increment`], which is not even read otherwise.
    const USES_TIME_INCREMENT: bool = false;

    /// Whether [`Self::update_block`] is there.
    const UPDATES_BLOCKS: bool = false;

    /// Advances LANES points at once, stress only: to the same bits as [`Self::update`] point by point. `None`: this is
    /// for single updates (any of them may fail, or the law has no such form for these parameters); `state` does not
    /// matter then.
    ///
    /// `#[inline(always)]` wherever it is implemented: the boundary compiles it for wider registers.
    #[inline(always)]
    fn update_block(_parameters: &Self::Parameters<'_>, _block: &Block, _state: &mut [Lane]) -> Option<BlockResponse> {
        None
    }

    /// Whether these parameters need a characteristic length (their crack band is on).
    fn needs_characteristic_length(_parameters: &Self::Parameters<'_>) -> bool {
        false
    }

    /// Refuses a characteristic length that these parameters cannot work with.
    fn check_characteristic_length(_parameters: &Self::Parameters<'_>, _length: f64) -> Result<(), ConfigurationError> {
        Ok(())
    }
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

/// What a UINTER update returns beside the new states.
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

/// What a FRIC update returns beside the new states.
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
    /// The parameters as the law's equations name them; may borrow tables from PROPS.
    type Parameters<'p>;

    /// Reads PROPS; see [`Law::parameters`].
    fn parameters(props: &[f64]) -> Result<Self::Parameters<'_>, ConfigurationError>;

    /// Normal and tangential traction; see [`Law::update`] for the rules of `state`.
    fn update(
        parameters: &Self::Parameters<'_>,
        increment: &InterfaceIncrement,
        state: &mut [f64],
        request: Request,
    ) -> Result<InterfaceResponse, Failure>;

    /// Tangential traction under a pressure that the host gives.
    fn update_tangential(
        parameters: &Self::Parameters<'_>,
        increment: &TangentialIncrement,
        state: &mut [f64],
        request: Request,
    ) -> Result<TangentialResponse, Failure>;
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
    let (fixed, group_size, occurrences) = match info.repeating {
        None if props.len() == table.len() => (table.len(), 0, 0),
        None => return Err(count_error(table.len())),
        Some(group) => {
            let fixed = table.len() - group.size as usize;
            let size = group.size as usize;
            let least = fixed + size * group.minimum as usize;
            if props.len() < least {
                return Err(count_error(least));
            }
            let rest = props.len() - fixed;
            let occurrences = if group.count_parameter >= 0 {
                let value = props[group.count_parameter as usize];
                let parameter = &table[group.count_parameter as usize];
                if !((0.0..=1e6).contains(&value) && value.fract() == 0.0) {
                    return Err(out_of_bounds(parameter, value));
                }
                if size * value as usize != rest {
                    return Err(count_error(fixed + size * value as usize));
                }
                value as usize
            } else if rest.is_multiple_of(size) {
                rest / size
            } else {
                return Err(count_error(fixed + size * (rest / size + 1)));
            };
            (fixed, size, occurrences)
        }
    };
    for (parameter, &value) in table[..fixed].iter().zip(props) {
        parameter.check(value).map_err(|()| parameter_error(parameter, value))?;
    }
    for group in props[fixed..].chunks_exact(group_size.max(1)).take(occurrences) {
        for (parameter, &value) in table[fixed..].iter().zip(group) {
            parameter.check(value).map_err(|()| parameter_error(parameter, value))?;
        }
    }
    Ok(())
}

/// [`check_properties`] of a law, without a look at the table where all is well: this runs in every call.
///
/// # Errors
/// As [`check_properties`].
#[inline(always)]
pub fn check_properties_of<L: Law>(props: &[f64]) -> Result<(), ConfigurationError> {
    let bounds = const { &ClosedBounds::of(&L::INFO) };
    if bounds.admit(props) { Ok(()) } else { check_properties(&L::INFO, props) }
}

/// Most parameters of a table that is looked at at once.
const MOST_BOUNDS: usize = 16;

/// The admissible numbers of each parameter, bounds included.
struct ClosedBounds {
    /// How many parameters are there once, how many the group at the end has, and how often it is there at least;
    /// `None`: more is to be looked at than bounds.
    counts: Option<[usize; 3]>,
    lower: [f64; MOST_BOUNDS],
    upper: [f64; MOST_BOUNDS],
}

impl ClosedBounds {
    const fn of(info: &LawInfo) -> Self {
        let table = info.parameters;
        let mut bounds = Self { counts: None, lower: [0.0; MOST_BOUNDS], upper: [0.0; MOST_BOUNDS] };
        let [size, minimum] = match info.repeating {
            None => [0, 0],
            Some(group) if group.count_parameter < 0 => [group.size as usize, group.minimum as usize],
            Some(_) => return bounds,
        };
        if table.len() > MOST_BOUNDS {
            return bounds;
        }
        let mut k = 0;
        while k < table.len() {
            let Some([lower, upper]) = table[k].closed_bounds() else { return bounds };
            (bounds.lower[k], bounds.upper[k]) = (lower, upper);
            k += 1;
        }
        bounds.counts = Some([table.len() - size, size, minimum]);
        bounds
    }

    /// Whether these are as many as there may be, all within their bounds; no NaN is.
    #[inline(always)]
    fn admit(&self, props: &[f64]) -> bool {
        let Some([fixed, size, minimum]) = self.counts else { return false };
        let Some((once, groups)) = props.split_at_checked(fixed) else { return false };
        let within = |k: usize, x: f64| (self.lower[k] <= x) & (x <= self.upper[k]);
        // one decision: they are independent, a branch for each would not be
        let mut all_within = true;
        for k in 0..fixed {
            all_within &= within(k, once[k]);
        }
        if !all_within || size == 0 {
            return all_within && groups.is_empty();
        }
        let groups = groups.chunks_exact(size);
        if groups.len() < minimum || !groups.remainder().is_empty() {
            return false;
        }
        for group in groups {
            for k in 0..size {
                if !within(fixed + k, group[k]) {
                    return false;
                }
            }
        }
        true
    }
}

fn parameter_error(parameter: &'static Parameter, value: f64) -> ConfigurationError {
    if parameter.choices().is_empty() {
        out_of_bounds(parameter, value)
    } else {
        ConfigurationError::NotAChoice { parameter: parameter.name(), value }
    }
}
