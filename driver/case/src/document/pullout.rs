//! Kind "pullout".

use super::{
    CommonCaseEntries, Components, Course, Cycle, Cycles, Fraction, Increments, Material, Plots, Positive, StepEnd,
    WithDefaults,
};
use fe_core::element::Integration;
use fe_core::kinematics::PlaneModel;
use fe_core::model::{Controls, Skipping, Spalling};
use schemars::JsonSchema;
use serde::Deserialize;
use std::collections::BTreeMap;

mod boundary;
pub(crate) use boundary::*;
mod contact;
pub(crate) use contact::*;
mod field;
pub(crate) use field::*;
mod specimen;
pub(crate) use specimen::*;

/// A specimen in two dimensions: parts, contact, supports, steps (kind "pullout").
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[schemars(deny_unknown_fields)]
pub(crate) struct PulloutCase {
    /// "pullout".
    #[expect(dead_code, reason = "dispatched on before")]
    #[schemars(extend("const" = "pullout"))]
    pub kind: String,
    /// Title, text, files, curves.
    #[serde(flatten)]
    pub head: CommonCaseEntries,
    /// A specimen by its parameters, or a Gmsh file.
    pub mesh: MeshSource,
    /// The parts by name: those of the specimen, or the physical surfaces of the file.
    pub parts: BTreeMap<String, Part>,
    /// One object for all contact pairs of the specimen, or a list of pairs.
    pub contact: Option<Contact>,
    /// Nodes that are pulled; default: those of the specimen.
    pub grip: Option<Grip>,
    /// One of the specimen's named support conditions, or supports by name, which replace all of the specimen's; default: those of the
    /// specimen.
    pub supports: Option<Supports>,
    /// Loads by name; each is multiplied by its drive.
    pub loads: Option<BTreeMap<String, Load>>,
    /// Multi-point constraints and ties.
    pub couplings: Option<Vec<Coupling>>,
    /// What the history columns slip and load measure; default: the grip, and the exit and tail of the specimen.
    pub measure: Option<Measure>,
    /// Large displacements (default false).
    pub nlgeom: Option<bool>,
    /// A scalar at every node: a temperature, or the phase field of a law such as concrete_phase_field (default: none).
    pub field: Option<ScalarField>,
    /// Release of torn concrete, for laws with damage (default: none is released).
    pub spalling: Option<WithDefaults<Spalling>>,
    /// Fields, and how the run ends.
    #[serde(flatten)]
    pub course: Course,
    /// The state before the first step.
    pub initial: Option<PulloutInitial>,
    /// Loading steps, in order.
    #[schemars(length(min = 1))]
    pub steps: Vec<PulloutStep>,
    /// Settings of the output.
    pub output: Option<PulloutOutput>,
    /// Tolerances and limits.
    pub controls: Option<WithDefaults<Controls>>,
    /// Work that the solver omits where the specimen does not need it (default "all"). Results agree within the
    /// tolerance of equilibrium.
    pub skip: Option<Skip>,
}

/// One body of the specimen.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(crate) struct Part {
    /// The plugin and its parameters.
    pub material: Material,
    /// Assumption about the third direction; default: the specimen's, plane_strain for a file.
    pub model: Option<PlaneModel>,
    /// Reference thickness, mm, or the property of a round fibre's section that the thickness preserves; default: the
    /// specimen's, 1 for a file.
    pub thickness: Option<Thickness>,
    /// Integration of the elements; default: reduced for Q8, full for the others.
    pub integration: Option<Integration>,
    /// Large displacements of this part; default: as in the case. A part that moves little compared with its size, such
    /// as the block around a fibre, is cheaper and more robust without them.
    pub nlgeom: Option<bool>,
    /// The state before the first step.
    pub initial: Option<PartInitial>,
    /// Tensile strength of a fibre's wire, MPa, on the initial area. The run ends with a warning when the mean axial
    /// stress of a section reaches it (default: the wire does not break by stress).
    pub strength: Option<Positive>,
    /// Elongation at which a fibre's wire breaks, measured over 5 diameters; 0.01 is 1 %. The run then ends with a
    /// warning (default: the wire does not break by strain). Bending over the exit or in a hook does not count.
    pub elongation: Option<Positive>,
    /// Average the dilatation of Q4 elements to avoid locking (default true).
    pub average_dilatation: Option<bool>,
}

/// Initial state of a specimen.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(crate) struct PulloutInitial {
    /// Initial values of the drives of loads (default 0): the loads in equilibrium with the initial stresses of the
    /// parts.
    pub drives: BTreeMap<String, f64>,
}

/// Initial state of the points of a part.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(crate) struct PartInitial {
    /// Stress, MPa, the same at all points: in order (11, 22, 33, 12; without 33 in plane stress) or by name (s11, …).
    /// Default: the stress that the library's SIGINI sets, or 0. Before the first increment, nodes move until the
    /// stress is in equilibrium with the supports and the initial values of the drives.
    pub stress: Option<Components>,
}

