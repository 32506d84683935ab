//! Programs: cases checked and resolved, with plugins loaded, names looked up, cycles expanded, tables read. The crate
//! `pullout-case` makes them; [`super`] runs them.

use crate::arguments::{ContactArguments, UmatArguments};
use crate::columns;
use crate::input::folder_of;
pub use fe_core::model::FieldValues;
use fe_core::schema::whole;
use fe_core::stepping::Recorded;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use umat_abi::host::Plugin;
use umat_abi::law::StressState;

/// Names of the strain components in case files and `history.csv`.
pub const STRAIN_NAMES: [&str; 6] = ["e11", "e22", "e33", "g12", "g13", "g23"];
/// Names of the stress components.
pub const STRESS_NAMES: [&str; 6] = ["s11", "s22", "s33", "s12", "s13", "s23"];

/// Stress state: the components that exist, and those that are fixed.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Mode {
    /// NTENS 6.
    #[default]
    #[serde(rename = "3d")]
    ThreeD,
    /// e33 = g13 = g23 = 0; NTENS 4.
    PlaneStrain,
    /// 11 rr, 22 zz, 33 hoop, 12 rz; NTENS 4.
    Axisymmetric,
    /// s33 = s13 = s23 = 0; NTENS 3.
    PlaneStress,
    /// Only s11, as in UMATs for trusses, wires and plane beams; NTENS 1.
    #[serde(rename = "1d")]
    OneD,
    /// Only s11 and s12, as in UMATs for beams in space; NTENS 2 (NDI 1, NSHR 1).
    Beam,
}

impl Mode {
    /// Returns the name that cases use.
    pub fn name(self) -> &'static str {
        match self {
            Self::ThreeD => "3d",
            Self::PlaneStrain => "plane_strain",
            Self::Axisymmetric => "axisymmetric",
            Self::PlaneStress => "plane_stress",
            Self::OneD => "1d",
            Self::Beam => "beam",
        }
    }

    /// The components that the plugin sees.
    pub fn stress_state(self) -> StressState {
        match self {
            Self::ThreeD => StressState::ThreeD,
            Self::PlaneStrain | Self::Axisymmetric => StressState::PlaneStrainOrAxisymmetric,
            Self::PlaneStress => StressState::PlaneStress,
            Self::OneD => StressState::OneD,
            Self::Beam => StressState::Beam,
        }
    }

    /// Returns whether the direct stresses across the line are 0 and the strains there unknown.
    pub fn is_of_line(self) -> bool {
        matches!(self, Self::OneD | Self::Beam)
    }

    /// Returns the type of an element of this mode, as ABAQUS calls it.
    pub fn element_type(self) -> &'static str {
        match self {
            Self::ThreeD => "C3D8",
            Self::PlaneStrain => "CPE4",
            Self::Axisymmetric => "CAX4",
            Self::PlaneStress => "CPS4",
            Self::OneD => "T3D2",
            Self::Beam => "B31",
        }
    }

    /// Indices (of six) of the components that a case may control; the others are fixed by the mode.
    pub fn controllable(self) -> &'static [usize] {
        match self {
            Self::ThreeD => &[0, 1, 2, 3, 4, 5],
            Self::PlaneStrain | Self::PlaneStress => &[0, 1, 3],
            Self::Axisymmetric => &[0, 1, 2, 3],
            Self::OneD | Self::Beam => self.stress_state().components(),
        }
    }
}

/// The strain and stress of steps and history with nlgeom. F = R U; P = J s F^-T is the first Piola-Kirchhoff stress, s
/// Cauchy's.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Deserialize, JsonSchema)]
#[serde(rename_all = "lowercase")]
pub enum Measure {
    /// Hencky's strain ln U (gNM twice the component) and Cauchy's stress.
    #[default]
    Logarithmic,
    /// Biot's: strain U - 1 (g12 = 2 U12), stress the symmetric part of R^T P, which is force per area before the
    /// deformation.
    Nominal,
}

