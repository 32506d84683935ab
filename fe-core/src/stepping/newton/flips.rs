//! What takes another branch from iteration to iteration, for those who ask where iterations go.

use super::Equilibrium;
use crate::assembly::solids::Branch;
use crate::contact::PointStatus;
use serde::{Deserialize, Serialize};

/// Numbers of points that took another branch in the evaluation of an iteration than in the one before.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct Flips {
    /// Contact points that opened, closed, came over an end of the master or went past it.
    pub opened: usize,
    /// Contact points that began to slip or to stick.
    pub slid: usize,
    /// Contact points that began to press or to pull: friction follows the pressure alone.
    pub pressed: usize,
    /// Damaged points a principal stress of which changed its sign: cracks that closed or opened.
    pub cracked: usize,
    /// Points of laws without damage that began to flow in the increment or ceased to.
    pub flowed: usize,
}

/// Branches of all points: at the end of the last increment, and at the last iteration.
#[derive(Debug, Default)]
pub(super) struct Watch {
    committed: Branches,
    last: Branches,
}

/// Branches of all points at an evaluation.
#[derive(Clone, Debug, Default)]
struct Branches {
    /// Status, and whether the point presses.
    contact: Vec<(PointStatus, bool)>,
    solids: Vec<Branch>,
}

impl Branches {
    fn flips_to(&self, after: &Self) -> Flips {
        let mut flips = Flips::default();
        let transmits = |status: PointStatus| matches!(status, PointStatus::Sticking | PointStatus::Slipping);
        for (&before, &after) in self.contact.iter().zip(&after.contact).filter(|(before, after)| before != after) {
            let counted = match (before.0, after.0) {
                (before, after) if before == after => &mut flips.pressed,
                (before, after) if transmits(before) && transmits(after) => &mut flips.slid,
                _ => &mut flips.opened,
            };
            *counted += 1;
        }
        for (before, after) in self.solids.iter().zip(&after.solids).filter(|(before, after)| before != after) {
            match (before, after) {
                (Branch::Flows(_), Branch::Flows(_)) => flips.flowed += 1,
                _ => flips.cracked += 1,
            }
        }
        flips
    }
}

impl Equilibrium<'_> {
    /// Counts flips from now on.
    pub(in crate::stepping) fn watch_flips(&mut self) {
        self.observed.watch = Some(Box::default());
    }

    /// An attempt begins: its first iteration predicts with the branches of the last increment.
    pub(super) fn begin_flips(&mut self) {
        if let Some(watch) = &mut self.observed.watch {
            watch.last.clone_from(&watch.committed);
        }
    }

    /// The last attempt is accepted.
    pub(super) fn commit_flips(&mut self) {
        if let Some(watch) = &mut self.observed.watch {
            watch.committed.clone_from(&watch.last);
        }
    }

    /// Returns the flips since the last call; none where nobody watches.
    pub(super) fn flips(&mut self) -> Flips {
        let Some(watch) = &mut self.observed.watch else { return Flips::default() };
        let contact = self.contact.points().map(|point| (point.status, point.pressure > 0.0)).collect();
        let after = Branches { contact, solids: self.solids.branches().collect() };
        let flips = watch.last.flips_to(&after);
        watch.last = after;
        flips
    }
}
