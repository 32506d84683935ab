//! A plugin's metadata, read out of its library into owned, checked Rust values.

use crate::metadata::{self, ABI_VERSION, Plugin, Table, Text, derived_forms, open_bounds, validation};
use std::ffi::{CStr, c_char};
use std::mem::offset_of;
use std::sync::Arc;

/// A law in a library, as its metadata describes it.
#[derive(Clone, Debug)]
pub struct LawDescription {
    /// The law's name.
    pub name: String,
    /// The plugin's version.
    pub version: String,
    /// One sentence.
    pub description: String,
    /// [`metadata::kinds`].
    pub kinds: u32,
    /// [`metadata::stress_states`].
    pub stress_states: u32,
    /// [`metadata::flags`].
    pub flags: u32,
    /// PROPS; the last [`ParameterGroup::size`] of them may repeat.
    pub parameters: Vec<Parameter>,
    /// The repeating group.
    pub group: Option<ParameterGroup>,
    /// STATEV.
    pub states: Vec<StateDescription>,
    /// Quantities that follow from states.
    pub derived: Vec<Derived>,
    validate: metadata::Validate,
    /// Keeps the code of `validate` loaded.
    _library: Arc<libloading::Library>,
}

/// One entry of PROPS.
#[derive(Clone, Debug)]
pub struct Parameter {
    /// Name in case files.
    pub name: String,
    /// Unit.
    pub unit: String,
    /// One sentence.
    pub doc: String,
    /// Quantity that the host may fill in when the value is 0.
    pub role: String,
    /// Default.
    pub default_value: f64,
    /// Least value.
    pub lower: f64,
    /// Greatest value.
    pub upper: f64,
    /// The least value itself is excluded.
    pub lower_open: bool,
    /// The greatest value itself is excluded.
    pub upper_open: bool,
    /// Named values.
    pub choices: Vec<Choice>,
    /// The least and the greatest usual value, if the law gives them.
    pub typical: Option<[f64; 2]>,
}

impl Parameter {
    /// Returns the bounds as text, e.g. `> 0`, `in (-1, 0.5)`; empty if there are none.
    pub fn bounds(&self) -> String {
        let (lower, upper) = (self.lower, self.upper);
        let (open, close) = (if self.lower_open { '(' } else { '[' }, if self.upper_open { ')' } else { ']' });
        match (lower.is_finite(), upper.is_finite()) {
            _ if !self.choices.is_empty() => {
                let names: Vec<_> = self.choices.iter().map(|c| format!("{} = {}", c.value, c.name)).collect();
                names.join(", ")
            }
            (true, true) => format!("in {open}{lower}, {upper}{close}"),
            (true, false) => format!("{} {lower}", if self.lower_open { ">" } else { ">=" }),
            (false, true) => format!("{} {upper}", if self.upper_open { "<" } else { "<=" }),
            (false, false) => String::new(),
        }
    }

    /// The usual range that a value is outside of. The default is usual, and 0, which is so in all units.
    pub fn missed_range(&self, value: f64) -> Option<[f64; 2]> {
        let is_usual = value == 0.0 || value == self.default_value;
        self.typical.filter(|[lower, upper]| !is_usual && !(*lower..=*upper).contains(&value))
    }

    /// Returns whether a value is finite, within the bounds, and listed if there are choices.
    pub fn admits(&self, value: f64) -> bool {
        let above = if self.lower_open { value > self.lower } else { value >= self.lower };
        let below = if self.upper_open { value < self.upper } else { value <= self.upper };
        let listed = self.choices.is_empty() || self.choices.iter().any(|choice| choice.value == value);
        value.is_finite() && above && below && listed
    }
}

/// A named value of a selecting parameter.
#[derive(Clone, Debug)]
pub struct Choice {
    /// The number in PROPS.
    pub value: f64,
    /// Name.
    pub name: String,
}

/// The repeating group at the end of PROPS.
#[derive(Clone, Debug)]
pub struct ParameterGroup {
    /// Key in case files.
    pub name: String,
    /// Parameters per occurrence.
    pub size: usize,
    /// Least number of occurrences.
    pub minimum: usize,
    /// Index of the parameter that holds the number of occurrences.
    pub count_parameter: Option<usize>,
    /// Number of parameters, the last before the group, that were added to the law later: PROPS may lack them.
    pub added: usize,
}

