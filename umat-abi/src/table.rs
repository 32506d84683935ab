//! One typed table per law: the structs that its equations read, with the metadata and the checks that hosts see.
//!
//! [`parameters!`](crate::parameters) and [`states!`](crate::states) make a field of one or more rows; the rows are PROPS or STATEV
//! in order. [`choices!`](crate::choices) makes an enum of the named values of a selecting parameter.

use crate::metadata::{Parameter, RepeatingGroup, StateVariable, open_bounds};
use std::fmt;

/// Largest number of state variables of a law exported by this crate.
pub const MAX_STATES: usize = 64;

/// Returns whether none is NaN or infinite: all are looked at, without an early exit, which vectorises. x − x is +0 of a number
/// and NaN of anything else (in the default rounding mode, in which laws run).
#[inline(always)]
#[expect(clippy::eq_op, reason = "x - x is not 0 of every x")]
pub(crate) fn all_finite(values: &[f64]) -> bool {
    values.iter().fold(0, |bits, x| bits | (x - x).to_bits()) == 0
}

/// PROPS, the characteristic length or the state layout are wrong: no increment can be computed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum ConfigurationError {
    /// NPROPS does not fit the parameter table.
    ParameterCount {
        /// Number of values that the host passed.
        given: usize,
        /// The least that the law needs.
        expected: usize,
    },
    /// A parameter is NaN, infinite, or outside its bounds.
    OutOfBounds {
        /// Name in the parameter table.
        parameter: &'static str,
        /// Value that the host passed.
        value: f64,
        /// Least admissible value.
        lower: f64,
        /// Greatest admissible value.
        upper: f64,
        /// Bounds that are not admissible themselves ([`crate::metadata::open_bounds`]).
        open_bounds: u32,
    },
    /// A selecting parameter has a value that names no variant.
    NotAChoice {
        /// Name in the parameter table.
        parameter: &'static str,
        /// Value that the host passed.
        value: f64,
    },
    /// Two or more parameters contradict each other.
    Inconsistent {
        /// The broken rule, as text.
        rule: &'static str,
        /// The number that breaks it.
        value: f64,
    },
    /// A number that follows from the parameters is greater than another.
    Exceeds {
        /// The broken rule, as text.
        rule: &'static str,
        /// The greater number.
        value: f64,
        /// What it must not exceed.
        limit: f64,
    },
    /// A crack band is asked for, and CELENT is NULL, NaN, infinite or not positive.
    CharacteristicLengthMissing {
        /// Name of the fracture energy's parameter.
        parameter: &'static str,
    },
    /// The crack band cannot dissipate the fracture energy over so long an element.
    CharacteristicLengthTooLarge {
        /// Name of the fracture energy's parameter.
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
                write!(f, "{parameter} = {value} is not one of the listed values")
            }
            Self::Inconsistent { rule, value } => write!(f, "{rule} (found {value})"),
            Self::Exceeds { rule, value, limit } => write!(f, "{rule} ({value} > {limit})"),
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

/// Refuses parameters that break a rule.
///
/// # Errors
/// [`ConfigurationError::Inconsistent`] unless the rule holds.
#[inline(always)]
pub fn require(holds: bool, rule: &'static str, value: f64) -> Result<(), ConfigurationError> {
    if holds { Ok(()) } else { Err(ConfigurationError::Inconsistent { rule, value }) }
}

/// Refuses parameters of which a number that follows is greater than another.
///
/// # Errors
/// [`ConfigurationError::Exceeds`] unless the rule holds.
#[inline(always)]
pub fn require_at_most(holds: bool, rule: &'static str, value: f64, limit: f64) -> Result<(), ConfigurationError> {
    if holds { Ok(()) } else { Err(ConfigurationError::Exceeds { rule, value, limit }) }
}

/// A struct that is read from PROPS.
pub trait Parameters<'p>: Sized {
    /// PROPS in order; of a repeating group the first occurrence, at the end.
    const TABLE: &'static [Parameter];
    /// The group of parameters at the end of PROPS that may occur several times.
    const REPEATING: Option<RepeatingGroup> = None;

    /// Returns whether there are as many as there may be, all within their bounds. This runs in every call, and compiles to two
    /// comparisons a parameter; [`crate::law::check_properties`] finds the words where it says no.
    fn admits(props: &[f64]) -> bool;

    /// Reads PROPS that were admitted.
    ///
    /// # Errors
    /// Values that contradict each other.
    fn read(props: &'p [f64]) -> Result<Self, ConfigurationError>;
}

