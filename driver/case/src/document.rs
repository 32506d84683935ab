//! The case file as serde reads it and as `pullout schema` prints it. Units: N, mm, MPa, s; shear strains are
//! engineering shear.
//!
//! Whatever its schema accepts, serde reads.

use pullout_run::program::{self, Caption};
use schemars::{JsonSchema, Schema, SchemaGenerator, json_schema};
use serde::de::Error;
use serde::{Deserialize, Deserializer};
use std::borrow::Cow;
use std::collections::BTreeMap;

pub use pullout_run::arguments::{ContactArguments, UmatArguments};
pub mod bridging;
mod with_defaults;
pub(crate) use with_defaults::WithDefaults;
mod point;
pub(crate) use point::*;
mod interface;
pub(crate) use interface::*;
pub mod pullout;
pub mod study;
pub mod sweep;
pub(crate) use pullout::PulloutCase;

/// Rows that drive a step: a file, or columns by name.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(untagged)]
pub(crate) enum TableSource {
    /// CSV file.
    File(String),
    /// Numbers of each column, as many in each.
    Columns(BTreeMap<String, Vec<f64>>),
}

/// A whole number between two bounds; `5.0` is one as well.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Whole<const LEAST: usize, const GREATEST: usize>(pub usize);

impl<'de, const LEAST: usize, const GREATEST: usize> Deserialize<'de> for Whole<LEAST, GREATEST> {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        let value = f64::deserialize(deserializer)?;
        if value.fract() == 0.0 && value >= LEAST as f64 && value <= GREATEST as f64 {
            return Ok(Self(value as usize));
        }
        Err(D::Error::custom(format!("{value} is not a whole number from {LEAST} to {GREATEST}")))
    }
}

impl<const LEAST: usize, const GREATEST: usize> From<Whole<LEAST, GREATEST>> for usize {
    fn from(number: Whole<LEAST, GREATEST>) -> Self {
        number.0
    }
}

impl<const LEAST: usize, const GREATEST: usize> JsonSchema for Whole<LEAST, GREATEST> {
    fn inline_schema() -> bool {
        true
    }
    fn schema_name() -> Cow<'static, str> {
        format!("WholeFrom{LEAST}To{GREATEST}").into()
    }
    fn json_schema(_: &mut SchemaGenerator) -> Schema {
        json_schema!({ "type": "integer", "minimum": LEAST, "maximum": GREATEST })
    }
}

/// Defines a number within bounds.
macro_rules! number {
    ($(#[$doc:meta])* $name:ident, $is_admitted:expr, $wrong:literal, $schema:tt) => {
        $(#[$doc])*
        #[derive(Clone, Copy, Debug, PartialEq)]
        pub struct $name(pub f64);

        impl<'de> Deserialize<'de> for $name {
            fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
                let value = f64::deserialize(deserializer)?;
                if $is_admitted(value) { Ok(Self(value)) } else { Err(D::Error::custom(format!($wrong, value))) }
            }
        }

        impl From<$name> for f64 {
            fn from(number: $name) -> Self {
                number.0
            }
        }

        impl JsonSchema for $name {
            fn inline_schema() -> bool {
                true
            }
            fn schema_name() -> Cow<'static, str> {
                stringify!($name).into()
            }
            fn json_schema(_: &mut SchemaGenerator) -> Schema {
                json_schema!($schema)
            }
        }
    };
}

number! {
    /// A number > 0.
    Positive, |value: f64| value > 0.0, "{} is not > 0", { "type": "number", "exclusiveMinimum": 0 }
}
number! {
    /// A number > 0 and ≤ 1.
    Fraction, |value: f64| value > 0.0 && value <= 1.0, "{} is not in (0, 1]",
    { "type": "number", "exclusiveMinimum": 0, "maximum": 1 }
}

/// Entries common to files of all kinds.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
pub struct CommonEntries {
    /// Address of this schema, for editors.
    #[serde(rename = "$schema")]
    pub schema: Option<String>,
    /// Title of plots and report; default: the file's stem.
    pub title: Option<String>,
    /// Text for the report.
    pub description: Option<String>,
}

/// Entries common to cases of all kinds.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
pub(crate) struct CommonCaseEntries {
    /// Title and text.
    #[serde(flatten)]
    pub head: CommonEntries,
    /// Files that the libraries of the case read on their own. They are copied with the case, and a change in them
    /// makes it a different run.
    #[expect(dead_code, reason = "read before the kinds differ")]
    pub files: Option<Vec<String>>,
    /// Measured curves to compare the run with. In a case of kind bridging, x and y are two columns of bridging.csv or
    /// two of beam.csv.
    pub compare: Option<Vec<Compare>>,
}

