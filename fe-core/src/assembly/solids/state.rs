//! The states of all points, as they are kept between runs.

use super::block::ElementBlock;
use super::points::States;
use super::record::Built;
use super::trust::Trust;
use super::{Counters, Solids};
use crate::kinematics::finite::Moduli;
use serde::{Deserialize, Serialize};

/// The committed states of all points with the displacements that they belong to, and the stiffnesses, which may be those
/// of an earlier increment.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct SolidsState {
    blocks: Vec<BlockState>,
    version: u64,
    counters: Counters,
    trust: Vec<Trust>,
}

#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
struct BlockState {
    points: States,
    trial: States,
    moduli: Vec<Moduli>,
    displacements: Vec<[f64; 2]>,
    stiffnesses: Vec<f64>,
    built: Vec<Built>,
}

impl BlockState {
    fn of(block: &ElementBlock) -> Self {
        let points = &block.body.points;
        Self {
            points: points.committed.clone(),
            trial: points.trial.clone(),
            moduli: points.moduli.clone(),
            displacements: block.committed.clone(),
            stiffnesses: block.stiffnesses.clone(),
            built: block.records.iter().map(|record| record.built.clone()).collect(),
        }
    }

    fn give_to(&self, block: &mut ElementBlock) {
        block.body.points.committed.clone_from(&self.points);
        block.body.points.trial.clone_from(&self.trial);
        block.body.points.moduli.clone_from(&self.moduli);
        block.committed.copy_from_slice(&self.displacements);
        block.stiffnesses.copy_from_slice(&self.stiffnesses);
        for (record, built) in block.records.iter_mut().zip(&self.built) {
            record.built.clone_from(built);
        }
        block.unsymmetric = self.built.iter().filter(|built| built.is_unsymmetric).count();
        (block.counters, block.body.points.calls) = (Counters::default(), 0);
        block.forget();
    }
}

impl Solids {
    /// The committed states and the stiffnesses.
    pub fn state(&self) -> SolidsState {
        let blocks = self.blocks.iter().map(BlockState::of).collect();
        SolidsState { blocks, version: self.version, counters: self.counters(), trust: self.present_trust() }
    }

    /// Takes over committed states and stiffnesses of the same solids.
    pub(crate) fn set_state(&mut self, state: &SolidsState) {
        for (block, state) in self.blocks.iter_mut().zip(&state.blocks) {
            state.give_to(block);
        }
        self.version = state.version;
        // what was done to get here has been counted before
        self.earlier = state.counters;
        self.take_trust(&state.trust);
    }
}
