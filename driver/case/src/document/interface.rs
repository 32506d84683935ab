//! Kind "interface".

use super::{
    Compare, ContactArguments, Controls, Cycle, Cycles, EndValue, Increments, Material, Output, Piece, Positive,
    RunIncrements, Until,
};
use schemars::JsonSchema;
use serde::Deserialize;

/// A contact point along a path (kind "interface").
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct InterfaceCase {
    /// Address of this schema, for editors.
    #[serde(rename = "$schema")]
    #[expect(dead_code, reason = "read by editors")]
    pub schema: Option<Piece<String>>,
    /// "interface".
    #[expect(dead_code, reason = "dispatched on before")]
    pub kind: InterfaceKind,
    /// Title of plots and report; default: the file's stem.
    pub title: Option<Piece<String>>,
    /// Text for the report.
    pub description: Option<Piece<String>>,
    /// Files that its libraries read on their own: they travel with the case, and the run is another one if they change.
    #[expect(dead_code, reason = "read before the kinds differ")]
    pub files: Option<Piece<Vec<String>>>,
    /// The plugin and its parameters.
    pub material: Piece<Material>,
    /// The folder that GETOUTDIR answers, relative to the case file; default: the case file's. A replay names that of the
    /// case it comes from.
    #[expect(dead_code, reason = "read by `job_folder`")]
    pub job_folder: Option<Piece<String>>,
    /// CHRLNGTH, mm.
    pub characteristic_length: Option<Piece<Positive>>,
    /// The state before the first step.
    pub initial: Option<Piece<InterfaceInitial>>,
    /// Arguments of the plugin that the path leaves open; a replay of a recorded call gives them.
    pub arguments: Option<Piece<ContactArguments>>,
    /// Initial temperature (default 0), the same on both surfaces.
    pub temperature: Option<Piece<f64>>,
    /// Initial field variables.
    pub predef: Option<Piece<Vec<f64>>>,
    /// What is done to the point.
    #[schemars(length(min = 1))]
    pub steps: Piece<Vec<Piece<InterfaceStep>>>,
    /// Increments of another run that are repeated as they are, instead of those of the steps; no "until" ends a step or
    /// the run then.
    pub increments: Option<Piece<RunIncrements>>,
    /// Ends the run early.
    pub until: Option<Piece<Until>>,
    /// Curves to compare with.
    pub compare: Option<Piece<Vec<Piece<Compare>>>>,
    /// What is written.
    pub output: Option<Piece<Output>>,
    /// Iteration limits.
    pub controls: Option<Piece<Controls>>,
}

/// The word "interface".
#[derive(Clone, Copy, Debug, Deserialize, JsonSchema)]
#[serde(rename_all = "lowercase")]
pub enum InterfaceKind {
    /// A contact point.
    Interface,
}

/// The state before the first step.
#[derive(Clone, Debug, Default, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct InterfaceInitial {
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
pub enum InterfaceStep {
    /// The same in a member named "cycles".
    Cycles(Cycles<InterfaceStep>),
    /// Steps run several times.
    Cycle(Cycle<InterfaceStep>),
    /// One increment per row of a CSV file.
    Table(InterfaceTable),
    /// Linear ramps to end values.
    Ramp(InterfaceRamp),
}

/// A step in which slips, gap or pressure ramp linearly to their end values.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct InterfaceRamp {
    /// Number of increments.
    pub increments: Increments,
    /// Duration, s (default 1).
    pub time: Option<Positive>,
    /// End values; what is not named is held.
    pub target: InterfaceTarget,
    /// Ends this step early.
    pub until: Option<Until>,
    /// Temperature at the end of the step.
    pub temperature: Option<f64>,
    /// Field variables at the end of the step.
    pub predef: Option<Vec<f64>>,
}

/// A step with one increment per row of a CSV file.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct InterfaceTable {
    /// CSV file, relative to the case file: columns time (optional, s), slip, slip2 (mm), gap (mm) or p (MPa), temperature,
    /// and predef1, predef2, … of the case's field variables.
    pub table: String,
    /// Ends this step early.
    pub until: Option<Until>,
    /// Temperature at the end of the step.
    pub temperature: Option<f64>,
    /// Field variables at the end of the step.
    pub predef: Option<Vec<f64>>,
}

/// End values of a contact point, or "hold".
#[derive(Clone, Debug, Default, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct InterfaceTarget {
    /// Slip, mm.
    pub slip: Option<EndValue>,
    /// Slip in the second direction, mm.
    pub slip2: Option<EndValue>,
    /// Gap, mm, > 0 open (entry uinter only).
    pub gap: Option<EndValue>,
    /// Pressure, MPa, > 0 compression.
    pub p: Option<EndValue>,
}