/// Entries of cases with steps that hold for all their steps.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
pub(crate) struct Course {
    /// Initial temperature, everywhere except in parts with a field (default 0).
    pub temperature: Option<f64>,
    /// Initial field variables, everywhere.
    pub predef: Option<Vec<f64>>,
    /// Recorded increments of another run, repeated exactly in place of those of the steps. "until" then has no effect.
    pub increments: Option<RunIncrements>,
    /// Condition that ends the run early.
    pub until: Option<Until>,
}

/// Entries common to material points and contact points; `S`: a step.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
pub(crate) struct Path<S> {
    /// The plugin and its parameters.
    pub material: Material,
    /// Folder that GETOUTDIR returns, relative to the case file; default: the folder of the case file. A replay names
    /// the folder of its original case.
    #[expect(dead_code, reason = "read by `job_folder`")]
    pub job_folder: Option<String>,
    /// Characteristic length, mm: CELENT of a material point, CHRLNGTH of a contact point. Required if the law's crack
    /// band is on.
    pub characteristic_length: Option<Positive>,
    /// Loading steps, in order.
    #[schemars(length(min = 1))]
    pub steps: Vec<S>,
    /// Settings of the output.
    pub output: Option<Output>,
    /// Iteration limits.
    pub controls: Option<WithDefaults<program::IterationLimits>>,
}

/// Conditions at the end of a step of any kind.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
pub(crate) struct StepEnd {
    /// Condition that ends this step early.
    pub until: Option<Until>,
    /// Temperature at the end of the step.
    pub temperature: Option<f64>,
    /// Field variables at the end of the step.
    pub predef: Option<Vec<f64>>,
}

/// Most increments of one step, and of a run.
pub const MOST_INCREMENTS: usize = 100_000_000;
/// Number of increments of a step.
pub(crate) type Increments = Whole<1, MOST_INCREMENTS>;
/// Number of repetitions.
pub(crate) type Repetitions = Whole<1, 1_000_000>;

/// A deformation gradient, row by row.
pub(crate) type Matrix = [[f64; 3]; 3];

/// Values along the local axes 1, 2 and 3: one for all, or one each.
#[derive(Clone, Copy, Debug, Deserialize, JsonSchema)]
#[serde(untagged)]
pub(crate) enum AxialValues {
    /// The same along all.
    Same(f64),
    /// Of each axis.
    Each([f64; 3]),
}

/// Values, or one for each place of a table.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(untagged)]
pub(crate) enum TabularValues {
    /// The same everywhere.
    Constant(f64),
    /// Along each axis, or of each place.
    List(Vec<AxialValues>),
}

/// Thermal expansion: the coefficients alone, or with what they refer to.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(untagged)]
pub(crate) enum Expansion {
    /// The coefficient, 1/K, or three, along the local axes.
    Coefficients(AxialValues),
    /// Coefficients and temperatures.
    Table(ExpansionTable),
}

/// Thermal strain alpha(T) (T - T0) - alpha(Ti) (Ti - T0), as ABAQUS has it.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(crate) struct ExpansionTable {
    /// Secant coefficient, 1/K: a number, three of the local axes, or a list of either, one for each of the temperatures.
    pub alpha: TabularValues,
    /// Temperatures of the coefficients, growing; linear between them, constant beyond.
    pub temperatures: Option<Vec<f64>>,
    /// T0, to which the coefficients refer (default 0).
    pub zero_temperature: Option<f64>,
    /// Ti, at which there is no thermal strain. Default: the temperature at the start, in parts with a temperature field its
    /// initial value, elsewhere that of the case.
    pub initial_temperature: Option<f64>,
}

/// A strain over the total time.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(crate) struct Shrinkage {
    /// Total times, s, growing; linear between them, constant beyond.
    pub times: Vec<f64>,
    /// Free strain at each, negative where the material shrinks: a number, or three of the local axes.
    pub strain: Vec<AxialValues>,
}

/// Local axes.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(untagged)]
pub(crate) enum Orientation {
    /// Degrees about axis 3.
    Angle(f64),
    /// Two vectors of two or three components.
    Vectors([Vec<f64>; 2]),
}