/// Words of a picture.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[schemars(deny_unknown_fields)]
pub struct Caption {
    /// Its title.
    pub title: Option<String>,
    /// Names of its lines in the legend, by the columns that they show along y.
    #[serde(default)]
    pub legend: BTreeMap<String, String>,
}

/// Properties of programs of all kinds.
#[derive(Clone, Debug, Default)]
pub struct About {
    /// The case file, for messages and replay cases.
    pub case_file: PathBuf,
    /// The case's title.
    pub title: String,
    /// The case's description, for the report.
    pub description: String,
    /// Stops the run early, after any increment of any step.
    pub until: Option<Until>,
    /// Every n-th increment (and the last of each step and of the run) goes to the history.
    pub every: usize,
    /// Draw plots and the report.
    pub plots: bool,
    /// Titles and legends of pictures, by their names.
    pub captions: BTreeMap<String, Caption>,
    /// Curves to compare with.
    pub compare: Vec<Compare>,
    /// Things the user should know although nothing is wrong.
    pub warnings: Vec<String>,
    /// Facts of the model that every case of its kind has: for the report, not for the terminal.
    pub notes: Vec<String>,
    /// Those of the notes that decide the result, for the terminal at the end of a run.
    pub highlights: Vec<String>,
    /// Values that the case leaves to defaults, a line for each place.
    pub defaults: Vec<String>,
    /// Increments of another run, which are repeated: no `until` ends a step or the run then.
    pub recorded: Option<Arc<Recorded>>,
}

/// A run of a point.
#[derive(Clone, Debug)]
pub struct Program {
    /// Properties that programs of all kinds have.
    pub about: About,
    /// The case as JSON after `--set`, for the replay case.
    pub document: serde_json::Value,
    /// The plugin.
    pub plugin: Plugin,
    /// Kind of point that is driven.
    pub kind: PointKind,
    /// CELENT, or the contact surface's characteristic length; `None` if the case names none (hosts pass 1).
    pub characteristic_length: Option<f64>,
    /// Iteration limits.
    pub controls: IterationLimits,
}

/// Kind of point that is driven.
#[derive(Clone, Debug)]
pub enum PointKind {
    /// A material point through UMAT.
    Point(PointProgram),
    /// A contact point through UINTER or FRIC.
    Interface(InterfaceProgram),
}

/// A material point along a path.
#[derive(Clone, Debug)]
pub struct PointProgram {
    /// Kinematic mode.
    pub mode: Mode,
    /// Finite strain: DFGRD0, DFGRD1, DROT; STRAN and STRESS rotated.
    pub nlgeom: bool,
    /// Measure of the strains and stresses of steps and history at finite strain.
    pub measure: Measure,
    /// Whether the history has RPL and its derivatives.
    pub heat: bool,
    /// The state before the first step.
    pub initial: PointState,
    /// Arguments that the path leaves open.
    pub arguments: UmatArguments,
    /// Steps in order, cycles expanded.
    pub steps: Vec<PointStep>,
}

/// Initial values of a material point.
#[derive(Clone, Debug)]
pub struct PointState {
    /// STRAN, six components, engineering shear.
    pub strain: [f64; 6],
    /// STRESS, MPa: Cauchy's at finite strain; `None`: what the library's SIGINI says, or zeros.
    pub stress: Option<Box<[f64; 6]>>,
    /// STATEV, NSTATV values; `None`: what the library's SDVINI says, or zeros.
    pub statev: Option<Vec<f64>>,
    /// Total time.
    pub time: f64,
    /// Deformation gradient, row by row.
    pub deformation_gradient: [[f64; 3]; 3],
    /// Temperature and field variables, of which there may be none.
    pub fields: FieldValues,
}

