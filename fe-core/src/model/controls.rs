//! Steps and their increments, tolerances and what may be skipped.

use crate::schema::{fraction, positive, whole};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// A stretch of time in which the drives go to new values.
#[derive(Clone, Debug, PartialEq)]
pub struct Step {
    /// Duration, s.
    pub time: f64,
    /// Value of each drive at the end; `None`: stays.
    pub targets: Vec<Option<f64>>,
    /// Choice of the increments.
    pub control: StepControl,
}

/// Choice of the increments of a step. Sizes are fractions of the step.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum StepControl {
    /// Equal increments, cut back when one fails.
    Fixed {
        /// Number of increments.
        increments: usize,
    },
    /// Automatic increments; under a snap-back the drives follow the mean contact slip.
    Automatic {
        /// The first.
        initial: f64,
        /// The greatest.
        maximum: f64,
        /// The least: below it the run fails.
        minimum: f64,
    },
}

/// The increment over which points are asked to advance.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct IncrementContext {
    /// Step, from 1.
    pub step: u32,
    /// Increment in the step, from 1.
    pub increment: u32,
    /// Newton iteration, from 1.
    pub iteration: u32,
    /// Step time at the start of the increment, s.
    pub step_time: f64,
    /// Total time at the start of the increment, s.
    pub total_time: f64,
    /// Time increment, s.
    pub time_increment: f64,
}

impl IncrementContext {
    /// DTIME, s. Laws divide by it: what takes no time, as the equilibrium at the start, takes a moment for them.
    pub(crate) fn dtime(&self) -> f64 {
        if self.time_increment > 0.0 { self.time_increment } else { umat_abi::host::MOMENT }
    }
}

/// Tolerances and limits.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize, Serialize, JsonSchema)]
#[serde(default, deny_unknown_fields)]
#[schemars(rename = "PulloutControls")]
pub struct Controls {
    /// Residual force relative to the force scale.
    // the larger of reaction and internal forces
    #[schemars(schema_with = "fraction")]
    pub force_tolerance: f64,
    /// Correction of displacements relative to the increment's.
    #[schemars(schema_with = "fraction")]
    pub displacement_tolerance: f64,
    /// Newton iterations of an attempt.
    #[schemars(schema_with = "whole::<2, 1000>")]
    pub max_iterations: usize,
    /// Most cut-backs of an increment.
    #[schemars(schema_with = "whole::<0, 1000>")]
    pub max_cutbacks: usize,
    /// Shorten corrections that make the residual grow.
    pub line_search: bool,
    /// Limit slips until the load has peaked, and locate the peak.
    pub locate_peak: bool,
    /// Relaxation time of viscous stabilisation, s; 0 is none. It acts on parts whose law may soften or has an unsymmetric
    /// tangent.
    // their stress gets η/Δt C Δε, with the virgin moduli C, the time increment Δt and this relaxation time η: elements that fail at once do so
    // within a few η
    #[schemars(range(min = 0.0))]
    pub relaxation_time: f64,
    /// Largest share of the work that stabilisation may take. A run that exceeds it fails at its end (default: no
    /// limit, but a warning from 1 %).
    #[schemars(schema_with = "fraction")]
    pub max_stabilisation_share: Option<f64>,
    /// Criterion by which torn elements are released; `None`: none are.
    #[serde(skip)]
    pub spalling: Option<Spalling>,
}

/// Criterion for torn concrete. The forces of a torn element fade and its contact ends, as do those of everything that
/// it alone attached. Contact moves to the newly exposed surface, with friction but without bond.
// cracks close again under compression, so that damage alone does not show that an element carries no load: both conditions must hold at all its
// points
#[derive(Clone, Copy, Debug, PartialEq, Deserialize, Serialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Spalling {
    /// Crack opening, mm, that all points of a torn element exceed: largest principal strain times element length. At
    /// 10 G_f/f_t the softening branch has ended.
    #[schemars(schema_with = "positive")]
    pub opening: f64,
    /// Largest magnitude, MPa, of the principal stresses at all points of a torn element. Use about 1 % of f_t.
    #[schemars(schema_with = "positive")]
    pub stress: f64,
    /// Slip, mm, over which both conditions must hold.
    #[serde(default = "usual_slip")]
    #[schemars(schema_with = "positive")]
    pub wait: f64,
    /// Slip, mm, over which the forces of a torn element fade.
    #[serde(default = "usual_slip")]
    #[schemars(schema_with = "positive")]
    pub fade: f64,
}

fn usual_slip() -> f64 {
    0.02
}

impl Default for Controls {
    fn default() -> Self {
        Self {
            force_tolerance: 1e-6,
            displacement_tolerance: 1e-5,
            max_iterations: 20,
            max_cutbacks: 30,
            line_search: true,
            locate_peak: true,
            relaxation_time: 0.0,
            max_stabilisation_share: None,
            spalling: None,
        }
    }
}

/// Computations that are skipped if a model does not need them; each item can be switched off, for benchmarks and for checks.
/// None changes the result by more than the solver's tolerance.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize, Serialize, JsonSchema)]
#[serde(default)]
pub struct Skipping {
    /// Keep the stiffness of elements that did not change.
    pub unchanged_elements: bool,
    /// Condense elements that stay elastic.
    pub elastic_far_field: bool,
    /// Reuse a factorisation while iterations converge fast.
    pub factor_reuse: bool,
    /// Start the search for a contact point's edge at its last edge.
    pub contact_search: bool,
}

impl Skipping {
    /// All of them are skipped.
    pub const ALL: Self =
        Self { unchanged_elements: true, elastic_far_field: true, factor_reuse: true, contact_search: true };
    /// None is skipped.
    pub const NONE: Self =
        Self { unchanged_elements: false, elastic_far_field: false, factor_reuse: false, contact_search: false };
}

impl Default for Skipping {
    fn default() -> Self {
        Self::ALL
    }
}