/// The plugin and its parameters.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(crate) struct Material {
    /// Name of a shipped law, or path of a shared library (.so, .dylib, .dll) relative to the case file.
    #[schemars(length(min = 1))]
    pub plugin: String,
    /// Parameters by name (laws with metadata; missing ones take their defaults), or an array in PROPS order.
    pub props: Option<Props>,
    /// Concrete by its class ("C40", "C40/50") or its mean compressive strength, MPa. It gives the parameters that `props`
    /// leaves out, by the fib Model Code 2010, to laws with the parameter f_t or those of concrete_damage.
    pub concrete: Option<ConcreteStrength>,
    /// Number of state variables; required for a library without metadata.
    pub nstatv: Option<Whole<0, 100_000>>,
    /// Initial state variables of every point; in a case of kind point the same as initial.statev. Default: the values
    /// set by the library's SDVINI, or zeros.
    pub statev0: Option<Vec<f64>>,
    /// Thermal expansion, for a law without its own. The thermal strain is subtracted from the strains that the law
    /// gets.
    pub expansion: Option<Expansion>,
    /// Stress-free strain as a function of total time, independent of temperature, such as drying shrinkage. It is
    /// subtracted from the strains that the law gets.
    pub shrinkage: Option<Shrinkage>,
    /// Local axes of the material: a rotation about axis 3 in degrees, positive from axis 1 to 2; or two vectors, the
    /// first along local axis 1, the second in the local 1-2 plane. The law gets stress and strain in local axes;
    /// results are in the axes of the case.
    pub orientation: Option<Orientation>,
    /// Symbol of the entry point, if it does not have one of the usual names. The library then runs in a separate
    /// process.
    #[schemars(length(min = 1))]
    pub symbol: Option<String>,
    /// CMNAME or CINAME passed to the plugin; default: the law's name in upper case. In a library of several laws it
    /// selects the law: the one with the longest name that it starts with.
    #[schemars(length(min = 1, max = 80))]
    pub cmname: Option<String>,
    /// Entry point: umat for kind point and for parts; uinter (default) or fric for kind interface and for contact.
    pub entry: Option<EntryPoint>,
    /// Run the case in a separate process, so that a plugin that stops, crashes or hangs is reported. Default: true,
    /// unless all plugins were built with pullout. The value false needs --in-process.
    pub isolate: Option<bool>,
    /// Components passed to a UMAT in plane modes: "3d" calls it with NTENS 6 (in plane stress, pullout finds e33),
    /// "plane" with NTENS 4 or 3. Default: what the law needs; for a library without metadata, trial calls at a virgin
    /// point decide.
    #[serde(rename = "as")]
    pub components: Option<CalledAs>,
    /// Source of the tangent DDSDDE (default reported). In parts of a specimen, pullout changes to numerical once the
    /// iterations show that the reported tangent is not the derivative of the stress.
    pub tangent: Option<Tangent>,
    /// Allow several threads to call a library without metadata at once.
    pub thread_safe: Option<bool>,
    /// Longest time of one call of an isolated plugin, s (default 60).
    pub call_time_limit_s: Option<Positive>,
}

/// Concrete by its strength.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(untagged)]
pub(crate) enum ConcreteStrength {
    /// The class of the fib Model Code: "C40", "C40/50".
    Class(String),
    /// The mean compressive strength of cylinders, MPa.
    Mean(Positive),
}

/// Components that a UMAT is called with in a plane.
#[derive(Clone, Copy, Debug, Deserialize, JsonSchema, PartialEq, Eq)]
#[serde(rename_all = "lowercase")]
pub(crate) enum CalledAs {
    /// NTENS 6.
    #[serde(rename = "3d")]
    ThreeD,
    /// NTENS 4, in plane stress 3.
    Plane,
}

/// Source of the tangent DDSDDE.
#[derive(Clone, Copy, Debug, Deserialize, JsonSchema, PartialEq, Eq)]
#[serde(rename_all = "lowercase")]
pub(crate) enum Tangent {
    /// The UMAT.
    Reported,
    /// Differences of its stress.
    Numerical,
    /// The UMAT, compared with differences; the largest deviation is reported.
    Compare,
}

/// Entry point that is called.
#[derive(Clone, Copy, Debug, Deserialize, JsonSchema, PartialEq, Eq)]
#[serde(rename_all = "lowercase")]
pub(crate) enum EntryPoint {
    /// A material point.
    Umat,
    /// A contact point, normal and tangential.
    Uinter,
    /// A contact point, tangential only.
    Fric,
}

