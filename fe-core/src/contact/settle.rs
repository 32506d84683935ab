//! Changes after Newton has converged: points that open, multipliers that grow.

use super::Contact;
use super::history::PointState;
use super::law::PointLaw;
use super::pair::Pair;
use crate::model::Enforcement;

/// The part of the points over the tension cap that open at a time.
const OPENING_SHARE: f64 = 0.1;
/// Kinds of updates of multipliers.
const AT_BALANCE: usize = 0;
const BETWEEN: usize = 1;

impl Contact {
    /// Settles a converged increment, and returns whether it must be iterated again at the same load; to be called until
    /// it need not. Opens at most a tenth, and at least one, of the points whose tension is over the cap of the host's
    /// hard law; if there are none, updates the multipliers of pairs with a held point whose gap is over the tolerance.
    pub fn settle(&mut self) -> bool {
        if open_worst(&mut self.pairs) > 0 {
            return true;
        }
        self.update(AT_BALANCE)
    }

    /// Returns whether there are multipliers to update between iterations: those of pairs with a held point whose gap is over the tolerance.
    pub(crate) fn wants_multipliers(&self) -> bool {
        self.pairs.iter().any(|pair| wants_update(pair, self.updates[BETWEEN]))
    }

    /// Updates these multipliers by the pressures of the last evaluation, and returns whether any has changed.
    pub(crate) fn update_multipliers(&mut self) -> bool {
        self.update(BETWEEN)
    }

    /// Each kind of updates has its own count: those between iterations must not use up those at balance, after which a gap is accepted.
    fn update(&mut self, kind: usize) -> bool {
        let updates = self.updates[kind];
        let wanting: Vec<&mut Pair> = self.pairs.iter_mut().filter(|pair| wants_update(pair, updates)).collect();
        self.updates[kind] += usize::from(!wanting.is_empty());
        wanting.into_iter().map(update_multipliers).sum::<usize>() > 0
    }
}

/// Returns whether a pair has a held point whose gap is over the tolerance of Uzawa's rule, after so many updates.
fn wants_update(pair: &Pair, updates: usize) -> bool {
    let Enforcement::Uzawa { tolerance, max_updates } = pair.enforcement else { return false };
    let over = |state: &PointState| state.held && !state.comes_in() && (state.gap + state.crushing).abs() > tolerance;
    updates < max_updates && pair.state.trial.points.iter().any(over)
}

/// Latches the points that are furthest over the cap; how many.
fn open_worst(pairs: &mut [Pair]) -> usize {
    let mut over = Vec::new();
    for (index, pair) in pairs.iter().enumerate() {
        let PointLaw::Fric { normal, .. } = &pair.law else { continue };
        for (point, state) in pair.state.trial.points.iter().enumerate() {
            if let Some(excess) = normal.excess(state.pressure, &state.normal) {
                over.push((excess, index, point));
            }
        }
    }
    over.sort_by(|a, b| b.0.total_cmp(&a.0));
    let share = (OPENING_SHARE * over.len() as f64).floor() as usize;
    let count = share.max(1).min(over.len());
    for &(_, pair, point) in &over[..count] {
        let normal = &mut pairs[pair].state.trial.points[point].normal;
        (normal.latched, normal.multiplier) = (true, 0.0);
    }
    count
}

/// λ ← p of held points, and of those that were held and are capped or open now.
fn update_multipliers(pair: &mut Pair) -> usize {
    let mut updated = 0;
    for state in pair.state.trial.points.iter_mut().filter(|state| !state.comes_in()) {
        if (state.held || state.normal.multiplier != 0.0) && state.normal.multiplier != state.pressure {
            state.normal.multiplier = state.pressure;
            updated += 1;
        }
    }
    updated
}