/// One entry of STATEV.
#[derive(Clone, Debug)]
pub struct StateDescription {
    /// Column name.
    pub name: String,
    /// Unit.
    pub unit: String,
    /// One sentence.
    pub doc: String,
    /// 1…6: component of a strain-like tensor; 0: scalar.
    pub tensor_component: u32,
}

/// A derived output.
#[derive(Clone, Debug)]
pub struct Derived {
    /// Column name.
    pub name: String,
    /// Index of its state.
    pub state: usize,
    form: u32,
}

impl Derived {
    /// Returns the value.
    #[inline]
    pub fn value(&self, states: &[f64]) -> f64 {
        let state = states[self.state];
        if self.form == derived_forms::DAMAGE_FROM_ETA { state / (1.0 + state) } else { state }
    }
}

/// A law's verdict on its parameters.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Validation {
    /// Usable.
    Valid,
    /// Parameters that the law refuses, and why.
    Invalid(String),
    /// A characteristic length is needed, and none was given.
    NeedsCharacteristicLength(String),
}

impl LawDescription {
    /// Returns whether a flag of [`metadata::flags`] is set.
    pub fn has(&self, flag: u32) -> bool {
        self.flags & flag != 0
    }

    /// Names of its entry points: those of `umat`, `uinter`, `fric` that it has.
    pub fn entry_points(&self) -> Vec<&'static str> {
        let named =
            [(metadata::kinds::UMAT, "umat"), (metadata::kinds::UINTER, "uinter"), (metadata::kinds::FRIC, "fric")];
        named.into_iter().filter(|(kind, _)| self.kinds & kind != 0).map(|(_, name)| name).collect()
    }

    /// Position in STATEV of the state of this name, if the law has it.
    pub fn state_index(&self, name: &CStr) -> Option<usize> {
        self.states.iter().position(|state| state.name.as_bytes() == name.to_bytes())
    }

    /// The law of a library that CMNAME chooses: whose name it begins with, the longest of several; upper and lower case are alike.
    pub fn named<'l>(laws: &'l [Self], cmname: &str) -> Option<&'l Self> {
        let wanted = cmname.trim().to_lowercase();
        laws.iter().filter(|law| wanted.starts_with(&law.name.to_lowercase())).max_by_key(|law| law.name.len())
    }

    /// PROPS with the defaults of the parameters that the law got later, where they are not given.
    pub fn completed(&self, props: &[f64]) -> Vec<f64> {
        let Some(group) = &self.group else { return props.to_vec() };
        let fixed = self.parameters.len() - group.size;
        let count = group.count_parameter.and_then(|place| props.get(place));
        let given = metadata::given(group.added, group.size, count, props.len(), fixed);
        let added = self.parameters[given..fixed].iter().map(|parameter| parameter.default_value);
        let (before, after) = props.split_at(given.min(props.len()));
        let added: Vec<f64> = if before.len() == given { added.collect() } else { Vec::new() };
        [before, &added, after].concat()
    }

    /// Position in PROPS of the parameter with this role, if the law has one.
    pub fn role(&self, role: &str) -> Option<usize> {
        self.parameters.iter().position(|parameter| parameter.role == role)
    }

    /// PROPS with the penalties that their zeros leave to the host. A tangential one only where the law refuses its zero: others
    /// derive it from their own stiffness.
    pub fn with_penalties(&self, props: &[f64], normal: Option<f64>, tangential: f64) -> Vec<f64> {
        let mut filled = props.to_vec();
        let zero = |role: &str| self.role(role).filter(|k| props.get(*k) == Some(&0.0));
        if let (Some(k), Some(penalty)) = (zero("normal_penalty"), normal) {
            filled[k] = penalty;
        }
        let is_refused = |props: &[f64]| matches!(self.validate(props, None), Validation::Invalid(_));
        if let Some(k) = zero("tangential_penalty").filter(|_| is_refused(&filled)) {
            filled[k] = tangential;
            if is_refused(&filled) {
                // it was not the zero
                filled[k] = 0.0;
            }
        }
        filled
    }

    /// Asks the law itself about PROPS and, if known, the characteristic length.
    pub fn validate(&self, props: &[f64], characteristic_length: Option<f64>) -> Validation {
        let mut message = [0_u8; 1024];
        let count = i32::try_from(props.len()).unwrap_or(i32::MAX);
        let length = characteristic_length.unwrap_or(0.0);
        // SAFETY: the function comes from metadata of the right ABI version; the buffers have the given sizes.
        let status = unsafe {
            (self.validate)(props.as_ptr(), count, length, message.as_mut_ptr().cast::<c_char>(), message.len())
        };
        let text = || {
            CStr::from_bytes_until_nul(&message)
                .map_or_else(|_| String::new(), |text| printable(&text.to_string_lossy()))
        };
        match status {
            validation::OK => Validation::Valid,
            validation::NEEDS_LENGTH => Validation::NeedsCharacteristicLength(text()),
            _ => Validation::Invalid(text()),
        }
    }

    /// Reads a description and those that follow it.
    ///
    /// # Errors
    /// A sentence that describes the fault.
    ///
    /// # Safety
    /// `plugin` is what `pullout_plugin_v1` of this library returned.
    pub(super) unsafe fn read_all(
        mut plugin: *const Plugin,
        library: &Arc<libloading::Library>,
    ) -> Result<Vec<Self>, String> {
        const MOST_LAWS: usize = 256;
        let mut laws = Vec::new();
        while !plugin.is_null() {
            if laws.len() == MOST_LAWS {
                return Err(format!("the library's metadata lists more than {MOST_LAWS} laws"));
            }
            // SAFETY: the first two fields exist in every version of the struct.
            let (version, size) = unsafe { ((*plugin).abi_version, (*plugin).struct_size) };
            if version != ABI_VERSION || (size as usize) < size_of::<Plugin>() {
                return Err(format!(
                    "the library's metadata has ABI version {version} ({size} bytes); this program reads version \
                     {ABI_VERSION} ({} bytes)",
                    size_of::<Plugin>()
                ));
            }
            // SAFETY: version and size fit.
            let plugin_reference = unsafe { &*plugin };
            // SAFETY: as above.
            let law = unsafe { Self::read(plugin_reference, library) }?;
            law.check_consistency()?;
            laws.push(law);
            plugin = plugin_reference.next;
        }
        Ok(laws)
    }

    unsafe fn read(plugin: &Plugin, library: &Arc<libloading::Library>) -> Result<Self, String> {
        // SAFETY: texts and tables of a description of the right version are static, NUL-terminated or NULL, and
        // `count` elements long; NULL is checked.
        unsafe {
            Ok(Self {
                name: text(plugin.law)?,
                version: text(plugin.version)?,
                description: text(plugin.description)?,
                kinds: plugin.kinds,
                stress_states: plugin.stress_states,
                flags: plugin.flags,
                parameters: read_parameters(&plugin.parameters)?,
                group: if plugin.has_repeating == 0 { None } else { Some(read_group(&plugin.repeating)?) },
                states: read_table(&plugin.states, |s: &metadata::StateVariable| {
                    Ok(StateDescription {
                        name: text(s.name)?,
                        unit: text(s.unit)?,
                        doc: text(s.doc)?,
                        tensor_component: s.tensor_component,
                    })
                })?,
                derived: read_table(&plugin.derived, |d: &metadata::DerivedOutput| {
                    Ok(Derived { name: text(d.name)?, state: d.state as usize, form: d.form })
                })?,
                validate: plugin.validate,
                _library: Arc::clone(library),
            })
        }
    }

    /// A description from a foreign hand may contradict itself.
    fn check_consistency(&self) -> Result<(), String> {
        let wrong = |what: &str| Err(format!("the metadata of law '{}' is inconsistent: {what}", self.name));
        if self.derived.iter().any(|derived| derived.state >= self.states.len()) {
            return wrong("a derived output refers to a state variable that does not exist");
        }
        if let Some(group) = &self.group {
            let always_given = self.parameters.len().checked_sub(group.size + group.added);
            let fits = group.size > 0
                && always_given.is_some_and(|given| group.count_parameter.is_none_or(|k| k < given))
                && (group.added == 0 || group.count_parameter.is_some());
            if !fits {
                return wrong("the repeating group does not fit the parameters");
            }
        }
        Ok(())
    }
}

