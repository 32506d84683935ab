//! Kind "point".

use super::{
    CommonCaseEntries, Course, Cycle, Cycles, EndValue, Increments, Matrix, Path, Positive, StepEnd, TableSource,
    UmatArguments,
};
use pullout_run::program::{Measure, Mode};
use schemars::JsonSchema;
use serde::Deserialize;
use std::collections::BTreeMap;

/// A material point along a path (kind "point").
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[schemars(deny_unknown_fields)]
pub(crate) struct PointCase {
    /// "point".
    #[expect(dead_code, reason = "dispatched on before")]
    #[schemars(extend("const" = "point"))]
    pub kind: String,
    /// Title, text, files, curves.
    #[serde(flatten)]
    pub head: CommonCaseEntries,
    /// Plugin, steps, output.
    #[serde(flatten)]
    pub path: Path<PointStep>,
    /// Stress state: the components that exist (default "3d").
    pub mode: Option<Mode>,
    /// Finite strain (default false). Strains are those of U in F = R U; a step with strain or stress targets keeps R.
    /// UMAT gets DFGRD0, DFGRD1 and DROT, and STRAN and STRESS rotated by DROT.
    pub nlgeom: Option<bool>,
    /// Strain and stress measure of steps and history with nlgeom (default "logarithmic").
    pub measure: Option<Measure>,
    /// The state before the first step.
    pub initial: Option<PointInitial>,
    /// UMAT arguments that the path does not determine. The replay of a recorded call sets them.
    pub arguments: Option<UmatArguments>,
    /// Fields, and how the run ends.
    #[serde(flatten)]
    pub course: Course,
}

/// The state before the first step, as UMAT is given it.
#[derive(Clone, Debug, Default, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(crate) struct PointInitial {
    /// STRAN: six values 11, 22, 33, 12, 13, 23 (or those of the mode), or by name (e11, g12, …); with nlgeom the
    /// logarithmic strain, default that of F.
    pub strain: Option<Components>,
    /// STRESS, MPa (with nlgeom Cauchy's): six values 11, 22, 33, 12, 13, 23 (or those of the mode), or by name (s11, …).
    pub stress: Option<Components>,
    /// State variables, NSTATV values.
    pub statev: Option<Vec<f64>>,
    /// Total time, s.
    #[schemars(range(min = 0.0))]
    pub time: Option<f64>,
    /// Deformation gradient, row by row (needs nlgeom); default: the stretch whose logarithm is the strain.
    #[serde(rename = "F")]
    pub deformation_gradient: Option<Matrix>,
}

/// Components in order or by name.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(untagged)]
pub(crate) enum Components {
    /// In order.
    List(Vec<f64>),
    /// By name.
    Named(BTreeMap<String, f64>),
}

/// A step: a ramp, a table, or a cycle of steps.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(untagged)]
pub(crate) enum PointStep {
    /// Steps run several times, in a member named "cycles".
    Cycles(Cycles<PointStep>),
    /// Steps run several times.
    Cycle(Cycle<PointStep>),
    /// One increment per row of a table.
    Table(PointTable),
    /// Linear ramps to end values.
    Ramp(Box<PointRamp>),
}

/// A step in which the controlled components ramp linearly to their end values.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[schemars(deny_unknown_fields)]
pub(crate) struct PointRamp {
    /// Number of increments.
    pub increments: Increments,
    /// Duration, s (default 1).
    pub time: Option<Positive>,
    /// End values. Components that are not named, neither as strain nor as stress, are stress-free.
    pub target: Option<StepTarget>,
    /// End value of the deformation gradient, row by row (needs nlgeom).
    #[serde(rename = "F")]
    pub deformation_gradient: Option<Matrix>,
    /// Linear relations, each in place of one stress-free component.
    pub constraints: Option<Vec<Constraint>>,
    /// Conditions that end it early, and fields at its end.
    #[serde(flatten)]
    pub end: StepEnd,
}

/// A step with one increment per row of a table.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[schemars(deny_unknown_fields)]
pub(crate) struct PointTable {
    /// CSV file, relative to the case file, or its columns: time (optional, s), components as in target, temperature,
    /// and predef1, predef2, … for the field variables of the case.
    pub table: TableSource,
    /// Linear relations, each in place of one stress-free component.
    pub constraints: Option<Vec<Constraint>>,
    /// Conditions that end it early, and fields at its end.
    #[serde(flatten)]
    pub end: StepEnd,
}

/// End values of controlled components: strains (engineering shear) or stresses (MPa), or "hold". With nlgeom, in the
/// case's measure.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[schemars(deny_unknown_fields)]
pub(crate) struct StepTarget {
    /// Components.
    #[serde(flatten)]
    pub components: ByComponent<EndValue>,
    /// Deformation gradient, row by row (needs nlgeom).
    #[serde(rename = "F")]
    pub deformation_gradient: Option<Matrix>,
}

/// A linear relation: the sum of coefficient · component equals a value at the end of the step. Examples: hold e11 +
/// e22 + e33 (undrained), or q - η p (a stress path).
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[schemars(deny_unknown_fields)]
pub(crate) struct Constraint {
    /// Coefficients.
    #[serde(flatten)]
    pub coefficients: ByComponent<f64>,
    /// Right side at the end of the step (default 0), reached linearly; "hold" keeps the left side as it is.
    pub equals: Option<EndValue>,
}

/// Values given for some components.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
pub(crate) struct ByComponent<T> {
    /// Strain 11.
    pub e11: Option<T>,
    /// Strain 22.
    pub e22: Option<T>,
    /// Strain 33.
    pub e33: Option<T>,
    /// Engineering shear strain 12.
    pub g12: Option<T>,
    /// Engineering shear strain 13.
    pub g13: Option<T>,
    /// Engineering shear strain 23.
    pub g23: Option<T>,
    /// Stress 11, MPa.
    pub s11: Option<T>,
    /// Stress 22, MPa.
    pub s22: Option<T>,
    /// Stress 33, MPa.
    pub s33: Option<T>,
    /// Stress 12, MPa.
    pub s12: Option<T>,
    /// Stress 13, MPa.
    pub s13: Option<T>,
    /// Stress 23, MPa.
    pub s23: Option<T>,
}

impl<T: Copy> ByComponent<T> {
    /// The six strains and the six stresses.
    pub fn strain_and_stress(&self) -> [[Option<T>; 6]; 2] {
        let Self { e11, e22, e33, g12, g13, g23, s11, s22, s33, s12, s13, s23 } = *self;
        [[e11, e22, e33, g12, g13, g23], [s11, s22, s33, s12, s13, s23]]
    }
}
