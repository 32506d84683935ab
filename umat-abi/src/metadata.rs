//! The `#[repr(C)]` description that a plugin exports through `pullout_plugin_v1`.
//!
//! The structs are at once the tables that a law writes (const builders from C string literals) and
//! the memory that hosts in C, Fortran and Rust read. They may grow at their ends: readers check
//! `abi_version`, `struct_size` and the strides.

use std::ffi::{CStr, c_char, c_void};
use std::marker::PhantomData;

/// Version of this layout; a host refuses any other.
pub const ABI_VERSION: u32 = 1;

/// Symbol of the function that returns the description: `const pullout_plugin *pullout_plugin_v1(void)`.
pub const PLUGIN_SYMBOL: &str = "pullout_plugin_v1";

/// Entry points that a library has (bit mask `kinds`).
pub mod kinds {
    /// `umat_`
    pub const UMAT: u32 = 1;
    /// `fric_`
    pub const FRIC: u32 = 2;
    /// `uinter_`
    pub const UINTER: u32 = 4;
}

/// Supported stress states (bit mask `stress_states`).
pub mod stress_states {
    /// NTENS 6.
    pub const THREE_D: u32 = 1;
    /// NTENS 4, NDI 3.
    pub const PLANE_STRAIN: u32 = 2;
    /// NTENS 4, NDI 3, 11 rr, 22 zz, 33 θθ.
    pub const AXISYMMETRIC: u32 = 4;
    /// NTENS 3, NDI 2.
    pub const PLANE_STRESS: u32 = 8;
    /// All of them.
    pub const ALL: u32 = THREE_D | PLANE_STRAIN | AXISYMMETRIC | PLANE_STRESS;
}

/// Properties that a law guarantees (bit mask `flags`).
pub mod flags {
    /// The consistent tangent is symmetric for all parameters.
    pub const SYMMETRIC_TANGENT: u32 = 1;
    /// May be called from several threads at once.
    pub const THREAD_SAFE: u32 = 2;
    /// Reads CELENT (for some parameters).
    pub const USES_CELENT: u32 = 4;
    /// Uses DFGRD0/DFGRD1: a finite-strain law.
    pub const FINITE_STRAIN: u32 = 8;
    /// DDSDDE (UINTER: DDSDDR, FRIC: DDTDDG) = NULL means: stress only.
    pub const STRESS_ONLY: u32 = 16;
    /// For all parameters, the response does not depend on the increment size on proportional monotonic strain
    /// paths.
    pub const PATH_EXACT: u32 = 32;
    /// Isotropic: a rotated strain path gives the rotated stress path.
    pub const ISOTROPIC: u32 = 64;
}

/// The state variable of a law that integrates by extrapolation: the work so far of what its stress exceeds that of the
/// implicit law by, N·mm/mm³, its amount. Hosts choose their increments by it.
pub const OVERSTRESS_WORK: &CStr = c"overstress_work";

/// The state variable that is the equivalent plastic strain of a law, ∫√(2/3 dεᵖ:dεᵖ). Hosts use it to report how far
/// a fibre has been strained.
pub const EQUIVALENT_PLASTIC_STRAIN: &CStr = c"peeq";

/// A C string that lives as long as the library: never NULL when made by a const builder.
#[repr(transparent)]
#[derive(Clone, Copy)]
pub struct Text(*const c_char);

// SAFETY: `Text` points to immutable static bytes.
unsafe impl Sync for Text {}
// SAFETY: as above.
unsafe impl Send for Text {}

impl Text {
    /// Wraps a literal.
    pub const fn new(text: &'static CStr) -> Self {
        Self(text.as_ptr())
    }

    /// The address, for readers that check it themselves.
    pub const fn as_ptr(self) -> *const c_char {
        self.0
    }

    /// The text of a table built in this program.
    fn as_str(self) -> &'static str {
        // SAFETY: the only constructor takes a `&'static CStr`.
        unsafe { CStr::from_ptr(self.0) }.to_str().unwrap_or("?")
    }
}

impl std::fmt::Debug for Text {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(self.as_str())
    }
}

