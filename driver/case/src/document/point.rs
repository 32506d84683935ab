//! Kind "point".

use super::{
    Compare, Controls, Cycle, Cycles, EndValue, Increments, Material, Matrix, Output, Piece, Positive, RunIncrements,
    UmatArguments, Until,
};
use pullout_run::program::{Measure, Mode};
use schemars::JsonSchema;
use serde::Deserialize;
use std::collections::BTreeMap;

/// A material point along a path (kind "point").
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct PointCase {
    /// Address of this schema, for editors.
    #[serde(rename = "$schema")]
    #[expect(dead_code, reason = "read by editors")]
    pub schema: Option<Piece<String>>,
    /// "point".
    #[expect(dead_code, reason = "dispatched on before")]
    pub kind: PointKind,
    /// Title of plots and report; default: the file's stem.
    pub title: Option<Piece<String>>,
    /// Text for the report.
    pub description: Option<Piece<String>>,
    /// Files that its libraries read on their own: they travel with the case, and the run is another one if they change.
    #[expect(dead_code, reason = "read before the kinds differ")]
    pub files: Option<Piece<Vec<String>>>,
    /// The plugin and its parameters.
    pub material: Piece<Material>,
    /// Which components exist (default "3d").
    pub mode: Option<Piece<Mode>>,
    /// Finite strain (default false): strains are those of U in F = R U, of which a step that is given strains or stresses
    /// keeps R; UMAT is given DFGRD0, DFGRD1 and DROT, and STRAN and STRESS turned by DROT.
    pub nlgeom: Option<Piece<bool>>,
    /// What strains and stresses of steps and history are with nlgeom (default "logarithmic").
    pub measure: Option<Piece<Measure>>,
    /// The folder that GETOUTDIR answers, relative to the case file; default: the case file's. A replay names that of the
    /// case it comes from.
    #[expect(dead_code, reason = "read by `job_folder`")]
    pub job_folder: Option<Piece<String>>,
    /// CELENT, mm; required when the law's crack band is on.
    pub characteristic_length: Option<Piece<Positive>>,
    /// The state before the first step.
    pub initial: Option<Piece<PointInitial>>,
    /// Arguments of UMAT that the path leaves open; a replay of a recorded call gives them.
    pub arguments: Option<Piece<UmatArguments>>,
    /// Initial temperature (default 0).
    pub temperature: Option<Piece<f64>>,
    /// Initial field variables.
    pub predef: Option<Piece<Vec<f64>>>,
    /// What is done to the point.
    #[schemars(length(min = 1))]
    pub steps: Piece<Vec<Piece<PointStep>>>,
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

/// The word "point".
#[derive(Clone, Copy, Debug, Deserialize, JsonSchema)]
#[serde(rename_all = "lowercase")]
pub enum PointKind {
    /// A material point.
    Point,
}

/// The state before the first step, as UMAT is given it.
#[derive(Clone, Debug, Default, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct PointInitial {
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
pub enum Components {
    /// In order.
    List(Vec<f64>),
    /// By name.
    Named(BTreeMap<String, f64>),
}

/// A step: a ramp, a table, or a cycle of steps.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(untagged)]
pub enum PointStep {
    /// The same in a member named "cycles".
    Cycles(Cycles<PointStep>),
    /// Steps run several times.
    Cycle(Cycle<PointStep>),
    /// One increment per row of a CSV file.
    Table(PointTable),
    /// Linear ramps to end values.
    Ramp(Box<PointRamp>),
}

/// A step in which the controlled components ramp linearly to their end values.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct PointRamp {
    /// Number of increments.
    pub increments: Increments,
    /// Duration, s (default 1).
    pub time: Option<Positive>,
    /// End values; components named by neither strain nor stress are stress-free.
    pub target: Option<Target>,
    /// End value of the deformation gradient, row by row (needs nlgeom).
    #[serde(rename = "F")]
    pub deformation_gradient: Option<Matrix>,
    /// Linear relations, each in place of one stress-free component.
    pub constraints: Option<Vec<Constraint>>,
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
pub struct PointTable {
    /// CSV file, relative to the case file: columns time (optional, s), any components, as in target, temperature, and
    /// predef1, predef2, … of the case's field variables.
    pub table: String,
    /// Linear relations, each in place of one stress-free component.
    pub constraints: Option<Vec<Constraint>>,
    /// Ends this step early.
    pub until: Option<Until>,
    /// Temperature at the end of the step.
    pub temperature: Option<f64>,
    /// Field variables at the end of the step.
    pub predef: Option<Vec<f64>>,
}

/// End values of controlled components: strains (engineering shear) or stresses (MPa), or "hold". With nlgeom, in the
/// case's measure.
#[derive(Clone, Debug, Default, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Target {
    /// Strain 11.
    pub e11: Option<EndValue>,
    /// Strain 22.
    pub e22: Option<EndValue>,
    /// Strain 33.
    pub e33: Option<EndValue>,
    /// Engineering shear strain 12.
    pub g12: Option<EndValue>,
    /// Engineering shear strain 13.
    pub g13: Option<EndValue>,
    /// Engineering shear strain 23.
    pub g23: Option<EndValue>,
    /// Stress 11, MPa.
    pub s11: Option<EndValue>,
    /// Stress 22, MPa.
    pub s22: Option<EndValue>,
    /// Stress 33, MPa.
    pub s33: Option<EndValue>,
    /// Stress 12, MPa.
    pub s12: Option<EndValue>,
    /// Stress 13, MPa.
    pub s13: Option<EndValue>,
    /// Stress 23, MPa.
    pub s23: Option<EndValue>,
    /// Deformation gradient, row by row (needs nlgeom).
    #[serde(rename = "F")]
    pub deformation_gradient: Option<Matrix>,
}