/// R t Rᵀ of the components 11, 22, 33, 12, 13, 23; `shear` is 2 for strains (engineering shear), 1 for stresses.
#[inline]
pub fn rotated(tensor: &[f64; 6], rotation: &[[f64; 3]; 3], shear: f64) -> [f64; 6] {
    let [a, b, c, d, e, f] = *tensor;
    let m = [[a, d / shear, e / shear], [d / shear, b, f / shear], [e / shear, f / shear, c]];
    let entry = |i: usize, j: usize| {
        let terms = (0..9).map(|n| rotation[i][n / 3] * m[n / 3][n % 3] * rotation[j][n % 3]);
        terms.fold(0.0, |sum, term| sum + term)
    };
    [entry(0, 0), entry(1, 1), entry(2, 2), shear * entry(0, 1), shear * entry(0, 2), shear * entry(1, 2)]
}

/// A struct that is copied from STATEV and back. All zero is the virgin state.
pub trait States: Copy {
    /// STATEV in order.
    const TABLE: &'static [StateVariable];

    /// Reads as many values as the table has rows.
    fn read(values: &[f64]) -> Self;

    /// Writes them.
    fn write(&self, values: &mut [f64]);

    /// Returns whether none is NaN or infinite.
    fn is_finite(&self) -> bool;

    /// Rotates the strain-like tensors among them: R ε Rᵀ.
    fn rotate(&mut self, rotation: &[[f64; 3]; 3]) {
        let mut values = [0.0; MAX_STATES];
        let values = &mut values[..Self::TABLE.len()];
        self.write(values);
        for start in (0..values.len()).filter(|&k| Self::TABLE[k].tensor_component == 1) {
            let tensor = std::array::from_fn(|i| values[start + i]);
            values[start..start + 6].copy_from_slice(&rotated(&tensor, rotation, 2.0));
        }
        *self = Self::read(values);
    }
}

/// Value that is read from N rows of a table of parameters.
pub trait Field<const N: usize>: Sized {
    /// Reads the values of its rows.
    ///
    /// # Errors
    /// Values that contradict each other.
    fn read(values: [f64; N]) -> Result<Self, ConfigurationError>;
}

impl Field<1> for f64 {
    #[inline(always)]
    fn read([value]: [f64; 1]) -> Result<Self, ConfigurationError> {
        Ok(value)
    }
}

impl<const N: usize> Field<N> for [f64; N] {
    #[inline(always)]
    fn read(values: [f64; N]) -> Result<Self, ConfigurationError> {
        Ok(values)
    }
}

/// Value that is stored in N state variables.
pub trait StateField<const N: usize> {
    /// Makes a field from the values of its rows.
    fn of(values: [f64; N]) -> Self;
    /// The values of its rows.
    fn values(&self) -> [f64; N];
}

impl StateField<1> for f64 {
    #[inline(always)]
    fn of([value]: [f64; 1]) -> Self {
        value
    }

    #[inline(always)]
    fn values(&self) -> [f64; 1] {
        [*self]
    }
}

impl<const N: usize> StateField<N> for [f64; N] {
    #[inline(always)]
    fn of(values: [f64; N]) -> Self {
        values
    }

    #[inline(always)]
    fn values(&self) -> [f64; N] {
        *self
    }
}

/// Admissible values of N rows: the bounds as arrays, so that all are compared at once.
#[doc(hidden)]
#[derive(Debug)]
pub struct Check<const N: usize> {
    rows: &'static [Parameter; N],
    /// Bounds included.
    lower: [f64; N],
    upper: [f64; N],
}

impl<const N: usize> Check<N> {
    /// Checks rows of a table.
    pub const fn new(rows: &'static [Parameter; N]) -> Self {
        let mut check = Self { rows, lower: [0.0; N], upper: [0.0; N] };
        let mut k = 0;
        while k < N {
            let Parameter { lower, upper, open_bounds, .. } = rows[k];
            let lower = if open_bounds & open_bounds::LOWER != 0 { lower.next_up() } else { lower };
            let upper = if open_bounds & open_bounds::UPPER != 0 { upper.next_down() } else { upper };
            (check.lower[k], check.upper[k]) = (lower.max(f64::MIN), upper.min(f64::MAX));
            k += 1;
        }
        check
    }

    /// Returns whether all values are within their bounds (no NaN is), and listed where there are choices.
    #[inline(always)]
    pub fn admits(&self, values: &[f64; N]) -> bool {
        // one decision: they are independent, a branch for each would not be
        let mut within = true;
        for k in 0..N {
            within &= (self.lower[k] <= values[k]) & (values[k] <= self.upper[k]);
        }
        let is_listed = |(row, value): (&Parameter, &f64)| row.choices.count == 0 || row.admits(*value);
        within && self.rows.iter().zip(values).all(is_listed)
    }
}

