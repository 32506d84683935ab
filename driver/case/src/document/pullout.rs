//! Kind "pullout".

use super::{CaseHead, Components, Course, Cycle, Cycles, Fraction, Increments, Material, Positive, StepEnd, Whole};
use fe_core::element::Integration;
use fe_core::kinematics::PlaneModel;
use schemars::JsonSchema;
use serde::Deserialize;
use std::collections::BTreeMap;

mod boundary;
pub use boundary::*;
mod contact;
pub use contact::*;
mod field;
pub use field::*;
mod specimen;
pub use specimen::*;

/// A specimen in two dimensions: parts, contact, supports, steps (kind "pullout").
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[schemars(deny_unknown_fields)]
pub struct PulloutCase {
    /// "pullout".
    #[expect(dead_code, reason = "dispatched on before")]
    #[schemars(extend("const" = "pullout"))]
    pub kind: String,
    /// Title, text, files, curves.
    #[serde(flatten)]
    pub head: CaseHead,
    /// A specimen by its parameters, or a Gmsh file.
    pub mesh: MeshSource,
    /// The parts by name: those of the specimen, or the physical surfaces of the file.
    pub parts: BTreeMap<String, Part>,
    /// One object for all contact pairs of the specimen, or a list of pairs.
    pub contact: Option<Contact>,
    /// Nodes that are pulled; default: the specimen's.
    pub grip: Option<Grip>,
    /// Name of one of the specimen's ways to be held, or supports by name; default: the specimen's.
    pub supports: Option<Supports>,
    /// Loads by name; each is multiplied by its drive.
    pub loads: Option<BTreeMap<String, Load>>,
    /// Multi-point constraints and ties.
    pub couplings: Option<Vec<Coupling>>,
    /// Quantities that the history calls slip and load; default: the grip's, and the specimen's exit and tail.
    pub measure: Option<Measure>,
    /// Large displacements (default false).
    pub nlgeom: Option<bool>,
    /// A scalar at every node: a temperature, or the phase field of a law such as concrete_phase_field (default: none).
    pub field: Option<ScalarField>,
    /// Release of torn matter of laws with damage (default: none is released).
    pub spalling: Option<Spalling>,
    /// Fields, and how the run ends.
    #[serde(flatten)]
    pub course: Course,
    /// The state before the first step.
    pub initial: Option<PulloutInitial>,
    /// Steps that the specimen is taken through.
    #[schemars(length(min = 1))]
    pub steps: Vec<PulloutStep>,
    /// Settings of the output.
    pub output: Option<PulloutOutput>,
    /// Tolerances and limits.
    pub controls: Option<PulloutControls>,
    /// Work that the solver skips where a scene does not need it (default "all"; results agree within the tolerance of equilibrium).
    pub skip: Option<Skip>,
}

/// Criterion by which an element is torn matter: its forces fade, it is no longer part of its body and has no contact,
/// and the same goes for whatever is then attached to nothing. Contact moves to the surface behind it, which has friction and
/// no bond.
#[derive(Clone, Copy, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Spalling {
    /// Opening, mm, beyond which a crack releases its element, at all its points: greatest principal strain times the element's length. 10 G_f/f_t is
    /// where the falling branch has ended.
    pub opening: Positive,
    /// Stress, MPa, that no principal stress may exceed in magnitude at any of its points: 1 % of f_t.
    pub stress: Positive,
    /// Increase of the slip over which both must hold, mm (default 0.02).
    pub wait: Option<Positive>,
    /// Slip over which its forces fade, mm (default 0.02).
    pub fade: Option<Positive>,
}

