//! Runs along one trail that share factors: the first of them factorises in each round, and the factor goes round. Their states
//! differ by what their parameters do, and so a correction with the factor of another leaves as little as one with their own.

use super::Equilibrium;
use crate::assembly::Factor;
use crate::stepping::constants::SHARED_FACTORS;
use std::sync::mpsc::{self, Receiver, Sender};

/// A run's turn among those that share factors.
#[derive(Debug)]
pub(in crate::stepping) struct Turn {
    is_first: bool,
    from: Receiver<Handed>,
    to: Sender<Handed>,
}

/// A factor on its way, and the round that it is of.
#[derive(Default)]
pub(super) struct Handed {
    /// Step, increment and round.
    place: [u32; 3],
    factor: Option<Factor>,
    /// Whether it is that of a matrix.
    is_factor: bool,
    rounding: f64,
    /// Whether it is in the system of the run that has it, whose own factor is here.
    is_in_use: bool,
}

impl Turn {
    /// Returns the turns of runs. Each waits for the one before, so all are to be under way at once; where one ends early, the others
    /// make their own factors.
    pub(in crate::stepping) fn all(count: usize) -> Vec<Self> {
        let (mut to, from): (Vec<_>, Vec<_>) = (0..count).map(|_| mpsc::channel()).unzip();
        for first in to.iter().take(1) {
            (0..SHARED_FACTORS).for_each(|_| drop(first.send(Handed::default())));
        }
        to.rotate_left(count.min(1));
        (0..).zip(to.into_iter().zip(from)).map(|(k, (to, from))| Self { is_first: k == 0, from, to }).collect()
    }
}

impl Equilibrium<'_> {
    /// Waits for the factor of a round that begins, if runs share them.
    pub(super) fn take_turn(&mut self, place: [u32; 3]) {
        let Some(turn) = &self.company.turn else { return };
        let mut handed = self.company.handed.take();
        while handed.as_ref().is_none_or(|handed| !turn.is_first && handed.place < place) {
            // those of rounds that this run does not have
            handed.take().into_iter().for_each(|earlier| drop(turn.to.send(earlier)));
            handed = turn.from.recv().ok();
            if handed.is_none() {
                self.company.turn = None;
                return;
            }
        }
        let (system, memory) = (&mut self.system, &mut self.memory);
        if let Some(Handed { place: of, factor, is_factor, rounding, is_in_use }) = &mut handed {
            if turn.is_first {
                (*of, *is_factor) = (place, false);
                *factor = factor.take().filter(|factor| system.fits(factor)).or_else(|| Some(system.new_factor()));
            }
            if let Some(factor) = factor
                && *of == place
                && system.fits(factor)
            {
                system.exchange(factor);
                (memory.factorised, memory.factor_is_elsewhere, *is_in_use) = (*is_factor, false, true);
                memory.last_reduction = 0.0;
                if *is_factor {
                    memory.rounding = *rounding;
                }
            }
        }
        self.company.handed = handed;
    }

    /// Factorises for all at the beginning of a round, if this run is the first. Where that fails, it may not be needed.
    pub(super) fn factorise_for_all(&mut self) {
        let is_first = self.company.turn.as_ref().is_some_and(|turn| turn.is_first);
        if is_first && self.holds_factor() {
            drop(self.factorise());
        }
    }

    /// Returns whether the system has the factor of another run.
    pub(super) fn needs_no_tangents(&self) -> bool {
        self.holds_factor() && self.company.turn.as_ref().is_some_and(|turn| !turn.is_first)
    }

    /// Returns whether the system has a factor that goes round.
    fn holds_factor(&self) -> bool {
        self.company.handed.as_ref().is_some_and(|handed| handed.is_in_use)
    }

    /// Hands a factor that goes round on, and takes its own back.
    pub(super) fn hand_on(&mut self) {
        let Some(mut handed) = self.company.handed.take_if(|handed| handed.is_in_use) else { return };
        handed.factor.iter_mut().for_each(|factor| self.system.exchange(factor));
        (handed.is_factor, handed.is_in_use) = (self.memory.factorised, false);
        handed.rounding = self.memory.rounding;
        self.memory.factorised = false;
        if let Some(turn) = &self.company.turn {
            // where the next one has ended, nobody needs it
            drop(turn.to.send(handed));
        }
    }
}