/// Splits PROPS before the group that may follow: the parameters that stand there, with the defaults of those that were added later and
/// are not given, and the rest.
#[doc(hidden)]
#[inline(always)]
pub fn split<'p, const N: usize>(
    group: &Option<RepeatingGroup>,
    rows: &[Parameter; N],
    props: &'p [f64],
) -> Option<([f64; N], &'p [f64])> {
    let given = group.as_ref().map_or(N, |group| group.given(props, N));
    if given == N {
        // one copy of a known size
        return props.split_first_chunk().map(|(before, rest)| (*before, rest));
    }
    let (before, rest) = props.split_at_checked(given)?;
    Some((std::array::from_fn(|k| before.get(k).copied().unwrap_or(rows[k].default_value)), rest))
}

/// Takes the next N values.
#[doc(hidden)]
#[inline(always)]
pub fn take<const N: usize>(values: &[f64], at: &mut usize) -> [f64; N] {
    let mut taken = [0.0; N];
    for i in 0..N {
        taken[i] = values[*at + i];
    }
    *at += N;
    taken
}

/// Writes the next N values.
#[doc(hidden)]
#[inline(always)]
pub fn put<const N: usize>(taken: [f64; N], values: &mut [f64], at: &mut usize) {
    for i in 0..N {
        values[*at + i] = taken[i];
    }
    *at += N;
}

/// Returns whether none of a field is NaN or infinite.
#[doc(hidden)]
#[inline(always)]
pub fn is_finite<const N: usize>(field: &impl StateField<N>) -> bool {
    all_finite(&field.values())
}

