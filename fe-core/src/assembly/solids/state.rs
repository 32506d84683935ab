//! The states of all points, as they are kept between runs.

use super::block::ElementBlock;
use super::points::States;
use super::record::{Built, ElementData};
use super::trust::Trust;
use super::{Counters, Solids};
use crate::assembly::GREATEST_COUNT;
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

impl Built {
    fn fits(&self, record: &ElementData, version: u64) -> bool {
        self.version <= version && self.spalled.as_ref().is_none_or(|spalled| spalled.fits(record.nodes().len()))
    }
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

    fn fits(&self, block: &ElementBlock, version: u64) -> bool {
        let Self { points, trial, moduli, displacements, stiffnesses, built } = self;
        let mut numbers =
            moduli.as_flattened().as_flattened().iter().chain(stiffnesses).chain(displacements.as_flattened());
        displacements.len() == block.committed.len()
            && moduli.len() == block.body.points.moduli.len()
            && stiffnesses.len() == block.stiffnesses.len()
            && built.len() == block.records.len()
            && built.iter().zip(&block.records).all(|(built, record)| built.fits(record, version))
            && numbers.all(|number| number.is_finite())
            && points.fits(&block.body.points.committed)
            && trial.fits(&block.body.points.trial)
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

    /// Takes over committed states and stiffnesses; `false`, and nothing done, if they are of other solids.
    #[must_use]
    pub(crate) fn set_state(&mut self, state: &SolidsState) -> bool {
        let state_version = state.version;
        let mut pairs = self.blocks.iter().zip(&state.blocks);
        let fits = self.blocks.len() == state.blocks.len()
            && pairs.all(|(block, state)| state.fits(block, state_version))
            && state_version < GREATEST_COUNT
            && state.counters.counts_on()
            && self.may_trust(&state.trust);
        if fits {
            for (block, state) in self.blocks.iter_mut().zip(&state.blocks) {
                state.give_to(block);
            }
            self.version = state_version;
            // what was done to get here has been counted before
            self.earlier = state.counters;
            self.take_trust(&state.trust);
        }
        fits
    }
}