/// One step of a path; `G`: its goal.
#[derive(Clone, Debug)]
pub struct PathStep<G> {
    /// Division into increments.
    pub pace: Pace,
    /// Goal at its end.
    pub goal: G,
    /// Condition that ends this step early.
    pub until: Option<Until>,
    /// Temperature and field variables.
    pub fields: StepFields,
}

/// One step of a material point.
pub type PointStep = PathStep<PointGoal>;

/// One step of a contact point.
pub type InterfaceStep = PathStep<InterfaceGoal>;

/// Division of a step into increments.
#[derive(Clone, Debug, PartialEq)]
pub enum Pace {
    /// Equal increments.
    Equal {
        /// Number of increments, ≥ 1.
        increments: usize,
        /// Duration of all of them, s.
        time: f64,
    },
    /// One increment for each row of a table, with its duration, s.
    Rows(Vec<f64>),
}

impl Pace {
    /// Number of increments.
    pub fn increments(&self) -> usize {
        match self {
            Self::Equal { increments, .. } => *increments,
            Self::Rows(times) => times.len(),
        }
    }

    /// Returns the parts of the increments that are done at the start and at the end of increment `index` (from 0).
    pub(crate) fn shares(&self, index: usize) -> [f64; 2] {
        let count = self.increments();
        [index, index + 1].map(|k| if k == count { 1.0 } else { k as f64 / count as f64 })
    }

    /// Step time at the start and at the end of increment `index`; `now`: as it is, s.
    pub(crate) fn times(&self, index: usize, now: f64) -> (f64, f64) {
        match self {
            Self::Equal { time, .. } => {
                let [before, after] = self.shares(index);
                (time * before, time * after)
            }
            Self::Rows(times) => (now, now + times[index]),
        }
    }
}

/// Goal of a material point's step.
#[derive(Clone, Debug)]
pub struct PointGoal {
    /// Quantities that are prescribed.
    pub drive: PointDrive,
    /// Linear relations, each in place of one stress-free component ([`Control::Constraint`]).
    pub constraints: Vec<Constraint>,
}

/// Message for a step that is not taken since its s11 and e11 would belong to different directions.
pub const TURNED: &str = "the material has turned (R of F = R U is not 1), so that strains along its directions and Cauchy \
                      stresses along the axes cannot be controlled together: control strains alone or stresses alone, \
                      or take \"measure\": \"nominal\", whose stresses turn with the material";

/// Alternatives where a law does not report its thickness strain in plane stress.
const WITH_THICKNESS: &str = "\"as\": \"3d\" calls it with six components and finds the thickness strain, and mode 3d has the same stresses, \
                                  with s33, s13 and s23 free";

/// Returns the message for nominal stresses in plane stress where the law does not report its thickness strain.
pub fn nominal_needs_thickness(law: &str) -> String {
    format!(
        "nominal stresses need the thickness strain, which '{law}' does not report in plane stress: {WITH_THICKNESS}"
    )
}

/// Returns the warning for plane stress at finite strain where the law does not report its thickness strain.
pub fn gradient_needs_thickness(law: &str) -> String {
    format!(
        "F33 and the column e33 are NaN, because '{law}' does not report its thickness strain. As in ABAQUS, DFGRD0 and DFGRD1 have the F33 of constant volume, which is right only for an incompressible material. If the law reads F33, {WITH_THICKNESS}"
    )
}

impl PointGoal {
    /// Returns whether it controls strains of some of these components, and stresses of others.
    pub fn mixes_strain_and_stress(&self, components: &[usize]) -> bool {
        let PointDrive::Components { controls, .. } = &self.drive else {
            return false;
        };
        let (mut strain, mut stress) = (false, false);
        for &i in components {
            match controls[i] {
                Control::Strain(_) | Control::HoldStrain => strain = true,
                Control::Stress(_) | Control::HoldStress => stress = true,
                Control::Constraint(k) => {
                    strain |= self.constraints[k].strain.iter().any(|coefficient| *coefficient != 0.0);
                    stress |= self.constraints[k].stress.iter().any(|coefficient| *coefficient != 0.0);
                }
            }
        }
        strain && stress
    }
}