/// Pointer and length of a static table, as C sees it; `stride` is the size of one element, so that
/// elements can grow without breaking old readers.
#[repr(C)]
#[derive(Debug)]
pub struct Table<T: 'static> {
    /// First element; NULL if `count` is 0.
    pub first: *const T,
    /// Number of elements.
    pub count: u32,
    /// Bytes from one element to the next.
    pub stride: u32,
    marker: PhantomData<&'static T>,
}

impl<T> Clone for Table<T> {
    fn clone(&self) -> Self {
        *self
    }
}
impl<T> Copy for Table<T> {}

// SAFETY: a table is a view of an immutable static slice of `Sync` elements.
unsafe impl<T: Sync> Sync for Table<T> {}
// SAFETY: as above.
unsafe impl<T: Sync> Send for Table<T> {}

impl<T> Table<T> {
    /// Views a static slice.
    pub const fn new(slice: &'static [T]) -> Self {
        Self { first: slice.as_ptr(), count: slice.len() as u32, stride: size_of::<T>() as u32, marker: PhantomData }
    }

    /// The slice of a table built in this program.
    fn as_slice(&self) -> &'static [T] {
        // SAFETY: `new` took pointer and length from a static slice.
        unsafe { std::slice::from_raw_parts(self.first, self.count as usize) }
    }
}

/// A named value of a selecting parameter.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct Choice {
    /// The number in PROPS.
    pub value: f64,
    /// The name that case files may use.
    pub name: Text,
}

impl Choice {
    /// A choice.
    pub const fn new(value: f64, name: &'static CStr) -> Self {
        Self { value, name: Text::new(name) }
    }

    /// Returns the name.
    pub fn name(&self) -> &'static str {
        self.name.as_str()
    }
}

/// `open_bounds` bits.
pub mod open_bounds {
    /// The lower bound itself is not admissible.
    pub const LOWER: u32 = 1;
    /// The upper bound itself is not admissible.
    pub const UPPER: u32 = 2;
}

/// One entry of PROPS.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct Parameter {
    /// Name in case files.
    pub name: Text,
    /// Unit, "-" if none.
    pub unit: Text,
    /// One sentence.
    pub doc: Text,
    /// Quantity that a host may fill in when the value is 0: "normal_penalty", "tangential_penalty", or "".
    pub role: Text,
    /// Used when a case names no value.
    pub default_value: f64,
    /// Least value.
    pub lower: f64,
    /// Greatest value.
    pub upper: f64,
    /// [`open_bounds`].
    pub open_bounds: u32,
    /// Unused, 0.
    pub reserved: u32,
    /// Named values, if this parameter selects a form.
    pub choices: Table<Choice>,
    /// Least usual value: a host warns of others, which may be a slip of units. Libraries older than this entry end here:
    /// readers look at the stride of the table.
    pub typical_lower: f64,
    /// Greatest usual value; 0, as `typical_lower`: none are said.
    pub typical_upper: f64,
}

impl Parameter {
    /// A parameter without bounds.
    pub const fn new(name: &'static CStr, unit: &'static CStr, default_value: f64, doc: &'static CStr) -> Self {
        Self {
            name: Text::new(name),
            unit: Text::new(unit),
            doc: Text::new(doc),
            role: Text::new(c""),
            default_value,
            lower: f64::NEG_INFINITY,
            upper: f64::INFINITY,
            open_bounds: 0,
            reserved: 0,
            choices: Table::new(&[]),
            typical_lower: 0.0,
            typical_upper: 0.0,
        }
    }

    /// Returns what values are usual, as the default and 0 are; others that the bounds admit are no errors.
    pub const fn typically(mut self, lower: f64, upper: f64) -> Self {
        self.typical_lower = lower;
        self.typical_upper = upper;
        self
    }

    /// lower ≤ value ≤ upper.
    pub const fn within(mut self, lower: f64, upper: f64) -> Self {
        self.lower = lower;
        self.upper = upper;
        self
    }

    /// lower < value.
    pub const fn above(mut self, lower: f64) -> Self {
        self.lower = lower;
        self.open_bounds |= open_bounds::LOWER;
        self
    }

    /// lower ≤ value.
    pub const fn at_least(mut self, lower: f64) -> Self {
        self.lower = lower;
        self
    }

    /// value < upper.
    pub const fn below(mut self, upper: f64) -> Self {
        self.upper = upper;
        self.open_bounds |= open_bounds::UPPER;
        self
    }

