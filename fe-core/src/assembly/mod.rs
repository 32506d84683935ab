//! From points to equations: solids evaluated element by element, constraints eliminated, blocks added to a pattern
//! that is found once.

mod block;
mod equations;
mod far_field;
pub mod loads;
pub mod solids;
mod system;
mod trouble;

pub use block::Blocks;
pub use equations::{ConstraintError, Equations};
pub use far_field::{may_be_condensed, touching};
pub use loads::loaded_freedoms;
pub use solids::{Solids, SolidsError};
pub use system::{Condensation, ElementStiffness, System, SystemState};
pub use trouble::{Place, Trouble};

/// No run counts calls, evaluations or factorisations so far: with more, counters could overflow.
pub const GREATEST_COUNT: u64 = 1 << 60;

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