/// Quantities that are prescribed at a material point.
#[derive(Clone, Debug)]
pub enum PointDrive {
    /// Controlled components.
    Components {
        /// Controls of each of the six components, with their values at the end of a ramp; those that the mode fixes
        /// are ignored. In a table they give the quantities that its rows hold; `FREE` for components without a column.
        controls: [Control; 6],
        /// Values at the end of each row of a table, by component, unused ones 0; none: a linear ramp.
        rows: Vec<[f64; 6]>,
    },
    /// The deformation gradient ramps linearly to this one (row by row).
    DeformationGradient([[f64; 3]; 3]),
}

/// Temperature and field variables of a step: they go linearly to the values at its end, or from row to row of its
/// table.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct StepFields {
    /// Temperature at the end (`None`: unchanged).
    pub temperature: Option<f64>,
    /// Field variables at the end (`None`: unchanged).
    pub predef: Option<Vec<f64>>,
    /// Column of the temperature at the end of each row.
    pub temperatures: Option<Vec<f64>>,
    /// Field variables, likewise; empty: without a table.
    pub predefs: Vec<Option<Vec<f64>>>,
}

impl StepFields {
    /// Sets the values at the start and at the end of increment `index` (from 0). `first`: those at the start of the step;
    /// `present`: those before the increment.
    pub(crate) fn set_increment(
        &self,
        first: &FieldValues,
        present: &FieldValues,
        pace: &Pace,
        index: usize,
        increment: &mut [FieldValues; 2],
    ) {
        for (values, fraction) in increment.iter_mut().zip(pace.shares(index)) {
            values.temperature = lerp(first.temperature, self.temperature.unwrap_or(first.temperature), fraction);
            values.variables.clone_from(&first.variables);
            for (value, end) in values.variables.iter_mut().zip(self.predef.iter().flatten()) {
                *value = lerp(*value, *end, fraction);
            }
        }
        let [start, end] = increment;
        if let Some(column) = &self.temperatures {
            (start.temperature, end.temperature) = (present.temperature, column[index]);
        }
        for (k, column) in self.predefs.iter().enumerate() {
            if let Some(column) = column {
                (start.variables[k], end.variables[k]) = (present.variables[k], column[index]);
            }
        }
    }
}

/// Control of a component.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Control {
    /// The strain ends at this value.
    Strain(f64),
    /// The strain stays as it is at the start of the step.
    HoldStrain,
    /// The stress ends at this value.
    Stress(f64),
    /// The stress stays as it is at the start of the step.
    HoldStress,
    /// Constraint number k of the step takes the place of "stress-free".
    Constraint(usize),
}

impl Control {
    /// Named by nothing: stress-free.
    pub const FREE: Self = Self::Stress(0.0);
}

/// Σ strain_i ε_i + Σ stress_i σ_i = equals, reached linearly from the present value of the left side.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Constraint {
    /// Coefficients of the strain components.
    pub strain: [f64; 6],
    /// Coefficients of the stress components.
    pub stress: [f64; 6],
    /// Right side at the end of the step.
    pub equals: f64,
    /// The right side stays what the left side is at the start of the step, whatever `equals`.
    pub hold: bool,
}

/// A contact point along a path.
#[derive(Clone, Debug)]
pub struct InterfaceProgram {
    /// Entry point that is called.
    pub entry: InterfaceEntry,
    /// Tangential directions, 1 or 2 (2 if the case controls `slip2`).
    pub tangential_directions: usize,
    /// STATEV at the start.
    pub initial_statev: Vec<f64>,
    /// Arguments that the path leaves open.
    pub arguments: ContactArguments,
    /// Total time at the start.
    pub initial_time: f64,
    /// \[slip, slip2, gap\] and p at the start (gap > 0 open).
    pub initial_displacement: [f64; 3],
    /// Temperature and field variables at the start.
    pub initial_fields: FieldValues,
    /// Steps in order, cycles expanded.
    pub steps: Vec<InterfaceStep>,
}