    /// value ≤ upper.
    pub const fn at_most(mut self, upper: f64) -> Self {
        self.upper = upper;
        self
    }

    /// The parameter selects one of these.
    pub const fn one_of(mut self, choices: &'static [Choice]) -> Self {
        self.choices = Table::new(choices);
        self.lower = choices[0].value;
        self.upper = choices[choices.len() - 1].value;
        self
    }

    /// The host may fill a zero according to this role.
    pub const fn with_role(mut self, role: &'static CStr) -> Self {
        self.role = Text::new(role);
        self
    }

    /// Returns the name.
    pub fn name(&self) -> &'static str {
        self.name.as_str()
    }

    /// Returns the named values.
    pub fn choices(&self) -> &'static [Choice] {
        self.choices.as_slice()
    }

    /// Returns whether the value is finite, within bounds and, for a selecting parameter, listed.
    pub fn admits(&self, value: f64) -> bool {
        let above = if self.open_bounds & open_bounds::LOWER != 0 { value > self.lower } else { value >= self.lower };
        let below = if self.open_bounds & open_bounds::UPPER != 0 { value < self.upper } else { value <= self.upper };
        let listed = self.choices.count == 0 || self.choices().iter().any(|choice| choice.value == value);
        value.is_finite() && above && below && listed
    }
}

/// The last `size` parameters of the table may occur several times in PROPS.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct RepeatingGroup {
    /// Key in case files: an array of arrays of `size` numbers.
    pub name: Text,
    /// Parameters in one occurrence.
    pub size: u32,
    /// Least number of occurrences.
    pub minimum: u32,
    /// Index of the parameter that holds the number of occurrences, or −1 if NPROPS determines it.
    pub count_parameter: i32,
    /// Number of parameters, the last before the group, that were added to the law later: PROPS without them are
    /// accepted, and their defaults used. 0 unless occurrences are counted, since the count and NPROPS together
    /// determine it.
    pub added: u32,
}

impl RepeatingGroup {
    /// A group.
    pub const fn new(name: &'static CStr, size: u32, minimum: u32, count_parameter: i32) -> Self {
        Self { name: Text::new(name), size, minimum, count_parameter, added: 0 }
    }

    /// Returns the group of a law that got so many parameters later, the last before the group.
    pub const fn with_added(mut self, added: u32) -> Self {
        assert!(self.count_parameter >= 0, "the count of occurrences must determine which parameters are given");
        self.added = added;
        self
    }

    /// Returns how many of the `fixed` parameters before the group PROPS give: all of them, or all but those that were added.
    #[inline(always)]
    pub fn given(&self, props: &[f64], fixed: usize) -> usize {
        let count = usize::try_from(self.count_parameter).ok().and_then(|place| props.get(place));
        given(self.added as usize, self.size as usize, count, props.len(), fixed)
    }

    /// Returns whether so many of them may follow the other parameters.
    #[inline(always)]
    pub fn admits(&self, occurrences: usize, others: &[f64]) -> bool {
        let is_counted = self.count_parameter < 0 || others[self.count_parameter as usize] == occurrences as f64;
        is_counted & (occurrences >= self.minimum as usize)
    }
}

/// Returns how many of the `fixed` parameters before a group of `size` are given by PROPS of this `length`: the last `added` of
/// them may be missing, and `count` holds the number of occurrences.
#[inline(always)]
pub(crate) fn given(added: usize, size: usize, count: Option<&f64>, length: usize, fixed: usize) -> usize {
    let earlier = fixed - added;
    let is_earlier = added > 0 && count.is_some_and(|count| earlier as f64 + size as f64 * count == length as f64);
    if is_earlier { earlier } else { fixed }
}

/// One entry of STATEV.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct StateVariable {
    /// Column name in `history.csv`.
    pub name: Text,
    /// Unit, "-" if none.
    pub unit: Text,
    /// One sentence.
    pub doc: Text,
    /// 0: a scalar. 1…6: component 11, 22, 33, 12, 13, 23 of a strain-like tensor (engineering
    /// shear), the six in a row; the ABI boundary rotates it by DROT.
    pub tensor_component: u32,
    /// Unused, 0.
    pub reserved: u32,
}

