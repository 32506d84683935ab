//! k_e s, a₁ s^b₁, a₂ s^b₂ (6.24).

use super::sums::{Line, Sums};
use super::thinned;
use crate::geometry::BondPoint;
use crate::law::Powers;
use models::bond_slip::Envelope;

/// Fewest points of the straight line, and of each power.
const FEWEST_ELASTIC: usize = 2;
const FEWEST_OF_POWER: usize = 3;
/// More points than this are thinned out: all pairs of joints are tried.
const MOST_POINTS: usize = 1500;

/// The law that fits the points (by rising slip) best; `None` if no two joints give a rise that is followed by a fall.
///
/// A power is a straight line between logarithms; the weight τ² makes its residuals those of τ, to first order.
pub fn powers(points: &[BondPoint]) -> Option<Powers> {
    let points = thinned(points, MOST_POINTS);
    let n = points.len();
    let elastic = Sums::of(points.iter().map(|point| [point.slip, point.traction, 1.0]));
    let logarithms = |point: &BondPoint| [point.slip.ln(), point.traction.ln(), point.traction.powi(2)];
    let logarithmic = Sums::of(points.iter().map(logarithms));
    let mut best: Option<(f64, [usize; 2])> = None;
    for first in FEWEST_ELASTIC..n.saturating_sub(2 * FEWEST_OF_POWER) {
        let Some(line) = elastic.line_through_origin(0, first) else { continue };
        for second in first + FEWEST_OF_POWER..=n - FEWEST_OF_POWER {
            let least = best.map_or(f64::INFINITY, |(residual, _)| residual);
            let Some(rise) = logarithmic.line(first, second).filter(|rise| line.residual + rise.residual < least)
            else {
                continue;
            };
            let Some(fall) = logarithmic.line(second, n) else { continue };
            let residual = line.residual + rise.residual + fall.residual;
            if residual < least && law(&line, &rise, &fall).is_some() {
                best = Some((residual, [first, second]));
            }
        }
    }
    let [first, second] = best?.1;
    // sums over the stretch alone lose no digits to the others
    let stretch = |from: usize, to: usize| Sums::of(points[from..to].iter().map(logarithms)).line(0, to - from);
    law(&elastic.line_through_origin(0, first)?, &stretch(first, second)?, &stretch(second, n)?)
}

/// The law of three lines, if it is one.
fn law(line: &Line, rise: &Line, fall: &Line) -> Option<Powers> {
    let [rise, fall] = [rise, fall].map(|line| [line.intercept.exp(), line.slope]);
    Envelope::powers(line.slope, rise, fall, 0.0).ok()?;
    Some(Powers { elastic_stiffness: line.slope, rise, fall })
}