/// Declares the parameters of a law: each field with the rows of PROPS that it is made of.
///
/// ```
/// # use umat_abi::metadata::Parameter;
/// umat_abi::parameters! {
///     /// PROPS.
///     pub struct Parameters {
///         /// K, MPa.
///         pub bulk_modulus: f64 = Parameter::new(c"K", c"MPa", 20e3, c"bulk modulus").above(0.0);
///         /// G, MPa.
///         pub shear_modulus: f64 = Parameter::new(c"G", c"MPa", 12e3, c"shear modulus").above(0.0);
///     }
/// }
/// ```
///
/// A field may be made of several rows by its [`Field::read`](crate::table::Field::read). With a lifetime the last
/// field, after `..RepeatingGroup::new(…) =>`, is a view of the group at the end: anything that is `From<&[[f64; N]]>`.
#[macro_export]
macro_rules! parameters {
    (
        $(#[$doc:meta])* $visibility:vis struct $name:ident $(<$life:lifetime>)? {
            $($(#[$field_doc:meta])* $field_visibility:vis $field:ident: $type:ty = $($row:expr),+;)+
            $(
                ..$repeating:expr =>
                $(#[$group_doc:meta])* $group_visibility:vis $group:ident: $group_type:ty = $($group_row:expr),+;
            )?
        }
    ) => {
        $(#[$doc])*
        #[derive(Clone, Copy, Debug, PartialEq)]
        $visibility struct $name $(<$life>)? {
            $($(#[$field_doc])* $field_visibility $field: $type,)+
            $($(#[$group_doc])* $group_visibility $group: $group_type,)?
        }

        $crate::parameters!(@read [$($life)? 'p] $name $(<$life>)? {
            $($field: $type = $($row),+;)+
            $(..$repeating => $group: $group_type = $($group_row),+;)?
        });
    };
    (@read [$life:lifetime $('p)?] $name:ident $(<$own:lifetime>)? {
        $($field:ident: $type:ty = $($row:expr),+;)+
        $(..$repeating:expr => $group:ident: $group_type:ty = $($group_row:expr),+;)?
    }) => {
        impl<$life> $crate::table::Parameters<$life> for $name $(<$own>)? {
            const TABLE: &'static [$crate::metadata::Parameter] = &const { [$($($row),+),+ $(, $($group_row),+)?] };
            $(const REPEATING: Option<$crate::metadata::RepeatingGroup> = Some($repeating);)?

            #[inline(always)]
            fn admits(props: &[f64]) -> bool {
                const ROWS: [$crate::metadata::Parameter; 0 $(+ [$($row),+].len())+] = [$($($row),+),+];
                const CHECK: $crate::table::Check<{ ROWS.len() }> = $crate::table::Check::new(&ROWS);
                let Some((once, groups)) = $crate::table::split(&Self::REPEATING, &ROWS, props) else { return false };
                #[allow(unused_mut, reason = "for a repeating group")]
                let mut admitted = CHECK.admits(&once);
                $(
                    const GROUP: $crate::metadata::RepeatingGroup = $repeating;
                    const GROUP_ROWS: [$crate::metadata::Parameter; [$($group_row),+].len()] = [$($group_row),+];
                    const GROUP_CHECK: $crate::table::Check<{ GROUP_ROWS.len() }> =
                        $crate::table::Check::new(&GROUP_ROWS);
                    let (occurrences, groups) = groups.as_chunks();
                    admitted &= GROUP.admits(occurrences.len(), &once);
                    for group in occurrences {
                        admitted &= GROUP_CHECK.admits(group);
                    }
                )?
                admitted && groups.is_empty()
            }

            #[inline(always)]
            fn read(props: &$life [f64]) -> Result<Self, $crate::table::ConfigurationError> {
                const ROWS: [$crate::metadata::Parameter; 0 $(+ [$($row),+].len())+] = [$($($row),+),+];
                let Some((once, rest)) = $crate::table::split(&Self::REPEATING, &ROWS, props) else {
                    let [given, expected] = [props.len(), ROWS.len()];
                    return Err($crate::table::ConfigurationError::ParameterCount { given, expected });
                };
                let mut at = 0;
                $(
                    let values = $crate::table::take(&once, &mut at);
                    let $field = <$type as $crate::table::Field<{ [$($row),+].len() }>>::read(values)?;
                )+
                $(let $group = <$group_type>::from(rest.as_chunks::<{ [$($group_row),+].len() }>().0);)?
                let _ = (at, rest);
                Ok(Self { $($field,)+ $($group)? })
            }
        }
    };
}

/// Declares the states of a law: each field, a number or an array of them, with its rows of STATEV.
///
/// ```
/// # use umat_abi::metadata::StateVariable;
/// umat_abi::states! {
///     /// STATEV.
///     pub struct State {
///         /// Total strain 33.
///         pub strain_33: f64 = StateVariable::new(c"strain_33", c"-", c"total strain 33");
///     }
/// }
/// ```
#[macro_export]
macro_rules! states {
    (
        $(#[$doc:meta])* $visibility:vis struct $name:ident {
            $($(#[$field_doc:meta])* $field_visibility:vis $field:ident: $type:ty = $($row:expr),+;)+
        }
    ) => {
        $(#[$doc])*
        #[derive(Clone, Copy, Debug, Default, PartialEq)]
        $visibility struct $name { $($(#[$field_doc])* $field_visibility $field: $type,)+ }

        impl $crate::table::States for $name {
            const TABLE: &'static [$crate::metadata::StateVariable] = &const { [$($($row),+),+] };

            #[inline(always)]
            fn read(values: &[f64]) -> Self {
                let mut at = 0;
                $(
                    let taken = $crate::table::take(values, &mut at);
                    let $field = <$type as $crate::table::StateField<{ [$($row),+].len() }>>::of(taken);
                )+
                let _ = at;
                Self { $($field),+ }
            }

            #[inline(always)]
            fn write(&self, values: &mut [f64]) {
                let mut at = 0;
                $(
                    let taken = <$type as $crate::table::StateField<{ [$($row),+].len() }>>::values(&self.$field);
                    $crate::table::put(taken, values, &mut at);
                )+
                let _ = at;
            }

            #[inline(always)]
            fn is_finite(&self) -> bool {
                true $(& $crate::table::is_finite::<{ [$($row),+].len() }>(&self.$field))+
            }
        }
    };
}

/// Declares the named values of a selecting parameter: an enum, and `CHOICES` for [`Parameter::one_of`].
///
/// ```
/// umat_abi::choices! {
///     /// Which form.
///     pub enum Form {
///         /// As in the thesis.
///         Thesis = 0.0 c"thesis",
///         /// Without its jumps.
///         Regular = 1.0 c"regular",
///     }
/// }
/// ```
#[macro_export]
macro_rules! choices {
    (
        $(#[$doc:meta])* $visibility:vis enum $name:ident {
            $($(#[$choice_doc:meta])* $choice:ident = $value:literal $text:literal,)+
        }
    ) => {
        $(#[$doc])*
        #[derive(Clone, Copy, Debug, PartialEq, Eq)]
        $visibility enum $name { $($(#[$choice_doc])* $choice,)+ }

        impl $name {
            /// The named values.
            pub const CHOICES: &'static [$crate::metadata::Choice] =
                &const { [$($crate::metadata::Choice::new($value, $text)),+] };
        }

        impl $crate::table::Field<1> for $name {
            #[inline(always)]
            fn read([value]: [f64; 1]) -> Result<Self, $crate::table::ConfigurationError> {
                $(if value == $value {
                    return Ok(Self::$choice);
                })+
                Err($crate::table::ConfigurationError::NotAChoice { parameter: stringify!($name), value })
            }
        }
    };
}