/// Reads the table of parameters. The elements of older libraries end before `typical_lower`: they name no usual values.
///
/// # Safety
/// As for `LawDescription::read`.
unsafe fn read_parameters(table: &Table<metadata::Parameter>) -> Result<Vec<Parameter>, String> {
    const FIRST_SIZE: usize = offset_of!(metadata::Parameter, typical_lower);
    // SAFETY: the elements have `stride` bytes, and `whole` has at least as many as are copied.
    unsafe {
        read_elements(table, FIRST_SIZE, |element| {
            let mut whole = metadata::Parameter::new(c"", c"", 0.0, c"");
            let known = size_of::<metadata::Parameter>().min(table.stride as usize);
            std::ptr::copy_nonoverlapping(element.cast::<u8>(), (&raw mut whole).cast::<u8>(), known);
            read_parameter(&whole)
        })
    }
}

unsafe fn read_parameter(p: &metadata::Parameter) -> Result<Parameter, String> {
    // SAFETY: as for `LawDescription::read`.
    unsafe {
        Ok(Parameter {
            name: text(p.name)?,
            unit: text(p.unit)?,
            doc: text(p.doc)?,
            role: text(p.role)?,
            default_value: p.default_value,
            lower: p.lower,
            upper: p.upper,
            lower_open: p.open_bounds & open_bounds::LOWER != 0,
            upper_open: p.open_bounds & open_bounds::UPPER != 0,
            choices: read_table(&p.choices, |c: &metadata::Choice| Ok(Choice { value: c.value, name: text(c.name)? }))?,
            typical: (p.typical_lower < p.typical_upper).then_some([p.typical_lower, p.typical_upper]),
        })
    }
}