/// UINTER or FRIC.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum InterfaceEntry {
    /// Normal and tangential tractions from the plugin.
    Uinter,
    /// Tangential traction; the pressure is prescribed.
    Fric,
}

/// Goal of a contact point's step. Values: \[slip, slip2, normal\].
#[derive(Clone, Debug)]
pub struct InterfaceGoal {
    /// Whether the normal value is a gap (> 0 open) or a pressure (> 0 compression).
    pub normal: NormalControl,
    /// Values at the end of a linear ramp, or of each row of a table; `None`: held.
    pub ends: Vec<[Option<f64>; 3]>,
}

/// Meaning of the normal value of an interface step.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum NormalControl {
    /// mm, > 0 open.
    Gap,
    /// MPa, > 0 compression.
    Pressure,
}

/// Ends a step or a run when a column of the history passes a bound.
#[derive(Clone, Debug, PartialEq)]
pub struct Until {
    /// Index among the history's columns.
    pub column: usize,
    /// Compare its absolute value.
    pub absolute: bool,
    /// Stop above this.
    pub greater_than: Option<f64>,
    /// Stop below this.
    pub less_than: Option<f64>,
}

/// Iteration limits.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(default, deny_unknown_fields)]
#[schemars(rename = "Controls")]
pub struct IterationLimits {
    /// Newton iterations per increment.
    #[schemars(schema_with = "whole::<1, 10_000>")]
    pub max_iterations: u32,
    /// Most cut-backs in a row. The shortest piece of an increment is 2^(−max_cutbacks) of it.
    #[schemars(schema_with = "whole::<0, 60>")]
    pub max_cutbacks: u32,
}

impl Default for IterationLimits {
    fn default() -> Self {
        Self { max_iterations: 25, max_cutbacks: 12 }
    }
}

/// A curve from a file to draw and to compare with.
#[derive(Clone, Debug)]
pub struct Compare {
    /// File as the case names it.
    pub file: String,
    /// The points of the file (before scaling).
    pub points: Vec<(f64, f64)>,
    /// Name of the file's x column.
    pub file_x: String,
    /// Name of the file's y column.
    pub file_y: String,
    /// Index among the history's columns.
    pub x: usize,
    /// Index among the history's columns.
    pub y: usize,
    /// file x · `scale_x` is compared with the history's x.
    pub scale_x: f64,
    /// file y · `scale_y` is compared with the history's y.
    pub scale_y: f64,
    /// Label of the curve.
    pub label: String,
}

impl Program {
    /// The history's columns, in the order of the CSV.
    pub fn columns(&self) -> Vec<String> {
        let states = self.plugin.state_names();
        match &self.kind {
            PointKind::Point(point) => columns::of_point(point.nlgeom, point.heat, &states),
            PointKind::Interface(contact) => columns::of_contact(contact.tangential_directions, &states),
        }
    }
}

/// Interpolates between two values; exact at both ends.
pub(crate) fn lerp(from: f64, to: f64, fraction: f64) -> f64 {
    match fraction {
        0.0 => from,
        1.0 => to,
        _ => from + fraction * (to - from),
    }
}

/// Returns the folder that GETOUTDIR answers. As in ABAQUS it is the one from which the job is submitted, so that what
/// a UMAT reads lies next to the case. A replay, which lies elsewhere, names its original's.
pub fn job_folder(path: &Path, document: &serde_json::Value) -> PathBuf {
    let mut folder = Path::new(".").join(folder_of(path));
    folder.extend(document["job_folder"].as_str());
    std::path::absolute(&folder).unwrap_or(folder)
}
