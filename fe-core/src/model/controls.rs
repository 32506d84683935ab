//! Steps and their increments, tolerances and what may be skipped.

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
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Controls {
    /// Residual force, relative to the larger of reaction and internal force scale.
    pub force_tolerance: f64,
    /// Correction of displacements, relative to the increment's.
    pub displacement_tolerance: f64,
    /// Newton iterations of an attempt.
    pub max_iterations: usize,
    /// Attempts of one increment that may be given up before the run is.
    pub max_cutbacks: usize,
    /// Whether a correction that makes the residual grow is shortened.
    pub line_search: bool,
    /// Whether slips of bonded points limit the increments until the load has peaked, and the peak is located.
    pub locate_peak: bool,
    /// Viscous stabilisation of the parts whose law may soften or has an unsymmetric tangent: their stress gets
    /// η/Δt C Δε, with the virgin moduli C, the time increment Δt and this relaxation time η, s. Elements that fail at
    /// once do so within a few η. 0: none.
    pub relaxation_time: f64,
    /// The largest part of the work that stabilisation and overstress may have taken when a run ends: beyond it the run
    /// has failed.
    pub max_stabilisation_share: f64,
    /// Criterion by which torn elements are released; `None`: none are.
    pub spalling: Option<Spalling>,
}

/// Criterion by which an element of a law with damage counts as torn and is released: its nodal forces fade, and it is no
/// longer part of its body, nor are elements that are then held by nothing. Since cracks close again under compression, damage
/// alone does not show that an element carries no load: both conditions must hold at all its points.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Spalling {
    /// Crack opening that must be exceeded: greatest principal strain × CELENT, mm; a softening branch has ended at 10 G_f/f_t.
    pub opening: f64,
    /// Largest magnitude of the principal stresses, MPa.
    pub stress: f64,
    /// Growth of the measured slip before it is released, mm.
    pub wait: f64,
    /// Slip over which its forces then fade linearly, mm.
    pub fade: f64,
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
            max_stabilisation_share: f64::INFINITY,
            spalling: None,
        }
    }
}

/// Computations that are skipped if a model does not need them; each item can be switched off, for benchmarks and for checks.
/// None changes the result by more than the solver's tolerance.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Skipping {
    /// Stiffnesses of elements whose tangents and geometry did not change are kept, and what only they are factorised to.
    pub unchanged_elements: bool,
    /// Elements that stay elastic are condensed onto the zone that does not.
    pub elastic_far_field: bool,
    /// A factor is used again while it still converges fast.
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