/// A body, or a piece of one.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Part {
    /// The plugin and its parameters.
    pub material: Material,
    /// Assumption about the third direction; default: the specimen's, plane_strain for a file.
    pub model: Option<PlaneModel>,
    /// Reference thickness, mm, or the property of a round fibre's section that the thickness preserves; default: the
    /// specimen's, 1 for a file.
    pub thickness: Option<Thickness>,
    /// Integration of its elements; default: reduced for Q8, full for the others.
    pub integration: Option<Integration>,
    /// Large displacements of this part; default: the case's. A part that moves little against its size, as a block does
    /// around a fibre, is cheaper and safer without.
    pub nlgeom: Option<bool>,
    /// The state before the first step.
    pub initial: Option<PartInitial>,
    /// Of a fibre: the tensile strength of its wire, MPa, on the initial area. The run ends, with a warning, where the mean axial stress of
    /// a section reaches it (default: the wire does not break by stress).
    pub strength: Option<Positive>,
    /// Of a fibre: the elongation at which its wire breaks, 0.01 for 1 %, measured over 5 diameters; the run ends there as at the strength
    /// (default: the wire does not break by strain). Bending, over the exit or in a hook, does not count.
    pub elongation: Option<Positive>,
    /// Average the dilatation of its Q4 elements against locking (default true).
    pub average_dilatation: Option<bool>,
}

/// Initial state of a specimen.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct PulloutInitial {
    /// Values of the drives of loads at the start (default 0): the loads that the parts' initial stresses are in equilibrium
    /// with.
    pub drives: BTreeMap<String, f64>,
}

/// Initial state of the points of a part.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct PartInitial {
    /// Stress, MPa, the same at all points: in order (11, 22, 33, 12; without 33 in plane stress) or by name (s11, …).
    /// Default: the stress that the library's SIGINI sets, or 0. Whatever the supports do not hold moves before the
    /// first increment, until it is in equilibrium with the drives at their initial values.
    pub stress: Option<Components>,
}

/// A thickness.
#[derive(Clone, Copy, Debug, Deserialize, JsonSchema)]
#[serde(untagged)]
pub enum Thickness {
    /// mm.
    Value(Positive),
    /// Thickness of a plate as high as the round fibre.
    Section(Section),
}

/// Property that a plate as high as a round fibre shares with it.
#[derive(Clone, Copy, Debug, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Section {
    /// The area: thickness πφ/4.
    EqualArea,
    /// The second moment of area: thickness 3πφ/16.
    EqualInertia,
    /// Area and plastic moment, by layers: the inner half of the height is 1.023 φ thick, the outer 0.548 φ. The second moment of area is
    /// 1.03 times the round one. Takes an `elements_across` of 4 or 8.
    Layers,
}

/// A step: drives go to their ends, or a cycle of steps.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(untagged)]
pub enum PulloutStep {
    /// Steps run several times, in a member named "cycles".
    Cycles(Cycles<PulloutStep>),
    /// Steps run several times.
    Cycle(Cycle<PulloutStep>),
    /// Linear ramps to end values.
    Ramp(Box<PulloutRamp>),
}

/// A step in which drives go linearly to their end values.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[schemars(deny_unknown_fields)]
pub struct PulloutRamp {
    /// Displacement of the grip at the end of the step, mm.
    pub slip: Option<f64>,
    /// Values of other drives at the end of the step; what is not named stays.
    pub drives: Option<BTreeMap<String, f64>>,
    /// Duration, s (default 1).
    pub time: Option<Positive>,
    /// Conditions that end it early, and fields at its end.
    #[serde(flatten)]
    pub end: StepEnd,
    /// Sizes of automatic increments, or a number of equal ones.
    pub increments: Option<StepIncrements>,
}

/// Choice of the increments of a step.
#[derive(Clone, Copy, Debug, Deserialize, JsonSchema)]
#[serde(untagged)]
pub enum StepIncrements {
    /// Number of equal increments, cut back when one fails.
    Equal(Increments),
    /// Automatic.
    Automatic(AutomaticIncrements),
}

/// Automatic increments, as fractions of the step.
#[derive(Clone, Copy, Debug, Default, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct AutomaticIncrements {
    /// The first (default 1e-3).
    pub initial: Option<Fraction>,
    /// The greatest (default 0.02).
    pub maximum: Option<Fraction>,
    /// The least: below it the run fails (default 1e-8).
    pub minimum: Option<Fraction>,
}