/// Parameters by name, or PROPS as an array.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(untagged)]
pub(crate) enum Props {
    /// By name.
    Named(BTreeMap<String, PropValue>),
    /// In PROPS order.
    List(Vec<f64>),
}

/// A parameter's number, the name of a choice, or the occurrences of a repeating group.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(untagged)]
pub(crate) enum PropValue {
    /// Number.
    Number(f64),
    /// Name of a choice.
    Choice(String),
    /// Occurrences of a repeating group.
    Occurrences(Vec<Occurrence>),
}

/// One occurrence of a repeating group: its values in order or by name.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(untagged)]
pub(crate) enum Occurrence {
    /// Values in order.
    Values(Vec<f64>),
    /// Values by name.
    Named(BTreeMap<String, f64>),
    /// The value of a group of one parameter.
    Single(f64),
}

/// Ends a step or the run when a history column passes a bound.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(crate) struct Until {
    /// NAME or abs(NAME) of a history column.
    pub quantity: String,
    /// Stop when the quantity is greater than this (in the column's unit).
    pub greater_than: Option<f64>,
    /// Stop when the quantity is less than this (in the column's unit).
    pub less_than: Option<f64>,
}

/// A curve from a CSV file to compare with.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(crate) struct Compare {
    /// CSV file with a header line, relative to the case file; lines that begin with # are comments.
    pub file: String,
    /// Name of the file's column of abscissae.
    pub file_x: String,
    /// Name of the file's column of ordinates.
    pub file_y: String,
    /// History column to compare file_x with.
    pub x: String,
    /// History column to compare file_y with.
    pub y: String,
    /// Factor on the file's abscissae (default 1).
    pub scale_x: Option<f64>,
    /// Factor on the file's ordinates (default 1).
    pub scale_y: Option<f64>,
    /// Label of the curve; default: the file's stem.
    pub label: Option<String>,
}

/// Whether there are plots, or their words.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(untagged)]
pub(crate) enum Plots {
    /// All, or none.
    Switch(bool),
    /// All, some of them with captions, by the names of their files: "load_slip".
    Captions(BTreeMap<String, Caption>),
}

impl Plots {
    /// Returns whether plots are drawn (by default they are), and the words of some.
    pub fn of(given: Option<&Self>) -> (bool, BTreeMap<String, Caption>) {
        match given {
            Some(Self::Switch(is_drawn)) => (*is_drawn, BTreeMap::new()),
            Some(Self::Captions(all)) => (true, all.clone()),
            None => (true, BTreeMap::new()),
        }
    }
}

/// Settings of the output.
#[derive(Clone, Debug, Default, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(crate) struct Output {
    /// Write every n-th increment, and the last of each step, to history.csv (default 1).
    pub every: Option<Whole<1, MOST_INCREMENTS>>,
    /// Draw plots and the report (default true), or draw them with these titles and legends.
    pub plots: Option<Plots>,
    /// Write VTU files (kinds with a mesh only).
    pub vtu: Option<bool>,
    /// Add columns with the thermal terms that UMAT returns: RPL, DDSDDT, DRPLDE and DRPLDT (points only, default
    /// false).
    pub heat: Option<bool>,
}

/// Recorded increments to repeat.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(crate) struct RunIncrements {
    /// The increments.json that --record-increments wrote: its path, relative to the case file, or its content.
    pub recorded: serde_json::Value,
}

/// The value of a component at the end of a step, or "hold".
#[derive(Clone, Copy, Debug, Deserialize, JsonSchema)]
#[serde(untagged)]
pub(crate) enum EndValue {
    /// The end value.
    Value(f64),
    /// The value at the start of the step.
    Hold(Hold),
}

/// The word "hold".
#[derive(Clone, Copy, Debug, Deserialize, JsonSchema)]
#[serde(rename_all = "lowercase")]
pub(crate) enum Hold {
    /// Keep the value.
    Hold,
}

/// Steps that are run several times.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
#[schemars(rename = "CycleOf{S}")]
pub(crate) struct Cycle<S> {
    /// Number of repetitions.
    pub repeat: Repetitions,
    /// The steps of one cycle.
    #[schemars(length(min = 1))]
    pub steps: Vec<S>,
}

/// Steps that are run several times, in a member named "cycles".
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
#[schemars(rename = "CyclesOf{S}")]
pub(crate) struct Cycles<S> {
    /// The cycle.
    pub cycles: Cycle<S>,
}
