//! Straight lines, one after the other (6.23).

use super::sums::{Line, Sums};
use super::thinned;
use crate::geometry::BondPoint;
use crate::law::Piecewise;
use nalgebra::{DMatrix, DVector};

/// Fewest points of a line.
const FEWEST: usize = 3;
/// More points than this are thinned out: all joints are tried.
const MOST_POINTS: usize = 800;
/// Each secant stiffness is below the one before it by at least this part: the law wants them to fall.
const LEAST_FALL: f64 = 1e-3;
/// No traction is below this part of the greatest.
const LEAST_TRACTION: f64 = 1e-3;

/// The law of `count` points that fits the points (by rising slip) best; its last point is at the greatest slip. `None`
/// if there are too few points.
///
/// The stretches are those with the least sum of squares of lines of their own (dynamic programming, Bellman and Roth
/// 1969); neighbouring lines meet in the joints; the tractions there are those of the continuous function that fits best.
pub fn piecewise(points: &[BondPoint], count: usize) -> Option<Piecewise> {
    let points = thinned(points, MOST_POINTS);
    let ends = stretches(&points, count)?;
    let mut slips = joints(&points, &ends);
    slips.push(points.last()?.slip);
    let tractions = tractions(&points, &slips)?;
    let greatest = tractions.iter().copied().fold(0.0, f64::max);
    let mut secant = f64::INFINITY;
    let mut law = Vec::new();
    for (slip, traction) in slips.into_iter().zip(tractions) {
        secant = (traction.max(LEAST_TRACTION * greatest) / slip).min(secant * (1.0 - LEAST_FALL));
        law.push([slip, secant * slip]);
    }
    Some(Piecewise { points: law })
}

/// Returns the indices of the last points of `count` independent lines, the first through the origin.
fn stretches(points: &[BondPoint], count: usize) -> Option<Vec<usize>> {
    let n = points.len();
    let sums = Sums::of(points.iter().map(|point| [point.slip, point.traction, 1.0]));
    // the least sum of squares of the lines so far, the last of which ends at each point, and where the one before ended
    let first = |end: usize| match sums.line_through_origin(0, end + 1) {
        Some(line) if end + 1 >= FEWEST => line.residual,
        _ => f64::INFINITY,
    };
    let mut least: Vec<f64> = (0..n).map(first).collect();
    let mut before: Vec<Vec<usize>> = Vec::new();
    for _ in 1..count {
        let mut next = vec![(f64::INFINITY, 0); n];
        for (last, so_far) in least.iter().enumerate().filter(|(_, so_far)| so_far.is_finite()) {
            for end in last + FEWEST..n {
                let residual = so_far + sums.line(last + 1, end + 1).map_or(f64::INFINITY, |line| line.residual);
                if residual < next[end].0 {
                    next[end] = (residual, last);
                }
            }
        }
        before.push(next.iter().map(|(_, last)| *last).collect());
        least = next.into_iter().map(|(residual, _)| residual).collect();
    }
    least.last()?.is_finite().then(|| {
        let mut ends = vec![n - 1];
        for last in before.iter().rev() {
            ends.push(last[ends[ends.len() - 1]]);
        }
        ends.reverse();
        ends
    })
}

/// Returns where neighbouring lines meet, but not outside the gap between their points.
fn joints(points: &[BondPoint], ends: &[usize]) -> Vec<f64> {
    let line = |from: usize, to: usize| -> Option<Line> {
        Sums::of(points[from..=to].iter().map(|point| [point.slip, point.traction, 1.0])).line(0, to + 1 - from)
    };
    let begins = std::iter::once(0).chain(ends.iter().map(|end| end + 1));
    let lines: Vec<Option<Line>> = begins.zip(ends).map(|(from, &to)| line(from, to)).collect();
    let meet = |(lines, &end): (&[Option<Line>], &usize)| {
        let [before, after] = [points[end].slip, points[end + 1].slip];
        match lines {
            [Some(a), Some(b)] if a.slope != b.slope => {
                ((b.intercept - a.intercept) / (a.slope - b.slope)).clamp(before, after)
            }
            _ => before,
        }
    };
    lines.windows(2).zip(ends).map(meet).collect()
}

/// Tractions at the slips of the continuous, piecewise linear function through (0, 0) that fits the points best.
fn tractions(points: &[BondPoint], slips: &[f64]) -> Option<Vec<f64>> {
    let mut hats = DMatrix::zeros(points.len(), slips.len());
    for (row, point) in points.iter().enumerate() {
        let right = slips.partition_point(|&slip| slip < point.slip).min(slips.len() - 1);
        let left = right.checked_sub(1);
        let start = left.map_or(0.0, |left| slips[left]);
        let part = (point.slip - start) / (slips[right] - start);
        hats[(row, right)] = part;
        if let Some(left) = left {
            hats[(row, left)] = 1.0 - part;
        }
    }
    let measured = DVector::from_iterator(points.len(), points.iter().map(|point| point.traction));
    let solution = hats.svd(true, true).solve(&measured, f64::EPSILON).ok()?;
    solution.iter().all(|traction| traction.is_finite()).then(|| solution.iter().copied().collect())
}
