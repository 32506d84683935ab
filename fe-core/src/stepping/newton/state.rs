//! State that an equilibrium keeps between increments, as it is saved between runs.

use super::Equilibrium;
use super::drag::Drag;
use crate::assembly::solids::SolidsState;
use crate::assembly::{Equations, SystemState};
use crate::contact::ContactState;
use crate::model::{Model, ModelError};
use crate::solver::Blocks;
use crate::stepping::Statistics;
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
    /// Iterations of the last increment.
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
    pub(in crate::stepping) statistics: Statistics,
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

    /// Returns whether its arrays have the numbers of freedoms, rows and elements of this equilibrium.
    fn fits(&self, made: &Equilibrium<'_>) -> bool {
        let freedoms = made.memory.internal.len();
        [&self.internal, &self.contact_forces, &self.external].into_iter().all(|forces| forces.len() == freedoms)
            && self.residual.len() == made.system.row_count()
            && self.blocks.is_sound(freedoms)
            && self.drag.fits(freedoms)
            && self.fallen_back.iter().all(|&element| element < made.model.mesh.elements().len())
    }
}

/// The memory with states and the elements that iterate, and the matrix, which may be of an earlier increment. The factor
/// follows from the matrix. A checkpoint does not change a run, and one that is resumed goes on to the same bits.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct EquilibriumState {
    solids: SolidsState,
    contact: ContactState,
    system: SystemState,
    zone: Zone,
    pub(in crate::stepping) memory: Memory,
}

impl EquilibriumState {
    /// Returns whether a run can have come to its forces, scales and counts.
    pub(in crate::stepping) fn is_sound(&self) -> bool {
        let Memory { internal, contact_forces, external, residual, greatest_scale, rounding, last_move, .. } =
            &self.memory;
        let forces = [internal, contact_forces, external, residual].into_iter().flatten();
        forces.chain([greatest_scale, rounding, last_move]).all(|number| number.is_finite())
            && self.memory.statistics.is_sound()
    }
}

impl<'m> Equilibrium<'m> {
    /// Returns the memory at the end of an increment, for a checkpoint.
    pub(in crate::stepping) fn state(&self) -> EquilibriumState {
        EquilibriumState {
            solids: self.solids.state(),
            contact: self.contact.state(),
            system: self.system.state(),
            zone: self.zone.clone(),
            memory: self.memory.clone(),
        }
    }

    /// Makes an equilibrium of a model with this memory.
    ///
    /// # Errors
    ///
    /// Those of [`Self::new`], and a state of another model.
    pub(in crate::stepping) fn with_state(model: &'m Model, state: &EquilibriumState) -> Result<Self, ModelError> {
        let mut made = Self::new(model, Equations::new(model)?)?;
        if !state.zone.may_follow(&made.zone) {
            return Err(foreign_state());
        }
        if made.zone != state.zone {
            // the solids are virgin still: what is condensed is elastic, and was so
            made.set_zone(state.zone.clone()).map_err(|error| ModelError(error.to_string()))?;
        }
        let fits = state.memory.fits(&made)
            && made.solids.set_state(&state.solids)
            && made.contact.set_state(&state.contact, model)
            && made.system.set_state(&state.system);
        if !fits {
            return Err(foreign_state());
        }
        made.memory = state.memory.clone();
        Ok(made)
    }
}

/// The checkpoint is of another model, or no run has made it.
pub(in crate::stepping) fn foreign_state() -> ModelError {
    ModelError("the states to go on from are those of another model".into())
}