impl StateVariable {
    /// A scalar.
    pub const fn new(name: &'static CStr, unit: &'static CStr, doc: &'static CStr) -> Self {
        Self { name: Text::new(name), unit: Text::new(unit), doc: Text::new(doc), tensor_component: 0, reserved: 0 }
    }

    /// Component 1…6 of a strain-like tensor.
    pub const fn strain_component(mut self, component: u32) -> Self {
        self.tensor_component = component;
        self
    }

    /// Returns the name.
    pub fn name(&self) -> &'static str {
        self.name.as_str()
    }
}

/// Functions that give a derived output from its state variable s.
pub mod derived_forms {
    /// s itself.
    pub const IDENTITY: u32 = 0;
    /// s/(1 + s): damage D from η.
    pub const DAMAGE_FROM_ETA: u32 = 1;
}

/// A quantity that hosts print in addition to the states.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct DerivedOutput {
    /// Column name.
    pub name: Text,
    /// Index in STATEV, from 0.
    pub state: u32,
    /// [`derived_forms`].
    pub form: u32,
}

impl DerivedOutput {
    /// D = η/(1 + η).
    pub const fn damage(name: &'static CStr, state: u32) -> Self {
        Self { name: Text::new(name), state, form: derived_forms::DAMAGE_FROM_ETA }
    }
}

/// Result of [`Plugin::validate`].
pub mod validation {
    /// Parameters are usable.
    pub const OK: i32 = 0;
    /// The parameters are not admitted; the message says why.
    pub const INVALID: i32 = 1;
    /// The parameters need a characteristic length > 0.
    pub const NEEDS_LENGTH: i32 = 2;
}

/// `validate(props, nprops, characteristic_length, message, capacity)` → [`validation`]; writes a
/// NUL-terminated UTF-8 message into `message` (capacity ≥ 512 bytes) unless OK.
/// `characteristic_length` ≤ 0 or NaN: none is known.
pub type Validate = unsafe extern "C" fn(
    props: *const f64,
    nprops: i32,
    characteristic_length: f64,
    message: *mut c_char,
    capacity: usize,
) -> i32;

/// Symbol of `UmatBatch`, the function that updates many points in one call, in libraries with one law for solids.
/// Under the unique name `<law>_umat_batch_v1` it is exported by these and by the library of all laws.
pub const BATCH_SYMBOL: &str = "pullout_umat_batch_v1";

/// Outcomes of the update of one point of a batch.
pub mod batch_results {
    /// Arrays hold the new values.
    pub const DONE: i32 = 0;
    /// The point needs a smaller increment; its arrays are as they were (if `status` is NULL, stress and tangent are NaN).
    pub const CUT_BACK: i32 = 1;
    /// Parameters, counts or characteristic length are wrong: STRESS and DDSDDE are NaN.
    pub const REFUSED: i32 = 2;
}

/// The description of one law in a library.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct Plugin {
    /// [`ABI_VERSION`].
    pub abi_version: u32,
    /// Bytes of this struct as the library knows it.
    pub struct_size: u32,
    /// Law name.
    pub law: Text,
    /// Version of the plugin.
    pub version: Text,
    /// One sentence.
    pub description: Text,
    /// [`kinds`].
    pub kinds: u32,
    /// [`stress_states`].
    pub stress_states: u32,
    /// [`flags`].
    pub flags: u32,
    /// 1 if `repeating` is meant.
    pub has_repeating: u32,
    /// PROPS.
    pub parameters: Table<Parameter>,
    /// A group of parameters at the end of PROPS.
    pub repeating: RepeatingGroup,
    /// STATEV.
    pub states: Table<StateVariable>,
    /// Derived outputs.
    pub derived: Table<DerivedOutput>,
    /// Checks parameters.
    pub validate: Validate,
    /// The next law of a library with several, or NULL.
    pub next: *const Plugin,
    /// Unused, NULL.
    pub reserved: *const c_void,
}

// SAFETY: every pointer refers to immutable static data.
unsafe impl Sync for Plugin {}
// SAFETY: as above.
unsafe impl Send for Plugin {}

impl Plugin {
    /// Returns this plugin with a following law, for libraries that hold several.
    pub const fn followed_by(mut self, next: &'static Plugin) -> Self {
        self.next = next;
        self
    }
}
