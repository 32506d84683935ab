//! Changes after Newton has converged: points that open, multipliers that grow.

use super::Contact;
use super::law::PointLaw;
use super::pair::Pair;
use crate::model::Enforcement;

/// The part of the points over the tension cap that open at a time.
const OPENING_SHARE: f64 = 0.1;

/// Changes made by [`Contact::settle`].
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Settlement {
    /// Whether the increment must be iterated again, at the same load.
    pub again: bool,
    /// Points that opened for good.
    pub opened: usize,
    /// Largest |g_N| of points held under Uzawa's rule, mm.
    pub worst_gap: f64,
}

impl Contact {
    /// Settles a converged increment; to be called until it asks for no more iterations. Opens at most a tenth, and
    /// at least one, of the points whose tension is over the cap of the host's hard law; if there are none, updates
    /// the multipliers of pairs with a held point whose gap is over the tolerance.
    pub fn settle(&mut self) -> Settlement {
        let mut settlement = Settlement { opened: open_worst(&mut self.pairs), ..Settlement::default() };
        let mut wanting = Vec::new();
        for (index, pair) in self.pairs.iter().enumerate() {
            let Enforcement::Uzawa { tolerance, max_updates } = pair.enforcement else { continue };
            let held = pair.trial.points.iter().filter(|state| state.held);
            let gap = held.fold(0.0, |worst: f64, state| worst.max(state.gap.abs()));
            settlement.worst_gap = settlement.worst_gap.max(gap);
            if gap > tolerance && self.updates < max_updates {
                wanting.push(index);
            }
        }
        let mut updated = 0;
        if settlement.opened == 0 && !wanting.is_empty() {
            self.updates += 1;
            updated = wanting.iter().map(|&index| update_multipliers(&mut self.pairs[index])).sum();
        }
        settlement.again = settlement.opened > 0 || updated > 0;
        settlement
    }
}

/// Latches the points that are furthest over the cap; how many.
fn open_worst(pairs: &mut [Pair]) -> usize {
    let mut over = Vec::new();
    for (index, pair) in pairs.iter().enumerate() {
        let PointLaw::Fric { normal, .. } = &pair.law else { continue };
        for (point, state) in pair.trial.points.iter().enumerate() {
            if let Some(excess) = normal.excess(state.pressure, &state.normal) {
                over.push((excess, index, point));
            }
        }
    }
    over.sort_by(|a, b| b.0.total_cmp(&a.0));
    let share = (OPENING_SHARE * over.len() as f64).floor() as usize;
    let count = share.max(1).min(over.len());
    for &(_, pair, point) in &over[..count] {
        let normal = &mut pairs[pair].trial.points[point].normal;
        (normal.latched, normal.multiplier) = (true, 0.0);
    }
    count
}

/// λ ← p of held points, and of those that were held and are capped or open now.
fn update_multipliers(pair: &mut Pair) -> usize {
    let mut updated = 0;
    for state in &mut pair.trial.points {
        if (state.held || state.normal.multiplier != 0.0) && state.normal.multiplier != state.pressure {
            state.normal.multiplier = state.pressure;
            updated += 1;
        }
    }
    updated
}
