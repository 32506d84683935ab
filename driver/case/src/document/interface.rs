//! Kind "interface".

use super::{
    CommonCaseEntries, ContactArguments, Course, Cycle, Cycles, EndValue, Increments, Path, Positive, StepEnd,
    TableSource,
};
use schemars::JsonSchema;
use serde::Deserialize;

/// A contact point along a path (kind "interface").
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[schemars(deny_unknown_fields)]
pub(crate) struct InterfaceCase {
    /// "interface".
    #[expect(dead_code, reason = "dispatched on before")]
    #[schemars(extend("const" = "interface"))]
    pub kind: String,
    /// Title, text, files, curves.
    #[serde(flatten)]
    pub head: CommonCaseEntries,
    /// Plugin, steps, output.
    #[serde(flatten)]
    pub path: Path<InterfaceStep>,
    /// The state before the first step.
    pub initial: Option<InterfaceInitial>,
    /// Plugin arguments that the path does not determine. The replay of a recorded call sets them.
    pub arguments: Option<ContactArguments>,
    /// Fields, and how the run ends.
    #[serde(flatten)]
    pub course: Course,
}

/// The state before the first step.
#[derive(Clone, Debug, Default, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(crate) struct InterfaceInitial {
    /// State variables, NSTATV values.
    pub statev: Option<Vec<f64>>,
    /// Total time, s.
    #[schemars(range(min = 0.0))]
    pub time: Option<f64>,
    /// Slip, mm.
    pub slip: Option<f64>,
    /// Slip in the second direction, mm.
    pub slip2: Option<f64>,
    /// Gap, mm, > 0 open.
    pub gap: Option<f64>,
}

/// A step: a ramp, a table, or a cycle of steps.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(untagged)]
pub(crate) enum InterfaceStep {
    /// Steps run several times, in a member named "cycles".
    Cycles(Cycles<InterfaceStep>),
    /// Steps run several times.
    Cycle(Cycle<InterfaceStep>),
    /// One increment per row of a table.
    Table(InterfaceTable),
    /// Linear ramps to end values.
    Ramp(InterfaceRamp),
}

/// A step in which slips, gap or pressure ramp linearly to their end values.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[schemars(deny_unknown_fields)]
pub(crate) struct InterfaceRamp {
    /// Number of increments.
    pub increments: Increments,
    /// Duration, s (default 1).
    pub time: Option<Positive>,
    /// End values. Components that are not named are held.
    pub target: InterfaceTarget,
    /// Conditions that end it early, and fields at its end.
    #[serde(flatten)]
    pub end: StepEnd,
}

/// A step with one increment per row of a table.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[schemars(deny_unknown_fields)]
pub(crate) struct InterfaceTable {
    /// CSV file, relative to the case file, or its columns: time (optional, s), slip, slip2 (mm), gap (mm) or p (MPa),
    /// temperature, and predef1, predef2, … for the field variables of the case.
    pub table: TableSource,
    /// Conditions that end it early, and fields at its end.
    #[serde(flatten)]
    pub end: StepEnd,
}

/// End values of a contact point, or "hold".
#[derive(Clone, Debug, Default, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(crate) struct InterfaceTarget {
    /// Slip, mm.
    pub slip: Option<EndValue>,
    /// Slip in the second direction, mm.
    pub slip2: Option<EndValue>,
    /// Gap, mm, > 0 open (entry uinter only).
    pub gap: Option<EndValue>,
    /// Pressure, MPa, > 0 compression.
    pub p: Option<EndValue>,
}
