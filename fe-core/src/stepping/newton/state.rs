//! State that an equilibrium keeps between increments, as it is saved between runs.

use super::Equilibrium;
use super::drag::Drag;
use crate::assembly::solids::SolidsState;
use crate::assembly::{Equations, SystemState};
use crate::contact::ContactState;
use crate::field::{Field, FieldState};
use crate::model::{Model, ModelError};
use crate::solver::{Blocks, SolverError};
use crate::stepping::AnalysisStatistics;
use crate::stepping::zone::Zone;
use serde::{Deserialize, Serialize};

/// Memory with which the next increment begins: the last evaluation, the findings on tangents and factors, and the scales that
/// tolerances are relative to.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
pub(in crate::stepping) struct Memory {
    pub(super) internal: Vec<f64>,
    pub(super) contact_forces: Vec<f64>,
    pub(super) external: Vec<f64>,
    /// Residual forces by rows of the equations, N.
    pub(in crate::stepping) residual: Vec<f64>,
    pub(in crate::stepping) blocks: Blocks,
    /// Whether a factor of the present pattern exists.
    pub(super) factorised: bool,
    /// Whether its tangents are of contact laws that were called elsewhere than at their gaps.
    pub(super) factor_is_elsewhere: bool,
    /// Stiffnesses of the solids that are in the matrix.
    pub(super) assembled_version: u64,
    /// Whether the tangents of the last evaluation may be used.
    pub(super) has_tangents: bool,
    /// Factor by which the last correction multiplied the residual.
    pub(super) last_reduction: f64,
    /// Iterations of the hardest round of the last increment.
    pub(super) last_iterations: usize,
    /// Whether the last evaluation is of the committed state, with the tangents that led there.
    pub(super) at_committed_state: bool,
    pub(super) drag: Drag,
    /// The largest force scale of an accepted increment.
    pub(super) greatest_scale: f64,
    /// Elements whose stiffness is not the consistent one.
    pub(super) fallen_back: Vec<usize>,
    /// Forces that rounding of positions makes of the largest stiffness, N.
    pub(in crate::stepping) rounding: f64,
    /// The largest change of a displacement in the last increment, mm.
    pub(super) last_move: f64,
    pub(in crate::stepping) statistics: AnalysisStatistics,
}

impl Memory {
    pub(super) fn new(freedoms: usize) -> Self {
        let zero = vec![0.0; freedoms];
        Self {
            internal: zero.clone(),
            contact_forces: zero.clone(),
            external: zero,
            last_reduction: 1.0,
            ..Self::default()
        }
    }

    /// Returns external less internal forces.
    pub(super) fn unbalanced(&self) -> Vec<f64> {
        self.external.iter().zip(&self.internal).map(|(e, i)| e - i).collect()
    }
}

/// The memory with states and the elements that iterate, and the matrix, which may be of an earlier increment. The factor
/// follows from the matrix. A checkpoint does not change a run, and one that is resumed goes on to the same bits.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct EquilibriumState {
    solids: SolidsState,
    contact: ContactState,
    field: Option<FieldState>,
    system: SystemState,
    zone: Zone,
    pub(in crate::stepping) memory: Memory,
}

impl<'m> Equilibrium<'m> {
    /// Returns the memory at the end of an increment, for a checkpoint.
    pub(in crate::stepping) fn state(&self) -> EquilibriumState {
        EquilibriumState {
            solids: self.solids.state(),
            contact: self.contact.state(),
            field: self.field.as_ref().map(Field::state),
            system: self.system.state(),
            zone: self.zone.clone(),
            memory: self.memory.clone(),
        }
    }

    /// Makes an equilibrium of a model with this memory, which one of the same model left.
    ///
    /// # Errors
    ///
    /// Those of [`Self::new`], and a matrix without a factor.
    pub(in crate::stepping) fn with_state(model: &'m Model, state: &EquilibriumState) -> Result<Self, ModelError> {
        let no_factor = |error: SolverError| ModelError(error.to_string());
        let mut made = Self::new(model, Equations::new(model)?)?;
        if made.zone != state.zone {
            // the solids are virgin still: what is condensed is elastic, and was so
            made.set_zone(state.zone.clone()).map_err(no_factor)?;
        }
        made.solids.set_state(&state.solids);
        made.contact.set_state(&state.contact, model)?;
        if let (Some(field), Some(state)) = (&mut made.field, &state.field) {
            field.set_state(state, &mut made.solids);
        }
        made.system.set_state(&state.system).map_err(no_factor)?;
        made.memory = state.memory.clone();
        Ok(made)
    }
}