unsafe fn read_group(group: &metadata::RepeatingGroup) -> Result<ParameterGroup, String> {
    Ok(ParameterGroup {
        // SAFETY: as for `LawDescription::read`.
        name: unsafe { text(group.name) }?,
        size: group.size as usize,
        minimum: group.minimum as usize,
        count_parameter: usize::try_from(group.count_parameter).ok(),
        added: group.added as usize,
    })
}

/// # Safety
/// The table's elements are `count` values, `stride` bytes apart.
unsafe fn read_table<T, R>(table: &Table<T>, read: impl Fn(&T) -> Result<R, String>) -> Result<Vec<R>, String> {
    // SAFETY: elements of the whole size, as the caller says.
    unsafe { read_elements(table, size_of::<T>(), |element| read(&*element)) }
}

/// Reads elements of at least `least` bytes.
///
/// # Safety
/// As for `read_table`.
unsafe fn read_elements<T, R>(
    table: &Table<T>,
    least: usize,
    read: impl Fn(*const T) -> Result<R, String>,
) -> Result<Vec<R>, String> {
    const MOST_ELEMENTS: u32 = 10_000;
    if table.count == 0 {
        return Ok(Vec::new());
    }
    if table.first.is_null() || table.count > MOST_ELEMENTS || (table.stride as usize) < least {
        return Err("a table of the metadata has no address, too many elements, or too small elements".into());
    }
    // SAFETY: k < count, and elements are `stride` bytes apart.
    let element = |k: usize| unsafe { table.first.byte_add(k * table.stride as usize) };
    (0..table.count as usize).map(|k| read(element(k))).collect()
}

/// A plugin's text without control characters: it is shown on terminals, in tables and in pictures. A line break is a blank.
fn printable(text: &str) -> String {
    let shown = |c: char| match c {
        '\n' | '\r' | '\t' => ' ',
        c if c.is_control() => char::REPLACEMENT_CHARACTER,
        c => c,
    };
    text.chars().map(shown).collect()
}

/// # Safety
/// NULL or a NUL-terminated string.
unsafe fn text(text: Text) -> Result<String, String> {
    if text.as_ptr().is_null() {
        return Err("a text of the metadata is NULL".into());
    }
    // SAFETY: not NULL; NUL-terminated by the contract.
    Ok(printable(&unsafe { CStr::from_ptr(text.as_ptr()) }.to_string_lossy()))
}

#[cfg(test)]
mod test;
