//! The least root m ≥ 1 of M(m) − m (doc.md).
//!
//! M is continuous but neither monotone nor smooth. So the pieces between its kinks are scanned for the first change of
//! sign. The valleys between nodes are searched for their bottoms as well, since two close roots leave no change of
//! sign between nodes.

use crate::roots::{Root, bracketed};

/// Cells of each piece, equal in ln m.
const CELLS: u32 = 16;
/// A residual this small at a kink is a root: there the residual may only touch zero, and rounding decides
/// on which side it passes. Uniaxial stress is one such point, a committed state met again another.
const TOUCHING: f64 = 64.0 * f64::EPSILON;
/// Part of a valley that a step of its search leaves aside: the golden section.
const SECTION: f64 = 0.381_966_011_250_105_1;
/// Width, relative to m, below which the residual can no longer locate the bottom of a valley.
const BOTTOM: f64 = 1.5e-8;
/// Equation M(m) = m that the search samples.
pub(super) trait Equation {
    /// All that is known at one m.
    type Sample: Copy;
    /// Evaluates at m.
    fn sample(&self, m: f64) -> Self::Sample;
    /// M(m) − m.
    fn residual(sample: &Self::Sample) -> f64;
    /// Quantities whose falling through 0 kinks M upwards.
    fn kinks(&self, sample: &Self::Sample) -> [f64; 2];
    /// Returns true only if M > m everywhere between two samples of one piece.
    fn excluded(&self, start: &Self::Sample, end: (f64, &Self::Sample)) -> bool;
}

/// The least root in [1, upper] of a residual that is > 0 at 1, where the sample is `first`, and ≤ 0 at
/// `upper`.
///
/// `break_points` lie inside, in ascending order. `None` if no sign changes.
#[inline]
pub(super) fn least_root<E: Equation>(
    equation: &E,
    first: E::Sample,
    break_points: &[f64],
    upper: f64,
) -> Option<Root> {
    let mut start = (1.0, first);
    // the node before, and its residual
    let mut before = (1.0, E::residual(&first));
    for &end in break_points.iter().chain([&upper]) {
        let last = (end, equation.sample(end));
        if !equation.excluded(&start.1, (end, &last.1)) {
            let cell_ratio = |from: f64| ((end / from).ln() / f64::from(CELLS)).exp();
            let mut lower = start;
            if lower.0 == 1.0 {
                match near_onset(equation, lower, cell_ratio(1.0)) {
                    Ok(root) => return Some(root),
                    Err(reached) => lower = reached,
                }
            }
            let ratio = cell_ratio(lower.0);
            for cell in 1..=CELLS {
                let m = lower.0 * ratio;
                let next = if cell == CELLS { last } else { (m, equation.sample(m)) };
                if let Some(root) = root_of_cell(equation, lower, next) {
                    return Some(root);
                }
                let ends = [E::residual(&lower.1), E::residual(&next.1)];
                if before.1 > ends[0]
                    && ends[1] > ends[0]
                    && let Some(root) = root_of_valley(equation, before, (lower.0, ends[0]), next.0)
                {
                    return Some(root);
                }
                before = (lower.0, ends[0]);
                lower = next;
            }
            let residual = E::residual(&last.1);
            if residual <= TOUCHING * end {
                return Some(Root::exact(end, residual));
            }
        }
        if start.0 > before.0 {
            before = (start.0, E::residual(&start.1));
        }
        start = last;
    }
    None
}

/// Just after onset the root is as near to 1 as M(1) is, and another root may follow within the first cell:
/// nodes at 1 + 2 (M(1) − 1), then four times as far each. `Err` is the last of them before `limit`.
#[inline]
fn near_onset<E: Equation>(equation: &E, first: (f64, E::Sample), limit: f64) -> Result<Root, (f64, E::Sample)> {
    let mut lower = first;
    let mut distance = 2.0 * E::residual(&first.1);
    while 1.0 + distance < limit && distance > 0.0 {
        let next = (1.0 + distance, equation.sample(1.0 + distance));
        if let Some(root) = root_of_cell(equation, lower, next) {
            return Ok(root);
        }
        lower = next;
        distance *= 4.0;
    }
    Err(lower)
}

/// The root in a cell at whose start the residual is positive: at a kink, or between ends of unlike signs.
#[inline]
fn root_of_cell<E: Equation>(equation: &E, start: (f64, E::Sample), end: (f64, E::Sample)) -> Option<Root> {
    let residual = |m: f64| E::residual(&equation.sample(m));
    let ends = [E::residual(&start.1), E::residual(&end.1)];
    let (before, after) = (equation.kinks(&start.1), equation.kinks(&end.1));
    let mut least: Option<Root> = None;
    for k in 0..2 {
        if before[k] > 0.0 && after[k] <= 0.0 {
            let kink = |m: f64| equation.kinks(&equation.sample(m))[k];
            let m = bracketed(kink, (start.0, before[k]), (end.0, after[k]), f64::EPSILON).x;
            let value = residual(m);
            if value <= TOUCHING * m && least.is_none_or(|root| m < root.x) {
                least = Some(Root::exact(m, value));
            }
        }
    }
    match least {
        Some(root) if root.residual >= -TOUCHING * root.x => Some(root),
        Some(root) => Some(bracketed(residual, (start.0, ends[0]), (root.x, root.residual), f64::EPSILON)),
        None if ends[1] <= 0.0 => Some(bracketed(residual, (start.0, ends[0]), (end.0, ends[1]), f64::EPSILON)),
        None => None,
    }
}

/// The root before the bottom of a valley, if that is not above 0: between a node, a lower one and a third that is higher again, with
/// positive residuals.
#[cold]
fn root_of_valley<E: Equation>(equation: &E, start: (f64, f64), lowest: (f64, f64), end: f64) -> Option<Root> {
    let residual = |m: f64| E::residual(&equation.sample(m));
    let (mut left, mut bottom, mut right) = (start.0, lowest, end);
    while right - left > BOTTOM * right {
        let sides = [left - bottom.0, right - bottom.0];
        let m = bottom.0 + SECTION * if -sides[0] > sides[1] { sides[0] } else { sides[1] };
        let value = residual(m);
        if value <= 0.0 {
            return Some(bracketed(residual, start, (m, value), f64::EPSILON));
        }
        let farther = if value < bottom.1 { std::mem::replace(&mut bottom, (m, value)).0 } else { m };
        if farther < bottom.0 {
            left = farther;
        } else {
            right = farther;
        }
    }
    None
}