/// Settings of the output.
#[derive(Clone, Debug, Default, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct PulloutOutput {
    /// Every n-th increment, and the last of each step, goes to history.csv (default 1).
    pub every: Option<Increments>,
    /// Draw plots (default true).
    pub plots: Option<bool>,
    /// Write fields for ParaView: never, at every 10th increment (true, the default), at every n-th; and at the end of
    /// each step.
    pub vtu: Option<Vtu>,
    /// Pictures, and fields unless there are none, also at these moments: as soon as the slip first reaches each of these, mm, or at
    /// these increments of the run. Beside those of the greatest load and of the end.
    pub pictures_at: Option<PicturesAt>,
    /// The elongation over 5 diameters beyond which a fibre without `strength` and `elongation` counts as ruptured: the summary gives the
    /// slip, and the run warns (default 0.03). Nothing else follows from it.
    pub rupture_strain: Option<Positive>,
}

/// Moments at which pictures are made.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(untagged)]
pub enum PicturesAt {
    /// Slips, mm.
    Slips(Vec<Positive>),
    /// Numbers of increments.
    Increments(IncrementNumbers),
}

/// Numbers of increments.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct IncrementNumbers {
    /// Counted from 1 over all steps.
    pub increments: Vec<Increments>,
}

/// Moments at which fields are written.
#[derive(Clone, Copy, Debug, Deserialize, JsonSchema)]
#[serde(untagged)]
pub enum Vtu {
    /// Never, or at every 10th increment.
    Switch(bool),
    /// At every n-th increment.
    Every(Increments),
}

/// Tolerances and limits.
#[derive(Clone, Debug, Default, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct PulloutControls {
    /// Residual force relative to the force scale (default 1e-6).
    pub force_tolerance: Option<Fraction>,
    /// Correction of displacements relative to the increment's (default 1e-5).
    pub displacement_tolerance: Option<Fraction>,
    /// Newton iterations of an attempt (default 20).
    pub max_iterations: Option<Whole<2, 1000>>,
    /// Attempts of one increment (default 30).
    pub max_cutbacks: Option<Whole<0, 1000>>,
    /// Shorten corrections that make the residual grow (default true).
    pub line_search: Option<bool>,
    /// Limit slips until the load has peaked, and locate the peak (default true).
    pub locate_peak: Option<bool>,
    /// Viscous stabilisation of the parts whose law may soften or has an unsymmetric tangent: relaxation time, s (default 0: none).
    #[schemars(range(min = 0.0))]
    pub relaxation_time: Option<f64>,
    /// The largest part of the work that stabilisation may have taken: beyond it the run fails at its end (default: none; a warning from 1 % on).
    pub max_stabilisation_share: Option<Fraction>,
}

/// Work that is skipped: everything, nothing, or everything but what is set to false.
#[derive(Clone, Copy, Debug, Deserialize, JsonSchema)]
#[serde(untagged)]
pub enum Skip {
    /// "all" or "none".
    Word(SkipWord),
    /// One by one.
    Items(SkipItems),
}

/// Everything or nothing.
#[derive(Clone, Copy, Debug, Deserialize, JsonSchema)]
#[serde(rename_all = "lowercase")]
pub enum SkipWord {
    /// Everything that can be.
    All,
    /// Nothing.
    None,
}

/// Work that is skipped, item by item (each true by default).
#[derive(Clone, Copy, Debug, Default, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct SkipItems {
    /// Stiffnesses of elements that did not change are kept.
    pub unchanged_elements: Option<bool>,
    /// Elements that stay elastic are condensed.
    pub elastic_far_field: Option<bool>,
    /// A factor is used again while it converges fast.
    pub factor_reuse: Option<bool>,
    /// A contact point looks for its edge from the last one.
    pub contact_search: Option<bool>,
    /// Has no effect any more; tangents are always asked for.
    pub unused_tangents: Option<bool>,
    /// Has no effect any more; the solver chooses.
    pub symmetric_solver: Option<bool>,
}
