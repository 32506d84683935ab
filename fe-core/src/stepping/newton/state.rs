//! What an equilibrium remembers between increments, as it is kept between runs.

use super::{Equilibrium, coupled_freedoms};
use crate::assembly::solids::SolidsState;
use crate::assembly::{Blocks, Equations, SystemState};
use crate::contact::ContactState;
use crate::model::Model;
use crate::stepping::ModelError;
use crate::stepping::zone::Zone;
use serde::{Deserialize, Serialize};

/// States, the elements that iterate, the scales that tolerances are relative to, and what the next increment begins with:
/// the last evaluation, stiffnesses and the matrix, which may be of an earlier increment. The factor follows from the
/// matrix. A checkpoint does not change a run, and one that is resumed goes on to the same bits.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct EquilibriumState {
    solids: SolidsState,
    contact: ContactState,
    system: SystemState,
    zone: Zone,
    greatest_scale: f64,
    rounding: f64,
    last_move: f64,
    last_iterations: usize,
    last_reduction: f64,
    assembled_version: u64,
    factorised: bool,
    factor_is_elsewhere: bool,
    has_tangents: bool,
    at_committed_state: bool,
    fallen_back: Vec<usize>,
    /// Internal, contact and external forces of the last evaluation, and what is left of them by rows.
    forces: [Vec<f64>; 3],
    residual: Vec<f64>,
    blocks: Blocks,
}

impl EquilibriumState {
    /// Whether the scales are numbers.
    pub(in crate::stepping) fn is_finite(&self) -> bool {
        let scales = [self.greatest_scale, self.rounding, self.last_move];
        scales
            .into_iter()
            .chain(self.forces.iter().flatten().copied())
            .chain(self.residual.iter().copied())
            .all(f64::is_finite)
    }

    /// Whether what it has of freedoms, rows and elements is of this equilibrium.
    fn fits(&self, made: &Equilibrium<'_>) -> bool {
        let freedoms = made.internal.len();
        self.forces.iter().all(|forces| forces.len() == freedoms)
            && self.residual.len() == made.system.row_count()
            && self.blocks.is_sound(freedoms)
            && self.fallen_back.iter().all(|&element| element < made.model.mesh.elements().len())
    }
}

impl<'m> Equilibrium<'m> {
    /// What it remembers at the end of an increment.
    pub(in crate::stepping) fn state(&self) -> EquilibriumState {
        EquilibriumState {
            solids: self.solids.state(),
            contact: self.contact.state(),
            zone: self.zone.clone(),
            greatest_scale: self.greatest_scale,
            rounding: self.rounding,
            last_move: self.last_move,
            last_iterations: self.last_iterations,
            system: self.system.state(),
            last_reduction: self.last_reduction,
            assembled_version: self.assembled_version,
            factorised: self.factorised,
            factor_is_elsewhere: self.factor_is_elsewhere,
            has_tangents: self.has_tangents,
            at_committed_state: self.at_committed_state,
            fallen_back: self.fallen_back.clone(),
            forces: [&self.internal, &self.contact_forces, &self.external].map(Vec::clone),
            residual: self.residual.clone(),
            blocks: self.blocks.clone(),
        }
    }

    /// An equilibrium of a model with this memory.
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
            made.zone = state.zone.clone();
            let equations = made.system.equations().clone();
            made.system = made.zone.system(model, equations, &coupled_freedoms(model, &made.contact), &made.solids)?;
            made.solids.set_active(made.zone.active());
        }
        let fits = state.fits(&made)
            && made.solids.set_state(&state.solids)
            && made.contact.set_state(&state.contact)
            && made.system.set_state(&state.system);
        if !fits {
            return Err(foreign_state());
        }
        [made.internal, made.contact_forces, made.external] = state.forces.clone();
        made.residual.clone_from(&state.residual);
        made.blocks.clone_from(&state.blocks);
        made.fallen_back.clone_from(&state.fallen_back);
        (made.factorised, made.assembled_version) = (state.factorised, state.assembled_version);
        made.factor_is_elsewhere = state.factor_is_elsewhere;
        (made.has_tangents, made.at_committed_state) = (state.has_tangents, state.at_committed_state);
        made.last_reduction = state.last_reduction;
        made.greatest_scale = state.greatest_scale;
        made.rounding = state.rounding;
        made.last_move = state.last_move;
        made.last_iterations = state.last_iterations;
        Ok(made)
    }
}

/// A checkpoint of another model, or one that no run has made.
pub(in crate::stepping) fn foreign_state() -> ModelError {
    ModelError::Inconsistent("the states to go on from are those of another model".into())
}