/// A thickness.
#[derive(Clone, Copy, Debug, Deserialize, JsonSchema)]
#[serde(untagged)]
pub(crate) enum Thickness {
    /// mm.
    Value(Positive),
    /// Thickness of a plate as high as the round fibre.
    Section(Section),
}

/// Property that a plate as high as a round fibre shares with it.
#[derive(Clone, Copy, Debug, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub(crate) enum Section {
    /// The area: thickness πφ/4.
    EqualArea,
    /// The second moment of area: thickness 3πφ/16.
    EqualInertia,
    /// Area and plastic moment, by layers: the inner half of the height is 1.023 φ thick, the outer 0.548 φ. The second moment of area is
    /// 1.03 times the round one. Takes an `elements_across` of 4 or 8.
    Layers,
}

/// A step in which drives ramp to their end values, or a cycle of steps.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(untagged)]
pub(crate) enum PulloutStep {
    /// Steps run several times, in a member named "cycles".
    Cycles(Cycles<PulloutStep>),
    /// Steps run several times.
    Cycle(Cycle<PulloutStep>),
    /// Linear ramps to end values.
    Ramp(Box<PulloutRamp>),
}

/// A step in which drives ramp linearly to their end values.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[schemars(deny_unknown_fields)]
pub(crate) struct PulloutRamp {
    /// Displacement of the grip at the end of the step, mm.
    pub slip: Option<f64>,
    /// Values of other drives at the end of the step. Drives that are not named keep their values.
    pub drives: Option<BTreeMap<String, f64>>,
    /// Duration, s (default 1).
    pub time: Option<Positive>,
    /// Conditions that end it early, and fields at its end.
    #[serde(flatten)]
    pub end: StepEnd,
    /// Sizes of automatic increments, or the number of equal increments.
    pub increments: Option<StepIncrements>,
}

/// Choice of the increments of a step.
#[derive(Clone, Copy, Debug, Deserialize, JsonSchema)]
#[serde(untagged)]
pub(crate) enum StepIncrements {
    /// Number of equal increments, cut back when one fails.
    Equal(Increments),
    /// Automatic.
    Automatic(AutomaticIncrements),
}

/// Automatic increments, as fractions of the step.
#[derive(Clone, Copy, Debug, Default, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(crate) struct AutomaticIncrements {
    /// First increment (default 1e-3).
    pub initial: Option<Fraction>,
    /// Largest increment (default 0.02).
    pub maximum: Option<Fraction>,
    /// Smallest increment; below it the run fails (default 1e-8).
    pub minimum: Option<Fraction>,
}

/// Settings of the output.
#[derive(Clone, Debug, Default, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(crate) struct PulloutOutput {
    /// Write every n-th increment, and the last of each step, to history.csv (default 1).
    pub every: Option<Increments>,
    /// Draw plots (default true), or draw them with these titles and legends.
    pub plots: Option<Plots>,
    /// Write fields for ParaView: never (false), or at every 10th (true, the default) or every n-th increment and at
    /// the end of each step.
    pub vtu: Option<Vtu>,
    /// Further moments for pictures, and for fields unless vtu is false: slips in mm, each when it is first reached, or
    /// increment numbers. There are always pictures of the greatest load and of the end.
    pub pictures_at: Option<PicturesAt>,
    /// Elongation over 5 diameters at which the run warns that a fibre without `strength` and `elongation` would have
    /// ruptured; the summary gives the slip (default 0.03). The run itself continues.
    pub rupture_strain: Option<Positive>,
}

/// Moments at which pictures are made.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(untagged)]
pub(crate) enum PicturesAt {
    /// Slips, mm.
    Slips(Vec<Positive>),
    /// Numbers of increments.
    Increments(IncrementNumbers),
}

/// Numbers of increments.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(crate) struct IncrementNumbers {
    /// Counted from 1 over all steps.
    pub increments: Vec<Increments>,
}

/// Moments at which fields are written.
#[derive(Clone, Copy, Debug, Deserialize, JsonSchema)]
#[serde(untagged)]
pub(crate) enum Vtu {
    /// Never, or at every 10th increment.
    Switch(bool),
    /// At every n-th increment.
    Every(Increments),
}

/// Work that is omitted: everything, nothing, or everything except the items set to false.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(untagged)]
pub(crate) enum Skip {
    /// "all" or "none".
    Word(SkipWord),
    /// One by one.
    Items(SkipItems),
}

/// Everything or nothing.
#[derive(Clone, Copy, Debug, Deserialize, JsonSchema)]
#[serde(rename_all = "lowercase")]
pub(crate) enum SkipWord {
    /// Everything that can be omitted.
    All,
    /// Nothing.
    None,
}

/// Work that is omitted, item by item.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[schemars(deny_unknown_fields)]
pub(crate) struct SkipItems {
    /// Each of them.
    #[serde(flatten)]
    pub items: WithDefaults<Skipping>,
    /// No longer has an effect: tangents are always requested.
    pub unused_tangents: Option<bool>,
    /// No longer has an effect: the solver chooses.
    pub symmetric_solver: Option<bool>,
}
