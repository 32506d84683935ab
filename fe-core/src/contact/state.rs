//! The history of all points, as it is kept between runs.

use super::Contact;
use super::history::History;
use crate::assembly::GREATEST_COUNT;
use serde::{Deserialize, Serialize};

/// The committed history of all pairs.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct ContactState {
    histories: Vec<History>,
    law_calls: u64,
}

impl Contact {
    /// The committed history.
    pub fn state(&self) -> ContactState {
        let histories = self.pairs.iter().map(|pair| pair.committed.clone()).collect();
        ContactState { histories, law_calls: self.law_calls() }
    }

    /// Takes over a committed history; `false`, and nothing done, if it is of other pairs.
    #[must_use]
    pub fn set_state(&mut self, state: &ContactState) -> bool {
        let fits = self.pairs.len() == state.histories.len()
            && state.law_calls < GREATEST_COUNT
            && self.pairs.iter().zip(&state.histories).all(|(pair, history)| pair.committed.fits(history));
        if fits {
            for (pair, history) in self.pairs.iter_mut().zip(&state.histories) {
                pair.committed.copy_from(history);
            }
            self.restore();
            self.earlier_calls += state.law_calls;
        }
        fits
    }
}
