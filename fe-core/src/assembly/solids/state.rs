//! The states of all points, as they are kept between runs.

use super::block::Block;
use super::points::States;
use super::trust::Trust;
use super::{Counters, Solids};
use serde::{Deserialize, Serialize};

/// The committed states of all points, and the displacements that they belong to.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct SolidsState {
    blocks: Vec<BlockState>,
    counters: Counters,
    trust: Vec<Trust>,
}

#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
struct BlockState {
    points: States,
    displacements: Vec<[f64; 2]>,
}

impl BlockState {
    fn of(block: &Block) -> Self {
        Self { points: block.body.points.committed.clone(), displacements: block.committed.clone() }
    }

    fn fits(&self, block: &Block) -> bool {
        self.displacements.len() == block.committed.len()
            && self.displacements.iter().flatten().all(|number| number.is_finite())
            && self.points.fits(&block.body.points.committed)
    }
}

impl Solids {
    /// The committed states.
    pub fn state(&self) -> SolidsState {
        let blocks = self.blocks.iter().map(BlockState::of).collect();
        SolidsState { blocks, counters: self.counters(), trust: self.present_trust() }
    }

    /// Takes over committed states; `false`, and nothing done, if they are of other solids. Stiffnesses stay until the
    /// next evaluation.
    #[must_use]
    pub fn set_state(&mut self, state: &SolidsState) -> bool {
        let mut pairs = self.blocks.iter().zip(&state.blocks);
        let fits = self.blocks.len() == state.blocks.len()
            && pairs.all(|(block, state)| state.fits(block))
            && state.counters.counts_on()
            && self.may_trust(&state.trust);
        if fits {
            for (block, state) in self.blocks.iter_mut().zip(&state.blocks) {
                block.body.points.committed.clone_from(&state.points);
                block.body.points.trial.clone_from(&state.points);
                block.committed.copy_from_slice(&state.displacements);
                block.forget();
            }
            self.earlier += state.counters;
            self.take_trust(&state.trust);
        }
        fits
    }
}