impl Target {
    /// The six strains.
    pub fn strain(&self) -> [Option<EndValue>; 6] {
        [self.e11, self.e22, self.e33, self.g12, self.g13, self.g23]
    }

    /// The six stresses.
    pub fn stress(&self) -> [Option<EndValue>; 6] {
        [self.s11, self.s22, self.s33, self.s12, self.s13, self.s23]
    }
}

/// A linear relation: the sum of coefficient · component equals a value at the end of the step. Undrained: the sum of e11,
/// e22 and e33 holds. A stress path: q - η p holds.
#[derive(Clone, Debug, Default, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Constraint {
    /// Coefficient of strain 11.
    pub e11: Option<f64>,
    /// Coefficient of strain 22.
    pub e22: Option<f64>,
    /// Coefficient of strain 33.
    pub e33: Option<f64>,
    /// Coefficient of shear strain 12.
    pub g12: Option<f64>,
    /// Coefficient of shear strain 13.
    pub g13: Option<f64>,
    /// Coefficient of shear strain 23.
    pub g23: Option<f64>,
    /// Coefficient of stress 11.
    pub s11: Option<f64>,
    /// Coefficient of stress 22.
    pub s22: Option<f64>,
    /// Coefficient of stress 33.
    pub s33: Option<f64>,
    /// Coefficient of stress 12.
    pub s12: Option<f64>,
    /// Coefficient of stress 13.
    pub s13: Option<f64>,
    /// Coefficient of stress 23.
    pub s23: Option<f64>,
    /// Right side at the end of the step (default 0), reached linearly; "hold" keeps the left side as it is.
    pub equals: Option<EndValue>,
}

impl Constraint {
    /// The coefficients of the strains.
    pub fn strain(&self) -> [Option<f64>; 6] {
        [self.e11, self.e22, self.e33, self.g12, self.g13, self.g23]
    }

    /// The coefficients of the stresses.
    pub fn stress(&self) -> [Option<f64>; 6] {
        [self.s11, self.s22, self.s33, self.s12, self.s13, self.s23]
    }
}
